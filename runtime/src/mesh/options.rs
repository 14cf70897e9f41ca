//! How to mesh.

use std::error::Error;

use super::error::{MAX_BRICK, MAX_PULLS, MIN_BRICK, MeshError};

/// How to mesh.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Options {
    /// The surface is where the field has this value. Any finite number.
    pub iso: f32,
    /// Newton steps that pull each vertex onto the surface, 0 to [`MAX_PULLS`]. Each costs a gradient per
    /// vertex and about squares the distance that is left, in units of the radius of curvature; two suffice
    /// for a smooth field.
    pub pulls: usize,
    /// Cells along the edge of the bricks at which division ends: a power of two from [`MIN_BRICK`] to
    /// [`MAX_BRICK`]. Small ones waste fewer points far from the surface, large ones fewer calls. It changes
    /// what is evaluated, but no bit of the mesh. `None`: 8, or 4 where a point takes long.
    pub brick: Option<usize>,
    /// Whether to look at every edge of the mesh to find out whether it is closed. Without that, it follows
    /// from the cells at the sides of the lattice.
    pub verify: bool,
    /// Whether to search for parts that are thinner than a cell: see
    /// [`MeshReport::thin`](super::MeshReport::thin). The search needs a field that knows ranges of boxes,
    /// and does not change the mesh.
    pub thin_parts: bool,
    /// Whether vertices go to edges and corners of the surface, where the field knows any: see
    /// [`Field::decided`](super::Field::decided). It needs at least one pull.
    pub sharp: bool,
}

impl Default for Options {
    /// Iso 0.5, two pulls, bricks as they are best, verified, no search for thin parts, sharp edges.
    fn default() -> Self {
        Options { iso: 0.5, pulls: 2, brick: None, verify: true, thin_parts: false, sharp: true }
    }
}

impl Options {
    /// Checks the options.
    pub(super) fn check<E: Error + 'static>(&self) -> Result<(), MeshError<E>> {
        let &Options { iso, pulls, brick, verify: _, thin_parts: _, sharp: _ } = self;
        if !iso.is_finite() {
            return Err(MeshError::Iso { iso });
        }
        if let Some(brick) = brick
            && (!brick.is_power_of_two() || !(MIN_BRICK..=MAX_BRICK).contains(&brick))
        {
            return Err(MeshError::Brick { brick });
        }
        if pulls > MAX_PULLS {
            return Err(MeshError::Pulls { pulls });
        }
        Ok(())
    }
}
