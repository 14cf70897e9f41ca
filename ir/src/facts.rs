//! What holds for values at every point, before every row: found from ops alone, whatever there is to know.
//!
//! An accumulator has the facts that its initial value has and that every next value keeps. The search begins
//! with those of the initial values and goes through the function, dropping what the next values do not have,
//! until nothing is dropped.

use crate::entity::{Block, Entity, Value};
use crate::function::{Function, InstKind};
use crate::op::Op;

/// What is known of a value. The default is nothing.
pub(crate) trait Fact: Copy + PartialEq + Default {
    /// Of an input, a constant or a column.
    fn leaf(kind: &InstKind) -> Self;
    /// Of the result of an op; `same` says that its first two operands are one value.
    fn of(op: Op, args: &[Self], same: bool) -> Self;
    /// What holds for both.
    fn join(self, other: Self) -> Self;
    /// What an accumulator may keep that begins with this: no number, which the first row would change.
    fn carried(self) -> Self;
}

/// Rounds after which the search gives up what is left. Two or three are usual; each drops a fact at least.
const MAX_ROUNDS: usize = 32;

/// The facts of every value. An accumulator's final value has those of the accumulator.
pub(crate) fn facts<F: Fact>(function: &Function) -> Vec<F> {
    let mut search = Search {
        function,
        facts: vec![F::default(); function.values.len()],
        accumulators: vec![None; function.values.len()],
        has_changed: false,
    };
    for _ in 0..MAX_ROUNDS {
        search.has_changed = false;
        search.block(function.body);
        if !search.has_changed {
            return search.facts;
        }
    }
    vec![F::default(); function.values.len()]
}

/// A search for a fixed point, from above.
struct Search<'a, F> {
    function: &'a Function,
    /// Of each value that has been met.
    facts: Vec<F>,
    /// Of each accumulator that has been met.
    accumulators: Vec<Option<F>>,
    has_changed: bool,
}

impl<F: Fact> Search<'_, F> {
    /// Lowers the facts of an accumulator to those that `value` has, too.
    fn meet(&mut self, accumulator: Value, value: Value) -> F {
        let new = self.facts[value.index()];
        let place = &mut self.accumulators[accumulator.index()];
        let met = place.map_or_else(|| new.carried(), |old| old.join(new));
        self.has_changed |= *place != Some(met);
        *place = Some(met);
        met
    }

    fn block(&mut self, block: Block) {
        let function = self.function;
        for &inst in &function.blocks[block].insts {
            crate::watch::look();
            let data = &function.insts[inst];
            let facts = match &data.kind {
                InstKind::Op { op, args } => {
                    let same = args.len() > 1 && args[0] == args[1];
                    let args: Vec<F> = args.iter().map(|arg| self.facts[arg.index()]).collect();
                    F::of(*op, &args, same)
                }
                InstKind::Fold(fold) => {
                    let body = &function.blocks[fold.body];
                    for (&param, &initial) in body.params.iter().zip(&fold.initial) {
                        self.facts[param.index()] = self.meet(param, initial);
                    }
                    self.block(fold.body);
                    for ((&param, &next), &result) in body.params.iter().zip(&body.results).zip(&data.results)
                    {
                        self.facts[result.index()] = self.meet(param, next);
                    }
                    continue;
                }
                leaf => F::leaf(leaf),
            };
            self.facts[data.results[0].index()] = facts;
        }
    }
}
