//! The reference meaning: one point, plain Rust. Every other engine has to give these bits.

use crate::math;
use crate::op::Domain;

/// The scalar domain. A real is an `f32`, a mask a `bool`, bits a `u32`.
#[derive(Clone, Copy, Default, Debug)]
pub struct Scalar;

impl Domain for Scalar {
    type Real = f32;
    type Mask = bool;
    type Bits = u32;

    fn constant(&mut self, value: f32) -> f32 {
        value
    }

    fn bits_constant(&mut self, value: u32) -> u32 {
        value
    }

    #[inline]
    fn add(&mut self, a: f32, b: f32) -> f32 {
        a + b
    }

    #[inline]
    fn sub(&mut self, a: f32, b: f32) -> f32 {
        a - b
    }

    #[inline]
    fn mul(&mut self, a: f32, b: f32) -> f32 {
        a * b
    }

    #[inline]
    fn div(&mut self, a: f32, b: f32) -> f32 {
        a / b
    }

    #[inline]
    fn fma(&mut self, a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }

    #[inline]
    fn neg(&mut self, a: f32) -> f32 {
        -a
    }

    #[inline]
    fn abs(&mut self, a: f32) -> f32 {
        a.abs()
    }

    #[inline]
    fn sqrt(&mut self, a: f32) -> f32 {
        a.sqrt()
    }

    #[inline]
    fn min(&mut self, a: f32, b: f32) -> f32 {
        if a < b { a } else { b }
    }

    #[inline]
    fn max(&mut self, a: f32, b: f32) -> f32 {
        if a > b { a } else { b }
    }

    #[inline]
    fn lt(&mut self, a: f32, b: f32) -> bool {
        a < b
    }

    #[inline]
    fn le(&mut self, a: f32, b: f32) -> bool {
        a <= b
    }

    #[inline]
    fn eq(&mut self, a: f32, b: f32) -> bool {
        a == b
    }

    #[inline]
    fn both(&mut self, a: bool, b: bool) -> bool {
        a && b
    }

    #[inline]
    fn either(&mut self, a: bool, b: bool) -> bool {
        a || b
    }

    #[inline]
    fn not(&mut self, a: bool) -> bool {
        !a
    }

    #[inline]
    fn select(&mut self, condition: bool, a: f32, b: f32) -> f32 {
        if condition { a } else { b }
    }

    #[inline]
    fn to_bits(&mut self, a: f32) -> u32 {
        a.to_bits()
    }

    #[inline]
    fn from_bits(&mut self, a: u32) -> f32 {
        f32::from_bits(a)
    }

    #[inline]
    fn bit_and(&mut self, a: u32, b: u32) -> u32 {
        a & b
    }

    #[inline]
    fn bit_or(&mut self, a: u32, b: u32) -> u32 {
        a | b
    }

    #[inline]
    fn bit_xor(&mut self, a: u32, b: u32) -> u32 {
        a ^ b
    }

    #[inline]
    fn int_add(&mut self, a: u32, b: u32) -> u32 {
        a.wrapping_add(b)
    }

    #[inline]
    fn int_sub(&mut self, a: u32, b: u32) -> u32 {
        a.wrapping_sub(b)
    }

    #[inline]
    fn shl(&mut self, a: u32, by: u32) -> u32 {
        a.wrapping_shl(by)
    }

    #[inline]
    fn shr(&mut self, a: u32, by: u32) -> u32 {
        a.wrapping_shr(by)
    }

    #[inline]
    fn sin(&mut self, a: f32) -> f32 {
        math::sin(self, a)
    }

    #[inline]
    fn cos(&mut self, a: f32) -> f32 {
        math::cos(self, a)
    }

    #[inline]
    fn exp(&mut self, a: f32) -> f32 {
        math::exp(self, a)
    }

    #[inline]
    fn ln(&mut self, a: f32) -> f32 {
        math::ln(self, a)
    }

    #[inline]
    fn pow(&mut self, a: f32, b: f32) -> f32 {
        math::pow(self, a, b)
    }

    #[inline]
    fn stop_gradient(&mut self, a: f32) -> f32 {
        a
    }

    #[inline]
    fn slope_x(&mut self, _: f32) -> f32 {
        0.0
    }

    #[inline]
    fn slope_y(&mut self, _: f32) -> f32 {
        0.0
    }

    #[inline]
    fn slope_z(&mut self, _: f32) -> f32 {
        0.0
    }

    #[inline]
    fn low_end(&mut self, a: f32) -> f32 {
        a
    }
}
