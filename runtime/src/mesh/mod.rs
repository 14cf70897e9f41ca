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
//!              those on edges and corners of the surface are put there                      (vertex/sharp)
//!     fold   = vertices on edges of the surface go back where triangles would be folded     (fold)
//!     quads  = one for each crossed edge, through the four cells around it,
//!              split along its shorter diagonal                                             (surface)
//!     check that the mesh is closed                                                         (check)
//!     search for parts that are too thin for the lattice, and report them                   (thin)
//! ```
//!
//! No point is evaluated twice, and of a box without surface only the range is computed. So time and memory
//! grow with the surface, not with the lattice: a lattice of 4096^3 cells takes about 16 times as long as one
//! of 1024^3.
//!
//! A cell that two sheets pass through has two vertices (Nielson 2004), so the sheets do not touch there. One
//! case remains: a face that is pinched in both of its cells. Such a face is flipped, which splits both
//! sheets (after the rule of Wenger 2013, "Isosurfaces", for manifold dual contours). The mesh is closed and
//! manifold wherever the surface stays inside the lattice, for any field, even noise. The result is the same
//! to the bit for every thread count and every brick size: cells are in Morton order, in which bricks of any
//! power of two follow one after the other.

mod area;
mod block;
mod brick;
mod cell;
mod check;
mod components;
mod crease;
mod crossing;
mod divide;
mod doubtful;
mod error;
mod field;
mod fill;
mod fold;
mod indexed;
mod lattice;
pub(crate) mod local;
mod measure;
mod options;
mod parts;
mod pull;
mod report;
mod sample;
mod scope;
#[cfg(feature = "simplify")]
mod simplify;
mod stage;
mod surface;
#[cfg(test)]
mod testing;
mod thin;
mod vertex;

pub use block::{BlockError, BlockWork, LatticeBlock, MeshBlock, VertexName, join_blocks};
pub use check::{Defect, check_manifold, is_closed};
pub use components::MeshComponent;
pub use error::{MAX_BRICK, MAX_PULLS, MIN_BRICK, MeshError};
pub use field::{Field, FieldWork};
pub use indexed::{Attribute, Creases, Mesh, MeshPart};
pub use lattice::{Lattice, LatticeError};
pub use options::Options;
pub use parts::MeshPiece;
pub use report::{MAX_NEAR, MeshReport, Sides, ThinReport};
#[cfg(feature = "simplify")]
pub use simplify::Simplify;

#[cfg(feature = "export")]
pub(crate) use area::{area_vector, unit};
pub(crate) use block::{busy, extract as extract_block};
pub(crate) use fill::room;

use crate::job::{Hook, Job};
use crate::parallel::{join, scatter};
use crate::progress::{EACH, Progress};

use crossing::Crossings;
use divide::{BrickDivision, BrickLimits};
use doubtful::VertexSet;
use fold::{SharpQuad, SideCorner};
use sample::BrickSamples;
use scope::DivisionScope;
use vertex::batch::VertexSource;
use vertex::side::SharpVertex;

/// Meshes the surface `field = iso` over a lattice.
///
/// Vertices are in the order of their cells, which is Morton order (the bits of z, y and x interleaved, x
/// lowest); triangles are in the order of the last cell that they touch. A vertex stays within its cell, off
/// its sides; so positions differ, unless [`MeshReport::crowded`] is set. One on an edge of the surface may
/// be a little beside its cell.
///
/// # Errors
/// See [`MeshError`].
///
/// # Panics
/// If the field breaks a promise: a region for each box, or a value within its range.
pub fn extract<'a, F: Field>(
    field: &'a F,
    lattice: &'a Lattice,
    options: &Options,
) -> Job<'a, (Mesh, MeshReport), MeshError<F::Error>> {
    let options = options.clone();
    Job::new(move |hook| extract_hooked(field, lattice, &options, hook, (|| Ok(()), |_| ())))
}

/// As [`extract`], with a hook. Whoever is idle while the cells are found prepares what vertices ask of the
/// field. The last function gets the report before the search for thin parts, when the mesh is complete.
pub(crate) fn extract_hooked<F: Field, E: From<MeshError<F::Error>> + Send>(
    field: &F,
    lattice: &Lattice,
    options: &Options,
    hook: Hook<'_>,
    (prepare_vertices, meshed): (impl FnOnce() -> Result<(), E> + Send, impl FnOnce(&MeshReport)),
) -> Result<(Mesh, MeshReport), E> {
    options.check()?;
    let progress = Progress::new(hook, EACH);
    let (found, prepared) = scatter(|watches| {
        let find = || FoundSurface::new(field, lattice, options, &progress);
        join(|| watches.hold(find), || watches.hold(prepare_vertices))
    });
    prepared?;
    Ok(finish(field, found?, options, &progress, meshed)?)
}

/// The cells that the surface crosses, and what found them.
struct FoundSurface<R> {
    division: BrickDivision<R>,
    samples: BrickSamples,
    crossings: Crossings,
}

