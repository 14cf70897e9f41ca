//! Division: what is decided, in which order, and what stops it.

use std::collections::BTreeSet;
use std::convert::Infallible;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use jbt::Box3;
use jbt::boxes::{Divisible, Range};
use jbt::divide::{Cell, Decision, DivideError, Division, Edit, Limits, Outcome, divide};

/// The distance from a centre, exactly enclosed. A region is its box; `asked` counts the boxes whose ranges
/// were asked for.
struct Ball {
    center: [f32; 3],
    asked: AtomicU64,
}

impl Ball {
    fn new(center: [f32; 3]) -> Self {
        Self { center, asked: AtomicU64::new(0) }
    }
}

impl Divisible for Ball {
    type Error = Infallible;
    type Region = Box3;

    fn region(&self, bounds: Box3) -> Result<Box3, Infallible> {
        Ok(bounds)
    }

    fn ranges(&self, around: &Box3, boxes: &[Box3], ranges: &mut [Range]) -> Result<(), Infallible> {
        self.asked.fetch_add(boxes.len() as u64, Ordering::Relaxed);
        for (bounds, range) in boxes.iter().zip(ranges) {
            assert!(around.contains(bounds.low) && around.contains(bounds.high));
            let mut ends = [0.0; 2];
            for axis in 0..3 {
                let [low, high] = [bounds.low[axis], bounds.high[axis]].map(|side| side - self.center[axis]);
                ends[0] += low.max(-high).max(0.0).powi(2);
                ends[1] += high.max(-low).powi(2);
            }
            *range = ends.map(f32::sqrt);
        }
        Ok(())
    }

    fn narrow(&self, _: &Box3, boxes: &[Box3], parts: &mut Vec<Box3>) -> Result<(), Infallible> {
        parts.extend(boxes);
        Ok(())
    }
}

/// Down to a sixteenth, where the sphere of radius 1 is: in octants or along the longest side.
fn where_the_sphere_is(cell: &Cell<'_, Ball>, octants: bool) -> Result<Decision<()>, Infallible> {
    let bounds = cell.bounds();
    let [low, high] = cell.range()?;
    if low > 1.0 || high < 1.0 {
        return Ok(Decision::Stop);
    }
    if bounds.longest_side() <= 0.0625 {
        return Ok(Decision::Leaf);
    }
    let at = [0, 1, 2].map(|axis| bounds.middle(axis));
    if octants {
        return Ok(Decision::Octants { at, data: [(); 8] });
    }
    let axis = (0..3).find(|&axis| bounds.high[axis] - bounds.low[axis] == bounds.longest_side()).unwrap();
    Ok(Decision::Split { axis, at: at[axis], data: [(), ()] })
}

fn sphere(octants: bool) -> Division<Box3, ()> {
    let ball = Ball::new([0.1, 0.0, 0.0]);
    let whole = Box3::new([-1.5; 3], [1.5; 3]);
    divide(&ball, whole, (), &Limits::default(), &|cell, ()| where_the_sphere_is(cell, octants)).unwrap()
}

#[test]
fn leaves_and_stops_fill_the_box_and_hold_the_surface() {
    for octants in [false, true] {
        let division = sphere(octants);
        let tally = division.tally();
        assert_eq!(tally.splits + tally.leaves + tally.stops, division.nodes().len() as u64);
        assert_eq!(division.decisions(), division.nodes().len() as u64);
        let volume = |bounds: &Box3| {
            (0..3).map(|axis| f64::from(bounds.high[axis] - bounds.low[axis])).product::<f64>()
        };
        let ends = division.nodes().iter().filter(|node| node.outcome != Outcome::Split);
        assert_eq!(ends.map(|node| volume(&node.bounds)).sum::<f64>(), 27.0);
        // Every point of the sphere is in a leaf.
        let mut rng = fastrand::Rng::with_seed(3);
        for _ in 0..2000 {
            let v: [f64; 3] = std::array::from_fn(|_| rng.f64() - 0.5);
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let point = [v[0] / length + 0.1, v[1] / length, v[2] / length].map(|x| x as f32);
            assert!(division.leaves().any(|(node, region)| {
                assert_eq!(node.bounds, *region, "a leaf's region is its own");
                node.bounds.contains(point)
            }));
        }
    }
}

