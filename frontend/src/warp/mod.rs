//! Warps: deformations of space. One file per member, one list.
//!
//! A warp states the *inverse* map, from the warped space (where points are asked) to the child's space (where it answers).

use glam::DVec3;
use jbt_ir::Domain;

use crate::bounds::Bounds;
use crate::field::{Field, FieldValue, Member};

/// What a warp states about itself.
pub trait WarpMember: Member {
    /// Names of the columns that [`columns`](Self::columns) fills, in order.
    const COLUMNS: &'static [&'static str];

    /// Where the child is asked when the node is asked at `p`, plainly.
    fn inverse(&self, p: DVec3) -> DVec3;

    /// A box around the warped child, from a box around the child.
    fn forward_bounds(&self, child: Bounds) -> Bounds;

    /// A box like [`forward_bounds`](Self::forward_bounds), for [`emit`](Self::emit) in f32 with its rounding: no point outside of it is
    /// taken into the child's box. Supports rest on it.
    fn reach(&self, child: Bounds) -> Bounds;

    /// What the inverse map makes of coordinates up to `largest` in magnitude.
    fn growth(&self, largest: f64) -> Growth;

    /// The numbers of a row: one for each of [`COLUMNS`](Self::COLUMNS).
    fn columns(&self, row: &mut Vec<f64>);

    /// The part of the parameters that selects code, below 256.
    fn variant(&self) -> u8;

    /// Where the child is asked, over the ops; `row` holds the columns of a warp with this variant.
    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3];
}

/// How large the numbers behind a warp may become.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Growth {
    /// A bound of the child's coordinates, in magnitude.
    pub coordinates: f64,
    /// A bound of the sum of the derivatives of a child's coordinate along the three axes, in magnitude.
    pub derivatives: f64,
}

macro_rules! warps {
    ($($module:ident :: $name:ident),+ $(,)?) => {
        $( mod $module; pub use $module::$name; )+

        /// A warp of any kind.
        #[derive(Clone, PartialEq, Debug)]
        pub enum Warp { $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name($name), )+ }

        /// The kind of a warp and the variant of its code: what selects code.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum WarpKind { $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name(u8), )+ }

        $( impl From<$name> for Warp { fn from(warp: $name) -> Self { Self::$name(warp) } } )+

        impl WarpKind {
            /// Every kind with variant 0, in the order of the list.
            pub const ALL: &'static [Self] = &[ $( Self::$name(0), )+ ];

            /// The word of the text format.
            #[must_use]
            pub const fn name(self) -> &'static str { match self { $( Self::$name(_) => $name::NAME, )+ } }

            /// The parameters.
            #[must_use]
            pub const fn fields(self) -> &'static [Field] { match self { $( Self::$name(_) => $name::FIELDS, )+ } }

            /// The names of the columns of a row.
            #[must_use]
            pub const fn columns(self) -> &'static [&'static str] { match self { $( Self::$name(_) => $name::COLUMNS, )+ } }

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
            /// The kind and variant.
            #[must_use]
            pub fn kind(&self) -> WarpKind { match self { $( Self::$name(w) => WarpKind::$name(w.variant()), )+ } }

            /// The parameters, in the order of [`WarpKind::fields`].
            #[must_use]
            pub fn to_fields(&self) -> Vec<FieldValue> { match self { $( Self::$name(w) => w.to_fields(), )+ } }

            /// See [`WarpMember::inverse`].
            #[must_use]
            pub fn inverse(&self, p: DVec3) -> DVec3 { match self { $( Self::$name(w) => w.inverse(p), )+ } }

            /// See [`WarpMember::forward_bounds`].
            #[must_use]
            pub fn forward_bounds(&self, child: Bounds) -> Bounds { match self { $( Self::$name(w) => w.forward_bounds(child), )+ } }

            /// See [`WarpMember::reach`].
            #[must_use]
            pub fn reach(&self, child: Bounds) -> Bounds { match self { $( Self::$name(w) => w.reach(child), )+ } }

            /// See [`WarpMember::growth`].
            #[must_use]
            pub fn growth(&self, largest: f64) -> Growth { match self { $( Self::$name(w) => w.growth(largest), )+ } }

            /// See [`WarpMember::columns`].
            pub fn columns(&self, row: &mut Vec<f64>) { match self { $( Self::$name(w) => w.columns(row), )+ } }
        }
    };
}

warps! {
    twist::Twist,
}
