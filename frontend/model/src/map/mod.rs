//! Affine maps as they are written. One file a member, one list.
//!
//! A map states its parameters, its matrix, and how much its linear part can change with parameters. To add
//! one: write its file, add its line to the list below.

use glam::DAffine3;

use crate::field::{Field, FieldValue};
use crate::member::Member as _;
use crate::report::Fault;

mod axis;
mod member;

pub use member::Freedom;
use member::MapMember as _;

macro_rules! maps {
    ($($module:ident :: $name:ident),+ $(,)?) => {
        $( mod $module; pub use $module::$name; pub(crate) use $module::describe as $module; )+

        /// The kind of an affine map.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum MapKind { $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name, )+ }

        impl MapKind {
            /// Every kind, in the order of the list.
            pub const ALL: &'static [Self] = &[$( Self::$name ),+];

            /// The word of the text format. Kinds may share a word; their parameters tell them apart.
            #[must_use]
            pub const fn name(self) -> &'static str { match self { $( Self::$name => $name::NAME, )+ } }

            /// The name of the constructor in [`builder`](crate::builder).
            #[must_use]
            pub const fn constructor(self) -> &'static str { match self { $( Self::$name => stringify!($module), )+ } }

            /// The parameters.
            #[must_use]
            pub const fn fields(self) -> &'static [Field] { match self { $( Self::$name => $name::FIELDS, )+ } }

            /// Whether the parameters are written by name. Otherwise there is one, whose value stands behind
            /// the word.
            #[must_use]
            pub const fn is_named(self) -> bool { match self { $( Self::$name => $name::NAMED, )+ } }

            /// How much the linear part can change, where its numbers depend on parameters.
            pub(crate) const fn freedom(self) -> Freedom { match self { $( Self::$name => $name::FREEDOM, )+ } }

            /// The map that takes the child's space to the parent's, from the values of its parameters.
            ///
            /// An axis without a direction is a fault.
            pub(crate) fn affine(self, values: &[FieldValue]) -> Result<DAffine3, Fault> {
                match self { $( Self::$name => $name::from_fields(values).affine(), )+ }
            }
        }

        $crate::member::each! { ($) map $($module)+ }
    };
}

maps! {
    translate::Translate,
    rotate::Rotate,
    rotate_radians::RotateRadians,
    scale::Scale,
    scale_axes::ScaleAxes,
    reflect::Reflect,
    stretch::Stretch,
    shear::Shear,
    affine::Affine,
}

impl MapKind {
    /// The kinds that a word begins.
    pub fn named(word: &str) -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(move |kind| kind.name() == word)
    }
}
