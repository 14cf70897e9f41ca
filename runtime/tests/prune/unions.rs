//! Unions, intersections, differences and what is made of them: rows that win nowhere in a box are left out
//! there, be they primitives, sums or formulas, and no bit changes.

use std::fmt::Write as _;

use super::*;

/// What the operands of an operator are.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum OperandKind {
    Primitive,
    Curve,
    Sum,
    Formula,
    Nested,
    /// What is left of a union by a union: tables under the row.
    Difference,
    Smooth,
}

const KINDS: [OperandKind; 7] = [
    OperandKind::Primitive,
    OperandKind::Curve,
    OperandKind::Sum,
    OperandKind::Formula,
    OperandKind::Nested,
    OperandKind::Difference,
    OperandKind::Smooth,
];

fn place(rng: &mut Rng, range: f32) -> [f32; 3] {
    [(); 3].map(|()| range * (2.0 * rng.f32() - 1.0))
}

fn point(rng: &mut Rng) -> String {
    let [x, y, z] = place(rng, 1.5);
    format!("point {{ at ({x} {y} {z}) radius {} }}", 0.5 + 2.0 * rng.f32())
}

fn operand(rng: &mut Rng, kind: OperandKind) -> String {
    let [x, y, z] = place(rng, 1.5);
    let [u, v, w] = place(rng, 1.5);
    let colour = [(); 3].map(|()| rng.f32());
    let text = match kind {
        OperandKind::Primitive => point(rng),
        OperandKind::Curve => {
            format!("polyline {{ points (({x} {y} {z}) ({u} {v} {w}) ({y} {z} {x})) radius 1 }}")
        }
        OperandKind::Sum => {
            let points: String = (0..rng.usize(2..5)).map(|_| point(rng)).collect();
            format!("sum {{ {points} }}")
        }
        OperandKind::Formula => {
            format!("expression {{ 1 - sqrt((x - {x})^2 + (y - {y})^2 + (z - {z})^2) }}")
        }
        OperandKind::Nested => {
            format!("intersection {{ {} {} }}", point(rng), point(rng))
        }
        OperandKind::Difference => {
            let [left, right]: [String; 2] =
                [(); 2].map(|()| (0..rng.usize(1..7)).map(|_| point(rng)).collect());
            let set = ["union", "intersection"][rng.usize(0..2)];
            format!("difference {{ {set} {{ {left} }} {right} }}")
        }
        OperandKind::Smooth => {
            let points: String = (0..rng.usize(2..7)).map(|_| point(rng)).collect();
            let set = ["union", "intersection", "difference"][rng.usize(0..3)];
            format!("smooth_{set} width {} {{ {points} }}", 0.02 + 0.2 * rng.f32())
        }
    };
    format!("color ({} {} {}) {{ {text} }} ", colour[0], colour[1], colour[2])
}

/// Operators of operands of a few kinds, some of them the same, some of them different by a unit in the last
/// place.
fn operators(rng: &mut Rng) -> Model {
    const OPERATORS: [&str; 7] = [
        "union",
        "intersection",
        "difference",
        "smooth_union width 0.1",
        "smooth_intersection width 0.1",
        "smooth_difference width 0.1",
        "sum",
    ];
    let mut text = String::from("jbt 1 ");
    if rng.bool() {
        text += "attribute color 3 default (0 0 0) dominant ";
    }
    let outer = OPERATORS[[0, 0, 0, 1, 1, 2, 2, 2, 3, 4, 5][rng.usize(0..11)]];
    write!(text, "{outer} {{ ").unwrap();
    for _ in 0..rng.usize(1..4) {
        let kind = KINDS[rng.usize(0..KINDS.len())];
        let operands: Vec<String> = (0..rng.usize(6..40)).map(|_| operand(rng, kind)).collect();
        let again = rng.usize(0..operands.len());
        let all = operands.concat() + &operands[again];
        match rng.u8(0..4) {
            0 => write!(text, "{} {{ {all} }} ", OPERATORS[rng.usize(0..6)]).unwrap(),
            1 => write!(text, "twist axis z rate 0.4 {{ union {{ {all} }} }} ").unwrap(),
            _ => text += &all,
        }
    }
    text += "}";
    model(&text)
}

