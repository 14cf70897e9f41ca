//! The op table: one row per op, and everything that derives from a row.
//!
//! A row gives the op's name in Rust and in text, its operand types, its result type, flags (`Flags` tells
//! what they mean), and a doc that *defines* it: rounding, NaN and signed zero. From the table come
//!
//! * [`Op`], its names and its type rule (the printer, the parser and the verifier read these),
//! * [`Domain`], the trait with one method per op and **no default**: a meaning of the ops is one `impl
//!   Domain` in one file of [`crate::domain`] (or the machine-code lowering of the `jit` crate), and an op
//!   that lacks a meaning somewhere does not compile,
//! * [`apply`], which calls the method of an op that is known only at run time,
//! * [`for_each_op!`](crate::for_each_op), which hands the rows to any macro: code that treats all ops alike
//!   is derived from it.
//!
//! ```text
//!                 op table ──► enum Op ──► text, verifier, passes
//!                     │
//!                     └──► trait Domain ◄── scalar, lanes, interval, tangent, counting, FunctionBuilder, Cranelift
//! ```
//!
//! All arithmetic is IEEE 754 binary32, round to nearest even, subnormals kept, no traps. "Gives NaN" means
//! some NaN: its sign and payload are unspecified, and two engines agree when both give a NaN.

use std::fmt;

/// The type of a value: what one lane holds.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Type {
    /// A binary32 number.
    Real,
    /// A truth value.
    Mask,
    /// 32 uninterpreted bits, for exponents and hashes.
    Bits,
}

impl Type {
    /// All types.
    pub const ALL: [Self; 3] = [Self::Real, Self::Mask, Self::Bits];

    /// The name in the text form.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Real => "real",
            Self::Mask => "mask",
            Self::Bits => "bits",
        }
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A value of a domain whose type is known only at run time.
#[derive(Debug)]
pub enum Any<D: Domain + ?Sized> {
    /// A real.
    Real(D::Real),
    /// A mask.
    Mask(D::Mask),
    /// Bits.
    Bits(D::Bits),
}

impl<D: Domain + ?Sized> Clone for Any<D> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D: Domain + ?Sized> Copy for Any<D> {}

impl<D: Domain + ?Sized> Any<D> {
    /// The real. Panics on another type: the verifier has excluded it.
    #[inline(always)]
    pub fn real(self) -> D::Real {
        match self {
            Self::Real(value) => value,
            Self::Mask(_) | Self::Bits(_) => panic!("a verified function has a real here"),
        }
    }

    /// The mask. Panics on another type: the verifier has excluded it.
    #[inline(always)]
    pub fn mask(self) -> D::Mask {
        match self {
            Self::Mask(value) => value,
            Self::Real(_) | Self::Bits(_) => panic!("a verified function has a mask here"),
        }
    }

    /// The bits. Panics on another type: the verifier has excluded it.
    #[inline(always)]
    pub fn bits(self) -> D::Bits {
        match self {
            Self::Bits(value) => value,
            Self::Real(_) | Self::Mask(_) => panic!("a verified function has bits here"),
        }
    }
}

/// The Rust type, the `Type` and the accessor of a type word of the table.
macro_rules! of_type {
    (rust real) => {
        Self::Real
    };
    (rust mask) => {
        Self::Mask
    };
    (rust bits) => {
        Self::Bits
    };
    (value real) => {
        Type::Real
    };
    (value mask) => {
        Type::Mask
    };
    (value bits) => {
        Type::Bits
    };
    (get real $any:expr) => {
        $any.real()
    };
    (get mask $any:expr) => {
        $any.mask()
    };
    (get bits $any:expr) => {
        $any.bits()
    };
    (wrap real $value:expr) => {
        Any::Real($value)
    };
    (wrap mask $value:expr) => {
        Any::Mask($value)
    };
    (wrap bits $value:expr) => {
        Any::Bits($value)
    };
}

/// What a row says of its op beside the types. Flags that a row does not name are false.
#[derive(Clone, Copy)]
struct Flags {
    /// The `legalize` pass writes it out.
    expanded: bool,
    /// The first two operands may be swapped.
    commutes: bool,
    /// The result has the bits of the operand.
    renames: bool,
}

impl Flags {
    const NONE: Self = Self { expanded: false, commutes: false, renames: false };
}

