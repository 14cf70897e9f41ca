//! Finds rows that change no accumulator, and the condition for that: the gate.
//!
//! ```text
//! fold t ricci (m, s):                        gate: near is +0
//!     near = max ..., 0         +0            as if it were +0
//!     f    = mul near, near     +0
//!     next = max f, m           m             m > 0 in every row: it begins at a positive number and only grows
//!     r    = div (min f, m), m  +0
//!     sum  = add s, r           s             s is never -0
//!     yield next, sum           m, s          what it was given: the row may end at the gate
//! ```
//!
//! Most rows of a model are out of reach of most points. Where the gate holds at all points that an engine
//! computes together, the engine may leave out the rest of the row: every bit stays. A row around folds has
//! another gate: the results of these folds equal their initial values, because all rows inside changed
//! nothing. Both are proven here, by constant propagation from the gate and by facts of the accumulators that
//! hold before every row. (All NaNs count as one.)

use std::collections::{HashMap, HashSet};

use crate::domain::scalar::Scalar;
use crate::entity::{Block, Entity, Inst, Store, Value};
use crate::facts::Fact;
use crate::function::{Fold, FoldKind, Function, InstKind};
use crate::op::{Any, Op, apply};

/// The least number of steps that a gate has to save. The test costs about four.
const LEAST_SPARED: usize = 12;
/// Steps that a division or a root counts as.
const SLOW: usize = 6;
/// The largest number of values of a body for which a proof is tried.
const MOST_TRIED: usize = 4;
/// In an fma with a constant addend at least this large, the product is 0 or too large for the sum to be
/// tiny: the sum is exact where it cancels, and its zero is +0.
const LARGE: f32 = 1e-12;

/// The condition at a point under which a row changes no accumulator: each value is this number, bit for bit.
#[derive(Clone, PartialEq, Debug)]
pub struct Gate(pub Vec<(Value, f32)>);

/// The gate of each fold's body, if it has one.
pub type Gates = Store<Block, Option<Gate>>;

/// For the body of each fold the first gate that saves enough to be tested, if there is one.
#[must_use]
pub fn gates(function: &Function) -> Gates {
    let mut gates = Store::new();
    for _ in function.blocks.keys() {
        gates.push(None);
    }
    let mut constants = vec![None; function.values.len()];
    for data in function.insts.values() {
        if let InstKind::Constant(number) = data.kind {
            constants[data.results[0].index()] = Some(number);
        }
    }
    let (mut facts, mut now) = (None, vec![None; function.values.len()]);
    for data in function.insts.values() {
        let InstKind::Fold(fold) = &data.kind else { continue };
        for (at, gate) in candidates(function, &function.blocks[fold.body].insts, &constants) {
            let facts = facts.get_or_insert_with(|| crate::facts::facts::<ValueFacts>(function));
            if is_idle(function, fold, (at, &gate), facts, &mut now) {
                gates[fold.body] = Some(gate);
                break;
            }
        }
    }
    gates
}

/// Where gates may be, and what they are: values clamped at 0, which are 0 at most points as a rule; and
/// results of folds inside, which equal their initial values if all rows inside change nothing.
fn candidates(function: &Function, insts: &[Inst], constants: &[Option<f32>]) -> Vec<(usize, Gate)> {
    let is_zero = |value: Value| constants[value.index()].is_some_and(|number| number.to_bits() == 0);
    // For each result of a fold in this block: the initial value of the first fold in the chain that hands it
    // on.
    let mut began: HashMap<Value, f32> = HashMap::new();
    let (mut candidates, mut clamped, mut last_fold) = (Vec::new(), 0, None);
    for (at, &inst) in insts.iter().enumerate() {
        let data = &function.insts[inst];
        match &data.kind {
            InstKind::Op { op: Op::Max | Op::Add, args } if is_zero(args[1]) && clamped < MOST_TRIED => {
                clamped += 1;
                candidates.push((at, Gate(vec![(data.results[0], 0.0)])));
            }
            InstKind::Fold(fold) => {
                for (&result, initial) in data.results.iter().zip(&fold.initial) {
                    let number = constants[initial.index()].or_else(|| began.get(initial).copied());
                    began.extend(number.map(|number| (result, number)));
                }
                let numbers = data.results.iter().map(|result| Some((*result, *began.get(result)?)));
                let gate = numbers.collect::<Option<Vec<_>>>().map(|values| (at, Gate(values)));
                last_fold = gate.or(last_fold);
            }
            _ => {}
        }
    }
    candidates.extend(last_fold);
    candidates.retain(|&(at, _)| spared(function, insts, at) >= LEAST_SPARED);
    candidates
}

