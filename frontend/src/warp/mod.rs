//! Warps: deformations of space. One file per member, one list.
//!
//! A warp states the *inverse* map, from the warped space (where points are asked) to the child's space (where it answers).

use glam::DVec3;
use jbt_ir::Domain;

use crate::bounds::Bounds;
use crate::field::{Field, FieldKind, FieldValue, Member};

mod angle;
#[cfg(test)]
mod testing;

/// What a warp states about itself.
pub trait WarpMember: Member {
    /// Names of the columns that [`columns`](Self::columns) fills, in order.
    const COLUMNS: &'static [&'static str];

    /// Where the child is asked when the node is asked at `p`, plainly.
    fn inverse(&self, p: DVec3) -> DVec3;

    /// How far a point is, about, from where the map has a crease or a jump: gradients of the warped child may jump there, too. Infinity
    /// if it has none.
    fn decision(&self, p: DVec3) -> f64;

    /// What is wrong with parameters of which each is what its [`FieldKind`] says.
    fn fault(&self) -> Option<WarpFault>;

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

/// Why a warp is none.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct WarpFault {
    /// What is wrong.
    pub message: String,
    /// What would be right.
    pub expected: &'static str,
}

/// How large the numbers behind a warp may become.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Growth {
    /// A bound of the child's coordinates, in magnitude.
    pub coordinates: f64,
    /// A bound of the sum of the derivatives of a child's coordinate along the three axes, in magnitude.
    pub derivatives: f64,
}

impl Growth {
    /// Nothing is known: what is behind such a warp may be anywhere.
    pub(crate) const UNKNOWN: Self = Self { coordinates: f64::INFINITY, derivatives: f64::INFINITY };
}

/// The parameter `axis`: a coordinate axis through the origin, z if it is not written.
const AXIS: Field =
    Field { name: "axis", kind: FieldKind::Axis, default: Some(FieldValue::Vector([0.0, 0.0, 1.0])) };

/// The number of an axis: 0 is x, 1 is y, 2 is z.
fn axis_of(value: FieldValue) -> u8 {
    let axis = value.vector();
    if axis[0] != 0.0 {
        0
    } else if axis[1] != 0.0 {
        1
    } else {
        2
    }
}

/// The value of the parameter [`AXIS`].
fn axis_value(axis: u8) -> FieldValue {
    FieldValue::Vector(DVec3::AXES[axis as usize].into())
}

/// An axis and the two behind it, in right-handed order.
const fn order(axis: u8) -> [usize; 3] {
    let a = axis as usize;
    [a, (a + 1) % 3, (a + 2) % 3]
}

/// A box, turned by every angle about an axis, and `stretch` times as far from it.
fn turned(axis: u8, child: Bounds, stretch: f64) -> Bounds {
    let [_, u, v] = order(axis);
    let reach = |axis: usize| child.min[axis].abs().max(child.max[axis].abs());
    let radius = reach(u).hypot(reach(v)) * stretch;
    let mut turned = child;
    for axis in [u, v] {
        turned.min[axis] = -radius;
        turned.max[axis] = radius;
    }
    turned
}

/// The largest magnitude of a coordinate in a box; 0 if nothing is in it.
fn farthest(child: Bounds) -> f64 {
    if child.is_empty() { 0.0 } else { child.min.abs().max(child.max.abs()).max_element() }
}

/// More than a few roundings of f32 take, relative to the numbers that are rounded: 2^-19.
const ROUNDINGS: f64 = 1.0 / (1 << 19) as f64;
/// More than underflow takes from products of numbers in f32 and coordinates: 2^-80.
const UNDERFLOW: f64 = 1.0 / (1_u128 << 80) as f64;

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

            /// See [`WarpMember::decision`].
            #[must_use]
            pub fn decision(&self, p: DVec3) -> f64 { match self { $( Self::$name(w) => w.decision(p), )+ } }

            /// See [`WarpMember::fault`].
            #[must_use]
            pub fn fault(&self) -> Option<WarpFault> { match self { $( Self::$name(w) => w.fault(), )+ } }

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
    taper::Taper,
    bend::Bend,
    mirror::Mirror,
    repeat::Repeat,
    repeat_around::RepeatAround,
    space_map::SpaceMap,
}
