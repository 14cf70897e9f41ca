//! The place of a vertex that aims at a corner or an edge: in its cell, or close beside it.
//!
//! ```text
//!     +-------+-------+
//!     |   .   |       |     The tip pokes through one side of an edge of the lattice, and no corner of the
//!     |  / \  |       |     upper cell is inside. So the vertex of the cell below goes a little beyond
//!     +-x---x-+-------+     its cell. Vertices of cells along an edge of the surface keep their order
//!     |/     \|       |     there, each at the point that is nearest to its mean. The vertex of a cell
//!     +-------+-------+     that all sides of a corner go through is at the corner: few other cells have
//!                           crossings of all of them, even the cell that the corner is in.
//! ```

use super::super::super::brick::{Bricks, box_of};
use super::super::super::field::Field;
use super::super::batch::{VertexBatch, VertexSource};
use super::super::bracket::BracketPoints;
use super::super::margin::room;
use super::candidate::{Candidate, clamped};
use super::quadric::EdgeAim;
use crate::boxes::Box3;

/// Places the candidates; those without an aim go. Returns the region around the brick, if it was needed.
pub(super) fn place<F: Field>(
    source: &VertexSource<'_, F>,
    brick: usize,
    batch: &VertexBatch,
    candidates: &mut Vec<Candidate<'_>>,
) -> Result<Option<F::Region>, F::Error> {
    let mut aims = Vec::with_capacity(candidates.len());
    candidates.retain(|one| one.aim().map(|aim| aims.push(aim)).is_some());
    for (one, aim) in candidates.iter_mut().zip(aims) {
        let bounds = batch.bounds(one.sheet.start.vertex);
        let near = |beyond| beside(&source.bricks.axes, one.sheet.cell, beyond);
        if let Some(point) = aim.within(bounds) {
            one.put(clamped(point, bounds), bounds);
            continue;
        }
        let edges = if let EdgeAim::Point(_) = aim {
            let near = near(CORNER_BEYOND);
            if let Some(point) = aim.within(near) {
                one.put(clamped(point, near), near);
                one.is_beyond = true;
                continue;
            }
            one.edges()
        } else {
            vec![aim]
        };
        let near = near(BEYOND);
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
    if !candidates.iter().any(|one| one.is_beyond || one.is_at_jump()) {
        return Ok(None);
    }
    source.field.region(around(source.bricks, brick)).map(Some)
}

/// How far a vertex may go beyond its cell to a corner, in cells: of the 2,400 corners of 300 turned cubes 12
/// have no vertex then, 20 with 0.6, and none has two.
const CORNER_BEYOND: f32 = 1.0;
/// How far a vertex may go beyond its cell along an edge, in cells. Found by trial, before vertices [went
/// back](super::super::super::fold): of the triangles of 24 turned cubes 58 are folded without edges, 32 with
/// 0.5, and 29 with 0.6 to 1.
const BEYOND: f32 = 0.6;

/// A cell and what is around it, as far as the lattice goes.
fn beside(axes: &[Vec<f32>; 3], Box3 { low, high }: Box3, beyond: f32) -> Box3 {
    let sides = [0, 1, 2].map(|axis| {
        let more = beyond * high[axis] - beyond * low[axis];
        let [first, last] = room([axes[axis][0], axes[axis][axes[axis].len() - 1]]);
        [(low[axis] - more).max(first), (high[axis] + more).min(last)]
    });
    Box3::new(sides.map(|side| side[0]), sides.map(|side| side[1]))
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
