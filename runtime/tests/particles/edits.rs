//! Edits of particles: new numbers compile nothing, and a live mesh follows them.

use jbt::build::{param, particles};
use jbt::{Compiler, Fineness, LiveMesh, Model, Polygonize, Tree};

/// Particles on a grid, of which one has moved.
fn grid(moved: usize, by: f32) -> Tree {
    let mut at: Vec<[f32; 3]> = (0..216).map(|i| [i % 6, i / 6 % 6, i / 36].map(|x| x as f32)).collect();
    at[moved][0] += by;
    particles(at, 0.9).colors((0..648).map(|i| (i % 7) as f32 / 6.0).collect::<Vec<f32>>())
}

fn settings() -> Polygonize {
    Polygonize { fineness: Fineness::Cell(0.25), thin_parts: false, ..Polygonize::default() }
}

#[test]
fn a_moved_particle_changes_its_surroundings_alone() {
    let compiler = Compiler::new();
    let mut live = LiveMesh::new(&compiler, &Model::new(grid(0, 0.0)), settings()).run().unwrap();
    let bricks = live.bricks().count();
    for (moved, by) in [(43, 0.2), (43, -0.1), (215, 0.3), (0, -0.2)] {
        let kernels = compiler.counters().kernels;
        let edited = Model::new(grid(moved, by));
        let change = live.replace(&edited).run().unwrap();
        assert_eq!(compiler.counters().kernels, kernels, "nothing is compiled");
        let written = change.changed.len() + change.added.len() + change.removed.len();
        assert!(0 < written && written < bricks / 2, "{written} of {bricks} bricks");
        let fresh = Compiler::new().compile(live.tree());
        let full = settings().over(&fresh, live.lattice()).run().unwrap().mesh;
        let compact = live.compact();
        assert_eq!((compact.positions.len(), &compact.triangles), (full.positions.len(), &full.triangles));
        let bits =
            |places: &[[f32; 3]]| places.as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&compact.positions), bits(&full.positions));
    }
}

#[test]
fn one_radius_for_all_may_follow_a_parameter() {
    let tree = |size: f64| {
        particles([[0.0_f32; 3], [1.0, 0.0, 0.0]], param("size", size) * 2.0).strength(param("power", 1.0))
    };
    let compiler = Compiler::new();
    let compiled = compiler.compile(&Model::new(tree(0.5)).check().unwrap());
    let mesh = |compiled: &jbt::Compiled| settings().with(compiled).run().unwrap().mesh;
    let small = mesh(&compiled);
    let kernels = compiler.counters().kernels;
    let set = compiled.tree().with_parameters(&[("size", 0.75), ("power", 2.0)]).unwrap();
    let large = mesh(&compiled.updated(&set));
    assert_eq!(compiler.counters().kernels, kernels, "nothing is compiled");
    let again = Model::new(particles([[0.0_f32; 3], [1.0, 0.0, 0.0]], 1.5).strength(2.0)).check().unwrap();
    assert_eq!(set.support(), again.support());
    assert!(large.positions.len() > small.positions.len());
    let wrong = compiled.tree().with_parameters(&[("size", -1.0)]).unwrap_err();
    assert_eq!(wrong[0].message, "the radius is -2");
}
