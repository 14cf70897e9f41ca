//! What all commands take that read a scene: its path, and values of its parameters.

use std::path::PathBuf;

use clap::Args;
use jbt::text;

/// The scene, and what its text leaves open.
#[derive(Args, Debug)]
pub struct SceneArguments {
    /// The scene: a .jbt text, a ParsIP .blob or .scene, or a .vm program; `-` is the standard input
    #[arg(value_name = "SCENE")]
    pub path: PathBuf,
    /// Set a parameter of a .jbt text; the value is a number or an expression of numbers, as 2*pi
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = definition)]
    pub definitions: Vec<(String, f64)>,
    /// Parts of it.
    #[command(flatten)]
    pub parts: PartArguments,
}

/// Which parts of a scene count.
#[derive(Args, Clone, Debug, Default)]
pub struct PartArguments {
    /// Only the parts of this name, where they are; a path as body/arm.1/hand tells parts of one name apart
    #[arg(long, value_name = "PATH")]
    pub only: Option<String>,
    /// Not the parts of this name or path; may be given several times
    #[arg(long, value_name = "PATH")]
    pub without: Vec<String>,
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
