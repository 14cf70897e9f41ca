//! Attribute groups: named tuples of reals that are carried by leaves and mixed by field.

use std::sync::Arc;

/// How the leaves' values become the value at a point.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Mixing {
    /// The mean of the values, weighted by how much each leaf contributes to the field.
    Blend,
    /// The value of the leaf with the largest total weight; of equals, the first in the file.
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

/// A group of 1 to 4 reals with a name.
#[derive(Clone, PartialEq, Debug)]
pub struct AttributeGroup {
    /// Its name: letters, digits and underscores, beginning with a letter.
    pub name: Arc<str>,
    /// The value of leaves without the attribute, and of points without field; its length is the width of the group.
    pub default: Vec<f64>,
    /// How values mix.
    pub mixing: Mixing,
}

impl AttributeGroup {
    /// The group that every model has: `color`, linear red, green and blue, mixed, white by default.
    #[must_use]
    pub fn color() -> Self {
        Self { name: "color".into(), default: vec![1.0; 3], mixing: Mixing::Blend }
    }

    /// Number of reals.
    #[must_use]
    pub fn width(&self) -> usize {
        self.default.len()
    }

    /// The name of a channel: `color.r`, `color.g`, `color.b` for colour, else `name` for one real and `name.x` and so on for more.
    #[must_use]
    pub fn channel(&self, index: usize) -> String {
        let letters = if &*self.name == "color" { ["r", "g", "b", "a"] } else { ["x", "y", "z", "w"] };
        if self.width() == 1 { self.name.to_string() } else { format!("{}.{}", self.name, letters[index]) }
    }
}
