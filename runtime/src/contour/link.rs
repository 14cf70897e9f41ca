//! Segments become closed loops, and loops know which other loop they are in.
//!
//! ```text
//! sort segments by the edges that they begin at, and by those that they end at: the same edges in both lists, so
//!     the one after a segment is known from its place
//! follow them around; drop points that say nothing; begin at the lowest point
//! sort loops by where they begin
//! a loop's leftmost crossing of a row of the lattice, and the crossing before it in that row, tell what it is in:
//!
//!     --outside--(--inside--[--outside--(--inside--        ( begins the row's part inside an outer loop or behind a hole's end, ...
//!                           ^ what is left of it           (after Suzuki and Abe 1985, who follow borders in pictures)
//! ```

use jbt_ir::watch;

use crate::parallel::*;
use crate::span::span;

use super::cells::{ContourSegment, EdgeKey, Segments};

/// A closed loop of the contour, with the inside on its left.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Loop {
    /// Its first vertex; the others follow, up to before `end`. The last one is joined to the first.
    pub start: usize,
    /// The vertex behind its last one.
    pub end: usize,
    /// Whether what it encloses is outside: it goes clockwise then.
    pub is_hole: bool,
    /// The loop around it: of a hole the outer loop that it is a hole of, of an outer loop the hole in which
    /// it is, if it is in one.
    pub parent: Option<usize>,
    /// Loops around it: even for outer loops, odd for holes.
    pub depth: usize,
    /// The area that it encloses, negative for a hole, in square units of the model: the sum over all loops
    /// is the area of the slice.
    pub area: f64,
    /// Its length, in units of the model.
    pub length: f64,
}

/// What a loop is before it has its place.
struct LoopDraft {
    /// Its vertices, as numbers of segments.
    vertices: Vec<usize>,
    /// The leftmost crossing of a row.
    leftmost: EdgeKey,
    is_hole: bool,
}

/// Loops over vertices.
pub(super) struct Linked {
    pub(super) positions: Vec<[f32; 2]>,
    /// Plane by plane.
    pub(super) attributes: Vec<Vec<f32>>,
    pub(super) loops: Vec<Loop>,
}

/// What a segment takes while it is linked, besides itself: its places in orders and loops.
const LINK_BYTES: usize = 96;

/// Stops the work if there is no memory to link so many segments, with so many planes of attributes.
pub(super) fn take_for_links(segments: usize, planes: usize) {
    watch::take(segments * (size_of::<ContourSegment>() + planes * size_of::<f32>() + LINK_BYTES));
}

/// Links all segments. Panics if they are no closed loops: the field was on both sides of the iso-value at
/// one point.
pub(super) fn link<'a>(pieces: impl Iterator<Item = &'a Segments> + Clone, planes: usize) -> Linked {
    span!("loops");
    let count = pieces.clone().map(|piece| piece.list.len()).sum();
    take_for_links(count, planes);
    let mut segments: Vec<ContourSegment> = Vec::with_capacity(count);
    let mut attributes = vec![Vec::with_capacity(segments.capacity()); planes];
    for piece in pieces {
        segments.extend_from_slice(&piece.list);
        for (all, plane) in attributes.iter_mut().zip(&piece.attributes) {
            all.extend_from_slice(plane);
        }
    }
    let (begins, next) = following(&segments);
    let mut of_segment = vec![usize::MAX; segments.len()];
    let mut drafts = Vec::new();
    // By their edges, so that the order of pieces does not matter.
    for first in begins {
        if of_segment[first] == usize::MAX {
            drafts.extend(follow(first, &segments, &next, &mut of_segment));
        }
    }
    let low = |draft: &LoopDraft| segments[draft.vertices[0]].place;
    drafts.sort_by(|a, b| by_place(low(a), low(b)).then(a.leftmost.cmp(&b.leftmost)));
    let parents = nest(&drafts, &segments, &of_segment);
    let order: Vec<usize> = drafts.iter().flat_map(|draft| draft.vertices.iter().copied()).collect();
    let positions: Vec<[f32; 2]> = order.iter().map(|&segment| segments[segment].place).collect();
    let pick = |plane: Vec<f32>| order.iter().map(|&segment| plane[segment]).collect();
    let attributes = attributes.into_iter().map(pick).collect();
    Linked { loops: loops(&drafts, &parents, &positions), positions, attributes }
}

/// All segments by the edges that they begin at, and for each segment the one that begins where it ends.
fn following(segments: &[ContourSegment]) -> (Vec<usize>, Vec<usize>) {
    let sorted = |key: fn(&ContourSegment) -> EdgeKey| {
        let mut order: Vec<usize> = (0..segments.len()).collect();
        order.par_sort_unstable_by_key(|&segment| key(&segments[segment]));
        order
    };
    let (begins, ends) =
        scatter(|_| join(|| sorted(|segment| segment.from), || sorted(|segment| segment.to)));
    let mut next = vec![0; segments.len()];
    for (&begin, &end) in begins.iter().zip(&ends) {
        let fits = segments[begin].from == segments[end].to;
        assert!(fits, "a field has one value at a point, and is within its ranges");
        next[end] = begin;
    }
    (begins, next)
}

