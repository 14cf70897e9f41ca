//! Meshes: the surface `field = iso` over a lattice, as triangles (dual marching cubes).
//!
//! ```text
//!     . . . . . . .        . . . . . . .          one vertex in each sheet of a cell,
//!     . . o o . . .        . .---.---. .          one quad around each crossed lattice edge
//!     . o o o o . .   =>   ./ o o o o \.
//!     . . o o o . .        . \ .o o o / .         o inside: field >= iso
//!     . . . . . . .        . . `-----'. .         . outside: field < iso, or NaN
//! ```
//!
//! In pseudo-code:
//!
//! ```text
//!     field  = evaluate every lattice point once, brick by brick                            (sample)
//!     cells  = the cells that the surface crosses, from their eight signs                   (crossing)
//!     faces  = flip the few ambiguous faces that would pinch the mesh                       (crossing, cell)
//!     quads  = one for each crossed edge, through the four cells around it                  (surface)
//!     vertex = mean of its sheet's crossings, pulled onto the surface by Newton's step,
//!              kept in its cell; then normal and attributes, once                           (vertex)
//!     split each quad along its shorter diagonal; check that the mesh is closed             (surface, check)
//! ```
//!
//! A cell that two sheets pass through has two vertices (Nielson 2004), so they do not touch there. What remains is a face
//! that both neighbours see twice from one sheet; such a face is resolved the other way, which splits both sheets (after the
//! rule of Wenger 2013, "Isosurfaces", for manifold dual contours). The mesh is closed and manifold wherever the surface stays inside
//! the lattice, for any field, also for one that is noise. The result is the same to the bit for every thread count and
//! every brick size.

mod cell;
mod check;
mod crossing;
mod lattice;
mod progress;
mod sample;
mod settle;
mod surface;
mod vertex;

use std::error::Error;
use std::fmt;

use jbt_ir::limits::MAX_ATTRIBUTE_WIDTH;
use thiserror::Error;

pub use check::{Defect, check_manifold, is_closed};
pub use lattice::{Lattice, LatticeError};

pub(crate) use surface::facet_normal;

use progress::Progress;

/// The largest [`Options::brick`].
pub const MAX_BRICK: usize = 128;
/// The largest [`Options::pulls`]. Newton's step has converged long before.
pub const MAX_PULLS: usize = 64;

/// What the mesher asks of a field. All slices of one call have the same length, which is at least 1 and otherwise free.
///
/// The mesher calls from many threads at once. An answer must depend on its own point only, and not on the points beside it;
/// then the mesh does not depend on how the points were grouped.
pub trait Field: Sync {
    /// What can go wrong with an evaluation.
    type Error: Error + Send + 'static;

    /// The names and widths (1 to 4 reals) of the attributes that [`Field::all`] answers, in its order.
    fn attributes(&self) -> Vec<(String, usize)>;

    /// The field at each point. Inside is `field >= iso`; NaN is outside.
    ///
    /// # Errors
    /// Whatever the evaluation reports; the mesher stops and hands it on.
    fn field(&self, x: &[f32], y: &[f32], z: &[f32], field: &mut [f32]) -> Result<(), Self::Error>;

    /// The field and its gradient at each point, to pull vertices onto the surface.
    ///
    /// # Errors
    /// As [`Field::field`].
    fn gradient(
        &self,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
    ) -> Result<(), Self::Error>;

    /// The field, its gradient and every attribute at each point: once for each vertex. There is one plane for each real of
    /// each attribute, in the order of [`Field::attributes`].
    ///
    /// # Errors
    /// As [`Field::field`].
    fn all(
        &self,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
        attributes: &mut [&mut [f32]],
    ) -> Result<(), Self::Error>;
}

/// How to mesh. The number of threads is that of the rayon pool in which [`extract`] is called.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The surface is where the field has this value. Any finite number.
    pub iso: f32,
    /// Newton steps that pull each vertex onto the surface, 0 to [`MAX_PULLS`]. Each costs a gradient per vertex and about
    /// squares the distance that is left, in units of the radius of curvature; two suffice for a smooth field.
    pub pulls: usize,
    /// Lattice points along the edge of the bricks in which the field is asked, 1 to [`MAX_BRICK`]. It changes the speed only.
    pub brick: usize,
}

impl Default for Options {
    /// Iso 0.5, two pulls, bricks of 16.
    fn default() -> Self {
        Options { iso: 0.5, pulls: 2, brick: 16 }
    }
}

/// Named reals at each vertex of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute {
    /// The name, as in the model.
    pub name: String,
    /// Reals per vertex, 1 to 4.
    pub width: usize,
    /// `width` reals for each vertex, one vertex after the other.
    pub values: Vec<f32>,
}

/// An indexed triangle mesh with normals and attributes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// One for each vertex.
    pub positions: Vec<[f32; 3]>,
    /// One for each vertex, of length 1, away from the inside.
    pub normals: Vec<[f32; 3]>,
    /// Each has values for every vertex.
    pub attributes: Vec<Attribute>,
    /// Three indices of vertices each, counter-clockwise when seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Some of the six sides of a lattice. Prints as `-x +z`, or `none`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sides {
    /// The low sides, at the first corners along x, y and z.
    pub low: [bool; 3],
    /// The high sides.
    pub high: [bool; 3],
}

impl Sides {
    /// Whether any side is among them.
    pub fn any(self) -> bool {
        self.low.iter().chain(&self.high).any(|&side| side)
    }
}

impl fmt::Display for Sides {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.any() {
            return f.write_str("none");
        }
        let mut separator = "";
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            for (sign, side) in [("-", self.low[axis]), ("+", self.high[axis])] {
                if side {
                    write!(f, "{separator}{sign}{name}")?;
                    separator = " ";
                }
            }
        }
        Ok(())
    }
}

