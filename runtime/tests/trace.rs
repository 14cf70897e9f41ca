//! Rays, against closed forms, against dense sampling of the plain evaluator, and against themselves in other
//! packets.
//!
//! `JBT_TRACE_TREES` sets the number of random models, `JBT_TRACE_RAYS` the rays at each, `JBT_TRACE_SEED`
//! the first seed. A failure prints the model.
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

mod common;

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use common::answers;
use fastrand::Rng;
use jbt::boxes::{ANYTHING, Divisible as _};
use jbt::text::print;
use jbt::trace::{Hits, Ray, TraceError, Tracer};
use jbt::{Box3, Compiler, Engine, Evaluator, Model, Points, Pruner, Query};
use jbt_model::kind::NodeKind;
use jbt_testkit::bits;
use jbt_testkit::random::Random;
use jbt_testkit::scene::{count, tree};
use jbt_testkit::skip::short_or_long;
use jbt_testkit::vector::dot;
use rayon::prelude::*;

const BALL: &str = "jbt 1 point { surface_radius 1 }";

fn tracer(text: &str) -> Tracer {
    Tracer::new(&Compiler::new(), &tree(text), Query::ALL).expect("it compiles")
}

fn ray(origin: [f64; 3], direction: [f64; 3], end: f64) -> Ray {
    Ray { origin, direction, span: [0.0, end] }
}

/// All hits of a ray, as t and whether it comes in; the first hit and any hit agree.
fn hits(tracer: &Tracer, ray: &Ray, tolerance: f64) -> Vec<(f64, bool)> {
    let all = tracer.all(ray, tolerance).expect("a good ray");
    let first = tracer.first(ray, tolerance).expect("a good ray");
    assert_eq!(all.first(), first.as_ref());
    assert_eq!(tracer.any(ray, tolerance), Ok(first.is_some()));
    all.iter().map(|hit| (hit.t, hit.entering)).collect()
}

#[track_caller]
fn check(tracer: &Tracer, ray: &Ray, tolerance: f64, expected: &[f64]) {
    let found = hits(tracer, ray, tolerance);
    let near = |(hit, t): (&(f64, bool), &f64)| (hit.0 - t).abs() < 0.01 * tolerance + 2e-6;
    assert!(
        found.len() == expected.len() && found.iter().zip(expected).all(near),
        "{found:?}, not {expected:?}"
    );
    assert!(found.windows(2).all(|pair| pair[0].1 != pair[1].1), "in and out take turns: {found:?}");
}

fn unit(rng: &mut Rng) -> [f64; 3] {
    loop {
        let v: [f64; 3] = std::array::from_fn(|_| 2.0 * rng.f64() - 1.0);
        let length = dot(v, v).sqrt();
        if (0.1..1.0).contains(&length) {
            return v.map(|x| x / length);
        }
    }
}

#[test]
fn a_ball_is_hit_where_it_is() {
    let tracer = tracer(BALL);
    let mut rng = Rng::with_seed(1);
    let mut found = 0;
    for _ in 0..500 {
        let (origin, direction) = (unit(&mut rng).map(|x| 3.0 * x), unit(&mut rng));
        // Towards a point near the ball; any length of direction.
        let size = [0.01, 0.3, 1.0, 7.0][rng.usize(0..4)];
        let to: [f64; 3] = std::array::from_fn(|axis| size * (1.3 * direction[axis] - origin[axis]));
        let tolerance = [0.3, 0.05, 0.001][rng.usize(0..3)];
        let (a, b, c) = (dot(to, to), dot(to, origin), dot(origin, origin) - 1.0);
        let discriminant = b * b - a * c;
        let hits = tracer.all(&ray(origin, to, 10.0 / size), tolerance).unwrap();
        let chord = 2.0 * discriminant.max(0.0).sqrt() / a.sqrt();
        if hits.is_empty() {
            assert!(chord < tolerance + 1e-3, "a chord of {chord} is missed, tolerance {tolerance}");
            continue;
        }
        found += 1;
        let length = a.sqrt();
        for (hit, sign) in hits.iter().zip([-1.0, 1.0]) {
            let t = (-b + sign * discriminant.max(0.0).sqrt()) / a;
            // Grazing rays move along the surface by more than the field is off.
            let slack = 4e-6 / chord.max(1e-3);
            assert!((hit.t - t).abs() * length <= tolerance / 512.0 + slack, "{} is not {t}", hit.t);
            assert_eq!(hit.entering, sign < 0.0);
            let normal = hit.normal().expect("a ball has normals").map(f64::from);
            let position = hit.position.map(f64::from);
            assert!(dot(normal, position) / dot(position, position).sqrt() > 1.0 - 1e-6);
            assert!((f64::from(hit.value()) - 0.5).abs() < 0.01 * tolerance + 1e-5);
        }
        assert_eq!(hits.len(), 2);
    }
    assert!(found > 150, "{found}");
}

