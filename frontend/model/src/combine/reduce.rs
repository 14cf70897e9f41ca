//! What the compiler asks of operators of any number of operands, whatever their form.

use jbt_ir::Rule;

use super::{Extreme, ReduceCode};

impl ReduceCode {
    /// Names of the numbers that a row keeps for the operator.
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Fold(code) => code.columns(),
            Self::Choice(_) => &[],
            Self::Step(code) => code.columns(),
        }
    }

    /// What may be done with operands that are rows and zero; `non_negative`: none can be negative.
    pub fn rule(self, non_negative: bool) -> Rule {
        match self {
            Self::Fold(code) => {
                if code.absorbs() {
                    Rule::OnlyZero
                } else {
                    Rule::Neutral
                }
            }
            Self::Choice(Extreme::Largest) if non_negative => Rule::Neutral,
            Self::Choice(Extreme::Smallest) if non_negative => Rule::OnlyZero,
            Self::Choice(_) => Rule::KeepOne,
            Self::Step(code) => code.rule(non_negative),
        }
    }
}