/// Whether a row changes no accumulator where a gate holds, which is known after an instruction. `now` is
/// empty before and after the call.
fn is_idle(
    function: &Function,
    fold: &Fold,
    (at, gate): (usize, &Gate),
    facts: &[ValueFacts],
    now: &mut [Option<Now>],
) -> bool {
    let body = &function.blocks[fold.body];
    for &(value, number) in &gate.0 {
        now[value.index()] = Some(Now::number(number));
    }
    for &inst in &body.insts[at + 1..] {
        crate::watch::look();
        let data = &function.insts[inst];
        if let InstKind::Op { op, args } = &data.kind {
            let result = data.results[0];
            now[result.index()] = Some(step(*op, args, facts, now, result));
        }
    }
    let of = |value: Value| now[value.index()].unwrap_or_else(|| Now::known(value, facts[value.index()]));
    let mut all = body.params.iter().zip(&body.results).zip(&fold.initial);
    let is_idle = all.all(|((&param, &next), &initial)| {
        let begins = Now::known(initial, facts[initial.index()]);
        // A guard has one row, so its result may also equal the initial value.
        let is_first = fold.kind == FoldKind::Guard && begins.is_exact() && of(next) == begins;
        is_first || of(next) == Now::Same(param)
    });
    for &inst in &body.insts[at..] {
        for result in &function.insts[inst].results {
            now[result.index()] = None;
        }
    }
    is_idle
}

/// The cost that is saved if a row ends after this instruction: of everything that the instruction does not
/// depend on.
fn spared(function: &Function, insts: &[Inst], at: usize) -> usize {
    let mut wanted: HashSet<Value> = function.operands(insts[at]).iter().copied().collect();
    let cost = |inst: Inst| match &function.insts[inst].kind {
        InstKind::Op { op: Op::Div | Op::Sqrt, .. } => SLOW,
        InstKind::Op { .. } => 1,
        _ => 0,
    };
    let mut spared = insts[at + 1..].iter().map(|&inst| cost(inst)).sum();
    for &inst in insts[..at].iter().rev() {
        crate::watch::look();
        let data = &function.insts[inst];
        if data.results.iter().any(|result| wanted.contains(result)) {
            wanted.extend(function.operands(inst));
        } else {
            spared += cost(inst);
        }
    }
    spared
}

/// Facts of a value that hold at every point, before every row.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct ValueFacts {
    /// It is more than 0, and no NaN.
    is_positive: bool,
    /// It is not less than 0.
    is_not_negative: bool,
    /// It is not -0.
    is_not_minus_zero: bool,
    /// The number, where the program has it; never NaN.
    constant: Option<f32>,
    /// The bits, where the program has them.
    bits: Option<u32>,
}

impl ValueFacts {
    fn constant(number: f32) -> Self {
        Self {
            is_positive: number > 0.0,
            is_not_negative: number >= 0.0,
            is_not_minus_zero: number.to_bits() != (-0.0_f32).to_bits(),
            constant: (!number.is_nan()).then_some(number),
            bits: None,
        }
    }

    fn is_plus_zero(self) -> bool {
        self.constant.is_some_and(|number| number.to_bits() == 0)
    }
}

