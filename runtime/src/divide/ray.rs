//! A ray through a divided box: the leaves that it passes, from the nearest to the farthest.

use super::node::{Division, DivisionNode, Outcome};
use crate::boxes::Box3;

/// A leaf that a ray passes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Passage<'a, R, D> {
    /// Where the ray enters the box, in lengths of its direction from its origin: 0 if it begins inside.
    pub enter: f32,
    /// Where it leaves it.
    pub exit: f32,
    /// The leaf.
    pub node: &'a DivisionNode<D>,
    /// What is known of it.
    pub region: &'a R,
}

impl<R, D> Division<R, D> {
    /// The leaves that a ray passes, by where it enters them; of equals the one that comes first in the
    /// division.
    ///
    /// A ray that runs along a side passes the boxes on both. Where a coordinate of the direction is 0 the
    /// ray stays at its origin's; a direction of zeros passes the boxes that hold the origin. Cost: the boxes
    /// that it meets, and a sort of the leaves among them.
    #[must_use]
    pub fn ray(&self, origin: [f32; 3], direction: [f32; 3]) -> Vec<Passage<'_, R, D>> {
        let mut passages = Vec::new();
        let (mut at, mut leaf) = (0, 0);
        // A walk over all nodes that jumps over the subtrees of boxes that are missed.
        while let Some(node) = self.nodes.get(at) {
            match passage(&node.bounds, origin, direction) {
                None => {
                    let end = at + node.size as usize;
                    leaf += self.nodes[at..end].iter().filter(|node| node.outcome == Outcome::Leaf).count();
                    at = end;
                }
                Some([enter, exit]) => {
                    if node.outcome == Outcome::Leaf {
                        passages.push(Passage { enter, exit, node, region: &self.regions[leaf] });
                        leaf += 1;
                    }
                    at += 1;
                }
            }
        }
        passages.sort_by(|a, b| a.enter.total_cmp(&b.enter));
        passages
    }
}

/// From where to where a ray is in a box, if it meets it (Kay and Kajiya 1986, "Ray tracing complex scenes":
/// slabs).
fn passage(bounds: &Box3, origin: [f32; 3], direction: [f32; 3]) -> Option<[f32; 2]> {
    let (mut enter, mut exit) = (0.0_f32, f32::INFINITY);
    for axis in 0..3 {
        let [low, high] = [bounds.low[axis], bounds.high[axis]].map(|side| side - origin[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let [a, b] = [low / direction[axis], high / direction[axis]];
        enter = enter.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    (enter <= exit).then_some([enter, exit])
}
