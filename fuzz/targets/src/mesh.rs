//! Meshes are closed manifolds, and have the same bits on every engine.

use jbt::mesh::{Sides, check_manifold, is_closed};
use jbt::{
    Box3, CheckedTree, Classified as _, Compiler, Engine, ErrorKind, Fineness, Polygonize, Polygonized,
};

use crate::engines::text;
use crate::model::{ops_per_point, quick_engine, rng, small_tree};

/// Cells along the longest side, at most.
const MAX_RESOLUTION: usize = 28;
/// Uses of leaves times cells along two sides, at most: one input takes a second.
const MAX_WORK: f64 = 6e3;
/// Ops of the field, times points, that the scalar engine is asked for: it does some 60 million a second.
const MAX_SCALAR_OPS: u64 = 50_000_000;
/// How many times as long a gradient takes as the field.
const GRADIENT: u64 = 4;

/// Meshes the model that bytes mean, in its own box or in one that may cut it.
pub(crate) fn run(bytes: &[u8]) {
    let Some(tree) = small_tree(bytes) else { return };
    let mut rng = rng(bytes);
    let uses = jbt::statistics::leaf_uses(&tree).max(1);
    let engine = quick_engine(&mut rng, &tree, &[Engine::Lanes, Engine::Scalar]);
    let slowness = if engine == Engine::Scalar { 10.0 } else { 1.0 };
    let affordable = (MAX_WORK / (uses as f64 * slowness)).sqrt() as usize;
    let region = rng.bool().then(|| {
        let half = [1.5, 0.7, 40.0][rng.usize(0..3)];
        Box3::new([-half; 3], [half; 3])
    });
    let polygonize = Polygonize {
        region,
        fineness: Fineness::Resolution(1 + rng.usize(0..MAX_RESOLUTION.min(affordable.max(1)))),
        verify: true,
        thin_parts: rng.bool(),
        sharp: true,
    };
    let Some(made) = mesh(&polygonize, Engine::Jit, &tree) else { return };
    let (vertices, triangles) = (made.mesh.positions.len(), &made.mesh.triangles);
    if made.report.cut_sides.any() {
        assert!(region.is_some() || made.report.cut_sides != Sides::default(), "{}", text(bytes));
    } else {
        assert!(made.report.closed && is_closed(vertices, triangles), "it is open\n{}", text(bytes));
        assert_eq!(check_manifold(vertices, triangles), Ok(()), "{}", text(bytes));
    }
    // A curve is one use of a leaf, and may have as many ops as a hundred others.
    let report = &made.report;
    let points = report.field_evaluations
        + report.jump_evaluations
        + GRADIENT * (report.gradient_evaluations + report.full_evaluations);
    let is_long = engine == Engine::Scalar && points.saturating_mul(ops_per_point(&tree)) > MAX_SCALAR_OPS;
    let engine = if is_long { Engine::Lanes } else { engine };
    if let Some(other) = mesh(&polygonize, engine, &tree) {
        assert!(bits(&made) == bits(&other), "another mesh by {}\n{}", engine.name(), text(bytes));
    }
}

/// Positions, normals and triangles.
fn bits(made: &Polygonized) -> [Vec<[u32; 3]>; 3] {
    let of = |vectors: &[[f32; 3]]| vectors.iter().map(|vector| vector.map(f32::to_bits)).collect();
    [of(&made.mesh.positions), of(&made.mesh.normals), made.mesh.triangles.clone()]
}

/// None for models without a mesh.
fn mesh(polygonize: &Polygonize, engine: Engine, tree: &CheckedTree) -> Option<Polygonized> {
    match polygonize.mesh(&Compiler::for_engine(engine), tree).run() {
        Ok(made) => Some(made),
        Err(error) => {
            let is_defect = matches!(error.kind(), ErrorKind::Internal);
            assert!(!is_defect, "{error}");
            None
        }
    }
}
