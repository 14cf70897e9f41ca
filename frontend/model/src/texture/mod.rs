//! Textures: patterns in space that mix two values of an attribute group. One file per member, one list.
//!
//! A texture gives every place a number t from 0 to 1, and an attribute node mixes two values with it,
//! `(1 - t) a + t b`, for a group of any width. The place is in the node's own space, so maps and warps above
//! the node move the pattern, and maps and warps below the node do not.
//!
//! A file has the same parts in the same order: what the texture is, its parameters, the plain formula in f64
//! (the oracle), the same formula over [`Domain`] (the compiler), tests. To add one: write its file, add its
//! line to the list below.
//!
//! A texture is not differentiated, and takes any coordinates: coordinates beyond [`LARGEST_CELL`] cells,
//! infinities and NaN count as the ends of that range, so t is always a number in [0, 1].

use glam::DVec3;
use jbt_ir::Domain;

use crate::field::{Field, FieldValue};
use crate::member::Member as _;
use crate::skeleton::emit_unit;

mod cells;
mod member;

pub use cells::LARGEST_CELL;
use cells::{
    ROUND, cell, cell_kink_distance, emit_cell, emit_dot, emit_odd, emit_smooth, emit_wave, first_three,
    smooth, wave,
};
pub use member::TextureMember;

macro_rules! textures {
    ($($module:ident :: $name:ident),+ $(,)?) => {
        $( mod $module; pub use $module::$name; pub(crate) use $module::describe as $module; )+

        /// A texture of any kind.
        #[derive(Clone, PartialEq, Debug)]
        pub enum Texture { $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name($name), )+ }

        /// The kind of a texture and the variant of its code: what selects code.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum TextureKind { $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name(u8), )+ }

        $( impl From<$name> for Texture { fn from(texture: $name) -> Self { Self::$name(texture) } } )+

        impl TextureKind {
            /// Every kind with variant 0, in the order of the list.
            pub const ALL: &'static [Self] = &[ $( Self::$name(0), )+ ];

            /// The word of the text format.
            #[must_use]
            pub const fn name(self) -> &'static str { match self { $( Self::$name(_) => $name::NAME, )+ } }

            /// The name of the constructor in [`builder`](crate::builder).
            #[must_use]
            pub const fn constructor(self) -> &'static str { match self { $( Self::$name(_) => stringify!($module), )+ } }

            /// The parameters.
            #[must_use]
            pub const fn fields(self) -> &'static [Field] { match self { $( Self::$name(_) => $name::FIELDS, )+ } }

            /// The names of the columns of a row.
            #[must_use]
            pub fn columns(self) -> &'static [&'static str] { match self { $( Self::$name(variant) => $name::columns(variant), )+ } }

            /// The texture of this kind with these parameters.
            #[must_use]
            pub fn from_fields(self, values: &[FieldValue]) -> Texture {
                match self { $( Self::$name(_) => Texture::$name($name::from_fields(values)), )+ }
            }

            /// See [`TextureMember::emit`].
            pub fn emit<D: Domain>(self, d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
                match self { $( Self::$name(variant) => $name::emit(d, variant, p, row), )+ }
            }

            /// See [`TextureMember::push_columns`]. Panics if the texture is of another kind.
            pub fn push_columns(self, texture: &Texture, row: &mut Vec<f64>) {
                match (self, texture) {
                    $( (Self::$name(variant), Texture::$name(t)) => t.push_columns(variant, row), )+
                    $( (Self::$name(_), _) )|+ => unreachable!("the kind is that of the texture"),
                }
            }
        }

        impl Texture {
            /// The kind, with variant 0.
            #[must_use]
            pub const fn kind(&self) -> TextureKind { match self { $( Self::$name(_) => TextureKind::$name(0), )+ } }

            /// The kind and the variant of its code; see [`TextureMember::variant`].
            #[must_use]
            pub fn code(&self, depends: bool) -> TextureKind {
                match self { $( Self::$name(t) => TextureKind::$name(t.variant(depends)), )+ }
            }

            /// The parameters, in the order of [`TextureKind::fields`].
            #[must_use]
            pub fn to_fields(&self) -> Vec<FieldValue> { match self { $( Self::$name(t) => t.to_fields(), )+ } }

            /// See [`TextureMember::fault`].
            #[must_use]
            pub fn fault(&self) -> Option<(String, String)> { match self { $( Self::$name(t) => t.fault(), )+ } }

            /// See [`TextureMember::value`].
            #[must_use]
            pub fn value(&self, p: DVec3) -> f64 { match self { $( Self::$name(t) => t.value(p), )+ } }

            /// See [`TextureMember::kink_distance`].
            #[must_use]
            pub fn kink_distance(&self, p: DVec3) -> f64 { match self { $( Self::$name(t) => t.kink_distance(p), )+ } }
        }

        $crate::member::each! { ($) texture $($module)+ }
    };
}

textures! {
    checker::Checker,
    stripes::Stripes,
    gradient::Gradient,
    noise::Noise,
    rings::Rings,
    marble::Marble,
}

#[cfg(test)]
mod testing;
mod veins;
