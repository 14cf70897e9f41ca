//! Constructors of members, made of their descriptions: one for each skeleton, falloff and texture, a method
//! of [`Tree`] for each warp and affine map, and a function or method of it for each operator.
//!
//! A constructor is called like the file of its member, and takes the parameters in their order. Lists of
//! lengths and flags are left out, since they have defaults: [`Tree::radii`] and [`Tree::closed`] set them.

use super::{Axis, Edge, Number, Pattern, Rows, Vector, leaf, real, vector, vectors};
use crate::combine::{CombinatorKind, SetOperation};
use crate::falloff::FalloffKind;
use crate::map::MapKind;
use crate::skeleton::SkeletonKind;
use crate::texture::TextureKind;
use crate::tree::Tree;
use crate::warp::WarpKind;
use crate::written::{FieldNumber, Radius, WrittenFalloff};

/// Goes through the fields of a member, and hands what they are as arguments, and their values as parameters,
/// on: `arguments! { then (words) () () fields }` is `then! { (words) (arguments) (values) }`.
macro_rules! arguments {
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*)) => {
        $then! { $words ($($taken)*) ($($value)*) }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: f64 $default:tt $($rest:tt)*) => {
        arguments! { $then $words
            ($($taken)* $field: impl Into<Number>,) ($($value)* real($field),) $($rest)* }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: DVec3 $default:tt $($rest:tt)*) => {
        arguments! { $then $words
            ($($taken)* $field: impl Into<Vector>,) ($($value)* vector($field),) $($rest)* }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: Axis $default:tt $($rest:tt)*) => {
        arguments! { $then $words
            ($($taken)* $field: Axis,) ($($value)* vector($field.unit().to_array()),) $($rest)* }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: Edge $default:tt $($rest:tt)*) => {
        arguments! { $then $words
            ($($taken)* $field: Edge,) ($($value)* $field.to_field().into(),) $($rest)* }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: SetOperation $default:tt $($rest:tt)*) => {
        arguments! { $then $words
            ($($taken)* $field: SetOperation,) ($($value)* $field.to_field().into(),) $($rest)* }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: u32 $default:tt $($rest:tt)*) => {
        arguments! { $then $words
            ($($taken)* $field: u32,) ($($value)* real(f64::from($field)),) $($rest)* }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: Matrix $default:tt $($rest:tt)*) => {
        arguments! { $then $words
            ($($taken)* $field: impl Into<Rows>,) ($($value)* rows($field),) $($rest)* }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: Positions $default:tt $($rest:tt)*) => {
        arguments! { $then $words
            ($($taken)* $field: impl IntoIterator<Item = impl Into<Vector>>,) ($($value)* vectors($field),) $($rest)* }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: Lengths ($default:expr) $($rest:tt)*) => {
        arguments! { $then $words ($($taken)*) ($($value)* FieldNumber::Reals(Vec::new()),) $($rest)* }
    };
    ($then:ident $words:tt ($($taken:tt)*) ($($value:tt)*) $field:ident: bool ($default:expr) $($rest:tt)*) => {
        arguments! { $then $words ($($taken)*) ($($value)* real(0.0),) $($rest)* }
    };
}

fn rows(rows: impl Into<Rows>) -> FieldNumber {
    FieldNumber::Reals(rows.into().0.into_iter().flatten().collect())
}

/// Hands the description of a member on, as its documentation, its arguments and their values:
/// `constructor! { then file; description }` is `then! { (file Name documentation) (arguments) (values) }`.
macro_rules! constructor {
    (
        $then:ident $function:ident;
        $(#[doc = $doc:literal])* #[derive $derived:tt] $name:ident { $($fields:tt)* }
    ) => {
        arguments! { $then ($function $name [$($doc)*]) () () $($fields)* }
    };
}

/// A function with the documentation of a member.
macro_rules! documented {
    ($folder:ident $name:ident [$($doc:literal)*] $($function:tt)*) => {
        $(#[doc = $doc])*
        ///
        #[doc = concat!(
            "See [`", stringify!($name), "`](struct@crate::", stringify!($folder), "::", stringify!($name), ")."
        )]
        #[must_use]
        $($function)*
    };
}

