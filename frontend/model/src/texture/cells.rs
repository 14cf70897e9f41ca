//! Cells, waves and smooth steps, shared by several textures.

use jbt_ir::Domain;

/// The number of cells from the origin along an axis in which a pattern goes on: 2^21. Beyond, f32 is too
/// coarse to tell cells apart.
pub const LARGEST_CELL: f32 = 2_097_152.0;

/// 1.5 * 2^23. For |x| < 2^22 the sum `x + ROUND` is `ROUND` plus the integer nearest to x, and its bits are
/// the bits of `ROUND` plus that integer.
pub(super) const ROUND: f32 = 12_582_912.0;

/// The cell of a coordinate: its number, as the low bits, and how far into the cell it is, from 0 to 1.
pub(super) struct TextureCell<D: Domain> {
    pub(super) number: D::Bits,
    pub(super) rest: D::Real,
}

/// Divides a coordinate, in cells, into the number of its cell and the rest.
pub(super) fn emit_cell<D: Domain>(d: &mut D, x: D::Real) -> TextureCell<D> {
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
    TextureCell { number: d.int_sub(bits, offset), rest: d.sub(x, floor) }
}

/// Divides a coordinate, in cells, into the number of its cell and the rest, in f64.
pub(super) fn cell(x: f64) -> (i32, f64) {
    let largest = f64::from(LARGEST_CELL);
    let x = x.clamp(-largest, largest);
    (x.floor() as i32, x - x.floor())
}

/// The distance of a coordinate from the nearest end of a cell.
pub(super) fn cell_kink_distance(x: f64) -> f64 {
    (x - x.round()).abs()
}

/// Whether the lowest bit is set: 1 or 0.
pub(super) fn emit_odd<D: Domain>(d: &mut D, bits: D::Bits) -> D::Real {
    let (one, thirty) = (d.bits_constant(1), d.bits_constant(30));
    let lowest = d.bit_and(bits, one);
    // 1 << 30 are the bits of 2.
    let two_or_zero = d.shl(lowest, thirty);
    let two_or_zero = d.from_bits(two_or_zero);
    let half = d.constant(0.5);
    d.mul(two_or_zero, half)
}

/// `3 t^2 - 2 t^3`: from 0 to 1 with level ends.
pub(super) fn smooth(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

pub(super) fn emit_smooth<D: Domain>(d: &mut D, t: D::Real) -> D::Real {
    let (minus_two, three) = (d.constant(-2.0), d.constant(3.0));
    let factor = d.fma(t, minus_two, three);
    let square = d.mul(t, t);
    d.mul(square, factor)
}

/// A wave of period 1 between 0, at whole numbers, and 1, half-way between them.
pub(super) fn wave(x: f64) -> f64 {
    smooth(1.0 - (2.0 * cell(x).1 - 1.0).abs())
}

pub(super) fn emit_wave<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let rest = emit_cell(d, x).rest;
    let (one, two) = (d.constant(1.0), d.constant(2.0));
    let doubled = d.mul(rest, two);
    let off_middle = d.sub(doubled, one);
    let off_middle = d.abs(off_middle);
    let triangle = d.sub(one, off_middle);
    emit_smooth(d, triangle)
}

/// The scalar product.
pub(super) fn emit_dot<D: Domain>(d: &mut D, a: [D::Real; 3], b: [D::Real; 3]) -> D::Real {
    let x = d.mul(a[0], b[0]);
    let xy = d.fma(a[1], b[1], x);
    d.fma(a[2], b[2], xy)
}

/// The first three numbers of a row.
pub(super) fn first_three<T: Copy>(row: &[T]) -> [T; 3] {
    [row[0], row[1], row[2]]
}
