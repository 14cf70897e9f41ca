//! Files of particles that a text names: `particles { file "a.npy" radius 0.02 }`.
//!
//! They are read as those on a command line are, through the resolver of the caller. A message says where in
//! the file something is wrong, and quotes nothing of it: whoever wrote the scene need not be one who may see
//! the file.

use super::files::NamedFile;
use super::import::SceneFormat;
use super::import::particles::ParticleOptions;
use super::lex::Token;
use super::program::known::ParticleFault;
use super::state::Parser;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::report::clip;
use jbt_model::written::{Written, WrittenParticles};

impl Parser<'_> {
    /// The particles of a file whose name stands in quotes: with these columns, and these arrays as
    /// attributes. Those of groups that the text does not declare are left out. `has_radius`: the text gives
    /// a radius.
    pub(super) fn particle_file(
        &mut self,
        file: Token,
        [columns, values]: [Vec<String>; 2],
        has_radius: bool,
    ) -> Option<WrittenParticles> {
        let name = self.text(file).trim_matches('"');
        let found = self.named_file(name, file, "read")?;
        let asked = (found.identity.clone(), columns, values, has_radius);
        let known = self.program.particles.entry(asked);
        let read = known.or_insert_with_key(|(_, columns, values, _)| {
            let radius = has_radius.then_some(1.0);
            let (columns, values) = (columns.clone(), values.clone());
            read(&found, &ParticleOptions { radius, columns, values, ..ParticleOptions::default() })
        });
        let mut written = match read {
            Ok(written) => written.clone(),
            Err(ParticleFault::None) => {
                let message = format!("`{}` is no file of particles", clip(&found.path));
                self.report(|| Diagnostic::error(Some(file.span()), message));
                return None;
            }
            Err(ParticleFault::Unreadable(place)) => {
                let message = format!("`{}` has no particles that can be read{place}", clip(&found.path));
                self.report(|| {
                    Diagnostic::error(Some(file.span()), message)
                        .expected("expected a file that `jbt check` reads, or a radius for its points")
                });
                return None;
            }
        };
        let is_known = |name: &str, width: usize| self.group(name) == Some(width);
        written.values =
            written.values.iter().filter(|values| is_known(&values.name, values.width)).cloned().collect();
        Some(written)
    }

    /// Words in quotes with commas between.
    pub(super) fn quoted_words(&self, quoted: Option<Token>) -> Vec<String> {
        let text = quoted.map_or("", |token| self.text(token).trim_matches('"'));
        text.split(',').map(|word| word.trim().to_owned()).filter(|word| !word.is_empty()).collect()
    }
}

/// The particles of a file. A text may name it at many places, so it is read once.
fn read(file: &NamedFile, options: &ParticleOptions) -> Result<WrittenParticles, ParticleFault> {
    let format = SceneFormat::of(&file.path, &file.bytes).ok();
    let read = format.and_then(|format| format.read_particles(&file.bytes, options));
    match read.ok_or(ParticleFault::None)? {
        Ok((model, _)) => match model.root.node().written() {
            Written::Particles(particles) => Ok((**particles).clone()),
            _ => Err(ParticleFault::None),
        },
        Err(errors) => {
            let place = errors.first().map(|error| place(error, &file.bytes)).unwrap_or_default();
            Err(ParticleFault::Unreadable(place))
        }
    }
}

/// Where an error is, in a file of which nothing is quoted.
fn place(error: &Diagnostic, bytes: &[u8]) -> String {
    let Some(span) = error.span else { return String::new() };
    let before = bytes.get(..span.start as usize).unwrap_or_default();
    if std::str::from_utf8(bytes).is_err() {
        return format!(": byte {}", span.start);
    }
    format!(": line {}", before.iter().filter(|&&byte| byte == b'\n').count() + 1)
}
