//! Joined blocks are the mesh that is made at once.

use jbt::mesh::{BlockError, MeshBlock, join_blocks};
use jbt::{Box3, CheckedTree, Compiler, Polygonize, PolygonizeError};
use jbt_testkit::scene::tree;

use crate::{bits, blocks, settings};

/// Compares; returns the blocks.
fn check(name: &str, tree: &CheckedTree, settings: &Polygonize, edge: usize) -> Vec<MeshBlock> {
    let compiled = Compiler::new().compile(tree);
    let whole = settings.with(&compiled).run().unwrap_or_else(|error| panic!("{name}: {error}"));
    let (lattice, all) = blocks(settings, tree, edge);
    let busy = settings.busy_blocks(&compiled, &lattice, edge).run().expect("ranges are told");
    let mut made: Vec<MeshBlock> = Vec::new();
    for block in all {
        let one = settings.block(&compiled, &lattice, block).run().expect("the block is meshed");
        let is_busy = busy.iter().any(|work| work.place == block.place());
        assert!(is_busy || one.mesh.triangles.is_empty(), "{name}: ranges miss {:?}", block.place());
        made.push(one);
    }
    // In any order.
    made.reverse();
    let joined = join_blocks(&made).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(joined.positions.len(), whole.mesh.positions.len(), "{name}");
    assert!(bits(&joined) == bits(&whole.mesh), "{name}: other bits");
    assert_eq!(joined, whole.mesh, "{name}");
    assert_eq!(made.iter().all(|block| !block.is_open), whole.report.closed, "{name}");
    made
}

#[test]
fn examples() {
    for name in ["hero", "peanut", "mood", "koi"] {
        let path = format!("{}/../examples/{name}.jbt", env!("CARGO_MANIFEST_DIR"));
        let Ok(scene) = jbt::Scene::load(&path) else { continue };
        let made = check(name, &scene.check().unwrap(), &settings(None, 100), 32);
        assert!(made.len() > 8, "{name}: {} blocks", made.len());
    }
}

/// A region cuts the surface: sides of the lattice lie in blocks, and at their ends.
#[test]
fn what_leaves_the_region_is_open() {
    let tree = tree("point { surface_radius 1 }");
    for side in [0.7, 0.9] {
        let region = Box3::new([-side; 3], [0.64, 0.8, 1.2]);
        let made = check("cut", &tree, &settings(Some(region), 96), 32);
        assert!(made.iter().any(|block| block.is_open && block.cut_sides.any()));
    }
}

/// Noise as fine as cells: nearly every cell is crossed, faces are ambiguous, and chains of them are long.
#[test]
fn noise() {
    let text = "expression within (-1 -1 -1) to (1 1 1) { sin(61 * x + 3 * sin(47 * y)) * sin(53 * y + z) * sin(59 * z + 40 * x) + 0.5 }";
    let tree = tree(text);
    let made = check("noise", &tree, &settings(Some(Box3::new([-1.0; 3], [1.0; 3])), 44), 32);
    assert!(made.iter().map(|block| block.below.len()).sum::<usize>() > 1000);
}

/// Walls, creases and doubtful normals at seams.
#[test]
fn walls_and_creases() {
    let text = "union { within (-0.6 -0.6 -0.6) to (0.7 0.6 0.6) { point { radius 2 } } \
                difference { point { at (0.5 0.4 0.3) surface_radius 0.8 } segment { from (-2 0 0) to (2 0.5 0) radius 0.7 } } }";
    check("walls", &tree(text), &settings(None, 90), 32);
}

/// Many small turned cubes: vertices on edges go back where triangles are folded, at seams too.
#[test]
fn turned_cubes() {
    let mut random = fastrand::Rng::with_seed(7);
    let mut cube = || {
        let [x, y, z] = [0; 3].map(|_| 4.0 * random.f64() - 2.0);
        let [a, b, c] = [0; 3].map(|_| 2.0 * random.f64() - 1.0);
        format!(
            "translate ({x} {y} {z}) {{ rotate axis ({a} {b} {c}) degrees {} {{
            expression within (-0.4 -0.4 -0.4) to (0.4 0.4 0.4) {{ 0.5 + 0.2 - max(abs(x), abs(y), abs(z)) }} }} }}",
            180.0 * random.f64()
        )
    };
    let cubes: Vec<String> = (0..150).map(|_| cube()).collect();
    let text = format!("jbt 1 union {{ {} }}", cubes.join(" "));
    check("cubes", &tree(&text), &settings(None, 80), 32);
}

/// The mesh of parts is one of several fields.
#[test]
fn blocks_are_of_one_solid() {
    let tree = tree(
        r#"part "a" { point { surface_radius 1 } } part "b" { point { at (1.5 0 0) surface_radius 1 } }"#,
    );
    let (settings, compiled) = (settings(None, 40), Compiler::new().compile(&tree));
    let (lattice, all) = blocks(&settings, &tree, 32);
    let busy = settings.busy_blocks(&compiled, &lattice, 32).run();
    assert!(matches!(busy, Err(PolygonizeError::Parts)), "{busy:?}");
    let block = settings.block(&compiled, &lattice, all[0]).run();
    assert!(matches!(block, Err(PolygonizeError::Parts)));
}

#[test]
fn a_missing_block_is_named() {
    let tree = tree("point { surface_radius 1 }");
    let mut made = check("ball", &tree, &settings(None, 60), 32);
    made.retain(|block| block.place != [0, 0, 0]);
    assert!(matches!(join_blocks(&made), Err(BlockError::Missing { .. })));
    let twice = [made[0].clone(), made[0].clone()];
    assert!(matches!(join_blocks(&twice), Err(BlockError::Twice { .. })));
    made[0].mesh.triangles[0][0] = u32::MAX;
    assert!(matches!(join_blocks(&made), Err(BlockError::Broken { .. })));
}
