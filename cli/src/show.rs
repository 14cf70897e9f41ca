//! `jbt show`: a scene as one of the stages on its way to machine code.

use jbt::diagnostic::escape;
use jbt::internals::ir::pass::GRADIENT;
use jbt::internals::ir::{Function, Straight, Verified};
use jbt::internals::kernel::{Purpose, form, forms, optimise, optimise_straight, passes, straighten};
use jbt::internals::lower::{Lowered, lower};
use jbt::text;
use jbt::{CompileError, Level, Query};

use crate::arguments::{LevelName, ShowArguments};
use crate::failure::Failure;
use crate::output::print;
use crate::scene::LoadedScene;

/// The stages that are neither passes nor forms of engines.
const TREE: &str = "tree";
const RUST: &str = "rust";
const IR: &str = "ir";

/// The message where there is nothing to show.
const NOT_STRAIGHT: &str = "the scene has no straight code: it has no formulas of which a few have much in common; see it without --straight";

/// Runs the command.
pub fn run(arguments: &ShowArguments, quiet: bool) -> Result<(), Failure> {
    let query = arguments.query.query;
    let stage = arguments.stage.as_str();
    if !stages(query).any(|(name, _)| name == stage) {
        return Err(Failure::Usage(unknown(stage, query)));
    }
    let scene = LoadedScene::load(&arguments.scene)?;
    scene.warn(quiet);
    arguments.query.check_numbers()?;
    let tree = scene.check_for(&arguments.query)?;
    if stage == TREE {
        return print(text::print(&scene.model).trim_end());
    }
    if stage == RUST {
        return print(text::print_rust(&scene.model).trim_end());
    }
    let fail = |error: &CompileError| scene.failure(error);
    let purpose = Purpose::Answers(query);
    let Lowered { function, tables } =
        lower(&tree, query).map_err(|diagnostics| Failure::diagnostics(scene.text(), &diagnostics))?;
    let straight = match arguments.straight {
        false => None,
        true => Some(
            straighten(&function, &tables, purpose, None)
                .map_err(|error| fail(&error))?
                .ok_or_else(|| Failure::Usage(NOT_STRAIGHT.to_owned()))?,
        ),
    };
    if stage == IR {
        let function = straight.as_ref().map_or(&function, Straight::function);
        return print(function.to_string().trim_end());
    }
    let mut shown = None;
    let mut observer = |pass: &str, function: &Function| {
        if pass == stage {
            shown = Some(function.to_string());
        }
    };
    let verified = match &straight {
        None => optimise(function, purpose, &mut observer),
        Some(straight) => {
            // It is made of what the purpose's own pass gives.
            observer(GRADIENT.name, straight.function());
            optimise_straight(straight, &mut observer)
        }
    };
    let verified = verified.map_err(|error| fail(&error))?;
    match shown {
        Some(text) => print(text.trim_end()),
        None => {
            let level = arguments.level.map_or_else(Level::best, LevelName::level);
            print(machine(&verified, stage, level)?.trim_end())
        }
    }
}

/// The program as an engine has it. Every stage that is no pass is a form of some engine.
fn machine(function: &Verified, stage: &str, level: Level) -> Result<String, Failure> {
    let form = form(stage, level)
        .ok_or_else(|| Failure::Usage(format!("there is no stage `{stage}` for the level {level}")))?;
    (form.text)(function, level).map_err(|declined| Failure::Limit(declined.reason))
}

/// All stages for a query, in order, and what each shows.
fn stages(query: Query) -> impl Iterator<Item = (&'static str, &'static str)> {
    let first = [
        (TREE, "The scene as .jbt text."),
        (RUST, "The scene as a function in Rust that builds it."),
        (IR, "The lowered program, before any pass."),
    ];
    let last = forms().into_iter().map(|form| (form.name, form.what));
    first.into_iter().chain(passes(Purpose::Answers(query)).map(|pass| (pass.name, pass.what))).chain(last)
}

/// The message about an unknown stage, with those that there are.
fn unknown(stage: &str, query: Query) -> String {
    let list: Vec<String> = stages(query).map(|(name, what)| format!("  {name:<18}{what}")).collect();
    format!(
        "the query `{}` has no stage `{}`; its stages are:\n{}",
        query.name(),
        escape(stage),
        list.join("\n")
    )
}
