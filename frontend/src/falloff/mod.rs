//! Falloffs, also called field functions: how a field fades with the distance to a skeleton. One file per member, one list.
//!
//! A falloff is a function of `s = d^2 / R^2`, 1 at the skeleton and 0 from the support radius R outwards, falling monotonically.
//! The compiler's form is written in `u = max(1 - s, 0)` with non-negative terms: exactly 0 outside, monotone in f32 too,
//! never negative.

use jbt_ir::Domain;

/// What a falloff states about itself.
pub trait FalloffMember {
    /// The word of the text format.
    const NAME: &'static str;

    /// The field at `s = d^2 / R^2 >= 0`, plainly.
    fn value(s: f64) -> f64;

    /// The `s` at which the field is `level`, for `0 < level < 1`.
    fn inverse(level: f64) -> f64;

    /// The field over the ops, from `u = max(1 - s, 0)`.
    fn emit<D: Domain>(d: &mut D, u: D::Real) -> D::Real;
}

macro_rules! falloffs {
    ($($module:ident :: $name:ident),+ $(,)?) => {
        $( mod $module; pub use $module::$name; )+

        /// A falloff of any kind.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum Falloff { $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name, )+ }

        impl Falloff {
            /// Every kind, in the order of the list.
            pub const ALL: &'static [Self] = &[ $( Self::$name, )+ ];

            /// The word of the text format.
            #[must_use]
            pub const fn name(self) -> &'static str { match self { $( Self::$name => $name::NAME, )+ } }

            /// See [`FalloffMember::value`].
            #[must_use]
            pub fn value(self, s: f64) -> f64 { match self { $( Self::$name => $name::value(s), )+ } }

            /// See [`FalloffMember::inverse`].
            #[must_use]
            pub fn inverse(self, level: f64) -> f64 { match self { $( Self::$name => $name::inverse(level), )+ } }

            /// See [`FalloffMember::emit`].
            pub fn emit<D: Domain>(self, d: &mut D, u: D::Real) -> D::Real {
                match self { $( Self::$name => $name::emit(d, u), )+ }
            }
        }
    };
}

falloffs! {
    soft::Soft,
    wyvill::Wyvill,
}

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
