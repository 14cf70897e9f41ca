//! A mesh that is kept brick by brick, and of which bricks are made again where the field has changed.
//!
//! ```text
//! renewal:  division of the touched boxes ► field at their points ► crossed cells     as for any mesh, of fewer bricks
//!           faces are flipped anew along chains of pinched faces that touch them       (flips)
//!           vertices of these bricks, and of others with another flip
//! commit:   vertices go to the slots of their bricks                                   (commit, slots)
//!           triangles of bricks with other vertices, and of those just above them      (join)
//!           doubtful normals of bricks with other triangles, and of those just below   (join)
//! ```
//!
//! How far the field at a point reaches:
//!
//! | part of the mesh | what it depends on |
//! |---|---|
//! | crossed cells | the field in the closed box of their brick |
//! | flips of faces | the crossed cells, along a chain of faces that are pinched in both of their cells |
//! | vertices, attributes | the field in the closed box of their brick, and flips of their own cell |
//! | triangles | vertices of their brick and of the seven bricks below |
//! | normals that triangles decide | triangles of their brick and of the seven bricks above |
//!
//! Everything that may fail is in the renewal, which changes nothing; the commit cannot fail.

mod commit;
mod compact;
mod flips;
mod join;
mod slots;

use jbt_ir::limits::MAX_BRICKS;
use rustc_hash::FxHashMap;

use super::brick::{Bricks, NONE, direction, morton};
use super::crossing::{self, CrossedCell, Crossings};
use super::divide::{self, BrickDivision};
use super::error::MeshError;
use super::field::Field;
use super::indexed::Mesh;
use super::lattice::Lattice;
use super::options::Options;
use super::sample;
pub(crate) use super::touched::Touched;
use super::vertex;
use super::vertex::batch::VertexSource;
use crate::boxes::Box3;
use crate::job::Hook;
use crate::progress::{EACH, Progress};

pub(crate) use commit::BrickChanges;
use flips::Chain;
use slots::{Slot, Slots};

/// The place of a brick in units of bricks, counted from the lattice's anchor.
pub(crate) type BrickPlace = [i32; 3];

/// A brick that the surface crosses.
struct KeptBrick {
    cells: Vec<CrossedCell>,
    /// The cells with a low face that is pinched by default, ascending.
    suspects: Vec<u32>,
    /// The number of quads that belong to its cells.
    quads: usize,
    /// In the buffers of vertices.
    vertices: Slot,
    /// In the buffer of triangles.
    triangles: Slot,
    /// Vertices whose normals are compared with their triangles, counted from the first one, and their
    /// normals before that.
    doubtful: Vec<(u32, [f32; 3])>,
}

/// A mesh by bricks.
pub(crate) struct BrickMesh {
    lattice: Lattice,
    /// Cells along the edge of a brick; 0 before there is any.
    edge: usize,
    bricks: FxHashMap<BrickPlace, KeptBrick>,
    /// Positions, normals, attributes and triangles of all bricks in their slots. Triangles that are in no
    /// slot, or in the unused end of one, are `[0, 0, 0]`.
    buffers: Mesh,
    vertex_slots: Slots,
    triangle_slots: Slots,
}

/// Bricks that were made anew, before they take the places of old ones.
pub(crate) struct Renewal {
    lattice: Lattice,
    bricks: Bricks,
    crossings: Crossings,
    /// For each brick, the cells with a low face that is pinched by default.
    suspects: Vec<Vec<u32>>,
    /// Vertices, with their first normals.
    mesh: Mesh,
    /// Of the mesh, ascending.
    doubtful: Vec<u32>,
    /// The bricks that may be made anew, in units of bricks from the first one; `None` for all.
    touched: Option<Touched>,
}

impl BrickMesh {
    /// No bricks, of a lattice.
    pub(crate) fn new(lattice: Lattice, origin: [f64; 3]) -> Self {
        Self {
            lattice,
            edge: 0,
            bricks: FxHashMap::default(),
            buffers: Mesh { origin, ..Mesh::default() },
            vertex_slots: Slots::default(),
            triangle_slots: Slots::default(),
        }
    }

    pub(crate) fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// The buffers: see the fields.
    pub(crate) fn buffers(&self) -> &Mesh {
        &self.buffers
    }

    /// The number of bricks that the surface crosses.
    pub(crate) fn len(&self) -> usize {
        self.bricks.len()
    }

    /// The bricks of a lattice that boxes meet; `None` if that is best said as everywhere.
    pub(crate) fn touched(&self, lattice: &Lattice, boxes: &[Box3]) -> Option<Touched> {
        if self.edge == 0 { None } else { Touched::by(&lattice.axes(), self.edge, boxes) }
    }

