//! Unions, intersections and what is made of them: rows that win nowhere in a box are left out there, be they
//! primitives, sums or formulas, and no bit changes.

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
}

const KINDS: [OperandKind; 5] =
    [OperandKind::Primitive, OperandKind::Curve, OperandKind::Sum, OperandKind::Formula, OperandKind::Nested];

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
    };
    format!("color ({} {} {}) {{ {text} }} ", colour[0], colour[1], colour[2])
}

/// Operators of operands of a few kinds, some of them the same, some of them different by a unit in the last
/// place.
fn operators(rng: &mut Rng) -> Model {
    const OPERATORS: [&str; 6] = [
        "union",
        "intersection",
        "difference",
        "smooth_union width 0.1",
        "smooth_intersection width 0.1",
        "sum",
    ];
    let mut text = String::from("jbt 1 ");
    if rng.bool() {
        text += "attribute color 3 default (0 0 0) dominant ";
    }
    let outer = OPERATORS[[0, 0, 0, 1, 1, 2, 3, 4][rng.usize(0..8)]];
    write!(text, "{outer} {{ ").unwrap();
    for _ in 0..rng.usize(1..4) {
        let kind = KINDS[rng.usize(0..KINDS.len())];
        let operands: Vec<String> = (0..rng.usize(6..40)).map(|_| operand(rng, kind)).collect();
        let again = rng.usize(0..operands.len());
        let all = operands.concat() + &operands[again];
        match rng.u8(0..4) {
            0 => write!(text, "{} {{ {all} }} ", OPERATORS[rng.usize(0..5)]).unwrap(),
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
    (0..count("JBT_PRUNE_UNIONS", 1000)).into_par_iter().for_each(|seed| {
        let model = operators(&mut Rng::with_seed(seed));
        try_model(&model, seed, 12, &tally);
    });
    let [rows, kept] = [tally.rows, tally.kept].map(AtomicU64::into_inner);
    println!("{rows} rows became {kept}");
    assert!(kept * 3 < rows, "most rows win nowhere");
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