#[test]
fn parts_are_in_order_and_found_again() {
    let division = sphere(true);
    let nodes = division.nodes();
    let root: Vec<usize> = division.parts(0).collect();
    assert_eq!(root.len(), 8);
    let lows: Vec<[f32; 3]> = root.iter().map(|&part| nodes[part].bounds.low).collect();
    assert_eq!(lows[..4], [[-1.5; 3], [0.0, -1.5, -1.5], [-1.5, 0.0, -1.5], [0.0, 0.0, -1.5]]);
    for (index, node) in nodes.iter().enumerate() {
        let parts: Vec<usize> = division.parts(index).collect();
        assert_eq!(parts.len(), if node.outcome == Outcome::Split { 8 } else { 0 });
        assert!(parts.iter().all(|&part| nodes[part].depth == node.depth + 1));
    }
}

#[test]
fn any_number_of_threads_divides_alike() {
    let one = sphere(true);
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| sphere(true)), one);
    }
}

#[test]
fn nothing_is_found_out_that_nobody_asked_for() {
    let ball = Ball::new([0.0; 3]);
    let whole = Box3::new([0.0; 3], [8.0; 3]);
    let depth = |cell: &Cell<'_, Ball>, _: &()| {
        if cell.depth() == 3 {
            return Ok(Decision::Stop);
        }
        Ok(Decision::Octants { at: [0, 1, 2].map(|axis| cell.bounds().middle(axis)), data: [(); 8] })
    };
    let division = divide(&ball, whole, (), &Limits::default(), &depth).unwrap();
    assert_eq!(division.tally().stops, 512);
    assert_eq!(ball.asked.load(Ordering::Relaxed), 0);
    assert!(division.nodes().iter().all(|node| node.range.is_none()));
}

#[test]
fn data_goes_down() {
    let ball = Ball::new([0.0; 3]);
    let seen = Mutex::new(BTreeSet::new());
    let number = |_: &Cell<'_, Ball>, path: &u32| {
        seen.lock().unwrap().insert(*path);
        if *path >= 8 {
            return Ok(Decision::Leaf);
        }
        Ok(Decision::Split { axis: 0, at: 0.5 / *path as f32, data: [2 * path, 2 * path + 1] })
    };
    let error = divide(&ball, Box3::new([0.0; 3], [1.0; 3]), 1, &Limits::default(), &number);
    // The part above 0.5 cannot be split at 0.5 / 3.
    assert!(matches!(error, Err(DivideError::Place { axis: 0, .. })), "{error:?}");
    assert!(seen.lock().unwrap().contains(&1));
}

#[test]
fn what_cannot_be_divided_is_named() {
    let ball = Ball::new([0.0; 3]);
    let stop = |_: &Cell<'_, Ball>, _: &()| Ok(Decision::Stop);
    for (low, high) in [(f32::NAN, 1.0), (f32::NEG_INFINITY, 1.0), (0.0, f32::INFINITY), (1.0, 0.0)] {
        let bounds = Box3::new([low; 3], [high; 3]);
        let error = divide(&ball, bounds, (), &Limits::default(), &stop).unwrap_err();
        assert!(matches!(error, DivideError::Bounds { .. }), "{error}");
    }
    for (axis, at) in [(0, 0.0), (1, 1.0), (2, f32::NAN), (3, 0.5), (0, -1.0)] {
        let split = |_: &Cell<'_, Ball>, _: &()| Ok(Decision::Split { axis, at, data: [(), ()] });
        let error = divide(&ball, Box3::new([0.0; 3], [1.0; 3]), (), &Limits::default(), &split).unwrap_err();
        assert!(matches!(error, DivideError::Place { .. }), "{error}");
    }
}

#[test]
fn a_decider_that_never_stops_meets_a_limit() {
    let ball = Ball::new([0.0; 3]);
    let whole = Box3::new([-1.0; 3], [1.0; 3]);
    let forever = |cell: &Cell<'_, Ball>, _: &()| {
        let at = [0, 1, 2].map(|axis| cell.bounds().middle(axis));
        Ok(Decision::Octants { at, data: [(); 8] })
    };
    let limits = Limits { boxes: 100, ..Limits::default() };
    let error = divide(&ball, whole, (), &limits, &forever).unwrap_err();
    assert_eq!(error, DivideError::Boxes { boxes: 100 });
    assert_eq!(error.to_string(), "the division has more than 100 boxes: the limit of boxes");

    // Towards one corner: deep before it is large.
    let corner = |cell: &Cell<'_, Ball>, wanted: &bool| {
        if !wanted {
            return Ok(Decision::Stop);
        }
        let axis = cell.depth() % 3;
        Ok(Decision::Split { axis, at: cell.bounds().middle(axis), data: [true, false] })
    };
    let unit = Box3::new([0.0; 3], [1.0; 3]);
    let error = divide(&ball, unit, true, &Limits::default(), &corner).unwrap_err();
    assert_eq!(error, DivideError::Depth { depth: jbt::limits::MAX_DIVISION_DEPTH });
}

