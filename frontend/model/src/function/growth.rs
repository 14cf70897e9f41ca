//! How large a value of a formula may become, and how fast it changes.

/// Bounds of a value and of the sum of its derivatives along the coordinates, in magnitude, as the program
/// computes them in f32.
///
/// A bound of derivatives counts every factor of the chain rule as at least 1, so that no product of some of
/// them is larger, in whatever order the program multiplies. What has poles, or slopes without bounds, is
/// bounded by nothing.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Growth {
    pub(crate) value: f64,
    pub(crate) slope: f64,
}

impl Growth {
    pub(crate) const UNKNOWN: Self = Self { value: f64::INFINITY, slope: f64::INFINITY };

    /// That of a value which does not change.
    pub(crate) const fn still(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    /// That of a product.
    pub(crate) fn times(self, other: Self) -> Self {
        let slope = self.slope * other.value.max(1.0) + other.slope * self.value.max(1.0);
        Self { value: self.value * other.value, slope }
    }

    /// That of a sum.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }

    /// That of a whole power, of at least 1.
    pub(crate) fn raised(self, n: i32) -> Self {
        let slope = self.slope * f64::from(n) * self.value.max(1.0).powi(n - 1);
        Self { value: self.value.powi(n), slope }
    }
}
