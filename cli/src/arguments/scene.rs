//! What all commands take that read a scene: its path, and values of its parameters.

use std::path::PathBuf;

use clap::Args;
use jbt::{SceneFormat, text};

/// The scene, and what its text leaves open.
#[derive(Args, Debug)]
pub struct SceneArguments {
    #[arg(value_name = "SCENE", help = format!("The scene: {}; `-` is the standard input", SceneFormat::list()))]
    pub path: PathBuf,
    #[command(flatten)]
    pub options: SceneOptions,
}

/// What the text of a scene leaves open.
#[derive(Args, Clone, Debug)]
pub struct SceneOptions {
    /// Set a parameter of a .jbt text; the value is a number or an expression of numbers, as 2*pi
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = definition)]
    pub definitions: Vec<(String, f64)>,
    /// Read this object of a file that holds several, instead of those that no other object refers to
    #[arg(long, value_name = "NAME")]
    pub object: Option<String>,
    /// Take the axes of the scene for those of the other hand: pictures and meshes are mirrored, coordinates stay
    #[arg(long)]
    pub mirror: bool,
}

impl SceneOptions {
    /// As the library takes them.
    pub fn to_library(&self) -> text::Options {
        text::Options { parameters: self.definitions.clone(), object: self.object.clone() }
    }
}

pub(super) fn definition(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    let name = name.trim();
    if name.is_empty() {
        return Err("expected a name before `=`".to_owned());
    }
    let value = text::number(value).map_err(|errors| {
        let reason = errors.first().map_or(String::new(), |error| format!(": {}", error.message));
        format!("expected a number after `{name}=`, as 2 or 2*pi{reason}")
    })?;
    Ok((name.to_owned(), value))
}
