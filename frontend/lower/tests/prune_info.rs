//! What `PruneInfo` says holds to the bit: supports, rules and decisions, tried at points of random models.

use fastrand::Rng;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use jbt_ir::domain::scalar::Scalar;
use jbt_ir::pass::{PIPELINE, run_pipeline};
use jbt_ir::{Table, Tables, Verified, interpret, verify};
use jbt_lower::prune_info::{ContestKind, LARGEST_COORDINATE, Rule, Support, SupportSpace};
use jbt_lower::{RangeFunction, lower_ranges};
use jbt_model::check::CheckedTree;
use jbt_model::combine::Extreme;
use jbt_model::falloff::Falloff;
use jbt_model::kind::{NodeKind, Primitive};
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::skeleton::{Point, Skeleton};
use jbt_model::tree::Tree;
use jbt_testkit::bits::assert_same;
use jbt_testkit::random::{Random, Settings, vector};
use jbt_testkit::scene::{self, compiled};
use jbt_testkit::skip::short_or_long;
use jbt_text::print;

fn under(maps: impl IntoIterator<Item = NodeKind>, leaf: Primitive) -> Model {
    let leaf = Tree::new(NodeKind::Primitive(leaf), Vec::new());
    Model::new(maps.into_iter().fold(leaf, |tree, map| Tree::new(map, vec![tree])))
}

/// A random model of so many leaves.
fn model(seed: u64, leaves: usize, negative: bool) -> Model {
    Random::with_settings(seed, !seed, Settings { negative, ..Settings::default() }).model(leaves)
}

/// The support of the whole model: that of the scene's row.
fn support(tree: &CheckedTree) -> Support {
    let ranges = lower_ranges(tree).expect("it can be lowered");
    let info = ranges.info.tables.values().next().expect("there is the scene");
    assert_eq!((info.space, info.rule), (SupportSpace::World, Rule::Never));
    info.supports[0]
}

/// A point outside of a support, hardly or by up to a thousandth; `None` if all directions from the inside
/// stay inside.
fn outside(support: &Support, rng: &mut Rng) -> Option<[f32; 3]> {
    let out = |p: [f32; 3]| support.misses(p, p);
    let from: [f32; 3] =
        std::array::from_fn(|k| support.low[k] + rng.f32() * (support.high[k] - support.low[k]));
    let size = (0..3).map(|k| support.high[k] - support.low[k]).fold(support.radius_squared.sqrt(), f32::max);
    let mut way = DVec3::from(vector(rng, 1.0));
    if rng.bool() {
        // Along an axis, where boxes are as large as what they are around.
        way = way.signum() * DVec3::AXES[rng.usize(..3)];
    }
    let way = way.normalize().as_vec3().to_array();
    let at = |t: f32| std::array::from_fn(|k| from[k] + t * way[k]);
    let (mut inside, mut outside) = (0.0f32, 4.0 * size);
    if !size.is_finite() || !out(at(outside)) {
        return None;
    }
    while let middle = 0.5 * (inside + outside)
        && inside < middle
        && middle < outside
    {
        if out(at(middle)) { outside = middle } else { inside = middle }
    }
    let farther = if rng.bool() { 0.0 } else { 10f32.powf(-3.0 - 5.0 * rng.f32()) };
    let point = at(outside * (1.0 + farther));
    out(point).then_some(point)
}

/// Tries points hardly outside; returns how many.
fn silent_outside(tree: &CheckedTree, points: usize, rng: &mut Rng, what: &str) -> usize {
    let support = support(tree);
    let (program, tables) = compiled(tree, Query::GRADIENT);
    let mut tried = 0;
    for _ in 0..points {
        let Some(point) = outside(&support, rng) else { continue };
        if point.iter().any(|x| x.abs() > LARGEST_COORDINATE) {
            continue;
        }
        tried += 1;
        let answers = interpret::run(&program, &tables, &mut Scalar, &point);
        assert_eq!(
            answers[0].to_bits(),
            0,
            "{what}: the field at {point:?}, outside of {support:?}: {answers:?}"
        );
        assert!(answers[1..].iter().all(|&g| g == 0.0), "{what}: the gradient at {point:?}: {answers:?}");
    }
    tried
}

