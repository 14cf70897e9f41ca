//! Falloffs, also called field functions: how a field fades with the distance to a skeleton. One file per
//! member, one list.
//!
//! A falloff is a function g of `s = d^2 / R^2 = r^2`, 1 at the skeleton and 0 from the support radius R
//! outwards, falling monotonically. Published field functions that never reach zero are cut off at R, and an
//! [`Edge`] says how.
//!
//! | falloff | g, with `u = 1 - s` | 1/2 at r | steepest, in r | at the rim |
//! |---|---|---|---|---|
//! | `soft` | `u^2 (5 + 4u) / 9` | 0.5 | 1.583 at 0.504 | C1 |
//! | `wyvill` | `u^3` | 0.4542 | 1.717 at 0.447 | C2 |
//! | `quartic` | `u^2` | 0.5412 | 1.540 at 0.577 | C1 |
//! | `metaball` | `1 - 3r^2`, then `3/2 (1 - r)^2` | 0.4226 | 2 at 1/3 | C1 |
//! | `hermite` | `1 - 3r^2 + 2r^3` | 0.5 | 1.5 at 0.5 | C1 |
//! | `quintic` | `1 - 10r^3 + 15r^4 - 6r^5` | 0.5 | 1.875 at 0.5 | C2 |
//! | `linear` | `1 - r` | 0.5 | 1 | C0 |
//! | `degree` | `u^n` | `sqrt(1 - 2^(-1/n))` | at `1/sqrt(2n - 1)` | C(n-1) |
//! | `blinn` | `exp(-h c^2 s)` | `sqrt(ln 2 / h) / c` | at `1 / (c sqrt(2h))` | its edge |
//! | `arctan` | `1/2 + atan(p - 2pr) / (2 atan p)` | 0.5 | `p / atan p` at 0.5 | C0, or its edge |
//! | `inverse_power` | `1 / (1 + (c r)^n)` | `1 / c` | near it | its edge |
//! | `blanc` | two rational pieces | 0.5 | `2 + 16/9 p` at 0.5, about | C1 |
//!
//! # The compiler's form
//!
//! The form is written in `u = max(1 - s, 0)`, and in s, as a chain of steps that are each monotone in the
//! distance, so that
//!
//! * it is exactly +0 at u = 0, never negative, and monotone in f32 too, because rounding is monotone (except
//!   for [`Degree`] and [`InversePower`] with powers that are not whole, and [`Blinn`]: an approximated power
//!   may step back by a unit in the last place);
//! * a range of distances gives its exact image, between the values at its ends: no difference of two terms
//!   that move together widens it (powers and exponentials widen it by 4 units in the last place);
//! * its derivative is finite everywhere: r is a root, whose tangent at 0 is 0.
//!
//! The root of `1 - u` is off by 2^-25 / r, at most 2^-13, because u has lost the last digits of a small s.
//! Falloffs with a tip would show it, in the field and much more in the gradient, so [`Linear`], [`ArcTan`]
//! and [`InversePower`] take the root of s. The other falloffs are flat at the skeleton and compute
//! everything from u, so that their pieces meet.
//!
//! Polynomials in r are no such chains as published. Each file says what replaces its polynomial.

use jbt_ir::Domain;

use crate::field::{Field, FieldOf, FieldValue, NumberText};
use crate::member::Member as _;

mod edge;
mod formulas;
mod member;

pub use edge::Edge;
use formulas::{bisect, emit_depth, emit_distance, emit_inside, emit_square, whole};
pub use member::{FalloffMember, Nearness, PlainFalloff};

