//! Skeletons of any number of points: many of them are one fold in a fold, pieces out of reach are left out,
//! and gradients have no facets.

mod common;

use common::answers;
use fastrand::Rng;
use jbt::boxes::Divisible;
use jbt::build::{bezier, catmull_rom, polygon, polyline};
use jbt::divide::Edit;
use jbt::{Box3, Compiler, Engine, Model, Points, Pruner, Query, Tree, Update};
use jbt_testkit::bits::bits;

fn positions(rng: &mut Rng, count: usize, around: [f64; 3], size: f64) -> Vec<[f64; 3]> {
    (0..count).map(|_| around.map(|x| x + size * (2.0 * rng.f64() - 1.0))).collect()
}

/// A sum of polylines with 2 to 13 points.
fn lines(count: usize, seed: u64) -> Model {
    let mut rng = Rng::with_seed(seed);
    let line = |_| {
        let around = positions(&mut rng, 1, [0.0; 3], 2.0)[0];
        let points = rng.usize(2..14);
        let radii: Vec<f64> = (0..points).map(|_| 0.05 * rng.f64()).collect();
        polyline(positions(&mut rng, points, around, 0.3), 0.2).radii(radii)
    };
    Model::new(Tree::sum((0..count).map(line)))
}

fn points(seed: u64, count: usize, size: f32) -> Points {
    let mut rng = Rng::with_seed(seed);
    (0..count).map(|_| [0; 3].map(|_: i32| size * (2.0 * rng.f32() - 1.0))).collect()
}

#[test]
fn a_thousand_lines_are_one_fold_in_a_fold() {
    let tree = lines(1000, 1).check().expect("a good model");
    let points = points(2, 37, 2.0);
    let found = Engine::ALL.map(|engine| {
        let mut evaluator = Compiler::for_engine(engine)
            .evaluator(&lines(2, 3).check().expect("a good model"), Query::ALL)
            .expect("it compiles");
        assert_eq!(
            evaluator.update(&tree).expect("it compiles"),
            Update::Numbers,
            "two lines are the same code"
        );
        assert_eq!(evaluator.program().function().folds().len(), 3, "the scene, lines, pieces");
        assert_eq!(evaluator.evaluations_per_point(), 1000, "a line is evaluated once, however long it is");
        answers(&evaluator, &points)
    });
    for samples in &found[1..] {
        assert_eq!(bits(found[0].planes()), bits(samples.planes()));
    }
}

#[test]
fn pieces_out_of_reach_are_left_out() {
    let mut rng = Rng::with_seed(5);
    let coil: Vec<[f64; 3]> = (0..700)
        .map(|i| {
            let angle = 0.05 * f64::from(i);
            [angle.cos(), angle.sin(), 0.1 * angle - 1.7]
        })
        .collect();
    let bow = polygon([[0.0; 3], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]], 0.3);
    let models = [
        Model::new(polyline(coil.clone(), 0.1).radii([0.02])),
        Model::new(catmull_rom(coil.into_iter().step_by(10), 0.1) | bow),
        Model::new(
            bezier(positions(&mut rng, 13, [0.0; 3], 1.0), 0.3)
                .rotate([1.0, 2.0, 3.0], 40.0)
                .scale_axes([1.0, 0.5, -1.0]),
        ),
        lines(100, 6),
    ];
    for (index, model) in models.iter().enumerate() {
        let tree = model.check().expect("a good model");
        let compiler = Compiler::for_engine(Engine::Lanes);
        let pruner = Pruner::new(&compiler, &tree).expect("it compiles");
        let evaluator = compiler.evaluator(&tree, Query::ALL).expect("it compiles");
        let (mut kept, mut all) = (0, 0);
        for _ in 0..200 {
            let low: [f32; 3] = std::array::from_fn(|_| 4.0 * rng.f32() - 2.0);
            let bounds = Box3::new(low, low.map(|side| side + 0.2 * rng.f32()));
            let region = pruner.region(bounds).expect("the box is proper");
            let inside: Points = (0..20)
                .map(|_| {
                    let mut at =
                        |axis: usize| bounds.low[axis] + rng.f32() * (bounds.high[axis] - bounds.low[axis]);
                    [at(0), at(1), at(2)]
                })
                .collect();
            let expected = answers(&evaluator, &inside);
            let mut planes = vec![vec![f32::NAN; inside.len()]; expected.planes().len()];
            let mut buffers: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
            evaluator.eval_region(&region, inside.planes(), &mut buffers).expect("the buffers fit");
            let found: Vec<Vec<u32>> =
                planes.iter().map(|plane| plane.iter().map(|x| x.to_bits()).collect()).collect();
            assert_eq!(found, bits(expected.planes()), "model {index} in {bounds:?}");
            kept += region.rows();
            all += pruner.everywhere().rows();
        }
        assert!(kept * 5 < all, "model {index}: {kept} of {all} rows stay");
    }
}

