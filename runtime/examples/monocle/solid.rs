//! The monocle as a tree.

use jbt::build::{point, ring};
use jbt::{AttributeGroup, Mixing, Model, Tree};

/// What solids are made of: BABEL's `material`, as an index.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Material {
    Glass = 1,
    Steel = 2,
}

use Material::{Glass, Steel};

/// The attribute group of materials. There is nothing half-way between glass and steel: the leaf that
/// contributes most decides.
const GROUP: &str = "material";

impl Material {
    /// The material that an answer stands for; `None` is none.
    pub fn of(answer: &[f32]) -> Option<Self> {
        [Glass, Steel].into_iter().find(|&material| answer == [material as u8 as f32])
    }
}

/// Material as a postfix operator.
trait Made {
    fn material(&self, material: Material) -> Tree;
}

impl Made for Tree {
    fn material(&self, material: Material) -> Tree {
        self.attribute(GROUP, &[f64::from(material as u8)])
    }
}

/// The unit ball: a soft field is 1/2 at half its radius.
fn sphere() -> Tree {
    point([0.0; 3], 2.0)
}

/// A torus about the unit circle across z.
fn torus(thickness: f64) -> Tree {
    ring([0.0; 3], [0.0, 0.0, 1.0], 1.0, 2.0 * thickness)
}

/// The listing.
pub fn monocle() -> Tree {
    let shared_sphere = sphere();

    let lens = shared_sphere.translate([0.0, 0.0, 0.8]) & shared_sphere.translate([0.0, 0.0, -0.8]);

    let rim = torus(0.1).scale_axes([0.6, 0.6, 0.6]);

    lens.material(Glass) | rim.material(Steel)
}

/// A tree with materials as a model.
pub fn model(root: Tree) -> Model {
    let materials = AttributeGroup {
        name: GROUP.into(),
        default: vec![0.0],
        mixing: Mixing::Dominant,
        ..AttributeGroup::color()
    };
    Model { attributes: vec![AttributeGroup::color(), materials], ..Model::new(root) }
}
