//! Contours and images of models in planes: closed loops, their areas and lengths, borders, bits.
//!
//! `JBT_CONTOUR_MODELS` says how many random models are tried.
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

mod common;

use std::collections::HashSet;
use std::f64::consts::PI;

use common::answers;
use fastrand::Rng;
use jbt::build::{Axis, cuboid, point, segment, x, y, z};
use jbt::contour::{
    Contour, Detail, Fate, ImageDetail, ImageMode, Plane, Rectangle, SliceError, Slicer, circles,
};
use jbt::export::svg::{Paint, Style, write_svg};
use jbt::{CancelToken, Compiler, Engine, Evaluator, Fineness, Model, Points, Query, Tree};
use jbt_testkit::samples;
use jbt_testkit::scene::{self, tree as checked};

fn slicer(tree: &jbt::CheckedTree, plane: &str, query: Query) -> Slicer {
    Slicer::new(&Compiler::new(), tree, &plane.parse().expect("a plane"), query).expect("it compiles")
}

fn square(half: f64) -> Rectangle {
    Rectangle::new([-half; 2], [half; 2]).expect("a square")
}

fn detail(cells: usize) -> Detail {
    Detail { fineness: Fineness::Resolution(cells), ..Detail::default() }
}

fn contour(slicer: &Slicer, rectangle: &Rectangle, detail: &Detail) -> Contour {
    slicer.contour(rectangle, detail).run().expect("a contour")
}

fn of_text(text: &str, half: f64, cells: usize) -> Contour {
    contour(&slicer(&checked(text), "z=0", Query::ALL), &square(half), &detail(cells))
}

/// The vertices of a loop.
fn vertices(contour: &Contour, index: usize) -> &[[f32; 2]] {
    &contour.positions[contour.loops[index].start..contour.loops[index].end]
}

/// Whether a polygon goes around a point: crossings of a ray to the right.
fn encloses(polygon: &[[f32; 2]], [u, v]: [f32; 2]) -> bool {
    let crosses = |index: &usize| {
        let [[a, b], [c, d]] =
            [polygon[*index], polygon[(index + 1) % polygon.len()]].map(|p| p.map(f64::from));
        let (u, v) = (f64::from(u), f64::from(v));
        (b <= v) != (d <= v) && a + (v - b) / (d - b) * (c - a) > u
    };
    (0..polygon.len()).filter(crosses).count() % 2 == 1
}

/// What holds of every contour.
fn check_loops(contour: &Contour, what: &str) {
    let mut end = 0;
    let mut seen = HashSet::new();
    for (index, one) in contour.loops.iter().enumerate() {
        assert_eq!(one.start, end, "{what}");
        end = one.end;
        assert!(one.end - one.start >= 3, "{what}");
        assert_eq!(one.is_hole, one.area < 0.0, "{what}: {one:?}");
        assert_eq!(one.is_hole, one.depth % 2 == 1, "{what}: {one:?}");
        let mine = vertices(contour, index);
        assert!(
            mine.iter().all(|place| seen.insert(place.map(f32::to_bits))),
            "{what}: a vertex is used twice"
        );
        let around: Vec<usize> = (0..contour.loops.len())
            .filter(|&other| other != index && encloses(vertices(contour, other), mine[0]))
            .collect();
        assert_eq!(around.len(), one.depth, "{what}: {one:?}");
        match one.parent {
            Some(parent) => {
                assert!(around.contains(&parent), "{what}");
                assert_eq!(contour.loops[parent].depth + 1, one.depth, "{what}");
            }
            None => assert_eq!(one.depth, 0, "{what}"),
        }
    }
    assert_eq!(end, contour.positions.len(), "{what}");
}

/// Whether two segments cross or touch.
fn meet([a, b]: [[f32; 2]; 2], [c, d]: [[f32; 2]; 2]) -> bool {
    let side = |p: [f32; 2], q: [f32; 2], r: [f32; 2]| {
        let [p, q, r] = [p, q, r].map(|point| point.map(f64::from));
        ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).total_cmp(&0.0)
    };
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