#[test]
fn a_point_that_moves_is_an_edit_near_its_pieces() {
    let line = |height: f64, count: u32| {
        // The middle of the pose, which is a number of the leaf, stays.
        let bump = |x| [(0, -2.0), (1, 2.0), (50, height)].iter().find(|at| at.0 == x).map_or(0.0, |at| at.1);
        let at = |x: u32| [f64::from(x), bump(x), 0.0];
        Model::new(polyline((0..count).map(at), 0.5)).check().expect("a good model")
    };
    let compiler = Compiler::for_engine(Engine::Lanes);
    let old = Pruner::new(&compiler, &line(0.0, 100)).expect("it compiles");
    let new = old.updated(&line(1.0, 100)).expect("it compiles");
    let edit = new.edit(&old);
    assert!(edit.touches(&Box3::new([50.0, 0.0, 0.0], [50.0, 0.0, 0.0])), "{edit:?}");
    assert!(!edit.touches(&Box3::new([0.0, -2.0, -1.0], [48.0, 2.0, 1.0])), "{edit:?}");
    assert_ne!(edit, Edit::Everywhere);
    // A piece more moves the middle of the pose, which the row of the leaf holds.
    let longer = old.updated(&line(0.0, 101)).expect("it compiles");
    assert!(longer.edit(&old).touches(&Box3::new([99.9, 0.0, 0.0], [100.1, 0.0, 0.0])));
}

/// Along a smooth curve the gradient turns as the normal does: the angle between them is small everywhere.
#[test]
fn the_gradient_of_a_curve_has_no_facets() {
    let through: Vec<[f64; 3]> = (0..9)
        .map(|i| {
            let angle = 0.7 * f64::from(i);
            [angle.cos(), angle.sin(), 0.2 * angle]
        })
        .collect();
    let radius = 0.6;
    for radii in [vec![], vec![0.1], (0..9).map(|i| 0.05 + 0.02 * f64::from(i % 3)).collect::<Vec<f64>>()] {
        let model = Model::new(catmull_rom(through.clone(), radius).radii(radii));
        let tree = model.check().expect("a good model");
        let evaluator =
            Compiler::for_engine(Engine::Lanes).evaluator(&tree, Query::ALL).expect("it compiles");
        let points: Points = (0..4000)
            .map(|i| {
                // Around the middle of the curve, beside it.
                let angle = 0.7 + 4.0 * i as f32 / 4000.0;
                let beside = 1.25 + 0.1 * (0.01 * i as f32).sin();
                [beside * angle.cos(), beside * angle.sin(), 0.2 * angle + 0.1]
            })
            .collect();
        let samples = answers(&evaluator, &points);
        let planes = samples.gradient().expect("asked for");
        let (mut worst, mut off, mut compared) = (0.0_f64, 0, 0);
        for index in 0..points.len() {
            let p = points.get(index).map(f64::from);
            let gradient = glam::DVec3::from(planes.map(|plane| f64::from(plane[index])));
            let normal = glam::DVec3::from(jbt::walk::walk_gradient(&tree, p, 1e-5));
            if normal.length() > 0.1 {
                let angle = gradient.angle_between(normal);
                worst = worst.max(angle);
                off += u32::from(angle > 5e-5);
                compared += 1;
            }
        }
        assert!(compared > 3000, "{compared}");
        // Where two pieces meet, the rounding of their distances decides between places that are as far apart
        // as its root.
        assert!(
            worst < 1e-3 && off * 1000 < compared,
            "off by {worst} radians, {off} of {compared} by more than 5e-5"
        );
    }
}
