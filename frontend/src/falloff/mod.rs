//! Falloffs, also called field functions: how a field fades with the distance to a skeleton. One file per member, one list.
//!
//! A falloff is a function g of `s = d^2 / R^2 = r^2`, 1 at the skeleton and 0 from the support radius R outwards, falling
//! monotonically. Published field functions that never reach zero are cut off at R, and an [`Edge`] says how.
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
//! It is written in `u = max(1 - s, 0)`, and in s itself, as a chain of steps of which each one rises or falls with the distance, so that
//!
//! * it is exactly +0 at u = 0, never negative, and monotone in f32 too, because rounding is (but for [`Degree`] and [`InversePower`]
//!   with powers that are not whole, and [`Blinn`]: an approximated power may step back by a unit in the last place);
//! * a range of distances gives the exact image of it, the same values as at its ends: no difference of two terms that move together makes it
//!   wider (where there are powers or exponentials, it is wider by their 4 units in the last place);
//! * its derivative is finite everywhere: r is a root, whose tangent at 0 is 0.
//!
//! The root of `1 - u` is off by 2^-25 / r, because u has lost the last digits of a small s: at most 2^-13. Falloffs with a tip would show it, in
//! the field and much more in its gradient, so [`Linear`], [`ArcTan`] and [`InversePower`] take the root of s. Others, which are flat at the
//! skeleton, have all that follows from u alone, so that pieces of them meet.
//!
//! Polynomials in r are not such chains as they are published. Their files say by what they are replaced.

use jbt_ir::Domain;

use crate::field::{Field, FieldValue, Member};
use crate::skeleton::positive_part;

mod edge;

pub use edge::{Edge, Rim};

/// How near a point is to the skeleton, over the ops: what falloffs are functions of.
#[derive(Clone, Copy, Debug)]
pub struct Nearness<R> {
    /// `max(1 - s, 0)`: exactly 0 from the support radius outwards, with all its digits in front of it.
    pub u: R,
    /// Two factors of `-s`.
    square: R,
    slope: R,
}

impl<R: Copy> Nearness<R> {
    /// From two factors of `-s`: the squared distance and `-1 / R^2`. NaN is outside.
    pub fn emit<D: Domain<Real = R>>(d: &mut D, square: R, slope: R) -> Self {
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let left = d.fma(square, slope, one);
        Self { u: d.max(left, zero), square, slope }
    }

    /// `min(s, 1)`, with all its digits near the skeleton. Where it moves, u is above 0.
    fn square<D: Domain<Real = R>>(self, d: &mut D) -> R {
        let (one, back) = (d.constant(1.0), d.mul(self.square, self.slope));
        let s = d.neg(back);
        d.min(s, one)
    }

    /// `r`, the root of that.
    fn distance<D: Domain<Real = R>>(self, d: &mut D) -> R {
        let s = self.square(d);
        d.sqrt(s)
    }
}

/// What a falloff without parameters states about itself.
pub trait PlainFalloff {
    /// The word of the text format.
    const NAME: &'static str;
    /// Other words that are read as this one.
    const ALIASES: &'static [&'static str];
    /// See [`FalloffMember::steepness`].
    const STEEPNESS: f64;
    /// See [`FalloffMember::is_pointed`].
    const IS_POINTED: bool = false;

    /// The field at `s = d^2 / R^2 >= 0`, plainly.
    fn value(s: f64) -> f64;

    /// The `s` at which the field is `level`, for `0 < level < 1`.
    fn inverse(level: f64) -> f64;

    /// The field over the ops.
    fn emit<D: Domain>(d: &mut D, near: Nearness<D::Real>) -> D::Real;
}

