//! Live meshes: after any edits, the mesh of a full run over their lattice.

use std::collections::BTreeMap;
use std::ops::Range;

use fastrand::Rng;
use jbt::build::{param, point, x};
use jbt::live::{BrickRanges, LiveChange};
use jbt::mesh::Mesh;
use jbt::{
    Box3, CancelToken, Classified as _, Compiler, Engine, ErrorKind, Fineness, LiveMesh, Model, Polygonize,
    PolygonizeError, Tree,
};

use jbt_testkit::skip::short_or_long;

use crate::scene::{Edited, Given, balls, bits, edit};

/// What the buffers hold, as somebody has copied it by the reports of edits alone.
#[derive(Default)]
struct Copied {
    buffers: Mesh,
    bricks: BTreeMap<[i32; 3], [Range<usize>; 2]>,
}

impl Copied {
    fn of(live: &LiveMesh) -> Self {
        let bricks = live.bricks().map(|brick| (brick.place, [brick.vertices, brick.triangles])).collect();
        Self { buffers: live.buffers().clone(), bricks }
    }

    /// Copies what an edit has written.
    fn follow(&mut self, live: &LiveMesh, change: &LiveChange) {
        let now = live.buffers();
        assert_eq!(
            change.grown,
            now.positions.len() != self.buffers.positions.len()
                || now.triangles.len() != self.buffers.triangles.len()
        );
        self.buffers.positions.resize(now.positions.len(), [0.0; 3]);
        self.buffers.normals.resize(now.positions.len(), [0.0; 3]);
        self.buffers.triangles.resize(now.triangles.len(), [0; 3]);
        if change.relaid {
            self.buffers.attributes.clone_from(&now.attributes);
        }
        for attribute in &mut self.buffers.attributes {
            attribute.values.resize(attribute.width * now.positions.len(), 0.0);
        }
        for range in change.written_vertices() {
            self.buffers.positions[range.clone()].copy_from_slice(&now.positions[range.clone()]);
            self.buffers.normals[range.clone()].copy_from_slice(&now.normals[range.clone()]);
            for (to, from) in self.buffers.attributes.iter_mut().zip(&now.attributes) {
                let range = range.start * to.width..range.end * to.width;
                to.values[range.clone()].copy_from_slice(&from.values[range]);
            }
        }
        for range in change.written_triangles() {
            self.buffers.triangles[range.clone()].copy_from_slice(&now.triangles[range]);
        }
        for BrickRanges { place, vertices, triangles } in &change.removed {
            let ranges = [vertices.clone(), triangles.clone()];
            assert_eq!(self.bricks.remove(place), Some(ranges), "a brick that was there");
        }
        for BrickRanges { place, vertices, triangles } in &change.added {
            assert!(self.bricks.insert(*place, [vertices.clone(), triangles.clone()]).is_none());
        }
        for changed in &change.changed {
            let BrickRanges { place, vertices, triangles } = changed.brick.clone();
            assert!(changed.positions || changed.normals || changed.attributes || changed.triangles);
            assert!(self.bricks.insert(place, [vertices, triangles]).is_some());
        }
    }

    /// Compares what was copied with the live mesh.
    fn check(&self, live: &LiveMesh) {
        let bricks: BTreeMap<_, _> =
            live.bricks().map(|brick| (brick.place, [brick.vertices, brick.triangles])).collect();
        assert_eq!(self.bricks, bricks);
        let now = live.buffers();
        assert_eq!(self.buffers.triangles, now.triangles);
        let mut vertices: Vec<_> = bricks.values().map(|[vertices, _]| vertices.clone()).collect();
        vertices.retain(|range| !range.is_empty());
        vertices.sort_by_key(|range| range.start);
        assert!(vertices.windows(2).all(|pair| pair[0].end <= pair[1].start), "bricks do not overlap");
        let mut triangles: Vec<_> = bricks.values().map(|[_, triangles]| triangles.clone()).collect();
        // A brick may have no triangles of its own.
        triangles.retain(|range| !range.is_empty());
        triangles.sort_by_key(|range| range.start);
        let mut end = 0;
        for range in triangles {
            assert!(end <= range.start, "bricks do not overlap");
            assert!(now.triangles[end..range.start].iter().all(|triangle| *triangle == [0; 3]));
            end = range.end;
        }
        assert!(now.triangles[end..].iter().all(|triangle| *triangle == [0; 3]));
        for range in vertices {
            same(&self.buffers.positions[range.clone()], &now.positions[range.clone()]);
            same(&self.buffers.normals[range.clone()], &now.normals[range.clone()]);
            for (copied, attribute) in self.buffers.attributes.iter().zip(&now.attributes) {
                let range = range.start * attribute.width..range.end * attribute.width;
                assert_eq!(bits(&copied.values[range.clone()]), bits(&attribute.values[range]));
            }
        }
    }
}

