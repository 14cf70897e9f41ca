//! Every leaf where it stands, each as a model of its own: what statistics ask about one primitive at a time.

use std::fmt;

use super::instance::{FieldId, Scene};
use super::run::LeafNumbers;
use super::shape::Hoist;
use jbt_model::check::{CheckedTree, NodeId};
use jbt_model::kind::{NodeKind, Primitive};

/// The leaves of a tree at their positions: one for each leaf and way of coordinates to it, whatever the
/// attributes. A leaf that several parents share under the same maps is there once. Of a selector's children,
/// only the chosen one has leaves.
///
/// ```
/// use jbt_model::builder::point;
/// use jbt_lower::LeafInstances;
/// use jbt_model::model::Model;
/// use jbt_model::walk::walk;
///
/// let ball = point([0.0; 3], 1.0);
/// let tree = Model::new((&ball + &ball) | ball.translate([5.0, 0.0, 0.0])).check().unwrap();
/// let leaves = LeafInstances::new(&tree);
/// assert_eq!(leaves.len(), 2, "three uses, two of them at one place");
/// assert_eq!(walk(&leaves.alone(1), [5.0, 0.0, 0.0]).field, 1.0);
/// ```
pub struct LeafInstances<'a> {
    scene: Scene<'a>,
    /// Those that selectors do not leave out; of particles, with the place in their arrays.
    asked: Vec<(FieldId, u32)>,
}

impl fmt::Debug for LeafInstances<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LeafInstances").field("len", &self.len()).finish_non_exhaustive()
    }
}

impl<'a> LeafInstances<'a> {
    /// Finds them. Cost: all paths of the tree at worst.
    #[must_use]
    pub fn new(tree: &'a CheckedTree) -> Self {
        let scene = Scene::new(tree);
        let all = (0..scene.fields.len() as u32).map(FieldId);
        let mut asked = Vec::new();
        for field in all.filter(|&field| scene.demand.is_asked(Hoist::Field(field))) {
            match &scene.field(field).run {
                None => asked.push((field, 0)),
                // There are at most limits::MAX_PARTICLES.
                Some(run) => asked.extend((0..run.len()).map(|number| (field, run.place(number) as u32))),
            }
        }
        Self { scene, asked }
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.asked.len()
    }

    /// Whether there are none. No tree is without leaves.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.asked.is_empty()
    }

    /// The node of one of them. Panics if there are not as many.
    #[must_use]
    pub fn node(&self, index: usize) -> NodeId {
        self.scene.field(self.asked[index].0).node
    }

    /// A model of this leaf alone, where it stands in the whole, in local coordinates of that and with
    /// strength 1: its field is above zero exactly inside the primitive's support. Its numbers are, to the
    /// bit, those that it has in the program of the whole model, unless they depend on parameters: then to
    /// within rounding. Panics if there are not as many.
    #[must_use]
    pub fn alone(&self, index: usize) -> CheckedTree {
        let (field, place) = self.asked[index];
        let LeafNumbers { radius, falloff, .. } =
            self.scene.leaf_numbers(self.scene.field(field), place as usize);
        let skeleton = self.scene.leaf_skeleton(field, place as usize).into_owned();
        let leaf = Primitive { skeleton, falloff: *falloff, radius, strength: 1.0 };
        let mut maps = Vec::new();
        let mut position = self.scene.position(self.scene.field(field).position);
        loop {
            maps.push((NodeKind::Affine(position.map), None));
            let Some(inside) = self.scene.inside(position.space) else { break };
            let warp = self.scene.tree.node(inside.warp);
            maps.push((warp.kind.clone(), warp.children.get(1).copied()));
            position = self.scene.position(inside.position);
        }
        self.scene.tree.leaf_under(leaf, maps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jbt_text::{Options, parse};

    fn leaves(text: &str, p: [f64; 3]) -> Vec<f64> {
        let tree = parse(text.as_bytes(), &Options::default()).unwrap().check().unwrap();
        let leaves = LeafInstances::new(&tree);
        (0..leaves.len()).map(|index| jbt_model::walk::walk(&leaves.alone(index), p).field).collect()
    }

    #[test]
    fn a_leaf_alone_stands_where_it_stood() {
        let text = "jbt 1 rotate axis z degrees 90 { twist axis z rate 1 { translate (1 0 1) { scale 2 {
            sum { point { radius 1 strength -3 } point { at (0 0 1) radius 0.5 strength 0 } } } } } }";
        // Undone: from (x, y) = (-sin 1, cos 1) back by a quarter, then by the twist's angle 1 at z = 1.
        let (sin, cos) = 1.0_f64.sin_cos();
        let found = leaves(text, [-sin, cos, 1.0]);
        assert!((found[0] - 1.0).abs() < 1e-12, "{found:?}");
        assert_eq!(found[1], 0.0);
    }

    #[test]
    fn a_leaf_in_a_weighted_warp_keeps_the_weight() {
        let text =
            "jbt 1 deform by (0 0 1) weighted { point { radius 1 } sum { point { at (0 0 1) radius 2 } } }";
        assert_eq!(
            leaves(text, [0.0, 0.0, 1.0]),
            [1.0, 1.0],
            "the leaf where it was pulled, and that of the weight"
        );
    }

    #[test]
    fn attributes_make_no_other_leaf() {
        let text = "jbt 1 let a = twist axis x rate 1 { point { at (0 1 0) radius 1 } }
            sum { color (1 0 0) { use a } color (0 1 0) { use a } rotate axis y degrees 180 { use a } }";
        assert_eq!(leaves(text, [0.0, 1.0, 0.0]), [1.0, 1.0]);
    }
}
