//! Attribute groups: named tuples of reals that leaves carry and the field mixes; and the values that
//! attribute nodes give to leaves.

use std::sync::Arc;

use glam::DVec3;

use crate::affine::sin_cos_degrees;
use crate::expression::Expression;
use crate::texture::Texture;
use crate::word::normalized;

pub use crate::precedence::Precedence;

/// How the leaves' values become the value at a point.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Mixing {
    /// The mean of the values, weighted by how much each leaf contributes to the field.
    Blend,
    /// The value of the leaf with the largest total weight; of equal weights, the first leaf in the file.
    Dominant,
}

impl Mixing {
    /// Both ways.
    pub const ALL: [Self; 2] = [Self::Blend, Self::Dominant];

    /// The word of the text format.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Blend => "blend",
            Self::Dominant => "dominant",
        }
    }
}

/// What the values of a group are.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum GroupKind {
    /// Numbers, which are the same wherever a leaf is moved.
    #[default]
    Numbers,
    /// Directions, of 3 reals: that of a line element, as the grain of wood or a fibre. Affine maps above the
    /// node that gives one turn it by their linear part, warps by the derivative of what they do there.
    /// It is not normalised again: where a line is stretched, its direction is longer.
    Direction,
}

impl GroupKind {
    /// Both kinds.
    pub const ALL: [Self; 2] = [Self::Numbers, Self::Direction];
}

/// The word for a group of directions, in place of its width.
pub const DIRECTION: &str = "direction";

/// A group of 1 to [`MAX_ATTRIBUTE_WIDTH`](jbt_ir::limits::MAX_ATTRIBUTE_WIDTH) reals with a name.
#[derive(Clone, PartialEq, Debug)]
pub struct AttributeGroup {
    /// Its name: letters, digits and underscores, beginning with a letter.
    pub name: Arc<str>,
    /// The value of leaves without the attribute, and of points where the field is zero; its length is the
    /// width of the group.
    pub default: Vec<f64>,
    /// How values mix.
    pub mixing: Mixing,
    /// What they are.
    pub kind: GroupKind,
    /// Of a group that nobody declares, as [`owner`](crate::check::OWNER): the names of its columns where
    /// answers are a table, one for each real. None of others, which have those of their
    /// [channels](Self::channel).
    pub titles: Arc<[String]>,
}

impl AttributeGroup {
    /// The group that every model has: `color`, linear red, green and blue, mixed, white by default.
    #[must_use]
    pub fn color() -> Self {
        Self { default: vec![1.0; 3], ..Self::mixed("color") }
    }

    /// A group of no reals so far, which are numbers, and mixed.
    pub(crate) fn mixed(name: &str) -> Self {
        Self {
            name: normalized(name).into(),
            default: Vec::new(),
            mixing: Mixing::Blend,
            kind: GroupKind::Numbers,
            titles: Arc::default(),
        }
    }

    /// A group of directions, mixed: see [`GroupKind::Direction`].
    ///
    /// ```
    /// use jbt_model::{attribute::AttributeGroup, builder::point, model::Model, walk::walk};
    /// let beam = point([0; 3], 1).attribute("grain", &[1, 0, 0]).scale(2);
    /// let groups = vec![AttributeGroup::color(), AttributeGroup::direction("grain", [0.0; 3])];
    /// let tree = Model { attributes: groups, ..Model::new(beam) }.check()?;
    /// assert_eq!(walk(&tree, [0.0; 3]).attributes[1], [2.0, 0.0, 0.0]);
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    #[must_use]
    pub fn direction(name: &str, default: [f64; 3]) -> Self {
        Self { default: default.to_vec(), kind: GroupKind::Direction, ..Self::mixed(name) }
    }

    /// Whether its values turn with what moves their leaves.
    #[must_use]
    pub fn turns(&self) -> bool {
        self.kind == GroupKind::Direction
    }

    /// Number of reals.
    #[must_use]
    pub fn width(&self) -> usize {
        self.default.len()
    }

    /// The name of a channel: `color.r`, `color.g`, `color.b` for colour, else `name` for one real, `name.x`
    /// and so on for up to four, and `name.0` and so on for more.
    #[must_use]
    pub fn channel(&self, index: usize) -> String {
        let letters = if &*self.name == "color" { ["r", "g", "b", "a"] } else { ["x", "y", "z", "w"] };
        match self.width() {
            1 => self.name.to_string(),
            2..=4 => format!("{}.{}", self.name, letters[index]),
            _ => format!("{}.{index}", self.name),
        }
    }

