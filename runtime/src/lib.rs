//! jbt compiles **BlobTrees** to SIMD machine code: the field, its gradient and its attributes come out of
//! one evaluation of each primitive.
//!
//! A BlobTree is a graph of skeletal implicit surfaces: primitives (a skeleton, and a falloff of the distance
//! to it), blends, CSG, warps, affine maps, attributes. Inside means `field >= iso`.
//!
//! ```
//! use jbt::build::{Axis, point};
//! use jbt::{Evaluator, Model, Query};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let orange = point([0.0, 0.4, 0.0], 1).color([1.0, 0.6, 0.1]);
//!     let blue = point([0.0, -0.4, 0.0], 1).color([0.1, 0.4, 1.0]);
//!     let tree = Model::new((orange + blue).twist(Axis::Y, 0.5)).check()?;
//!
//!     let evaluator = Evaluator::compile(&tree, Query::ALL)?; // once; threads may share it
//!     let mut samples = evaluator.samples();
//!     evaluator.eval(&[[0.0, 0.1, 0.0], [0.3, 0.0, 0.0]], &mut samples)?; // many times
//!
//!     // The published figures of this peanut: fields 0.794976 and 1/2, and the colours mixed by them.
//!     assert!((samples.field()[0] - 1.294976).abs() < 1e-6);
//!     let [red, _, _] = samples.colors().ok_or("attributes were asked for")?;
//!     assert!((red[0] - (0.613892 * 1.0 + 0.386108 * 0.1)).abs() < 1e-5);
//!     Ok(())
//! }
//! ```
//!
//! ```text
//! Model ──check──► CheckedTree ──Compiler──► Compiled ──Query──► Evaluator ──points──► samples
//!   ▲                                           │
//! text, build, import                           └──► Pruner, Polygonize, Render, Slicer, Sampler, .. ──► export
//! ```
//!
//! * [`Scene::load`], [`build`], [`text`] and [`import`] make a [`Model`]; [`Model::check`] says everything
//!   that is wrong with it. [`tree`] is for programs that read one.
//! * Numbers may depend on named parameters ([`build::param`], `param` in a text):
//!   [`CheckedTree::with_parameters`] sets them, and [`Compiled::updated`] and [`Evaluator::update`] then
//!   write numbers and compile nothing.
//! * A [`Compiler`] makes a [`Compiled`] model, which compiles what is asked of it when it is asked, and
//!   once: a mesh, a slice and a picture of one compiled model share their programs. For a single question
//!   there are shorter ways, as `Solid::new` or [`Compiler::evaluator`].
//! * An [`Evaluator`] answers one [`Query`] at any points, on the [`Engine`] that the machine has; all
//!   engines give the same bits. A [`Probe`] is a single point: its answers may be read in any order, and
//!   together cost one evaluation.
//! * A [`Pruner`] makes a [`Region`] of a box: the rows that matter there. [`Evaluator::eval_region`] runs
//!   these alone, with the same bits; [`divide`], [`sample`] and meshes do so by themselves.
//! * [`Polygonize`] meshes a model, [`Render`] makes pictures of it; [`export`] writes both.
//! * [`remote`] makes parts of models for other processes, and [`Polygonize::block`] parts of meshes.
//! * A [`LiveMesh`] follows the edits of its model: what has changed is made anew, in buffers for a GPU.
//! * A [`contour::Slicer`] looks at a model in a plane: contours as closed loops, and images.
//! * A [`Solid`] answers questions about the set that a model encloses: which side a point is on, which leaf
//!   decides there, how far it reaches, how large it is.
//! * A [`Tracer`] follows rays to where they hit the surface, singly or in packets, and misses nothing that
//!   is longer than a tolerance.
//! * [`Counters`] say how much was evaluated, and how much more one walk of the tree for each answer would
//!   have been; [`statistics`] tell both beforehand, and how many evaluations are inside of a primitive's
//!   support.
//!
//! # Features
//!
//! | feature | what for |
//! |---|---|
//! | `jit` (default) | machine code; without it the SIMD interpreter runs, with the same bits |
//! | `parallel` (default) | long work on the threads of the rayon pool in which it is called; without it on one |
//! | `levels` (default) | loops of the mesher in AVX2 where the CPU has it, with the same bits |
//! | `export` (default) | files: meshes, contours, pictures, atomic replacement, files that scenes name |
//! | `listing` | machine code as text |
//! | `trace` | stages of long work as spans of the crate `tracing`, for timelines |
//! | `glam` | vectors and affine maps of glam 0.34 wherever numbers and points go |
//! | `mint` | the same for mint 0.5, for any other library of vectors |
//! | `serde` | meshes, points, samples, settings and reports can be written, and read where nothing can be wrong with them |
//!
//! Without default features fifteen packages of others are built, with `jit` forty-five. glam's major
//! version is a matter of its feature alone: nothing else here has its types.
//!
//! # Targets
//!
//! | target | what runs |
//! |---|---|
//! | x86-64 with AVX-512 or AVX2 and FMA | wide machine code of 512 or 256 bits; the interpreter in the same widths |
//! | other x86-64, aarch64, riscv64, s390x | Cranelift's machine code of 128 bits, where its generator takes the CPU |
//! | anything else that has `std` | the SIMD interpreter, without the feature `jit` |
//!
//! The bits are the same on all of them, since every op is defined by IEEE 754 arithmetic and its own
//! polynomials. The tests run on x86-64. [`Level`] bounds the instruction set by hand.
//!
//! The least version of Rust is 1.95. A newer one is needed only by a new minor version of this crate.
//!
//! # Threads
//!
//! | what | threads |
//! |---|---|
//! | [`Evaluator::eval`], [`Probe`], the check, the compiler | the one that calls |
//! | [`Evaluator::par_eval`], every [`Job`] | the rayon pool in which they are called |
//! | compiled models, evaluators, pruners, tracers, solids, slicers, renderers | `Send + Sync`: threads share them |
//! | [`Samples`], [`Probe`] | `Send`: each thread has its own |
//!
//! Answers have the same bits for any number of threads. Long work is a [`Job`]: `.run()` does it,
//! `.on_progress(..)` watches it, `.cancel(&token)` stops it.
//!
//! # Errors
//!
//! Reading, checking and setting parameters have one error, [`Diagnostics`]: a list of all that is wrong,
//! which shows each place with its line and a caret. Every other door has a small error of its own. All of
//! them are [`Classified`]: an [`ErrorKind`] says what has to change so that the error goes away. All are
//! `Send + Sync + 'static` and go into `Box<dyn Error>`; none is a panic, whatever a file says.
//!
//! Memory that is not to be had is an error as well, wherever its size follows the size of an input, and as
//! long as some megabytes are left for small parts. What has no error cannot tell of it: checks of triangles,
//! copies of what is there in another form or as bytes, where two models differ ([`Pruner::edit`]). Programs
//! that are built with `panic = "abort"` are told of large vectors alone.
//!
//! # What later versions may add
//!
//! * Errors, reports and counters are `#[non_exhaustive]`: they get variants and fields.
//! * Structs of settings, as [`Polygonize`], are written with `..Default::default()`. They get fields too,
//!   which breaks nobody who writes them so; `#[non_exhaustive]` would forbid this form.
//! * Enums of the language, as [`NodeKind`] and [`Combinator`], have no `#[non_exhaustive]`: a program that
//!   reads trees wants to hear from its compiler what it does not handle yet. A new member is a new minor
//!   version.
//! * Of [`internals`] nothing is promised.