    /// Makes bricks anew: those that are touched, or all. The lattice is the present one or a grown one.
    pub(crate) fn renewal<F: Field>(
        &self,
        field: &F,
        lattice: &Lattice,
        (options, touched): (&Options, Option<Touched>),
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
            let division = divide::divide(field, axes, (&options, touched.as_ref()), MAX_BRICKS, &progress)?;
            let BrickDivision { bricks, regions, boxes: _, chunks: _ } = division;
            let samples = sample::sample(field, &bricks, &regions, &progress)?;
            let mut found = crossing::look(&bricks, &samples, options.iso);
            drop(samples);
            let flipped = match &mut touched {
                None => crossing::flip(&bricks, &found.starts, &mut found.cells, &found.suspects),
                Some(touched) => {
                    let chain = Chain { mesh: self, lattice, bricks: &bricks, touched };
                    let others = chain.flip(&mut found);
                    if !others.is_empty() {
                        // Rare: their vertices need the field again.
                        others.into_iter().for_each(|place| touched.add(place));
                        continue;
                    }
                    0
                }
            };
            let suspects = suspects(bricks.len(), &found.starts, &found.suspects);
            let crossings = found.numbered(&bricks, flipped);
            self.check_limits(&bricks, &crossings, touched.as_ref())?;
            let source = VertexSource {
                field,
                options: &options,
                bricks: &bricks,
                regions: &regions,
                crossings: &crossings,
            };
            let (mesh, done) = vertex::finish(&source, &progress)?;
            progress.finish()?;
            let (lattice, doubtful) = (lattice.clone(), done.doubtful);
            return Ok(Renewal { lattice, bricks, crossings, suspects, mesh, doubtful, touched });
        }
    }

    /// Whether the numbers of bricks and vertices stay within their limits.
    fn check_limits<E: std::error::Error + 'static>(
        &self,
        bricks: &Bricks,
        crossings: &Crossings,
        touched: Option<&Touched>,
    ) -> Result<(), MeshError<E>> {
        let kept = if touched.is_some() { self.bricks.len() } else { 0 };
        if kept + bricks.len() > MAX_BRICKS {
            return Err(MeshError::TooManyBricks { limit: MAX_BRICKS });
        }
        // Slots are at most half as large again as what is in them, and those of the largest class no less.
        let vertices = self.vertex_slots.end() as u64 + 2 * crossings.vertex_count() as u64;
        let triangles = self.triangle_slots.end() as u64 + 4 * crossings.quad_count() as u64;
        if vertices.max(triangles) + 64 * bricks.len() as u64 > u64::from(u32::MAX) {
            return Err(MeshError::TooManyVertices { vertices });
        }
        Ok(())
    }

    /// The bricks of a lattice from its first brick to its anchor.
    fn shift(lattice: &Lattice, edge: usize) -> [i32; 3] {
        lattice.first().map(|first| (first / edge.max(1) as i64) as i32)
    }

    /// All bricks in Morton order.
    pub(crate) fn places(&self) -> Vec<BrickPlace> {
        self.in_order(self.bricks.keys().copied()).into_iter().map(|(_, place)| place).collect()
    }

    /// Bricks in Morton order, as places from the lattice's first brick and from its anchor.
    fn in_order(&self, places: impl Iterator<Item = BrickPlace>) -> Vec<([u32; 3], BrickPlace)> {
        let shift = Self::shift(&self.lattice, self.edge);
        let from_first = |place: BrickPlace| [0, 1, 2].map(|axis| (place[axis] - shift[axis]) as u32);
        let mut places: Vec<_> = places.map(|place| (from_first(place), place)).collect();
        places.sort_unstable_by_key(|&(place, _)| morton(place));
        places
    }
}

/// The suspects of each brick, counted from its first cell.
fn suspects(bricks: usize, starts: &[usize], all: &[(usize, usize)]) -> Vec<Vec<u32>> {
    let mut suspects = vec![Vec::new(); bricks];
    all.iter().for_each(|&(brick, cell)| suspects[brick].push((cell - starts[brick]) as u32));
    suspects
}

/// Bricks in these places, in Morton order, with those of their neighbours that are below them along some
/// axes and beside them along none: all that flips and triangles ask for.
fn linked(edge: usize, axes: [Vec<f32>; 3], places: Vec<[u32; 3]>) -> Bricks {
    let numbers: FxHashMap<[u32; 3], u32> =
        (0..).zip(&places).map(|(number, &place)| (place, number)).collect();
    let below = |&place: &[u32; 3]| {
        let mut neighbours = [NONE; 27];
        for axes in 0..8 {
            let steps = [0, 1, 2].map(|axis| -i8::from(axes >> axis & 1 == 1));
            let other = [0, 1, 2].map(|axis| place[axis].wrapping_add_signed(steps[axis].into()));
            neighbours[direction(steps)] = numbers.get(&other).copied().unwrap_or(NONE);
        }
        neighbours
    };
    let neighbours = places.iter().map(below).collect();
    Bricks::new(edge, axes, places, neighbours)
}

/// The place some bricks further.
fn beside(place: BrickPlace, steps: [i32; 3]) -> BrickPlace {
    [0, 1, 2].map(|axis| place[axis] + steps[axis])
}

/// A brick, and the seven that are above it (`1`) or below it (`-1`) along some axes.
fn octet(place: BrickPlace, side: i32) -> impl Iterator<Item = BrickPlace> {
    (0..8).map(move |axes: i32| beside(place, [0, 1, 2].map(|axis| side * (axes >> axis & 1))))
}