/// No two segments cross, but neighbours touch.
fn check_crossings(contour: &Contour, what: &str) {
    let mut segments = Vec::new();
    for (index, one) in contour.loops.iter().enumerate() {
        let mine = vertices(contour, index);
        for at in 0..mine.len() {
            let next = (at + 1) % mine.len();
            segments.push(([mine[at], mine[next]], [one.start + at, one.start + next]));
        }
    }
    for (index, (first, ends)) in segments.iter().enumerate() {
        for (second, others) in &segments[index + 1..] {
            let neighbours = ends.iter().any(|end| others.contains(end));
            let near = (0..2).all(|axis| {
                let range = |s: &[[f32; 2]; 2]| [s[0][axis].min(s[1][axis]), s[0][axis].max(s[1][axis])];
                let ([a, b], [c, d]) = (range(first), range(second));
                a <= d && c <= b
            });
            assert!(neighbours || !near || !meet(*first, *second), "{what}: {first:?} {second:?}");
        }
    }
}

/// The part of segments that have the inside on their left, and the outside on their right.
fn oriented(tree: &jbt::CheckedTree, contour: &Contour) -> [usize; 2] {
    let evaluator = Evaluator::compile(tree, Query::FIELD).expect("it compiles");
    let mut points = Points::new();
    let step = 0.25 * contour.cell as f32;
    for index in 0..contour.loops.len() {
        let mine = vertices(contour, index);
        for at in 0..mine.len() {
            let [[a, b], [c, d]] = [mine[at], mine[(at + 1) % mine.len()]];
            let length = (c - a).hypot(d - b);
            if length > 0.5 * contour.cell as f32 {
                let (du, dv) = ((c - a) / length * step, (d - b) / length * step);
                let (u, v) = (0.5 * (a + c), 0.5 * (b + d));
                points.push([u - dv, v + du, 0.0]);
                points.push([u + dv, v - du, 0.0]);
            }
        }
    }
    let samples = answers(&evaluator, &points);
    let iso = tree.iso() as f32;
    let right = samples.field().chunks_exact(2).filter(|pair| pair[0] >= iso && pair[1] < iso).count();
    [right, points.len() / 2]
}

/// A model in the plane z = 0.
fn random(rng: &mut Rng) -> Model {
    let at = |rng: &mut Rng| [2.4 * rng.f64() - 1.2, 2.4 * rng.f64() - 1.2, 0.0];
    let mut trees: Vec<Tree> = Vec::new();
    for _ in 0..rng.usize(1..7) {
        let radius = 0.4 + 0.8 * rng.f64();
        let leaf = match rng.u8(0..4) {
            0 => segment(at(rng), at(rng), radius),
            1 => cuboid(at(rng), [0.1 + 0.4 * rng.f64(), 0.1 + 0.4 * rng.f64(), 0.2], radius),
            _ => point(at(rng), radius),
        };
        let leaf = leaf.color([rng.f64(), rng.f64(), rng.f64()]);
        trees.push(match rng.u8(0..5) {
            0 => leaf.strength(-0.2 - 0.6 * rng.f64()),
            1 => leaf.strength(0.7 + rng.f64()),
            _ => leaf,
        });
    }
    while trees.len() > 1 {
        let (a, b) = (trees.remove(0), trees.remove(rng.usize(0..trees.len())));
        let pair = [a, b];
        let tree = match rng.u8(0..7) {
            0 => Tree::union(pair),
            1 => Tree::difference(pair),
            2 => Tree::intersection(pair),
            3 => Tree::blend(2.0 + 3.0 * rng.f64(), pair),
            _ => Tree::sum(pair),
        };
        trees.push(match rng.u8(0..8) {
            0 => tree.rotate([0.0, 0.0, 1.0], 360.0 * rng.f64()),
            1 => tree.mirror(Axis::X),
            2 => tree.repeat_around(Axis::Z, f64::from(rng.u8(2..5))),
            3 => tree.warp([x() + 0.15 * (3.0 * y()).sin(), y() + 0.1 * (4.0 * x()).sin(), z()]),
            _ => tree,
        });
    }
    let root = trees.pop().expect("at least one");
    Model { iso: (0.3 + 0.3 * rng.f64()).into(), ..Model::new(root) }
}

