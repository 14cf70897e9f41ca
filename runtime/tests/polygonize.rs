//! Meshes of models: vertices are on the surface, also at creases, and every engine makes the same mesh.

mod common;

use common::answers;
use jbt::solid::RegionError;
use jbt::{Box3, Compiler, Engine, Evaluator, Fineness, Points, Polygonize, PolygonizeError, Query, Solid};
use jbt_testkit::scene::tree;

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
        let made = polygonize.mesh(&Compiler::new(), &tree).run().expect("it has a surface");
        assert!(made.report.closed);
        let points: Points = made.mesh.positions.iter().copied().collect();
        let samples = answers(&evaluator, &points);
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
    let mesh =
        |engine| polygonize.mesh(&Compiler::for_engine(engine), &tree).run().expect("it has a surface").mesh;
    let reference = mesh(Engine::Scalar);
    assert!(!reference.triangles.is_empty());
    for engine in [Engine::Lanes, Engine::Jit] {
        assert!(mesh(engine) == reference, "{}", engine.name());
    }
}

/// A half space by itself needs a region, and has a surface in it that is open at the region's sides.
#[test]
fn what_is_unbounded_needs_a_region() {
    let half = "half_space { at (0 0 0.25) normal (1 0 2) radius 1 }";
    let alone = tree(&format!("jbt 1 {half}"));
    let polygonize = Polygonize { fineness: Fineness::Resolution(24), ..Polygonize::default() };
    let error = polygonize.mesh(&Compiler::new(), &alone).run().map(|_| ()).expect_err("no region");
    assert!(matches!(error, PolygonizeError::Unbounded), "{error}");
    assert_eq!(error.to_string(), "the model is unbounded: its mesh needs a region");
    let solid = Solid::new(&Compiler::new(), &alone).expect("it compiles");
    let error = solid.tight_bounds(None, 0.01).expect_err("no region");
    assert_eq!(error.to_string(), RegionError::Unbounded.to_string());

    let region = Polygonize { region: Some(Box3::new([-1.0; 3], [1.0; 3])), ..polygonize };
    let made = region.mesh(&Compiler::new(), &alone).run().expect("it has a surface there");
    assert!(!made.report.closed && made.mesh.triangles.len() > 500);
    for &[x, _, z] in &made.mesh.positions {
        // Half the radius from the plane.
        let distance = (x + 2.0 * (z - 0.25)) / 5f32.sqrt();
        assert!((distance - 0.5).abs() < 1e-4, "{distance}");
    }
    let cut = tree(&format!("jbt 1 intersection {{ {half} point {{ radius 1 }} }}"));
    let made = polygonize.mesh(&Compiler::new(), &cut).run().expect("it is bounded");
    assert!(made.report.closed);
}
