//! Directions that fill a cone or a hemisphere evenly: the same for a pixel in every run, different for the
//! next pixel.

use super::vector::{Vector, add, scale, tangents};

/// Evenly spread points of the unit square for one pixel.
///
/// All pixels share one sequence, a two-dimensional Sobol' sequence: any 2^k points of it that begin at a
/// multiple of 2^k are spread evenly over every division of the square into 2^k equal boxes. Pixels take
/// their points from it in Morton order, so the points of a pixel are spread evenly, and so are those of its
/// block of 2 x 2, 4 x 4, ... pixels. An error of one pixel is compensated by its neighbours, and noise is
/// fine and without a pattern (Ahmed and Wonka, Screen-space blue-noise diffusion, 2020).
#[derive(Clone, Copy)]
pub struct Sequence {
    /// The index of the pixel's first point in the sequence.
    first: u32,
    /// Seeds of the scrambling of the points' order and of both coordinates.
    seeds: [u32; 3],
}

impl Sequence {
    /// The points of a pixel that takes `length` of them; `stream` distinguishes their uses.
    pub fn new(pixel: [u32; 2], stream: u32, length: u32) -> Self {
        // Morton order for 2^13 columns and rows; beyond, it repeats.
        let spread = |at: u32| {
            let halves = [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)];
            halves.iter().fold(at & 0x1fff, |bits, (shift, mask)| (bits | bits << shift) & mask)
        };
        let place = spread(pixel[0]) | spread(pixel[1]) << 1;
        let seed = |use_of: u32| hashed(3 * stream + use_of);
        Self { first: place.wrapping_mul(length.next_power_of_two()), seeds: [seed(0), seed(1), seed(2)] }
    }

    /// A point of the unit square, without its sides at 1.
    pub fn point(self, index: u32) -> [f64; 2] {
        let [order, first, second] = self.seeds;
        let index = scrambled(self.first.wrapping_add(index), order);
        let part = |bits: u32| f64::from(bits) / 2f64.powi(32);
        [part(scrambled(index.reverse_bits(), first)), part(scrambled(sobol(index), second))]
    }
}

/// The second coordinate of a point in the Sobol' sequence, as the 32 bits after the binary point; the first
/// coordinate is the index with its bits reversed.
///
/// Bit `j` after the point is the sum, modulo 2, of the bits `k` of the index with an odd binomial
/// coefficient of `k` and `j`. By Lucas' theorem these are the `k` that have all bits of `j`: one step for
/// each bit of `k`.
fn sobol(index: u32) -> u32 {
    let steps = [(1, 0x5555_5555), (2, 0x3333_3333), (4, 0x0f0f_0f0f), (8, 0x00ff_00ff), (16, 0x0000_ffff)];
    steps.iter().fold(index, |bits, (shift, mask)| bits ^ bits >> shift & mask).reverse_bits()
}

/// Owen's scrambling (1995): each bit is flipped or not by a hash of the bits above it. Evenly spread points
/// stay evenly spread. The hash is that of Laine and Karras (2011), with the constants of Vegdahl.
fn scrambled(bits: u32, seed: u32) -> u32 {
    let mut low_first = bits.reverse_bits();
    low_first ^= low_first.wrapping_mul(0x3d20_adea);
    low_first = low_first.wrapping_add(seed);
    low_first = low_first.wrapping_mul(seed >> 16 | 1);
    low_first ^= low_first.wrapping_mul(0x0552_6c56);
    low_first ^= low_first.wrapping_mul(0x53a2_2864);
    low_first.reverse_bits()
}

/// A hash: every bit depends on all bits of the number (Wellons, lowbias32).
fn hashed(number: u32) -> u32 {
    let mut bits = number.wrapping_add(0x9e37_79b9);
    bits = (bits ^ bits >> 16).wrapping_mul(0x7feb_352d);
    bits = (bits ^ bits >> 15).wrapping_mul(0x846c_a68b);
    bits ^ bits >> 16
}

/// A unit vector above a surface with this unit normal, with a density in proportion to the cosine to the
/// normal, from a point of the unit square.
pub fn above(normal: Vector, [u, v]: [f64; 2]) -> Vector {
    let (radius, height) = (u.sqrt(), (1.0 - u).sqrt());
    add(across(normal, radius, v), scale(normal, height))
}

