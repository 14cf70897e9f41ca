//! Live contours: after any edits, the contour of a full run over their lattice.

use fastrand::Rng;
use jbt::build::{param, point, x};
use jbt::contour::{Contour, Detail, Rectangle, SliceError, Slicer};
use jbt::live::LiveSection;
use jbt::{
    CancelToken, Classified as _, Compiler, Engine, ErrorKind, Fineness, LiveContour, Model, Query, Tree,
};

use crate::scene::{Edited, Given, balls, bits, edit};

fn section(plane: &str, cell: f64) -> LiveSection {
    LiveSection {
        plane: plane.parse().expect("a plane"),
        query: Query::ATTRIBUTES,
        detail: Detail { fineness: Fineness::Cell(cell), ..Detail::default() },
        ..LiveSection::default()
    }
}

/// What a full run over the lattice makes, by another compiler.
fn full(live: &LiveContour, section: &LiveSection, engine: Engine) -> Contour {
    let compiler = Compiler::for_engine(engine);
    let slicer = Slicer::new(&compiler, live.tree(), &section.plane, section.query).expect("it compiles");
    slicer.contour_over(live.lattice(), &section.detail).run().expect("a contour")
}

/// Whether two contours have the same bits. How they were found does not matter.
fn is_same(a: &Contour, b: &Contour) -> bool {
    let attributes = |contour: &Contour| -> Vec<(String, usize, Vec<u32>)> {
        let all = contour.attributes.iter();
        all.map(|one| (one.name.clone(), one.width, bits(&one.values))).collect()
    };
    bits(a.positions.as_flattened()) == bits(b.positions.as_flattened())
        && attributes(a) == attributes(b)
        && (&a.loops, a.cut_sides, a.rectangle, a.cells, a.cell, a.origin)
            == (&b.loops, b.cut_sides, b.rectangle, b.cells, b.cell, b.origin)
}

/// Squares that an edit may not tell: vertices in them are as they were.
fn check_change(before: &Contour, now: &Contour, squares: &[[[f32; 2]; 2]]) {
    let is_told = |place: &[f32; 2]| {
        let holds =
            |[low, high]: &[[f32; 2]; 2]| (0..2).all(|axis| (low[axis]..=high[axis]).contains(&place[axis]));
        squares.iter().any(holds)
    };
    let rest = |contour: &Contour| {
        let places = contour.positions.iter().filter(|place| !is_told(place));
        let mut places: Vec<_> = places.map(|place| place.map(f32::to_bits)).collect();
        places.sort_unstable();
        places
    };
    assert_eq!(rest(before), rest(now));
}

/// Follows random edits; returns how many of them left most of the field alone.
fn follow(engine: Engine, (seed, leaves): (u64, usize), edits: usize, section: &LiveSection) -> usize {
    let mut rng = Rng::with_seed(seed);
    let mut scene = Edited::new(&mut rng, leaves);
    let compiler = Compiler::for_engine(engine);
    let mut live = LiveContour::new(&compiler, &scene.model(), section).run().expect("a contour");
    let mut local = 0;
    for number in 0..edits {
        let before = live.contour().clone();
        let (change, _) = edit(&mut rng, &mut scene, |given| match given {
            Given::Parameter(name, value) => live.set(&[(name, value)]).run().expect("a good value"),
            Given::Model(model) => live.replace(model).run().expect("a good model"),
            Given::Tree(tree) => live.replace(tree).run().expect("a good model"),
        });
        let now = live.contour();
        assert!(is_same(now, &full(&live, section, engine)), "edit {number} of seed {seed} by {engine}");
        check_change(&before, now, &change.squares);
        let has_grown = before.cells != now.cells;
        assert!(!change.is_empty() || has_grown || is_same(&before, now));
        let points = (now.cells[0] * now.cells[1]) as u64;
        let (_, field, full) = live.slicer().counters();
        local += usize::from(4 * (field.points + full.points) < points);
    }
    local
}

#[test]
fn five_hundred_edits() {
    let local = follow(Engine::Lanes, (1, 30), 300, &section("z=0.1", 0.01));
    assert!(local > 100, "{local} local edits");
    let within = Rectangle::new([-0.6, -0.4], [0.7, 0.5]).expect("a rectangle");
    // Sides of the rectangle cut the model, and inside squares are as large as they can be.
    let cut = LiveSection { rectangle: Some(within), ..section("x=0.05", 0.02) };
    follow(Engine::Lanes, (2, 60), 150, &cut);
    let small = Detail { block: Some(1), quadtree: true, ..cut.detail };
    follow(Engine::Lanes, (3, 60), 50, &LiveSection { detail: small, ..cut });
    // Any other plane.
    follow(Engine::Scalar, (4, 30), 50, &section("0,0,0.1,1,0.5,0,0,1,1", 0.04));
    if !Engine::Jit.backends().is_empty() {
        follow(Engine::Jit, (5, 30), 100, &section("y=0", 0.02));
    }
}