/// Whether the area of the contour is within 1 % of that of the pixels inside, nine of them to a cell; and a
/// fiftieth of a cell along the contour and some pixels, for slivers and specks.
fn has_its_area(slicer: &Slicer, rectangle: &Rectangle, cells: usize) -> bool {
    let found = contour(slicer, rectangle, &detail(cells));
    let fine = ImageDetail { fineness: Fineness::Resolution(3 * cells), samples: 1 };
    let inside = slicer.inside(rectangle, &fine).run().expect("an image");
    let pixel = found.cell / 3.0;
    let area = pixel.powi(2) * inside.values.iter().filter(|&&part| part == 255).count() as f64;
    (found.area() - area).abs() <= 0.01 * area + 0.02 * found.cell * found.length() + 4.0 * pixel.powi(2)
}

fn models() -> u64 {
    scene::count("JBT_CONTOUR_MODELS", 1000)
}

#[test]
fn random_models_have_closed_simple_oriented_loops() {
    // Each is another shape: to make machine code of it would take longer than to run it.
    let compiler = Compiler::for_engine(Engine::Lanes);
    let mut oriented_segments = [0; 2];
    let (mut loops, mut holes, mut cut, mut refined) = (0, 0, 0, 0);
    for seed in 0..models() {
        let tree = random(&mut Rng::with_seed(seed)).check().expect("a good model");
        let slicer = Slicer::new(&compiler, &tree, &Plane::default(), Query::FIELD).expect("it compiles");
        // Some cut the solid.
        let rectangle = square(if seed % 3 == 0 { 1.0 } else { 2.6 });
        let found = contour(&slicer, &rectangle, &detail(192));
        let what = format!("model {seed}");
        check_loops(&found, &what);
        if seed % 25 == 0 {
            check_crossings(&found, &what);
        }
        // What is smaller than a cell is lost: then cells are too large for this model.
        let good = [192, 768, 1536].iter().find(|&&cells| has_its_area(&slicer, &rectangle, cells));
        assert!(good.is_some(), "{what}");
        refined += usize::from(good != Some(&192));
        if found.cut_sides == [false; 4] {
            let [right, all] = oriented(&tree, &found);
            oriented_segments = [oriented_segments[0] + right, oriented_segments[1] + all];
        } else {
            cut += 1;
        }
        loops += found.loops.len();
        holes += found.holes();
    }
    let [right, all] = oriented_segments;
    println!(
        "{loops} loops, {holes} of them holes; {cut} models cut, {refined} with smaller cells; {right} of {all} segments have the inside on the left"
    );
    assert!(right as f64 >= 0.99 * all as f64, "{right} of {all}");
}

#[test]
fn threads_and_blocks_change_no_bit() {
    let compiler = Compiler::new();
    let bits = |found: &Contour| {
        let places: Vec<u32> = found.positions.iter().flatten().map(|side| side.to_bits()).collect();
        let values: Vec<u32> =
            found.attributes.iter().flat_map(|group| &group.values).map(|value| value.to_bits()).collect();
        (places, values, found.loops.clone(), found.cut_sides)
    };
    for seed in 0..models().min(40) {
        let tree = random(&mut Rng::with_seed(seed)).check().expect("a good model");
        let slicer = Slicer::new(&compiler, &tree, &Plane::default(), Query::ALL).expect("it compiles");
        // The lattice is no square, and no multiple of a block.
        let rectangle = Rectangle::new([-1.5, -1.3], [0.8, 0.5 + seed as f64 / 20.0]).expect("a rectangle");
        let first = bits(&contour(&slicer, &rectangle, &detail(83)));
        for (threads, block, quadtree) in
            [(1, None, false), (7, None, true), (2, Some(1), true), (3, Some(2), false), (1, Some(64), false)]
        {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let detail = Detail { block, quadtree, ..detail(83) };
            let found = pool.install(|| contour(&slicer, &rectangle, &detail));
            assert_eq!(bits(&found), first, "model {seed}: {threads} threads, {block:?}");
        }
    }
}

