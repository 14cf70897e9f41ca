//! From a lowered function to one that engines accept: the passes that a purpose asks for, and straight code.

use jbt_ir::pass::{GUARDED_GRADIENT, INTERVAL, PIPELINE, Pass, ROW_INTERVAL, run_pipeline};
use jbt_ir::{Function, Straight, Tables, Verified, limits, verify};
use jbt_model::diagnostic::Diagnostic;
use jbt_model::query::Query;

use crate::error::CompileError;

/// What a kernel is for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Purpose {
    /// To answer a query at points.
    Answers(Query),
    /// To answer again at those points where the gradient of the usual program is not finite.
    FiniteGradient,
    /// To enclose the field in boxes.
    Ranges,
    /// To enclose the fields of rows in boxes, a row a lane.
    RowRanges,
}

impl Purpose {
    /// The passes that go before the others, and change what is computed.
    fn first_passes(self) -> Vec<&'static Pass> {
        match self {
            Self::Answers(query) => query.passes().collect(),
            Self::FiniteGradient => vec![&GUARDED_GRADIENT],
            Self::Ranges => vec![&INTERVAL],
            Self::RowRanges => vec![&ROW_INTERVAL],
        }
    }
}

/// The passes that a function goes through.
pub fn passes(purpose: Purpose) -> impl Iterator<Item = &'static Pass> {
    purpose.first_passes().into_iter().chain(PIPELINE)
}

/// Runs the passes and verifies. The observer sees what every pass made.
///
/// # Errors
/// A function that a pass makes larger than [`limits::MAX_VALUES`]; broken rules, which are a defect of the
/// compiler.
pub fn optimise(
    function: Function,
    purpose: Purpose,
    observer: &mut dyn FnMut(&str, &Function),
) -> Result<Verified, CompileError> {
    finish(run(function, passes(purpose), observer)?)
}

/// The function as long as it gets: after the passes that make it longer.
///
/// # Errors
/// Those of [`optimise`].
pub fn grown(function: Function, purpose: Purpose) -> Result<Function, CompileError> {
    let longer = passes(purpose).take(purpose.first_passes().len() + 1);
    run(function, longer, &mut |_, _| {})
}

/// Straight code for a lowered function and its tables, if it is worth it. The purpose's first passes run
/// before, so that the bits are those of the program by rows. With `before`, numbers that differed there keep
/// columns of their own, so that an edit back and forth fits.
///
/// # Errors
/// Those of [`optimise`].
pub fn straighten(
    function: &Function,
    tables: &Tables,
    purpose: Purpose,
    before: Option<&Straight>,
) -> Result<Option<Straight>, CompileError> {
    let made;
    let first = purpose.first_passes();
    let function = if first.is_empty() {
        function
    } else {
        // Asked once before these passes too: that rules out most functions, and saves the passes.
        if before.is_none() && Straight::new(function, tables).is_none() {
            return Ok(None);
        }
        made = run(function.copied(), first, &mut |_, _| {})?;
        &made
    };
    Ok(match before {
        Some(before) => before.again(function, tables),
        None => Straight::new(function, tables),
    })
}

/// Runs the passes that straight code has still to go through, and verifies.
///
/// # Errors
/// Those of [`optimise`].
pub fn optimise_straight(
    straight: &Straight,
    observer: &mut dyn FnMut(&str, &Function),
) -> Result<Verified, CompileError> {
    finish(run(straight.function().copied(), PIPELINE, observer)?)
}

fn run<'a>(
    mut function: Function,
    passes: impl IntoIterator<Item = &'a Pass>,
    observer: &mut dyn FnMut(&str, &Function),
) -> Result<Function, CompileError> {
    for pass in passes {
        function = run_pipeline(function, [pass], observer);
        if function.values.len() > limits::MAX_VALUES {
            let most = limits::MAX_VALUES;
            let message =
                format!("after the pass {}, the model's program has more than {most} values", pass.name);
            return Err(CompileError::Model(vec![Diagnostic::limit(None, message)].into()));
        }
    }
    Ok(function)
}

fn finish(function: Function) -> Result<Verified, CompileError> {
    verify(function).map_err(CompileError::Internal)
}