#[test]
fn rows_of_operators_of_any_kind_keep_the_bits() {
    let tally = Tally::default();
    (0..count("JBT_PRUNE_UNIONS", short_or_long([400, 1000]))).into_par_iter().for_each(|seed| {
        let model = operators(&mut Rng::with_seed(seed));
        try_model(&model, seed, 12, &tally);
    });
    let [rows, kept] = [tally.rows, tally.kept].map(AtomicU64::into_inner);
    println!("{rows} rows became {kept}");
    assert!(kept * 3 < rows, "most rows win nowhere");
}

/// A program of instructions: spheres and slabs, joined one after the other by minima and maxima, some of
/// them turned inside out.
fn program(rng: &mut Rng) -> Model {
    let mut text = String::from("_0 var-x\n_1 var-y\n_2 var-z\n");
    let mut lines = 3;
    let mut line = |what: String| {
        writeln!(text, "_{lines} {what}").unwrap();
        lines += 1;
        lines - 1
    };
    let mut so_far: Option<i32> = None;
    let cuts = rng.bool();
    for _ in 0..rng.usize(20..60) {
        let squares = [0, 1, 2].map(|axis| {
            let at = line(format!("const {}", 3.0 * rng.f32() - 1.5));
            let away = line(format!("sub _{axis} _{at}"));
            let op = if rng.u8(0..8) == 0 { "abs" } else { "square" };
            line(format!("{op} _{away}"))
        });
        let sum = line(format!("add _{} _{}", squares[0], squares[1]));
        let sum = line(format!("add _{sum} _{}", squares[2]));
        let (root, radius) = (line(format!("sqrt _{sum}")), line(format!("const {}", 0.1 + 0.4 * rng.f32())));
        let shape = line(format!("sub _{root} _{radius}"));
        so_far = Some(match so_far {
            None => shape,
            Some(before) if cuts && rng.bool() => {
                let outside = line(format!("neg _{shape}"));
                line(format!("max _{before} _{outside}"))
            }
            Some(before) if rng.u8(0..12) == 0 => line(format!("max _{before} _{shape}")),
            Some(before) => line(format!("min _{before} _{shape}")),
        });
    }
    jbt::import::vm(text.as_bytes()).expect("the program reads").model
}

#[test]
fn rows_of_programs_keep_the_bits() {
    let tally = Tally::default();
    (0..count("JBT_PRUNE_UNIONS", short_or_long([40, 200]))).into_par_iter().for_each(|seed| {
        try_model(&program(&mut Rng::with_seed(seed)), seed, 12, &tally);
    });
    let [rows, kept] = [tally.rows, tally.kept].map(AtomicU64::into_inner);
    println!("{rows} rows became {kept}");
    assert!(kept * 2 < rows, "most rows win nowhere");
}

/// How many rows of formulas and primitives are left in boxes of 1/128 of a cube's side, on average.
fn left(text: &str) -> f64 {
    let tree = tree(text);
    let pruner = Pruner::new(&Compiler::for_engine(Engine::Lanes), &tree).expect("it compiles");
    let mut rng = Rng::with_seed(7);
    let boxes = 64;
    let all = pruner.everywhere().rows();
    let rows: usize = (0..boxes)
        .map(|_| {
            let low = place(&mut rng, 1.0 - 1.0 / 64.0);
            let region = pruner.region(Box3::new(low, low.map(|side| side + 1.0 / 64.0))).expect("a region");
            region.rows()
        })
        .sum();
    let average = rows as f64 / f64::from(boxes);
    println!("{average:.1} rows of {all}");
    average
}

#[test]
fn of_a_thousand_spheres_a_few_are_left() {
    let many = |operand: &dyn Fn([f32; 3]) -> String| {
        let mut rng = Rng::with_seed(1);
        let operands: String = (0..1024).map(|_| operand(place(&mut rng, 1.0))).collect();
        format!("jbt 1 union {{ {operands} }}")
    };
    let smooth = |text: &str| text.replace("union", "smooth_union width 0.02");
    let primitives = many(&|[x, y, z]| format!("point {{ at ({x} {y} {z}) radius 3 }} "));
    assert!(left(&primitives) < 32.0);
    assert!(left(&smooth(&primitives)) < 64.0);
    let formulas =
        many(&|[x, y, z]| format!("expression {{ 0.6 - sqrt((x - {x})^2 + (y - {y})^2 + (z - {z})^2) }} "));
    assert!(left(&formulas) < 32.0);
    let sums = many(&|[x, y, z]| {
        let point = |x: f32| format!("point {{ at ({x} {y} {z}) radius 3 }} ");
        format!("sum {{ {} {} }} ", point(x), point(x + 0.01))
    });
    assert!(left(&sums) < 32.0);
}

