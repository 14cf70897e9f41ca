//! Pairs: two ops in one loop, where the second op is the only reader of the first op's result.
//!
//! An op that runs alone reads its operands from registers in memory and writes its result there, which takes
//! longer than its arithmetic. In a pair the first result stays in the CPU. Pairs save about two of five ops.
//!
//! ```text
//!     r3 = sub r0, s4                                              r3 = SubSquareAdd r0, s4, r2
//!     r3 = fma r3, r3, r2        becomes                           t = sub(a, s), fma(t, t, b)
//! ```
//!
//! Each row of the table is a loop of its own. The rows are the most frequent pairs in programs of examples
//! and of other people's models; any other pair runs as two ops and gives the same bits.

use crate::domain::scalar::Scalar;
use crate::entity::Value;
use crate::op::{Domain, Op};

use super::ops::{Chunk, Lanes};
use super::place::ScratchPlace;

/// Operands of a pair, at most.
pub(super) const MOST_OPERANDS: usize = 5;

/// An op and its operands.
pub(super) type Single<'a> = (Op, &'a [Value]);

/// An operand of a pair.
trait Operand: Copy {
    /// What it is in a lane.
    type Value;
    /// Whether it is the same in all lanes.
    const IS_SPLAT: bool;
    fn new(place: ScratchPlace, splats: &[u32]) -> Self;
    fn at(self, row: &[Chunk], lane: usize) -> Self::Value;
}

/// A register whose lanes are read as a type.
macro_rules! register {
    ($(#[$doc:meta])* $name:ident, $value:ty, |$bits:ident| $read:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        struct $name(usize);

        impl Operand for $name {
            type Value = $value;
            const IS_SPLAT: bool = false;

            #[inline(always)]
            fn new(place: ScratchPlace, _: &[u32]) -> Self {
                Self(place.index())
            }

            #[inline(always)]
            fn at(self, row: &[Chunk], lane: usize) -> $value {
                let $bits = row[self.0].0[lane];
                $read
            }
        }
    };
}

register! {
    /// A register of reals.
    Real, f32, |bits| f32::from_bits(bits)
}
register! {
    /// A register of masks. One bit alone is read: the sign test of a vector blend.
    Mask, bool, |bits| bits.cast_signed() < 0
}

/// A real that is the same in all lanes.
#[derive(Clone, Copy)]
struct Number(f32);

impl Operand for Number {
    type Value = f32;
    const IS_SPLAT: bool = true;

    #[inline(always)]
    fn new(place: ScratchPlace, splats: &[u32]) -> Self {
        Self(f32::from_bits(splats[place.index()]))
    }

    #[inline(always)]
    fn at(self, _: &[Chunk], _: usize) -> f32 {
        self.0
    }
}

/// A result, as the bits of a lane.
trait Result {
    fn bits(self) -> u32;
}

impl Result for f32 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.to_bits()
    }
}

impl Result for bool {
    #[inline(always)]
    fn bits(self) -> u32 {
        if self { !0 } else { 0 }
    }
}

/// A row of the table as data.
struct Pattern {
    pair: FusedPair,
    /// For each operand, whether it is a splat.
    splats: &'static [bool],
    first: Op,
    /// The operands of the first op, as positions in those of the pair.
    of_first: &'static [usize],
    second: Op,
    /// The operands of the second op: positions, or [`T`].
    of_second: &'static [usize],
}

/// The result of the first op.
const T: usize = usize::MAX;

/// The op with the name of a method of [`Domain`].
const fn op_named(name: &str) -> Op {
    let mut at = 0;
    while at < Op::ALL.len() {
        if same(Op::ALL[at].name(), name) {
            return Op::ALL[at];
        }
        at += 1;
    }
    panic!("the op table has an op of this name")
}

/// The position of a name, or [`T`] if it is not there.
const fn position(names: &[&str], name: &str) -> usize {
    let mut at = 0;
    while at < names.len() {
        if same(names[at], name) {
            return at;
        }
        at += 1;
    }
    T
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut at = 0;
    while at < a.len() && at < b.len() && a[at] == b[at] {
        at += 1;
    }
    a.len() == at && b.len() == at
}

