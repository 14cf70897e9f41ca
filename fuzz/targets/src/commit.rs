//! Which code a record is about.

use std::process::Command;

/// The commit of the folder that this is run in; `-` where nobody knows.
#[must_use]
pub fn commit() -> String {
    let said = Command::new("git").args(["rev-parse", "--short", "HEAD"]).output();
    let said = said.ok().filter(|said| said.status.success());
    said.map_or_else(|| "-".into(), |said| String::from_utf8_lossy(&said.stdout).trim().to_owned())
}