/// A map of any size and place.
fn wild_affine(rng: &mut Rng) -> DAffine3 {
    let mut log = |low: f64, high: f64| 10f64.powf(low + (high - low) * rng.f64());
    let (size, far, stretch) = (log(-3.0, 3.0), log(-3.0, 4.0), log(-2.0, 2.0));
    let turn = DMat3::from_quat(DQuat::from_vec4(vector(rng, 1.0).map(|x| x + 0.1).into_vec4()).normalize());
    let to = far * DVec3::from(vector(rng, 1.0));
    let matrix = match rng.u8(..5) {
        0 => DMat3::IDENTITY,
        1 => DMat3::from_diagonal(DVec3::splat(size)),
        2 => size * turn,
        3 => turn * DMat3::from_diagonal(size * DVec3::new(1.0, stretch, 1.0)),
        _ => turn * DMat3::from_diagonal(size * DVec3::new(1.0, stretch, -0.3)) * turn,
    };
    DAffine3::from_mat3_translation(matrix, to)
}

trait IntoVec4 {
    fn into_vec4(self) -> glam::DVec4;
}

impl IntoVec4 for [f64; 3] {
    fn into_vec4(self) -> glam::DVec4 {
        glam::DVec4::new(self[0], self[1], self[2], 0.4)
    }
}

#[test]
fn a_leaf_is_silent_outside_of_its_support() {
    let (mut rng, mut random) = (Rng::with_seed(1), Random::new(1, 1));
    let mut tried = 0;
    for index in 0..3000 {
        let maps = (0..rng.usize(..3)).map(|_| NodeKind::Affine(wild_affine(&mut rng))).collect::<Vec<_>>();
        let mut leaf = random.primitive();
        leaf.radius = 10f64.powf(2.0 - 5.0 * rng.f64());
        let model = under(maps, leaf);
        let Ok(tree) = model.check() else { continue };
        tried += silent_outside(&tree, 60, &mut rng, &format!("leaf {index}\n{}", print(&model)));
    }
    assert!(tried > 100_000, "{tried} points");
}

#[test]
fn a_warped_leaf_is_silent_outside_of_its_support() {
    let (mut rng, mut random) = (Rng::with_seed(2), Random::new(2, 2));
    let mut tried = 0;
    for index in 0..1200 {
        let mut maps = Vec::new();
        for _ in 0..rng.usize(1..4) {
            maps.push(NodeKind::Affine(random.affine()));
            maps.push(random.warp());
        }
        maps.push(NodeKind::Affine(wild_affine(&mut rng)));
        let model = under(maps, random.primitive());
        let tree = model.check().expect("its numbers are ordinary");
        tried += silent_outside(&tree, 60, &mut rng, &format!("leaf {index}\n{}", print(&model)));
    }
    assert!(tried > 20_000, "{tried} points");
}

#[test]
fn a_tree_is_silent_outside_of_its_support() {
    let mut rng = Rng::with_seed(3);
    let mut tried = 0;
    for index in 0..700 {
        let model = model(index, 1 + index as usize % 16, index % 2 == 0);
        let tree = model.check().expect("its numbers are ordinary");
        tried += silent_outside(&tree, 40, &mut rng, &format!("tree {index}\n{}", print(&model)));
    }
    assert!(tried > 15_000, "{tried} points");
}

