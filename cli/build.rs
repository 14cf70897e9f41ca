//! Has the little of the C++ library that the simplifier of meshes needs (`new`, `delete`) in the binary itself:
//! to load the whole library takes half a millisecond of each start, a quarter of what `jbt --version` takes.
//!
//! `-lstdc++` finds a linker script here that names the static library, where the C compiler has one.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// The static C++ library of the C compiler, if it has one.
fn library() -> Option<PathBuf> {
    let compiler = env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let told = Command::new(compiler).arg("-print-file-name=libstdc++.a").output().ok()?;
    let path = String::from_utf8(told.stdout).ok()?;
    // Without one it says the name alone.
    Some(Path::new(path.trim()).to_owned()).filter(|path| path.is_absolute() && path.exists())
}

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=CC");
    let of = |name: &str| env::var(name).unwrap_or_default();
    let is_linux = of("CARGO_CFG_TARGET_OS") == "linux" && of("CARGO_CFG_TARGET_ENV") == "gnu";
    if !is_linux || of("TARGET") != of("HOST") {
        return;
    }
    if let Some(library) = library() {
        let folder = of("OUT_DIR");
        let script = format!("INPUT({})\n", library.display());
        if fs::write(Path::new(&folder).join("libstdc++.so"), script).is_ok() {
            println!("cargo:rustc-link-search=native={folder}");
        }
    }
}
