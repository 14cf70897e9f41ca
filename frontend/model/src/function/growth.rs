//! Bounds of the values of formulas and of their slopes.

/// Bounds of a value and of the sum of its derivatives along the coordinates, in magnitude, as the program
/// computes them in f32.
///
/// A bound of slopes counts every factor of the chain rule as at least 1, so that no partial product is
/// larger, in any order of multiplication. Values with poles or unbounded slopes have no bound.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Growth {
    pub(crate) value: f64,
    pub(crate) slope: f64,
}

impl Growth {
    pub(crate) const UNKNOWN: Self = Self { value: f64::INFINITY, slope: f64::INFINITY };

    /// The growth of a constant value.
    pub(crate) const fn still(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    /// The growth of a product.
    pub(crate) fn times(self, other: Self) -> Self {
        let slope = self.slope * other.value.max(1.0) + other.slope * self.value.max(1.0);
        Self { value: self.value * other.value, slope }
    }

    /// The growth of a sum.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }

    /// The growth of a whole power, of at least 1.
    pub(crate) fn raised(self, n: i32) -> Self {
        let slope = self.slope * f64::from(n) * self.value.max(1.0).powi(n - 1);
        Self { value: self.value.powi(n), slope }
    }
}