#[test]
fn a_ring_is_hit_four_times() {
    let tracer = tracer("jbt 1 ring { ring_radius 1 surface_radius 0.25 }");
    check(&tracer, &ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], 9.0), 0.1, &[1.75, 2.25, 3.75, 4.25]);
    check(
        &tracer,
        &ray([0.0, 9.0, 0.0], [0.0, -3.0, 0.0], 9.0),
        0.01,
        &[7.75 / 3.0, 8.25 / 3.0, 9.75 / 3.0, 10.25 / 3.0],
    );
    check(&tracer, &ray([0.0; 3], [0.0, 0.6, 0.8], 9.0), 0.01, &[]);
    // Through the hole, in the plane of the top circle, and beside.
    check(&tracer, &ray([0.0, 0.0, -5.0], [0.0, 0.0, 1.0], 9.0), 0.01, &[]);
    check(&tracer, &ray([1.0, 0.0, -5.0], [0.0, 0.0, 1.0], 9.0), 0.01, &[4.75, 5.25]);
    // Where spans end.
    let along = |span| Ray { origin: [-3.0, 0.0, 0.0], direction: [1.0, 0.0, 0.0], span };
    check(&tracer, &along([2.0, 3.8]), 0.01, &[2.25, 3.75]);
    check(&tracer, &along([-20.0, 2.0]), 0.01, &[1.75]);
    check(&tracer, &along([2.0, 2.0]), 0.01, &[]);
    check(&tracer, &along([2.24, 2.26]), 100.0, &[2.25]);
    let back = Ray { origin: [0.0; 3], direction: [1.0, 0.0, 0.0], span: [-5.0, 0.0] };
    check(&tracer, &back, 0.01, &[-1.25, -0.75]);
}

#[test]
fn what_is_longer_than_the_tolerance_is_found() {
    let tracer = tracer(BALL);
    for tolerance in [0.1, 0.02, 0.004] {
        for part in [1.01, 1.3, 3.0] {
            // A chord a little longer than the tolerance, anywhere on the lattice.
            let chord: f64 = part * tolerance;
            let beside = (1.0 - 0.25 * chord * chord).sqrt();
            for shift in 0..20 {
                let start = -3.0 - f64::from(shift) * 0.0137;
                let ray = ray([start, beside, 0.0], [1.0, 0.0, 0.0], 9.0);
                // f32 knows the distance to 1e-7 only, which is more along the chord.
                let slack = 1e-6 / chord + 0.01 * tolerance;
                let hits = hits(&tracer, &ray, tolerance);
                assert_eq!(hits.len(), 2, "a chord of {chord} is missed");
                for (hit, sign) in hits.iter().zip([-1.0, 1.0]) {
                    assert!((hit.0 - (sign * 0.5 * chord - start)).abs() < slack);
                }
            }
        }
    }
}

#[test]
fn a_ray_may_begin_inside() {
    let tracer = tracer(BALL);
    let ray = ray([0.0, 0.0, 0.5], [0.0, 0.0, 2.0], 9.0);
    check(&tracer, &ray, 0.01, &[0.25]);
    let hit = tracer.first(&ray, 0.01).unwrap().unwrap();
    assert!(!hit.entering);
    assert_eq!(hit.normal(), Some([0.0, 0.0, 1.0]));
    check(&tracer, &Ray { span: [0.0, 0.2], ..ray }, 0.01, &[]);
}

#[test]
fn all_space_but_a_ball() {
    let tracer = tracer("jbt 1 complement { point { surface_radius 1 } }");
    let ray = ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], 100.0);
    check(&tracer, &ray, 0.01, &[2.0, 4.0]);
    let hit = tracer.first(&ray, 0.01).unwrap().unwrap();
    assert!(!hit.entering, "a ray leaves what is around the ball");
    assert_eq!(hit.normal(), Some([0.0, 0.0, -1.0]));
    // A half space ends nowhere; its rays do.
    let tracer = self::tracer("jbt 1 half_space { normal (0 0 1) radius 1 }");
    let found = hits(&tracer, &Ray { span: [-50.0, 50.0], ..ray }, 0.01);
    assert_eq!(found.len(), 1);
}

