//! The lanes domain: each op as a loop over the lanes of a block.
//!
//! A loop takes [`WIDTH`] lanes at a time: it reads them from the operands' registers, calls the scalar op on
//! each, and writes them to the result's register. All reads of a chunk come before its writes, so the result
//! may go to the register of an operand.

use crate::domain::scalar::Scalar;
use crate::op::Domain;

/// Lanes of a chunk, the least that runs together: four vectors of AVX2, two of AVX-512, eight of the
/// baseline.
pub const WIDTH: usize = 32;

/// The bits of consecutive points of one register. A mask is 0 or all ones in each lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Chunk(pub [u32; WIDTH]);

impl Chunk {
    pub const ZERO: Self = Self([0; WIDTH]);
}

/// A real, a mask or bits of this domain: a register of lanes, or the bits that all lanes share.
#[derive(Clone, Copy, Debug)]
pub(super) enum Handle {
    /// The register with this number.
    Block(usize),
    /// The same bits in every lane.
    Splat(u32),
}

use Handle::{Block, Splat};

/// The lanes domain. An op whose operands are all splats gives a splat; any other op writes the result
/// register.
pub(super) struct Lanes<'a> {
    /// The register file: row after row of chunks, one chunk per register and row, for `WIDTH` points.
    pub file: &'a mut [Chunk],
    /// Chunks of a row, at least one.
    pub stride: usize,
    /// The register that the next op writes.
    pub result: usize,
}

/// The mask of a truth value.
#[inline(always)]
const fn mask(truth: bool) -> u32 {
    if truth { !0 } else { 0 }
}

/// The truth of a mask. It reads the sign bit only, which makes it the sign test of a vector blend.
#[inline(always)]
const fn truth(mask: u32) -> bool {
    mask.cast_signed() < 0
}

impl Lanes<'_> {
    /// Reads a plane's points into a register; the lanes behind the last one become zero.
    #[inline(always)]
    pub fn load(&mut self, register: usize, plane: &[f32]) {
        for (row, points) in self.file.chunks_exact_mut(self.stride).zip(plane.chunks(WIDTH)) {
            let lanes = &mut row[register].0;
            if points.len() < WIDTH {
                *lanes = [0; WIDTH];
            }
            for (lane, point) in lanes.iter_mut().zip(points) {
                *lane = point.to_bits();
            }
        }
    }

    /// Writes a register's first points to a plane.
    #[inline(always)]
    pub fn store(&self, register: usize, plane: &mut [f32]) {
        for (row, points) in self.file.chunks_exact(self.stride).zip(plane.chunks_mut(WIDTH)) {
            for (point, &lane) in points.iter_mut().zip(&row[register].0) {
                *point = f32::from_bits(lane);
            }
        }
    }

    /// Copies to a register.
    #[inline(always)]
    pub fn copy(&mut self, from: Handle, to: usize) {
        self.result = to;
        match from {
            Block(from) => self.each(|row, lane| row[from].0[lane]),
            Splat(bits) => self.each(|_, _| bits),
        };
    }

    /// Fills the result register, lane by lane, from a row of chunks and the number of the lane.
    #[inline(always)]
    pub(super) fn each(&mut self, f: impl Fn(&[Chunk], usize) -> u32) -> Handle {
        let mut file = &mut *self.file;
        // Not `chunks_exact_mut`: its division takes as long as a short loop.
        while let Some((row, rest)) = file.split_at_mut_checked(self.stride) {
            let mut lanes = [0; WIDTH];
            for (index, lane) in lanes.iter_mut().enumerate() {
                *lane = f(row, index);
            }
            row[self.result].0 = lanes;
            file = rest;
        }
        Block(self.result)
    }

    #[inline(always)]
    fn unary(&mut self, a: Handle, f: impl Fn(u32) -> u32) -> Handle {
        match a {
            Splat(a) => Splat(f(a)),
            Block(a) => self.each(|row, i| f(row[a].0[i])),
        }
    }

    #[inline(always)]
    fn binary(&mut self, a: Handle, b: Handle, f: impl Fn(u32, u32) -> u32) -> Handle {
        match (a, b) {
            (Splat(a), Splat(b)) => Splat(f(a, b)),
            (Splat(a), Block(b)) => self.each(|row, i| f(a, row[b].0[i])),
            (Block(a), Splat(b)) => self.each(|row, i| f(row[a].0[i], b)),
            (Block(a), Block(b)) => self.each(|row, i| f(row[a].0[i], row[b].0[i])),
        }
    }

    #[inline(always)]
    fn ternary(&mut self, a: Handle, b: Handle, c: Handle, f: impl Fn(u32, u32, u32) -> u32) -> Handle {
        match (a, b, c) {
            (Splat(a), Splat(b), Splat(c)) => Splat(f(a, b, c)),
            (Splat(a), Splat(b), Block(c)) => self.each(|row, i| f(a, b, row[c].0[i])),
            (Splat(a), Block(b), Splat(c)) => self.each(|row, i| f(a, row[b].0[i], c)),
            (Splat(a), Block(b), Block(c)) => self.each(|row, i| f(a, row[b].0[i], row[c].0[i])),
            (Block(a), Splat(b), Splat(c)) => self.each(|row, i| f(row[a].0[i], b, c)),
            (Block(a), Splat(b), Block(c)) => self.each(|row, i| f(row[a].0[i], b, row[c].0[i])),
            (Block(a), Block(b), Splat(c)) => self.each(|row, i| f(row[a].0[i], row[b].0[i], c)),
            (Block(a), Block(b), Block(c)) => self.each(|row, i| f(row[a].0[i], row[b].0[i], row[c].0[i])),
        }
    }

    #[inline(always)]
    fn real1(&mut self, a: Handle, f: impl Fn(f32) -> f32) -> Handle {
        self.unary(a, |a| f(f32::from_bits(a)).to_bits())
    }

    #[inline(always)]
    fn real2(&mut self, a: Handle, b: Handle, f: impl Fn(f32, f32) -> f32) -> Handle {
        self.binary(a, b, |a, b| f(f32::from_bits(a), f32::from_bits(b)).to_bits())
    }

    #[inline(always)]
    fn compare(&mut self, a: Handle, b: Handle, f: impl Fn(f32, f32) -> bool) -> Handle {
        self.binary(a, b, |a, b| mask(f(f32::from_bits(a), f32::from_bits(b))))
    }
}

