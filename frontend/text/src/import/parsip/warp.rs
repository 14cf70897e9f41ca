//! Operators that deform space: TWIST, TAPER, SHEAR and BEND.

use glam::{DAffine3, DMat3, DVec3};
use jbt_model::axis::Axis;
use jbt_model::builder::{x, y, z};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::tree::Tree;
use jbt_model::warp::{Bend, Twist, Warp};

use super::scan::{Key, Section};
use super::state::{Importer, LinearTaper, Meaning};

/// The names of warps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum WarpName {
    Twist,
    Taper,
    Shear,
    Bend,
}

impl LinearTaper {
    /// The tree, asked at the changed point.
    pub(super) fn tree(self, tree: &Tree, span: Span) -> Tree {
        let coordinates = [x(), y(), z()];
        let mut changed = coordinates.clone();
        changed[self.axis] = &coordinates[self.axis] * (1.0 + self.factor * &coordinates[self.base]);
        let warped = tree.warp(changed);
        Tree::at(span, warped.node().written().clone(), vec![tree.clone()])
    }
}

impl Importer<'_> {
    /// The meaning of a warp. `None` after a message.
    pub(super) fn warp(&mut self, section: &Section, name: WarpName) -> Option<Meaning> {
        match name {
            WarpName::Twist => self.twist(section).map(|twist| Meaning::Warp(twist.into())),
            WarpName::Taper => self.taper(section).map(Meaning::Taper),
            WarpName::Shear => self.shear(section).map(Meaning::Map),
            WarpName::Bend => self.bend(section).map(Meaning::Warp),
        }
    }

    /// ParsIP turns the point by `factor * height` from the first to the second of the other two axes, in the
    /// order x, y, z. Our inverse map turns it the opposite way, right-handed about the axis; for y the other
    /// axes are in the order z, x.
    fn twist(&mut self, section: &Section) -> Option<Twist> {
        let factor = self.number_or(section, Key::Factor, 1.0)?;
        Some(match self.axis(section, Key::Axis, 2)? {
            0 => Twist { axis: Axis::X, rate: -factor },
            1 => Twist { axis: Axis::Y, rate: factor },
            _ => Twist { axis: Axis::Z, rate: -factor },
        })
    }

    /// The second coordinate of the point is multiplied by `1 + factor * first`.
    fn taper(&mut self, section: &Section) -> Option<LinearTaper> {
        let factor = self.number_or(section, Key::Factor, 1.0)?;
        let [base, axis] = self.axes(section, Key::TaperAxis)?;
        if (base, axis) == (2, 1) {
            self.departs(section, "scales x where y is to be scaled along z; here it is y");
        }
        Some(LinearTaper { axis, base, factor })
    }

    /// The first coordinate of the point moves by `factor` times the second, so what is seen moves back.
    fn shear(&mut self, section: &Section) -> Option<DAffine3> {
        let factor = self.number_or(section, Key::Factor, 1.0)?;
        let [base, axis] = self.axes(section, Key::ShearAxis)?;
        let mut matrix = DMat3::IDENTITY;
        matrix.col_mut(axis)[base] = -factor;
        Some(DAffine3 { matrix3: matrix, translation: DVec3::ZERO })
    }

    /// Barr's bend of the y axis in the plane of y and z.
    fn bend(&mut self, section: &Section) -> Option<Warp> {
        let rate = self.number_or(section, Key::Rate, 1.0)?;
        let center = self.number_or(section, Key::Center, 0.5)?;
        let from = self.number_or(section, Key::LeftBound, 0.0)?;
        let to = self.number_or(section, Key::RightBound, 1.0)?;
        self.departs(section, "applies the bend where its inverse is asked for; here it is the inverse");
        Some(Bend { axis: Axis::X, rate, from, to, center }.into())
    }

    /// Warns that ParsIP's own evaluator does something else.
    pub(super) fn departs(&mut self, section: &Section, does: &str) {
        let span = section.get(Key::OperatorType).or(section.get(Key::PrimitiveType));
        let (id, span) = (section.id, span.unwrap_or(section.span));
        self.warnings
            .add(|| Diagnostic::warning(Some(span), format!("node {id}: ParsIP's own evaluator {does}")));
    }

    /// The base axis, and another one. Where both are the same, the other one is y for x, else x.
    fn axes(&mut self, section: &Section, other: Key) -> Option<[usize; 2]> {
        let (base, axis) = (self.axis(section, Key::BaseAxis, 0)?, self.axis(section, other, 2)?);
        let axis = match (base == axis, base) {
            (false, _) => axis,
            (true, 0) => 1,
            (true, _) => 0,
        };
        Some([base, axis])
    }

    /// A number, or what it is without its key.
    fn number_or(&mut self, section: &Section, key: Key, otherwise: f64) -> Option<f64> {
        if section.get(key).is_some() { self.number(section, key) } else { Some(otherwise) }
    }

    /// An axis by its number.
    fn axis(&mut self, section: &Section, key: Key, otherwise: usize) -> Option<usize> {
        let Some(span) = section.get(key) else { return Some(otherwise) };
        let axis = self.integer(section, key)?;
        if !(0..3).contains(&axis) {
            self.bad(span, key, &axis.to_string(), "0, 1 or 2");
            return None;
        }
        Some(axis as usize)
    }
}
