//! The place of a vertex that aims at a corner or an edge: in its cell, or close beside it.
//!
//! ```text
//!     +-------+-------+
//!     |   .   |       |     The tip pokes through one side of an edge of the lattice, and no corner of the
//!     |  / \  |       |     upper cell is inside. So the vertex of the cell below goes a little beyond
//!     +-x---x-+-------+     its cell. Vertices of cells along an edge of the surface keep their order
//!     |/     \|       |     there, each at the point that is nearest to its mean. A corner has one vertex:
//!     +-------+-------+     of the cell that it is in, or, if no surface goes through that by its signs, of
//!                           the one whose face is nearest. Others are on an edge.
//! ```

use super::super::super::brick::{Bricks, box_of, place as place_of};
use super::super::super::cell::EDGE_CORNERS;
use super::super::super::field::Field;
use super::super::batch::{VertexBatch, VertexSource};
use super::super::bracket::BracketPoints;
use super::super::margin::room;
use super::candidate::{Candidate, clamped};
use super::crossing::dot;
use super::quadric::EdgeAim;
use crate::boxes::Box3;

/// A vertex that would be in the cell beyond a face.
struct Claim {
    candidate: usize,
    face: usize,
    position: [f32; 3],
    /// That cell.
    bounds: Box3,
    /// The corners of it away from the face.
    corners: [[f32; 3]; 4],
}

/// Places the candidates; those without an aim go. Returns the region around the brick, if it was needed.
pub(super) fn place<F: Field>(
    source: &VertexSource<'_, F>,
    brick: usize,
    batch: &VertexBatch,
    candidates: &mut Vec<Candidate<'_>>,
) -> Result<Option<F::Region>, F::Error> {
    let mut aims = Vec::with_capacity(candidates.len());
    candidates.retain(|one| one.aim().map(|aim| aims.push(aim)).is_some());
    let mut claims = Vec::new();
    for (n, (one, aim)) in candidates.iter_mut().zip(aims).enumerate() {
        let bounds = batch.bounds(one.sheet.start.vertex);
        if let Some(point) = aim.within(bounds) {
            one.put(clamped(point, bounds), bounds);
            continue;
        }
        let edges = if let EdgeAim::Point(_) = aim {
            claims.extend(claim(source, brick, n, one, aim));
            one.edges()
        } else {
            vec![aim]
        };
        let near = beside(&source.bricks.axes, one.sheet.cell);
        let first = |bounds: Box3| {
            edges.iter().find_map(|edge| edge.within(bounds)).map(|point| clamped(point, bounds))
        };
        let reached = first(bounds);
        let beyond = if reached.is_none() { first(near) } else { None };
        one.is_beyond = beyond.is_some();
        one.is_off_edge = reached.or(beyond).is_none();
        let nearest = || clamped(edges.first().unwrap_or(&aim).point(), bounds);
        let home = if one.is_beyond { near } else { bounds };
        one.put(reached.or(beyond).unwrap_or_else(nearest), home);
    }
    if claims.is_empty() && !candidates.iter().any(|one| one.is_beyond || one.is_at_jump()) {
        return Ok(None);
    }
    let around = around(source.bricks, brick);
    let region = source.field.region(around)?;
    let mut points = BracketPoints::default();
    let corners = claims.iter().flat_map(|claim| claim.corners);
    let values = points.ask(source.field, &region, corners)?;
    for (claim, values) in claims.iter().zip(values.as_chunks::<4>().0) {
        let one = &mut candidates[claim.candidate];
        let inside = is_inside(one, claim.face);
        if values.iter().all(|&value| (value >= source.options.iso) == inside) {
            one.put(claim.position, claim.bounds);
            (one.is_beyond, one.is_off_edge) = (true, false);
        }
    }
    Ok(Some(region))
}

/// How far a vertex may go beyond its cell, in cells. Found by trial, before vertices [went
/// back](super::super::super::fold): of the triangles of 24 turned cubes 58 are folded without edges, 32 with
/// 0.5, and 29 with 0.6 to 1.
const BEYOND: f32 = 0.6;

/// A cell and what is around it, as far as the lattice goes.
fn beside(axes: &[Vec<f32>; 3], Box3 { low, high }: Box3) -> Box3 {
    let sides = [0, 1, 2].map(|axis| {
        let more = BEYOND * high[axis] - BEYOND * low[axis];
        let [first, last] = room([axes[axis][0], axes[axis][axes[axis].len() - 1]]);
        [(low[axis] - more).max(first), (high[axis] + more).min(last)]
    });
    Box3::new(sides.map(|side| side[0]), sides.map(|side| side[1]))
}

