//! Warps: deformations of space. One file per member, one list, and the warp that is given by formulas
//! ([`FormulaWarp`](struct@FormulaWarp)).
//!
//! A warp is an *inverse* map, from the warped space (where points are asked) to the child's space.
//!
//! Any warp can be *weighted* by the field of a second child, which stands in the warp's space and
//! contributes only that number: a point p is taken to `p + w (inverse(p) - p)`, where w is the field at p,
//! between 0 and 1 (de Groot and Wyvill's deformation by a second BlobTree). So outside of the second child's
//! support the first child is unchanged.

use std::sync::Arc;

use glam::DVec3;
use jbt_ir::Domain;

use crate::bounds::Bounds;
use crate::expression::Form;
use crate::field::{Field, FieldValue};
use crate::member::Member as _;

mod axes;
mod formula;
mod member;
#[cfg(test)]
mod testing;

use axes::{ROUNDINGS, UNDERFLOW, farthest, turned};
pub use formula::{FormulaWarp, LARGEST_WARPED};
pub use member::{WarpFault, WarpGrowth, WarpMember};

macro_rules! warps {
    ($($module:ident :: $name:ident),+ $(,)?) => {
        $( mod $module; pub use $module::$name; pub(crate) use $module::describe as $module; )+

        /// A warp of any kind.
        #[derive(Clone, PartialEq, Debug)]
        pub enum Warp {
            $(
                #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")]
                $name($name),
            )+
            /// See [`FormulaWarp`](struct@FormulaWarp).
            Formula(FormulaWarp),
        }

        /// The kind of a member and the variant of its code: what selects code.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum WarpKind {
            $(
                #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")]
                $name(u8),
            )+
        }

        $( impl From<$name> for Warp { fn from(warp: $name) -> Self { Self::$name(warp) } } )+

        impl WarpKind {
            /// Every kind with variant 0, in the order of the list.
            pub const ALL: &'static [Self] = &[ $( Self::$name(0), )+ ];

            /// The word of the text format.
            #[must_use]
            pub const fn name(self) -> &'static str { match self { $( Self::$name(_) => $name::NAME, )+ } }

            /// The name of the constructor in [`builder`](crate::builder).
            #[must_use]
            pub const fn constructor(self) -> &'static str { match self { $( Self::$name(_) => stringify!($module), )+ } }

            /// The parameters.
            #[must_use]
            pub const fn fields(self) -> &'static [Field] {
                match self { $( Self::$name(_) => $name::FIELDS, )+ }
            }

            /// See [`WarpMember::CREASES`].
            #[must_use]
            pub const fn creases(self) -> bool {
                match self { $( Self::$name(_) => $name::CREASES, )+ }
            }

            /// The names of the columns of a row.
            #[must_use]
            pub const fn columns(self) -> &'static [&'static str] {
                match self { $( Self::$name(_) => $name::COLUMNS, )+ }
            }

            /// The warp of this kind with these parameters.
            #[must_use]
            pub fn from_fields(self, values: &[FieldValue]) -> Warp {
                match self { $( Self::$name(_) => Warp::$name($name::from_fields(values)), )+ }
            }

            /// The inverse map over the ops.
            pub fn emit<D: Domain>(self, d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
                match self { $( Self::$name(variant) => $name::emit(d, variant, p, row), )+ }
            }
        }

        impl Warp {
            /// What selects its code.
            #[must_use]
            pub fn code(&self) -> WarpCode {
                match self {
                    $( Self::$name(w) => WarpCode::Member(WarpKind::$name(w.variant())), )+
                    Self::Formula(w) => WarpCode::Formula(Arc::clone(&w.form)),
                }
            }

            /// The kind of a member, with variant 0; `None` for formulas.
            #[must_use]
            pub const fn kind(&self) -> Option<WarpKind> {
                match self { $( Self::$name(_) => Some(WarpKind::$name(0)), )+ Self::Formula(_) => None }
            }

            /// The word of the text format.
            #[must_use]
            pub const fn name(&self) -> &'static str {
                match self { $( Self::$name(_) => $name::NAME, )+ Self::Formula(_) => FormulaWarp::NAME }
            }

            /// The parameters; formulas have numbers of their own.
            #[must_use]
            pub const fn fields(&self) -> &'static [Field] {
                match self { $( Self::$name(_) => $name::FIELDS, )+ Self::Formula(_) => &[] }
            }

            /// The parameters, in the order of [`fields`](Self::fields).
            #[must_use]
            pub fn to_fields(&self) -> Vec<FieldValue> {
                match self { $( Self::$name(w) => w.to_fields(), )+ Self::Formula(_) => Vec::new() }
            }

            /// See [`WarpMember::inverse`].
            #[must_use]
            pub fn inverse(&self, p: DVec3) -> DVec3 {
                match self { $( Self::$name(w) => w.inverse(p), )+ Self::Formula(w) => w.inverse(p) }
            }

            /// See [`WarpMember::kink_distance`].
            #[must_use]
            pub fn kink_distance(&self, p: DVec3) -> f64 {
                match self {
                    $( Self::$name(w) => w.kink_distance(p), )+
                    Self::Formula(w) => w.kink_distance(p),
                }
            }

            /// See [`WarpMember::fault`].
            #[must_use]
            pub fn fault(&self) -> Option<WarpFault> {
                match self { $( Self::$name(w) => w.fault(), )+ Self::Formula(w) => w.fault() }
            }

            /// See [`WarpMember::forward_bounds`].
            #[must_use]
            pub fn forward_bounds(&self, child: Bounds) -> Bounds {
                match self {
                    $( Self::$name(w) => w.forward_bounds(child), )+
                    Self::Formula(_) => FormulaWarp::reach(child),
                }
            }

            /// See [`WarpMember::reach`].
            #[must_use]
            pub fn reach(&self, child: Bounds) -> Bounds {
                match self {
                    $( Self::$name(w) => w.reach(child), )+
                    Self::Formula(_) => FormulaWarp::reach(child),
                }
            }

            /// See [`WarpMember::growth`].
            #[must_use]
            pub fn growth(&self, largest: f64) -> WarpGrowth {
                match self {
                    $( Self::$name(w) => w.growth(largest), )+
                    Self::Formula(w) => w.growth(largest),
                }
            }

            /// See [`WarpMember::columns`].
            pub fn columns(&self, row: &mut Vec<f64>) {
                match self {
                    $( Self::$name(w) => w.columns(row), )+
                    Self::Formula(w) => row.extend(&w.numbers),
                }
            }
        }

        $crate::member::each! { ($) warp $($module)+ }
    };
}

