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
//!     bricks = divide the lattice; drop boxes that are inside or outside as a whole         (divide)
//!     field  = evaluate every point of a brick once, also those that bricks share           (brick, sample)
//!     cells  = the cells that the surface crosses, from their eight signs                   (crossing)
//!     faces  = flip the few ambiguous faces that would pinch the mesh                       (crossing, cell)
//!     vertex = mean of its sheet's crossings, pulled onto the surface by Newton's step,
//!              kept off the sides of its cell; normal and attributes                        (vertex, pull)
//!              those at jumps of the field are put where halved edges say                   (vertex/suspect)
//!              those that a crease keeps off the surface are brought onto it                (settle)
//!     quads  = one for each crossed edge, through the four cells around it,
//!              split along its shorter diagonal                                             (surface)
//!     check that the mesh is closed                                                         (check)
//!     search for parts that are too thin for the lattice, and report them                   (thin)
//! ```
//!
//! No point is evaluated twice, and nothing is asked about a box without surface but its range. So time and memory grow with
//! the surface, and not with the lattice: one of 4096^3 cells takes about 16 times as long as one of 1024^3.
//!
//! A cell that two sheets pass through has two vertices (Nielson 2004), so they do not touch there. What remains is a face
//! that both neighbours see twice from one sheet; such a face is resolved the other way, which splits both sheets (after the
//! rule of Wenger 2013, "Isosurfaces", for manifold dual contours). The mesh is closed and manifold wherever the surface stays inside
//! the lattice, for any field, also for one that is noise. The result is the same to the bit for every thread count and
//! every brick size: cells are in Morton order, in which bricks of any power of two stand one after the other.

mod brick;
mod cell;
mod check;
mod crossing;
mod divide;
mod field;
mod lattice;
mod measure;
mod progress;
mod pull;
mod sample;
mod settle;
mod surface;
mod thin;
mod vertex;

use std::error::Error;
use std::fmt;

use jbt_frontend::origin::ModelOrigin;
use jbt_ir::limits::{MAX_ATTRIBUTE_WIDTH, MAX_BRICKS};
use thiserror::Error;

pub use check::{Defect, check_manifold, is_closed};
pub use field::{Field, Work};
pub use lattice::{Lattice, LatticeError};
pub use thin::{MAX_NEAR, ThinReport};

pub(crate) use surface::facet_normal;

use crate::job::{Hook, Job};
use crate::points::Points;

use crossing::Crossings;
use divide::Division;
use progress::Progress;
use vertex::Source;

/// The smallest [`Options::brick`].
pub const MIN_BRICK: usize = 2;
/// The largest [`Options::brick`].
pub const MAX_BRICK: usize = 32;
/// The largest [`Options::pulls`]. Newton's step has converged long before.
pub const MAX_PULLS: usize = 64;

/// How to mesh.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Options {
    /// The surface is where the field has this value. Any finite number.
    pub iso: f32,
    /// Newton steps that pull each vertex onto the surface, 0 to [`MAX_PULLS`]. Each costs a gradient per vertex and about
    /// squares the distance that is left, in units of the radius of curvature; two suffice for a smooth field.
    pub pulls: usize,
    /// Cells along the edge of the bricks at which division ends: a power of two from [`MIN_BRICK`] to [`MAX_BRICK`]. Small ones waste fewer points
    /// far from the surface, large ones fewer calls. It changes what is evaluated, but no bit of the mesh. `None`: 8, or 4 where a point takes
    /// long.
    pub brick: Option<usize>,
    /// Whether to look at every edge of the mesh to say that it is closed. Where no side of the lattice cuts the body it is, by construction.
    pub verify: bool,
    /// Whether to search for parts that are thinner than a cell: see [`Report::thin`]. It takes a field that
    /// knows ranges of boxes, and changes nothing of the mesh.
    pub thin_parts: bool,
}

impl Default for Options {
    /// Iso 0.5, two pulls, bricks as they are best, verified, no search for thin parts.
    fn default() -> Self {
        Options { iso: 0.5, pulls: 2, brick: None, verify: true, thin_parts: false }
    }
}

/// Named reals at each vertex of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Attribute {
    /// The name, as in the model.
    pub name: String,
    /// Reals per vertex, 1 to [`MAX_ATTRIBUTE_WIDTH`].
    pub width: usize,
    /// `width` reals for each vertex, one vertex after the other.
    pub values: Vec<f32>,
}

