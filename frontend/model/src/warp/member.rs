//! What every warp states about itself.

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

    /// Where the child is asked when the node is asked at `p`, plainly.
    fn inverse(&self, p: DVec3) -> DVec3;

    /// How far a point is, about, from where the map has a crease or a jump: gradients of the warped child
    /// may jump there, too. Infinity if it has none.
    fn kink_distance(&self, p: DVec3) -> f64;

    /// What is wrong with parameters of which each is what its [`FieldKind`] says.
    fn fault(&self) -> Option<WarpFault>;

    /// A box around the warped child, from a box around the child.
    fn forward_bounds(&self, child: Bounds) -> Bounds;

    /// A box like [`forward_bounds`](Self::forward_bounds), for [`emit`](Self::emit) in f32 with its
    /// rounding: no point outside of it is taken into the child's box. Supports rest on it.
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