#[test]
fn hits_are_inside_where_the_field_jumps() {
    let block = tracer("jbt 1 color (1 0 0) { expression within (-1 -1 -1) to (1 1 1) { 0.75 } }");
    for step in 0..150 {
        let at = f64::from(step) * 0.00917 - 0.9;
        let hits = block.all(&ray([3.0, at, 0.5 * at], [-1.0, 0.1, 0.05], 9.0), 0.01).unwrap();
        assert_eq!(hits.len(), 2, "in and out");
        for hit in hits {
            assert_eq!((hit.value(), hit.color()), (0.75, Some([1.0, 0.0, 0.0])), "at {:?}", hit.position);
        }
    }
}

#[test]
fn creases() {
    // Of a ball, what is not in another one.
    let bowl = tracer(
        "jbt 1 difference { color (1 0 0) { point { surface_radius 1 } } color (0 1 0) { point { at (0 0 1) surface_radius 1 } } }",
    );
    let down = ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], 9.0);
    check(&bowl, &down, 0.01, &[3.0, 4.0]);
    let all = bowl.all(&down, 0.01).unwrap();
    assert_eq!(all[0].color(), Some([0.0, 1.0, 0.0]), "the wall of the hole is the tool's");
    assert_eq!(all[1].color(), Some([1.0, 0.0, 0.0]));
    // At the rim, z = 1/2, the bowl is thin.
    let across = ray([-3.0, 0.0, 0.4], [1.0, 0.0, 0.0], 9.0);
    let (outer, inner) = ((1.0_f64 - 0.16).sqrt(), (1.0_f64 - 0.36).sqrt());
    check(&bowl, &across, 0.01, &[3.0 - outer, 3.0 - inner, 3.0 + inner, 3.0 + outer]);
    let lens = tracer(
        "jbt 1 intersection { point { at (0 0 0.8) surface_radius 1 } point { at (0 0 -0.8) surface_radius 1 } }",
    );
    check(&lens, &down, 0.01, &[2.8, 3.2]);
    check(&lens, &ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], 9.0), 0.01, &[2.4, 3.6]);
    let two = tracer(
        "jbt 1 union { point { at (-1.5 0 0) surface_radius 1 } point { at (1.5 0 0) surface_radius 1 } }",
    );
    check(&two, &ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], 9.0), 0.01, &[0.5, 2.5, 3.5, 5.5]);
}

#[test]
fn hits_carry_textures() {
    let tracer =
        tracer("jbt 1 color checker { size 0.5 a (1 0 0) b (0 0 1) } { point { surface_radius 1 } }");
    let evaluator = Compiler::new().evaluator(tracer.tree(), Query::ALL).unwrap();
    let mut colors = Vec::new();
    for step in 0..20 {
        let x = -0.9 + 0.09 * f64::from(step);
        let hit = tracer.first(&ray([x, 0.13, 3.0], [0.0, 0.0, -1.0], 9.0), 0.01).unwrap().unwrap();
        let probe = evaluator.probe(hit.position);
        assert_eq!(
            (hit.color(), hit.gradient(), hit.value()),
            (probe.color(), probe.gradient(), probe.value())
        );
        colors.push(hit.color().unwrap());
    }
    assert!(colors.contains(&[1.0, 0.0, 0.0]) && colors.contains(&[0.0, 0.0, 1.0]));
}

#[test]
fn an_edit_moves_the_surface() {
    let start = tree("jbt 1 param size = 1 color (1 0 0) { point { surface_radius size } }");
    let tracer = Tracer::new(&Compiler::new(), &start, Query::GRADIENT).unwrap();
    let down = ray([0.0, 0.0, 5.0], [0.0, 0.0, -1.0], 9.0);
    check(&tracer, &down, 0.01, &[4.0, 6.0]);
    let edited = tracer.updated(&start.with_parameters(&[("size", 1.5)]).unwrap()).unwrap();
    check(&edited, &down, 0.01, &[3.5, 6.5]);
    check(&tracer, &down, 0.01, &[4.0, 6.0]);
    assert_eq!(edited.all(&down, 0.01).unwrap()[0].color(), None, "that was not asked for");
    // Another shape compiles.
    check(&edited.updated(&tree(BALL)).unwrap(), &down, 0.01, &[4.0, 6.0]);
}

