//! Programs of other systems, every instruction at every point: machine code and interpreters, ours and
//! fidget's.

use fidget::eval::MathFunction;
use fidget::render::RenderHints;
use jbt::import;
use jbt::walk::walk;
use jbt::{CheckedTree, Compiler, Engine, Points, Query};
use jbt_testkit::samples;
use serde_json::json;

use super::contest::{Contest, Contestant, Standings};
use super::options::Options;
use super::report::ResultRow;
use crate::model;
use crate::peers::fidget::{FidgetProgram, JitFunction, VmFunction};

/// The programs, in the folder of samples.
const PROGRAMS: [&str; 4] = ["prospero", "colonnade", "bear", "hi"];
const POINTS: usize = 1 << 14;
/// One point in so many is compared with the oracle.
const LOOKS: usize = 64;
/// By how much an answer in f32 may be off, where the oracle's is below 1.
const TOLERANCE: f64 = 1e-3;

/// A program, and points in the cube [-1, 1]^3.
struct ImportedProgram {
    name: &'static str,
    bytes: Vec<u8>,
    tree: CheckedTree,
    points: Points,
    /// Fields of some points.
    known: Vec<(usize, f64)>,
}

impl ImportedProgram {
    fn new(name: &'static str) -> Result<Self, String> {
        let bytes = samples::file(&format!("vm/{name}.vm"))?;
        let imported = import::vm(&bytes).map_err(|_| format!("{name} has errors"))?;
        let tree = imported.model.check().map_err(|_| format!("the model of {name} has errors"))?;
        let points = model::cube(POINTS, 3);
        let field = |index: usize| (index, walk(&tree, points.get(index).map(f64::from)).field);
        let known = (0..points.len()).step_by(LOOKS).map(field).collect();
        Ok(Self { name, bytes, tree, points, known })
    }

    /// Compares some fields with the oracle.
    fn check(&self, field: impl Fn(usize) -> f64) -> Result<(), String> {
        for &(index, known) in &self.known {
            let given = field(index);
            if (given - known).abs() > TOLERANCE * known.abs().max(1.0) {
                return Err(format!("the field of point {index} is {given}, and not {known}"));
            }
        }
        Ok(())
    }

    fn ours<'a>(&'a self, contest: &mut Contest<'a>, contestant: Contestant, compiler: &Compiler) {
        let evaluator = compiler.evaluator(&self.tree, Query::FIELD).expect("the program compiles");
        let mut samples = evaluator.samples();
        evaluator.eval(&self.points, &mut samples).expect("the buffers fit");
        let checked = self.check(|index| f64::from(samples.field()[index]));
        contest.enter(contestant, "", checked, move || {
            evaluator.eval(&self.points, &mut samples).expect("the buffers fit");
        });
    }

    fn fidget<'a, F: MathFunction + RenderHints + 'a>(
        &'a self,
        contest: &mut Contest<'a>,
        contestant: Contestant,
    ) {
        let mut tape = FidgetProgram::<F>::new(&self.bytes).expect("fidget reads the program").tape();
        let mut values = vec![f32::NAN; POINTS];
        tape.eval(self.points.planes(), &mut values);
        // The field of an imported program is 1/2 less the value.
        let checked = self.check(|index| 0.5 - f64::from(values[index]));
        contest.enter(contestant, "", checked, move || tape.eval(self.points.planes(), &mut values));
    }

    fn row(&self, options: Options) -> ResultRow {
        let mut contest = Contest::new();
        self.ours(&mut contest, Contestant::Ours, &Compiler::new());
        self.ours(&mut contest, Contestant::Lanes, &Compiler::for_engine(Engine::Lanes));
        self.fidget::<JitFunction>(&mut contest, Contestant::FidgetJit);
        self.fidget::<VmFunction>(&mut contest, Contestant::FidgetVm);
        ResultRow {
            case: "programs",
            of: "",
            primitives: self.bytes.iter().filter(|&&byte| byte == b'\n').count(),
            points: POINTS,
            unit: "point",
            units: POINTS as f64,
            standings: contest.run(options.effort()),
            extra: vec![("program", json!(self.name))],
        }
    }
}

/// The field of each program, without leaving anything out.
pub(super) fn programs(options: Options) -> Vec<ResultRow> {
    let row = |name| match ImportedProgram::new(name) {
        Ok(program) => program.row(options),
        Err(reason) => ResultRow {
            case: "programs",
            of: "",
            primitives: 0,
            points: 0,
            unit: "point",
            units: 1.0,
            standings: Standings { standings: Vec::new(), disagreements: vec![reason] },
            extra: vec![("program", json!(name))],
        },
    };
    PROGRAMS.into_iter().map(row).collect()
}
