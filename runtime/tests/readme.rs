//! What the README shows is true: its scene is a good model with a closed surface, and its two commands are
//! the only ones.

use jbt::{Compiler, Polygonize};
use jbt_testkit::scene::tree;

fn readme() -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../README.md");
    std::fs::read_to_string(path).expect("the project has a README")
}

#[test]
fn the_scene_on_the_first_screen_is_a_closed_surface() {
    let readme = readme();
    let scene: Vec<&str> =
        readme.lines().skip_while(|line| *line != "jbt 1").take_while(|line| *line != "```").collect();
    assert_eq!(scene.len(), 12, "a scene of twelve lines");
    let tree = tree(&scene.join("\n"));
    let made = Polygonize::default().mesh(&Compiler::new(), &tree).run().expect("it has a surface");
    assert!(made.report.closed && !made.mesh.triangles.is_empty());
}

#[test]
fn there_are_two_commands() {
    let readme = readme();
    let commands: Vec<&str> =
        readme.lines().map(str::trim).filter(|line| line.starts_with("cargo ")).collect();
    assert_eq!(
        commands,
        ["cargo run --release -- mesh examples/hero.jbt -o hero.glb", "cargo test --release"]
    );
}