#[test]
fn leaves_and_counters() {
    let text = "jbt 1 union { point { at (-1.5 0 0) surface_radius 1 } sum { point { at (1.5 0 0) radius 2 } point { at (2 0 0) radius 2 } } }";
    let tracer = tracer(text);
    let rays: Vec<Ray> =
        (0..50).map(|i| ray([0.1 * f64::from(i) - 2.6, 0.1, 5.0], [0.0, 0.0, -1.0], 9.0)).collect();
    let hits = tracer.first_of(&rays, 0.01).unwrap();
    // Leaves take ranges, too.
    let counters = tracer.counters();
    for index in 0..hits.len() {
        let position = hits.positions.get(index);
        let owner = tracer.owner(position).expect("somebody owns the surface");
        assert_eq!(tracer.leaf(position), Ok(Some(owner.node)));
        assert!(matches!(tracer.tree().node(owner.node).kind, NodeKind::Primitive(_)));
    }
    assert_eq!((counters.rays, counters.hits), (50, hits.len() as u64));
    assert!(hits.len() > 30 && counters.boxes > 0 && counters.points > counters.hits, "{counters:?}");
    let evaluations: f32 = hits.evaluations.iter().sum();
    let counted = counters.primitive_evaluations + counters.interval_evaluations;
    assert!((f64::from(evaluations) / counted as f64 - 1.0).abs() < 0.001, "{evaluations} of {counted}");
    // A twentieth of what sampling takes: 3 leaves at 900 points of each ray.
    assert!(f64::from(evaluations) < 0.05 * 50.0 * 3.0 * 900.0, "{evaluations}");
}

#[test]
fn what_cannot_be_a_ray() {
    let tracer = tracer(BALL);
    let good = ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], 9.0);
    let first = |ray: Ray, tolerance: f64| tracer.first_of(&[good, ray], tolerance).map(|hits| hits.len());
    assert_eq!(first(good, 0.01), Ok(2));
    assert_eq!(
        first(Ray { direction: [0.0, -0.0, 0.0], ..good }, 0.01),
        Err(TraceError::Direction { ray: 1 })
    );
    assert_eq!(
        first(Ray { span: [1.0, 0.5], ..good }, 0.01),
        Err(TraceError::Span { ray: 1, span: [1.0, 0.5] })
    );
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in 0..3 {
            let mut bad = good;
            match place {
                0 => bad.origin[1] = number,
                1 => bad.direction[2] = number,
                _ => bad.span[1] = number,
            }
            assert!(matches!(first(bad, 0.01), Err(TraceError::NotFinite { ray: 1, .. })));
        }
    }
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(first(good, tolerance), Err(TraceError::Tolerance { .. })));
    }
    let error = first(good, 1e-8).unwrap_err();
    assert!(matches!(error, TraceError::Resolution { ray: 0, .. }));
    assert!(error.to_string().starts_with("the tolerance 0.00000001 is too small for ray 0"), "{error}");
    // A huge tolerance looks at the ends.
    assert_eq!(first(Ray { span: [0.0, 3.0], ..good }, 1e30), Ok(1));
    assert_eq!(tracer.first_of(&[], 0.1).map(|hits| hits.len()), Ok(0));
    // Whoever passes by at a distance is not looked at.
    let far = ray([1e300, 0.0, 0.0], [0.0, 0.0, 1e-300], 1e308);
    assert_eq!(first(far, 0.01), Ok(1));
    let far = ray([1e9, 0.0, 0.0], [-1e9, 0.0, 0.0], 2.0);
    assert_eq!(first(far, 0.01), Ok(2));
    let everywhere = self::tracer("jbt 1 complement { point { surface_radius 1 } }");
    let far = ray([0.0; 3], [0.0, 0.0, 1e39], 1.0);
    assert!(matches!(everywhere.first(&far, 1e30), Err(TraceError::Far { ray: 0, .. })));
    assert!(matches!(
        everywhere.first(&ray([0.0; 3], [1.0; 3], 1e9), 0.01),
        Err(TraceError::Resolution { .. })
    ));
    let nothing =
        self::tracer("jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }");
    assert_eq!(hits(&nothing, &good, 0.01), []);
}

#[test]
fn a_field_that_says_nothing_of_boxes_takes_no_longer_than_the_limit() {
    // The range of the divisor holds 0 in every box.
    let tracer = tracer("jbt 1 expression { 0.2 / (x - x) }");
    let long = ray([0.0; 3], [1.0, 0.0, 0.0], 100.0);
    assert_eq!(tracer.any(&long, 0.1), Ok(false));
    assert_eq!(tracer.any(&long, 1e-5), Err(TraceError::Work { rays: 1 }));
}

