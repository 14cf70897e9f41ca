//! Every member of the open sets, in a few small models with known answers: skeletons, falloffs, combinators,
//! warps, affine maps, kinds of nodes, ways to mix attributes.
//!
//! ```text
//! members! { SkeletonKind {                                   a member without its line does not compile,
//!     Point => vec![                                          one without a row does not pass
//!         row("a ball", "point { radius 2 }", &[              a model, and its field at named points,
//!             ([1.0, 0.0, 0.0], 0.5),                         worked out by hand
//!         ]),
//!     ],
//! } }
//! ```
//!
//! That is all that a row has to say. What it is judged by stands in `check/`: values, oracle, support,
//! ranges, engines, round trip. A failure prints the family, the member, the row, the check, the point, what
//! was expected and what came out.
//!
//! `defects` are mistakes that other systems have made, each with the formula that makes it; `folds` says
//! what a sum of all skeletons compiles to.

mod attributes;
mod check;
mod combinators;
#[path = "../common/mod.rs"]
mod common;
mod defects;
mod falloffs;
mod folds;
mod maps;
mod nodes;
mod points;
mod row;
mod skeletons;
mod subject;
mod warps;
