//! Samples on lattices: the bits of any other way to ask, and limits that are named before memory is taken.

use jbt::mesh::Lattice;
use jbt::sample::{SampleError, Sampler, Wanted};
use jbt::{CancelToken, CheckedTree, Compiler, Engine, Points, Query};
use jbt_testkit::bits::bits;
use jbt_testkit::scene::tree;

/// Two coloured balls and a twisted bar, far from each other.
fn scene() -> CheckedTree {
    tree(
        "jbt 1 sum {
            color (1 0 0) { point { at (-2 0 0) radius 0.7 } }
            color (0 1 0) { translate (2 0.5 0) { point { radius 0.5 strength -0.4 } } }
            twist axis z rate 2 { segment { from (0 0 -1) to (0.4 0 1) radius 0.4 } }
        }",
    )
}

/// A formula in a box, and a ball away from it: no distance is evaluated in the box.
fn formula() -> CheckedTree {
    tree(
        "jbt 1 union {
            color (0 0 1) { expression within (-1 -1 -1) to (1 1 1) { 0.5 + sin(4 * x) * cos(3 * y) - abs(z) } }
            color (1 0 0) { point { at (2 0 0) radius 0.7 } }
        }",
    )
}

fn lattice() -> Lattice {
    Lattice::covering([-3.0, -1.5, -1.5], [3.0, 1.5, 1.6], 0.06).unwrap()
}

/// The answers at all points, asked without a lattice.
fn expected(sampler: &Sampler, lattice: &Lattice) -> Vec<Vec<f32>> {
    let [nx, ny, nz] = lattice.points();
    let at = |x, y, z| [lattice.coordinate(0, x), lattice.coordinate(1, y), lattice.coordinate(2, z)];
    let all = (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| (x, y, z))));
    let points: Points = all.map(|(x, y, z)| at(x, y, z)).collect();
    let mut samples = sampler.evaluator().samples();
    sampler.evaluator().eval(&points, &mut samples).unwrap();
    samples.planes().to_vec()
}

#[test]
fn dense_samples_have_the_bits_of_points() {
    let tree = scene();
    for query in Query::EVERY {
        let sampler = Sampler::new(&Compiler::for_engine(Engine::Lanes), &tree, query).unwrap();
        let lattice = lattice();
        let dense = sampler.dense(&lattice).run().unwrap();
        let done = sampler.evaluator().counters();
        assert!(done.points < lattice.point_count(), "constant blocks take one point");
        assert!(done.evaluations_pruned > done.primitive_evaluations);
        assert_eq!(bits(&dense), bits(expected(&sampler, &lattice)), "{}", query.name());
    }
}

#[test]
fn a_formula_is_not_constant_where_no_primitive_is() {
    for query in Query::EVERY {
        let sampler = Sampler::new(&Compiler::for_engine(Engine::Lanes), &formula(), query).unwrap();
        let dense = sampler.dense(&lattice()).run().unwrap();
        assert_eq!(bits(&dense), bits(expected(&sampler, &lattice())), "{}", query.name());
    }
}

#[test]
fn sparse_blocks_are_where_they_are_wanted() {
    [scene(), formula()].iter().for_each(check_sparse_blocks);
}

fn check_sparse_blocks(tree: &CheckedTree) {
    let sampler = Sampler::new(&Compiler::for_engine(Engine::Lanes), tree, Query::FIELD).unwrap();
    let lattice = lattice();
    let dense = sampler.dense(&lattice).run().unwrap();
    let [nx, ny, _] = lattice.points();
    let iso = tree.iso() as f32;
    let blocks = |wanted| sampler.blocks(&lattice, wanted).run().unwrap();
    let mut counts = Vec::new();
    for wanted in [Wanted::Everywhere, Wanted::Support, Wanted::Surface(iso)] {
        let mut seen = vec![false; dense[0].len()];
        for block in blocks(wanted) {
            let ([x, y, z], [mx, my, mz]) = (block.first(), block.points());
            for (k, j, i) in (0..mz).flat_map(|k| (0..my).flat_map(move |j| (0..mx).map(move |i| (k, j, i))))
            {
                let index = ((z + k) * ny + y + j) * nx + x + i;
                assert!(!std::mem::replace(&mut seen[index], true), "no point is in two blocks");
                assert_eq!(block.get(0, [i, j, k]).to_bits(), dense[0][index].to_bits());
            }
        }
        // What is left out is what was not wanted.
        let left_out = |index: usize| match wanted {
            Wanted::Everywhere => false,
            Wanted::Support => dense[0][index] == 0.0,
            Wanted::Surface(_) => true,
        };
        assert!((0..seen.len()).all(|index| seen[index] || left_out(index)), "{wanted:?}");
        counts.push(seen.iter().filter(|&&seen| seen).count());
    }
    assert_eq!(counts[0], dense[0].len());
    assert!(counts[1] < counts[0] && counts[2] < counts[1], "{counts:?}");
}

#[test]
fn any_number_of_threads_samples_alike() {
    let tree = scene();
    let sampler = Sampler::new(&Compiler::for_engine(Engine::Lanes), &tree, Query::ALL).unwrap();
    let [one, five] = [1, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sampler.dense(&lattice()).run().unwrap())
    });
    assert_eq!(bits(&one), bits(&five));
}

#[test]
fn too_many_numbers_are_refused_before_memory_is_taken() {
    let tree = scene();
    let compiler = Compiler::for_engine(Engine::Scalar);
    let huge = Lattice::new([-3.0; 3], 0.001, [4096; 3]).unwrap();
    let sampler = Sampler::new(&compiler, &tree, Query::FIELD).unwrap();
    let error = sampler.dense(&huge).run().unwrap_err();
    assert!(matches!(error, SampleError::TooMany { points: 68_769_820_673, planes: 1 }), "{error}");
    // As many points as there may be numbers are too many for two answers.
    let sampler = Sampler::new(&compiler, &tree, Query::GRADIENT).unwrap();
    let large = Lattice::new([-3.0; 3], 0.005, [1023; 3]).unwrap();
    assert!(matches!(sampler.dense(&large).run(), Err(SampleError::TooMany { planes: 4, .. })));
    let token = CancelToken::new();
    token.cancel();
    let mut calls = 0;
    let cancelled = sampler.dense(&lattice()).on_progress(|_| calls += 1).cancel(&token).run();
    assert!(matches!(cancelled, Err(SampleError::Cancelled)));
    assert_eq!(calls, 1);
}
