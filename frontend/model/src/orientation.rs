//! How a model stands: which of its axes points up, and whether its coordinates are right-handed.
//!
//! ```text
//! z up, right-handed        y up, right-handed        y up, left-handed
//! (here, Blender)           (glTF, three.js)          (POV-Ray)
//!      z   y                     y                         y   z
//!      | /                       |                         | /
//!      o--- x                    o--- x                    o--- x
//!                              /
//!                             z
//! ```
//!
//! It changes no coordinate and no field. Pictures and files show the model the right way up by it.

use std::ops::Sub;

/// The axis of a model that points up.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ModelUp {
    /// As three.js and POV-Ray have it.
    Y,
    /// The usual one.
    #[default]
    Z,
}

/// The hand whose thumb, forefinger and middle finger are x, y and z.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Handed {
    /// The usual one.
    #[default]
    Right,
    /// As POV-Ray has it.
    Left,
}

/// How a model stands.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Orientation {
    /// The axis that points up.
    pub up: ModelUp,
    /// The hand of its axes.
    pub handed: Handed,
}

impl ModelUp {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Y, Self::Z];

    /// The word of the text format.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

impl Handed {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Right, Self::Left];

    /// The word of the text format.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }

    /// The other hand.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }
}

impl Orientation {
    /// With y up and left-handed axes.
    pub const Y_LEFT: Self = Self { up: ModelUp::Y, handed: Handed::Left };
    /// With y up and right-handed axes.
    pub const Y_RIGHT: Self = Self { up: ModelUp::Y, handed: Handed::Right };

    /// The mirror image of a point or a direction with left-handed axes, in right-handed ones with the same
    /// axis up: the axis that points away from whoever looks with x to the right is turned around. With
    /// right-handed axes nothing changes.
    #[must_use]
    pub fn right_handed<T: Default + Sub<Output = T>>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        // As differences, so that no zero becomes a negative one.
        match (self.handed, self.up) {
            (Handed::Right, _) => [x, y, z],
            (Handed::Left, ModelUp::Y) => [x, y, T::default() - z],
            (Handed::Left, ModelUp::Z) => [x, T::default() - y, z],
        }
    }

    /// A direction in the axes of the model, by how far it goes to the front, to the left and up.
    ///
    /// The front is x where z is up. Where y is up, it is z, as of glTF, and -z in left-handed axes, where
    /// cameras look along z.
    #[must_use]
    pub fn direction(self, [front, left, up]: [f64; 3]) -> [f64; 3] {
        let turned = match self.up {
            ModelUp::Y => [left, up, front],
            ModelUp::Z => [front, left, up],
        };
        self.right_handed(turned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_known_programs() {
        let at = [1.0, 2.0, 3.0];
        assert_eq!(Orientation::default().direction(at), at);
        // glTF: whoever looks at the front has the model's left at the right.
        assert_eq!(Orientation::Y_RIGHT.direction(at), [2.0, 3.0, 1.0]);
        // POV-Ray: z leads away from whoever looks.
        assert_eq!(Orientation::Y_LEFT.direction(at), [2.0, 3.0, -1.0]);
        assert_eq!(Orientation::Y_LEFT.right_handed(at), [1.0, 2.0, -3.0]);
        let z_left = Orientation { up: ModelUp::Z, handed: Handed::Left };
        assert_eq!(z_left.direction(at), [1.0, -2.0, 3.0]);
        assert_eq!(Handed::Left.other().other(), Handed::Left);
    }
}
