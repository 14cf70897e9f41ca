//! One attribute group: its part of an answer, and its accumulators in an operator.

use jbt_ir::{Domain, FunctionBuilder, Value};

use jbt_model::attribute::Mixing;

/// One attribute group of an answer.
#[derive(Clone, Debug)]
pub(crate) struct GroupAnswer {
    pub(crate) channels: Vec<Value>,
    /// For dominant groups: the part of the answer's weight that belongs to the leaf behind it; `None` is all
    /// of it.
    pub(crate) share: Option<Value>,
    /// Whether the channels are numbers of a row: finite in every lane.
    pub(crate) numbers: bool,
}

/// The accumulators of one attribute group.
#[derive(Clone, Debug)]
pub(super) struct GroupState {
    pub(super) channels: Vec<Value>,
    /// Dominant groups: the largest weight so far if the operator weighs, the winner's share if it lets one
    /// win.
    pub(super) best: Option<Value>,
    /// The place in the file of the operand behind `best`, where it matters.
    pub(super) order: Option<Value>,
}

impl GroupState {
    /// Takes the operand's channels where `takes`.
    pub(super) fn take(
        &mut self,
        d: &mut FunctionBuilder,
        takes: Value,
        answer: &GroupAnswer,
        order: Option<Value>,
    ) {
        for (channel, &taken) in self.channels.iter_mut().zip(&answer.channels) {
            *channel = d.select(takes, taken, *channel);
        }
        if let (Some(so_far), Some(order)) = (self.order, order) {
            self.order = Some(d.select(takes, order, so_far));
        }
    }

    /// The right side of a step comes to the left one.
    pub(super) fn join(&mut self, d: &mut FunctionBuilder, [left, right]: [Value; 2], answer: &GroupAnswer) {
        let zero = d.constant(0.0);
        let (has_left, has_right) = (d.lt(zero, left), d.lt(zero, right));
        let total = d.add(left, right);
        let part = d.div(right, total);
        // A side that is alone keeps its bits: then leaving out the other one changes none.
        if let Some(share) = self.best {
            let one = d.constant(1.0);
            let theirs = answer.share.unwrap_or(one);
            let rest = d.div(left, total);
            let (candidate, so_far) = (d.mul(part, theirs), d.mul(rest, share));
            let takes = d.lt(so_far, candidate);
            let both = d.select(takes, candidate, so_far);
            let alone = d.select(has_left, both, theirs);
            self.best = Some(d.select(has_right, alone, share));
            let without_left = d.not(has_left);
            let takes = d.either(takes, without_left);
            let takes = d.both(takes, has_right);
            self.take(d, takes, answer, None);
            return;
        }
        for (channel, &theirs) in self.channels.iter_mut().zip(&answer.channels) {
            let difference = d.sub(theirs, *channel);
            let mixed = d.fma(part, difference, *channel);
            let alone = d.select(has_left, mixed, theirs);
            *channel = d.select(has_right, alone, *channel);
        }
    }

    /// The group's answer once all weights are in; the default where `seen` is not positive.
    ///
    /// Divided, and not multiplied with a reciprocal: that is infinite for subnormal sums, and mixes like
    /// values inexactly.
    pub(super) fn normalised(
        &self,
        d: &mut FunctionBuilder,
        (total, seen): (Value, Value),
        default: &[Value],
    ) -> GroupAnswer {
        let zero = d.constant(0.0);
        let any = d.lt(zero, seen);
        let channels = self.channels.iter().zip(default).map(|(&channel, &default)| {
            let mixed = if self.best.is_some() { channel } else { d.div(channel, total) };
            d.select(any, mixed, default)
        });
        let channels = channels.collect();
        // Where nothing has weight, the default is all of the answer.
        let share = self.best.map(|best| {
            let (part, one) = (d.div(best, total), d.constant(1.0));
            d.select(any, part, one)
        });
        GroupAnswer { channels, share, numbers: false }
    }
}

/// The accumulators of all groups before the first operand. `weighs`: operands are weighed; `ordered`: ties
/// need their order in the file.
pub(super) fn group_states(
    zero: Value,
    mixing: &[Mixing],
    defaults: &[Vec<Value>],
    weighs: bool,
    ordered: bool,
) -> Vec<GroupState> {
    let of = |(default, mixing): (&Vec<Value>, &Mixing)| match mixing {
        Mixing::Blend => GroupState {
            channels: if weighs { vec![zero; default.len()] } else { default.clone() },
            best: None,
            order: None,
        },
        Mixing::Dominant => GroupState {
            channels: default.clone(),
            best: Some(zero),
            order: (weighs && ordered).then_some(zero),
        },
    };
    defaults.iter().zip(mixing).map(of).collect()
}