impl Fact for ValueFacts {
    fn leaf(kind: &InstKind) -> Self {
        match kind {
            InstKind::Constant(number) => Self::constant(*number),
            InstKind::BitsConstant(bits) => Self { bits: Some(*bits), ..Self::default() },
            _ => Self::default(),
        }
    }

    fn join(self, other: Self) -> Self {
        Self {
            is_positive: self.is_positive && other.is_positive,
            is_not_negative: self.is_not_negative && other.is_not_negative,
            is_not_minus_zero: self.is_not_minus_zero && other.is_not_minus_zero,
            constant: None,
            bits: None,
        }
    }

    fn carried(self) -> Self {
        Self { constant: None, bits: None, ..self }
    }

    fn of(op: Op, args: &[Self], same: bool) -> Self {
        let minus = |is_not_minus_zero| Self { is_not_minus_zero, ..Self::default() };
        match op {
            // The second operand is the result where an operand is NaN or the first is not larger.
            Op::Max => Self {
                is_positive: args[1].is_positive,
                is_not_negative: args[1].is_not_negative,
                is_not_minus_zero: args[1].is_positive || args[1].is_plus_zero(),
                ..Self::default()
            },
            Op::Select => args[1].join(args[2]),
            Op::StopGradient | Op::LowEnd => args[0],
            // Only -0 and -0 give -0: a sum that cancels is +0, and a sum is never too small to be exact.
            Op::Add => minus(args[0].is_not_minus_zero || args[1].is_not_minus_zero),
            Op::Fma => minus(args[2].constant.is_some_and(|number| number.abs() >= LARGE)),
            Op::Abs => Self { is_not_negative: true, ..minus(true) },
            Op::Mul => Self { is_not_negative: same, ..minus(same) },
            _ => Self::default(),
        }
    }
}

/// What is known of a value where the gate holds.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Now {
    /// The same bits as this value has without the gate; nothing else is known.
    Same(Value),
    Zero {
        /// Whether it is +0; otherwise the sign is unknown.
        is_plus: bool,
    },
    /// Another number, but no NaN.
    Number(f32),
    Bits(u32),
    Truth(bool),
}

impl Now {
    /// The knowledge of a number other than NaN.
    fn number(number: f32) -> Self {
        if number == 0.0 { Self::Zero { is_plus: number.is_sign_positive() } } else { Self::Number(number) }
    }

    /// The knowledge of a value that does not depend on the gate.
    fn known(value: Value, facts: ValueFacts) -> Self {
        let bits = facts.bits.map(Self::Bits);
        bits.or_else(|| facts.constant.map(Self::number)).unwrap_or(Self::Same(value))
    }

    /// Whether all its bits are known.
    const fn is_exact(self) -> bool {
        match self {
            Self::Zero { is_plus } => is_plus,
            Self::Number(_) | Self::Bits(_) | Self::Truth(_) => true,
            Self::Same(_) => false,
        }
    }
}