macro_rules! op_table {
    ($(
        $(#[doc = $doc:literal])*
        $variant:ident $name:ident ( $($arg:ident : $type:ident),+ ) -> $result:ident $(, $flag:ident)*;
    )+) => {
        /// An operation on lanes: pure, total, and the same in each lane.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum Op {
            $( $(#[doc = $doc])* $variant, )+
        }

        impl Op {
            /// Every op, in the order of the table.
            pub const ALL: &[Self] = &[ $( Self::$variant, )+ ];

            /// The name in the text form; also the name of the method of [`Domain`].
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $( Self::$variant => stringify!($name), )+ }
            }

            /// The operand types, at most three.
            #[must_use]
            pub const fn operands(self) -> &'static [Type] {
                match self { $( Self::$variant => &[ $( of_type!(value $type), )+ ], )+ }
            }

            /// The type of the one result.
            #[must_use]
            pub const fn result(self) -> Type {
                match self { $( Self::$variant => of_type!(value $result), )+ }
            }

            const fn flags(self) -> Flags {
                match self { $( Self::$variant => Flags { $($flag: true,)* ..Flags::NONE }, )+ }
            }

            /// Whether the `legalize` pass replaces it by other ops: engines never meet it.
            #[must_use]
            pub const fn is_expanded(self) -> bool {
                self.flags().expanded
            }

            /// Whether it is the slope of a value: one of the whole function, which no op has alone.
            #[must_use]
            pub const fn is_slope(self) -> bool {
                matches!(self, Self::SlopeX | Self::SlopeY | Self::SlopeZ)
            }

            /// Whether swapping the first two operands gives the same bits (a NaN for a NaN).
            #[must_use]
            pub const fn commutes(self) -> bool {
                self.flags().commutes
            }

            /// Whether the result has the bits of the operand: then it costs nothing.
            #[must_use]
            pub const fn renames(self) -> bool {
                self.flags().renames
            }

            /// The definition: the doc of the row.
            #[must_use]
            pub const fn definition(self) -> &'static str {
                match self { $( Self::$variant => concat!($( $doc, "\n" ),*), )+ }
            }
        }

        /// A meaning of the ops. One method per op, and no defaults: a new op that lacks a meaning does not
        /// compile.
        // `from_bits` takes the domain, as every op does.
        #[allow(clippy::wrong_self_convention)]
        pub trait Domain {
            /// What a real is in this domain.
            type Real: Copy;
            /// What a mask is in this domain.
            type Mask: Copy;
            /// What bits are in this domain.
            type Bits: Copy;

            /// The same number in every lane.
            fn constant(&mut self, value: f32) -> Self::Real;
            /// The same bits in every lane.
            fn bits_constant(&mut self, value: u32) -> Self::Bits;

            $(
                $(#[doc = $doc])*
                fn $name(&mut self, $($arg: of_type!(rust $type)),+) -> of_type!(rust $result);
            )+
        }

        /// Calls the method of `op`. Panics if `args` do not fit [`Op::operands`]: the verifier has excluded
        /// it.
        #[inline(always)]
        pub fn apply<D: Domain + ?Sized>(domain: &mut D, op: Op, args: &[Any<D>]) -> Any<D> {
            match op {
                $(
                    Op::$variant => {
                        let [$($arg),+] = args else {
                            panic!("a verified function has the operands of the table")
                        };
                        of_type!(wrap $result domain.$name($( of_type!(get $type (*$arg)) ),+))
                    }
                )+
            }
        }
    };
}

