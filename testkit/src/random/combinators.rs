//! Random operators.

use jbt_frontend::combine::{Combinator, Family, SetOperation};
use jbt_frontend::kind::NodeKind;
use jbt_frontend::tree::Tree;

use super::Random;

impl Random {
    /// An operator, a selector or a formula over at least one child.
    pub(super) fn operator(&mut self, children: Vec<Tree>) -> Tree {
        let set = SetOperation::ALL[self.shape.usize(0..3)];
        let combinator = match self.shape.u8(0..21) {
            0 | 1 | 18 => Combinator::Sum,
            2 => Combinator::Ricci(f64::from(self.shape.u32(1..20))),
            3 => Combinator::Ricci(if self.shape.bool() { self.between(1.01, 9.9) } else { 1024.0 }),
            4 => Combinator::Intersection,
            5 => Combinator::Difference,
            8 | 19 => return self.expression(&children),
            9 => Combinator::Product,
            10 => Combinator::SymmetricDifference,
            11 => Combinator::Smooth(set, self.between(0.05, 0.5)),
            12 => {
                let width = self.between(0.05, 0.5);
                return Tree::smooth(set, self.parameter("width", width), children);
            }
            13 => Combinator::RFunction(set, self.family()),
            14 => Combinator::Ricci(match self.shape.u8(0..3) {
                0 => -f64::from(self.shape.u32(1..20)),
                1 => -self.between(1.01, 9.9),
                _ => -512.0,
            }),
            20 if self.settings.selectors => {
                // Which child answers is a number as any other.
                let which = self.between(-0.49, children.len() as f64 - 0.51);
                return Tree::select(self.parameter("choice", which), children);
            }
            _ => Combinator::Union,
        };
        Tree::new(NodeKind::Combine(combinator), children)
    }

    fn family(&mut self) -> Family {
        match self.shape.u8(0..3) {
            0 => Family::Alpha(self.between(-0.8, 1.0)),
            1 => Family::Order(self.shape.u32(if self.is_hostile() { 0..9 } else { 1..4 })),
            _ => Family::Power(self.between(1.5, 6.0)),
        }
    }

    /// A map of the field, for iso-values from 0.3. Whether a clamp lets negative fields pass selects code.
    pub(super) fn field_map(&mut self) -> NodeKind {
        NodeKind::Combine(match self.shape.u8(0..6) {
            0 => Combinator::Complement,
            1 => Combinator::Clamp { low: -self.between(0.01, 0.5), high: self.between(0.4, 1.3) },
            2 => Combinator::Clamp { low: self.between(0.0, 0.2), high: self.between(0.4, 1.3) },
            3 => Combinator::Clamp { low: 0.0, high: self.between(0.4, 1.3) },
            4 => Combinator::Shell(self.between(0.05, 0.5)),
            _ => Combinator::Offset(self.between(-0.3, 0.2)),
        })
    }
}
