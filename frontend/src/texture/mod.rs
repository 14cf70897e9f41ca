//! Textures: patterns in space that mix two values of an attribute group. One file per member, one list.
//!
//! A texture gives every place a number t from 0 to 1, and an attribute node makes the values `(1 - t) a + t b` of it, for a group of any
//! width. The place is that of the node's own space, so maps and warps above the node move the pattern and those below do not.
//!
//! A file has the same parts in the same order: what the texture is, its parameters, the plain formula in f64 (the oracle), the same
//! formula over [`Domain`] (the compiler), tests. To add one: write its file, add its line to the list below.
//!
//! A texture is not differentiated, and takes any coordinates: those beyond [`LARGEST_CELL`] cells, infinities and NaN count as the ends of
//! that range, so t is always a number in [0, 1].

use glam::DVec3;
use jbt_ir::Domain;

use crate::field::{Field, FieldValue, Member};

/// What a texture states about itself.
pub trait TextureMember: Member {
    /// What is wrong with the parameters beyond their kinds: a message and what is expected.
    fn fault(&self) -> Option<(String, String)> {
        None
    }

    /// The number at `p`, plainly: from 0 to 1.
    fn value(&self, p: DVec3) -> f64;

    /// How far `p` is from where the number jumps; infinity if it never does.
    fn decision(&self, p: DVec3) -> f64;

    /// The part of the parameters that selects code. `follows`: they follow those of the model, so the code has to serve all their values.
    fn variant(&self, follows: bool) -> u8 {
        let _ = follows;
        0
    }

    /// Names of the columns of a row, for a variant.
    fn columns(variant: u8) -> &'static [&'static str];

    /// The numbers of a row: one for each of [`columns`](Self::columns).
    fn push_columns(&self, variant: u8, row: &mut Vec<f64>);

    /// The number at `p`, over the ops; `row` holds the columns of a texture with this variant.
    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> D::Real;
}

macro_rules! textures {
    ($($module:ident :: $name:ident),+ $(,)?) => {
        $( mod $module; pub use $module::$name; )+

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
            /// The kind and variant; see [`TextureMember::variant`].
            #[must_use]
            pub fn kind(&self, follows: bool) -> TextureKind {
                match self { $( Self::$name(t) => TextureKind::$name(t.variant(follows)), )+ }
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

            /// See [`TextureMember::decision`].
            #[must_use]
            pub fn decision(&self, p: DVec3) -> f64 { match self { $( Self::$name(t) => t.decision(p), )+ } }
        }
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
pub use veins::Veins;

/// How many cells from the origin a pattern goes on along an axis: 2^21. Beyond that f32 has no places left to tell cells apart.
pub const LARGEST_CELL: f32 = 2_097_152.0;

/// 1.5 * 2^23: for |x| < 2^22 the sum `x + ROUND` is `ROUND` plus the integer nearest to x, and so are its bits.
const ROUND: f32 = 12_582_912.0;

/// The cell of a coordinate: its number, as the low bits, and how far into the cell it is, from 0 to 1.
struct Cell<D: Domain> {
    number: D::Bits,
    rest: D::Real,
}

/// Divides a coordinate, in cells, into the number of its cell and the rest.
fn emit_cell<D: Domain>(d: &mut D, x: D::Real) -> Cell<D> {
    let (low, high) = (d.constant(-LARGEST_CELL), d.constant(LARGEST_CELL));
    // The order of the operands matters: NaN becomes the low end.
    let x = d.max(x, low);
    let x = d.min(x, high);
    let round = d.constant(ROUND);
    let shifted = d.add(x, round);
    let nearest = d.sub(shifted, round);
    let above = d.lt(x, nearest);
    let (zero, one) = (d.constant(0.0), d.constant(1.0));
    let step = d.select(above, one, zero);
    let floor = d.sub(nearest, step);
    let shifted = d.add(floor, round);
    let (bits, offset) = (d.to_bits(shifted), d.bits_constant(ROUND.to_bits()));
    Cell { number: d.int_sub(bits, offset), rest: d.sub(x, floor) }
}

/// Divides a coordinate, in cells, into the number of its cell and the rest, plainly.
fn cell(x: f64) -> (i32, f64) {
    let largest = f64::from(LARGEST_CELL);
    let x = x.clamp(-largest, largest);
    (x.floor() as i32, x - x.floor())
}

/// How far a coordinate is from where its cell ends.
fn cell_decision(x: f64) -> f64 {
    (x - x.round()).abs()
}

/// Whether the lowest bit is set: 1 or 0.
fn emit_odd<D: Domain>(d: &mut D, bits: D::Bits) -> D::Real {
    let (one, thirty) = (d.bits_constant(1), d.bits_constant(30));
    let lowest = d.bit_and(bits, one);
    // 1 << 30 are the bits of 2.
    let two_or_zero = d.shl(lowest, thirty);
    let two_or_zero = d.from_bits(two_or_zero);
    let half = d.constant(0.5);
    d.mul(two_or_zero, half)
}

/// `3 t^2 - 2 t^3`: from 0 to 1 with level ends.
fn smooth(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

fn emit_smooth<D: Domain>(d: &mut D, t: D::Real) -> D::Real {
    let (minus_two, three) = (d.constant(-2.0), d.constant(3.0));
    let factor = d.fma(t, minus_two, three);
    let square = d.mul(t, t);
    d.mul(square, factor)
}

/// A wave of period 1 between 0, at whole numbers, and 1, half-way between them.
fn wave(x: f64) -> f64 {
    smooth(1.0 - (2.0 * cell(x).1 - 1.0).abs())
}

fn emit_wave<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let rest = emit_cell(d, x).rest;
    let (one, two) = (d.constant(1.0), d.constant(2.0));
    let doubled = d.mul(rest, two);
    let off_middle = d.sub(doubled, one);
    let off_middle = d.abs(off_middle);
    let triangle = d.sub(one, off_middle);
    emit_smooth(d, triangle)
}

/// `x` between 0 and 1; 0 for NaN.
pub(crate) fn emit_unit<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let (zero, one) = (d.constant(0.0), d.constant(1.0));
    let x = d.max(x, zero);
    d.min(x, one)
}

/// The scalar product.
pub(crate) fn emit_dot<D: Domain>(d: &mut D, a: [D::Real; 3], b: [D::Real; 3]) -> D::Real {
    let x = d.mul(a[0], b[0]);
    let xy = d.fma(a[1], b[1], x);
    d.fma(a[2], b[2], xy)
}

/// The first three numbers of a row.
fn first_three<T: Copy>(row: &[T]) -> [T; 3] {
    [row[0], row[1], row[2]]
}