/// Hands the rows of the op table to a macro, which takes them in this form:
///
/// ```text
/// $( $(#[doc = $doc:literal])*
///    $variant:ident $name:ident ( $($arg:ident : $type:ident),+ ) -> $result:ident $(, $flag:ident)*; )+
/// ```
///
/// A builder, a counter or a dispatch that treats all ops alike is written once.
#[macro_export]
macro_rules! for_each_op {
    ($callback:ident) => {
        $callback! {
            // ── arithmetic ───────────────────────────────────────────────────────────────────────────

            /// `a + b`, rounded once. `-0 + -0 = -0`, every other zero sum is `+0`. `inf - inf` gives NaN.
            Add add(a: real, b: real) -> real, commutes;
            /// `a - b`, rounded once. `x - x = +0` for finite x.
            Sub sub(a: real, b: real) -> real;
            /// `a * b`, rounded once; the sign is the exclusive or of the signs. `0 * inf` gives NaN.
            Mul mul(a: real, b: real) -> real, commutes;
            /// `a / b`, rounded once. `x / 0` is an infinity with the sign of both, `0 / 0` and `inf / inf`
            /// give NaN.
            Div div(a: real, b: real) -> real;
            /// `a * b + c` with **one** rounding, in every engine. An exact zero sum is `+0` unless both
            /// parts are `-0`.
            Fma fma(a: real, b: real, c: real) -> real, commutes;
            /// Flips the sign bit, of zeros and NaNs too.
            Neg neg(a: real) -> real;
            /// Clears the sign bit, of zeros and NaNs too.
            Abs abs(a: real) -> real;
            /// The square root, rounded once. `sqrt(-0) = -0`; below zero it gives NaN. Its tangent at 0 is
            /// 0.
            Sqrt sqrt(a: real) -> real;
            /// `if a < b { a } else { b }`: b if either is NaN, b if both are zeros. Does not commute.
            Min min(a: real, b: real) -> real;
            /// `if a > b { a } else { b }`: b if either is NaN, b if both are zeros. Does not commute.
            Max max(a: real, b: real) -> real;

            // ── decisions ────────────────────────────────────────────────────────────────────────────

            /// `a < b`; false if either is NaN. Zeros of either sign are equal.
            Lt lt(a: real, b: real) -> mask;
            /// `a <= b`; false if either is NaN. Zeros of either sign are equal.
            Le le(a: real, b: real) -> mask;
            /// `a == b`; false if either is NaN. Zeros of either sign are equal.
            Eq eq(a: real, b: real) -> mask, commutes;
            /// True where both are.
            Both both(a: mask, b: mask) -> mask, commutes;
            /// True where at least one is.
            Either either(a: mask, b: mask) -> mask, commutes;
            /// True where the operand is not.
            Not not(a: mask) -> mask;
            /// `if condition { a } else { b }`: the bits of one of them, whatever the other holds.
            Select select(condition: mask, a: real, b: real) -> real;

            // ── bits ─────────────────────────────────────────────────────────────────────────────────

            /// The encoding of a real.
            ToBits to_bits(a: real) -> bits, renames;
            /// The real with this encoding.
            FromBits from_bits(a: bits) -> real, renames;
            /// Bitwise and.
            BitAnd bit_and(a: bits, b: bits) -> bits, commutes;
            /// Bitwise or.
            BitOr bit_or(a: bits, b: bits) -> bits, commutes;
            /// Bitwise exclusive or.
            BitXor bit_xor(a: bits, b: bits) -> bits, commutes;
            /// Sum modulo 2^32.
            IntAdd int_add(a: bits, b: bits) -> bits, commutes;
            /// Difference modulo 2^32.
            IntSub int_sub(a: bits, b: bits) -> bits;
            /// `a << (by mod 32)`. The verifier wants `by` to be a constant: vector units shift all lanes
            /// alike.
            Shl shl(a: bits, by: bits) -> bits;
            /// `a >> (by mod 32)`, zeros coming in. The verifier wants `by` to be a constant.
            Shr shr(a: bits, by: bits) -> bits;

            // ── transcendentals: stay whole through the gradient, then `legalize` expands them by
            // `crate::math`

            /// The sine of radians. `sin(-0) = -0`; infinities give NaN; a finite angle beyond
            /// [`crate::math::LARGEST_ANGLE`] counts as a zero of its sign. See [`crate::math`] for its
            /// error.
            Sin sin(a: real) -> real, expanded;
            /// The cosine of radians; infinities give NaN; a finite angle beyond
            /// [`crate::math::LARGEST_ANGLE`] counts as zero. See [`crate::math`] for its error.
            Cos cos(a: real) -> real, expanded;
            /// e to the power a. Overflows to infinity, underflows through the subnormals; `exp(0) = 1`,
            /// `exp(-inf) = 0`. See [`crate::math`] for its error.
            Exp exp(a: real) -> real, expanded;
            /// The natural logarithm. `ln(1) = +0`, `ln(-0) = ln(0) = -inf`; below zero it gives NaN. See
            /// [`crate::math`] for its error.
            Ln ln(a: real) -> real, expanded;
            /// `a` to the power `b`, for `a >= 0`. `pow(1, b) = 1` and `pow(a, 0) = 1` for every other
            /// operand, NaN and negative ones too; else a NaN or a negative `a` gives NaN. Exactly: `pow(0,
            /// b)` is `+0` for b > 0 and inf for b < 0, for zeros of either sign. See [`crate::math`] for its
            /// error.
            Pow pow(a: real, b: real) -> real, expanded;

            // ── differentiation ──────────────────────────────────────────────────────────────────────

            /// `a`, bit for bit, with zero tangent: a running scale that cancels must not be differentiated.
            StopGradient stop_gradient(a: real) -> real, renames;
            /// The slope of `a` along the first input of the function, finite or not. The `gradient` and
            /// `legalize` passes write it out; by itself, in a function that nobody has differentiated, it is
            /// +0, as that of a constant. It has no slope.
            SlopeX slope_x(a: real) -> real, expanded;
            /// As `slope_x`, along the second input.
            SlopeY slope_y(a: real) -> real, expanded;
            /// As `slope_x`, along the third input.
            SlopeZ slope_z(a: real) -> real, expanded;

            // ── ranges ───────────────────────────────────────────────────────────────────────────────

            /// `a`, bit for bit. Over ranges it is the number at the low end of `a`, and NaN unless both ends
            /// are finite. So a formula that grows with `a` gives a bound of itself: its value there.
            LowEnd low_end(a: real) -> real, renames;
        }
    };
}

for_each_op!(op_table);
