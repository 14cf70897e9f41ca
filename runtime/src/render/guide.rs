//! The mesh that guides rays: what light sees of a model, and where the eye begins to look.
//!
//! ```text
//! coarse mesh: a few thousand triangles   how the model fills the picture, where the ground is,
//!                                         how many triangles a fine mesh will have
//! fine mesh:   cells of some pixels       light meets it instead of the field; near it, the eye's rays
//!                                         take the field's word
//! ```
//!
//! The lattices follow from the settings of the picture and from the model. So a mesh, and whatever is traced
//! against it, is the same for any number of threads and every engine.

use std::time::{Duration, Instant};

use super::error::RenderError;
use super::hierarchy::Hierarchy;
use super::renderer::Renderer;
use super::surface_field::SurfaceField;
use crate::boxes::Box3;
use crate::job::Hook;
use crate::mesh::{self, Lattice, Mesh, MeshError, MeshReport};
use crate::span::span;

use jbt_ir::limits::{MAX_GUIDE_CELLS, MAX_GUIDE_TRIANGLES};

/// Cells along the longest side of a coarse mesh.
const COARSE_CELLS: f64 = 48.0;

/// The number of wanted cells up to which a cell may be larger and its mesh still leads the eye.
const LEADING: f64 = 2.0;

/// A coarse mesh of the part of a model that is in some bounds.
pub struct CoarseMesh {
    pub mesh: Mesh,
    pub cell: f64,
    /// Whether a side of the region cuts the model.
    pub is_cut: bool,
}

/// A mesh that rays meet in place of the surface.
pub struct Guide {
    pub mesh: Mesh,
    /// What light meets; `None` where a picture has no other light than what reaches everything.
    pub hierarchy: Option<Hierarchy>,
    /// Whether it is fine enough to lead the eye. If not, the eye's rays are exact.
    pub leads: bool,
    /// The edge of a cell: the mesh may miss what is thinner.
    pub cell: f64,
    /// Whether a side of the region cuts the model, so that the mesh is open there.
    pub is_cut: bool,
    /// The smallest coordinate of the mesh along the picture's up direction.
    pub lowest: f64,
    /// The number of distances to skeletons that were evaluated for it.
    pub evaluations: u64,
    /// The time that it took.
    pub time: Duration,
}

impl CoarseMesh {
    /// The mesh of what is in the bounds; `None` if there is none.
    pub fn new(renderer: &Renderer, bounds: &Box3, hook: Hook<'_>) -> Result<Option<Self>, RenderError> {
        span!("guide");
        let cell = f64::from(bounds.longest_side()) / COARSE_CELLS;
        let Some((mesh, report, _)) = meshed(renderer, bounds, cell, hook)? else { return Ok(None) };
        Ok(Some(Self { mesh, cell, is_cut: report.cut_sides.any() }))
    }

    /// The edge of cells with which there will be about so many triangles: their number grows with the square
    /// of the fineness.
    pub fn cell_for(&self, triangles: f64) -> f64 {
        self.cell * (self.mesh.triangles.len() as f64 / triangles).sqrt()
    }
}

impl Guide {
    /// A mesh with cells of this edge, or larger ones where there would be more triangles than
    /// [`MAX_GUIDE_TRIANGLES`] or more cells along a side than [`MAX_GUIDE_CELLS`]. `None` if there is no
    /// surface, or no mesh to be had of it. `is_lit` asks for what light meets.
    pub fn new(
        renderer: &Renderer,
        (bounds, coarse): (&Box3, &CoarseMesh),
        cell: f64,
        (up, is_lit): ([f64; 3], bool),
        hook: Hook<'_>,
    ) -> Result<Option<Self>, RenderError> {
        let started = Instant::now();
        let wanted = cell;
        let least = coarse.cell_for(MAX_GUIDE_TRIANGLES as f64);
        let cell = cell.max(least).max(f64::from(bounds.longest_side()) / MAX_GUIDE_CELLS as f64);
        let Some((mesh, report, evaluations)) = meshed(renderer, bounds, cell, hook)? else {
            return Ok(None);
        };
        let height =
            |position: &[f32; 3]| (0..3).map(|axis| f64::from(position[axis]) * up[axis]).sum::<f64>();
        let lowest = mesh.positions.iter().map(height).fold(f64::INFINITY, f64::min);
        let hierarchy = if is_lit { Hierarchy::new(&mesh.positions, &mesh.triangles) } else { None };
        Ok(Some(Self {
            mesh,
            hierarchy,
            leads: cell <= LEADING * wanted,
            cell,
            is_cut: report.cut_sides.any(),
            lowest,
            evaluations,
            time: started.elapsed(),
        }))
    }
}

/// The mesh of a part of a model, and the distances to skeletons that it took. `None` where no lattice is to
/// be had, or where it would be beyond a limit of meshes.
fn meshed(
    renderer: &Renderer,
    bounds: &Box3,
    cell: f64,
    hook: Hook<'_>,
) -> Result<Option<(Mesh, MeshReport, u64)>, RenderError> {
    let Box3 { low, high } = bounds.map(|corner| corner.map(f64::from));
    let Ok(lattice) = Lattice::covering(low, high, cell) else { return Ok(None) };
    let field = SurfaceField::new(renderer);
    let options = mesh::Options {
        iso: renderer.tracer.iso(),
        pulls: 0,
        verify: false,
        thin_parts: false,
        ..mesh::Options::default()
    };
    match mesh::extract_hooked(&field, &lattice, &options, hook, (|| Ok(()), |_| ())) {
        Ok((mesh, report)) => Ok(Some((mesh, report, field.evaluations()))),
        Err(MeshError::Cancelled) => Err(RenderError::Cancelled),
        Err(MeshError::Field(error)) => Err(error.into()),
        Err(
            MeshError::Iso { .. }
            | MeshError::Brick { .. }
            | MeshError::Pulls { .. }
            | MeshError::Width { .. }
            | MeshError::TooManyBricks { .. }
            | MeshError::Memory(_)
            | MeshError::Reach { .. }
            | MeshError::TooManyVertices { .. },
        ) => Ok(None),
    }
}
