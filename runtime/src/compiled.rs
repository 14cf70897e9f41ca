//! One compiled model: its programs, each of which is made when somebody first asks for it, and once.
//!
//! ```text
//!                                        ┌─ answers to a query, at points anywhere ─► Evaluator
//!   CheckedTree ──Compiler──► Compiled ──┼─ answers to a query, in regions ─────────► meshes, rays, slices, samples
//!                                        └─ ranges of the field in boxes ───────────► Pruner
//! ```
//!
//! Whatever looks at a model borrows programs from here and counts its own work: two tracers of one model run
//! the same code on the same numbers, and each says what its own rays took.

mod patch;
mod preparation;
mod task;

use std::sync::{Arc, OnceLock};

use jbt_ir::{Selection, pass, watch};
use jbt_lower::{Lowered, Lowering};
use jbt_model::check::CheckedTree;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::origin::ModelOrigin;
use jbt_model::query::Query;

use crate::compiler::Compiler;
use crate::debug::brief_debug;
use crate::error::{CompileError, EvalError};
use crate::kernel::{BoundKernel, Engine, Kernel, Purpose};
use crate::parallel::PoolWorkers;
use crate::program::{AnswerProgram, ModelProgram};
use crate::prune::program::RangeProgram;
use crate::span::span;

use patch::PresentPrograms;
pub(crate) use preparation::Preparation;
pub use task::Task;
pub(crate) use task::mesh_needs;

/// A compiled model: programs for whatever is asked of it.
///
/// It is `Send + Sync`, and a clone is another handle to the same programs. A program is compiled when it is
/// first asked for, and then kept: a mesh, a slice and a picture of one compiled model share what they have
/// in common, and nothing is compiled that nobody needs.
///
/// ```
/// use jbt::contour::{Plane, Slicer};
/// use jbt::{Compiler, Polygonize, Query, Tracer};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let tree = jbt::Model::new(jbt::build::point([0, 0, 0], 1)).check()?;
/// let compiler = Compiler::new();
/// let compiled = compiler.compile(&tree); // nothing yet
/// let made = Polygonize::default().with(&compiled).run()?; // four programs
/// let tracer = Tracer::of(&compiled, Query::ALL)?; // none
/// let slicer = Slicer::of(&compiled, &Plane::default(), Query::FIELD)?; // none
/// assert_eq!(compiler.counters().kernels, 4);
///
/// let moved = jbt::Model::new(jbt::build::point([0, 1, 0], 2)).check()?;
/// let made = Polygonize::default().with(&compiled.updated(&moved)).run()?; // only numbers
/// assert_eq!(compiler.counters().kernels, 4);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Compiled(Arc<CompiledParts>);

struct CompiledParts {
    compiler: Compiler,
    tree: CheckedTree,
    /// By [`Query::index`].
    anywhere: [ProgramSlot<AnswerProgram>; QUERIES],
    /// By [`Query::index`].
    in_regions: [ProgramSlot<AnswerProgram>; QUERIES],
    ranges: ProgramSlot<RangeProgram>,
    decisions: ProgramSlot<DecisionProgram>,
}

/// A program that tells which operands decide about the field: field, gradient and signature.
struct DecisionProgram(BoundKernel);

impl ModelProgram for DecisionProgram {
    fn kernel(&self) -> &Arc<Kernel> {
        &self.0.kernel
    }
}

/// What tells which operands decide about a model's field, in regions.
#[derive(Clone)]
pub(crate) struct Decisions(Arc<DecisionProgram>);

impl Decisions {
    /// Field, the three components of the gradient, and the signature at points of a region that has these
    /// rows.
    pub(crate) fn eval_region(
        &self,
        selection: &Selection,
        points: [&[f32]; 3],
        answers: &mut [&mut [f32]],
    ) -> Result<(), EvalError> {
        self.0.0.run_with_finite_gradient(selection, &points, answers).map(drop)
    }
}

brief_debug!(Compiled, "Compiled", this: compiler = this.compiler());

const QUERIES: usize = Query::EVERY.len();

/// Where the points are that a program answers at.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum PointScope {
    /// Anywhere: straight code where it is quicker.
    Anywhere,
    /// In regions, with the rows that matter there.
    Regions,
}

/// A program that somebody needs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Need {
    /// Answers to a query at points.
    Answers(PointScope, Query),
    /// Ranges of the field in boxes.
    Ranges,
    /// Gradients in regions, and what tells which operands decide, which is made of their program.
    Decisions,
}

impl Need {
    /// What the program answers; `None`: ranges.
    fn query(self) -> Option<Query> {
        match self {
            Self::Answers(_, query) => Some(query),
            Self::Decisions => Some(Query::GRADIENT),
            Self::Ranges => None,
        }
    }
}