/// Formulas that have a table each: balls of distances that are measured in six ways along each axis.
fn unlike() -> String {
    let along = |form: usize, axis: char, at: f32| match form {
        0 => format!("({axis} - {at})^2"),
        1 => format!("abs({axis} - {at})^3"),
        2 => format!("({axis} - {at})^2 + ({axis} - {at})^4"),
        3 => format!("2 * ({axis} - {at}) * sin({axis} - {at})"),
        4 => format!("max({axis} - {at}, 2 * ({at} - {axis}))^2"),
        _ => format!("exp(({axis} - {at})^2) - 1"),
    };
    let mut rng = Rng::with_seed(1);
    let formula = |form: usize| {
        let [x, y, z] = place(&mut rng, 1.0);
        let [x, y, z] = [along(form % 6, 'x', x), along(form / 6 % 6, 'y', y), along(form / 36, 'z', z)];
        format!("expression {{ 0.6 - sqrt({x} + {y} + {z}) }} ")
    };
    (0..216).map(formula).collect()
}

#[test]
fn of_formulas_that_are_unlike_a_few_are_left() {
    assert!(left(&format!("jbt 1 union {{ {} }}", unlike())) < 32.0);
    // Sixteen are fewer than are met one by one.
    let few: String = unlike().split_inclusive("} ").take(16).collect();
    assert!(left(&format!("jbt 1 union {{ {few} }}")) < 4.0);
    let model = model(&format!("jbt 1 union {{ {} }}", unlike()));
    (0..3).for_each(|shape| try_model(&model, shape, 12, &Tally::default()));
}

#[test]
fn of_a_thousand_holes_those_that_cut_are_left() {
    let many = |operand: &dyn Fn([f32; 3]) -> String| -> String {
        let mut rng = Rng::with_seed(1);
        (0..1024).map(|_| operand(place(&mut rng, 1.0))).collect()
    };
    let primitives = many(&|[x, y, z]| format!("point {{ at ({x} {y} {z}) radius 3 }} "));
    let formulas =
        many(&|[x, y, z]| format!("expression {{ 0.6 - sqrt((x - {x})^2 + (y - {y})^2 + (z - {z})^2) }} "));
    // The field of a slab is 0.4: what is subtracted matters where it is above 0.6, though a nearer one may
    // be larger.
    for holes in [&primitives, &formulas] {
        let slab = format!("jbt 1 difference {{ expression {{ 0.4 + 0 * x }} {holes} }}");
        assert!(left(&slab) < 32.0);
        let smooth = slab.replace("difference {", "smooth_difference width 0.02 {");
        assert!(left(&smooth) < 64.0);
    }
}

/// Rows that are left by themselves in boxes, of one difference or of many.
fn rows_in(text: &str, boxes: &[Box3]) -> Vec<usize> {
    let pruner = Pruner::new(&Compiler::for_engine(Engine::Lanes), &tree(text)).expect("it compiles");
    let rows = |bounds: &Box3| {
        let region = pruner.region(*bounds).expect("a proper box");
        let selection = region.selection();
        (0..selection.tables())
            .map(<jbt::internals::ir::Table as jbt::internals::ir::Entity>::new)
            .filter(|&table| pruner.everywhere().selection().active(table).len() >= 16)
            .map(|table| selection.active(table).len())
            .sum()
    };
    boxes.iter().map(rows).collect()
}