/// Where a map goes far, its rounding takes a good part of a small leaf.
#[test]
fn small_leaves_far_away_are_silent_outside_of_their_supports() {
    let mut rng = Rng::with_seed(6);
    let mut tried = 0;
    for index in 0..400 {
        // Two that are far apart, so that coordinates count from the world.
        let mut leaf = |side: f64| {
            let to = side * (DVec3::splat(700.0) + DVec3::from(vector(&mut rng, 300.0)));
            let flat = DMat3::from_diagonal(DVec3::new(1.0, [1.0, 0.1, 0.01][rng.usize(..3)], 1.0));
            let turned =
                DMat3::from_rotation_x(6.0 * rng.f64()) * flat * DMat3::from_rotation_z(6.0 * rng.f64());
            let map = NodeKind::Affine(DAffine3::from_mat3_translation(turned, to));
            let (at, radius) = (DVec3::from(vector(&mut rng, 0.1)), 1e-3 * (0.5 + rng.f64()));
            let skeleton = Skeleton::from(Point { at });
            let leaf = Primitive { skeleton, falloff: Falloff::Soft, radius, strength: 1.0 };
            Tree::new(map, vec![Tree::new(NodeKind::Primitive(leaf), Vec::new())])
        };
        let tree = Model::new(Tree::sum([leaf(1.0), leaf(-1.0)])).check().expect("its numbers are ordinary");
        assert!(tree.origin().is_world());
        let ranges = lower_ranges(&tree).expect("it can be lowered");
        let (program, tables) = compiled(&tree, Query::FIELD);
        for support in ranges.info.tables.values().skip(1).flat_map(|table| table.supports.iter()) {
            for _ in 0..40 {
                let Some(point) = outside(support, &mut rng) else { continue };
                tried += 1;
                let field = interpret::run(&program, &tables, &mut Scalar, &point)[0];
                assert_eq!(field.to_bits(), 0, "tree {index}: {field} at {point:?}, outside of {support:?}");
            }
        }
    }
    assert!(tried > 20_000, "{tried} points");
}

#[test]
fn supports_of_points_are_no_larger_than_they_have_to_be() {
    let (mut rng, mut random) = (Rng::with_seed(4), Random::new(4, 4));
    for _ in 0..2000 {
        let map = random.affine();
        let (at, radius) = (DVec3::from(vector(&mut rng, 1.0)), 0.1 + rng.f64());
        let skeleton = Skeleton::from(Point { at });
        let leaf = Primitive { skeleton, falloff: Falloff::Soft, radius, strength: 1.0 };
        let tree = under([NodeKind::Affine(map)], leaf).check().expect("its numbers are ordinary");
        let support = support(&tree);
        let (program, tables) = compiled(&tree, Query::FIELD);
        let (axis, side) = (rng.usize(..3), if rng.bool() { 1.0 } else { -1.0 });
        // Where the image of the ball reaches farthest along an axis.
        let farthest = map.matrix3.transpose() * (side * DVec3::AXES[axis]);
        let reach =
            |part: f64| map.transform_point3(at + farthest.normalize() * radius * part).as_vec3().to_array();
        let field = interpret::run(&program, &tables, &mut Scalar, &reach(1.0 - 1e-3))[0];
        assert!(field > 0.0 && !support.misses(reach(1.0 - 1e-3), reach(1.0 - 1e-3)));
        let beyond = reach(1.0 + 1e-3);
        assert!(support.misses(beyond, beyond), "{support:?} holds {beyond:?}");
    }
}

#[test]
fn a_turned_segment_has_its_ends_and_not_a_turned_box() {
    let text = "jbt 1 rotate axis z degrees 45 { segment { from (0 0 0) to (1 0 0) radius 0.1 } }";
    let tree = scene::tree(text);
    let support = support(&tree);
    let half = 0.5f32.sqrt();
    for (side, expected) in support.low.iter().chain(&support.high).zip([0.0, 0.0, 0.0, half, half, 0.0]) {
        assert!((side - expected).abs() < 1e-5, "{support:?}");
    }
    assert!((support.radius_squared - 0.01).abs() < 1e-5);
    // The corner of the box around it that a box would have, and a rounded one has not.
    assert!(support.misses([-0.08, -0.08, 0.0], [-0.08, -0.08, 0.0]));
    assert!(!support.misses([-0.05, -0.05, 0.0], [-0.05, -0.05, 0.0]));
}