#[test]
fn a_circle_converges() {
    let mut last = f64::INFINITY;
    for cells in [16, 32, 64, 128] {
        let found = of_text("jbt 1 point { surface_radius 1 }", 1.3, cells);
        assert_eq!((found.loops.len(), found.holes(), found.cut_sides), (1, 0, [false; 4]));
        let errors = [found.area() / PI - 1.0, found.length() / (2.0 * PI) - 1.0].map(f64::abs);
        let largest = errors[0].max(errors[1]);
        assert!(largest < 0.4 * last && errors[1] < errors[0], "{cells}: {errors:?}");
        last = largest;
        let far = found.positions.iter().map(|[u, v]| (f64::from(*u).hypot(f64::from(*v)) - 1.0).abs());
        assert!(far.fold(0.0, f64::max) < 2e-3 * found.cell);
    }
    assert!(last < 3e-4, "{last}");
}

#[test]
fn a_ring_has_a_hole_and_the_hole_an_island() {
    let text = "jbt 1 union {
        ring { ring_radius 1 surface_radius 0.25 }
        point { surface_radius 0.3 }
        point { at (2 0 0) surface_radius 0.2 }
    }";
    let found = of_text(text, 2.5, 100);
    check_loops(&found, "ring");
    let mut depths: Vec<usize> = found.loops.iter().map(|one| one.depth).collect();
    depths.sort_unstable();
    assert_eq!(depths, [0, 0, 1, 2]);
    let expected = PI * (1.25_f64.powi(2) - 0.75_f64.powi(2) + 0.09 + 0.04);
    assert!((found.area() / expected - 1.0).abs() < 2e-3);
    let length = 2.0 * PI * (1.25 + 0.75 + 0.3 + 0.2);
    assert!((found.length() / length - 1.0).abs() < 2e-3);
}

#[test]
fn the_border_closes_what_it_cuts() {
    // A quarter of a disc in the corner of the rectangle.
    let tree = checked("jbt 1 point { surface_radius 1 }");
    let slicer = slicer(&tree, "z=0", Query::ALL);
    let quarter = Rectangle::new([0.0, 0.0], [1.5, 1.5]).unwrap();
    let found = contour(&slicer, &quarter, &detail(64));
    assert_eq!((found.loops.len(), found.cut_sides), (1, [true, true, false, false]));
    assert!((found.area() / (PI / 4.0) - 1.0).abs() < 1e-3);
    assert!((found.length() / (2.0 + PI / 2.0) - 1.0).abs() < 1e-3);
    assert_eq!(found.positions[0], [0.0, 0.0], "the corner, from which the border goes straight");
    assert!(found.positions.iter().filter(|place| place[1] == 0.0).count() == 2);

    // All of the rectangle is inside: its border is the contour, whatever its squares are.
    let small = square(0.25);
    for block in [None, Some(1)] {
        let found = contour(&slicer, &small, &Detail { block, ..detail(50) });
        assert_eq!(found.positions, [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]]);
        assert_eq!((found.cut_sides, found.area(), found.length()), ([true; 4], 0.25, 2.0));
    }

    // A hole in a rectangle that is inside: nothing crosses its rows on the left but the border.
    let sieve =
        of_text("jbt 1 difference { half_space { at (0 0 9) radius 30 } point { radius 0.9 } }", 1.0, 64);
    check_loops(&sieve, "hole");
    assert_eq!((sieve.loops.len(), sieve.holes()), (2, 1));
}

#[test]
fn saddles_are_decided_by_their_middles() {
    // x y >= 1/2 - c about the origin: the corners of the middle cell are inside crosswise, its middle is at
    // the iso-value less c.
    for (constant, loops) in [(0.51, 1), (0.49, 2)] {
        let text = format!("jbt 1 expression {{ x * y + {constant} }}");
        let found = of_text(&text, 1.0, 7);
        check_loops(&found, &text);
        assert_eq!(found.loops.len(), loops, "{text}");
        assert_eq!(found.cut_sides, [true; 4]);
    }
}