impl<R: Send + Sync> FoundSurface<R> {
    fn new<F: Field<Region = R>>(
        field: &F,
        lattice: &Lattice,
        options: &Options,
        progress: &Progress<'_>,
    ) -> Result<Self, MeshError<F::Error>> {
        let scope = (options, DivisionScope::Everything);
        let division = divide::divide(field, lattice.axes(), scope, BrickLimits::WHOLE, progress)?;
        let BrickDivision { bricks, regions, .. } = &division;
        let mut samples = sample::sample(field, (bricks, regions), (options.iso, None), progress)?;
        let crossings = crossing::find(bricks, &samples, progress)?;
        samples.forget_inside();
        Ok(Self { division, samples, crossings })
    }
}

/// The mesh of a surface that has been found.
fn finish<F: Field>(
    field: &F,
    FoundSurface { mut division, samples, crossings }: FoundSurface<F::Region>,
    options: &Options,
    progress: &Progress<'_>,
    meshed: impl FnOnce(&MeshReport),
) -> Result<(Mesh, MeshReport), MeshError<F::Error>> {
    let Polygons { mesh, mut report, sharp } =
        polygonize(field, (&mut division, samples, &crossings), options, progress)?;
    meshed(&report);
    if options.thin_parts {
        report.thin = Some(thin::find(field, &division, (&crossings, &mesh, &sharp), options.iso, progress)?);
    }
    drop((division, crossings, sharp));
    // Otherwise it is known by construction.
    if options.verify {
        report.closed = check::are_closed(mesh.positions.len(), &mesh.triangles, || progress.breathe())?;
    }
    progress.finish()?;
    Ok((mesh, report))
}

/// Lets sharp vertices go back where triangles would be folded.
fn go_back<E: Send>(
    mesh: &mut Mesh,
    quads: &[SharpQuad],
    sharp: &[SharpVertex],
    go_on: impl Fn() -> Result<(), E> + Sync,
) -> Result<(), E> {
    let positions = &mesh.positions;
    let moved = fold::unfolded(quads, sharp, |vertex| positions[vertex as usize], go_on)?;
    for (place, position) in moved {
        mesh.positions[sharp[place as usize].vertex as usize] = position;
    }
    Ok(())
}

/// The sides of vertices, and the corners that show them.
fn creases(mesh: &Mesh, sharp: &[SharpVertex], corners: &[SideCorner]) -> Creases {
    let widths: Vec<usize> = mesh.attributes.iter().map(|attribute| attribute.width).collect();
    let (mut creases, mut first) = (Creases::default(), Vec::with_capacity(sharp.len()));
    for vertex in sharp {
        first.push(creases.vertices.len());
        creases.push(vertex.vertex, vertex, &widths);
    }
    let corner = |of: &SideCorner| [of.corner, (first[of.sharp] + of.side) as u32];
    creases.corners = corners.iter().map(corner).collect();
    creases
}

/// A mesh, and what the search for thin parts asks.
struct Polygons {
    mesh: Mesh,
    report: MeshReport,
    sharp: Vec<SharpVertex>,
}

/// Makes vertices and triangles.
fn polygonize<F: Field>(
    field: &F,
    (division, samples, crossings): (&mut BrickDivision<F::Region>, BrickSamples, &Crossings),
    options: &Options,
    progress: &Progress<'_>,
) -> Result<Polygons, MeshError<F::Error>> {
    let BrickDivision { bricks, regions, boxes, chunks: _ } = division;
    let field_evaluations = samples.len() as u64;
    let count = crossings.vertex_count();
    let source = VertexSource { field, options, bricks, regions, samples: &samples, crossings };
    let (mut mesh, done) = vertex::finish(&source, progress)?;
    let room = surface::room(crossings, samples)?;
    let mut report = MeshReport {
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
        sharp_vertices: done.sharp.len() as u64,
        crossing_cells: crossings.cells.len() as u64,
        flipped_faces: crossings.flipped_faces,
        closed: !crossings.is_open,
        thin: None,
    };
    report.cut_sides.add(boxes.cut);
    let (of, go_on) = ((&*bricks, crossings), || progress.breathe());
    let quads = fold::sharp_quads(of, &done.sharp, [0; 3], go_on)?;
    go_back(&mut mesh, &quads, &done.sharp, go_on)?;
    let doubtful = VertexSet::new(0, count, done.doubtful.iter().copied());
    let mut around;
    (mesh.triangles, around) = surface::triangles(of, room, (&mesh.positions, &doubtful), go_on)?;
    let corners = fold::crease(&quads, &done.sharp, &mesh.positions, &mut mesh.triangles, go_on)?;
    mesh.creases = creases(&mesh, &done.sharp, &corners);
    // Regions are many small things, and only the search for thin parts has another look at them.
    let done_with = if options.thin_parts { Vec::new() } else { std::mem::take(regions) };
    let repair = || {
        let anew = quads.iter().map(SharpQuad::number);
        doubtful::repair_normals(&mut mesh, &doubtful, &mut around, anew, progress)
    };
    let (repaired, ()) = scatter(|watches| join(|| watches.hold(repair), || drop(done_with)));
    repaired?;
    Ok(Polygons { mesh, report, sharp: done.sharp })
}