#[test]
fn what_could_overflow_is_bounded_by_nothing() {
    // In the coordinates of the smallest leaf, squares of those of the farthest points are no numbers.
    for (scale, bounded) in [("1e-6", true), ("1e-14", true), ("1e-15", false)] {
        for place in ["(0 0 0)", "(1 2 3)"] {
            let text = format!("jbt 1 translate {place} {{ scale {scale} {{ point {{ radius 1 }} }} }}");
            assert_eq!(support(&scene::tree(&text)) != Support::EVERYWHERE, bounded, "{text}");
        }
    }
    // A map so flat that rounding may take any point anywhere.
    for (flat, bounded) in [("0.1", true), ("1e-3", true), ("1e-9", false)] {
        let below = "twist axis z rate 0.1 { point { radius 1 } }";
        let text = format!("jbt 1 scale (1 1 {flat}) {{ rotate axis y degrees 30 {{ {below} }} }}");
        assert_eq!(support(&scene::tree(&text)) != Support::EVERYWHERE, bounded, "{text}");
    }
    // Slopes of what weighs a warp multiply.
    for (count, bounded) in [(1, true), (2, true), (3, false)] {
        let (before, after) = ("twist axis z rate 0.1 weighted { ", " point { radius 4 } }");
        let below = "sum { point { radius 1 } point { radius 2 } }";
        let text = format!("jbt 1 {} {below} {}", before.repeat(count), after.repeat(count));
        let info = lower_ranges(&scene::tree(&text)).expect("it can be lowered").info;
        let points = info.tables.values().last().expect("there are tables");
        assert_eq!(points.supports[..] != [Support::EVERYWHERE; 2], bounded, "{text}: {points:?}");
    }
}

/// Supports say nothing about a formula, whatever stands beside it: its rows are operands to decide on.
#[test]
fn rows_that_hold_formulas_have_a_probe() {
    let decided = |part: &str| {
        let row = |at: u32| format!("sum {{ {part} point {{ at ({at} 0 0) radius 1 }} }}");
        let tree = scene::tree(&format!("jbt 1 union {{ {} {} }}", row(1), row(2)));
        let info = lower_ranges(&tree).expect("it can be lowered").info;
        !info.decisions.is_empty()
    };
    assert!(decided("expression { x - y }"));
    assert!(!decided("ring { ring_radius 1 radius 1 }"));
}

#[test]
fn contests_begin_where_their_operator_does() {
    let contest = |text: &str| {
        let ranges = lower_ranges(&scene::tree(&format!("jbt 1 {text}"))).expect("it can be lowered");
        let [contest] = &ranges.info.contests[..] else { panic!("{:?}", ranges.info.contests) };
        (contest.extreme, contest.kind)
    };
    let positive = "point { radius 1 } point { radius 2 }";
    let negative = "point { radius 1 } point { radius 2 strength -1 }";
    let all = |extreme, start| (extreme, ContestKind::All(start));
    assert_eq!(contest(&format!("union {{ {positive} }}")), all(Extreme::Largest, Some(0.0)));
    assert_eq!(contest(&format!("union {{ {negative} }}")), all(Extreme::Largest, None));
    assert_eq!(contest(&format!("intersection {{ {positive} }}")), all(Extreme::Smallest, None));
}

/// Counts of what was left out, by reason.
#[derive(Default, Debug)]
struct Tally {
    zero: usize,
    probed: usize,
    alone: usize,
    decided: [usize; 4],
    points: usize,
}

