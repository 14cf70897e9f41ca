//! The circles in which a plane cuts the supports of points: what a picture of a quadtree is drawn over.

use jbt_model::affine::{IDENTITY, Similarity};
use jbt_model::check::CheckedTree;
use jbt_model::kind::NodeKind;
use jbt_model::skeleton::Skeleton;

use super::plane::Plane;

/// The most circles that anybody wants to see.
const MOST: usize = 1 << 14;
/// The most nodes that are visited for them, again at each use.
const VISITED: usize = 1 << 18;

/// Center and radius of the circle in which the support of each point primitive meets the plane, in
/// coordinates of the plane. Points behind warps, and behind maps that are no similarities, have no circles,
/// and other skeletons have none; of a very large model there are not all.
#[must_use]
pub fn circles(tree: &CheckedTree, plane: &Plane) -> Vec<([f64; 2], f64)> {
    let mut circles = Vec::new();
    let mut stack = vec![(tree.root(), IDENTITY)];
    let mut visited = 0;
    while let Some((id, map)) = stack.pop() {
        visited += 1;
        if circles.len() == MOST || visited > VISITED {
            break;
        }
        let node = tree.node(id);
        let map = match &node.kind {
            NodeKind::Primitive(leaf) => {
                if let (Skeleton::Point(point), Some(similarity)) =
                    (&leaf.skeleton, Similarity::from_affine(&map))
                {
                    let at = map.transform_point3(point.at).to_array();
                    circles.extend(circle(plane, at, similarity.scale() * leaf.radius));
                }
                continue;
            }
            NodeKind::Particles(particles) => {
                if let Some(similarity) = Similarity::from_affine(&map) {
                    let all = (0..particles.len()).filter_map(|particle| {
                        let at = map.transform_point3(particles.at(particle)).to_array();
                        circle(plane, at, similarity.scale() * particles.radius(particle))
                    });
                    let room = MOST - circles.len();
                    circles.extend(all.take(room));
                }
                continue;
            }
            NodeKind::Warp(_) | NodeKind::Expression(_) => continue,
            NodeKind::Affine(inner) => map * *inner,
            NodeKind::Combine(_)
            | NodeKind::Select(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => map,
        };
        stack.extend(node.kind.asked(&node.children).iter().rev().map(|&child| (child, map)));
    }
    circles
}

/// Where a ball meets the plane.
fn circle(plane: &Plane, at: [f64; 3], radius: f64) -> Option<([f64; 2], f64)> {
    let [a, b, away] = plane.coordinates(at);
    let square = radius * radius - away * away;
    (square > 0.0).then(|| ([a, b], square.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_under_similarities_have_circles() {
        let text = b"jbt 1 sum {
            point { at (1 0 0) radius 1 }
            translate (0 2 0) { scale 2 { color (1 0 0) { point { at (0.5 0 0.3) radius 0.5 } } } }
            point { at (0 0 5) radius 1 }
            segment { from (0 0 0) to (1 0 0) radius 1 }
            twist axis z rate 1 { point { radius 1 } }
        }";
        let tree = jbt_text::parse(text, &Default::default()).unwrap().check().unwrap();
        let found = circles(&tree, &Plane::default());
        let expected = [([1.0, 0.0], 1.0), ([1.0, 2.0], 0.8)];
        assert_eq!(found.len(), 2);
        for ((center, radius), (at, expected)) in found.iter().zip(expected) {
            assert!(
                (0..2).all(|axis| (center[axis] - at[axis]).abs() < 1e-12)
                    && (radius - expected).abs() < 1e-12
            );
        }
    }
}
