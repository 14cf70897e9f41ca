//! Sample files that are no part of the project.
//!
//! `JBT_SAMPLES` names the folder that holds `parsip`, `pov`, `quadtree`, `vm` and so on; a relative path
//! counts from the project's folder. Without it the folder is `shared/samples` beside the project.

use std::path::{Path, PathBuf};

use crate::skip::skip;

/// The folder of all samples, whether it is there or not.
#[must_use]
pub fn root() -> PathBuf {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let given = std::env::var_os("JBT_SAMPLES");
    project.join(given.map_or_else(|| PathBuf::from("../shared/samples"), PathBuf::from))
}

/// A folder of samples, as `"parsip"`. `None` where it is missing: the test that asks for it says that it is
/// [skipped](skip).
#[must_use]
pub fn folder(name: &str) -> Option<PathBuf> {
    let folder = root().join(name);
    if folder.is_dir() {
        return Some(folder);
    }
    skip(&format!("there is no folder {name} in the samples: set JBT_SAMPLES"));
    None
}

/// The bytes of a sample, as `"parsip/train_corrected.scene"`.
///
/// # Errors
///
/// What the system says of a file that cannot be read, in words for people.
pub fn file(name: &str) -> Result<Vec<u8>, String> {
    std::fs::read(root().join(name))
        .map_err(|error| format!("no {name} in the folder that JBT_SAMPLES names: {error}"))
}