#[test]
fn only_what_an_edit_touches_is_decided_again() {
    let before = sphere(true);
    let whole = before.nodes()[0].bounds;
    let ball = Ball::new([0.1, 0.0, 0.0]);
    let again = |edit: &Edit, ball: &Ball| {
        before.redivide(ball, edit, &|region| *region, &Limits::default(), &|cell, ()| {
            where_the_sphere_is(cell, true)
        })
    };
    let same = again(&Edit::Boxes(vec![]), &ball).unwrap();
    assert_eq!(same.decisions(), 0);
    assert_eq!(same.nodes(), before.nodes());
    assert!(same.leaves().eq(before.leaves()));

    let everywhere = again(&Edit::Everywhere, &ball).unwrap();
    assert_eq!(everywhere, before);

    // The ball moves, and the edit says so for a corner alone: there it is divided anew.
    let moved = Ball::new([0.0, 0.1, 0.0]);
    let corner = Box3::new([0.8; 3], [1.5; 3]);
    let some = again(&Edit::Boxes(vec![corner]), &moved).unwrap();
    assert!(some.decisions() < before.decisions() / 4, "{} decisions", some.decisions());
    assert_eq!(some.nodes()[0].bounds, whole);
    let fresh =
        divide(&moved, whole, (), &Limits::default(), &|cell, ()| where_the_sphere_is(cell, true)).unwrap();
    let leaves = |division: &Division<Box3, ()>, inside: bool| {
        let leaves = division.leaves().map(|(node, _)| node.bounds);
        leaves.filter(|bounds| corner.meets(bounds) == inside).map(|b| format!("{b:?}")).collect::<Vec<_>>()
    };
    assert_eq!(leaves(&some, true), leaves(&fresh, true));
    assert_eq!(leaves(&some, false), leaves(&before, false));
}

#[test]
fn a_ray_passes_leaves_from_the_nearest_on() {
    let division = sphere(true);
    let mut rng = fastrand::Rng::with_seed(8);
    for _ in 0..200 {
        let mut vector = |size: f32| [0; 3].map(|_: i32| size * (2.0 * rng.f32() - 1.0));
        let (origin, direction) = (vector(3.0), vector(1.0));
        let passed = division.ray(origin, direction);
        assert!(passed.is_sorted_by(|a, b| a.enter <= b.enter));
        // The middle of a passage is in its box, as far as rounding goes; and no other leaf holds a point of
        // the ray.
        for passage in &passed {
            let at = 0.5 * (passage.enter + passage.exit);
            let slack = 1e-5;
            let bounds = passage.node.bounds;
            for axis in 0..3 {
                let x = origin[axis] + at * direction[axis];
                assert!(bounds.low[axis] - slack <= x && x <= bounds.high[axis] + slack);
            }
            assert_eq!(*passage.region, bounds);
        }
        for step in 0..300 {
            let at = 0.02 * step as f32;
            let point: [f32; 3] = std::array::from_fn(|axis| origin[axis] + at * direction[axis]);
            let middle = |bounds: &Box3| {
                (0..3).all(|axis| {
                    bounds.low[axis] + 1e-4 < point[axis] && point[axis] < bounds.high[axis] - 1e-4
                })
            };
            for (node, _) in division.leaves().filter(|(node, _)| middle(&node.bounds)) {
                assert!(passed.iter().any(|passage| passage.node.bounds == node.bounds));
            }
        }
    }
    assert!(division.ray([0.0; 3], [0.0; 3]).is_empty(), "no leaf is at the centre");
    let along = division.ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    assert!(along[0].enter > 1.8 && along[along.len() - 1].exit < 4.3, "two walls of the sphere");
}
