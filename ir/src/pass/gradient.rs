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

use crate::builder::FunctionBuilder;
use crate::domain::tangent::{Dual, Tangent, Vector};
use crate::entity::{Block, Entity, Value};
use crate::function::{Fold, Function, InstKind};
use crate::op::{Any, Domain, Op, Type, apply};

/// Names of the outputs that the pass adds.
pub const GRADIENT_OUTPUTS: [&str; 3] = ["gx", "gy", "gz"];

/// The function with the gradient of its first output.
#[must_use]
pub fn gradient(function: &Function) -> Function {
    with_gradient(function, Tangent::new(FunctionBuilder::like(function)))
}

/// As [`gradient`], with guards: every component is finite and within
/// [`LARGEST_SLOPE`](crate::domain::tangent::LARGEST_SLOPE), whatever overflows on the way. Where nothing
/// overflows, the bits are the same. It costs several times as many ops.
#[must_use]
pub fn guarded_gradient(function: &Function) -> Function {
    with_gradient(function, Tangent::guarded(FunctionBuilder::like(function)))
}

fn with_gradient(function: &Function, tangent: Tangent) -> Function {
    let mut pass = GradientPass {
        function,
        moves: moving(function),
        tangent,
        values: vec![None; function.values.len()],
    };
    pass.block(function.body);
    let body = &function.blocks[function.body];
    let mut outputs = Vec::new();
    for (index, (name, &value)) in function.outputs.iter().zip(&body.results).enumerate() {
        let dual = pass.value(value).real();
        outputs.push((name.clone(), dual.value));
        if index == 0 {
            let slope = pass.tangent.components(dual.slope);
            let zero = pass.tangent.builder.constant(0.0);
            for (name, component) in GRADIENT_OUTPUTS.iter().zip(pass.with_zeros(slope)) {
                let component = pass.tangent.saturated(component);
                // The sign of a zero may depend on rows that add nothing; adding +0 removes it.
                let component = pass.tangent.builder.add(component, zero);
                outputs.push(((*name).to_owned(), component));
            }
        }
    }
    pass.tangent.builder.finish(&outputs)
}