/// Whether the corners of a face of the candidate's cell are inside; all of them are on one side.
fn is_inside(one: &Candidate<'_>, face: usize) -> bool {
    let corner = (face & 1) << (face / 2);
    one.sheet.signs >> corner & 1 == 1
}

/// The claim of a vertex on a cell beside its own: the one beyond a face without crossings where what it aims
/// at is nearest to its mean. Of several cells that aim at one corner, the one has it whose face is nearest.
fn claim<F: Field>(
    source: &VertexSource<'_, F>,
    brick: usize,
    candidate: usize,
    one: &Candidate<'_>,
    aim: EdgeAim,
) -> Option<Claim> {
    let bricks = source.bricks;
    let (origin, place) = (bricks.origin(brick), place_of(one.sheet.number));
    let cell = [0, 1, 2].map(|axis| origin[axis] + place[axis]);
    let mut best: Option<(f64, Claim)> = None;
    for face in 0..6 {
        let (axis, side) = (face / 2, face & 1);
        let beyond = if side == 1 { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
        if beyond >= bricks.axes[axis].len() - 1 || crosses(one.sheet.signs, face) {
            continue;
        }
        let mut other = cell;
        other[axis] = beyond;
        let ends = [0, 1, 2].map(|axis| {
            let axis_of = &bricks.axes[axis];
            [axis_of[other[axis]], axis_of[other[axis] + 1]]
        });
        let rooms = ends.map(room);
        let bounds = Box3::new(rooms.map(|room| room[0]), rooms.map(|room| room[1]));
        let Some(point) = aim.within(bounds) else { continue };
        if matches!(aim, EdgeAim::Point(_)) && !is_nearest(point, ends, face) {
            continue;
        }
        let way = [0, 1, 2].map(|axis| point[axis] - one.mean[axis]);
        let far = ends[axis][side];
        let corner = |n: usize| {
            let mut corner = [0.0; 3];
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            (corner[axis], corner[b], corner[c]) = (far, ends[b][n & 1], ends[c][n >> 1]);
            corner
        };
        let position = clamped(point, bounds);
        let made = Claim { candidate, face, position, bounds, corners: std::array::from_fn(corner) };
        let distance = dot(way, way);
        if best.as_ref().is_none_or(|(least, _)| distance < *least) {
            best = Some((distance, made));
        }
    }
    best.map(|(_, claim)| claim)
}

/// Whether an edge of a face is crossed.
fn crosses(signs: u8, face: usize) -> bool {
    let on_face = |corner: usize| corner >> (face / 2) & 1 == face & 1;
    EDGE_CORNERS
        .iter()
        .any(|&[low, high]| on_face(low) && on_face(high) && (signs >> low ^ signs >> high) & 1 == 1)
}

/// Whether the near face of a cell is the nearest one to a point in it. `face` is its number from before it.
fn is_nearest(point: [f64; 3], ends: [[f32; 2]; 3], face: usize) -> bool {
    let distance = |axis: usize, side: usize| (point[axis] - f64::from(ends[axis][side])).abs();
    let near = distance(face / 2, 1 - (face & 1));
    (0..6).all(|other| near <= distance(other / 2, other & 1))
}

/// The box of a brick and the cells around it.
fn around(bricks: &Bricks, brick: usize) -> Box3 {
    let (origin, extent) = (bricks.origin(brick), bricks.extent(brick));
    let first = origin.map(|cell| cell.saturating_sub(1));
    box_of(&bricks.axes, first, [0, 1, 2].map(|axis| origin[axis] + extent[axis] + 1))
}

/// The candidates at whose places the field is as near to the iso-value as at their means, or nearer. At a
/// jump the value tells nothing: there the place is kept if the surface goes through between two points, a
/// little outside and inside of it.
pub(super) fn nearer<'a, F: Field>(
    field: &F,
    (region, bricks): (&F::Region, &Bricks),
    iso: f32,
    candidates: Vec<Candidate<'a>>,
) -> Result<Vec<Candidate<'a>>, F::Error> {
    let mut points = BracketPoints::default();
    let both = candidates.iter().flat_map(|one| {
        if one.is_at_jump() { one.across(bricks) } else { [one.position, one.mean.map(|c| c as f32)] }
    });
    let values = points.ask(field, region, both)?;
    let away = |value: f32| (value - iso).abs();
    let kept = candidates.into_iter().zip(values.as_chunks::<2>().0).filter(|(one, [here, other])| {
        if one.is_at_jump() { *here < iso && *other >= iso } else { away(*here) <= away(*other) }
    });
    Ok(kept.map(|(one, _)| one).collect())
}
