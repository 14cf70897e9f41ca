//! The coordinate axes.

use glam::DVec3;

/// A coordinate axis.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

impl Axis {
    /// All three, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Its place among the coordinates, from 0.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The unit vector along it.
    #[must_use]
    pub const fn unit(self) -> DVec3 {
        DVec3::AXES[self.index()]
    }

    /// The first axis along which a vector reaches, or the last one.
    pub(crate) fn along(vector: [f64; 3]) -> Self {
        let first = vector.iter().position(|&coordinate| coordinate != 0.0);
        Self::ALL[first.unwrap_or(2)]
    }

    /// It and the two behind it, in right-handed order.
    pub(crate) const fn order(self) -> [usize; 3] {
        let first = self.index();
        [first, (first + 1) % 3, (first + 2) % 3]
    }
}