#[test]
fn holes_are_left_where_their_balls_touch_the_box() {
    // 0.6 - distance is above 2 iso - 0.7 = 0.3 within 0.3 of a centre. Centres are far from each other.
    let centre = |index: usize| [index % 4, index / 4 % 4, index / 16].map(|i| 2.0 * i as f32);
    let holes: String = (0..64)
        .map(|index| {
            let [x, y, z] = centre(index);
            format!("expression {{ 0.6 - sqrt((x - {x})^2 + (y - {y})^2 + (z - {z})^2) }} ")
        })
        .collect();
    let plain = format!("jbt 1 difference {{ expression {{ 0.7 + 0 * x }} {holes} }}");
    // The same in rows: a union of differences of unions, each of a quarter of the holes.
    let quarters: Vec<String> =
        holes.split_inclusive("} ").collect::<Vec<_>>().chunks(16).map(<[&str]>::concat).collect();
    let nested: String = (quarters.iter())
        .map(|holes| format!("difference {{ expression {{ 0.7 + 0 * x }} {holes} }} "))
        .collect();
    let nested = format!("jbt 1 intersection {{ {nested} }}");
    let mut rng = Rng::with_seed(3);
    let boxes: Vec<Box3> = (0..200)
        .map(|_| {
            let low = [(); 3].map(|()| 6.0 * rng.f32());
            Box3::new(low, low.map(|side| side + 0.1))
        })
        .collect();
    // The distance of a box from a centre.
    let distance = |bounds: &Box3, centre: [f32; 3]| {
        let gap =
            |axis: usize| (bounds.low[axis] - centre[axis]).max(centre[axis] - bounds.high[axis]).max(0.0);
        [0, 1, 2].map(|axis| gap(axis).powi(2)).iter().sum::<f32>().sqrt()
    };
    let within = |bounds: &Box3, by: f32| (0..64).filter(|&i| distance(bounds, centre(i)) < by).count();
    let mut some = 0;
    for text in [&plain, &nested] {
        for (bounds, left) in boxes.iter().zip(rows_in(text, &boxes)) {
            // What touches by less than a rounding may be left or not.
            let (least, most) = (within(bounds, 0.3 - 1e-5), within(bounds, 0.3 + 1e-5));
            assert!((least..=most).contains(&left), "{left} rows, {least} to {most} in {bounds:?}");
            some += left;
        }
    }
    assert!(some > 0, "some boxes touch something");
}

#[test]
fn what_is_cut_away_is_not_looked_at() {
    // The hole is deep in all of the box, so it decides, whatever it is cut out of.
    let points = |set: &str| -> String {
        let mut rng = Rng::with_seed(5);
        let points: String = (0..40)
            .map(|_| {
                let [x, y, z] = place(&mut rng, 0.3);
                format!("expression {{ 0.9 - 0.1 * sqrt((x - {x})^2 + (y - {y})^2 + (z - {z})^2) }} ")
            })
            .collect();
        // Two differences, so that they are rows: a guard would leave the left side out as a whole.
        let one = format!("difference {{ {set} {{ {points} }} expression {{ 0.8 + 0 * x }} }} ");
        format!("jbt 1 intersection {{ {one} {one} }}")
    };
    let bounds = [Box3::new([-0.1; 3], [0.1; 3])];
    // A union keeps one row that is larger.
    assert_eq!(rows_in(&points("union"), &bounds), [2]);
    assert_eq!(rows_in(&points("intersection"), &bounds), [0]);
}

#[test]
fn a_thing_and_its_complement_are_everything() {
    let pruner = |text: &str| Pruner::new(&Compiler::for_engine(Engine::Lanes), &tree(text)).unwrap();
    let bounds = Box3::new([-1.0; 3], [1.0; 3]);
    for thing in [
        "point { at (0 0 0) radius 1 }",
        "sum { point { at (0 0 0) radius 1 } box { half (0.2 0.3 0.4) radius 1 } }",
    ] {
        for (set, expected) in [("union", [0.5, f32::INFINITY]), ("intersection", [f32::NEG_INFINITY, 0.5])] {
            let text = format!("jbt 1 let a = {thing} {set} {{ use a complement {{ use a }} }}");
            let pruner = pruner(&text);
            let mut ranges = [ANYTHING];
            pruner.ranges(&pruner.everywhere(), &[bounds], &mut ranges).unwrap();
            let [low, high] = ranges[0];
            assert!(expected[0] <= low && high <= expected[1], "{set}: {low} to {high}");
        }
    }
}
