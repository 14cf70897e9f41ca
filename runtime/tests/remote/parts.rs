//! A part from shape and rows has the bits of the whole, in every block of many models.

use std::sync::atomic::{AtomicU64, Ordering};

use jbt::mesh::{LatticeBlock, MeshError};
use jbt::remote::{ModelRows, ModelShape, RemoteError, RowSource, from_rows};
use jbt::sample::Sampler;
use jbt::tree::WeightOf;
use jbt::{Box3, Compiler, Engine, Evaluator, Fineness, Model, Points, Polygonize, PolygonizeError, Query};
use jbt_testkit::random::Random;
use jbt_testkit::scene::{count, tree};
use jbt_testkit::skip::short_or_long;
use rayon::prelude::*;

use crate::{blocks, settings};

/// Random models: of a run in short, and of one at length.
const SHAPES: [u64; 2] = [25, 200];

#[derive(Default)]
struct Tally {
    blocks: AtomicU64,
    vertices: AtomicU64,
    rows: AtomicU64,
    kept: AtomicU64,
}

/// All blocks, their meshes, and the answers to every query at points of them.
#[test]
fn every_block_of_random_models_has_the_bits_of_the_whole() {
    let shapes = count("JBT_REMOTE_SHAPES", short_or_long(SHAPES));
    let tally = Tally::default();
    (0..shapes).into_par_iter().for_each(|shape| {
        let leaves = 1 + (shape % 29) as usize;
        let model = Random::new(shape, shape ^ 0x0a_7000).model(leaves);
        let engine = if shape % 8 == 0 { Engine::Jit } else { Engine::Lanes };
        try_model(&format!("shape {shape}"), &model, engine, &tally);
    });
    let Tally { blocks, vertices, rows, kept } = tally;
    let [blocks, vertices, rows, kept] = [blocks, vertices, rows, kept].map(AtomicU64::into_inner);
    assert!(blocks >= 8 * shapes && vertices > 100 * blocks / 8, "{blocks} blocks, {vertices} vertices");
    assert!(kept < rows, "some rows do not reach some blocks: {kept} of {rows}");
}

fn try_model(name: &str, model: &Model, engine: Engine, tally: &Tally) {
    let tree = model.check().expect("a random model is a good model");
    let settings = settings(Some(Box3::new([-3.0; 3], [3.1, 2.9, 3.0])), 44);
    let compiled = Compiler::for_engine(engine).compile(&tree);
    let source = RowSource::new(&compiled, &Query::EVERY).expect("the model lowers");
    let shape = ModelShape::from_bytes(source.shape().bytes()).expect("a shape reads back");
    assert_eq!(shape, *source.shape(), "{name}");
    let far = compiled.pruner().expect("the model compiles").everywhere().rows();
    let (lattice, all) = blocks(&settings, &tree, 32);
    let elsewhere = Compiler::for_engine(engine);
    for block in all {
        let mut reach = LatticeBlock::REACH;
        let (part, mine) = loop {
            let rows = source.rows(block.bounds(&lattice, reach)).expect("the box is proper");
            let read = ModelRows::from_bytes(&rows.to_bytes()).expect("rows read back");
            let part = from_rows(&elsewhere, &shape, &read).expect("the rows fit");
            tally.kept.fetch_add(rows.len() as u64, Ordering::Relaxed);
            let made = part.block(&lattice, block, reach).expect("the rows reach").run();
            match made {
                Err(PolygonizeError::Mesh(MeshError::Reach { .. })) => reach *= 4,
                made => break (part, made.expect("the block is meshed")),
            }
        };
        let whole = settings.block(&compiled, &lattice, block).run().expect("the block is meshed");
        assert!(mine.to_bytes() == whole.to_bytes(), "{name}: block {:?} has other bits", block.place());
        let [first, end] = block.cells(&lattice, 0);
        // Some of them: every query is asked in each block.
        let cells = [0, 1, 2].map(|axis| (end[axis] - first[axis]).min(9));
        let points = lattice.part(first, cells).expect("cells of the lattice");
        for query in Query::EVERY {
            let sampler = part.sampler(query).expect("the shape has it");
            let answers = part.dense(&sampler, &points).expect("it is within").run().expect("it is sampled");
            let expected = Sampler::of(&compiled, query).unwrap().dense(&points).run().unwrap();
            let same = answers.iter().flatten().zip(expected.iter().flatten());
            let same = same.into_iter().all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan());
            assert!(same, "{name}: block {:?}, {}", block.place(), query.name());
        }
        tally.blocks.fetch_add(1, Ordering::Relaxed);
        tally.vertices.fetch_add(mine.mesh.positions.len() as u64, Ordering::Relaxed);
        tally.rows.fetch_add(far as u64, Ordering::Relaxed);
    }
    // Each program once, however many blocks there are.
    assert!(elsewhere.counters().kernels <= 64, "{name}: {:?}", elsewhere.counters());
}