/// The result of an op where the gate holds.
fn step(op: Op, args: &[Value], facts: &[ValueFacts], now: &[Option<Now>], result: Value) -> Now {
    use Now::{Number, Same, Truth, Zero};
    let of = |value: Value| now[value.index()].unwrap_or_else(|| Now::known(value, facts[value.index()]));
    let args: Vec<Now> = args.iter().map(|&arg| of(arg)).collect();
    if let Some(number) = computed(op, &args) {
        return number;
    }
    let facts_of = |value: Value| facts[value.index()];
    let is_positive = |value: Value| facts_of(value).is_positive;
    match (op, &args[..]) {
        (Op::StopGradient | Op::LowEnd, &[value]) => value,
        (Op::Mul, &[Zero { .. }, Zero { .. }]) => Zero { is_plus: false },
        (Op::Mul, &[Zero { .. }, Number(number)] | &[Number(number), Zero { .. }]) if number.is_finite() => {
            Zero { is_plus: false }
        }
        (Op::Add, &[Zero { is_plus: a }, Zero { is_plus: b }]) => Zero { is_plus: a || b },
        (Op::Add, &[Zero { .. }, Same(value)] | &[Same(value), Zero { .. }])
            if facts_of(value).is_not_minus_zero =>
        {
            Same(value)
        }
        (Op::Sub, &[Same(value), Zero { is_plus: true }]) => Same(value),
        (Op::Max | Op::Min, &[Same(a), Same(b)]) if a == b => Same(a),
        (Op::Div, &[Zero { is_plus }, Same(value)]) if is_positive(value) => Zero { is_plus },
        // `a > b ? a : b` and `a < b ? a : b`.
        (Op::Max, &[Zero { .. }, Same(value)]) if facts_of(value).is_not_negative => Same(value),
        (Op::Max, &[Same(value), Zero { .. }]) if is_positive(value) => Same(value),
        (Op::Min, &[zero @ Zero { .. }, Same(value)] | &[Same(value), zero @ Zero { .. }])
            if is_positive(value) =>
        {
            zero
        }
        (Op::Lt | Op::Le, &[Zero { .. }, Same(value)]) if is_positive(value) => Truth(true),
        (Op::Lt | Op::Le, &[Same(value), Zero { .. }]) if is_positive(value) => Truth(false),
        (Op::Select, &[Truth(truth), yes, no]) => {
            if truth {
                yes
            } else {
                no
            }
        }
        (Op::Select, &[_, yes, no]) if yes == no => yes,
        _ => Same(result),
    }
}

