//! Affine maps as they are written. One `impl` a member, one list.
//!
//! A map states its word, what stands behind the word, its matrix, and how much its linear part can change with parameters.
//! To add one: write its `impl` into a file of this folder, and its line into the list below.

use glam::DAffine3;

use crate::field::{Field, FieldValue};
use crate::report::Fault;

mod axis;
mod member;
mod rotate;
mod rows;
mod scale;
mod shear;
mod stretch;
mod translate;

pub(crate) use member::Freedom;
use member::MapMember as _;
pub use member::MapShape;

macro_rules! maps {
    ($($(#[$doc:meta])* $module:ident :: $name:ident),+ $(,)?) => {
        /// The kind of an affine map.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum MapKind { $( $(#[$doc])* $name, )+ }

        impl MapKind {
            /// Every kind, in the order of the list.
            pub const ALL: &'static [Self] = &[$( Self::$name ),+];

            /// The word of the text format. Kinds of one word differ in what stands behind it.
            #[must_use]
            pub const fn name(self) -> &'static str { match self { $( Self::$name => $module::$name::WORD, )+ } }

            /// What stands behind the word.
            #[must_use]
            pub const fn shape(self) -> MapShape { match self { $( Self::$name => $module::$name::SHAPE, )+ } }

            /// How much the linear part can change, where its numbers follow parameters.
            pub(crate) const fn freedom(self) -> Freedom { match self { $( Self::$name => $module::$name::FREEDOM, )+ } }

            /// The map that takes the child's space to the parent's, from values as its [`shape`](Self::shape) says.
            ///
            /// An axis without a direction is a fault.
            pub(crate) fn affine(self, values: &[FieldValue]) -> Result<DAffine3, Fault> {
                match self { $( Self::$name => $module::$name::affine(values), )+ }
            }
        }
    };
}

maps! {
    /// A shift.
    translate::Translate,
    /// A rotation by degrees about an axis through the origin, right-handed.
    rotate::RotateDegrees,
    /// The same by radians.
    rotate::RotateRadians,
    /// A uniform scale about the origin.
    scale::Scale,
    /// A scale about the origin, by another factor along each axis.
    scale::ScaleAxes,
    /// A mirror image in a plane through the origin.
    stretch::Reflect,
    /// A scale along a direction.
    stretch::Stretch,
    /// A shear.
    shear::Shear,
    /// The rows of a 3x4 matrix, child to parent.
    rows::Affine,
}

impl MapKind {
    /// The kinds that a word begins.
    pub fn named(word: &str) -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(move |kind| kind.name() == word)
    }

    /// The parameters that are written by name.
    #[must_use]
    pub const fn fields(self) -> &'static [Field] {
        match self.shape() {
            MapShape::Named(fields) => fields,
            MapShape::Number | MapShape::Vector | MapShape::Rows => &[],
        }
    }
}
