//! Random operators, from their list.

use jbt_model::combine::{
    Clamp, Combinator, CombinatorKind, Offset, RFunction, RFunctionOrder, RFunctionPower, Ricci,
    SetOperation, Shell, Sum, Union,
};
use jbt_model::kind::NodeKind;
use jbt_model::tree::Tree;

use super::Random;

impl Random {
    /// An operator, a selector or a formula over at least one child.
    pub(super) fn operator(&mut self, children: Vec<Tree>) -> Tree {
        // Unions and sums are what most models are made of.
        let combinator = match self.shape.u8(0..20) {
            0..3 => Sum {}.into(),
            3..7 => Union {}.into(),
            7 | 8 => return self.expression(&children),
            9 => {
                let width = self.between(0.05, 0.5);
                let set = self.set();
                return Tree::smooth(set, self.parameter("width", width), children);
            }
            10 if self.settings.selectors => {
                // Which child answers is a number as any other.
                let which = self.between(-0.49, children.len() as f64 - 0.51);
                return Tree::select(self.parameter("choice", which), children);
            }
            11..13 => Ricci { exponent: self.exponent() }.into(),
            _ => self.combinator(false),
        };
        Tree::new(NodeKind::Combine(combinator), children)
    }

    /// A map of the field, for iso-values from 0.3.
    pub(super) fn field_map(&mut self) -> NodeKind {
        NodeKind::Combine(self.combinator(true))
    }

    /// An operator of the list that takes one child, or any number of children. One that is not named here
    /// has the numbers that its description allows.
    fn combinator(&mut self, takes_one: bool) -> Combinator {
        let kinds: Vec<CombinatorKind> =
            CombinatorKind::ALL.iter().copied().filter(|kind| kind.takes_one() == takes_one).collect();
        match kinds[self.shape.usize(0..kinds.len())] {
            CombinatorKind::Ricci => Ricci { exponent: self.exponent() }.into(),
            CombinatorKind::SmoothUnion
            | CombinatorKind::SmoothIntersection
            | CombinatorKind::SmoothDifference => Combinator::smooth(self.set(), self.between(0.05, 0.5)),
            CombinatorKind::RFunction => RFunction { set: self.set(), alpha: self.between(-0.8, 1.0) }.into(),
            CombinatorKind::RFunctionOrder => {
                let orders = if self.is_hostile() { 0..9 } else { 1..4 };
                RFunctionOrder { set: self.set(), order: self.shape.u32(orders) }.into()
            }
            CombinatorKind::RFunctionPower => {
                RFunctionPower { set: self.set(), power: self.between(1.5, 6.0) }.into()
            }
            // Whether a clamp lets negative fields pass selects code.
            CombinatorKind::Clamp => {
                let low = match self.shape.u8(0..3) {
                    0 => -self.between(0.01, 0.5),
                    1 => self.between(0.0, 0.2),
                    _ => 0.0,
                };
                Clamp { low, high: self.between(0.4, 1.3) }.into()
            }
            CombinatorKind::Shell => Shell { thickness: self.between(0.05, 0.5) }.into(),
            CombinatorKind::Offset => Offset { by: self.between(-0.3, 0.2) }.into(),
            other => other.from_fields(&self.fields(other.fields())),
        }
    }

    fn set(&mut self) -> SetOperation {
        SetOperation::ALL[self.shape.usize(0..3)]
    }

    /// An exponent of Ricci's blend. Whether it is whole, and its sign, select code.
    fn exponent(&mut self) -> f64 {
        let exponent = match self.shape.u8(0..3) {
            0 => f64::from(self.shape.u32(1..20)),
            1 => self.between(1.01, 9.9),
            _ => 1024.0,
        };
        if self.shape.u8(0..3) == 0 { -exponent } else { exponent }
    }
}