/// Rays about random models, which are within 2 of the origin for the most part: from outside, from inside,
/// along axes, with any length of direction.
fn random_ray(rng: &mut Rng) -> Ray {
    let origin = unit(rng).map(|x| x * [0.3, 1.5, 4.0][rng.usize(0..3)]);
    let target = unit(rng).map(|x| x * 1.2 * rng.f64());
    let size = [1.0, 1.0, 0.02, 30.0][rng.usize(0..4)];
    let mut direction: [f64; 3] = std::array::from_fn(|axis| size * (target[axis] - origin[axis]));
    if rng.u8(0..4) == 0 {
        let axis = rng.usize(0..3);
        direction = [0.0; 3];
        direction[axis] = if rng.bool() { size } else { -size };
    }
    let length = dot(direction, direction).sqrt();
    let start = if rng.bool() { 0.0 } else { -2.0 * rng.f64() };
    Ray { origin, direction, span: [start, start + 3.0 + 3.0 * rng.f64()].map(|t| t / length) }
}

#[derive(Default)]
struct Tally {
    hits: AtomicU64,
    rays: AtomicU64,
    points: AtomicU64,
    dense: AtomicU64,
}

#[test]
fn random_models_are_hit_where_dense_sampling_says() {
    let default = if cfg!(debug_assertions) { 12 } else { short_or_long([100, 300]) };
    let (trees, seed) = (count("JBT_TRACE_TREES", default), count("JBT_TRACE_SEED", 0));
    let rays = count("JBT_TRACE_RAYS", 100) as usize;
    let tally = Tally::default();
    (seed..seed + trees).into_par_iter().for_each(|seed| try_model(seed, rays, &tally));
    let Tally { hits, rays, points, dense } = tally;
    let [hits, rays, points, dense] = [hits, rays, points, dense].map(AtomicU64::into_inner);
    println!("{rays} rays, {hits} hits, {points} points; {dense} points of dense sampling");
    if trees >= 10 {
        assert!(2 * hits > rays, "most rays hit something");
        assert!(points < dense / 4, "boxes spare points");
    }
}

fn try_model(seed: u64, count: usize, tally: &Tally) {
    let leaves = 1 + (seed % 13) as usize;
    let model = Random::new(seed, seed ^ 0x7a_ce00).model(leaves);
    let tree = model.check().expect("a random model is a good model");
    let compiler = match seed % 8 {
        0 => Compiler::for_engine(Engine::Lanes),
        _ => Compiler::new(),
    };
    let tracer = Tracer::new(&compiler, &tree, Query::ALL).expect("the model compiles");
    let field = compiler.evaluator(&tree, Query::FIELD).expect("the model compiles");
    let mut rng = Rng::with_seed(seed);
    let rays: Vec<Ray> = (0..count).map(|_| random_ray(&mut rng)).collect();
    let tolerance = [0.05, 0.02][rng.usize(0..2)];
    let what = |ray: usize| {
        format!("model {seed}, ray {ray} {:?}, tolerance {tolerance}\n{}", rays[ray], print(&model))
    };
    let all = tracer.all_of(&rays, tolerance).unwrap_or_else(|error| panic!("{error}, {}", what(0)));
    for (index, ray) in rays.iter().enumerate() {
        let mine = all.of(index);
        let dense = compare_dense(&field, tracer.iso(), ray, tolerance, &all, mine, &|| what(index));
        tally.dense.fetch_add(dense, Ordering::Relaxed);
    }
    let points = tracer.counters().points;
    tally.points.fetch_add(points, Ordering::Relaxed);
    tally.hits.fetch_add(all.len() as u64, Ordering::Relaxed);
    tally.rays.fetch_add(count as u64, Ordering::Relaxed);
    compare_samples(&compiler.evaluator(&tree, Query::ALL).expect("the model compiles"), &all, &|| what(0));
    compare_packets(&tracer, &mut rng, &rays, tolerance, &all, &|| what(0));
}

/// The field at places of a ray, rounded as everywhere.
fn sides(field: &Evaluator, iso: f32, ray: &Ray, times: &[f64]) -> Vec<bool> {
    let place = |t: &f64| std::array::from_fn(|axis| (ray.origin[axis] + t * ray.direction[axis]) as f32);
    let points: Points = times.iter().map(place).collect();
    let samples = answers(field, &points);
    samples.field().iter().map(|&value| value >= iso).collect()
}

