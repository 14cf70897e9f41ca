//! The `jbt` command: scenes to meshes, pictures and values.
//!
//! | file | what it does |
//! |---|---|
//! | [`arguments`] | what can be asked |
//! | [`scene`], [`points`] | reading |
//! | [`mesh`], [`render`], [`contour`], [`sample`], [`eval`], [`convert`], [`show`], [`count`], [`stats`], [`check`], [`manual`] | one command each |
//! | [`formats`] | the kinds of files that each command writes |
//! | [`output`], [`progress`], [`logger`] | what comes out, and where |
//! | [`signals`], [`threads`], [`memory`] | what stops the work, what does it, and where |
//! | [`timeline`] | which thread did what when |
//! | [`failure`], [`message`] | what went wrong, and the exit code for it |

mod arguments;
mod check;
mod contour;
mod convert;
mod count;
mod diff;
mod eval;
mod failure;
mod formats;
mod lattice;
mod logger;
mod manual;
mod memory;
mod mesh;
mod message;
mod output;
mod overlaps;
mod part_files;
mod points;
mod progress;
mod render;
mod sample;
mod scene;
mod sequence;
mod shade;
mod show;
mod signals;
mod stages;
mod standard;
mod stats;
mod threads;
mod timeline;

use std::io::Write as _;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser as _;
use clap::error::{ContextKind, ContextValue};

use arguments::{Arguments, Command};
use failure::Failure;

fn main() -> ExitCode {
    let start = Instant::now();
    memory::prepare();
    signals::install();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    let quiet = arguments.quiet;
    memory::limit(arguments.memory);
    logger::install(quiet);
    let watched = || signals::token().watches(|| run(&arguments.command, quiet, start));
    let work = || threads::run_all(watched);
    let done = match &arguments.trace {
        Some(path) => timeline::record(path, work),
        None => work(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // What fails once a signal has come, fails because of it.
            let failure = signals::caught().map_or(failure, Failure::Signal);
            output::report(&failure);
            ExitCode::from(failure.code())
        }
    }
}

fn run(command: &Command, quiet: bool, start: Instant) -> Result<(), Failure> {
    match command {
        Command::Mesh(arguments) => mesh::run(arguments, quiet, start),
        Command::Render(arguments) => render::run(arguments, quiet, start),
        Command::Contour(arguments) => contour::run(arguments, quiet, start),
        Command::Sample(arguments) => sample::run(arguments, quiet, start),
        Command::Eval(arguments) => eval::run(arguments, quiet),
        Command::Convert(arguments) => convert::run(arguments, quiet),
        Command::Show(arguments) => show::run(arguments, quiet),
        Command::Count(arguments) => count::run(arguments, quiet),
        Command::Stats(arguments) => stats::run(arguments, quiet, start),
        Command::Check(arguments) => check::run(arguments, quiet),
        Command::Diff(arguments) => diff::run(arguments, quiet),
        Command::Completions(arguments) => manual::completions(arguments),
        Command::Man(arguments) => manual::man(arguments, quiet),
    }
}

/// The scene that stands where a command should.
fn scene_without_command(error: &clap::Error) -> Option<String> {
    let ContextValue::String(word) = error.get(ContextKind::InvalidSubcommand)? else { return None };
    let endings = jbt::SceneFormat::ALL.into_iter().flat_map(jbt::SceneFormat::extensions);
    let extension = std::path::Path::new(word).extension()?;
    endings.into_iter().any(|ending| extension.eq_ignore_ascii_case(ending)).then(|| word.clone())
}

/// Help, the version, or what is wrong with the command line.
fn usage(error: &clap::Error) -> ExitCode {
    if let Some(scene) = scene_without_command(error) {
        let scene = jbt::diagnostic::escape(&scene);
        output::tell(&format!(
            "jbt: error: a command stands before the scene, as `jbt render {scene}`; see jbt --help"
        ));
        return ExitCode::from(2);
    }
    let hostile = std::env::args_os().any(|word| word.to_string_lossy().chars().any(char::is_control));
    if error.use_stderr() && hostile {
        // The message repeats words of the command line, which a script may have taken from anywhere.
        let text = error.render().to_string();
        let lines: Vec<String> = text.trim_end().lines().map(jbt::diagnostic::escape).collect();
        output::tell(&lines.join("\n"));
    } else {
        // A reader of the help may go away before its end.
        let printed = error.print().and_then(|()| std::io::stdout().flush());
        let full = printed.is_err_and(|error| error.kind() != std::io::ErrorKind::BrokenPipe);
        if full && !error.use_stderr() {
            return ExitCode::from(4);
        }
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}