warps! {
    twist::Twist,
    taper::Taper,
    bend::Bend,
    mirror::Mirror,
    repeat::Repeat,
    repeat_around::RepeatAround,
    space_map::SpaceMap,
    deform::Deform,
}

/// What selects the code of a warp.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub enum WarpCode {
    /// The code of a member of the list.
    Member(WarpKind),
    /// The code of formulas.
    Formula(Arc<Form>),
}

impl WarpCode {
    /// Whether the map may have creases, which bend the child sharply.
    #[must_use]
    pub fn creases(&self) -> bool {
        match self {
            Self::Member(kind) => kind.creases(),
            Self::Formula(_) => true,
        }
    }

    /// The names of the columns of a row.
    #[must_use]
    pub fn columns(&self) -> Vec<&'static str> {
        match self {
            Self::Member(kind) => kind.columns().to_vec(),
            Self::Formula(form) => vec!["number"; form.numbers()],
        }
    }

    /// The inverse map over the ops.
    pub fn emit<D: Domain>(&self, d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        match self {
            Self::Member(kind) => kind.emit(d, p, row),
            Self::Formula(form) => formula::emit(form, d, p, row),
        }
    }

    /// The inverse map over the ops, with a weight: see the module. Where the weight is 0, a point keeps its
    /// bits.
    pub fn emit_weighted<D: Domain>(
        &self,
        d: &mut D,
        p: [D::Real; 3],
        row: &[D::Real],
        weight: D::Real,
    ) -> [D::Real; 3] {
        let q = self.emit(d, p, row);
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let weight = d.max(weight, zero);
        let weight = d.min(weight, one);
        std::array::from_fn(|axis| {
            let way = d.sub(q[axis], p[axis]);
            d.fma(weight, way, p[axis])
        })
    }
}

impl From<FormulaWarp> for Warp {
    fn from(warp: FormulaWarp) -> Self {
        Self::Formula(warp)
    }
}

impl Warp {
    /// The inverse map with a weight: see the module.
    #[must_use]
    pub fn weighted(&self, p: DVec3, weight: f64) -> DVec3 {
        p + weight.clamp(0.0, 1.0) * (self.inverse(p) - p)
    }
}
