//! The accumulators of an operator: its field, and its attributes in the same traversal.
//!
//! An operator either *weighs* its operands (sum, Ricci, product), lets one *win* (union, intersection) or
//! *steps* from one to the next.
//!
//! ```text
//! weighs   blend:     A = sum w a            in the end A / W, W = sum w
//!          dominant:  the a with the largest w * share, share being the part of w that the leaf behind a has in its operand
//! wins     both:      the a of the winner, and its share
//! steps    blend:     a = (l a + r b) / (l + r), of both sides' weights l and r; where one is 0, the other side's to the bit
//!          dominant:  that with the larger share
//! ```
//!
//! w is what the operator's own code gives (`Met::weight`): `f_i dF/df_i` up to a factor that all operands
//! share; for products all weights are equal. The table in `combine/mod.rs` of `jbt-model` has them.

mod group;

use std::rc::Rc;

use jbt_ir::{Domain, FunctionBuilder, InstKind, Origin, Rule, Value};

pub(super) use self::group::GroupAnswer;
use self::group::{GroupState, group_states};
use crate::prune_info::{ContestGroup, ContestKind, RowContest, StepFields};
use jbt_model::attribute::Mixing;
use jbt_model::combine::{Extreme, Met, ReduceCode, Setting, TakesApart};
use jbt_model::expression::LARGEST_FIELD;

/// What a subtree answers at a point.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    pub(super) field: Value,
    pub(super) groups: Vec<GroupAnswer>,
    /// In a range function: the contest of the operator that answers, if there is one and nobody else sees
    /// its answer.
    pub(super) contest: Option<usize>,
}

impl Answer {
    pub(super) const fn new(field: Value, groups: Vec<GroupAnswer>) -> Self {
        Self { field, groups, contest: None }
    }
}

/// What an operator is, to its accumulators.
#[derive(Clone, Debug)]
pub(super) struct Operator {
    pub(super) code: ReduceCode,
    /// The numbers that the row of the operator keeps.
    pub(super) row: Vec<Value>,
    /// Twice the iso-value: a complement is `2 iso - field`.
    pub(super) iso2: Value,
    /// Whether no operand can be negative.
    pub(super) non_negative: bool,
    /// Whether no operand is further from 0 than [`LARGEST_FIELD`].
    pub(super) bounded: bool,
    /// Whether operands have several shapes: then ties need their order in the file.
    pub(super) ordered: bool,
    /// Whether ranges will be made of it.
    pub(super) ranged: bool,
    /// Whether the field will be differentiated.
    pub(super) moving: bool,
    /// How each attribute group of the query mixes.
    pub(super) mixing: Rc<[Mixing]>,
}

impl Operator {
    const fn weighs(&self) -> bool {
        match self.code {
            ReduceCode::Fold(_) => true,
            ReduceCode::Choice(_) | ReduceCode::Step(_) => false,
        }
    }

    /// What folds have to know.
    fn setting(&self) -> Setting<'_, Value> {
        let Self { iso2, non_negative, moving, .. } = *self;
        Setting { row: &self.row, iso2, non_negative, moving }
    }

    /// Whether it gives the field of one operand and tells nobody which. Then bounds may wait until that is
    /// known.
    pub(super) fn only_chooses(&self) -> bool {
        let chooses = matches!(self.code, ReduceCode::Choice(_));
        chooses && !self.moving && self.mixing.is_empty()
    }

    /// Whether its field must not move where it is 0. There all operands but one that is zero may be left
    /// out, and another one may be 0 and yet move: a field that is too small for a number has a slope that
    /// is not.
    fn stands_still_at_zero(&self) -> bool {
        self.moving && !self.weighs() && self.rule() == Rule::OnlyZero
    }

    /// What may be done with operands that are rows and zero.
    pub(super) fn rule(&self) -> Rule {
        self.code.rule(self.non_negative)
    }

    /// The contest of these operands, if one of them wins.
    pub(super) fn contest(&self, mut groups: Vec<ContestGroup>, d: &FunctionBuilder) -> Option<RowContest> {
        let (extreme, kind) = match self.code {
            ReduceCode::Fold(_) => return None,
            ReduceCode::Choice(extreme) => {
                let start = (extreme == Extreme::Largest && self.non_negative).then_some(0.0);
                // The others are known by the range of the operator.
                groups.retain(|group| group.rows);
                (extreme, ContestKind::All(start))
            }
            ReduceCode::Step(code) => {
                let TakesApart { extreme, complements } = code.takes_apart()?;
                let &InstKind::Column { table, column } = d.definition(*self.row.first()?)? else {
                    return None;
                };
                let fields = if complements { StepFields::Complements } else { StepFields::Plain };
                (extreme, ContestKind::Steps(table, column, fields))
            }
        };
        let any = groups.iter().any(|group| group.rows);
        any.then_some(RowContest { extreme, kind, groups, node: None, difference: None })
    }

    /// Whether operands need their place in the file: something is decided among several groups, and somebody
    /// sees by whom.
    pub(super) fn wants_order(&self) -> bool {
        let decides = match self.code {
            ReduceCode::Fold(_) => self.mixing.contains(&Mixing::Dominant),
            ReduceCode::Choice(_) => self.moving || !self.mixing.is_empty(),
            // They come in that order.
            ReduceCode::Step(_) => false,
        };
        self.ordered && decides
    }
}