/// What a falloff with parameters states about itself.
pub trait FalloffMember: Member {
    /// Other words that are read as its name.
    const ALIASES: &'static [&'static str];

    /// The field at `s = d^2 / R^2 >= 0`, plainly.
    fn value(&self, s: f64) -> f64;

    /// The `s` at which the field is `level`, for `0 < level < 1`. Where the field jumps over the level: where it jumps.
    fn inverse(&self, level: f64) -> f64;

    /// A bound of the factors that the derivative by u multiplies where u is 0, and of their products: supports rest on it.
    fn steepness(&self) -> f64;

    /// Whether the field has a tip at the skeleton: its slope in r is not 0 there, so that the gradient jumps.
    fn is_pointed(&self) -> bool;

    /// The part of the parameters that selects code. If a parameter follows one of the model, `follows`, code serves all its values.
    fn variant(&self, follows: bool) -> u8;

    /// The names of the columns of a row, for this variant.
    fn column_names(variant: u8) -> &'static [&'static str];

    /// The numbers of a row: one for each of [`column_names`](Self::column_names).
    fn columns(&self, variant: u8, row: &mut Vec<f64>);

    /// The field over the ops; `row` holds the columns of a falloff with this variant.
    fn emit<D: Domain>(d: &mut D, variant: u8, near: Nearness<D::Real>, row: &[D::Real]) -> D::Real;
}

macro_rules! falloffs {
    (
        plain { $($module:ident :: $name:ident),+ $(,)? }
        with_parameters { $($rich_module:ident :: $rich:ident),+ $(,)? }
    ) => {
        $( mod $module; pub use $module::$name; )+
        $( mod $rich_module; pub use $rich_module::$rich; )+

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
            /// The kind, and the variant for these very numbers.
            #[must_use]
            pub fn kind(&self) -> FalloffKind { self.code(false) }

            /// The kind, and the variant whose code serves these numbers or, if they follow a parameter, all numbers.
            #[must_use]
            pub fn code(&self, follows: bool) -> FalloffKind {
                match self {
                    $( Self::$name => FalloffKind::$name, )+
                    $( Self::$rich(falloff) => FalloffKind::$rich(falloff.variant(follows)), )+
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

            /// The numbers of a row, for code of this kind and variant: one for each of [`FalloffKind::columns`].
            pub fn columns(&self, code: FalloffKind, row: &mut Vec<f64>) {
                match self { $( Self::$name => {} )+ $( Self::$rich(falloff) => falloff.columns(code.variant(), row), )+ }
            }
        }
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

impl FalloffKind {
    /// The kind that this word of the text format names, by its name or by another one.
    #[must_use]
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == word || kind.aliases().contains(&word))
    }
}

#[cfg(test)]
mod testing;

/// The `s` in [0, 1] where a falling `value` passes `level`.
fn bisect(value: impl Fn(f64) -> f64, level: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > f64::EPSILON * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if value(middle) >= level { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The exponent as a whole number, if it is one in [1, `most`]: then it is code.
fn whole(exponent: f64, most: u8) -> Option<u8> {
    let n = exponent as u8;
    (f64::from(n) == exponent && (1..=most).contains(&n)).then_some(n)
}

/// `s = 1 - u`, from 0 to 1, for falloffs that are flat at the skeleton.
fn emit_square<D: Domain>(d: &mut D, u: D::Real) -> D::Real {
    let one = d.constant(1.0);
    let s = d.sub(one, u);
    positive_part(d, s)
}

/// `r = sqrt(1 - u)`, from 0 to 1, for falloffs that are flat at the skeleton.
fn emit_distance<D: Domain>(d: &mut D, u: D::Real) -> D::Real {
    let s = emit_square(d, u);
    d.sqrt(s)
}

/// `1 - r = u / (1 + r)`: this form is exactly 0 at the rim and rises with u.
fn emit_depth<D: Domain>(d: &mut D, u: D::Real, r: D::Real) -> D::Real {
    let one = d.constant(1.0);
    let sum = d.add(one, r);
    d.div(u, sum)
}

/// `value`, or exactly 0 at u = 0.
fn emit_inside<D: Domain>(d: &mut D, u: D::Real, value: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    let inside = d.lt(zero, u);
    d.select(inside, value, zero)
}
