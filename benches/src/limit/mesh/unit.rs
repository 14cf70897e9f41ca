//! A unit of bricks: culls its blobs down to each brick, and makes the vertices of those that the surface
//! crosses.

use crate::limit::dense::Row;
use crate::limit::vector::dispatch;

use super::brick::{Brick, Flips, find};
use super::cull::{Bounds, Candidates, Cull};
use super::finish::{Finish, Starts, Vertices};
use super::sample::{CORNERS, Sample, Samples};
use super::scene::{BRICK, Scene, UNIT};

/// What became of a unit.
pub(super) struct Unit {
    /// The bricks that the surface crosses.
    pub(super) bricks: Vec<Brick>,
    /// Their vertices.
    pub(super) vertices: Vertices,
    /// Cells with a face, on their low side, that is pinched in them.
    pub(super) suspects: Vec<[usize; 3]>,
    /// Bricks that were sampled.
    pub(super) sampled: u64,
    /// Fields of one blob at one corner.
    pub(super) field_evaluations: u64,
}

/// What is reused from brick to brick.
struct Scratch {
    rows: Vec<Row>,
    samples: Samples,
    starts: Starts,
}

impl Scratch {
    fn new() -> Self {
        Self { rows: Vec::new(), samples: Samples::new(), starts: Starts::new() }
    }
}

/// Room for the vertices of most units.
const EXPECTED_VERTICES: usize = 8 * 1024;

/// Makes the unit at a place among the units.
pub(super) fn make(scene: &Scene, place: [usize; 3]) -> Unit {
    let mut unit = Unit {
        bricks: Vec::new(),
        vertices: Vertices::with_capacity(EXPECTED_VERTICES),
        suspects: Vec::new(),
        sampled: 0,
        field_evaluations: 0,
    };
    let mut levels = vec![Candidates::default(); UNIT.ilog2() as usize + 1];
    divide(
        scene,
        place.map(|index| index * UNIT),
        UNIT,
        &scene.all,
        &mut levels,
        &mut unit,
        &mut Scratch::new(),
    );
    unit
}

/// Divides a cube of `size` bricks along each axis into eight, as long as the surface may be in it. (Two
/// levels deep.)
fn divide(
    scene: &Scene,
    place: [usize; 3],
    size: usize,
    from: &Candidates,
    levels: &mut [Candidates],
    unit: &mut Unit,
    scratch: &mut Scratch,
) {
    if (0..3).any(|axis| place[axis] >= scene.bricks[axis]) {
        return;
    }
    let Some((to, rest)) = levels.split_first_mut() else { return };
    let bounds = cull(scene, place, size, from, to);
    if bounds.upper < scene.iso || bounds.lower >= scene.iso {
        return;
    }
    if size == 1 {
        make_brick(scene, place, to, unit, scratch);
        return;
    }
    let half = size / 2;
    for child in 0..8 {
        let place = [0, 1, 2].map(|axis| place[axis] + half * (child >> axis & 1));
        divide(scene, place, half, to, rest, unit, scratch);
    }
}

/// The blobs that reach a cube of bricks, and bounds of the field in it.
fn cull(scene: &Scene, place: [usize; 3], size: usize, from: &Candidates, to: &mut Candidates) -> Bounds {
    let corner = |bricks: usize| {
        [0, 1, 2].map(|axis| scene.axes[axis][((place[axis] + bricks) * BRICK).min(scene.cells[axis])])
    };
    dispatch(Cull { from, to, low: corner(0), high: corner(size) })
}

fn make_brick(
    scene: &Scene,
    place: [usize; 3],
    candidates: &Candidates,
    unit: &mut Unit,
    scratch: &mut Scratch,
) {
    sample(scene, place, candidates, scratch);
    unit.sampled += 1;
    unit.field_evaluations += (scratch.rows.len() * CORNERS.pow(3)) as u64;
    if !scratch.samples.is_crossed() {
        return;
    }
    let Scratch { rows, samples, starts } = scratch;
    starts.clear();
    let first = unit.vertices.len() as u32;
    unit.bricks.push(Brick::new(place, first));
    let Some(brick) = unit.bricks.last_mut() else { return };
    find(scene, samples, &Flips::new(), brick, starts, &mut unit.suspects);
    dispatch(Finish { rows, iso: scene.iso, starts, vertices: &mut unit.vertices });
}

/// Samples a brick, with the rows of these candidates.
fn sample(scene: &Scene, place: [usize; 3], candidates: &Candidates, scratch: &mut Scratch) {
    let Scratch { rows, samples, .. } = scratch;
    rows.clear();
    rows.extend(candidates.indices.iter().map(|&index| scene.rows[index as usize]));
    let axes = [0, 1, 2].map(|axis| {
        let (first, last) = (place[axis] * BRICK, scene.cells[axis]);
        std::array::from_fn(|n| scene.axes[axis][(first + n).min(last)])
    });
    dispatch(Sample { rows, axes, iso: scene.iso, samples });
}

/// Makes a brick of a unit again, with flipped faces.
pub(super) fn remake(scene: &Scene, unit: &mut Unit, index: usize, flips: &Flips) {
    let mut scratch = Scratch::new();
    let mut candidates = Candidates::default();
    let place = unit.bricks[index].place;
    cull(scene, place, 1, &scene.all, &mut candidates);
    sample(scene, place, &candidates, &mut scratch);
    let Scratch { rows, samples, starts } = &mut scratch;
    find(scene, samples, flips, &mut unit.bricks[index], starts, &mut Vec::new());
    let mut vertices = Vertices::default();
    dispatch(Finish { rows, iso: scene.iso, starts, vertices: &mut vertices });
    let first = unit.bricks[index].first as usize;
    let next = unit.bricks.get(index + 1).map_or(unit.vertices.len(), |brick| brick.first as usize);
    let more = vertices.len() - (next - first);
    unit.vertices.replace(first..next, vertices);
    for brick in &mut unit.bricks[index + 1..] {
        brick.first += more as u32;
    }
}