/// Leaves out all that `PruneInfo` allows at a point.
fn prune(
    ranges: &RangeFunction,
    tables: &Tables,
    point: [f32; 3],
    probes: &[f32],
    tally: &mut Tally,
) -> Tables {
    let mut pruned = tables.clone();
    for (table, info) in ranges.info.tables.iter() {
        let at = match info.space {
            SupportSpace::World => point,
            SupportSpace::Probed(first) => std::array::from_fn(|k| probes[first + k]),
            SupportSpace::Unknown => continue,
        };
        let rows = &mut pruned.tables[table];
        let zero = |row: &u32| info.supports[*row as usize].misses(at, at);
        let (mut active, mut starts) = (Vec::new(), vec![0]);
        for parent in 0..rows.starts.len() - 1 {
            let range = rows.range(parent);
            let first = range.iter().position(zero);
            let stays = |(place, row): (usize, &u32)| match info.rule {
                Rule::Neutral => !zero(row),
                Rule::KeepOne => !zero(row) || Some(place) == first,
                Rule::OnlyZero => first.is_none() || Some(place) == first,
                Rule::Never => true,
            };
            active.extend(
                range.iter().enumerate().filter(|&(place, row)| stays((place, row))).map(|(_, row)| row),
            );
            starts.push(active.len() as u32);
        }
        let out = rows.active.len() - active.len();
        match (info.rule, info.space) {
            (Rule::OnlyZero, _) => tally.alone += out,
            (_, SupportSpace::Probed(_)) => tally.probed += out,
            (Rule::Neutral | Rule::KeepOne | Rule::Never, _) => tally.zero += out,
        }
        (rows.active, rows.starts) = (active, starts);
    }
    for decision in &ranges.info.decisions {
        let [operand, node] = [decision.operand, decision.node].map(|probe| [probes[probe]; 2]);
        let rows = &mut pruned.tables[decision.table];
        assert_eq!(rows.len(), 1, "a guard has one row");
        if !rows.active.is_empty() && decision.kind.spares(operand, node, ranges.info.iso2) {
            tally.decided[decision.kind as usize] += 1;
            rows.active.clear();
            rows.starts = vec![0, 0];
        }
    }
    pruned
}

fn run(program: &Verified, tables: &Tables, point: &[f32; 3]) -> Vec<f32> {
    interpret::run(program, tables, &mut Scalar, point)
}

/// The same rows active.
fn with_active(tables: &Tables, active: &Tables) -> Tables {
    let mut result = tables.clone();
    for table in tables.tables.keys().collect::<Vec<Table>>() {
        result.tables[table].active.clone_from(&active.tables[table].active);
        result.tables[table].starts.clone_from(&active.tables[table].starts);
    }
    result
}

#[test]
fn leaving_out_what_may_be_changes_no_bit() {
    let mut rng = Rng::with_seed(5);
    let mut tally = Tally::default();

    let models = short_or_long([300, 1000]);
    for index in 0..models {
        let model = model(index, 2 + index as usize % 24, index % 3 == 0);
        let tree = model.check().expect("its numbers are ordinary");
        let ranges = lower_ranges(&tree).expect("it can be lowered");
        assert_eq!(ranges.function.outputs.len(), 1 + ranges.info.probes);
        ranges.tables.check(&ranges.function).expect("its rows fit");
        let function = run_pipeline(ranges.function.clone(), PIPELINE, &mut |_, _| {});
        let probing = verify(function).expect("passes keep the rules");
        let (full, tables) = compiled(&tree, Query::ALL);
        for _ in 0..25 {
            let point: [f32; 3] = vector(&mut rng, 1.8).map(|x| x as f32);
            tally.points += 1;
            let expected = run(&full, &tables, &point);
            let mut active = ranges.tables.clone();
            // Twice: what is left out is left out of the range function, too.
            for round in 0..2 {
                let probes = run(&probing, &active, &point);
                assert_eq!(probes[0].to_bits(), expected[0].to_bits(), "the range function has the field");
                active = prune(&ranges, &active, point, &probes[1..], &mut tally);
                let pruned = with_active(&tables, &active);
                pruned.check(full.function()).expect("fewer rows fit as well");
                let found = run(&full, &pruned, &point);
                let what = format!("tree {index}, round {round}, {point:?} of\n{}", print(&model));
                assert_same(&[&expected], &[&found], &what);
            }
        }
    }
    let models = models as usize;
    assert!(tally.zero > 10 * models && tally.probed > 3 * models, "{tally:?}");
    assert!(100 * tally.alone > 3 * models, "{tally:?}");
    assert!(tally.decided.iter().all(|&count| 1000 * count > 15 * models), "{tally:?}");
}
