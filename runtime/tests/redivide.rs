//! Division of edited models: only where something has changed is it decided again.

use jbt::boxes::Divisible;
use jbt::divide::{Cell, Decision, Division, Edit, Limits, divide};
use jbt::prune::Region;
use jbt::{Box3, Compiler, Engine, EvalError, Model, Pruner};
use jbt_model::tree::Tree;

/// Centres and radii of many small blobs in [-1, 1]^3.
fn blobs(count: usize) -> Vec<([f64; 3], f64)> {
    let mut rng = fastrand::Rng::with_seed(4);
    let size = 1.6 * (count as f64).powf(-1.0 / 3.0);
    let blob = |_| (std::array::from_fn(|_| 1.8 * rng.f64() - 0.9), size * (0.5 + rng.f64()));
    (0..count).map(blob).collect()
}

fn pruner(compiler: &Compiler, blobs: &[([f64; 3], f64)]) -> Pruner {
    let leaves = blobs.iter().map(|&(at, radius)| jbt::build::point(at, radius));
    let model = Model::new(Tree::sum(leaves));
    Pruner::new(compiler, &model.check().expect("a good model")).expect("it compiles")
}

/// Octants down to boxes of 1/16, where the surface may be.
fn surface(cell: &Cell<'_, Pruner>, (): &()) -> Result<Decision<()>, EvalError> {
    let bounds = cell.bounds();
    if cell.depth() > 2 {
        let [low, high] = cell.range()?;
        if low >= 0.5 || high < 0.5 {
            return Ok(Decision::Stop);
        }
    }
    if cell.depth() == 5 {
        return Ok(Decision::Leaf);
    }
    Ok(Decision::Octants { at: [0, 1, 2].map(|axis| bounds.middle(axis)), data: [(); 8] })
}

const WHOLE: Box3 = Box3::new([-1.0; 3], [1.0; 3]);

fn divided(pruner: &Pruner) -> Division<Region, ()> {
    divide(pruner, WHOLE, (), &Limits::default(), &surface).expect("it can be divided")
}

/// The division of an edited model, which has to be that of a new one.
fn redivided(before: &Division<Region, ()>, old: &Pruner, new: &Pruner) -> Division<Region, ()> {
    let edit = new.edit(old);
    assert_ne!(edit, Edit::Everywhere);
    let renew = |region: &Region| new.renewed(old, region);
    let again = before.redivide(new, &edit, &renew, &Limits::default(), &surface).expect("it can be divided");
    let fresh = divided(new);
    assert_eq!(again.nodes(), fresh.nodes());
    for ((_, again), (node, fresh)) in again.leaves().zip(fresh.leaves()) {
        assert_eq!(again.selection(), fresh.selection(), "{:?}", node.bounds);
    }
    again
}

#[test]
fn one_of_many_blobs() {
    let compiler = Compiler::for_engine(Engine::Lanes);
    let mut blobs = blobs(4096);
    let old = pruner(&compiler, &blobs);
    let before = divided(&old);
    assert!(before.decisions() > 8_000, "{} decisions", before.decisions());

    let same = pruner(&compiler, &blobs);
    assert_eq!(redivided(&before, &old, &same).decisions(), 0, "nothing has changed");

    blobs[1234].0[0] += 0.02;
    let moved = pruner(&compiler, &blobs);
    let again = redivided(&before, &old, &moved);
    assert!(again.decisions() > 0);
    assert!(again.decisions() * 20 < before.decisions(), "{} of {}", again.decisions(), before.decisions());

    // Rows that come and go move the numbers of others.
    let gone = blobs.remove(100);
    let fewer = pruner(&compiler, &blobs);
    let without = redivided(&again, &moved, &fewer);
    assert!(without.decisions() * 20 < before.decisions());
    blobs.insert(2000, gone);
    let more = pruner(&compiler, &blobs);
    let with = redivided(&without, &fewer, &more);
    assert!(with.decisions() * 20 < before.decisions());
}

#[test]
fn a_model_of_another_shape_is_divided_anew() {
    let compiler = Compiler::for_engine(Engine::Lanes);
    let old = pruner(&compiler, &blobs(10));
    let segment = jbt::build::segment([0.0; 3], [0.5, 0.0, 0.0], 0.4);
    let new = Pruner::new(&compiler, &Model::new(segment).check().unwrap()).unwrap();
    assert_eq!(new.edit(&old), Edit::Everywhere);
    let region = new.region(WHOLE).unwrap();
    assert_eq!(region.rows(), new.everywhere().rows());
}