/// What was done to make a mesh, and what it is like.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Whether every edge has exactly two triangles, in opposite directions. A mesh without triangles is closed.
    pub closed: bool,
    /// The sides of the lattice that cut the body: some lattice point on that side is inside. Without any, the mesh is closed.
    pub cut_sides: Sides,
    /// Points at which the field alone was evaluated: the points of the lattice, once each.
    pub field_evaluations: u64,
    /// Points at which field and gradient were evaluated: with any pulls, one more than that for each
    /// vertex, and some more for those that a crease keeps off the surface.
    pub gradient_evaluations: u64,
    /// Points at which everything was evaluated: once for each vertex.
    pub full_evaluations: u64,
    /// Cells that the surface crosses.
    pub crossing_cells: u64,
    /// Ambiguous faces that were resolved the other way, to keep the mesh manifold.
    pub flipped_faces: u64,
}

/// Why there is no mesh. `E` is the error of the field.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MeshError<E: Error + 'static> {
    /// The field could not be evaluated.
    #[error("the field cannot be evaluated")]
    Field(#[source] E),
    /// The progress hook said to stop.
    #[error("meshing was cancelled")]
    Cancelled,
    /// The iso-value is infinite or NaN.
    #[error("the iso-value must be a finite number, and it is {iso}")]
    Iso {
        /// What was asked for.
        iso: f32,
    },
    /// A brick of no points, or of more than [`MAX_BRICK`] along an edge.
    #[error("a brick has from 1 to {MAX_BRICK} points along an edge, and {brick} were asked for")]
    Brick {
        /// What was asked for.
        brick: usize,
    },
    /// More than [`MAX_PULLS`] pulls.
    #[error("a vertex is pulled at most {MAX_PULLS} times, and {pulls} were asked for")]
    Pulls {
        /// What was asked for.
        pulls: usize,
    },
    /// The field has an attribute of no reals, or of more than [`MAX_ATTRIBUTE_WIDTH`].
    #[error("an attribute has from 1 to {MAX_ATTRIBUTE_WIDTH} reals, and {name:?} has {width}")]
    Width {
        /// The name of the attribute.
        name: String,
        /// Its width.
        width: usize,
    },
    /// The memory for the field on the lattice (4 bytes a point) is not to be had.
    #[error("there is no memory for the field at {points} lattice points")]
    Memory {
        /// The points of the lattice.
        points: usize,
    },
    /// More vertices than a u32 can number.
    #[error("the mesh would have {vertices} vertices, more than can be numbered in 32 bits")]
    TooManyVertices {
        /// How many there would be.
        vertices: u64,
    },
}

/// Meshes the surface `field = iso` over a lattice.
///
/// Vertices are in the order of their cells (x fastest, then y, then z), and a vertex stays in its closed cell.
///
/// # Errors
/// See [`MeshError`].
pub fn extract<F: Field>(
    field: &F,
    lattice: &Lattice,
    options: &Options,
) -> Result<(Mesh, Report), MeshError<F::Error>> {
    extract_with_progress(field, lattice, options, &mut |_| true)
}

/// As [`extract`]; reports how far it is to a hook, which may cancel.
///
/// The hook is called from worker threads, never twice at once, with ascending fractions from 0 to 1. When it returns false,
/// the work stops soon with [`MeshError::Cancelled`].
///
/// # Errors
/// See [`MeshError`].
pub fn extract_with_progress<F: Field>(
    field: &F,
    lattice: &Lattice,
    options: &Options,
    hook: &mut (dyn FnMut(f32) -> bool + Send),
) -> Result<(Mesh, Report), MeshError<F::Error>> {
    check_options(options)?;
    let progress = Progress::new(hook);
    let grid = sample::sample(field, lattice, options, &progress)?;
    let crossings = crossing::find(&grid);
    let cut_sides = grid.cut_sides();
    let mut report = Report {
        cut_sides,
        field_evaluations: lattice.point_count() as u64,
        crossing_cells: crossings.cell_count(),
        flipped_faces: crossings.flipped_faces,
        ..Report::default()
    };
    let count = crossings.vertex_count;
    if count > u64::from(u32::MAX) {
        return Err(MeshError::TooManyVertices { vertices: count });
    }

    let mut quads = surface::quads(&crossings);
    let mut vertices = vertex::start(&grid, &crossings);
    if cut_sides.any() {
        // Where the lattice cuts the body, a sheet may have lost all of its quads.
        surface::drop_unused(&mut vertices, &mut quads);
    }
    let axes = grid.axes;
    drop((grid.field, crossings));

    report.full_evaluations = vertices.len() as u64;
    let (mut mesh, gradient_evaluations) = vertex::finish(field, &axes, options, vertices, &progress)?;
    report.gradient_evaluations = gradient_evaluations;
    mesh.triangles = surface::triangles(&mesh.positions, &quads);
    drop(quads);
    surface::repair_normals(&mut mesh);
    report.closed = is_closed(mesh.positions.len(), &mesh.triangles);
    progress.finish()?;
    Ok((mesh, report))
}

fn check_options<E: Error + 'static>(options: &Options) -> Result<(), MeshError<E>> {
    let &Options { iso, pulls, brick } = options;
    if !iso.is_finite() {
        return Err(MeshError::Iso { iso });
    }
    if brick == 0 || brick > MAX_BRICK {
        return Err(MeshError::Brick { brick });
    }
    if pulls > MAX_PULLS {
        return Err(MeshError::Pulls { pulls });
    }
    Ok(())
}