#[test]
fn fields_at_the_iso_value_on_lattice_points_give_simple_loops() {
    // A checkerboard of lattice points that are exactly at the iso-value, and a plane along lattice lines.
    for text in [
        "jbt 1 expression { 0.5 + sin(x * 4)^2 * 0 }",
        "jbt 1 expression { 0.5 - abs(x) * abs(y) }",
        "jbt 1 expression { 0.5 - abs(x) - abs(y) }",
        "jbt 1 expression { 0.5 - abs(x) }",
        "jbt 1 expression { 0.75 - x }",
    ] {
        let found = of_text(text, 1.0, 16);
        check_loops(&found, text);
        check_crossings(&found, text);
    }
}

#[test]
fn slices_across_other_planes() {
    let tree = checked("jbt 1 translate (1 2 3) { sphere { sphere_radius 0.5 surface_radius 0.5 } }");
    for (plane, middle, away) in [
        ("x=1.2", [2.0, 3.0], 0.2_f64),
        ("y=1.7", [1.0, 3.0], 0.3),
        ("z=3", [1.0, 2.0], 0.0),
        ("1,2,3,1,1,0,0,0,1", [0.0, 0.0], 0.0),
        ("1,2,3.6,0,1,0,-1,0,0", [0.0, 0.0], 0.6),
    ] {
        let slicer = slicer(&tree, plane, Query::FIELD);
        let found = contour(&slicer, &slicer.rectangle().unwrap(), &detail(128));
        let radius = (1.0 - away * away).sqrt();
        assert!((found.area() / (PI * radius * radius) - 1.0).abs() < 2e-3, "{plane}: {}", found.area());
        for place in &found.positions {
            let far = (f64::from(place[0]) - middle[0]).hypot(f64::from(place[1]) - middle[1]);
            assert!((far - radius).abs() < 1e-4, "{plane}: {place:?}");
        }
    }
    // The plane misses the solid: no loops, and no error.
    let slicer = slicer(&tree, "z=10", Query::FIELD);
    let found = contour(&slicer, &slicer.rectangle().unwrap(), &detail(64));
    assert!(found.loops.is_empty() && found.positions.is_empty() && found.area() == 0.0);
}

#[test]
fn images_have_the_bits_of_the_field() {
    for seed in 0..models().min(40) {
        let tree = random(&mut Rng::with_seed(seed)).check().expect("a good model");
        let slicer =
            Slicer::new(&Compiler::new(), &tree, &Plane::default(), Query::ALL).expect("it compiles");
        let rectangle = Rectangle::new([-1.9, -1.4], [1.7, 1.2]).unwrap();
        let detail = ImageDetail { fineness: Fineness::Resolution(150), samples: 1 };
        let field = slicer.field_values(&rectangle, detail.fineness).run().unwrap();
        let step = 3.6 / 150.0;
        let points: Points = (0..field.values.len())
            .map(|index| {
                let (column, row) = (index % field.width, field.height - 1 - index / field.width);
                [-1.9 + step * (column as f64 + 0.5), -1.4 + step * (row as f64 + 0.5), 0.0].map(|c| c as f32)
            })
            .collect();
        let evaluator = Evaluator::compile(&tree, Query::FIELD).unwrap();
        let samples = answers(&evaluator, &points);
        let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<u32>>();
        assert_eq!(bits(&field.values), bits(samples.field()), "model {seed}");
        let inside = slicer.inside(&rectangle, &detail).run().unwrap();
        let iso = tree.iso() as f32;
        let expected: Vec<u8> = samples.field().iter().map(|&f| if f >= iso { 255 } else { 0 }).collect();
        assert_eq!(inside.values, expected, "model {seed}");
        let color = slicer.picture(&rectangle, &ImageMode::Attribute("color".to_owned()), &detail).run();
        let alpha: Vec<u8> = color.unwrap().pixels().iter().map(|pixel| pixel[3]).collect();
        assert_eq!(alpha, expected, "model {seed}");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap();
        assert_eq!(pool.install(|| slicer.inside(&rectangle, &detail).run()).unwrap(), inside);
    }
}

