//! An edit of one of many points, until a mesh is up to date: the tree, its check, its lowering, the mesh.

use jbt::{Box3, CheckedTree, Compiler, Fineness, LiveMesh, Model, Polygonize, Tree};
use serde_json::json;

use super::contest::{Contest, Contestant};
use super::options::Options;
use super::report::ResultRow;
use crate::model::{self, Blob};

/// Cells along an axis of the lattice over [-1, 1]^3.
const CELLS: usize = 128;
/// How far a point moves.
const STEP: f32 = 0.01;
/// The next point that moves is so many further.
const STRIDE: usize = 977;

/// Points, one of which moves with each edit, there and back.
#[derive(Clone)]
struct MovingBlobs {
    blobs: Vec<Blob>,
    leaves: Vec<Tree>,
    edits: usize,
}

impl MovingBlobs {
    fn new(count: usize) -> Self {
        let blobs = model::blobs(count, 1);
        let leaves = blobs.iter().map(model::leaf).collect();
        Self { blobs, leaves, edits: 0 }
    }

    fn model(&self) -> Model {
        Model::new(Tree::sum(self.leaves.iter().cloned()))
    }

    /// The model after one more edit: other trees than that of the point and the sum are shared.
    fn edited(&mut self) -> Model {
        let which = self.edits / 2 * STRIDE % self.blobs.len();
        self.blobs[which].center[0] += if self.edits.is_multiple_of(2) { STEP } else { -STEP };
        self.leaves[which] = model::leaf(&self.blobs[which]);
        self.edits += 1;
        self.model()
    }
}

fn settings() -> Polygonize {
    Polygonize {
        region: Some(Box3::new([-1.0; 3], [1.0; 3])),
        fineness: Fineness::Resolution(CELLS),
        verify: false,
        thin_parts: false,
        sharp: true,
    }
}

/// The mesh of a model, everything made anew but the code.
fn whole(compiler: &Compiler, model: &Model) -> (CheckedTree, jbt::mesh::Mesh) {
    let tree = model.check().expect("blobs are a good model");
    let mesh = settings().mesh(compiler, &tree).run().expect("blobs have a mesh").mesh;
    (tree, mesh)
}

/// Some edits, compared to the bit with what is made anew.
fn check(compiler: &Compiler, moving: &MovingBlobs) -> Result<(), String> {
    let mut moving = moving.clone();
    let mut live = LiveMesh::new(compiler, &moving.model(), settings()).run().expect("blobs have a mesh");
    for _ in 0..3 {
        let model = moving.edited();
        live.replace(&model).run().expect("blobs have a mesh");
        if live.compact() != whole(compiler, &model).1 {
            return Err("the mesh is another one than that of the whole".to_owned());
        }
    }
    Ok(())
}

/// One of many points moves.
pub(super) fn moves(options: Options) -> Vec<ResultRow> {
    let counts: &[usize] = if options.quick { &[4_096] } else { &[4_096, 100_000] };
    counts.iter().map(|&count| row(count, options)).collect()
}

fn row(count: usize, options: Options) -> ResultRow {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build();
    let pool = pool.expect("threads can be made");
    let (compiler, moving) = (Compiler::new().for_edits(), MovingBlobs::new(count));
    let checked = pool.install(|| check(&compiler, &moving));
    let model = moving.model();
    let start = || LiveMesh::new(&compiler, &model, settings()).run();
    let mut live = pool.install(start).expect("blobs have a mesh");
    let triangles = live.compact().triangles.len();
    let mut contest = Contest::new();
    let (pool, mut edits) = (&pool, moving.clone());
    contest.enter(Contestant::Ours, "", checked, move || {
        let model = edits.edited();
        let change = pool.install(|| live.replace(&model).run()).expect("blobs have a mesh");
        assert!(!change.relaid, "an edit of numbers");
    });
    let (compiler, mut edits) = (&compiler, moving.clone());
    contest.enter(Contestant::Whole, "", Ok(()), move || {
        let model = edits.edited();
        let made = pool.install(|| whole(compiler, &model));
        assert!(!made.1.triangles.is_empty());
    });
    ResultRow {
        case: "live",
        of: if count == 4_096 { "few" } else { "many" },
        primitives: count,
        points: (CELLS + 1).pow(3),
        unit: "run",
        units: 1.0,
        standings: contest.run(options.effort()),
        extra: vec![("threads", json!(options.threads)), ("triangles", json!(triangles))],
    }
}
