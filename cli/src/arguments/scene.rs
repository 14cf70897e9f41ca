//! What all commands take that read a scene: its path, and values of its parameters.

use std::path::PathBuf;

use clap::Args;
use jbt::import::particles::{ParticleForm, ParticleOptions};
use jbt::text::files::Files;
use jbt::{ModelUp, SceneFormat, text};

use super::words::positive;

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
    /// Take the axes of the scene for those of the other hand: pictures and meshes are mirrored
    #[arg(long)]
    pub mirror: bool,
    /// Take this axis of the scene for the one that points up, for a file that does not say, as a table
    #[arg(long, value_name = "y|z", value_parser = scene_up)]
    pub scene_up: Option<ModelUp>,
    /// Parts of it.
    #[command(flatten)]
    pub parts: PartArguments,
    #[command(flatten)]
    pub particles: ParticleArguments,
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

/// What a file of particles or atoms leaves open.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Particles and atoms")]
pub struct ParticleArguments {
    /// The radius of points that have none: alone, the surface of each is there
    #[arg(long, value_name = "R", value_parser = positive)]
    pub radius: Option<f64>,
    /// Multiply all radii; 0.6 gives bonds of molecules a waist
    #[arg(long, value_name = "FACTOR", value_parser = positive)]
    pub scale: Option<f64>,
    /// The field of a point: `soft` ends at two radii, `blinn` is Blinn's Gaussian at iso 1, `blinn:H` with
    /// another hardness than 2
    #[arg(long, value_name = "soft|blinn[:H]", value_parser = form)]
    pub form: Option<ParticleForm>,
    /// Make points ellipsoids by their neighbours within R, several times their distance: smooth fluids with
    /// thin sheets, after Yu and Turk (2013)
    #[arg(long, value_name = "R", value_parser = positive)]
    pub anisotropic: Option<f64>,
    /// What the columns of a table are, in order: x, y, z, radius, strength, r, g, b, names of attributes, or
    /// `-` for one to leave out
    #[arg(long, value_name = "NAMES", value_delimiter = ',', allow_hyphen_values = true)]
    pub columns: Vec<String>,
    /// Arrays of the file that become attributes
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub values: Vec<String>,
    /// Keep molecules of water
    #[arg(long)]
    pub waters: bool,
    /// The frame of a trajectory, or the model of a structure, from 1
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub frame: Option<u32>,
}

impl SceneOptions {
    /// As the library takes them, with a way to open the files that a scene names.
    pub fn to_library(&self, files: Files) -> text::Options {
        let ParticleArguments { radius, scale, form, anisotropic, columns, values, waters, frame } =
            self.particles.clone();
        let frame = frame.map(|frame| frame as usize);
        text::Options {
            parameters: self.definitions.clone(),
            object: self.object.clone(),
            files,
            particles: ParticleOptions { radius, scale, form, anisotropic, columns, values, waters, frame },
        }
    }
}

/// The axis of a scene that points up.
fn scene_up(word: &str) -> Result<ModelUp, String> {
    ModelUp::ALL.into_iter().find(|up| up.name() == word).ok_or_else(|| "expected y or z".to_owned())
}

fn form(text: &str) -> Result<ParticleForm, String> {
    let (word, hardness) = text.split_once(':').map_or((text, None), |(word, rest)| (word, Some(rest)));
    match (word, hardness) {
        ("soft", None) => Ok(ParticleForm::Soft),
        ("blinn", None) => Ok(ParticleForm::Blinn(2.0)),
        ("blinn", Some(hardness)) => positive(hardness).map(ParticleForm::Blinn),
        _ => Err("expected soft, blinn, or blinn:H".to_owned()),
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
