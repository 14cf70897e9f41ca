//! Random formulas: some whose derivatives are bounded, and such of any operations for hostile models.

use jbt_model::attribute::AttributeGroup;
use jbt_model::builder::{Term, param, x, y, z};
use jbt_model::combine::Sum;
use jbt_model::falloff::Falloff;
use jbt_model::kind::NodeKind;
use jbt_model::tree::Tree;

use super::Random;

impl Random {
    /// A formula, of the point or of some of the children, of which there is one at least.
    pub(super) fn expression(&mut self, children: &[Tree]) -> Tree {
        let (low, high) = (self.vector(0.8).map(|low| low - 0.9), self.vector(0.8).map(|high| high + 0.9));
        if self.is_hostile() {
            let last = self.any_terms(children).pop().unwrap_or_else(x);
            let is_boxed = self.shape.bool();
            return if is_boxed { Tree::expression_within(last, low, high) } else { Tree::expression(last) };
        }
        let (p, q) = (self.between(0.3, 0.9), self.between(0.3, 0.9));
        let [a, b, c] = std::array::from_fn(|place| children[place % children.len()].field());
        let size = || (x() * x() + y() * y() + z().powf(2.0)).sqrt();
        match self.shape.u8(0..9) {
            0 => Tree::expression((p - size()).clamp(-0.5, 1.5)),
            1 if self.settings.walls => Tree::expression_within(q + 0.3 * (2.0 * x()).sin() * y(), low, high),
            2 => Tree::expression(size() - p).fading(Falloff::Wyvill, q),
            3 => Tree::expression((p * &a * &b).clamp(-1.5, 1.5)),
            4 => Tree::expression((0.7 * &a * &b - q * c.square()).max(-1.0).min(1.0)),
            5 if self.settings.walls => children[0].within(low, high),
            6 => Tree::expression(&a * (1.0 + p * (2.0 * x()).sin()) + q * (&b - &a)),
            7 => Tree::expression(a.max(b.min(p)) / (1.0 + y().abs()) + q * (&c * &c + 0.1).sqrt()),
            _ => {
                Tree::expression(p * a.clamp(-0.5, 1.5).atan2(2.0 + b.abs()) + 0.2 * (z() * 0.5).tan().atan())
            }
        }
    }

    /// A warp that is given by formulas: of bounded derivatives, with a definition, with a pole that is not
    /// there, with a crease.
    pub fn formula_warp(&mut self) -> NodeKind {
        let [p, q, r] = self.vector(1.0);
        let turn = p * z();
        let coordinates = match self.shape.u8(0..4) {
            _ if self.is_hostile() => {
                let terms = self.any_terms(&[]);
                std::array::from_fn(|_| terms[self.shape.usize(..terms.len())].clone())
            }
            0 => [x() + 0.3 * p * (3.0 * q * y()).sin(), y() + r, z() * 0.9],
            1 => [x() * turn.cos() + y() * turn.sin(), y() * turn.cos() - x() * turn.sin(), z()],
            2 => [x() / (1.0 + r.abs() * z() * z()), y(), z() + 0.2 * q],
            _ => [x().abs() + 0.3 * p, y() + 0.1 * x() * y(), z().max(2.0 * z() + q)],
        };
        let still = Tree::combine(Sum {}, Vec::<Tree>::new()).warp(coordinates);
        still.node().written().evaluated(0.5).expect("formulas mean something")
    }

    /// The tree with a formula as an attribute, with a number that depends on a parameter.
    pub(super) fn expressed(&mut self, tree: &Tree, group: &AttributeGroup) -> Tree {
        let (size, part) = (self.between(0.3, 2.0), self.between(0.0, 1.0));
        let follows = self.parameter("wave", size);
        let radius = (x() * x() + y() * y() + z() * z()).sqrt();
        // The last one is infinite or no number where the point is.
        let mut all = vec![
            (x() * depends).sin() * part,
            radius.falloff(Falloff::Wyvill),
            y().clamp(-part, part),
            radius.clone() + part,
            Term::from(part),
            radius.square() - radius.square() * x().abs() / (1.0 + x().abs()),
        ];
        if self.is_hostile() {
            all = self.any_terms(&[]);
        }
        let values = (0..group.width()).map(|_| all[self.shape.usize(0..all.len())].clone());
        let values: Vec<Term> = values.collect();
        tree.expressed(&group.name, values)
    }

    /// Formulas of any operations, where what was made once may be used again.
    fn any_terms(&mut self, children: &[Tree]) -> Vec<Term> {
        let mut terms = vec![x(), y(), z()];
        terms.extend(children.iter().map(Tree::field));
        for _ in 0..self.shape.usize(..12) {
            let a = terms[self.shape.usize(..terms.len())].clone();
            let [b, c] = [(); 2].map(|()| match self.shape.u8(..3) {
                0 => Term::from(self.between(-1.0, 1.0)),
                1 => param("bulge", 0.5) * self.between(-1.0, 1.0) + x(),
                _ => terms[self.shape.usize(..terms.len())].clone(),
            });
            terms.push(match self.shape.u8(..22) {
                0 => a + b,
                1 => b - a,
                2 => a * b,
                3 => b / a,
                4 => -a,
                5 => a.powf(f64::from(self.shape.i8(-4..5))),
                6 => b.powf(a),
                7 => a.sqrt(),
                8 => a.sin() + a.cos(),
                9 => a.tan().atan(),
                10 => a.asin() - a.acos(),
                11 => a.abs().sign(),
                12 => a.floor() - (a.ceil() - a.round()),
                13 => a.exp().ln(),
                14 => a.square(),
                15 => a.min(b).max(c),
                16 => a.clamp(b, c),
                17 => a.mix(b, c),
                18 => a.step_at(b),
                19 => a.modulo(b),
                20 => a.atan2(b),
                _ => a.falloff(self.falloff()),
            });
        }
        terms
    }
}