#[test]
fn only_what_has_changed_is_told() {
    let section = section("z=0", 0.05);
    let compiler = Compiler::for_engine(Engine::Lanes);
    let mut live = LiveContour::new(&compiler, &balls(3.0), &section).run().expect("a contour");
    let kernels = compiler.counters().kernels;
    assert!(live.replace(&balls(3.0)).run().expect("a good model").is_empty());
    let change = live.set(&[("green", 0.25)]).run().expect("a good value");
    assert!(!change.is_empty() && change.squares.iter().all(|[low, _]| low[0] > 4.0));
    live.set(&[("green", 0.5)]).run().expect("a good value");
    let change = live.replace(&balls(3.1)).run().expect("a good model");
    assert!(!change.is_empty() && change.squares.iter().all(|[low, high]| low[0] > 1.5 && high[0] < 4.6));
    assert_eq!(compiler.counters().kernels, kernels);
}

#[test]
fn the_lattice_grows_with_the_model() {
    let section = section("z=0", 0.05);
    let compiler = Compiler::for_engine(Engine::Lanes);
    let mut live = LiveContour::new(&compiler, &balls(3.0), &section).run().expect("a contour");
    let first = live.lattice().cells();
    for x in [3.1, -9.0, 14.0, 3.0] {
        live.replace(&balls(x)).run().expect("a good model");
        assert!(is_same(live.contour(), &full(&live, &section, Engine::Lanes)), "{x}");
    }
    assert!(live.lattice().cells()[0] > first[0] + 256);
    // Nothing is left, and comes back.
    let apart = point([0, 0, 0], 1) & point([3, 0, 0], 1);
    let change = live.replace(&Model::new(apart).check().expect("a good model")).run();
    assert!(!change.expect("an empty contour").is_empty() && live.contour().positions.is_empty());
    live.replace(&balls(3.0)).run().expect("a good model");
    assert!(is_same(live.contour(), &full(&live, &section, Engine::Lanes)));
}

#[test]
fn an_edit_that_fails_changes_nothing() {
    let section = section("z=0", 0.05);
    let compiler = Compiler::for_engine(Engine::Lanes);
    let mut live = LiveContour::new(&compiler, &balls(3.0), &section).run().expect("a contour");
    let (tree, lattice, contour) = (live.tree().clone(), live.lattice().clone(), live.contour().clone());
    let unchanged = |live: &LiveContour| {
        assert_eq!((live.tree(), live.lattice()), (&tree, &lattice));
        assert!(is_same(live.contour(), &contour) && is_same(&contour, &full(live, &section, Engine::Lanes)));
    };
    let error = live.set(&[("bulge", -1.0)]).run().expect_err("a negative radius");
    assert_eq!(error.diagnostics().map(|list| list[0].message.as_str()), Some("the radius is -1"));
    unchanged(&live);
    let error = live.replace(&balls(1e6)).run().expect_err("too far away");
    assert!(matches!(error, SliceError::Lattice(_)), "{error}");
    unchanged(&live);
    let endless = Model::new(Tree::expression(x())).check().expect("a good model");
    let error = live.replace(&endless).run().expect_err("without an end");
    assert!(matches!(error, SliceError::Unbounded), "{error}");
    unchanged(&live);
    for part in 0..10 {
        let token = CancelToken::new();
        let moved = Model::new(point([0, 0, 0], param("size", 1.0))).check().expect("a good model");
        let watch = |done| {
            if done >= 0.1 * part as f32 {
                token.cancel();
            }
        };
        let error = live.replace(&moved).on_progress(watch).cancel(&token).run();
        assert_eq!(error.expect_err("cancelled").kind(), ErrorKind::Cancelled);
        unchanged(&live);
    }
    let wrong = LiveSection { detail: Detail { block: Some(3), ..section.detail }, ..section.clone() };
    let error = LiveContour::new(&compiler, &balls(3.0), &wrong).run().expect_err("no power of two");
    assert_eq!(error.kind(), ErrorKind::Argument);
}
