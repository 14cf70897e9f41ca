//! What solids are the intersection of: a body of revolution about z, slabs about the origin, and planes.
//!
//! ```text
//! field = min(h - g z - |(a rho + b z + c, d rho + e z + f)|,         a ball, a cylinder, a cone, a torus ..
//!             1/2 + s - s |x|, ..,                                    between two planes
//!             l - n . p, ..)                                          behind a plane
//! ```
//!
//! One formula of everything, with six planes, would do for each; a formula of what there is takes less. But
//! combinations are rows of one table only where their leaves are alike. So solids of a large model have
//! the one formula, whatever they are.

use jbt_model::builder::{Term, x, y, z};

use super::make::{LeafStyle, length};

/// Planes of the one formula.
const PLANES: usize = 6;

/// What a solid is the intersection of, in its frame.
#[derive(Clone, Default)]
pub(super) struct SolidParts {
    pub(super) round: Option<Revolved>,
    /// An axis, and how fast the field falls along it: 1/2 at the distance 1 from the origin.
    pub(super) slabs: Vec<(usize, f64)>,
    pub(super) planes: Vec<HalfField>,
}

/// A field `offset - slope . p`.
#[derive(Clone, Copy)]
pub(super) struct HalfField {
    pub(super) slope: [f64; 3],
    pub(super) offset: f64,
}

/// A field about z, where rho is the distance from it: of two numbers that are linear in rho and z, the
/// length is taken from another one.
#[derive(Clone, Copy, Default)]
pub(super) struct Revolved {
    /// Factors of rho and of z, and what is added.
    pub(super) first: [f64; 3],
    pub(super) second: [f64; 3],
    /// The factor of z, and what is added.
    pub(super) height: [f64; 2],
}

impl SolidParts {
    /// The field: more than 1/2 inside.
    pub(super) fn field(&self, style: LeafStyle) -> Term {
        let planes = 2 * self.slabs.len() + self.planes.len();
        match style {
            LeafStyle::Alike if planes <= PLANES => self.alike(),
            LeafStyle::Alike | LeafStyle::Plain => self.plain(),
        }
    }

    fn plain(&self) -> Term {
        let round = self.round.iter().map(Revolved::plain);
        let slabs = self.slabs.iter().map(|&(axis, sharp)| (0.5 + sharp) - sharp * axis_of(axis).abs());
        let planes = self.planes.iter().map(HalfField::field);
        let all = round.chain(slabs).chain(planes);
        all.reduce(|least, term| least.min(term)).unwrap_or_else(|| Term::from(0.0))
    }

    /// As a row of the one formula: what is missing is never the least.
    fn alike(&self) -> Term {
        let missing = HalfField { slope: [0.0; 3], offset: FAR };
        let mut planes = self.planes.clone();
        for &(axis, sharp) in &self.slabs {
            for sign in [-1.0, 1.0] {
                let mut slope = [0.0; 3];
                slope[axis] = sign * sharp;
                planes.push(HalfField { slope, offset: 0.5 + sharp });
            }
        }
        planes.resize(PLANES, missing);
        let round = self.round.unwrap_or(Revolved { height: [0.0, FAR], ..Revolved::default() });
        planes.iter().fold(round.whole(), |least, plane| least.min(plane.field()))
    }
}

/// More than any field of a solid.
const FAR: f64 = 1e6;

/// A coordinate.
fn axis_of(axis: usize) -> Term {
    match axis {
        0 => x(),
        1 => y(),
        _ => z(),
    }
}

impl HalfField {
    fn field(&self) -> Term {
        let [a, b, c] = self.slope;
        self.offset - (a * x() + b * y() + c * z())
    }
}

impl Revolved {
    /// With all numbers.
    fn whole(&self) -> Term {
        let beside = length(&x(), &y());
        let linear = |[rho, up, offset]: [f64; 3]| rho * &beside + up * z() + offset;
        self.height[1] - self.height[0] * z() - length(&linear(self.first), &linear(self.second))
    }

    /// With those numbers that are not 0.
    fn plain(&self) -> Term {
        let from = match (self.first, self.second) {
            ([rho, 0.0, 0.0], [0.0, 0.0, 0.0]) => rho * length(&x(), &y()),
            ([rho, 0.0, 0.0], [0.0, 0.0, offset]) => {
                (rho * rho * (x().square() + y().square()) + offset * offset).sqrt()
            }
            _ => {
                let beside = length(&x(), &y());
                let linear = |[rho, up, offset]: [f64; 3]| rho * &beside + up * z() + offset;
                length(&linear(self.first), &linear(self.second))
            }
        };
        match self.height {
            [0.0, offset] => offset - from,
            [up, offset] => offset - up * z() - from,
        }
    }
}
