//! What all commands take that write a file: how to do the work, and how to tell of it.

use std::path::Path;

use clap::Args;
use jbt::Compiler;

use super::EngineArguments;
use crate::failure::Failure;
use crate::output::Told;
use crate::standard::is_standard;
use crate::threads::Threads;

/// How a command that writes a file does its work, and what it tells.
#[derive(Args, Debug)]
pub struct WorkArguments {
    /// What computes.
    #[command(flatten)]
    pub engine: EngineArguments,
    /// Number of threads; what is written does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Print one JSON object instead of a summary
    #[arg(long)]
    pub json: bool,
}

impl WorkArguments {
    /// A compiler for the engine and the level.
    pub fn compiler(&self) -> Result<Compiler, Failure> {
        self.engine.compiler()
    }

    /// Refuses to write the report to the standard output where `what` the command makes goes there, too.
    pub fn check_output(&self, output: &Path, what: &str) -> Result<(), Failure> {
        if is_standard(output) && self.json {
            let message = format!("the {what} and the JSON report cannot both go to the standard output");
            return Err(Failure::Usage(message));
        }
        Ok(())
    }

    /// Does it on so many threads.
    pub fn run<T: Send>(&self, work: &mut (impl FnMut() -> T + Send)) -> T {
        Threads::new(self.threads).run(work)
    }

    /// How to tell what has been done.
    pub fn told(&self, quiet: bool) -> Told {
        if self.json { Told::Json } else { Told::Text { quiet } }
    }
}