/// The place of a program.
struct ProgramSlot<T> {
    made: OnceLock<Result<Arc<T>, CompileError>>,
    /// The kernel that an earlier model had here.
    earlier: Option<Arc<Kernel>>,
}

impl<T> Default for ProgramSlot<T> {
    fn default() -> Self {
        Self { made: OnceLock::new(), earlier: None }
    }
}

impl<T: ModelProgram> ProgramSlot<T> {
    /// The program. Whoever is first makes it of what was lowered; the others wait.
    ///
    /// Lowering gives work to the pool, and a thread that waits for the pool may take a task that asks for
    /// this very program. So whoever finds no program lowers the model first, and waits for nobody while it
    /// makes the program.
    fn get_or_make<L>(
        &self,
        lower: impl FnOnce() -> L,
        make: impl FnOnce(L, Option<&Arc<Kernel>>) -> Result<Arc<T>, CompileError>,
    ) -> Result<&Arc<T>, CompileError> {
        let made = match self.made.get() {
            Some(made) => made,
            None => {
                let lowered = lower();
                self.made.get_or_init(|| make(lowered, self.earlier.as_ref()))
            }
        };
        made.as_ref().map_err(Clone::clone)
    }

    /// The program, if it has been made and could be.
    fn present(&self) -> Option<&Arc<T>> {
        self.made.get()?.as_ref().ok()
    }

    /// Puts a program here, where none has been asked for.
    fn give(&self, program: Arc<T>) {
        // Nobody else has the place yet.
        let _ = self.made.set(Ok(program));
    }

    /// The place of the same program of another model.
    fn renewed(&self) -> Self {
        let present = self.present().map(|program| program.kernel());
        Self { made: OnceLock::new(), earlier: present.or(self.earlier.as_ref()).cloned() }
    }
}

impl CompiledParts {
    /// Gives an edited model its programs, if it is known what has changed, and if this takes less than to
    /// lower it. Otherwise they are made when they are asked for.
    fn hand_on(&self, edited: &Self) {
        let Some(changed) = edited.tree.changed_since(&self.tree) else { return };
        let answers: Vec<&Arc<AnswerProgram>> =
            self.in_regions.iter().filter_map(ProgramSlot::present).collect();
        if changed.is_empty() {
            // Nothing but parameters that nothing depends on.
            if let Some(ranges) = self.ranges.present() {
                edited.ranges.give(Arc::clone(ranges));
            }
            answers.into_iter().for_each(|program| self.give(edited, Arc::clone(program)));
            return;
        }
        let present = PresentPrograms { tree: &self.tree, ranges: self.ranges.present(), answers };
        if let Some(patched) = patch::patch(&present, (&edited.compiler, &edited.tree), changed) {
            edited.ranges.give(Arc::new(patched.ranges));
            patched.answers.into_iter().for_each(|program| self.give(edited, Arc::new(program)));
        }
    }

    /// Gives an edited model its program for regions. Points anywhere have the same one, if they have no
    /// straight code.
    fn give(&self, edited: &Self, program: Arc<AnswerProgram>) {
        let query = program.query.index();
        let [anywhere, regions] = [&self.anywhere, &self.in_regions].map(|slots| slots[query].present());
        if anywhere.zip(regions).is_some_and(|(anywhere, regions)| Arc::ptr_eq(anywhere, regions)) {
            edited.anywhere[query].give(Arc::clone(&program));
        }
        edited.in_regions[query].give(program);
    }
}

impl Compiler {
    /// A compiled model. Nothing is compiled before something is asked of it.
    #[must_use]
    pub fn compile(&self, tree: &CheckedTree) -> Compiled {
        Compiled(Arc::new(CompiledParts {
            compiler: self.clone(),
            tree: tree.clone(),
            anywhere: Default::default(),
            in_regions: Default::default(),
            ranges: ProgramSlot::default(),
            decisions: ProgramSlot::default(),
        }))
    }
}

impl Compiled {
    /// Another model, usually an edited one. It is lowered when something is asked of it. A program whose
    /// function is equal takes the new numbers; only others are compiled. The [origin](Self::origin) stays,
    /// wherever the other model is.
    ///
    /// If the check knows which nodes of the present model were edited ([`CheckedTree::changed_since`]), and
    /// these are few, the programs that are there get the rows of these nodes anew, and nothing is lowered
    /// but them.
    #[must_use]
    pub fn updated(&self, tree: &CheckedTree) -> Self {
        let parts = CompiledParts {
            compiler: self.0.compiler.clone(),
            tree: tree.with_origin(self.origin()),
            anywhere: self.0.anywhere.each_ref().map(ProgramSlot::renewed),
            in_regions: self.0.in_regions.each_ref().map(ProgramSlot::renewed),
            ranges: self.0.ranges.renewed(),
            decisions: self.0.decisions.renewed(),
        };
        self.0.hand_on(&parts);
        Self(Arc::new(parts))
    }