/// An indexed triangle mesh with normals and attributes.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mesh {
    /// Where positions count from, in the world: the origin of the model, 0 for most. A mesh of a field that
    /// is not a model's counts from 0.
    pub origin: [f64; 3],
    /// One for each vertex, from the origin.
    pub positions: Vec<[f32; 3]>,
    /// One for each vertex, of length 1, away from the inside.
    pub normals: Vec<[f32; 3]>,
    /// Each has values for every vertex.
    pub attributes: Vec<Attribute>,
    /// Three indices of vertices each, counter-clockwise when seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Attribute {
    /// The reals of a vertex. Panics if there is no such vertex.
    #[must_use]
    pub fn at(&self, vertex: usize) -> &[f32] {
        &self.values[vertex * self.width..][..self.width]
    }
}

impl Mesh {
    /// The attribute of this name.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// Linear red, green and blue for each vertex; `None` if the mesh has no attribute `color` of three
    /// reals.
    ///
    /// ```
    /// use jbt::{Compiler, Model, Polygonize, build::point};
    /// let tree = Model::new(point([0, 0, 0], 1).color([1.0, 0.5, 0.0])).check()?;
    /// let mesh = Polygonize::default().mesh(&Compiler::new(), &tree).run()?.mesh;
    /// assert!(mesh.colors().ok_or("no colours")?.iter().all(|&color| color == [1.0, 0.5, 0.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn colors(&self) -> Option<&[[f32; 3]]> {
        let color = self.attribute("color").filter(|color| color.width == 3)?;
        Some(color.values.as_chunks().0)
    }

    /// The positions as points to evaluate.
    #[must_use]
    pub fn points(&self) -> Points {
        let mut points = Points::about(ModelOrigin::new(self.origin));
        self.positions.iter().for_each(|&position| points.push(position));
        points
    }

    /// Whether positions are those of the world.
    #[must_use]
    pub fn is_about_world(&self) -> bool {
        ModelOrigin::new(self.origin).is_world()
    }

    /// Where a vertex is in the world. Panics if there are not as many.
    #[must_use]
    pub fn world(&self, vertex: usize) -> [f64; 3] {
        ModelOrigin::new(self.origin).world(self.positions[vertex].map(f64::from))
    }
}

/// Some of the six sides of a lattice. Prints as `-x +z`, or `none`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sides {
    /// The low sides, at the first corners along x, y and z.
    pub low: [bool; 3],
    /// The high sides.
    pub high: [bool; 3],
}

impl Sides {
    fn add(&mut self, other: Self) {
        for axis in 0..3 {
            self.low[axis] |= other.low[axis];
            self.high[axis] |= other.high[axis];
        }
    }

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
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Report {
    /// Whether every edge has exactly two triangles, in opposite directions. A mesh without triangles is closed. It has been looked at if
    /// [`Options::verify`] said so, and follows from `cut_sides` otherwise.
    pub closed: bool,
    /// The sides of the lattice that cut the body: some lattice point on that side is inside. Without any, the mesh is closed.
    pub cut_sides: Sides,
    /// Boxes whose range was asked, to find the bricks.
    pub boxes: u64,
    /// Those that were dropped because they are inside as a whole.
    pub boxes_inside: u64,
    /// Those that were dropped because they are outside as a whole.
    pub boxes_outside: u64,
    /// Evaluations of primitives that the points of these boxes would have taken, with the rows that matter in the box around each.
    pub evaluations_spared: u64,
    /// Bricks that were left and sampled.
    pub bricks: u64,
    /// Points at which the field alone was evaluated: the lattice points of the bricks, once each.
    pub field_evaluations: u64,
    /// Points at which field and gradient were evaluated: at each vertex once for each pull, and some more for those that a crease keeps off the surface.
    pub gradient_evaluations: u64,
    /// Points at which everything was evaluated: once for each vertex, and once more for those that a crease has kept off
    /// the surface, or that are at a jump.
    pub full_evaluations: u64,
    /// Points at which the field alone was evaluated to find out where it jumps: on crossed edges of cells that
    /// raise suspicion, and at walls.
    pub jump_evaluations: u64,
    /// Vertices at which the field jumps, as at the walls of `within`.
    pub jump_vertices: u64,
    /// Whether cells are shorter than 16 steps of f32 somewhere in the lattice: then vertices of different cells
    /// may coincide.
    pub crowded: bool,
    /// Cells that the surface crosses.
    pub crossing_cells: u64,
    /// Ambiguous faces that were resolved the other way, to keep the mesh manifold.
    pub flipped_faces: u64,
    /// Parts that are thinner than a cell, if [`Options::thin_parts`] said to search for them.
    pub thin: Option<ThinReport>,
}

/// Why there is no mesh. `E` is the error of the field.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MeshError<E: Error + 'static> {
    /// The field could not be evaluated.
    #[error("the field cannot be evaluated")]
    Field(#[source] E),
    /// It was told to stop.
    #[error("meshing was cancelled")]
    Cancelled,
    /// The iso-value is infinite or NaN.
    #[error("the iso-value must be a finite number, and it is {iso}")]
    Iso {
        /// What was asked for.
        iso: f32,
    },
    /// The edge of a brick is no power of two, or not from [`MIN_BRICK`] to [`MAX_BRICK`].
    #[error(
        "the edge of a brick is a power of two from {MIN_BRICK} to {MAX_BRICK}, and {brick} was asked for"
    )]
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
    /// More bricks, or boxes of one larger size, than [`MAX_BRICKS`].
    #[error("the surface passes through more than {limit} bricks of the lattice")]
    TooManyBricks {
        /// How many there may be.
        limit: usize,
    },
    /// The memory for the field at the points of the bricks (4 bytes a point) is not to be had.
    #[error("there is no memory for the field at {points} lattice points")]
    Memory {
        /// How many points there are.
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
/// Vertices are in the order of their cells, which is Morton order (the bits of z, y and x interleaved, that of x lowest); triangles are in the order of the
/// last cell that they touch. A vertex stays within its cell, off its sides; so positions differ, unless
/// [`Report::crowded`] says otherwise.
///
/// # Errors
/// See [`MeshError`].
///
/// # Panics
/// If the field does not keep its promises: that it gives each box a region, and that it is within its ranges.
pub fn extract<'a, F: Field>(
    field: &'a F,
    lattice: &'a Lattice,
    options: &Options,
) -> Job<'a, (Mesh, Report), MeshError<F::Error>> {
    let options = options.clone();
    Job::new(move |hook| extract_hooked(field, lattice, &options, hook, |_| ()))
}

