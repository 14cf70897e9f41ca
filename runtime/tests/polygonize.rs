//! Meshes of models: vertices are on the surface, also at creases, and every engine makes the same mesh.

use jbt::text::{Options, parse};
use jbt::{CheckedTree, Compiler, Engine, Evaluator, Fineness, Points, Polygonize, Query};

fn tree(text: &str) -> CheckedTree {
    parse(text.as_bytes(), &Options::default()).expect("it reads").check().expect("it is a good model")
}

/// A ball without a thin capsule: the gradient jumps where the capsule leaves the ball.
const CREASE: &str = "jbt 1 difference {
    point { at (0 0 0.62) radius 1.1 falloff wyvill }
    segment { from (0.52 -0.12 0.47) to (0.52 0.12 0.47) radius 0.16 }
}";

#[test]
fn vertices_at_creases_are_on_the_surface() {
    let tree = tree(CREASE);
    let evaluator = Evaluator::compile(&tree, Query::GRADIENT).expect("it compiles");
    for resolution in [60, 110, 150, 170] {
        let polygonize = Polygonize { fineness: Fineness::Resolution(resolution), ..Polygonize::default() };
        let made = polygonize.run(&Compiler::new(), &tree, &mut |_| true).expect("it has a surface");
        assert!(made.report.closed);
        let points: Points = made.mesh.positions.iter().copied().collect();
        let mut samples = evaluator.samples();
        evaluator.eval(&points, &mut samples).expect("the buffers fit");
        let gradient = samples.gradient().expect("asked for");
        let mut worst = 0.0f32;
        for (index, field) in samples.field().iter().enumerate() {
            let steep = gradient.iter().map(|plane| plane[index].powi(2)).sum::<f32>().sqrt();
            worst = worst.max((field - 0.5).abs() / steep / made.lattice.spacing() as f32);
        }
        assert!(worst < 0.01, "{worst} cells from the surface at resolution {resolution}");
    }
}

#[test]
fn every_engine_makes_the_same_mesh() {
    let tree = tree(CREASE);
    let polygonize = Polygonize { fineness: Fineness::Resolution(30), ..Polygonize::default() };
    let mesh = |engine| {
        polygonize.run(&Compiler::for_engine(engine), &tree, &mut |_| true).expect("it has a surface").mesh
    };
    let reference = mesh(Engine::Scalar);
    assert!(!reference.triangles.is_empty());
    for engine in [Engine::Lanes, Engine::Jit] {
        assert!(mesh(engine) == reference, "{}", engine.name());
    }
}
