//! Bricks are made anew where the field has changed.

use jbt_ir::limits::MAX_BRICKS;
use jbt_ir::watch;

use super::bricks::BrickMesh;
use super::flips::FlipChain;
use crate::job::Hook;
use crate::mesh::brick::Bricks;
use crate::mesh::crossing::{self, Crossings};
use crate::mesh::divide::{self, BrickDivision, BrickLimits};
use crate::mesh::error::MeshError;
use crate::mesh::field::Field;
use crate::mesh::indexed::Mesh;
use crate::mesh::lattice::Lattice;
use crate::mesh::options::Options;
use crate::mesh::sample;
use crate::mesh::scope::DivisionScope;
use crate::mesh::vertex;
use crate::mesh::vertex::batch::VertexSource;
use crate::mesh::vertex::side::SharpVertex;
use crate::progress::{EACH, Progress};
use crate::touched::Touched;

/// Bricks that were made anew, before they take the places of old ones.
pub(crate) struct Renewal {
    pub(super) lattice: Lattice,
    pub(super) bricks: Bricks,
    pub(super) crossings: Crossings,
    /// For each brick, the cells with a low face that is pinched by default.
    pub(super) suspects: Vec<Vec<u32>>,
    /// Vertices, with their first normals.
    pub(super) mesh: Mesh,
    /// Of the mesh, ascending.
    pub(super) doubtful: Vec<u32>,
    /// Its vertices on edges and corners of the surface, ascending.
    pub(super) sharp: Vec<SharpVertex>,
    /// The bricks that may be made anew, in units of bricks from the first one; `None` for all.
    pub(super) touched: Option<Touched<3>>,
}

impl BrickMesh {
    /// Makes bricks anew: those that are touched, or all. The lattice is the present one or a grown one.
    pub(crate) fn renewal<F: Field>(
        &self,
        field: &F,
        lattice: &Lattice,
        (options, touched): (&Options, Option<Touched<3>>),
        hook: Hook<'_>,
    ) -> Result<Renewal, MeshError<F::Error>> {
        options.check()?;
        let progress = Progress::new(hook, EACH);
        let mut touched = touched;
        // Bricks keep their size, and so their names.
        let brick = if self.edge > 0 { Some(self.edge) } else { options.brick };
        let options = Options { brick, thin_parts: false, ..options.clone() };
        loop {
            let axes = lattice.axes();
            let scope = touched.as_ref().map_or(DivisionScope::Everything, DivisionScope::Touched);
            let division = divide::divide(field, axes, (&options, scope), BrickLimits::PIECES, &progress)?;
            let BrickDivision { bricks, regions, boxes: _, chunks: _ } = division;
            let samples = sample::sample(field, (&bricks, &regions), (options.iso, None), &progress)?;
            let mut found = crossing::look(&bricks, &samples, &progress)?;
            let flips = match &mut touched {
                None => crossing::flip(&bricks, &found.starts, &mut found.cells, &found.suspects),
                Some(touched) => {
                    let chain = FlipChain { mesh: self, lattice, bricks: &bricks, touched };
                    let (flips, others) = chain.flip(&mut found);
                    if !others.is_empty() {
                        // Rare: their vertices need the field again.
                        others.into_iter().for_each(|place| touched.add(place));
                        continue;
                    }
                    flips
                }
            };
            let suspects = suspects(bricks.len(), &found.starts, &found.suspects);
            let crossings = found.numbered(&bricks, &flips, &progress)?;
            self.check_limits(&bricks, &crossings, touched.as_ref())?;
            let source = VertexSource {
                field,
                options: &options,
                bricks: &bricks,
                regions: &regions,
                samples: &samples,
                crossings: &crossings,
            };
            let (mesh, done) = vertex::finish(&source, &progress)?;
            progress.finish()?;
            self.take_for_commit(&mesh, &crossings);
            let (lattice, doubtful, sharp) = (lattice.clone(), done.doubtful, done.sharp);
            return Ok(Renewal { lattice, bricks, crossings, suspects, mesh, doubtful, sharp, touched });
        }
    }

    /// Stops the work if there is no memory for new bricks among the old ones: a commit is not stopped
    /// halfway.
    fn take_for_commit(&self, mesh: &Mesh, crossings: &Crossings) {
        let widths: usize = mesh.attributes.iter().map(|attribute| attribute.width).sum();
        let a_vertex = size_of::<[f32; 3]>() * 2 + widths * size_of::<f32>();
        let a_triangle = size_of::<[u32; 3]>();
        let (vertices, triangles) = (mesh.positions.len(), 2 * crossings.quad_count());
        let mut bytes = vertices * a_vertex + triangles * a_triangle + size_of_val(&*crossings.cells);
        let buffers = &self.buffers;
        if self.vertex_slots.end() + vertices > buffers.positions.capacity() {
            bytes += buffers.positions.len() * a_vertex + buffers.triangles.len() * a_triangle;
        }
        // Buffers grow to twice what is in them, and slots are larger than what is in them.
        watch::take(3 * bytes);
    }

    /// Whether the numbers of bricks and vertices stay within their limits.
    fn check_limits<E: std::error::Error + 'static>(
        &self,
        bricks: &Bricks,
        crossings: &Crossings,
        touched: Option<&Touched<3>>,
    ) -> Result<(), MeshError<E>> {
        let kept = if touched.is_some() { self.bricks.len() } else { 0 };
        if kept + bricks.len() > MAX_BRICKS {
            return Err(MeshError::TooManyBricks { limit: MAX_BRICKS });
        }
        // Slots are at most half as large again as what is in them, but for the smallest ones.
        let vertices = self.vertex_slots.end() as u64 + 2 * crossings.vertex_count() as u64;
        let triangles = self.triangle_slots.end() as u64 + 4 * crossings.quad_count() as u64;
        if vertices.max(triangles) + 64 * bricks.len() as u64 > u64::from(u32::MAX) {
            return Err(MeshError::TooManyVertices { vertices });
        }
        Ok(())
    }
}

/// The suspects of each brick, counted from its first cell.
fn suspects(bricks: usize, starts: &[usize], all: &[(usize, usize)]) -> Vec<Vec<u32>> {
    let mut suspects = vec![Vec::new(); bricks];
    all.iter().for_each(|&(brick, cell)| suspects[brick].push((cell - starts[brick]) as u32));
    suspects
}