    /// The name of the column of a channel where answers are a table.
    #[must_use]
    pub fn title(&self, index: usize) -> String {
        self.titles.get(index).cloned().unwrap_or_else(|| self.channel(index))
    }
}

/// What an attribute node gives to the leaves below it.
#[derive(Clone, PartialEq, Debug)]
pub enum AttributeValue {
    /// The same numbers everywhere: one for each channel of the group.
    Numbers(Vec<f64>),
    /// A mixture of two values, by a pattern in the space of the node.
    Textured(Textured),
    /// The uv of each leaf's skeleton, for groups of two reals: see
    /// [`SkeletonMember::uv`](crate::skeleton::SkeletonMember::uv).
    Uv(UvMap),
    /// A formula of the coordinates in the space of the node, with one value for each channel of the group.
    /// It asks for no fields, and has no box.
    Expressed(Expression),
}

impl AttributeValue {
    /// Whether it depends on the place in the node's space.
    pub fn is_placed(&self) -> bool {
        match self {
            Self::Textured(_) | Self::Expressed(_) => true,
            Self::Numbers(_) | Self::Uv(_) => false,
        }
    }
}

impl From<Vec<f64>> for AttributeValue {
    fn from(numbers: Vec<f64>) -> Self {
        Self::Numbers(numbers)
    }
}

/// A mixture of two values of a group: `(1 - t) a + t b`, where t is the number of a texture.
#[derive(Clone, PartialEq, Debug)]
pub struct Textured {
    /// The pattern.
    pub texture: Texture,
    /// Where the texture is 0: one real for each channel.
    pub a: Vec<f64>,
    /// Where the texture is 1: one real for each channel.
    pub b: Vec<f64>,
}

impl Textured {
    /// The value at a place of the node's space, in f64.
    #[must_use]
    pub fn value(&self, p: DVec3) -> Vec<f64> {
        let t = self.texture.value(p);
        self.a.iter().zip(&self.b).map(|(a, b)| (1.0 - t) * a + t * b).collect()
    }
}

/// A map of uv: scale, then rotation about (0, 0), then shift. Nothing is wrapped to 0 .. 1.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct UvMap {
    /// The factors of u and v: how often a picture repeats.
    pub scale: [f64; 2],
    /// The rotation in degrees, from u to v.
    pub degrees: f64,
    /// The shift of u and v.
    pub shift: [f64; 2],
}

impl UvMap {
    /// The identity map.
    pub const IDENTITY: Self = Self { scale: [1.0; 2], degrees: 0.0, shift: [0.0; 2] };

    /// The rows of its 2x3 matrix: factors of u and v, and what is added.
    #[must_use]
    pub fn matrix(&self) -> [[f64; 3]; 2] {
        let (sin, cos) = sin_cos_degrees(self.degrees);
        let ([su, sv], [u, v]) = (self.scale, self.shift);
        [[cos * su, -sin * sv, u], [sin * su, cos * sv, v]]
    }

    /// The image of a uv, in f64.
    #[must_use]
    pub fn apply(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        self.matrix().map(|[by_u, by_v, shift]| by_u * u + by_v * v + shift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uv_is_scaled_then_turned_then_shifted() {
        let map = UvMap { scale: [2.0, 3.0], degrees: 90.0, shift: [10.0, 20.0] };
        assert_eq!(map.apply([0.5, 1.0]), [10.0 - 3.0, 20.0 + 1.0]);
        assert_eq!(UvMap::IDENTITY.apply([0.25, 0.75]), [0.25, 0.75]);
    }

    #[test]
    fn channels_have_letters_up_to_four() {
        let group = |width: usize| AttributeGroup { default: vec![0.0; width], ..AttributeGroup::mixed("n") };
        assert_eq!(
            [group(1).channel(0), group(4).channel(3), group(5).channel(4)],
            ["n", "n.w", "n.4"].map(str::to_owned)
        );
        let titled = AttributeGroup { titles: ["a/b".to_owned()].into(), ..group(1) };
        assert_eq!([titled.title(0), titled.channel(0), group(5).title(4)], ["a/b", "n", "n.4"]);
    }
}