pub mod boxes;
mod buffer;
mod bytes;
mod compiled;
mod compiler;
pub mod contour;
mod counter;
mod debug;
pub mod differing;
pub mod divide;
mod error;
mod evaluator;
#[cfg(feature = "export")]
pub mod export;
mod finite_gradient;
mod finite_points;
#[cfg(feature = "export")]
mod folder;
pub mod internals;
mod job;
mod kernel;
pub mod live;
pub mod mesh;
mod morton;
mod ordered;
mod parallel;
mod picture;
mod points;
mod polygonize;
mod probe;
mod program;
mod progress;
pub mod prune;
pub mod remote;
pub mod render;
pub mod sample;
mod scene;
pub mod solid;
mod span;
pub mod srgb;
pub mod statistics;
mod support;
mod touched;
pub mod trace;
pub mod tree;
mod union_find;
mod word;

/// README's program runs.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
mod readme {}

pub use jbt_ir::level::{self, Level};
pub use jbt_ir::limits;
pub use jbt_model::attribute::{AttributeGroup, GroupKind, Mixing};
pub use jbt_model::builder as build;
pub use jbt_model::check::{CheckedModel, CheckedTree, NodeId};
pub use jbt_model::combine::{Combinator, SetOperation};
pub use jbt_model::diagnostic::{self, Diagnostic, Diagnostics};
pub use jbt_model::falloff::Falloff;
pub use jbt_model::model::Model;
pub use jbt_model::number::Number;
pub use jbt_model::orientation::{Handed, ModelUp, Orientation};
pub use jbt_model::origin::ModelOrigin;
pub use jbt_model::parameter::{Fixture, Parameter, ParameterRange};
pub use jbt_model::query::{AnswerKind, Planes, Query};
pub use jbt_model::tree::Tree;
pub use jbt_model::walk;
pub use jbt_text as text;
pub use jbt_text::import;

pub use boxes::{Box3, Range};
pub use buffer::{Layout, Samples};
pub use compiled::{Compiled, Task};
pub use compiler::{CompileCounters, Compiler};
pub use counter::Counters;
pub use error::{Classified, CompileError, ErrorKind, EvalError};
pub use evaluator::{Evaluator, Update};
#[cfg(feature = "export")]
pub use folder::SceneFolder;
pub use jbt_text::import::SceneFormat;
pub use job::{CancelToken, Job};
pub use kernel::Engine;
pub use live::{LiveContour, LiveMesh};
pub use picture::Picture;
pub use points::{AsPoint, AsPoints, LengthError, Points, PointsIter};
pub use polygonize::{Fineness, MeshCounters, Polygonize, PolygonizeError, Polygonized};
pub use probe::Probe;
pub use prune::{PruneCounters, Pruner, Region};
pub use render::{Render, Renderer};
pub use scene::Scene;
pub use solid::{Membership, Solid};
pub use trace::{Ray, Tracer};
pub use tree::{Node, NodeKind};
pub use word::UnknownWord;