/// The loop of a segment, if it encloses anything.
fn follow(
    first: usize,
    segments: &[ContourSegment],
    next: &[usize],
    of_segment: &mut [usize],
) -> Option<LoopDraft> {
    let mut around = Vec::new();
    let mut segment = first;
    let mut leftmost: Option<(EdgeKey, bool)> = None;
    while of_segment[segment] == usize::MAX {
        of_segment[segment] = first;
        around.push(segment);
        let ContourSegment { from, low_inside, .. } = segments[segment];
        let column = |key: EdgeKey| (key.column(), key.row());
        if from.axis() == 0 && leftmost.is_none_or(|(best, _)| column(from) < column(best)) {
            leftmost = Some((from, low_inside));
        }
        segment = next[segment];
    }
    let (leftmost, low_inside) = leftmost.expect("a loop encloses a point, whose row it crosses");
    let vertices = tidied(around, segments);
    (vertices.len() >= 3).then_some(LoopDraft { vertices, leftmost, is_hole: low_inside })
}

/// The vertices of a loop without those that say nothing, from its lowest one on.
fn tidied(mut around: Vec<usize>, segments: &[ContourSegment]) -> Vec<usize> {
    let place = |segment: usize| segments[segment].place;
    around.dedup_by_key(|segment| place(*segment));
    while around.len() > 1 && place(around[0]) == place(around[around.len() - 1]) {
        around.pop();
    }
    let count = around.len();
    let straight = |index: usize| {
        let [a, b, c] = [index + count - 1, index, index + 1].map(|index| place(around[index % count]));
        segments[around[index]].border && (0..2).any(|axis| a[axis] == b[axis] && b[axis] == c[axis])
    };
    let mut kept: Vec<usize> =
        (0..count).filter(|&index| !straight(index)).map(|index| around[index]).collect();
    let lowest = (0..kept.len()).min_by(|&a, &b| by_place(place(kept[a]), place(kept[b])));
    kept.rotate_left(lowest.unwrap_or(0));
    kept
}

/// From below, then from the left.
fn by_place(a: [f32; 2], b: [f32; 2]) -> std::cmp::Ordering {
    a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0]))
}

/// For each loop the one around it.
fn nest(drafts: &[LoopDraft], segments: &[ContourSegment], of_segment: &[usize]) -> Vec<Option<usize>> {
    // Loops by their first segments, as `of_segment` names them.
    let mut named: Vec<(usize, usize)> =
        drafts.iter().enumerate().map(|(index, draft)| (of_segment[draft.vertices[0]], index)).collect();
    named.sort_unstable();
    let loop_of = |segment: usize| {
        let found = named.binary_search_by_key(&of_segment[segment], |(name, _)| *name);
        found.ok().map(|index| named[index].1)
    };
    let crossings = (0..segments.len()).filter(|&segment| segments[segment].from.axis() == 0);
    let mut crossings: Vec<(EdgeKey, usize)> =
        crossings.filter_map(|segment| Some((segments[segment].from, loop_of(segment)?))).collect();
    scatter(|_| crossings.par_sort_unstable_by_key(|(key, _)| *key));
    // Those on the left border, by row.
    let left: Vec<(u32, usize)> = crossings
        .iter()
        .filter(|(key, _)| key.column() == 0)
        .map(|(key, index)| (key.row(), *index))
        .collect();
    let mut order: Vec<usize> = (0..drafts.len()).collect();
    order.sort_unstable_by_key(|&index| (drafts[index].leftmost.column(), drafts[index].leftmost));
    let mut parents: Vec<Option<usize>> = vec![None; drafts.len()];
    for index in order {
        let LoopDraft { leftmost, is_hole, .. } = drafts[index];
        let at = crossings.partition_point(|(key, _)| *key < leftmost);
        let before = at.checked_sub(1).map(|before| crossings[before]);
        let before = before.filter(|(key, _)| key.row() == leftmost.row()).map(|(_, other)| other);
        // A hole with nothing before it is in what reaches the left border, where squares that are inside
        // leave but a few crossings.
        let border =
            || left.get(left.partition_point(|(row, _)| *row < leftmost.row())).map(|(_, other)| *other);
        let before = before.or_else(|| if is_hole { border() } else { None });
        parents[index] = before
            .and_then(|other| if drafts[other].is_hole == is_hole { parents[other] } else { Some(other) });
    }
    parents
}

fn loops(drafts: &[LoopDraft], parents: &[Option<usize>], positions: &[[f32; 2]]) -> Vec<Loop> {
    let mut loops: Vec<Loop> = Vec::with_capacity(drafts.len());
    let mut start = 0;
    for (draft, &parent) in drafts.iter().zip(parents) {
        let end = start + draft.vertices.len();
        let [area, length] = measure(&positions[start..end]);
        loops.push(Loop { start, end, is_hole: draft.is_hole, parent, depth: usize::MAX, area, length });
        start = end;
    }
    // Parents may come later; each is looked at once.
    for index in 0..loops.len() {
        let mut chain = Vec::new();
        let mut at = index;
        while loops[at].depth == usize::MAX {
            chain.push(at);
            match loops[at].parent {
                Some(parent) => at = parent,
                None => break,
            }
        }
        for at in chain.into_iter().rev() {
            loops[at].depth = loops[at].parent.map_or(0, |parent| loops[parent].depth + 1);
        }
    }
    loops
}

/// Area and length of a polygon.
fn measure(positions: &[[f32; 2]]) -> [f64; 2] {
    let origin = positions[0].map(f64::from);
    let at = |index: usize| {
        let [u, v] = positions[index % positions.len()].map(f64::from);
        [u - origin[0], v - origin[1]]
    };
    let (mut area, mut length) = (0.0, 0.0);
    for index in 0..positions.len() {
        let ([a, b], [c, d]) = (at(index), at(index + 1));
        area += 0.5 * (a * d - c * b);
        length += (c - a).hypot(d - b);
    }
    [area, length]
}