/// As [`extract`], told to a hook. The report is shown before the search for thin parts, when all that the
/// mesh takes has been evaluated.
pub(crate) fn extract_hooked<F: Field>(
    field: &F,
    lattice: &Lattice,
    options: &Options,
    hook: Hook<'_>,
    meshed: impl FnOnce(&Report),
) -> Result<(Mesh, Report), MeshError<F::Error>> {
    check_options(options)?;
    let progress = Progress::new(hook);
    let division = divide::divide(field, lattice.axes(), options, MAX_BRICKS, &progress)?;
    let (mesh, mut report, crossings) = polygonize(field, &division, options, &progress)?;
    meshed(&report);
    if options.thin_parts {
        report.thin = Some(thin::find(field, &division, (&crossings, &mesh), options.iso, &progress)?);
    }
    drop((division, crossings));
    report.closed = if options.verify {
        is_closed(mesh.positions.len(), &mesh.triangles)
    } else {
        !report.cut_sides.any()
    };
    progress.finish()?;
    Ok((mesh, report))
}

/// Meshes the bricks of a lattice.
fn polygonize<F: Field>(
    field: &F,
    division: &Division<F::Region>,
    options: &Options,
    progress: &Progress<'_>,
) -> Result<(Mesh, Report, Crossings), MeshError<F::Error>> {
    let Division { bricks, regions, boxes, chunks: _ } = division;
    let samples = sample::sample(field, bricks, regions, progress)?;
    let mut crossings = crossing::find(bricks, &samples, options.iso);
    let field_evaluations = samples.len() as u64;
    drop(samples);
    let count = crossings.vertex_count();
    if u32::try_from(count).is_err() {
        return Err(MeshError::TooManyVertices { vertices: count as u64 });
    }
    let source = Source { field, options, bricks, regions, crossings: &crossings };
    let (mut mesh, done) = vertex::finish(&source, progress)?;
    let mut report = Report {
        cut_sides: crossings.cut,
        boxes: boxes.examined,
        boxes_inside: boxes.inside,
        boxes_outside: boxes.outside,
        evaluations_spared: boxes.spared,
        bricks: bricks.len() as u64,
        field_evaluations,
        gradient_evaluations: done.gradient_evaluations,
        full_evaluations: done.full_evaluations,
        jump_evaluations: done.jump_evaluations,
        jump_vertices: done.jump_vertices,
        crowded: vertex::is_crowded(&bricks.axes),
        crossing_cells: crossings.cells.len() as u64,
        flipped_faces: crossings.flipped_faces,
        closed: false,
        thin: None,
    };
    report.cut_sides.add(boxes.cut);
    crossings.corners = Vec::new();
    mesh.triangles = surface::triangles(bricks, &crossings, &mesh.positions);
    surface::repair_normals(&mut mesh, bricks, &crossings, &done.doubtful);
    Ok((mesh, report, crossings))
}

fn check_options<E: Error + 'static>(options: &Options) -> Result<(), MeshError<E>> {
    let &Options { iso, pulls, brick, verify: _, thin_parts: _ } = options;
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