/// The values that the first output depends on.
fn wanted(function: &Function) -> Vec<bool> {
    let mut wanted = vec![false; function.values.len()];
    let mut waiting: Vec<Value> =
        function.blocks[function.body].results.first().copied().into_iter().collect();
    // The direct dependences of each value: its operands; for an accumulator, its initial and its next value.
    let mut sources: Vec<Vec<Value>> = vec![Vec::new(); function.values.len()];
    for inst in function.insts.values() {
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

/// Which values depend on the inputs and change the first output.
fn moving(function: &Function) -> Vec<bool> {
    let mut moves = moved(function);
    for (moves, wanted) in moves.iter_mut().zip(wanted(function)) {
        *moves &= wanted;
    }
    // An accumulator may be wanted only in the body, or only behind the fold: its tangent exists in both or
    // in neither.
    for inst in function.insts.values() {
        if let InstKind::Fold(fold) = &inst.kind {
            for (&param, &result) in function.blocks[fold.body].params.iter().zip(&inst.results) {
                let either = moves[param.index()] || moves[result.index()];
                moves[param.index()] = either;
                moves[result.index()] = either;
            }
        }
    }
    moves
}

/// Which values depend on the inputs. Accumulators need a fixed point: the body may make an accumulator
/// depend on the inputs whose initial value does not.
fn moved(function: &Function) -> Vec<bool> {
    let mut moves = vec![false; function.values.len()];
    loop {
        let before = moves.iter().filter(|&&m| m).count();
        for inst in function.insts.values() {
            match &inst.kind {
                InstKind::Input(index) => moves[inst.results[0].index()] = *index < 3,
                InstKind::Constant(_) | InstKind::BitsConstant(_) | InstKind::Column { .. } => {}
                InstKind::Op { op, args } => {
                    let held = *op == Op::StopGradient || op.result() != Type::Real;
                    moves[inst.results[0].index()] = !held && args.iter().any(|arg| moves[arg.index()]);
                }
                InstKind::Fold(fold) => {
                    let body = &function.blocks[fold.body];
                    for (place, result) in inst.results.iter().enumerate() {
                        let moved = moves[fold.initial[place].index()] || moves[body.results[place].index()];
                        moves[body.params[place].index()] |= moved;
                        moves[result.index()] |= moved;
                    }
                }
            }
        }
        if moves.iter().filter(|&&m| m).count() == before {
            return moves;
        }
    }
}

struct GradientPass<'a> {
    function: &'a Function,
    moves: Vec<bool>,
    tangent: Tangent,
    values: Vec<Option<Any<Tangent>>>,
}

impl GradientPass<'_> {
    fn value(&self, value: Value) -> Any<Tangent> {
        self.values[value.index()].expect("a verified function defines values before it uses them")
    }

    /// An operand; without its tangent if nothing needs the tangent of the result.
    fn operand(&self, value: Value, moves: bool) -> Any<Tangent> {
        match self.value(value) {
            Any::Real(dual) if !moves => Any::Real(Tangent::still(dual.value)),
            operand => operand,
        }
    }

    fn with_zeros(&mut self, vector: Vector) -> [Value; 3] {
        vector.map(|component| component.unwrap_or_else(|| self.tangent.builder.constant(0.0)))
    }

    fn block(&mut self, block: Block) {
        for &inst in &self.function.blocks[block].insts {
            let data = &self.function.insts[inst];
            self.tangent.builder.set_origin(data.origin);
            let result = match &data.kind {
                InstKind::Input(index) => Any::Real(self.input(*index)),
                InstKind::Constant(number) => Any::Real(self.tangent.constant(*number)),
                InstKind::BitsConstant(bits) => Any::Bits(self.tangent.bits_constant(*bits)),
                InstKind::Column { table, column } => {
                    Any::Real(Tangent::still(self.tangent.builder.column(*table, *column)))
                }
                InstKind::Op { op, args } => {
                    let moves = self.moves[data.results[0].index()];
                    let args: Vec<Any<Tangent>> = args.iter().map(|&arg| self.operand(arg, moves)).collect();
                    apply(&mut self.tangent, *op, &args)
                }
                InstKind::Fold(fold) => {
                    self.fold(fold, &data.results);
                    continue;
                }
            };
            self.values[data.results[0].index()] = Some(result);
        }
    }

    fn input(&mut self, index: usize) -> Dual {
        let value = self.tangent.builder.input(index);
        if index >= 3 {
            return Tangent::still(value);
        }
        let one = self.tangent.builder.constant(1.0);
        let axis = std::array::from_fn(|axis| (axis == index).then_some(one));
        self.tangent.moving(value, axis)
    }

    /// The fold, with three more accumulators for each accumulator that has a tangent.
    fn fold(&mut self, fold: &Fold, results: &[Value]) {
        let origin = self.tangent.builder.origin();
        let body = &self.function.blocks[fold.body];
        let initial = self.flatten(&fold.initial, &body.params);
        let params = self.tangent.builder.begin_fold(fold.table, (fold.kind, fold.rule), &initial);
        self.unflatten(&body.params, &params);
        self.block(fold.body);
        let next = self.flatten(&body.results, &body.params);
        self.tangent.builder.set_origin(origin);
        let finals = self.tangent.builder.end_fold(&next);
        self.unflatten(results, &finals);
    }

    /// The values, each followed by its tangent where the accumulator in its place has one.
    fn flatten(&mut self, values: &[Value], accumulators: &[Value]) -> Vec<Value> {
        let mut flat = Vec::new();
        for (&value, accumulator) in values.iter().zip(accumulators) {
            match self.value(value) {
                Any::Mask(mask) => flat.push(mask),
                Any::Bits(bits) => flat.push(bits),
                Any::Real(dual) => {
                    flat.push(dual.value);
                    if self.moves[accumulator.index()] {
                        let slope = self.tangent.components(dual.slope);
                        flat.extend(self.with_zeros(slope));
                    }
                }
            }
        }
        flat
    }

    /// Gives `values` what [`flatten`](Self::flatten) laid out.
    fn unflatten(&mut self, values: &[Value], flat: &[Value]) {
        let mut flat = flat.iter().copied();
        let mut next = || flat.next().expect("the layout is that of flatten");
        for &value in values {
            let primal = next();
            let any = match self.function.values[value] {
                Type::Mask => Any::Mask(primal),
                Type::Bits => Any::Bits(primal),
                Type::Real if self.moves[value.index()] => {
                    // Components are finite, and so are accumulators made of them.
                    let slope = [0; 3].map(|_| Some(self.tangent.note(next())));
                    Any::Real(self.tangent.moving(primal, slope))
                }
                Type::Real => Any::Real(Tangent::still(primal)),
            };
            self.values[value.index()] = Some(any);
        }
    }
}
