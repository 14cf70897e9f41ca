//! Adds the gradient of the first output along the first three inputs: outputs `gx`, `gy` and `gz`, right
//! behind it. A zero component is +0.
//!
//! The function is run once in the [`Tangent`] domain. Primal instructions are shared with the derivatives,
//! so nothing is computed twice. A fold gets three more accumulators for each accumulator that depends on the
//! inputs and that the first output depends on. These are found beforehand, because an accumulator may begin
//! to depend on the inputs only in the body.
//!
//! ```text
//! (s) = fold t0 rows neutral (0) (acc): ... yield next
//!     becomes
//! (s, sx, sy, sz) = fold t0 rows neutral (0, 0, 0, 0) (acc, ax, ay, az): ... yield next, nx, ny, nz
//! ```

use std::borrow::Cow;

use smallvec::SmallVec;

use crate::builder::FunctionBuilder;
use crate::domain::tangent::{Slope, Tangent};
use crate::entity::{Entity, Table, Value};
use crate::function::{Fold, Function, InstData, InstKind};
use crate::op::{Any, Domain, Op, Type, apply};
use crate::origin::Origin;
use crate::translate::{AccumulatorParts, Translation, translate};

/// Names of the outputs that the pass adds.
pub const GRADIENT_OUTPUTS: [&str; 3] = ["gx", "gy", "gz"];

/// The function with the gradient of its first output.
#[must_use]
pub fn gradient(function: &Function) -> Function {
    with_gradient(function, Tangent::new(FunctionBuilder::like(function)))
}

/// The function with derivatives in place of its slopes, and no output more.
pub(super) fn slopes(function: &Function) -> Cow<'_, Function> {
    let has_slopes = function.insts.values().any(|inst| asks_slope(inst).is_some());
    if !has_slopes {
        return Cow::Borrowed(function);
    }
    let tangent = Tangent::new(FunctionBuilder::like(function));
    let differentiated = differentiated(function, None);
    let mut differentiation = Differentiation { differentiated, function, tangent };
    let results = translate(function, &mut differentiation);
    let values = results.into_iter().map(|result| result.real().value);
    let outputs: Vec<(String, Value)> = function.outputs.iter().cloned().zip(values).collect();
    Cow::Owned(differentiation.tangent.builder.finish(&outputs))
}

/// The value whose slope an instruction is.
fn asks_slope(inst: &InstData) -> Option<Value> {
    match &inst.kind {
        InstKind::Op { op, args } if op.is_slope() => Some(args[0]),
        InstKind::Op { .. }
        | InstKind::Input(_)
        | InstKind::Constant(_)
        | InstKind::BitsConstant(_)
        | InstKind::Column { .. }
        | InstKind::Fold(_) => None,
    }
}

/// As [`gradient`], with guards: every component is finite and within
/// [`LARGEST_SLOPE`](crate::domain::tangent::LARGEST_SLOPE), whatever overflows on the way. Where nothing
/// overflows, the bits are the same. It costs several times as many ops.
#[must_use]
pub fn guarded_gradient(function: &Function) -> Function {
    with_gradient(function, Tangent::guarded(FunctionBuilder::like(function)))
}

fn with_gradient(function: &Function, tangent: Tangent) -> Function {
    let first = function.blocks[function.body].results.first().copied();
    let differentiated = differentiated(function, first);
    let mut differentiation = Differentiation { differentiated, function, tangent };
    let results = translate(function, &mut differentiation);
    let mut outputs = Vec::new();
    for (index, (name, result)) in function.outputs.iter().zip(results).enumerate() {
        let dual = result.real();
        outputs.push((name.clone(), dual.value));
        if index == 0 {
            let slope = differentiation.components(dual.slope);
            let tangent = &mut differentiation.tangent;
            let zero = tangent.builder.constant(0.0);
            for (name, component) in GRADIENT_OUTPUTS.iter().zip(slope) {
                let component = tangent.saturated(component);
                // The sign of a zero may depend on rows that add nothing; adding +0 removes it.
                let component = tangent.builder.add(component, zero);
                outputs.push(((*name).to_owned(), component));
            }
        }
    }
    differentiation.tangent.builder.finish(&outputs)
}

/// The values that `first` depends on, or anything whose slope is asked for.
fn wanted(function: &Function, first: Option<Value>) -> Vec<bool> {
    let mut wanted = vec![false; function.values.len()];
    let mut waiting: Vec<Value> =
        first.into_iter().chain(function.insts.values().filter_map(asks_slope)).collect();
    // The direct dependences of each value: its operands; for an accumulator, its initial and its next value.
    let mut sources: Vec<Vec<Value>> = vec![Vec::new(); function.values.len()];
    for inst in function.insts.values() {
        crate::watch::look();
        match &inst.kind {
            InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. } => {}
            InstKind::Op { args, .. } => sources[inst.results[0].index()] = args.to_vec(),
            InstKind::Fold(fold) => {
                let body = &function.blocks[fold.body];
                for (place, result) in inst.results.iter().enumerate() {
                    let of = vec![fold.initial[place], body.results[place]];
                    sources[body.params[place].index()].clone_from(&of);
                    sources[result.index()] = of;
                }
            }
        }
    }
    while let Some(value) = waiting.pop() {
        if !std::mem::replace(&mut wanted[value.index()], true) {
            waiting.extend(&sources[value.index()]);
        }
    }
    wanted
}