macro_rules! pairs {
    ($(
        $name:ident ( $($arg:ident: $kind:ident),+ ) $t:ident = $first:ident ( $($p:ident),+ ),
            $second:ident ( $($q:ident),+ );
    )+) => {
        /// Two ops in one loop.
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        pub(super) enum FusedPair {
            $(
                #[doc = concat!(stringify!($t = $first($($p),+)), ", ", stringify!($second($($q),+)))]
                $name,
            )+
        }

        static PATTERNS: &[Pattern] = &[$({
            const NAMES: &[&str] = &[$(stringify!($arg)),+];
            Pattern {
                pair: FusedPair::$name,
                splats: &[$($kind::IS_SPLAT),+],
                first: op_named(stringify!($first)),
                of_first: &[$(position(NAMES, stringify!($p))),+],
                second: op_named(stringify!($second)),
                of_second: &[$(position(NAMES, stringify!($q))),+],
            }
        }),+];

        impl Lanes<'_> {
            /// Runs a pair; the result register gets what the second op gives.
            #[inline(always)]
            pub(super) fn pair(&mut self, pair: FusedPair, args: &[ScratchPlace; MOST_OPERANDS], splats: &[u32]) {
                match pair {
                    $(FusedPair::$name => {
                        let mut places = args.iter();
                        $(
                            let $arg = $kind::new(*places.next().expect("as many as the row has"), splats);
                        )+
                        self.each(|row, lane| {
                            $( let $arg = $arg.at(row, lane); )+
                            let $t = Scalar.$first($($p),+);
                            Scalar.$second($($q),+).bits()
                        });
                    })+
                }
            }
        }
    };
}