/// Four points for each tolerance: every stretch that is longer is where the hits say, and every hit is a
/// change. Returns how many points.
fn compare_dense(
    field: &Evaluator,
    iso: f32,
    ray: &Ray,
    tolerance: f64,
    all: &Hits,
    mine: Range<usize>,
    what: &dyn Fn() -> String,
) -> u64 {
    let length = dot(ray.direction, ray.direction).sqrt();
    let [low, high] = ray.span;
    let count = (4.0 * (high - low) * length / tolerance).ceil();
    let times: Vec<f64> =
        (0..=count as u32).map(|i| (low + (high - low) * f64::from(i) / count).min(high)).collect();
    let inside = sides(field, iso, ray, &times);
    let hits: Vec<(f64, bool)> = mine.map(|hit| (all.t[hit], all.entering[hit])).collect();
    assert!(
        hits.windows(2).all(|pair| pair[0].1 != pair[1].1 && pair[0].0 <= pair[1].0),
        "{hits:?}, {}",
        what()
    );
    let precise = (tolerance / 1024.0).max(2e-6) / length;
    let told = |t: f64| match hits.iter().rfind(|hit| hit.0 <= t) {
        Some(hit) => Some(hit.1),
        None => hits.first().map(|hit| !hit.1),
    };
    let mut always = None;
    let mut start = 0;
    while start < times.len() {
        let run = inside[start..].iter().take_while(|&&side| side == inside[start]).count();
        let end = start + run;
        // A hit in a run is where something is too short for this sampling: that it is there, is checked
        // below.
        let cuts = hits.iter().map(|hit| hit.0).filter(|t| (times[start]..times[end - 1]).contains(t));
        let mut ends: Vec<f64> = cuts.collect();
        ends.insert(0, times[start]);
        ends.push(times[end - 1]);
        for piece in ends.windows(2).filter(|piece| (piece[1] - piece[0]) * length > tolerance * 1.0001) {
            let told = told(0.5 * (piece[0] + piece[1]));
            let told = told.unwrap_or_else(|| *always.get_or_insert(inside[start]));
            assert_eq!(told, inside[start], "in {piece:?}, {hits:?}, {}", what());
        }
        start = end;
    }
    for &(t, _) in &hits {
        let around: Vec<f64> =
            (-32..=32).map(|i| (t + precise * f64::from(i) / 32.0).clamp(low, high)).collect();
        let sides = sides(field, iso, ray, &around);
        assert!(sides.contains(&true) && sides.contains(&false), "nothing changes at {t}, {}", what());
    }
    times.len() as u64
}

/// A ray's places, as the documentation of `jbt::trace` defines them.
struct Places {
    step: f64,
    span: [f64; 2],
    /// The first and the last one.
    ends: [i64; 2],
}

impl Places {
    fn new(ray: &Ray, tolerance: f64) -> Self {
        let length = dot(ray.direction, ray.direction).sqrt();
        // Four binary digits.
        let step = f64::from_bits((tolerance / length).to_bits() & !((1 << 49) - 1));
        let ends = [(ray.span[0] / step).floor() as i64, (ray.span[1] / step).ceil() as i64];
        Self { step, span: ray.span, ends }
    }

    fn time(&self, place: i64) -> f64 {
        (place as f64 * self.step).clamp(self.span[0], self.span[1])
    }

    fn times(&self) -> Vec<f64> {
        (self.ends[0]..=self.ends[1]).map(|place| self.time(place)).collect()
    }
}