/// Which values depend on the inputs and change `first`, or anything whose slope is asked for.
fn differentiated(function: &Function, first: Option<Value>) -> Vec<bool> {
    let mut varies = depends_on_point(function);
    for (varies, wanted) in varies.iter_mut().zip(wanted(function, first)) {
        *varies &= wanted;
    }
    // An accumulator may be wanted only in the body, or only behind the fold: its tangent exists in both or
    // in neither.
    for inst in function.insts.values() {
        if let InstKind::Fold(fold) = &inst.kind {
            for (&param, &result) in function.blocks[fold.body].params.iter().zip(&inst.results) {
                let either = varies[param.index()] || varies[result.index()];
                varies[param.index()] = either;
                varies[result.index()] = either;
            }
        }
    }
    varies
}

/// Which values depend on the inputs. Accumulators need a fixed point: the body may make an accumulator
/// depend on the inputs whose initial value does not.
fn depends_on_point(function: &Function) -> Vec<bool> {
    let mut varies = vec![false; function.values.len()];
    loop {
        let before = varies.iter().filter(|&&varies| varies).count();
        for inst in function.insts.values() {
            crate::watch::look();
            match &inst.kind {
                InstKind::Input(index) => varies[inst.results[0].index()] = *index < 3,
                InstKind::Constant(_) | InstKind::BitsConstant(_) | InstKind::Column { .. } => {}
                InstKind::Op { op, args } => {
                    let held = *op == Op::StopGradient || op.is_slope() || op.result() != Type::Real;
                    varies[inst.results[0].index()] = !held && args.iter().any(|arg| varies[arg.index()]);
                }
                InstKind::Fold(fold) => {
                    let body = &function.blocks[fold.body];
                    for (place, result) in inst.results.iter().enumerate() {
                        let depends =
                            varies[fold.initial[place].index()] || varies[body.results[place].index()];
                        varies[body.params[place].index()] |= depends;
                        varies[result.index()] |= depends;
                    }
                }
            }
        }
        if varies.iter().filter(|&&varies| varies).count() == before {
            return varies;
        }
    }
}

/// The translation into the tangent domain.
struct Differentiation<'a> {
    function: &'a Function,
    /// The values that have a tangent.
    differentiated: Vec<bool>,
    tangent: Tangent,
}

impl Differentiation<'_> {
    /// The three components of a slope.
    fn components(&mut self, slope: Slope) -> [Value; 3] {
        let components = self.tangent.components(slope);
        components.map(|component| component.unwrap_or_else(|| self.tangent.builder.constant(0.0)))
    }
}

impl Translation for Differentiation<'_> {
    type Value = Any<Tangent>;
    type Part = Value;

    fn begin(&mut self, origin: Origin) {
        self.tangent.builder.set_origin(origin);
    }

    fn input(&mut self, index: usize) -> Any<Tangent> {
        let value = self.tangent.builder.input(index);
        if index >= 3 {
            return Any::Real(Tangent::still(value));
        }
        let one = self.tangent.builder.constant(1.0);
        let axis = std::array::from_fn(|axis| (axis == index).then_some(one));
        Any::Real(self.tangent.with_tangent(value, axis))
    }

    fn constant(&mut self, number: f32) -> Any<Tangent> {
        Any::Real(self.tangent.constant(number))
    }

    fn bits_constant(&mut self, bits: u32) -> Any<Tangent> {
        Any::Bits(self.tangent.bits_constant(bits))
    }

    fn column(&mut self, table: Table, column: usize) -> Any<Tangent> {
        Any::Real(Tangent::still(self.tangent.builder.column(table, column)))
    }

    /// Where nothing needs the tangent of the result, operands go without theirs.
    fn op(&mut self, inst: &InstData, op: Op, args: &[Any<Tangent>]) -> Any<Tangent> {
        if self.differentiated[inst.results[0].index()] || asks_slope(inst).is_some() {
            return apply(&mut self.tangent, op, args);
        }
        let args: SmallVec<[Any<Tangent>; 3]> = args.iter().map(|&arg| still(arg)).collect();
        apply(&mut self.tangent, op, &args)
    }

    /// The value, and its tangent if the accumulator has one.
    fn split(&mut self, value: Any<Tangent>, accumulator: Value, parts: &mut AccumulatorParts<Value>) {
        match value {
            Any::Mask(mask) => parts.push(mask),
            Any::Bits(bits) => parts.push(bits),
            Any::Real(dual) => {
                parts.push(dual.value);
                if self.differentiated[accumulator.index()] {
                    parts.extend(self.components(dual.slope));
                }
            }
        }
    }

    fn whole(&mut self, accumulator: Value, mut next: impl FnMut() -> Value) -> Any<Tangent> {
        let value = next();
        match self.function.values[accumulator] {
            Type::Mask => Any::Mask(value),
            Type::Bits => Any::Bits(value),
            Type::Real if self.differentiated[accumulator.index()] => {
                // Components are finite, and so are accumulators made of them.
                let slope = [0; 3].map(|_| Some(self.tangent.note(next())));
                Any::Real(self.tangent.with_tangent(value, slope))
            }
            Type::Real => Any::Real(Tangent::still(value)),
        }
    }

    fn enter(&mut self, fold: &Fold, _: usize, initial: AccumulatorParts<Value>) -> AccumulatorParts<Value> {
        self.tangent.builder.begin_fold(fold.table, (fold.kind, fold.rule), &initial).into()
    }

    fn leave(&mut self, _: &Fold, origin: Origin, next: AccumulatorParts<Value>) -> AccumulatorParts<Value> {
        self.tangent.builder.set_origin(origin);
        self.tangent.builder.end_fold(&next).into()
    }
}

/// An operand without its tangent.
fn still(operand: Any<Tangent>) -> Any<Tangent> {
    match operand {
        Any::Real(dual) => Any::Real(Tangent::still(dual.value)),
        Any::Mask(_) | Any::Bits(_) => operand,
    }
}