/// A vector about as long as this unit axis, evenly spread in a cone around it; `spread` is the tangent of
/// the cone's angle.
pub fn around(axis: Vector, spread: f64, [u, v]: [f64; 2]) -> Vector {
    add(across(axis, spread * u.sqrt(), v), axis)
}

/// A vector of this length at a right angle to an axis; `turn` is its angle as a part of a turn.
fn across(axis: Vector, length: f64, turn: f64) -> Vector {
    let [s, t] = tangents(axis);
    let (sine, cosine) = (std::f64::consts::TAU * turn).sin_cos();
    add(scale(s, length * cosine), scale(t, length * sine))
}

#[cfg(test)]
mod tests {
    use super::super::vector::{dot, length};
    use super::*;

    /// The points of a pixel, and of a block of 2 x 2 pixels, are one in each part of the square, for parts
    /// of any shape.
    #[test]
    fn points_of_a_pixel_and_of_its_neighbours_are_spread_evenly() {
        for (stream, corner) in [(0, [0, 0]), (1, [6, 2]), (2, [8190, 4])] {
            let pixel = |number: u32| [corner[0] + number % 2, corner[1] + number / 2];
            let of =
                |number: u32| (0..16).map(move |index| Sequence::new(pixel(number), stream, 16).point(index));
            let parts = |points: &mut dyn Iterator<Item = [f64; 2]>, columns: f64, rows: f64| {
                let mut parts: Vec<u32> =
                    points.map(|[u, v]| (u * columns) as u32 + columns as u32 * (v * rows) as u32).collect();
                parts.sort_unstable();
                parts
            };
            for halvings in 0..=6 {
                let (columns, rows) = (f64::from(1 << halvings), f64::from(64 >> halvings));
                let all = parts(&mut (0..4).flat_map(of), columns, rows);
                assert_eq!(all, (0..64).collect::<Vec<u32>>(), "{columns} x {rows}");
            }
            for (number, halvings) in
                (0..4).flat_map(|number| (0..=4).map(move |halvings| (number, halvings)))
            {
                let (columns, rows) = (f64::from(1 << halvings), f64::from(16 >> halvings));
                assert_eq!(parts(&mut of(number), columns, rows), (0..16).collect::<Vec<u32>>());
            }
        }
        assert_ne!(Sequence::new([0, 0], 0, 16).point(0), Sequence::new([1, 0], 0, 16).point(0));
        assert_ne!(Sequence::new([0, 0], 0, 16).point(0), Sequence::new([0, 0], 1, 16).point(0));
    }

    /// By the direction numbers of the primitive polynomial x + 1 (Joe and Kuo, 2008).
    #[test]
    fn the_second_coordinate_is_that_of_sobol() {
        for index in [0, 1, 2, 3, 4, 5, 1000, 0x1234_5678, 0x8000_0000, u32::MAX] {
            let (mut sum, mut direction) = (0, 1 << 31);
            for bit in 0..32 {
                sum ^= direction * (index >> bit & 1);
                direction ^= direction >> 1;
            }
            assert_eq!(sobol(index), sum, "{index}");
        }
    }

    /// The mean of the cosine over directions weighted by it is 2/3.
    #[test]
    fn directions_above_a_surface() {
        let normal = [0.6, 0.0, -0.8];
        let count = 1024;
        let sequence = Sequence::new([17, 4], 1, count);
        let mut mean = 0.0;
        for index in 0..count {
            let direction = above(normal, sequence.point(index));
            assert!((length(direction) - 1.0).abs() < 1e-12);
            assert!(dot(direction, normal) > 0.0);
            mean += dot(direction, normal) / f64::from(count);
        }
        assert!((mean - 2.0 / 3.0).abs() < 0.005, "{mean}");
    }

    #[test]
    fn directions_in_a_cone() {
        let axis = [0.0, 1.0, 0.0];
        for index in 0..100 {
            let direction = around(axis, 0.1, Sequence::new([index, 0], 0, 1).point(index));
            assert!((direction[1] - 1.0).abs() < 1e-12);
            assert!(direction[0].hypot(direction[2]) < 0.1);
        }
    }

    #[test]
    fn pixels_and_streams_differ() {
        let first = |pixel, stream| Sequence::new(pixel, stream, 16).point(0);
        assert_ne!(first([0, 0], 0), first([1, 0], 0));
        assert_ne!(first([0, 1], 0), first([1, 0], 0));
        assert_ne!(first([0, 0], 0), first([0, 0], 1));
    }
}