    /// The model.
    #[must_use]
    pub fn tree(&self) -> &CheckedTree {
        &self.0.tree
    }

    /// Puts programs here that were made in another way, where none has been asked for.
    pub(crate) fn fill(&self, ranges: RangeProgram, answers: Vec<AnswerProgram>) {
        self.0.ranges.give(Arc::new(ranges));
        for program in answers {
            self.0.in_regions[program.query.index()].give(Arc::new(program));
        }
    }

    /// What compiles it.
    #[must_use]
    pub fn compiler(&self) -> &Compiler {
        &self.0.compiler
    }

    /// Where the coordinates of its programs count from: that of the model for which it was made.
    #[must_use]
    pub fn origin(&self) -> ModelOrigin {
        self.0.tree.origin()
    }

    /// The program that answers a query.
    pub(crate) fn answers(
        &self,
        scope: PointScope,
        query: Query,
    ) -> Result<&Arc<AnswerProgram>, CompileError> {
        watch::stoppable(|| self.answers_of(scope, query, None))?
    }

    /// What tells which operands decide about the field; `None` if nothing in the model may bend its surface
    /// sharply. It has the rows and the numbers of the gradient's program for regions: the field's has terms
    /// left out that only the gradient needs.
    pub(crate) fn decisions(&self) -> Result<Option<Decisions>, CompileError> {
        watch::stoppable(|| self.decisions_of(None))?
    }