/// What no field goes beyond on the far side of an extreme. Finite, because a range with an infinite end says
/// nothing: every field is nearer to zero. `bounded`: no field is further from 0 than [`LARGEST_FIELD`].
pub(super) const fn beyond(extreme: Extreme, bounded: bool) -> f32 {
    match extreme {
        Extreme::Largest if bounded => -LARGEST_FIELD,
        Extreme::Largest => f32::MIN,
        Extreme::Smallest if bounded => LARGEST_FIELD,
        Extreme::Smallest => f32::MAX,
    }
}

/// The accumulators of an operator.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Fold: its own. Choice: the best field. Step: the left side.
    field: Vec<Value>,
    /// The place in the file of the winner, where it matters.
    order: Option<Value>,
    /// The sum of weights, where it is not among `field`. Step: 1 where the attributes so far have any
    /// weight, else 0.
    total: Option<Value>,
    groups: Vec<GroupState>,
}

impl State {
    /// The accumulators before the first operand. `defaults` are the channels of every group.
    pub(super) fn new(d: &mut FunctionBuilder, operator: &Operator, defaults: &[Vec<Value>]) -> Self {
        let zero = d.constant(0.0);
        let field = match operator.code {
            ReduceCode::Fold(code) => code.start(d, operator.setting()),
            // Until its first operand comes.
            ReduceCode::Step(_) => vec![zero],
            // Begins at 0, as if an operand were 0: one above 0 still wins, and where none is, attributes are
            // defaults.
            ReduceCode::Choice(Extreme::Largest) if operator.non_negative => vec![zero],
            ReduceCode::Choice(extreme) => vec![d.constant(beyond(extreme, operator.bounded))],
        };
        let weighs = operator.weighs();
        let wants_attributes = !defaults.is_empty();
        let separate_total = wants_attributes
            && match operator.code {
                ReduceCode::Fold(code) => code.has_total(operator.non_negative),
                ReduceCode::Step(_) => true,
                ReduceCode::Choice(_) => false,
            };
        let groups = group_states(zero, &operator.mixing, defaults, weighs, operator.wants_order());
        Self {
            field,
            order: (!weighs && operator.wants_order()).then_some(zero),
            total: separate_total.then_some(zero),
            groups,
        }
    }

    /// All accumulators, in a fixed order.
    pub(super) fn values(&mut self) -> Vec<Value> {
        let mut values = Vec::new();
        self.each(|value| values.push(*value));
        values
    }

    /// Other values for the same accumulators.
    pub(super) fn replace(&mut self, values: &[Value]) {
        let mut next = values.iter();
        self.each(|value| *value = *next.next().expect("as many as there are accumulators"));
    }

    fn each(&mut self, mut visit: impl FnMut(&mut Value)) {
        self.field.iter_mut().for_each(&mut visit);
        self.order.iter_mut().for_each(&mut visit);
        self.total.iter_mut().for_each(&mut visit);
        for group in &mut self.groups {
            group.channels.iter_mut().for_each(&mut visit);
            group.best.iter_mut().for_each(&mut visit);
            group.order.iter_mut().for_each(&mut visit);
        }
    }

