//! Completions and manual pages know every command.

use std::fs;

use crate::folder::Folder;

const COMMANDS: [&str; 13] = [
    "mesh",
    "render",
    "contour",
    "sample",
    "eval",
    "convert",
    "diff",
    "show",
    "count",
    "stats",
    "check",
    "completions",
    "man",
];

/// A page for each command and one for the program.
const PAGES: usize = COMMANDS.len() + 1;

#[test]
fn completions_for_every_shell() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = folder.jbt(&["completions", shell]).code(0).stdout();
        for command in COMMANDS {
            assert!(script.contains(command), "{shell}: {command}");
        }
        // What the tables of formats say.
        assert!(script.contains("glb") && script.contains("svg") && script.contains("resolution"), "{shell}");
    }
    folder.jbt(&["completions", "korn"]).code(2).says("bash, elvish, fish, powershell, zsh");
}

#[test]
fn manual_pages_for_every_command() {
    let folder = Folder::new();
    folder.jbt(&["man", "pages"]).code(4).says("cannot write pages/jbt.1: there is no folder pages");
    fs::create_dir(folder.path("pages")).unwrap();
    let ran = folder.jbt(&["man", "pages"]).code(0);
    assert_eq!(ran.stdout(), format!("pages: {PAGES} pages\n"));
    let page = |name: &str| String::from_utf8(folder.read(&format!("pages/{name}.1"))).unwrap();
    assert!(page("jbt").contains(".TH jbt 1"));
    for command in COMMANDS {
        let page = page(&format!("jbt-{command}"));
        assert!(page.contains(&format!(".TH jbt-{command} 1")), "{page}");
        assert!(page.contains("NAME") && page.contains("Examples:"), "{page}");
    }
    assert!(page("jbt-mesh").contains(".glb"));
    assert_eq!(fs::read_dir(folder.path("pages")).unwrap().count(), PAGES, "and nothing else");
    folder.jbt(&["man", "pages", "-q"]).code(0);
}
