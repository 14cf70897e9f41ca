//! The curve between linear light and the numbers that a screen is given (sRGB, IEC 61966-2-1), and eight
//! bits of them.

/// From linear light to the number that a screen is given, 0 .. 1 (IEC 61966-2-1, sRGB). Light beyond 0 .. 1
/// is clamped; NaN is 0.
#[must_use]
pub fn encode(linear: f32) -> f32 {
    let x = unit(linear);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// As [`encode`], rounded once: white is 1 and not 1 - 2^-24. For numbers that are kept; a picture's bytes do
/// not see it.
#[must_use]
pub fn encode_precisely(linear: f32) -> f32 {
    let x = f64::from(unit(linear));
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    encoded as f32
}

/// From the number that a screen is given to linear light: the inverse of [`encode`].
#[must_use]
pub fn decode(encoded: f32) -> f32 {
    let x = unit(encoded);
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// Cells into which [`ScreenBytes`] divides light.
const CELLS: usize = 4096;

/// The bytes of a screen for many numbers of linear light: those of [`byte`] and [`encode`], from a table.
pub(crate) struct ScreenBytes {
    /// For each byte the least light that has it.
    least: [f32; 256],
    /// The byte of the darkest light of each cell.
    first: [u8; CELLS + 1],
}

impl ScreenBytes {
    /// The table.
    pub(crate) fn new() -> Self {
        let mut least = [0.0_f32; 256];
        for code in 1..256 {
            // Bits of positive numbers are in the order of the numbers.
            let (mut low, mut high) = (least[code - 1].to_bits(), 1.0_f32.to_bits());
            while low < high {
                let middle = low + (high - low) / 2;
                let is_there = usize::from(byte(encode(f32::from_bits(middle)))) >= code;
                (low, high) = if is_there { (low, middle) } else { (middle + 1, high) };
            }
            least[code] = f32::from_bits(low);
        }
        let first = std::array::from_fn(|cell| {
            let dark = cell as f32 / CELLS as f32;
            (least.partition_point(|&least| least <= dark) - 1) as u8
        });
        Self { least, first }
    }

    /// The byte of linear light; light beyond 0 .. 1 is clamped, NaN is 0.
    pub(crate) fn of(&self, linear: f32) -> u8 {
        let x = unit(linear);
        let mut code = self.first[(x * CELLS as f32) as usize];
        while code < u8::MAX && x >= self.least[usize::from(code) + 1] {
            code += 1;
        }
        code
    }
}

/// Eight bits of a number from 0 to 1.
pub(crate) fn byte(x: f32) -> u8 {
    (unit(x) * 255.0 + 0.5) as u8
}

/// A number as 0 .. 1; what is no number is 0.
pub(crate) fn unit(x: f32) -> f32 {
    if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_screens_curve() {
        assert_eq!(byte(encode(0.0)), 0);
        assert_eq!(byte(encode(0.5)), 188);
        assert_eq!(byte(encode(1.0)), 255);
        assert_eq!(byte(encode(f32::NAN)), 0);
        assert_eq!(byte(encode(7.0)), 255);
        for step in 0..=255 {
            let x = step as f32 / 255.0;
            assert!((encode(decode(x)) - x).abs() < 1e-5);
        }
    }

    #[test]
    fn the_table_has_the_bytes_of_the_curve() {
        let table = ScreenBytes::new();
        for step in -50_000..=1_100_000 {
            let x = step as f32 * 1e-6;
            assert_eq!(table.of(x), byte(encode(x)), "{x}");
        }
        for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, -0.0] {
            assert_eq!(table.of(x), byte(encode(x)), "{x}");
        }
    }

    /// Pairs that others have published: the ends and the joint of the standard's two pieces, the
    /// photographers' mid grey, and what colour pickers give for halves on either side.
    #[test]
    fn published_values() {
        let pairs = [
            (0.0, 0.0),
            (0.001, 0.012_92),
            (0.003_130_8, 0.040_449_94),
            (0.18, 0.461_356_13),
            (0.214_041_14, 0.5),
            (0.5, 0.735_357),
            (0.8, 0.906_331_8),
            (1.0, 1.0),
        ];
        for (linear, encoded) in pairs {
            assert!((encode(linear) - encoded).abs() < 3e-7, "{linear}: {}", encode(linear));
            assert!(
                (encode_precisely(linear) - encoded).abs() < 4e-8,
                "{linear}: {}",
                encode_precisely(linear)
            );
            assert!((decode(encoded) - linear).abs() < 3e-7, "{encoded}: {}", decode(encoded));
        }
        assert_eq!((encode_precisely(1.0), encode_precisely(f32::NAN)), (1.0, 0.0));
        // Every byte is the byte of its own light.
        for code in 0..=u8::MAX {
            assert_eq!(byte(encode(decode(f32::from(code) / 255.0))), code);
        }
    }
}
