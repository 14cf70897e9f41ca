//! The budget of work: what one point is foreseen to cost, counted before any of it is spent.
//!
//! ```text
//! a leaf          its pieces, each as far as it reaches         ──► work at a point of the leaf's box, on average
//! an operator     the sum of its children, each by the part of its own box that it fills
//! map, warp       the work of the child, in the box of the child's image
//! ```
//!
//! A node that is shared is counted once and weighed with every use, so the count is linear in the nodes. It
//! is what pruning leaves of the model at a point of its box: strands of hair side by side cost little, and
//! as many curves that all reach everywhere cost everything, at every point. Points are asked brick by brick,
//! so whatever touches the brick of a point is asked there ([`BRICK`]).

use jbt_ir::limits;

use super::arena::{CheckedNode, NodeId};
use super::tree::node_extent;
use crate::bounds::Bounds;
use crate::combine::extent::Extent;
use crate::diagnostic::Diagnostic;
use crate::kind::{NodeKind, Primitive};
use crate::report::Report;

/// Numbers of a piece that are read and computed with in one unit of work: those of a straight piece.
const NUMBERS_IN_A_UNIT: usize = 8;
/// Operations of a formula in one unit of work.
const STEPS_IN_A_UNIT: usize = 16;
/// The side of a brick, of that of the box in which it is.
const BRICK: f64 = 0.125;

/// Refuses a model of which one point is foreseen to cost more than [`limits::MAX_POINT_WORK`].
pub(super) fn check_work(report: &mut Report, nodes: &[CheckedNode], iso: f64) {
    if !nodes.iter().any(|node| whole(&node.kind) > 0.0) {
        return;
    }
    let most = limits::MAX_POINT_WORK as f64;
    // Asking every piece where it is takes longer, and is seldom needed.
    if foreseen(nodes, iso, |kind, _| whole(kind)) <= most {
        return;
    }
    let work = foreseen(nodes, iso, reaching);
    if work > most {
        // The place is that of the node that costs most by itself.
        let dearest = nodes.iter().max_by(|a, b| whole(&a.kind).total_cmp(&whole(&b.kind)));
        let span = dearest.and_then(|node| node.span);
        let message = format!(
            "unfolded, a point of the model would take {work:.0} pieces of curves and parts of formulas; \
             it may take {most}"
        );
        report.add(|| Diagnostic::limit(span, message).expected("expected fewer uses, or smaller radii"));
    }
}

/// The work of the root at a point of its box, where that of a leaf in its own box is `own`.
fn foreseen(nodes: &[CheckedNode], iso: f64, own: impl Fn(&NodeKind, Bounds) -> f64) -> f64 {
    let mut done: Vec<(Extent, f64)> = Vec::with_capacity(nodes.len());
    for node in nodes {
        let of = |id: &NodeId| done[id.0 as usize];
        let extents: Vec<Extent> = node.children.iter().map(|id| of(id).0).collect();
        let extent = node_extent(&node.kind, &extents, iso);
        // Nothing is evaluated where an operator is 0, and a map changes no part of a box.
        let parts = match node.kind {
            NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => node.children.iter().map(|id| of(id).1).sum::<f64>(),
            NodeKind::Primitive(_)
            | NodeKind::Particles(_)
            | NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_) => {
                let part = |id: &NodeId| of(id).1 * part_of(of(id).0.support, extent.support);
                node.children.iter().map(part).sum()
            }
        };
        done.push((extent, parts + own(&node.kind, extent.support)));
    }
    done.last().map_or(0.0, |root| root.1)
}

/// What a node takes everywhere in its box besides what one leaf without pieces takes.
fn whole(kind: &NodeKind) -> f64 {
    match kind {
        NodeKind::Primitive(leaf) => {
            let pieces = leaf.skeleton.piece_count(leaf.radius, limits::MAX_INSTANCES);
            pieces as f64 * work_of_a_piece(leaf)
        }
        NodeKind::Expression(expression) => (expression.form().steps() / STEPS_IN_A_UNIT) as f64,
        NodeKind::Particles(_)
        | NodeKind::Combine(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Attribute { .. }
        | NodeKind::Constant { .. } => 0.0,
    }
}

/// The same, where a piece counts as far as it reaches.
fn reaching(kind: &NodeKind, support: Bounds) -> f64 {
    let NodeKind::Primitive(leaf) = kind else { return whole(kind) };
    if !leaf.skeleton.kind().pieces().is_some_and(|pieces| pieces.local) {
        return whole(kind);
    }
    let pieces = leaf.skeleton.piece_bounds_under(leaf.radius, &glam::DAffine3::IDENTITY);
    let part = |piece: Bounds| part_of(piece.grown(leaf.radius), support);
    pieces.into_iter().map(part).sum::<f64>() * work_of_a_piece(leaf)
}

fn work_of_a_piece(leaf: &Primitive) -> f64 {
    let numbers = leaf.skeleton.kind().pieces().map_or(0, |pieces| pieces.columns.len());
    numbers.div_ceil(NUMBERS_IN_A_UNIT) as f64
}

/// The part of the bricks of a box that another one touches, axis by axis; all of it where nobody knows.
fn part_of(inner: Bounds, outer: Bounds) -> f64 {
    let common = inner.intersection(outer);
    if common.is_empty() {
        return 0.0;
    }
    let [inner, outer] = [common, outer].map(|bounds| (bounds.max - bounds.min).to_array());
    let part = |axis: usize| {
        let part = inner[axis] / outer[axis] + BRICK;
        if part.is_finite() && outer[axis].is_finite() { part.min(1.0) } else { 1.0 }
    };
    (0..3).map(part).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_boxes() {
        let cube = |side: f64| Bounds::new([0.0; 3].into(), [side; 3].into());
        assert_eq!(part_of(cube(1.0), cube(2.0)), 0.625_f64.powi(3));
        assert_eq!(part_of(cube(2.0), cube(1.0)), 1.0);
        assert_eq!(part_of(cube(1.0), Bounds::EVERYWHERE), 1.0);
        assert_eq!(part_of(cube(1.0), cube(1.0).moved([2.0; 3].into())), 0.0);
        assert_eq!(part_of(Bounds::EMPTY, cube(1.0)), 0.0);
    }
}