fn same(a: &[[f32; 3]], b: &[[f32; 3]]) {
    assert_eq!(bits(a.as_flattened()), bits(b.as_flattened()));
}

fn same_mesh(a: &Mesh, b: &Mesh) {
    same(&a.positions, &b.positions);
    same(&a.normals, &b.normals);
    assert_eq!(a.triangles, b.triangles);
    assert_eq!((a.origin, a.attributes.len()), (b.origin, b.attributes.len()));
    for (a, b) in a.attributes.iter().zip(&b.attributes) {
        assert_eq!((&a.name, a.width, bits(&a.values)), (&b.name, b.width, bits(&b.values)));
    }
}

/// What a full run over the lattice makes, by another compiler.
fn full(live: &LiveMesh, engine: Engine) -> jbt::Polygonized {
    let compiled = Compiler::for_engine(engine).compile(live.tree());
    Polygonize { thin_parts: false, ..Polygonize::default() }
        .over(&compiled, live.lattice())
        .run()
        .expect("it has a mesh")
}

/// Follows random edits; returns how many flips there were, how many edits left most bricks alone, and of how
/// many only changed rows were lowered.
fn follow(engine: Engine, (seed, leaves): (u64, usize), edits: usize, settings: Polygonize) -> [usize; 3] {
    let mut rng = Rng::with_seed(seed);
    let mut scene = Edited::new(&mut rng, leaves);
    let compiler = Compiler::for_engine(engine);
    let mut live = LiveMesh::new(&compiler, &scene.model(), settings).run().expect("a mesh");
    let mut copied = Copied::of(&live);
    let (mut flips, mut local) = (0, 0);
    for number in 0..edits {
        let (change, tree) = edit(&mut rng, &mut scene, |given| match given {
            Given::Parameter(name, value) => live.set(&[(name, value)]).run().expect("a good value"),
            Given::Model(model) => live.replace(model).run().expect("a good model"),
            Given::Tree(tree) => live.replace(tree).run().expect("a good model"),
        });
        if let Some(tree) = tree {
            assert_eq!(*live.tree(), tree.with_origin(live.tree().origin()));
        }
        copied.follow(&live, &change);
        copied.check(&live);
        let full = full(&live, engine);
        assert_eq!(full.lattice, *live.lattice());
        let compact = live.compact();
        assert!(
            std::panic::catch_unwind(|| same_mesh(&compact, &full.mesh)).is_ok(),
            "edit {number} of seed {seed} by {engine}"
        );
        let told = change.removed.len() + change.added.len() + change.changed.len();
        local += usize::from(told > 0 && 3 * told < live.bricks().count());
        flips += full.report.flipped_faces as usize;
    }
    [flips, local, compiler.counters().patched as usize]
}

#[test]
fn six_hundred_edits() {
    let [_, local, patched] = follow(Engine::Lanes, (1, 30), 600, cells(0.07));
    assert!(local > 200 && patched > 150, "{local} local edits, {patched} patched ones");
}

#[test]
fn two_hundred_edits_of_a_region() {
    let region = Some(Box3::new([-0.8, -1.0, -0.9], [0.9, 0.7, 1.0]));
    follow(Engine::Lanes, (2, 30), 200, Polygonize { region, ..cells(0.1) });
}

#[test]
fn edits_by_other_engines() {
    // An edit by the reference takes longer than all that the others do here.
    let (edits, cell) = short_or_long([(25, 0.2), (50, 0.12)]);
    follow(Engine::Scalar, (3, 30), edits, cells(cell));
    if !Engine::Jit.backends().is_empty() {
        follow(Engine::Jit, (4, 30), 100, cells(0.07));
    }
}

fn cells(cell: f64) -> Polygonize {
    Polygonize { fineness: Fineness::Cell(cell), ..Polygonize::default() }
}

/// Parts about as large as cells: many faces are pinched, and flips depend on each other.
#[test]
fn edits_of_shreds() {
    let [flips, ..] = follow(Engine::Lanes, (5, 250), 100, cells(0.17));
    assert!(flips > 200, "{flips} flips");
}

fn coarse() -> Polygonize {
    cells(0.1)
}

