//! Ours against the physical limit and the peers: cases, each a contest over one kind of work.
//!
//! ```text
//! Case ──► models, points ──► Oracle checks every contestant ──► Contest runs them in turn ──► ResultRow: medians, ratios
//! ```
//!
//! All contestants of a case are given the same numbers and run on as many threads. Whoever's answers are off
//! is named in the row and not timed.

mod contest;
mod dense;
mod live;
mod mesh;
mod options;
mod oracle;
mod picture;
mod programs;
mod report;
mod rows;
mod threads;
mod train;
mod unions;

pub use contest::{Contestant, Effort, Standing, Standings};
pub use options::Options;
pub use report::{ResultRow, heading, line};

/// A case.
#[derive(Clone, Copy)]
pub struct Case {
    /// The word of the command line.
    pub name: &'static str,
    /// What is measured, for people.
    pub what: &'static str,
    run: fn(Options) -> Vec<ResultRow>,
}

impl Case {
    /// All cases, in the order of the table.
    pub const ALL: &'static [Self] = &[
        Self { name: "dense-field", what: "the field of 200 points, no culling", run: dense::field },
        Self { name: "dense-gradient", what: "field and gradient of 200 points", run: dense::gradient },
        Self { name: "dense-full", what: "field, gradient and colour of 200 points", run: dense::full },
        Self {
            name: "interpreter",
            what: "the field by interpreters, no machine code",
            run: dense::interpreter,
        },
        Self {
            name: "compile",
            what: "from a model to its kernel, by number of primitives",
            run: rows::compile,
        },
        Self {
            name: "mesh-64",
            what: "blobs to a mesh, 129^3 lattice",
            run: |options| mesh::blobs(64, "mesh-64", options),
        },
        Self {
            name: "mesh-512",
            what: "the same, 512 blobs",
            run: |options| mesh::blobs(512, "mesh-512", options),
        },
        Self {
            name: "mesh-4096",
            what: "the same, 4,096 blobs",
            run: |options| mesh::blobs(4096, "mesh-4096", options),
        },
        Self {
            name: "mesh-scaling",
            what: "blobs to a mesh, 257^3 lattice, by number of blobs",
            run: mesh::scaling,
        },
        Self {
            name: "unions",
            what: "unions of 1,024 spheres and a sponge to meshes, 129^3 lattice",
            run: unions::unions,
        },
        Self {
            name: "small-box",
            what: "the rows of a union that matter in one small box, by number of spheres",
            run: unions::small_boxes,
        },
        Self { name: "particles", what: "a ball of particles to a mesh", run: mesh::particles },
        Self { name: "threads", what: "meshes on two threads, and on one", run: threads::threads },
        Self {
            name: "train",
            what: "the field of the ParsIP train on its lattice, cell 0.13",
            run: train::train,
        },
        Self {
            name: "programs",
            what: "the fields of imported programs of up to 7,866 instructions, no culling",
            run: programs::programs,
        },
        Self {
            name: "prospero",
            what: "a page of text by 7,866 instructions, 1024 x 1024 pixels",
            run: picture::prospero,
        },
        Self {
            name: "picture",
            what: "512 blobs seen along z after an edit, 512 x 512 pixels with normals",
            run: picture::blobs,
        },
        Self {
            name: "hero-picture",
            what: "an octopus in light, 800 x 600 pixels, draft and good, and 200 x 200",
            run: picture::hero,
        },
        Self {
            name: "scaling",
            what: "the field at 4,096 points, by number of primitives",
            run: dense::scaling,
        },
        Self {
            name: "edit",
            what: "change a number of 512 points, evaluate the field at 4,096",
            run: rows::edit,
        },
        Self {
            name: "live",
            what: "one of many points moves, until the mesh is up to date, 129^3 lattice",
            run: live::moves,
        },
    ];

    /// The case of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|case| case.name == name)
    }

    /// Runs it.
    #[must_use]
    pub fn run(&self, options: Options) -> Vec<ResultRow> {
        (self.run)(options)
    }
}