    /// One operand more. `order` is its place in the file, where the operator is ordered.
    pub(super) fn meet(
        &mut self,
        d: &mut FunctionBuilder,
        operator: &Operator,
        operand: &Answer,
        order: Option<Value>,
    ) {
        match operator.code {
            ReduceCode::Fold(code) => {
                let weighs = !self.groups.is_empty();
                let setting = operator.setting();
                let Met { so_far, weight, rescale } =
                    code.meet(d, &self.field, operand.field, setting, weighs);
                self.field = so_far;
                if let Some(weight) = weight.filter(|_| weighs) {
                    if let Some(total) = &mut self.total {
                        *total = d.add(*total, weight);
                    }
                    weigh(d, &mut self.groups, (weight, rescale), operand, order);
                }
            }
            ReduceCode::Step(code) => {
                let origin = if code.creases() { Origin::CREASE } else { d.origin() };
                let before = d.set_origin(origin);
                let pair = code.emit(d, [self.field[0], operand.field], &operator.row, operator.iso2);
                let sides = [self.field[0], operand.field];
                self.field[0] = if operator.ranged {
                    code.bounded(d, (pair.field, sides), &operator.row, operator.iso2)
                } else {
                    pair.field
                };
                d.set_origin(before);
                let Some(known) = self.total else { return };
                let (zero, one) = (d.constant(0.0), d.constant(1.0));
                let is_known = d.lt(zero, known);
                let [left, right] = pair.weights;
                let left = d.select(is_known, left, zero);
                for (state, answer) in self.groups.iter_mut().zip(&operand.groups) {
                    state.join(d, [left, right], answer);
                }
                let total = d.add(left, right);
                let any = d.lt(zero, total);
                self.total = Some(d.select(any, one, zero));
            }
            ReduceCode::Choice(extreme) => self.win(d, extreme, operand, order),
        }
    }

    /// The first operand of a step.
    pub(super) fn seed(&mut self, d: &mut FunctionBuilder, operand: &Answer) {
        self.field[0] = operand.field;
        if let Some(known) = &mut self.total {
            *known = d.constant(1.0);
        }
        for (state, answer) in self.groups.iter_mut().zip(&operand.groups) {
            state.channels.clone_from(&answer.channels);
            if let Some(share) = &mut state.best {
                *share = answer.share.unwrap_or_else(|| d.constant(1.0));
            }
        }
    }

    /// Lets the operand win, where it does.
    fn win(&mut self, d: &mut FunctionBuilder, extreme: Extreme, operand: &Answer, order: Option<Value>) {
        let (best, orders) = (self.field[0], self.order.zip(order));
        let is_asked = orders.is_some() || !self.groups.is_empty();
        let takes = is_asked.then(|| takes(d, extreme, best, operand.field, orders));
        if let (Some(takes), Some((so_far, order))) = (takes, orders) {
            self.order = Some(d.select(takes, order, so_far));
        }
        let before = d.set_origin(Origin::CREASE);
        self.field[0] = match (takes, orders) {
            (Some(takes), Some(_)) => d.select(takes, operand.field, best),
            _ => extreme.step(d, best, operand.field),
        };
        d.set_origin(before);
        let Some(takes) = takes else { return };
        for (state, answer) in self.groups.iter_mut().zip(&operand.groups) {
            if let Some(share) = state.best {
                let one = d.constant(1.0);
                state.best = Some(d.select(takes, answer.share.unwrap_or(one), share));
            }
            state.take(d, takes, answer, None);
        }
    }

    /// The operator's answer.
    pub(super) fn finish(
        &self,
        d: &mut FunctionBuilder,
        operator: &Operator,
        defaults: &[Vec<Value>],
    ) -> Answer {
        // What it divides by, and what has to be positive for that.
        let (field, total, seen) = match operator.code {
            ReduceCode::Fold(code) => {
                let finished = code.finish(d, &self.field, self.total, operator.setting());
                (finished.field, finished.total, finished.seen)
            }
            ReduceCode::Choice(_) => (self.field[0], self.field[0], self.field[0]),
            ReduceCode::Step(_) => {
                let seen = self.total.map_or(self.field[0], |known| d.min(self.field[0], known));
                (self.field[0], seen, seen)
            }
        };
        let field = if operator.stands_still_at_zero() { still_at_zero(d, field) } else { field };
        let groups = self.groups.iter().zip(defaults).map(|(state, default)| {
            if operator.weighs() {
                state.normalised(d, (total, seen), default)
            } else {
                let channels = where_positive(d, seen, &state.channels, default);
                GroupAnswer { channels, share: share_where_positive(d, seen, state.best), numbers: false }
            }
        });
        Answer::new(field, groups.collect())
    }
}

/// The field, to the bit, without a slope where it is not positive.
fn still_at_zero(d: &mut FunctionBuilder, field: Value) -> Value {
    let zero = d.constant(0.0);
    let is_positive = d.lt(zero, field);
    let still = d.stop_gradient(field);
    d.select(is_positive, field, still)
}

/// The attributes of operands by these weights, none of which is negative.
pub(super) fn weighted(
    d: &mut FunctionBuilder,
    mixing: &[Mixing],
    operands: &[Answer],
    weights: &[Value],
    defaults: &[Vec<Value>],
) -> Vec<GroupAnswer> {
    let zero = d.constant(0.0);
    let mut groups = group_states(zero, mixing, defaults, true, false);
    let mut total = zero;
    for (operand, &weight) in operands.iter().zip(weights) {
        weigh(d, &mut groups, (weight, None), operand, None);
        total = d.add(total, weight);
    }
    groups.iter().zip(defaults).map(|(group, default)| group.normalised(d, (total, total), default)).collect()
}