macro_rules! skeleton {
    (($function:ident $name:ident $doc:tt) ($($taken:tt)*) ($($value:tt)*)) => {
        documented! { skeleton $name $doc
            /// At the distance `support_radius` from it, the field reaches zero; or it is a
            /// [`surface`](crate::builder::surface) radius.
            pub fn $function($($taken)* support_radius: impl Into<Radius>) -> Tree {
                leaf(SkeletonKind::$name, vec![$($value)*], support_radius)
            }
        }
    };
}

macro_rules! falloff {
    (($function:ident $name:ident $doc:tt) ($($taken:tt)*) ($($value:tt)*)) => {
        documented! { falloff $name $doc
            pub fn $function($($taken)*) -> WrittenFalloff {
                WrittenFalloff::new(FalloffKind::$name(0), vec![$($value)*])
            }
        }
    };
}

macro_rules! texture {
    (($function:ident $name:ident $doc:tt) ($($taken:tt)*) ($($value:tt)*)) => {
        documented! { texture $name $doc
            pub fn $function($($taken)*) -> Pattern {
                Pattern { texture: TextureKind::$name(0), fields: vec![$($value)*] }
            }
        }
    };
}

macro_rules! warp {
    (($function:ident $name:ident $doc:tt) ($($taken:tt)*) ($($value:tt)*)) => {
        documented! { warp $name $doc
            pub fn $function(&self, $($taken)*) -> Self {
                self.warped(WarpKind::$name(0), vec![$($value)*])
            }
        }
    };
}

macro_rules! map {
    (($function:ident $name:ident $doc:tt) ($($taken:tt)*) ($($value:tt)*)) => {
        documented! { map $name $doc
            pub fn $function(&self, $($taken)*) -> Self {
                self.mapped(MapKind::$name, vec![$($value)*])
            }
        }
    };
}

macro_rules! several {
    // These have methods of two trees; `Tree::blend` and `Tree::smooth` take any number.
    ((ricci $($rest:tt)*) $taken:tt $value:tt) => { pair! { (ricci $($rest)*) $taken $value } };
    ((smooth_union $($rest:tt)*) $taken:tt $value:tt) => { pair! { (smooth_union $($rest)*) $taken $value } };
    ((smooth_intersection $($rest:tt)*) $taken:tt $value:tt) => {
        pair! { (smooth_intersection $($rest)*) $taken $value }
    };
    ((smooth_difference $($rest:tt)*) $taken:tt $value:tt) => {
        pair! { (smooth_difference $($rest)*) $taken $value }
    };
    (($function:ident $name:ident $doc:tt) ($($taken:tt)*) ($($value:tt)*)) => {
        documented! { combine $name $doc
            pub fn $function($($taken)* children: impl IntoIterator<Item = Self>) -> Self {
                Self::operator(CombinatorKind::$name, vec![$($value)*], children)
            }
        }
    };
}

macro_rules! pair {
    (($function:ident $name:ident $doc:tt) ($($taken:tt)*) ($($value:tt)*)) => {
        documented! { combine $name $doc
            pub fn $function(&self, $($taken)* other: &Self) -> Self {
                Self::operator(CombinatorKind::$name, vec![$($value)*], [self.clone(), other.clone()])
            }
        }
    };
}

macro_rules! single {
    (($function:ident $name:ident $doc:tt) ($($taken:tt)*) ($($value:tt)*)) => {
        documented! { combine $name $doc
            pub fn $function(&self, $($taken)*) -> Self {
                Self::operator(CombinatorKind::$name, vec![$($value)*], [self.clone()])
            }
        }
    };
}

crate::skeleton::each! { constructor skeleton }
crate::falloff::each! { constructor falloff }
crate::texture::each! { constructor texture }

/// Deformed trees.
impl Tree {
    crate::warp::each! { constructor warp }
}

/// The same trees elsewhere: affine maps.
impl Tree {
    crate::map::each! { constructor map }
}

/// Trees whose fields become one field: operators.
impl Tree {
    crate::combine::several::each! { constructor several }
    crate::combine::single::each! { constructor single }
}