macro_rules! falloffs {
    (
        plain { $($module:ident :: $name:ident),+ $(,)? }
        with_parameters { $($rich_module:ident :: $rich:ident),+ $(,)? }
    ) => {
        $( mod $module; pub use $module::$name; )+
        $( mod $rich_module; pub use $rich_module::$rich; pub(crate) use $rich_module::describe as $rich_module; )+

        /// A falloff of any kind.
        #[derive(Clone, Copy, PartialEq, Debug)]
        pub enum Falloff {
            $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name, )+
            $( #[doc = concat!("See [`", stringify!($rich), "`](struct@", stringify!($rich), ").")] $rich($rich), )+
        }

        /// The kind of a falloff and the variant of its code: what selects code.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum FalloffKind {
            $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name, )+
            $( #[doc = concat!("See [`", stringify!($rich), "`](struct@", stringify!($rich), ").")] $rich(u8), )+
        }

        $( impl From<$name> for Falloff { fn from(_: $name) -> Self { Self::$name } } )+
        $( impl From<$rich> for Falloff { fn from(falloff: $rich) -> Self { Self::$rich(falloff) } } )+

        impl FalloffKind {
            /// Every kind with variant 0, in the order of the list.
            pub const ALL: &'static [Self] = &[ $( Self::$name, )+ $( Self::$rich(0), )+ ];

            /// The word of the text format.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $( Self::$name => $name::NAME, )+ $( Self::$rich(_) => $rich::NAME, )+ }
            }

            /// Other words of the text format that are read as this one.
            #[must_use]
            pub const fn aliases(self) -> &'static [&'static str] {
                match self { $( Self::$name => $name::ALIASES, )+ $( Self::$rich(_) => $rich::ALIASES, )+ }
            }

            /// The name of its constructor, which stands in [`builder`](crate::builder) if it has parameters.
            #[must_use]
            pub const fn constructor(self) -> &'static str {
                match self { $( Self::$name => stringify!($module), )+ $( Self::$rich(_) => stringify!($rich_module), )+ }
            }

            /// The parameters.
            #[must_use]
            pub const fn fields(self) -> &'static [Field] {
                match self { $( Self::$name => &[], )+ $( Self::$rich(_) => $rich::FIELDS, )+ }
            }

            /// The names of the columns of a row.
            #[must_use]
            pub fn columns(self) -> &'static [&'static str] {
                match self { $( Self::$name => &[], )+ $( Self::$rich(variant) => $rich::column_names(variant), )+ }
            }

            /// The falloff of this kind with these parameters.
            #[must_use]
            pub fn from_fields(self, values: &[FieldValue]) -> Falloff {
                match self {
                    $( Self::$name => Falloff::$name, )+
                    $( Self::$rich(_) => Falloff::$rich($rich::from_fields(values)), )+
                }
            }

            /// The field over the ops; `row` holds the columns.
            pub fn emit<D: Domain>(self, d: &mut D, near: Nearness<D::Real>, row: &[D::Real]) -> D::Real {
                match self {
                    $( Self::$name => $name::emit(d, near), )+
                    $( Self::$rich(variant) => $rich::emit(d, variant, near, row), )+
                }
            }

            /// The same kind with variant 0.
            #[must_use]
            pub const fn base(self) -> Self {
                match self { $( Self::$name => Self::$name, )+ $( Self::$rich(_) => Self::$rich(0), )+ }
            }

            const fn variant(self) -> u8 {
                match self { $( Self::$name => 0, )+ $( Self::$rich(variant) => variant, )+ }
            }
        }

        impl Falloff {
            /// The kind, and the variant for exactly these numbers.
            #[must_use]
            pub fn kind(&self) -> FalloffKind { self.code(false) }

            /// The kind, and the variant whose code serves these numbers or, if the numbers follow a
            /// parameter, all numbers.
            #[must_use]
            #[inline]
            pub fn code(&self, depends: bool) -> FalloffKind {
                match self {
                    $( Self::$name => FalloffKind::$name, )+
                    $( Self::$rich(falloff) => FalloffKind::$rich(falloff.variant(depends)), )+
                }
            }

            /// The word of the text format.
            #[must_use]
            pub const fn name(&self) -> &'static str {
                match self { $( Self::$name => $name::NAME, )+ $( Self::$rich(_) => $rich::NAME, )+ }
            }

            /// The parameters, in the order of [`FalloffKind::fields`].
            #[must_use]
            pub fn to_fields(&self) -> Vec<FieldValue> {
                match self { $( Self::$name => Vec::new(), )+ $( Self::$rich(falloff) => falloff.to_fields(), )+ }
            }

            /// See [`FalloffMember::value`].
            #[must_use]
            pub fn value(&self, s: f64) -> f64 {
                match self { $( Self::$name => $name::value(s), )+ $( Self::$rich(falloff) => falloff.value(s), )+ }
            }

            /// See [`FalloffMember::inverse`].
            #[must_use]
            pub fn inverse(&self, level: f64) -> f64 {
                match self { $( Self::$name => $name::inverse(level), )+ $( Self::$rich(falloff) => falloff.inverse(level), )+ }
            }

            /// See [`FalloffMember::steepness`].
            #[must_use]
            pub fn steepness(&self) -> f64 {
                match self { $( Self::$name => $name::STEEPNESS, )+ $( Self::$rich(falloff) => falloff.steepness(), )+ }
            }

            /// See [`FalloffMember::is_pointed`].
            #[must_use]
            pub fn is_pointed(&self) -> bool {
                match self { $( Self::$name => $name::IS_POINTED, )+ $( Self::$rich(falloff) => falloff.is_pointed(), )+ }
            }

            /// The numbers of a row, for code of this kind and variant: one for each of
            /// [`FalloffKind::columns`].
            pub fn columns(&self, code: FalloffKind, row: &mut Vec<f64>) {
                match self { $( Self::$name => {} )+ $( Self::$rich(falloff) => falloff.columns(code.variant(), row), )+ }
            }
        }

        $crate::member::each! { ($) falloff $($rich_module)+ }
    };
}

falloffs! {
    plain {
        soft::Soft,
        wyvill::Wyvill,
        quartic::Quartic,
        metaball::Metaball,
        hermite::Hermite,
        quintic::Quintic,
        linear::Linear,
    }
    with_parameters {
        degree::Degree,
        blinn::Blinn,
        arctan::ArcTan,
        inverse_power::InversePower,
        blanc::Blanc,
    }
}

impl Falloff {
    /// The falloff as text, with parameters that differ from their defaults in braces.
    pub(crate) fn text(&self) -> String {
        self.kind().text(&self.to_fields())
    }
}

impl FalloffKind {
    /// A falloff of this kind as text, with parameters that differ from their defaults in braces.
    pub fn text<T: NumberText>(self, fields: &[FieldOf<T>]) -> String {
        let mut text = String::new();
        for (described, value) in self.fields().iter().zip(fields) {
            described.write(&mut text, described.name, value);
        }
        if text.is_empty() { self.name().to_owned() } else { format!("{} {{{text} }}", self.name()) }
    }

    /// The kind whose name or synonym this word of the text format is.
    #[must_use]
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == word || kind.aliases().contains(&word))
    }
}

#[cfg(test)]
mod testing;