/// Whether a candidate takes over: it beats what is there, or equals it and comes earlier in the file.
fn takes(
    d: &mut FunctionBuilder,
    extreme: Extreme,
    so_far: Value,
    candidate: Value,
    orders: Option<(Value, Value)>,
) -> Value {
    let better = extreme.beats(d, so_far, candidate);
    let Some((order_so_far, order)) = orders else { return better };
    let equal = d.eq(so_far, candidate);
    let earlier = d.lt(order, order_so_far);
    let tie = d.both(equal, earlier);
    d.either(better, tie)
}

/// Adds the attributes of an operand with a weight; what weights so far are multiplied with comes behind it.
fn weigh(
    d: &mut FunctionBuilder,
    groups: &mut [GroupState],
    (weight, rescale): (Value, Option<Value>),
    operand: &Answer,
    order: Option<Value>,
) {
    let zero = d.constant(0.0);
    for (state, answer) in groups.iter_mut().zip(&operand.groups) {
        let Some(best) = state.best else {
            for (sum, &channel) in state.channels.iter_mut().zip(&answer.channels) {
                let so_far = rescale.map_or(*sum, |rescale| d.mul(*sum, rescale));
                let added = d.fma(weight, channel, so_far);
                // A row without weight leaves the sum alone, whatever is in its channels: 0 * NaN must not
                // get in.
                *sum = if answer.numbers {
                    added
                } else {
                    let counts = d.lt(zero, weight);
                    d.select(counts, added, so_far)
                };
            }
            continue;
        };
        let candidate = answer.share.map_or(weight, |share| d.mul(weight, share));
        let best = rescale.map_or(best, |rescale| d.mul(best, rescale));
        let takes = takes(d, Extreme::Largest, best, candidate, state.order.zip(order));
        state.best = Some(d.select(takes, candidate, best));
        state.take(d, takes, answer, order);
    }
}

/// The channels of whoever decided; the default where the field that was decided on has no weight.
fn where_positive(
    d: &mut FunctionBuilder,
    field: Value,
    channels: &[Value],
    default: &[Value],
) -> Vec<Value> {
    let zero = d.constant(0.0);
    let weighs = d.lt(zero, field);
    channels.iter().zip(default).map(|(&channel, &default)| d.select(weighs, channel, default)).collect()
}

/// The share of the leaf behind the channels; all where the field that was decided on has no weight, because
/// the default is all of the answer there.
fn share_where_positive(d: &mut FunctionBuilder, field: Value, share: Option<Value>) -> Option<Value> {
    share.map(|share| {
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let weighs = d.lt(zero, field);
        d.select(weighs, share, one)
    })
}

/// The answer of a map: the child's attributes where both fields are positive.
pub(super) fn mapped(
    d: &mut FunctionBuilder,
    field: Value,
    child: &Answer,
    defaults: &[Vec<Value>],
) -> Answer {
    let groups = child.groups.iter().zip(defaults).map(|(group, default)| {
        let channels = where_positive(d, child.field, &group.channels, default);
        let share = share_where_positive(d, child.field, group.share);
        GroupAnswer { channels: where_positive(d, field, &channels, default), share, numbers: false }
    });
    let groups = groups.collect();
    Answer::new(field, groups)
}

/// The answer of the left child of a difference, or of the subtracted one where that decides.
pub(super) fn difference(
    d: &mut FunctionBuilder,
    left: &Answer,
    right: &Answer,
    iso2: Value,
    defaults: &[Vec<Value>],
) -> Answer {
    let before = d.set_origin(Origin::CREASE);
    let (field, cuts) = jbt_model::combine::difference::emit(d, left.field, right.field, iso2);
    d.set_origin(before);
    let one = d.constant(1.0);
    let groups = left.groups.iter().zip(&right.groups).zip(defaults).map(|((left, right), default)| {
        let decided: Vec<Value> =
            left.channels.iter().zip(&right.channels).map(|(&l, &r)| d.select(cuts, r, l)).collect();
        GroupAnswer {
            channels: where_positive(d, field, &decided, default),
            share: match (left.share, right.share) {
                (None, None) => None,
                (l, r) => Some(d.select(cuts, r.unwrap_or(one), l.unwrap_or(one))),
            },
            numbers: left.numbers && right.numbers,
        }
    });
    Answer::new(field, groups.collect())
}