#[test]
fn rays_hit_what_is_defined_without_boxes() {
    let models = if cfg!(debug_assertions) { 6 } else { 72 };
    let seed = count("JBT_TRACE_SEED", 0);
    let [thin, hits] = [const { AtomicU64::new(0) }; 2];
    (seed..seed + models).into_par_iter().for_each(|seed| {
        let model = Random::new(seed, seed ^ 0x7417).model(1 + (seed % 17) as usize);
        let tree = model.check().expect("a random model is a good model");
        // The reference takes long.
        let (engine, rays) = [(Engine::Jit, 40), (Engine::Lanes, 40), (Engine::Jit, 40), (Engine::Scalar, 3)]
            [(seed % 4) as usize];
        let compiler = Compiler::for_engine(engine);
        let tracer = Tracer::new(&compiler, &tree, Query::FIELD).expect("the model compiles");
        let field = Compiler::new().evaluator(&tree, Query::FIELD).expect("the model compiles");
        let mut rng = Rng::with_seed(seed);
        let rays: Vec<Ray> = (0..rays).map(|_| random_ray(&mut rng)).collect();
        // Coarse, so that much is shorter.
        let tolerance = [0.3, 0.1, 0.03, 0.01][rng.usize(0..4)];
        let all = tracer.all_of(&rays, tolerance).expect("good rays");
        for (index, ray) in rays.iter().enumerate() {
            let places = Places::new(ray, tolerance);
            let times = places.times();
            let inside = sides(&field, tracer.iso(), ray, &times);
            let changes = (1..times.len()).filter(|&at| inside[at - 1] != inside[at]);
            let expected: Vec<([f64; 2], bool)> =
                changes.map(|at| ([times[at - 1], times[at]], inside[at])).collect();
            let what = || {
                format!(
                    "model {seed}, {engine}, ray {index} {ray:?}, tolerance {tolerance}\n{}",
                    print(&model)
                )
            };
            let found: Vec<(f64, bool)> = all.of(index).map(|hit| (all.t[hit], all.entering[hit])).collect();
            assert_eq!(found.len(), expected.len(), "{found:?}, not {expected:?}, {}", what());
            for (hit, (ends, entering)) in found.iter().zip(&expected) {
                assert!(
                    (ends[0]..=ends[1]).contains(&hit.0) && hit.1 == *entering,
                    "{hit:?}, not {expected:?}, {}",
                    what()
                );
            }
            // Posts are no farther apart than so many places.
            let far = 8.0 * places.step;
            let near = expected.windows(2).filter(|pair| pair[1].0[0] - pair[0].0[0] < far);
            thin.fetch_add(near.count() as u64, Ordering::Relaxed);
            hits.fetch_add(found.len() as u64, Ordering::Relaxed);
        }
        compare_packets(&tracer, &mut rng, &rays, tolerance, &all, &|| print(&model));
    });
    let [thin, hits] = [thin, hits].map(AtomicU64::into_inner);
    println!("{hits} hits, {thin} of them shortly behind another one");
    assert!(models < 60 || (thin > 80 && hits > 1000), "{thin} of {hits}");
}

/// What tracing asks about: boxes around parts of rays side by side, in the region of a longer part.
#[test]
fn ranges_of_parts_of_rays_hold_the_fields_at_their_places() {
    let models = if cfg!(debug_assertions) { 6 } else { short_or_long([8, 24]) };
    (0..models).into_par_iter().for_each(|seed| {
        let model = Random::new(seed, seed ^ 0xb0e5).model(1 + (seed % 17) as usize);
        let tree = model.check().expect("a random model is a good model");
        let compiler = Compiler::for_engine([Engine::Jit, Engine::Lanes][(seed % 2) as usize]);
        let pruner = Pruner::new(&compiler, &tree).expect("the model compiles");
        let field = Compiler::new().evaluator(&tree, Query::FIELD).expect("the model compiles");
        let mut rng = Rng::with_seed(seed);
        for _ in 0..30 {
            let (ray, step) = (random_ray(&mut rng), [0.5, 0.1, 0.02][rng.usize(0..3)]);
            let places = Places::new(&ray, step);
            let at = |place: i64| -> [f32; 3] {
                let t = places.time(place);
                std::array::from_fn(|axis| (ray.origin[axis] + t * ray.direction[axis]) as f32)
            };
            let hull = |part: [i64; 2]| {
                let ends = part.map(at);
                let side = |pick: fn(f32, f32) -> f32| {
                    std::array::from_fn(|axis| pick(ends[0][axis], ends[1][axis]))
                };
                Box3::new(side(f32::min), side(f32::max))
            };
            let all = places.ends;
            let whole = hull(all);
            let region = pruner.region(whole).expect("a proper box");
            let mut parts = Vec::new();
            for length in [1, 2, 8, 64] {
                let from = rng.i64(all[0]..all[1]);
                parts.push([from, (from + length).min(all[1])]);
            }
            let boxes: Vec<Box3> = parts.iter().map(|&part| hull(part)).collect();
            let mut regions = Vec::new();
            pruner.narrow(&region, &boxes, &mut regions).expect("proper boxes");
            let surveyed = pruner.survey(&region, &boxes, &|_| false).expect("proper boxes");
            for (index, part) in parts.iter().enumerate() {
                let mut ranges = [ANYTHING; 2];
                pruner.ranges(&region, &boxes[index..=index], &mut ranges[..1]).expect("proper boxes");
                pruner
                    .ranges(&regions[index], &boxes[index..=index], &mut ranges[1..])
                    .expect("proper boxes");
                let points: Points = (part[0]..=part[1]).map(at).collect();
                let samples = answers(&field, &points);
                for [low, high] in ranges.into_iter().chain([surveyed[index].0]) {
                    let holds = |value: &f32| [low, high] == ANYTHING || (low <= *value && *value <= high);
                    assert!(
                        samples.field().iter().all(holds),
                        "model {seed}: {:?} in {:?} are not in {low} .. {high}\n{}",
                        samples.field(),
                        boxes[index],
                        print(&model)
                    );
                }
            }
        }
    });
}