#[test]
fn only_what_has_changed_is_told() {
    let compiler = Compiler::for_engine(Engine::Lanes);
    let mut live = LiveMesh::new(&compiler, &balls(3.0), coarse()).run().expect("a mesh");
    let kernels = compiler.counters().kernels;
    assert!(live.replace(&balls(3.0)).run().expect("a good model").is_empty());
    // Attributes alone, where one of the leaves is.
    let change = live.set(&[("green", 0.25)]).run().expect("a good value");
    assert!(change.added.is_empty() && change.removed.is_empty() && !change.changed.is_empty());
    for changed in &change.changed {
        assert!(changed.attributes && !changed.positions && !changed.normals && !changed.triangles);
        let positions = &live.buffers().positions[changed.brick.vertices.clone()];
        assert!(positions.iter().all(|[x, ..]| *x > 4.0));
    }
    assert!(change.written_triangles().is_empty() && !change.grown);
    // A leaf more is an edit of its box, and compiles nothing.
    let more = |at: f64| {
        let leaf = |x: f64| point([x, 0.0, 0.0], 1.0).color([1.0, 0.5, 0.0]);
        let last = point((6.0, 0.0, 0.0), param("bulge", 0.6)).color((0.0, param("green", 0.25), 1.0));
        let model = Model::new(Tree::sum([leaf(0.0), leaf(at), leaf(3.0), last]));
        model.check().expect("a good model")
    };
    let change = live.replace(&more(1.5)).run().expect("a good model");
    assert!(!change.added.is_empty());
    for brick in change.added.iter().chain(change.changed.iter().map(|changed| &changed.brick)) {
        let positions = &live.buffers().positions[brick.vertices.clone()];
        assert!(positions.iter().all(|[x, ..]| (-0.4..3.4).contains(x)));
    }
    assert_eq!(compiler.counters().kernels, kernels);
}

#[test]
fn the_lattice_grows_with_the_model() {
    let compiler = Compiler::for_engine(Engine::Lanes);
    let mut live = LiveMesh::new(&compiler, &balls(3.0), coarse()).run().expect("a mesh");
    let first = live.lattice().clone();
    for x in [3.1, -9.0, 14.0, 3.0] {
        live.replace(&balls(x)).run().expect("a good model");
        same_mesh(&live.compact(), &full(&live, Engine::Lanes).mesh);
    }
    let grown = live.lattice();
    assert!(grown.first()[0] < 0 && grown.cells()[0] > first.cells()[0] + 128, "{grown:?}");
    // Nothing is left, and comes back.
    let apart = point([0, 0, 0], 1) & point([3, 0, 0], 1);
    let change =
        live.replace(&Model::new(apart).check().expect("a good model")).run().expect("an empty mesh");
    assert!(change.added.is_empty() && change.changed.is_empty() && live.compact().triangles.is_empty());
    assert!(live.buffers().triangles.iter().all(|triangle| *triangle == [0; 3]));
    live.replace(&balls(3.0)).run().expect("a good model");
    same_mesh(&live.compact(), &full(&live, Engine::Lanes).mesh);
}

#[test]
fn an_edit_that_fails_changes_nothing() {
    let compiler = Compiler::for_engine(Engine::Lanes);
    let mut live = LiveMesh::new(&compiler, &balls(3.0), coarse()).run().expect("a mesh");
    let copied = Copied::of(&live);
    let (tree, lattice) = (live.tree().clone(), live.lattice().clone());
    let unchanged = |live: &LiveMesh| {
        copied.check(live);
        assert_eq!((live.tree(), live.lattice()), (&tree, &lattice));
        same_mesh(&live.compact(), &full(live, Engine::Lanes).mesh);
    };
    let error = live.set(&[("bulge", -1.0)]).run().expect_err("a negative radius");
    assert_eq!(error.diagnostics().map(|list| list[0].message.as_str()), Some("the radius is -1"));
    unchanged(&live);
    let error = live.set(&[("bilge", 1.0)]).run().expect_err("no parameter");
    assert_eq!(error.kind(), ErrorKind::Model);
    unchanged(&live);
    // A lattice beyond its limits, and a model without an end.
    let error = live.replace(&balls(1e6)).run().expect_err("too far away");
    assert!(matches!(error, PolygonizeError::Lattice(_)), "{error}");
    unchanged(&live);
    let endless = Model::new(Tree::expression(x())).check().expect("a good model");
    let error = live.replace(&endless).run().expect_err("without an end");
    assert!(matches!(error, PolygonizeError::Unbounded), "{error}");
    unchanged(&live);
    // Cancelled before it begins, and at any of its steps.
    let token = CancelToken::new();
    token.cancel();
    let error = live.replace(&balls(2.5)).cancel(&token).run().expect_err("cancelled");
    assert_eq!(error.kind(), ErrorKind::Cancelled);
    unchanged(&live);
    for part in 0..20 {
        let token = CancelToken::new();
        let moved = balls(2.5);
        let watch = |done| {
            if done >= 0.05 * part as f32 {
                token.cancel();
            }
        };
        let error = live.replace(&moved).on_progress(watch).cancel(&token).run();
        assert_eq!(error.expect_err("cancelled").kind(), ErrorKind::Cancelled);
        unchanged(&live);
    }
    live.replace(&balls(2.5)).run().expect("a good model");
    same_mesh(&live.compact(), &full(&live, Engine::Lanes).mesh);
}
