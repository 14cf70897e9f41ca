//! A program, and the door to it: tables are checked when they are bound, planes and selections at each run.

use std::fmt;
use std::sync::Arc;

use crate::function::Function;
use crate::selection::Selection;
use crate::table::{TableError, Tables};

use super::planes::{RunError, check};

/// What a program is given and gives: the planes and tables of its function.
#[derive(Clone, Debug)]
pub struct Interface {
    /// The function without its instructions.
    outside: Function,
}

impl Interface {
    /// That of a function.
    #[must_use]
    pub fn new(function: &Function) -> Self {
        let mut outside = Function::new(&function.name, &[]);
        outside.inputs.clone_from(&function.inputs);
        outside.outputs.clone_from(&function.outputs);
        outside.tables.clone_from(&function.tables);
        Self { outside }
    }

    /// The function's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.outside.name
    }

    /// Number of input planes, and of output planes.
    #[must_use]
    pub fn planes(&self) -> (usize, usize) {
        (self.outside.inputs.len(), self.outside.outputs.len())
    }
}

/// A function that an engine has compiled. It never changes, so threads may share it.
pub trait Program: fmt::Debug + Send + Sync {
    /// What [`BoundProgram`] checks: always the same one, which no other program has.
    fn interface(&self) -> &Arc<Interface>;

    /// Points that run together, at least 1: of what is no multiple of it, some lanes are computed in vain.
    fn block(&self) -> usize;

    /// Answers for all points of a run that was checked against the [`interface`](Self::interface), point by
    /// point with the bits of the scalar domain. The floating-point environment of the caller does not
    /// matter, and is what it was when this returns.
    fn run(&self, run: Run<'_, '_>);
}

/// One run, which [`BoundProgram::run_selected`] has checked. Nobody else makes one.
pub struct Run<'a, 'o> {
    interface: &'a Arc<Interface>,
    planes: Planes<'a, 'o>,
}

impl fmt::Debug for Run<'_, '_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Run").field("points", &self.planes.points).finish_non_exhaustive()
    }
}

/// What a run reads and writes.
#[derive(Debug)]
pub struct Planes<'a, 'o> {
    /// The length of every plane.
    pub points: usize,
    /// Tables that fit the function.
    pub tables: &'a Tables,
    /// Which of their rows run.
    pub selection: &'a Selection,
    /// `inputs[plane][point]`, as many planes as the function has.
    pub inputs: &'a [&'a [f32]],
    /// `outputs[plane][point]`, as many planes as the function has.
    pub outputs: &'a mut [&'o mut [f32]],
}

impl<'a, 'o> Run<'a, 'o> {
    /// What was checked. Panics if it was checked against another interface than this one: a program may
    /// follow indices and lengths blindly.
    #[must_use]
    pub fn planes(self, interface: &Arc<Interface>) -> Planes<'a, 'o> {
        assert!(Arc::ptr_eq(self.interface, interface), "a run is checked for the program that runs it");
        self.planes
    }
}

/// A program with tables that fit it: the thing that runs. Cloning gives another handle.
#[derive(Clone)]
pub struct BoundProgram {
    program: Arc<dyn Program>,
    /// That of the program, which its tables were checked against.
    interface: Arc<Interface>,
    tables: Arc<Tables>,
    /// All rows that are active.
    all: Arc<Selection>,
}

impl fmt::Debug for BoundProgram {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BoundProgram").field("program", &self.program).finish_non_exhaustive()
    }
}

impl BoundProgram {
    /// Gives a program the rows that it will run over. It looks at every active row, so do it once for many
    /// runs.
    ///
    /// # Errors
    /// The tables do not fit the function ([`Tables::check`]).
    pub fn new(program: Arc<dyn Program>, tables: Arc<Tables>) -> Result<Self, TableError> {
        let interface = Arc::clone(program.interface());
        let all = Arc::new(Selection::checked(&interface.outside, &tables)?);
        Ok(Self { program, interface, tables, all })
    }

    /// The program.
    #[must_use]
    pub fn program(&self) -> &Arc<dyn Program> {
        &self.program
    }

    /// The rows.
    #[must_use]
    pub fn tables(&self) -> &Arc<Tables> {
        &self.tables
    }

    /// All rows that are active.
    #[must_use]
    pub fn all(&self) -> &Arc<Selection> {
        &self.all
    }

    /// Answers for all points with all rows: `inputs[plane][point]` to `outputs[plane][point]`. All planes
    /// have one length, any length; any number is fine as an input.
    ///
    /// # Errors
    /// The planes are not as many as the function's, or differ in length.
    pub fn run(&self, inputs: &[&[f32]], outputs: &mut [&mut [f32]]) -> Result<(), RunError> {
        self.run_selected(&self.all, inputs, outputs)
    }

    /// As [`run`](Self::run), with the rows of a selection.
    ///
    /// # Errors
    /// Those of [`run`](Self::run), and a selection that was made for other numbers of rows.
    pub fn run_selected(
        &self,
        selection: &Selection,
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
    ) -> Result<(), RunError> {
        if !selection.fits(self.all.extent()) {
            return Err(RunError::Selection);
        }
        let points = check(self.interface.planes(), inputs, outputs)?;
        let planes = Planes { points, tables: &self.tables, selection, inputs, outputs };
        self.program.run(Run { interface: &self.interface, planes });
        Ok(())
    }
}