pairs! {
    // Distances and falloffs.
    SubSquare(a: Real, s: Number) t = sub(a, s), mul(t, t);
    SubSquareAdd(a: Real, s: Number, b: Real) t = sub(a, s), fma(t, t, b);
    SubAbs(a: Real, s: Number) t = sub(a, s), abs(t);
    SubMax(a: Real, s: Number, u: Number) t = sub(a, s), max(t, u);
    SubFromMax(s: Number, a: Real, u: Number) t = sub(s, a), max(t, u);
    AbsSub(a: Real, s: Number) t = abs(a), sub(t, s);
    SqrtSub(a: Real, s: Number) t = sqrt(a), sub(t, s);
    FmaSqrt(a: Real, b: Real, c: Real) t = fma(a, b, c), sqrt(t);
    FmaMax(a: Real, s: Number, u: Number, v: Number) t = fma(a, s, u), max(t, v);
    FmaAbs(a: Real, s: Number, b: Real) t = fma(a, s, b), abs(t);
    FmaSquare(a: Real, s: Number, b: Real) t = fma(a, s, b), mul(t, t);
    FmaSquareAdd(a: Real, s: Number, b: Real, c: Real) t = fma(a, s, b), fma(t, t, c);
    MaxSquare(a: Real, s: Number) t = max(a, s), mul(t, t);
    MaxMin(a: Real, s: Number, u: Number) t = max(a, s), min(t, u);
    MinMax(a: Real, s: Number, u: Number) t = min(a, s), max(t, u);

    // Products and sums.
    MulMul(a: Real, b: Real, c: Real) t = mul(a, b), mul(t, c);
    MulScale(a: Real, b: Real, s: Number) t = mul(a, b), mul(t, s);
    ScaleMul(a: Real, s: Number, b: Real) t = mul(a, s), mul(t, b);
    MulAdd(a: Real, b: Real, c: Real) t = mul(a, b), add(t, c);
    MulShift(a: Real, b: Real, s: Number) t = mul(a, b), add(t, s);
    ScaleAdd(a: Real, s: Number, b: Real) t = mul(a, s), add(t, b);
    ScaleShift(a: Real, s: Number, u: Number) t = mul(a, s), add(t, u);
    ShiftAdd(a: Real, s: Number, b: Real) t = add(a, s), add(t, b);
    AddAdd(a: Real, b: Real, c: Real) t = add(a, b), add(t, c);
    MulSub(a: Real, b: Real, c: Real) t = mul(a, b), sub(t, c);
    MulSubFrom(a: Real, b: Real, c: Real) t = mul(a, b), sub(c, t);
    SubMul(a: Real, b: Real, c: Real) t = sub(a, b), mul(t, c);
    SubAdd(a: Real, b: Real, c: Real) t = sub(a, b), add(t, c);
    MulFma(a: Real, b: Real, c: Real, d: Real) t = mul(a, b), fma(c, d, t);
    MulFmaScale(a: Real, b: Real, c: Real, s: Number) t = mul(a, b), fma(c, s, t);
    MulFmaShift(a: Real, b: Real, s: Number, u: Number) t = mul(a, b), fma(t, s, u);
    ScaleFma(a: Real, s: Number, b: Real, c: Real) t = mul(a, s), fma(b, c, t);
    ScaleFmaScale(a: Real, s: Number, b: Real, u: Number) t = mul(a, s), fma(b, u, t);
    MulFmaMul(a: Real, b: Real, c: Real, d: Real) t = mul(a, b), fma(t, c, d);

    // Chains of fused products.
    FmaMul(a: Real, b: Real, c: Real, d: Real) t = fma(a, b, c), mul(t, d);
    FmaScaleMul(a: Real, s: Number, b: Real, c: Real) t = fma(a, s, b), mul(t, c);
    Horner(a: Real, s: Number, u: Number, b: Real, v: Number) t = fma(a, s, u), fma(t, b, v);
    HornerMul(a: Real, s: Number, u: Number, b: Real) t = fma(a, s, u), mul(t, b);
    HornerNext(a: Real, b: Real, s: Number, c: Real, u: Number) t = fma(a, b, s), fma(t, c, u);
    Dot(a: Real, s: Number, u: Number, b: Real, v: Number) t = fma(a, s, u), fma(b, v, t);
    DotNext(a: Real, s: Number, b: Real, c: Real, u: Number) t = fma(a, s, b), fma(c, u, t);
    FmaLinear(a: Real, b: Real, c: Real, s: Number, u: Number) t = fma(a, b, c), fma(t, s, u);
    FmaFma(a: Real, b: Real, c: Real, d: Real, e: Real) t = fma(a, b, c), fma(d, e, t);
    FmaInto(a: Real, s: Number, b: Real, c: Real, d: Real) t = fma(a, s, b), fma(t, c, d);
    FmaSub(a: Real, b: Real, c: Real, s: Number) t = fma(a, b, c), sub(t, s);
    FmaSubFrom(a: Real, b: Real, s: Number, c: Real) t = fma(a, b, s), sub(c, t);

    // Decisions.
    BelowChoose(a: Real, s: Number, u: Number, v: Number) t = lt(a, s), select(t, u, v);
    BelowKeep(a: Real, s: Number, b: Real, u: Number) t = lt(a, s), select(t, b, u);
    BelowReplace(a: Real, s: Number, u: Number, b: Real) t = lt(a, s), select(t, u, b);
    AboveChoose(s: Number, a: Real, u: Number, v: Number) t = lt(s, a), select(t, u, v);
    AboveKeep(s: Number, a: Real, b: Real, u: Number) t = lt(s, a), select(t, b, u);
    LessChoose(a: Real, b: Real, u: Number, v: Number) t = lt(a, b), select(t, u, v);
    LessSelect(a: Real, b: Real, c: Real, d: Real) t = lt(a, b), select(t, c, d);
    LessEither(a: Real, b: Real, m: Mask) t = lt(a, b), either(t, m);
    AboveBoth(s: Number, a: Real, m: Mask) t = lt(s, a), both(t, m);
    MulKeep(a: Real, b: Real, m: Mask, c: Real) t = mul(a, b), select(m, t, c);
    MulKeepElse(a: Real, b: Real, m: Mask, s: Number) t = mul(a, b), select(m, t, s);
    MulReplace(a: Real, b: Real, m: Mask, c: Real) t = mul(a, b), select(m, c, t);
    ScaleKeep(a: Real, s: Number, m: Mask, b: Real) t = mul(a, s), select(m, t, b);
    ScaleReplace(a: Real, s: Number, m: Mask, b: Real) t = mul(a, s), select(m, b, t);
    ScaleReplaceBy(a: Real, s: Number, m: Mask, u: Number) t = mul(a, s), select(m, u, t);
    FmaReplace(a: Real, b: Real, c: Real, m: Mask, d: Real) t = fma(a, b, c), select(m, d, t);
    AddReplace(a: Real, b: Real, m: Mask, c: Real) t = add(a, b), select(m, c, t);
    DivKeepElse(a: Real, b: Real, m: Mask, s: Number) t = div(a, b), select(m, t, s);
    OverKeepElse(s: Number, a: Real, m: Mask, u: Number) t = div(s, a), select(m, t, u);

    // Ranges.
    MaxMax(a: Real, b: Real, c: Real) t = max(a, b), max(c, t);
    MinMin(a: Real, b: Real, c: Real) t = min(a, b), min(c, t);
    FmaMaxOf(a: Real, b: Real, c: Real, d: Real) t = fma(a, b, c), max(d, t);
    FmaMinOf(a: Real, b: Real, c: Real, d: Real) t = fma(a, b, c), min(d, t);
    ScaleMaxOf(a: Real, s: Number, b: Real) t = mul(a, s), max(b, t);
    ScaleMinOf(a: Real, s: Number, b: Real) t = mul(a, s), min(b, t);
}