fn same(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(&a, &b)| bits::same(a, b))
}

/// Samples at hits are those of the plain evaluator at their positions.
fn compare_samples(full: &Evaluator, all: &Hits, what: &dyn Fn() -> String) {
    let samples = answers(full, &all.positions);
    for ((name, here), there) in full.layout().names().iter().zip(all.samples.planes()).zip(samples.planes())
    {
        assert!(same(here, there), "{name}, {}", what());
    }
}

/// Any packets give each ray the bits that it has alone.
fn compare_packets(
    tracer: &Tracer,
    rng: &mut Rng,
    rays: &[Ray],
    tolerance: f64,
    all: &Hits,
    what: &dyn Fn() -> String,
) {
    let mut order: Vec<usize> = (0..rays.len()).collect();
    rng.shuffle(&mut order);
    let mut rest = &order[..];
    while !rest.is_empty() {
        let (some, others) = rest.split_at(rng.usize(1..=rest.len().min(9)));
        rest = others;
        let packet: Vec<Ray> = some.iter().map(|&index| rays[index]).collect();
        let hits = tracer.all_of(&packet, tolerance).expect("they were good before");
        let first = tracer.first_of(&packet, tolerance).expect("they were good before");
        let any = tracer.any_of(&packet, tolerance).expect("they were good before");
        for (place, &index) in some.iter().enumerate() {
            compare_ranges(all, all.of(index), &hits, hits.of(place), what);
            let mut one = all.of(index);
            one.end = one.end.min(one.start + 1);
            compare_ranges(all, one, &first, first.of(place), what);
            assert_eq!(any.blocked[place], !all.of(index).is_empty(), "{}", what());
        }
    }
}

fn compare_ranges(a: &Hits, of_a: Range<usize>, b: &Hits, of_b: Range<usize>, what: &dyn Fn() -> String) {
    let bits = |hits: &Hits, of: &Range<usize>| -> Vec<u64> {
        hits.t[of.clone()].iter().map(|t| t.to_bits()).collect()
    };
    assert_eq!(bits(a, &of_a), bits(b, &of_b), "{}", what());
    assert_eq!(a.entering[of_a.clone()], b.entering[of_b.clone()], "{}", what());
    let planes = |hits: &Hits| -> Vec<Vec<f32>> {
        hits.positions
            .planes()
            .iter()
            .map(|plane| plane.to_vec())
            .chain(hits.samples.planes().iter().cloned())
            .collect()
    };
    for (a, b) in planes(a).iter().zip(planes(b)) {
        assert!(same(&a[of_a.clone()], &b[of_b.clone()]), "{}", what());
    }
}

#[test]
fn threads_share_a_tracer() {
    let mut rng = Rng::with_seed(3);
    let leaf = |_| jbt::build::point([0; 3].map(|_: i32| 2.0 * rng.f64() - 1.0), 0.3);
    let leaves: Vec<_> = (0..200).map(leaf).collect();
    let tree = Model::new(jbt::Tree::sum(leaves)).check().expect("a good model");
    let tracer = Tracer::new(&Compiler::new(), &tree, Query::ALL).expect("it compiles");
    let pixel = |x: usize, y: usize| {
        let [x, y] = [x, y].map(|i| 2.4 * (i as f64 + 0.5) / 32.0 - 1.2);
        ray([x, y, 3.0], [0.0, 0.0, -1.0], 6.0)
    };
    let rows: Vec<Vec<Ray>> = (0..32).map(|y| (0..32).map(|x| pixel(x, y)).collect()).collect();
    let together = tracer.first_of(&rows.concat(), 0.02).expect("good rays");
    let apart: Vec<Hits> =
        rows.par_iter().map(|row| tracer.first_of(row, 0.02).expect("good rays")).collect();
    let mut hit = 0;
    for (y, row) in apart.iter().enumerate() {
        for x in 0..32 {
            let (a, b) = (together.of(32 * y + x), row.of(x));
            hit += a.len();
            compare_ranges(&together, a, row, b, &String::new);
        }
    }
    assert!(hit > 300, "{hit}");
}
