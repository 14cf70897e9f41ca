//! Draws every picture of the documentation again, into `docs/pictures/`: a scene of `examples/`, of
//! `docs/members/`, of the README each. The steps of the tutorial are put into its page as well,
//! `docs/tutorial.md`. The same files every time, on any number of threads. Two threads take a few minutes,
//! and most of that for the particles.
//!
//! ```text
//! cargo run --release -p jbt --example gallery
//! cargo run --release -p jbt --example gallery -- hero members/skeletons
//! ```
//!
//! Names are those of the files without their extension, or of folders: they alone are drawn.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example prints")]

#[path = "gallery/draw.rs"]
mod draw;
#[path = "gallery/list.rs"]
mod list;
#[path = "gallery/looks.rs"]
mod looks;
#[path = "gallery/page.rs"]
mod page;
#[path = "particles/splash.rs"]
mod splash;

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use list::Entry;

fn main() -> ExitCode {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    match run(&root, &names) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("gallery: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Draws all pictures, or those with these names.
fn run(root: &Path, names: &[String]) -> Result<(), Box<dyn Error>> {
    let mut entries = list::entries(root)?;
    if let Some(unknown) = names.iter().find(|name| !entries.iter().any(|entry| is_in(entry, name))) {
        return Err(format!("there is no picture `{unknown}`").into());
    }
    entries.retain(|entry| names.is_empty() || names.iter().any(|name| is_in(entry, name)));
    let mut total = 0;
    for entry in &entries {
        let start = Instant::now();
        let path = root.join("docs/pictures").join(entry.file());
        fs::create_dir_all(path.parent().expect("a folder"))?;
        let bytes = draw::draw(root, entry).map_err(|error| format!("{}: {error}", entry.name))?;
        fs::write(&path, &bytes)?;
        total += bytes.len();
        println!("{:40}{:>9} bytes {:>7.2} s", entry.file(), bytes.len(), start.elapsed().as_secs_f64());
    }
    let names = entries.iter().map(|entry| entry.name.as_str());
    page::write(root, &names.filter(|name| name.starts_with("tutorial/")).collect::<Vec<_>>())?;
    println!("{} pictures, {total} bytes", entries.len());
    Ok(())
}

/// Whether a picture has this name, or is in the folder of this name.
fn is_in(entry: &Entry, name: &str) -> bool {
    let rest = entry.name.strip_prefix(name.trim_end_matches('/'));
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}