/// The pair that two ops form, and its operands. `t` is the first result, which only the second op reads.
pub(super) fn find(
    first: Single<'_>,
    t: Value,
    second: Single<'_>,
    is_splat: impl Fn(Value) -> bool,
) -> Option<(FusedPair, [Value; MOST_OPERANDS])> {
    let candidates = PATTERNS.iter().filter(|of| of.first == first.0 && of.second == second.0);
    let mut orders =
        candidates.flat_map(|pattern| [0, 1, 2, 3].map(|order| (pattern, order & 1 == 1, order & 2 == 2)));
    orders.find_map(|(pattern, swap_first, swap_second)| {
        if swap_first && !first.0.commutes() || swap_second && !second.0.commutes() {
            return None;
        }
        let mut found = [None; MOST_OPERANDS];
        let first = ordered(first.1, swap_first).zip(pattern.of_first);
        let second = ordered(second.1, swap_second).zip(pattern.of_second);
        let matches = first.chain(second).all(|(value, &position)| {
            if position == T || value == t {
                return position == T && value == t;
            }
            let is_new = found[position].is_none_or(|known| known == value);
            found[position] = Some(value);
            is_new && pattern.splats[position] == is_splat(value)
        });
        // A pair may have fewer operands than the array has places; the other places are never read.
        matches.then(|| (pattern.pair, found.map(|value| value.unwrap_or(t))))
    })
}

/// Operands, the first two swapped or not.
fn ordered(args: &[Value], swap: bool) -> impl Iterator<Item = Value> {
    (0..args.len()).map(move |at| args[if swap && at < 2 { 1 - at } else { at }])
}

#[cfg(test)]
mod tests {
    use jbt_testkit::bits::same;
    use jbt_testkit::points::OPERANDS;

    use super::super::ops::WIDTH;
    use super::*;
    use crate::domain::lanes::{Scratch, Tape};
    use crate::interpret::run;
    use crate::level::Level;
    use crate::op::Type;
    use crate::{FunctionBuilder, Selection, Tables, verify};

