//! The monocle of BABEL (Tobler, Galla, Löffelmann and Purgathofer, "BABEL: A Generic Data Structure for
//! Geometric Modeling"), which took C++ for a modelling language, in Rust nearly as it was written there:
//!
//! ```text
//! Solid sharedSphere = Solid::newSphere();
//! Solid lens = sharedSphere.trans(0, 0, 0.8) & sharedSphere.trans(0, 0, -0.8);
//! Solid rim = Solid::newTorus(0.1).scale(0.6, 0.6, 0.6);
//! Solid monocle = lens.material("Glass") | rim.material("Steel");
//! ```
//!
//! ```text
//! cargo run --release -p jbt --example monocle
//! ```
//!
//! It prints the model as text, counts its nodes, and says what it meets on a line across it.
//! `examples/monocle.jbt` is the same tree.
#![allow(clippy::print_stdout, reason = "an example prints")]

#[path = "monocle/solid.rs"]
mod solid;

use std::error::Error;

use jbt::{Evaluator, Query, text};
use jbt_model::traverse::Visit;

use solid::{Material, model, monocle};

fn main() -> Result<(), Box<dyn Error>> {
    let model = model(monocle());
    println!("{}", text::print(&model));
    let [nodes, paths] = [Visit::Nodes, Visit::Paths].map(|visit| model.root.prefix(visit).count());
    println!("{nodes} nodes, {paths} with each path to them counted\n");

    let tree = model.check()?;
    let evaluator = Evaluator::compile(&tree, Query::ATTRIBUTES)?;
    for step in -8..=8 {
        let x = step as f32 / 10.0;
        let probe = evaluator.probe([x, 0.0, 0.0]);
        let inside = f64::from(probe.value()) >= tree.iso();
        let material = probe.attribute("material").filter(|_| inside).and_then(Material::of);
        println!("{x:5.1} {}", material.map_or("-".to_owned(), |material| format!("{material:?}")));
    }
    Ok(())
}