/// The result of an op on operands whose bits are all known.
fn computed(op: Op, args: &[Now]) -> Option<Now> {
    let exact = |arg: &Now| match *arg {
        Now::Zero { is_plus: true } => Some(Any::Real(0.0)),
        Now::Number(number) => Some(Any::Real(number)),
        Now::Bits(bits) => Some(Any::Bits(bits)),
        Now::Truth(truth) => Some(Any::Mask(truth)),
        Now::Zero { is_plus: false } | Now::Same(_) => None,
    };
    let args: Option<Vec<Any<Scalar>>> = args.iter().map(exact).collect();
    match apply(&mut Scalar, op, &args?) {
        // The bits of a NaN are unspecified.
        Any::Real(number) if number.is_nan() => None,
        Any::Real(number) => Some(Now::number(number)),
        Any::Mask(truth) => Some(Now::Truth(truth)),
        Any::Bits(bits) => Some(Now::Bits(bits)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::FunctionBuilder;
    use crate::entity::Table;
    use crate::function::{Rule, Schema};
    use crate::op::Domain;

    /// A fold of ten roots and what `write` makes of the accumulator, which begins at `start`, and of a
    /// clamped number.
    fn fold(start: f32, write: impl FnOnce(&mut FunctionBuilder, Value, Value) -> Value) -> Option<Gate> {
        fold_of(FoldKind::Rows, start, write)
    }

    /// The same for a kind of fold.
    fn fold_of(
        kind: FoldKind,
        start: f32,
        write: impl FnOnce(&mut FunctionBuilder, Value, Value) -> Value,
    ) -> Option<Gate> {
        let mut b = FunctionBuilder::new("fold", &["x"]);
        let columns = vec!["c".to_owned()];
        let table = b.table(Schema { name: "t".to_owned(), columns, parent: None, slots: Vec::new() });
        let (x, zero, start) = (b.input(0), b.constant(0.0), b.constant(start));
        let acc = b.begin_fold(table, (kind, Rule::Neutral), &[start])[0];
        let column = b.column(table, 0);
        let reach = b.sub(column, x);
        let near = b.max(reach, zero);
        let root = (0..10).fold(near, |value, _| b.sqrt(value));
        let next = write(&mut b, acc, root);
        let out = b.end_fold(&[next])[0];
        let function = b.finish(&[("out".to_owned(), out)]);
        let gates = gates(&function);
        let mut found = function.blocks.keys().filter_map(|block| gates[block].clone());
        let found = found.next();
        let expected = Gate(vec![(near, 0.0)]);
        assert!(found.iter().all(|gate| *gate == expected), "the clamped number is the gate");
        found
    }

    #[test]
    fn a_sum_is_gated_unless_it_may_be_minus_zero() {
        assert!(fold(0.0, Domain::add).is_some());
        assert!(fold(1.0, |b, acc, term| b.add(term, acc)).is_some());
        assert!(fold(-0.0, Domain::add).is_none(), "-0 and +0 is +0");
        assert!(fold(0.0, Domain::mul).is_none());
        assert!(fold(0.0, |_, _, term| term).is_none(), "the last term, and no sum");
    }

    #[test]
    fn the_largest_is_gated_while_it_is_positive() {
        assert!(fold(1e-30, |b, acc, term| b.max(term, acc)).is_some());
        assert!(fold(-1.0, |b, acc, term| b.max(term, acc)).is_none(), "0 is larger");
        // Where the term is NaN the result is, and then the next comparison loses the row before.
        assert!(fold(1e-30, Domain::max).is_none());
        assert!(fold(1.0, |b, acc, term| b.min(term, acc)).is_none());
    }

    #[test]
    fn a_quotient_by_what_is_positive_is_gated() {
        let ratio = |b: &mut FunctionBuilder, acc, term| {
            let (small, large) = (b.min(acc, term), b.max(term, acc));
            let ratio = b.div(small, large);
            let is_larger = b.lt(acc, term);
            let (more, less) = (b.mul(ratio, acc), b.add(acc, ratio));
            let next = b.select(is_larger, more, less);
            b.max(next, large)
        };
        assert!(fold(1e-30, ratio).is_some());
        assert!(fold(0.0, ratio).is_none(), "0 / 0");
    }

    #[test]
    fn bits_are_known_where_the_program_has_them() {
        let masked = |b: &mut FunctionBuilder, acc, term| {
            let (bits, mask) = (b.to_bits(term), b.bits_constant(0x7fff_ffff));
            let bits = b.bit_and(bits, mask);
            let size = b.from_bits(bits);
            b.add(acc, size)
        };
        assert!(fold(0.0, masked).is_some());
        let marked = |b: &mut FunctionBuilder, acc, term| {
            let (bits, mark) = (b.to_bits(term), b.bits_constant(0x3f80_0000));
            let bits = b.bit_or(bits, mark);
            let one = b.from_bits(bits);
            b.add(acc, one)
        };
        assert!(fold(0.0, marked).is_none(), "each row adds 1");
    }

    #[test]
    fn a_guard_may_also_yield_its_initial_value() {
        assert!(fold_of(FoldKind::Guard, 0.0, |_, _, term| term).is_some());
        assert!(fold_of(FoldKind::Guard, 1.0, |_, _, term| term).is_none());
        let zero_of_a_sign = |b: &mut FunctionBuilder, _, term| {
            let minus = b.constant(-1.0);
            b.mul(term, minus)
        };
        assert!(fold_of(FoldKind::Guard, -0.0, zero_of_a_sign).is_none(), "which zero it is, nobody knows");
        let other = |b: &mut FunctionBuilder, acc, term| {
            let sum = b.add(acc, term);
            b.sqrt(sum)
        };
        assert!(fold_of(FoldKind::Guard, 2.0, other).is_none());
        assert!(fold_of(FoldKind::Guard, 0.0, Domain::add).is_some());
    }

    #[test]
    fn comparisons_with_what_is_positive_are_known() {
        let below = |b: &mut FunctionBuilder, acc, term| {
            let (is_below, one) = (b.lt(term, acc), b.constant(1.0));
            let kept = b.select(is_below, acc, one);
            b.max(term, kept)
        };
        assert!(fold(1e-30, below).is_some());
        assert!(fold(-1.0, below).is_none(), "0 is not less than -1");
        let at_least = |b: &mut FunctionBuilder, acc, term| {
            let (is_at_least, one) = (b.le(acc, term), b.constant(1.0));
            let kept = b.select(is_at_least, one, acc);
            b.max(term, kept)
        };
        assert!(fold(1e-30, at_least).is_some());
        assert!(fold(-1.0, at_least).is_none());
    }

    #[test]
    fn the_least_of_what_may_be_negative_is_unknown() {
        let sum = |b: &mut FunctionBuilder, acc, term| {
            let least = b.min(acc, term);
            b.add(acc, least)
        };
        assert!(fold(-1.0, sum).is_none(), "the sum of -1 and -1");
        let turned = |b: &mut FunctionBuilder, acc, term| {
            let least = b.min(term, acc);
            b.add(acc, least)
        };
        assert!(fold(-1.0, turned).is_none());
    }

    /// A fold whose quotient is by one of two numbers; which of them, the accumulator decides.
    fn by_one_of(numbers: [f32; 2]) -> Option<Gate> {
        fold(0.0, |b, acc, term| {
            let [first, second] = numbers.map(|number| b.constant(number));
            let (one, number) = (b.constant(1.0), b.column(Table::new(0), 0));
            let is_less = b.lt(number, one);
            let chosen = b.select(is_less, first, second);
            let quotient = b.div(term, chosen);
            b.add(acc, quotient)
        })
    }

    #[test]
    fn what_holds_of_both_branches_holds_of_a_choice() {
        assert!(by_one_of([2.0, 3.0]).is_some());
        assert!(by_one_of([2.0, 0.0]).is_none(), "0 / 0");
        assert!(by_one_of([0.0, 2.0]).is_none());
    }

    /// A sum of products and a constant, as an accumulator that a row may leave as it is.
    fn of_fma(addend: f32) -> Option<Gate> {
        fold(1.0, |b, acc, term| {
            let (one, addend) = (b.constant(1.0), b.constant(addend));
            let (sum, product) = (b.add(acc, term), b.fma(acc, acc, addend));
            let is_inside = b.lt(one, term);
            b.select(is_inside, product, sum)
        })
    }

    #[test]
    fn a_sum_with_a_product_is_never_minus_zero_if_the_addend_is_large() {
        assert!(of_fma(1.0).is_some());
        assert!(of_fma(-LARGE).is_some());
        assert!(of_fma(1e-20).is_none(), "a product of about -1e-20 may leave a -0");
    }

    /// Whether a sum of one clamped number has a gate: with steps before it that it does not need, and after.
    fn spares(before: usize, after: usize) -> bool {
        let mut b = FunctionBuilder::new("fold", &["x"]);
        let schema =
            Schema { name: "t".to_owned(), columns: vec!["c".to_owned()], parent: None, slots: Vec::new() };
        let table = b.table(schema);
        let (x, zero) = (b.input(0), b.constant(0.0));
        let acc = b.begin_fold(table, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
        let column = b.column(table, 0);
        let other = (0..before).fold(column, |value, _| b.add(value, x));
        let near = b.max(column, zero);
        let term = (0..after).fold(near, |value, _| b.mul(value, near));
        let next = b.add(acc, term);
        // What the gate does not need is needed by the row.
        let is_high = b.lt(column, other);
        let next = b.select(is_high, acc, next);
        let out = b.end_fold(&[next])[0];
        let function = b.finish(&[("out".to_owned(), out)]);
        gates(&function).values().any(Option::is_some)
    }

    #[test]
    fn what_spares_little_is_no_gate() {
        // The sum, the comparison and the choice are three steps more.
        for before in [0, 1, 5] {
            let after = LEAST_SPARED - before - 3;
            assert!(spares(before, after), "{before} steps before and {after} after");
            assert!(!spares(before, after - 1), "{before} steps before and {} after", after - 1);
        }
    }
}