    fn decisions_of<'t>(
        &'t self,
        lowering: Option<&Lowering<'t>>,
    ) -> Result<Option<Decisions>, CompileError> {
        let slopes = self.answers_of(PointScope::Regions, Query::GRADIENT, lowering)?;
        pass::take_for_pass(&slopes.bound.kernel.lowered);
        let Some(function) = pass::decisions(&slopes.bound.kernel.lowered) else { return Ok(None) };
        let make = |(), earlier: Option<&Arc<Kernel>>| {
            let (compiler, purpose) = (&self.0.compiler, Purpose::Answers(Query::GRADIENT));
            let kernel = compiler.kernel(function.copied(), purpose, earlier).or_else(|_| {
                // It is several times as long as the field's, which the engine has taken.
                compiler.clone().on_engine(Engine::Lanes).kernel(function, purpose, None)
            })?;
            Ok(Arc::new(DecisionProgram(compiler.bind(&kernel, Arc::clone(&slopes.bound.lowered)))))
        };
        let program = self.0.decisions.get_or_make(|| (), make)?;
        Ok(Some(Decisions(Arc::clone(program))))
    }

    /// The program of ranges, and what is known about rows.
    pub(crate) fn ranges(&self) -> Result<&Arc<RangeProgram>, CompileError> {
        watch::stoppable(|| self.ranges_of(None))?
    }

    /// The program for regions that belongs to one of straight code, which cannot leave rows out. If the
    /// wished engine declines it, the interpreter runs it.
    pub(crate) fn regional_twin<'a>(&self, straight: &'a AnswerProgram) -> &'a Arc<AnswerProgram> {
        straight.for_regions.get_or_init(|| {
            let wished = self.answers_of(PointScope::Regions, straight.query, None).cloned();
            wished.unwrap_or_else(|_| {
                // A program that is small as straight code is within all limits.
                let lanes = self.0.compiler.clone().on_engine(Engine::Lanes);
                self.unstraightened(&lanes, straight, None)
                    .expect("whatever is within the limits is interpreted")
            })
        })
    }

    fn is_made(&self, need: Need) -> bool {
        match need {
            Need::Answers(scope, query) => self.slot(scope, query).made.get().is_some(),
            Need::Ranges => self.0.ranges.made.get().is_some(),
            // What is made of a program takes no lowering.
            Need::Decisions => self.slot(PointScope::Regions, Query::GRADIENT).made.get().is_some(),
        }
    }

    fn make<'t>(&'t self, need: Need, lowering: Option<&Lowering<'t>>) -> Result<(), CompileError> {
        match need {
            Need::Answers(scope, query) => self.answers_of(scope, query, lowering).map(drop),
            Need::Ranges => self.ranges_of(lowering).map(drop),
            Need::Decisions => self.decisions_of(lowering).map(drop),
        }
    }

    fn slot(&self, scope: PointScope, query: Query) -> &ProgramSlot<AnswerProgram> {
        match scope {
            PointScope::Anywhere => &self.0.anywhere[query.index()],
            PointScope::Regions => &self.0.in_regions[query.index()],
        }
    }

    fn answers_of<'t>(
        &'t self,
        scope: PointScope,
        query: Query,
        lowering: Option<&Lowering<'t>>,
    ) -> Result<&'t Arc<AnswerProgram>, CompileError> {
        let slot = self.slot(scope, query);
        let lowered = || self.lowered(lowering, |lowering| lowering.answers(query));
        match scope {
            PointScope::Anywhere if self.0.compiler.may_straighten(self.tree()) => {
                slot.get_or_make(lowered, |lowered, earlier| self.anywhere(query, lowered?, earlier))
            }
            PointScope::Anywhere => {
                let regional = || self.answers_of(PointScope::Regions, query, lowering).cloned();
                slot.get_or_make(regional, |program, _| program)
            }
            PointScope::Regions => {
                let straight = self.slot(PointScope::Anywhere, query).present();
                match straight.filter(|program| program.is_straight()) {
                    Some(straight) => slot.get_or_make(
                        || straight,
                        |straight, earlier| self.unstraightened(&self.0.compiler, straight, earlier),
                    ),
                    None => {
                        slot.get_or_make(lowered, |lowered, earlier| self.program(query, lowered?, earlier))
                    }
                }
            }
        }
    }

    /// Straight code for a lowered model, if it is worth it; else the program for regions.
    fn anywhere(
        &self,
        query: Query,
        lowered: Lowered,
        earlier: Option<&Arc<Kernel>>,
    ) -> Result<Arc<AnswerProgram>, CompileError> {
        let (compiler, purpose) = (&self.0.compiler, Purpose::Answers(query));
        match compiler.straight(&lowered.function, &lowered.tables, purpose, earlier) {
            Some(kernel) => {
                let bound = compiler.bind(&kernel, lowered.tables);
                Ok(Arc::new(AnswerProgram::new(self.tree(), query, bound)))
            }
            None => {
                let slot = self.slot(PointScope::Regions, query);
                slot.get_or_make(|| lowered, |lowered, earlier| self.program(query, lowered, earlier))
                    .cloned()
            }
        }
    }

    /// A program for regions.
    fn program(
        &self,
        query: Query,
        Lowered { function, tables }: Lowered,
        earlier: Option<&Arc<Kernel>>,
    ) -> Result<Arc<AnswerProgram>, CompileError> {
        let compiler = &self.0.compiler;
        let kernel = compiler.kernel(function, Purpose::Answers(query), earlier);
        let kernel = kernel.map_err(|error| self.placed(error))?;
        Ok(Arc::new(AnswerProgram::new(self.tree(), query, compiler.bind(&kernel, tables))))
    }

    /// The program for regions, of what straight code was made of.
    fn unstraightened(
        &self,
        compiler: &Compiler,
        straight: &AnswerProgram,
        earlier: Option<&Arc<Kernel>>,
    ) -> Result<Arc<AnswerProgram>, CompileError> {
        let AnswerProgram { query, bound, .. } = straight;
        let kernel = compiler.kernel(bound.kernel.lowered.copied(), Purpose::Answers(*query), earlier);
        let kernel = kernel.map_err(|error| self.placed(error))?;
        let bound = compiler.bind(&kernel, Arc::clone(&bound.lowered));
        Ok(Arc::new(AnswerProgram::new(self.tree(), *query, bound)))
    }

    fn ranges_of<'t>(
        &'t self,
        lowering: Option<&Lowering<'t>>,
    ) -> Result<&'t Arc<RangeProgram>, CompileError> {
        let lowered = || self.lowered(lowering, Lowering::ranges);
        self.0.ranges.get_or_make(lowered, |ranges, earlier| {
            let program = RangeProgram::new(&self.0.compiler, ranges?, earlier);
            program.map(Arc::new).map_err(|error| self.placed(error))
        })
    }

    /// What a lowering of the model gives: the one that is there, or a new one.
    fn lowered<'t, T>(
        &'t self,
        lowering: Option<&Lowering<'t>>,
        ask: impl FnOnce(&Lowering<'t>) -> Result<T, Vec<Diagnostic>>,
    ) -> Result<T, CompileError> {
        span!("lower");
        let answer = match lowering {
            Some(lowering) => ask(lowering),
            None => ask(&Lowering::with(self.tree(), &PoolWorkers)),
        };
        answer.map_err(|list| self.tree().diagnostics(list).into())
    }
}
