//! A splash of 100,000 particles: the crown that a drop throws up when it falls into milk (after Edgerton's
//! photographs, 1936), as a fluid simulation would hand it over. It writes the model as text, the same one
//! every time.
//!
//! ```text
//! cargo run --release -p jbt --example particles > particles.jbt
//! jbt mesh particles.jbt --resolution 300 -o particles.glb
//! ```
#![allow(clippy::print_stdout, reason = "an example prints")]

#[path = "particles/splash.rs"]
mod splash;

use std::error::Error;
use std::io::{Write as _, stdout};

use jbt::text;

use splash::COUNT;

fn main() -> Result<(), Box<dyn Error>> {
    let text = text::print(&splash::model());
    write!(stdout(), "# A splash of {COUNT} particles, written by runtime/examples/particles.rs.\n{text}")?;
    Ok(())
}
