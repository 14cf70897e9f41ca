//! The passes, from a lowered function to one that an engine runs: one list, [`PIPELINE`].
//!
//! A pass takes a function that obeys the verifier's rules and gives another one that computes the same bits
//! (any NaN equals any NaN). Between any two passes the observer of [`run_pipeline`] can print the function,
//! verify it, or run it.
//!
//! ```text
//! lowered ─► (gradient) ─► (interval) ─► legalize ─► constant-folding ─► simplify ─► cse ─► dce ─► schedule ─► verify ─► engine
//! ```
//!
//! `decisions`, `gradient`, `guarded-gradient` and `interval` change what is computed. So they are not in
//! the list: the caller puts one of them in front, by what the program is for: `run_pipeline(f,
//! [&GRADIENT].into_iter().chain(PIPELINE), ..)`. They need the transcendentals whole, hence before
//! `legalize`. Straight code is made behind them.
//!
//! `idle` and `liveness` are no passes: they look at a function, for engines.

mod dce;
mod decisions;
mod fold_constants;
mod gradient;
mod idle;
mod interval;
mod legalize;
mod liveness;
mod schedule;
mod simplify;

pub use dce::dce;
pub use decisions::{SIGNATURE_OUTPUT, decisions};
pub use fold_constants::fold_constants;
pub use gradient::{GRADIENT_OUTPUTS, gradient, guarded_gradient};
pub use idle::{Gate, Gates, gates};
pub use interval::{BOUND_SUFFIXES, interval, row_interval};
pub use legalize::legalize;
pub use liveness::max_live;
pub use schedule::schedule;
pub use simplify::simplify;

use crate::builder::FunctionBuilder;
use crate::function::Function;
use crate::limits::MAX_VALUES;
use crate::translate::rewrite;
use crate::watch;

/// A step from a function to another one.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Its name, as `--stage` takes it.
    pub name: &'static str,
    /// What it does, in one sentence.
    pub what: &'static str,
    /// Does it.
    pub run: fn(Function) -> Function,
}

/// Runs before the others where the gradient is asked for.
pub const GRADIENT: Pass = Pass {
    name: "gradient",
    what: "Adds the gradient of the first output, by forward differentiation.",
    run: |function| gradient(&function),
};

/// Replaces [`GRADIENT`] for points where [`GRADIENT`] gives a component that is not finite.
pub const GUARDED_GRADIENT: Pass = Pass {
    name: "guarded-gradient",
    what: "Adds the gradient of the first output, finite whatever overflows on the way.",
    run: |function| guarded_gradient(&function),
};

/// Runs before the others, after the gradient, where ranges are asked for.
pub const INTERVAL: Pass = Pass {
    name: "interval",
    what: "Replaces every input and output by a low and a high bound, by interval arithmetic.",
    run: |function| interval(&function),
};

/// As [`INTERVAL`], for the function of one row ([`crate::alone`]).
pub const ROW_INTERVAL: Pass = Pass {
    name: "row-interval",
    what: "Replaces the point and every output by a low and a high bound; numbers of the row stay numbers.",
    run: |function| row_interval(&function),
};

/// Every pass that each function goes through, in order.
pub const PIPELINE: &[Pass] = &[
    Pass {
        name: "legalize",
        what: "Expands transcendentals into the ops that machines have, writes slopes out, drops `stop_gradient`.",
        run: |function| legalize(&function),
    },
    Pass {
        name: "constant-folding",
        what: "Computes ops on constants, and decides selections whose mask is known.",
        run: |function| fold_constants(&function),
    },
    Pass {
        name: "simplify",
        what: "Replaces ops by cheaper ones that give the same bits for every operand.",
        run: |function| simplify(&function),
    },
    Pass {
        name: "cse",
        what: "Shares equal instructions and moves what does not depend on the row out of the folds.",
        run: |function| share(&function),
    },
    Pass {
        name: "dce",
        what: "Removes instructions, accumulators and folds that no output needs.",
        run: dce,
    },
    Pass {
        name: "schedule",
        what: "Orders the instructions of each block so that few values are alive at once.",
        run: schedule,
    },
];

/// What a pass takes for a value of a function, with the function that it makes, unless that is longer: 100
/// to 170 bytes were seen.
const PASS_BYTES: usize = 200;

/// Before a pass over a function: stops the work here if there is no memory for it. See [`watch::take`]. What
/// a longer function takes besides is asked for by its builder.
pub fn take_for_pass(function: &Function) {
    watch::take(function.values.len() * PASS_BYTES);
}

/// Runs the passes in order. The observer sees each pass's name and what the pass made. The passes behind one
/// that makes more than [`MAX_VALUES`] values do not run: what it made is no function any more, and the
/// verifier refuses it.
#[must_use]
pub fn run_pipeline<'a>(
    mut function: Function,
    passes: impl IntoIterator<Item = &'a Pass>,
    observer: &mut dyn FnMut(&str, &Function),
) -> Function {
    for pass in passes {
        take_for_pass(&function);
        function = (pass.run)(function);
        // The function before is gone, which takes a while.
        watch::look_now();
        observer(pass.name, &function);
        if function.values.len() > MAX_VALUES {
            break;
        }
    }
    function
}

/// Shares equal instructions and hoists: a plain rewrite, because the builder does both.
///
/// Every pass that rewrites does it too. This pass is in the list because simplification makes operands equal
/// after instructions before them were written.
#[must_use]
pub fn share(function: &Function) -> Function {
    rewrite(function, FunctionBuilder::op)
}
