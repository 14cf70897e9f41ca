//! Loading scenes: a path or the standard input becomes a model, whatever its format.

use std::io;
use std::sync::Arc;

use jbt::diagnostic::{Diagnostic, Severity, SourceText};
use jbt::text::files::Files;
use jbt::{CheckedTree, Classified, Compiled, Evaluator, Model, Query, SceneFolder};

use crate::arguments::{PartArguments, SceneArguments, WantedAnswers};
use crate::failure::Failure;
use crate::message::Message;
use crate::output::{highlight, tell};
use crate::standard::is_standard;

/// A scene: its text for messages, and its model.
pub struct LoadedScene {
    text: SourceText,
    /// What the text says.
    pub model: Model,
    /// What is odd about the text, rendered.
    pub warnings: Vec<String>,
    /// The same for machines.
    pub notices: Vec<Message>,
}

impl LoadedScene {
    /// Reads and parses a scene.
    pub fn load(arguments: &SceneArguments) -> Result<Self, Failure> {
        let path = &arguments.path;
        let files = if is_standard(path) {
            Files::of_standard_input()
        } else {
            Files::new(Arc::new(SceneFolder::of(path)))
        };
        let options = arguments.options.to_library(files);
        let loaded = if is_standard(path) {
            jbt::Scene::from_reader("<stdin>", io::stdin().lock(), &options)
        } else {
            jbt::Scene::load_with(path, &options)
        };
        let jbt::Scene { mut model, warnings, text, .. } =
            loaded.map_err(|error| Failure::scene(&path.display(), &error))?;
        if let Some(up) = arguments.options.scene_up {
            model.orientation.up = up;
        }
        if arguments.options.mirror {
            model.orientation.handed = model.orientation.handed.other();
        }
        let PartArguments { only, without } = &arguments.options.parts;
        for part in without {
            model = model.without(part).map_err(|error| Failure::scene(&path.display(), &error))?;
        }
        if let Some(part) = only {
            model = model.only(part).map_err(|error| Failure::scene(&path.display(), &error))?;
        }
        let notices: Vec<_> = warnings.iter().map(|one| Message::in_text(&text, one)).collect();
        let warnings = notices.iter().map(|notice| notice.rendered.clone()).collect();
        Ok(Self { text, model, warnings, notices })
    }

    /// What a mesh of it is called: the part that is asked for, or the name of the root.
    pub fn part_name<'a>(&'a self, parts: &'a PartArguments) -> Option<&'a str> {
        parts.only.as_deref().or_else(|| self.model.root.node().name())
    }

    /// Tells people what is odd about the text.
    pub fn warn(&self, quiet: bool) {
        if !quiet {
            for warning in &self.warnings {
                tell(&highlight(warning, Severity::Warning));
            }
        }
    }

    /// The text, for messages.
    pub fn text(&self) -> &SourceText {
        &self.text
    }

    /// Its name, as it stands on the command line.
    pub fn name(&self) -> &str {
        self.text.name()
    }

    /// Why a task was not done for it.
    pub fn failure(&self, error: &impl Classified) -> Failure {
        Failure::task(&self.text, error)
    }

    /// The checked model, or all that is wrong with it.
    pub fn check(&self) -> Result<CheckedTree, Failure> {
        self.model.check().map_err(|error| Failure::diagnostics(&self.text, &error))
    }

    /// The checked model, as far as something is wanted of it.
    pub fn check_for(&self, wanted: &WantedAnswers) -> Result<CheckedTree, Failure> {
        wanted.of(self.check()?).map_err(|error| {
            let words = |one: &Diagnostic| {
                let help = one.help.as_ref().map_or_else(String::new, |help| format!("; {help}"));
                format!("{}{help}; answers are {}", one.message, Query::EVERY.map(Query::name).join(", "))
            };
            Failure::Usage(error.first().map(words).unwrap_or_default())
        })
    }

    /// The checked model with a colour for each leaf, in the group of this name, where that leaf decides.
    pub fn owner_colors(&self, name: &str) -> Result<CheckedTree, Failure> {
        let tree = self.check()?;
        let has_own = tree.attributes().iter().any(|group| &*group.name == name);
        if has_own {
            return Ok(tree);
        }
        tree.with_owner_colors().map_err(|error| Failure::diagnostics(&self.text, &error))
    }

    /// An evaluator.
    pub fn evaluator(&self, compiled: &Compiled, query: Query) -> Result<Evaluator, Failure> {
        compiled.evaluator(query).map_err(|error| self.failure(&error))
    }
}