/// Thousands of rows, most of which do not reach a block; numbers of rows ascend.
#[test]
fn rows_are_few_and_ascend() {
    let mut random = fastrand::Rng::with_seed(5);
    let places: Vec<[f64; 3]> =
        (0..20_000).map(|_| std::array::from_fn(|_| 2.0 * random.f64() - 1.0)).collect();
    let tree = Model::new(jbt::build::particles(places, vec![0.03_f64; 20_000])).check().unwrap();
    let compiled = Compiler::new().compile(&tree);
    let source = RowSource::new(&compiled, &[Query::FIELD, Query::GRADIENT, Query::SURFACE]).unwrap();
    let settings = Polygonize { fineness: Fineness::Cell(0.016), ..settings(None, 1) };
    let (lattice, all) = blocks(&settings, &tree, 64);
    let compiler = Compiler::new();
    let mut made = Vec::new();
    for &block in &all {
        let reach = LatticeBlock::REACH;
        let rows = source.rows(block.bounds(&lattice, reach)).unwrap();
        assert!(rows.len() < 12_000, "{}", rows.len());
        let table =
            (0..source.rows(block.bounds(&lattice, reach)).unwrap().len()).find(|&t| rows.whole(t).len() > 1);
        assert!(rows.whole(table.expect("particles are rows")).is_sorted_by(|a, b| a < b));
        let part = from_rows(&compiler, source.shape(), &rows).unwrap();
        made.push(part.block(&lattice, block, reach).unwrap().run().unwrap());
    }
    assert!(all.len() >= 8 && compiler.counters().kernels == 4, "{:?}", compiler.counters());
    assert_eq!(jbt::mesh::join_blocks(&made).unwrap(), settings.with(&compiled).run().unwrap().mesh);
}

#[test]
fn what_does_not_fit_is_refused() {
    let compiler = Compiler::new();
    let source = |text: &str| RowSource::new(&compiler.compile(&tree(text)), &[Query::FIELD]).unwrap();
    let (ball, box_of) = (source("point { radius 1 }"), Box3::new([-1.0; 3], [1.0; 3]));
    let other = source("segment { from (0 0 0) to (1 0 0) radius 1 }");
    let rows = ball.rows(box_of).unwrap();
    assert!(matches!(from_rows(&compiler, other.shape(), &rows), Err(RemoteError::Shape { .. })));
    let part = from_rows(&compiler, ball.shape(), &rows).unwrap();
    assert!(matches!(part.evaluator(Query::SURFACE), Err(RemoteError::Query { .. })));
    let wide = jbt::mesh::Lattice::covering([-2.0; 3], [2.0; 3], 0.5).unwrap();
    let sampler = part.sampler(Query::FIELD).unwrap();
    assert!(matches!(part.dense(&sampler, &wide), Err(RemoteError::Bounds { .. })));
}

/// Columns of weights are called after leaves, elsewhere too, and have the bits of the whole there.
#[test]
fn weights_keep_their_titles() {
    let text = "union { point { radius 1 } segment { from (1 0 0) to (2 0 0) radius 1 } }";
    let tree = tree(text).with_weights(WeightOf::Leaves).expect("two leaves have weights");
    let compiler = Compiler::for_engine(Engine::Lanes);
    let compiled = compiler.compile(&tree);
    let source = RowSource::new(&compiled, &Query::EVERY).expect("the model lowers");
    let shape = ModelShape::from_bytes(source.shape().bytes()).expect("a shape reads back");
    let bounds = Box3::new([-1.0; 3], [1.0; 3]);
    let rows = source.rows(bounds).expect("the box is proper");
    let part = from_rows(&compiler, &shape, &rows).expect("the rows fit");
    let there = part.evaluator(Query::SURFACE).expect("it was asked for");
    let here = compiled.evaluator(Query::SURFACE).expect("the model compiles");
    assert_eq!(there.layout(), here.layout());
    let names = here.layout().names();
    assert!(names.iter().any(|name| name == "weights.0.union/1.segment"), "{names:?}");
    let points = Points::from([[0.25, 0.5, 0.0], [0.5, 0.0, 0.25]]);
    let of = |evaluator: &Evaluator| {
        let mut samples = evaluator.samples();
        evaluator.eval(&points, &mut samples).expect("the buffers fit");
        samples.attribute("weights").expect("it is asked for").to_vec()
    };
    assert_eq!(of(&there), of(&here));
}