#[test]
fn several_samples_smooth_an_image() {
    let tree = checked("jbt 1 point { surface_radius 1 }");
    let slicer = slicer(&tree, "z=0", Query::FIELD);
    let smooth = ImageDetail { fineness: Fineness::Resolution(40), samples: 4 };
    let inside = slicer.inside(&square(1.2), &smooth).run().unwrap();
    let area = inside.values.iter().map(|&part| f64::from(part) / 255.0).sum::<f64>() * 0.06 * 0.06;
    assert!((area / PI - 1.0).abs() < 2e-3, "{area}");
    let grey = inside.values.iter().filter(|part| !matches!(part, 0 | 255)).count();
    assert!((60..200).contains(&grey), "{grey}");
}

#[test]
fn errors_say_what_is_wrong() {
    let tree = checked("jbt 1 half_space { radius 1 }");
    let unbounded = slicer(&tree, "z=0", Query::FIELD);
    assert!(matches!(unbounded.rectangle(), Err(SliceError::Unbounded)));
    let empty = checked("jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }");
    assert!(matches!(slicer(&empty, "z=0", Query::FIELD).rectangle(), Err(SliceError::Empty)));
    let fails = |detail: &Detail| unbounded.contour(&square(1.0), detail).run().unwrap_err();
    for block in [0, 3, 128] {
        let error = fails(&Detail { block: Some(block), ..Detail::default() });
        assert!(matches!(error, SliceError::Block { .. }), "{error}");
    }
    assert!(matches!(fails(&detail(0)), SliceError::Lattice(_)));
    assert!(matches!(fails(&detail(1 << 21)), SliceError::Lattice(_)));
    let image = |detail: ImageDetail, mode: ImageMode| {
        unbounded.picture(&square(1.0), &mode, &detail).run().unwrap_err()
    };
    let plain = ImageDetail::default();
    for samples in [0, 9] {
        let error = image(ImageDetail { samples, ..plain }, ImageMode::Inside);
        assert!(matches!(error, SliceError::Samples { .. }), "{error}");
    }
    let many = ImageDetail { fineness: Fineness::Resolution(1 << 20), samples: 1 };
    assert!(matches!(image(many, ImageMode::Inside), SliceError::TooManyPixels { .. }));
    let error = image(plain, ImageMode::Attribute("color".to_owned())).to_string();
    assert!(error.contains("no attribute `color`"), "{error}");
    let token = CancelToken::new();
    token.cancel();
    let cancelled = unbounded.contour(&square(1.0), &detail(64)).cancel(&token).run();
    assert!(matches!(cancelled, Err(SliceError::Cancelled)));
}

/// A model whose field is noise: every cell is crossed.
#[test]
fn noise_has_closed_loops_too() {
    let text = "jbt 1 expression { 0.5 + sin(x * 7411.7 + 37 * sin(y * 6271.7)) }";
    let found = of_text(text, 1.0, 60);
    check_loops(&found, text);
    assert!(found.loops.len() > 100 && found.holes() > 10, "{} {}", found.loops.len(), found.holes());
}

fn svg(contour: &Contour, style: &Style) -> String {
    let mut file = Vec::new();
    write_svg(contour, style, &mut file).expect("it is written");
    String::from_utf8(file).expect("text")
}

