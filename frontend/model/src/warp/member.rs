//! What every warp implements.

use glam::DVec3;
use jbt_ir::Domain;

use crate::bounds::Bounds;
#[cfg(doc)]
use crate::field::FieldKind;
use crate::member::Member;

/// What a warp states about itself.
pub trait WarpMember: Member {
    /// Names of the columns that [`columns`](Self::columns) fills, in order.
    const COLUMNS: &'static [&'static str];

    /// Whether the map has creases, which bend the child sharply.
    const CREASES: bool = false;

    /// The point of the child's space for the point `p` of the warped space, in f64.
    fn inverse(&self, p: DVec3) -> DVec3;

    /// About the distance of a point from a crease or a jump of the map, where gradients of the warped child
    /// may jump, too; infinity if there is none.
    fn kink_distance(&self, p: DVec3) -> f64;

    /// The fault of parameters that are valid one by one by their [`FieldKind`].
    fn fault(&self) -> Option<WarpFault>;

    /// A box around the warped child, from a box around the child.
    fn forward_bounds(&self, child: Bounds) -> Bounds;

    /// A box like [`forward_bounds`](Self::forward_bounds), for [`emit`](Self::emit) in f32 with its
    /// rounding: no point outside of it is taken into the child's box. Supports rest on it.
    fn reach(&self, child: Bounds) -> Bounds;

    /// Bounds of the inverse map for coordinates up to `largest` in magnitude.
    fn growth(&self, largest: f64) -> WarpGrowth;

    /// The numbers of a row: one for each of [`COLUMNS`](Self::COLUMNS).
    fn columns(&self, row: &mut Vec<f64>);

    /// The part of the parameters that selects code, below 256.
    fn variant(&self) -> u8;

    /// The inverse map over the ops; `row` holds the columns of a warp with this variant.
    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3];
}

/// Why parameters make no warp.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct WarpFault {
    /// What is wrong.
    pub message: String,
    /// What would be right.
    pub expected: &'static str,
}

/// How large the numbers behind a warp may become.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct WarpGrowth {
    /// A bound of the child's coordinates, in magnitude.
    pub coordinates: f64,
    /// A bound of the sum of the derivatives of a child's coordinate along the three axes, in magnitude.
    pub derivatives: f64,
}

impl WarpGrowth {
    /// Nothing is known: the image of such a warp may be anywhere.
    pub(crate) const UNKNOWN: Self = Self { coordinates: f64::INFINITY, derivatives: f64::INFINITY };
}