    /// A function that is one pair: registers are inputs, masks are their signs.
    fn function_of(pattern: &Pattern, numbers: &[f32]) -> crate::Function {
        let types = |op: Op, positions: &'static [usize]| {
            positions.iter().copied().zip(op.operands().iter().copied())
        };
        let mut is_mask = [false; MOST_OPERANDS];
        for (position, type_) in
            types(pattern.first, pattern.of_first).chain(types(pattern.second, pattern.of_second))
        {
            if position != T && type_ == Type::Mask {
                is_mask[position] = true;
            }
        }
        let mut b = FunctionBuilder::new("pair", &["a", "b", "c", "d", "e"]);
        let zero = b.constant(0.0);
        let args: Vec<Value> = (0..pattern.splats.len())
            .map(|at| match (pattern.splats[at], is_mask[at]) {
                (true, _) => b.constant(numbers[at]),
                (false, false) => b.input(at),
                (false, true) => {
                    let input = b.input(at);
                    b.lt(input, zero)
                }
            })
            .collect();
        let of_first: Vec<Value> = pattern.of_first.iter().map(|&at| args[at]).collect();
        let t = b.op(pattern.first, &of_first);
        let of_second: Vec<Value> =
            pattern.of_second.iter().map(|&at| if at == T { t } else { args[at] }).collect();
        let result = b.op(pattern.second, &of_second);
        let (one, two) = (b.constant(1.0), b.constant(2.0));
        let mut real = |value, is_mask| if is_mask { b.select(value, one, two) } else { value };
        let mut outputs = vec![("out".to_owned(), real(result, pattern.second.result() == Type::Mask))];
        // A mask with another reader is not the first of a pair.
        for (at, &mask) in args.iter().enumerate().filter(|&(at, _)| is_mask[at]) {
            outputs.push((format!("m{at}"), real(mask, true)));
        }
        b.finish(&outputs)
    }

    #[test]
    fn every_pair_has_the_bits_of_its_ops() {
        let mut rng = fastrand::Rng::with_seed(3);
        for pattern in PATTERNS {
            let mut spicy = || OPERANDS[rng.usize(..OPERANDS.len())];
            for round in 0..20 {
                let numbers: Vec<f32> = (0..MOST_OPERANDS).map(|_| spicy()).collect();
                let function = verify(function_of(pattern, &numbers)).expect("it obeys the rules");
                let tape = Tape::new(&function).expect("its ops are plain");
                assert!(tape.pairs().any(|pair| pair == pattern.pair), "{:?} is not found", pattern.pair);
                let points = 3 * WIDTH + 5;
                let planes: Vec<Vec<f32>> = (0..5).map(|_| (0..points).map(|_| spicy()).collect()).collect();
                let inputs: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
                for level in Level::available() {
                    let mut out = vec![vec![0.0; points]; function.function().outputs.len()];
                    let mut outputs: Vec<&mut [f32]> = out.iter_mut().map(Vec::as_mut_slice).collect();
                    let nothing = (&Tables::default(), &Selection::default());
                    tape.run_at(level, nothing, &inputs, &mut outputs, &mut Scratch::new())
                        .expect("they fit");
                    for (point, &given) in out[0].iter().enumerate() {
                        let at: Vec<f32> = planes.iter().map(|plane| plane[point]).collect();
                        let expected: f32 = run(&function, &Tables::default(), &mut Scalar, &at)[0];
                        let pair = pattern.pair;
                        assert!(
                            same(given, expected),
                            "{pair:?} of {at:?} and {numbers:?}: {given:e}, not {expected:e} ({round})"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_result_that_is_read_twice_stays() {
        let pairs = |is_read_twice: bool| {
            let mut b = FunctionBuilder::new("twice", &["x", "y"]);
            let (x, y) = (b.input(0), b.input(1));
            let product = b.mul(x, y);
            let sum = b.add(product, x);
            let mut outputs = vec![("sum".to_owned(), sum)];
            if is_read_twice {
                outputs.push(("product".to_owned(), product));
            }
            let function = verify(b.finish(&outputs)).expect("it obeys the rules");
            Tape::new(&function).expect("its ops are plain").pairs().collect::<Vec<FusedPair>>()
        };
        assert_eq!(pairs(true), []);
        assert_eq!(pairs(false), [FusedPair::MulAdd]);
    }
}