/// Requires that tags are closed in order, and attributes quoted.
fn check_xml(text: &str) {
    let mut open: Vec<&str> = Vec::new();
    for part in text.split('<').skip(1) {
        let (tag, rest) = part.split_once('>').expect("a tag ends");
        assert!(rest.trim().is_empty(), "no text between tags");
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let name = tag.trim_start_matches('/').split([' ', '/']).next().expect("a name");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn svg_files_are_well_formed_and_complete() {
    let tree = checked("jbt 1 color (1 0.5 0) { ring { ring_radius 1 surface_radius 0.25 } }");
    let slicer = slicer(&tree, "z=0", Query::ALL);
    let found = contour(&slicer, &square(1.5), &Detail { block: Some(1), quadtree: true, ..detail(64) });
    let style = Style {
        fill: Paint::Attribute("color".to_owned()),
        quadtree: true,
        circles: vec![([0.0, 0.5], 1.0)],
        ..Style::default()
    };
    let text = svg(&found, &style);
    check_xml(&text);
    assert!(text.contains("viewBox=\"-1.5 -1.5 3 3\"") && text.contains("matrix(1 0 0 -1 0 0)"));
    assert!(text.contains("fill=\"#ff8000\" fill-rule=\"evenodd\""));
    assert_eq!(text.matches("<circle").count(), 1);
    let coloured =
        Style { stroke: Paint::Attribute("color".to_owned()), fill: Paint::None, ..Style::default() };
    let text = svg(&found, &coloured);
    check_xml(&text);
    assert_eq!(text.matches("stroke=\"#ff8000\"").count(), 2, "a path for each loop");
    assert_eq!(text.matches('L').count(), found.positions.len());
    let missing = Style { fill: Paint::Attribute("rough".to_owned()), ..Style::default() };
    assert!(write_svg(&found, &missing, &mut Vec::new()).is_err());
    let nothing = contour(&slicer, &Rectangle::new([5.0; 2], [6.0; 2]).unwrap(), &detail(8));
    check_xml(&svg(&nothing, &Style::default()));
}

#[test]
fn the_twenty_circles_have_the_crossing_cells_of_the_quadtree() {
    let Some(folder) = samples::folder("quadtree") else { return };
    let mut reader = csv::Reader::from_path(folder.join("circles_seed1.csv")).expect("a table of circles");
    let rows: Vec<[f64; 5]> = reader.deserialize().collect::<Result<_, _>>().expect("five numbers a row");
    let leaves = rows.iter().map(|&[_, radius, x, _, z]| point([x, z, 0.0], radius));
    let tree = Model::new(Tree::sum(leaves)).check().expect("a good model");
    let slicer = slicer(&tree, "z=0", Query::FIELD);
    let quadtree = Detail { block: Some(1), quadtree: true, ..detail(256) };
    let found = contour(&slicer, &square(2.0), &quadtree);
    check_loops(&found, "circles");
    check_crossings(&found, "circles");
    let crossed = found.squares.iter().filter(|square| square.fate == Fate::Crossed).count();
    assert_eq!(crossed, 1_534);
    assert_eq!(
        found.levels.last().map(|level| (level.depth, level.cells, level.crossed)),
        Some((8, 1, 1_534))
    );
    assert_eq!(circles(&tree, &Plane::default()).len(), 20);
    println!(
        "{} loops, {} holes, area {}, length {}",
        found.loops.len(),
        found.holes(),
        found.area(),
        found.length()
    );
}

#[test]
fn a_program_of_instructions_is_drawn_as_its_field_says() {
    let Some(folder) = samples::folder("vm") else { return };
    let bytes = std::fs::read(folder.join("prospero.vm")).expect("a program");
    let tree = jbt::import::vm(&bytes).expect("it reads").model.check().expect("a good model");
    let slicer = slicer(&tree, "z=0", Query::FIELD);
    let detail = ImageDetail { fineness: Fineness::Resolution(256), samples: 1 };
    let image = slicer.inside(&square(1.0), &detail).run().expect("an image");
    let points: Points = (0..256 * 256)
        .map(|index| {
            let at = |index: usize| (-1.0 + (index as f64 + 0.5) / 128.0) as f32;
            [at(index % 256), at(255 - index / 256), 0.0]
        })
        .collect();
    let evaluator = Compiler::for_engine(Engine::Lanes).evaluator(&tree, Query::FIELD).expect("it compiles");
    let samples = answers(&evaluator, &points);
    let expected: Vec<u8> = samples.field().iter().map(|&f| if f >= 0.5 { 255 } else { 0 }).collect();
    assert!(image.values == expected, "every pixel is what its point says");
}