/// The transcendental ops of the scalar domain, out of line: they are long, and no tape contains them.
mod whole {
    use crate::domain::scalar::Scalar;
    use crate::op::Domain;

    macro_rules! out_of_line {
        ($($name:ident($($arg:ident),+));+) => {
            $(
                #[inline(never)]
                pub fn $name($($arg: f32),+) -> f32 {
                    Scalar.$name($($arg),+)
                }
            )+
        };
    }

    out_of_line!(sin(a); cos(a); exp(a); ln(a); pow(a, b));
}

impl Domain for Lanes<'_> {
    type Real = Handle;
    type Mask = Handle;
    type Bits = Handle;

    #[inline(always)]
    fn constant(&mut self, value: f32) -> Handle {
        Splat(value.to_bits())
    }

    #[inline(always)]
    fn bits_constant(&mut self, value: u32) -> Handle {
        Splat(value)
    }

    #[inline(always)]
    fn add(&mut self, a: Handle, b: Handle) -> Handle {
        self.real2(a, b, |a, b| Scalar.add(a, b))
    }

    #[inline(always)]
    fn sub(&mut self, a: Handle, b: Handle) -> Handle {
        self.real2(a, b, |a, b| Scalar.sub(a, b))
    }

    #[inline(always)]
    fn mul(&mut self, a: Handle, b: Handle) -> Handle {
        self.real2(a, b, |a, b| Scalar.mul(a, b))
    }

    #[inline(always)]
    fn div(&mut self, a: Handle, b: Handle) -> Handle {
        self.real2(a, b, |a, b| Scalar.div(a, b))
    }

    #[inline(always)]
    fn fma(&mut self, a: Handle, b: Handle, c: Handle) -> Handle {
        self.ternary(a, b, c, |a, b, c| {
            Scalar.fma(f32::from_bits(a), f32::from_bits(b), f32::from_bits(c)).to_bits()
        })
    }

    #[inline(always)]
    fn neg(&mut self, a: Handle) -> Handle {
        self.real1(a, |a| Scalar.neg(a))
    }

    #[inline(always)]
    fn abs(&mut self, a: Handle) -> Handle {
        self.real1(a, |a| Scalar.abs(a))
    }

    #[inline(always)]
    fn sqrt(&mut self, a: Handle) -> Handle {
        self.real1(a, |a| Scalar.sqrt(a))
    }

    #[inline(always)]
    fn min(&mut self, a: Handle, b: Handle) -> Handle {
        self.real2(a, b, |a, b| Scalar.min(a, b))
    }

    #[inline(always)]
    fn max(&mut self, a: Handle, b: Handle) -> Handle {
        self.real2(a, b, |a, b| Scalar.max(a, b))
    }

    #[inline(always)]
    fn lt(&mut self, a: Handle, b: Handle) -> Handle {
        self.compare(a, b, |a, b| Scalar.lt(a, b))
    }

    #[inline(always)]
    fn le(&mut self, a: Handle, b: Handle) -> Handle {
        self.compare(a, b, |a, b| Scalar.le(a, b))
    }

    #[inline(always)]
    fn eq(&mut self, a: Handle, b: Handle) -> Handle {
        self.compare(a, b, |a, b| Scalar.eq(a, b))
    }

    #[inline(always)]
    fn both(&mut self, a: Handle, b: Handle) -> Handle {
        self.binary(a, b, |a, b| a & b)
    }

    #[inline(always)]
    fn either(&mut self, a: Handle, b: Handle) -> Handle {
        self.binary(a, b, |a, b| a | b)
    }

    #[inline(always)]
    fn not(&mut self, a: Handle) -> Handle {
        self.unary(a, |a| !a)
    }

    #[inline(always)]
    fn select(&mut self, condition: Handle, a: Handle, b: Handle) -> Handle {
        self.ternary(condition, a, b, |condition, a, b| if truth(condition) { a } else { b })
    }

    #[inline(always)]
    fn to_bits(&mut self, a: Handle) -> Handle {
        self.unary(a, |a| a)
    }

    #[inline(always)]
    fn from_bits(&mut self, a: Handle) -> Handle {
        self.unary(a, |a| a)
    }

    #[inline(always)]
    fn bit_and(&mut self, a: Handle, b: Handle) -> Handle {
        self.binary(a, b, |a, b| Scalar.bit_and(a, b))
    }

    #[inline(always)]
    fn bit_or(&mut self, a: Handle, b: Handle) -> Handle {
        self.binary(a, b, |a, b| Scalar.bit_or(a, b))
    }

    #[inline(always)]
    fn bit_xor(&mut self, a: Handle, b: Handle) -> Handle {
        self.binary(a, b, |a, b| Scalar.bit_xor(a, b))
    }

    #[inline(always)]
    fn int_add(&mut self, a: Handle, b: Handle) -> Handle {
        self.binary(a, b, |a, b| Scalar.int_add(a, b))
    }

    #[inline(always)]
    fn int_sub(&mut self, a: Handle, b: Handle) -> Handle {
        self.binary(a, b, |a, b| Scalar.int_sub(a, b))
    }

    #[inline(always)]
    fn shl(&mut self, a: Handle, by: Handle) -> Handle {
        self.binary(a, by, |a, by| Scalar.shl(a, by))
    }

    #[inline(always)]
    fn shr(&mut self, a: Handle, by: Handle) -> Handle {
        self.binary(a, by, |a, by| Scalar.shr(a, by))
    }

    #[inline(always)]
    fn sin(&mut self, a: Handle) -> Handle {
        self.real1(a, whole::sin)
    }

    #[inline(always)]
    fn cos(&mut self, a: Handle) -> Handle {
        self.real1(a, whole::cos)
    }

    #[inline(always)]
    fn exp(&mut self, a: Handle) -> Handle {
        self.real1(a, whole::exp)
    }

    #[inline(always)]
    fn ln(&mut self, a: Handle) -> Handle {
        self.real1(a, whole::ln)
    }

    #[inline(always)]
    fn pow(&mut self, a: Handle, b: Handle) -> Handle {
        self.real2(a, b, whole::pow)
    }

    #[inline(always)]
    fn stop_gradient(&mut self, a: Handle) -> Handle {
        self.unary(a, |a| a)
    }

    #[inline(always)]
    fn slope_x(&mut self, _: Handle) -> Handle {
        self.constant(0.0)
    }

    #[inline(always)]
    fn slope_y(&mut self, _: Handle) -> Handle {
        self.constant(0.0)
    }

    #[inline(always)]
    fn slope_z(&mut self, _: Handle) -> Handle {
        self.constant(0.0)
    }

    #[inline(always)]
    fn low_end(&mut self, a: Handle) -> Handle {
        self.unary(a, |a| a)
    }
}
