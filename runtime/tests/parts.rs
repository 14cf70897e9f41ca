//! Parts of a model: what two of them have in common, against closed forms and dense sampling; their meshes
//! and files.

use jbt::export::{ExportOptions, Format, write_with};
use jbt::mesh::{Mesh, is_closed};
use jbt::solid::{PartSolids, Relation};
use jbt::{Compiler, Fineness, Points, Polygonize, Query};
use jbt_model::walk::walk;
use jbt_testkit::scene::tree;

/// A cube of edge 3 about a point: its faces are planes away from edges.
fn cube(name: &str, at: [f64; 3]) -> String {
    let [x, y, z] = at;
    format!("part \"{name}\" {{ translate ({x} {y} {z}) {{ box {{ half (1 1 1) surface_radius 0.5 }} }} }}\n")
}

fn parts(text: &str) -> PartSolids {
    PartSolids::new(&Compiler::new(), &tree(text)).unwrap()
}

#[test]
fn three_touch_and_two_overlap() {
    // a, b and c touch in planes; d is in c, by a slab of 0.5.
    let text = [
        cube("a", [0.0; 3]),
        cube("b", [3.0, 0.0, 0.0]),
        cube("c", [3.0, 3.0, 0.0]),
        cube("d", [3.0, 5.5, 0.0]),
    ];
    let parts = parts(&text.concat());
    let found = parts.relations(0.01).unwrap();
    let word = |relation: &Relation| match relation {
        Relation::Apart { .. } => "apart",
        Relation::Touching { .. } => "touching",
        Relation::Overlapping { .. } => "overlapping",
        _ => "?",
    };
    let words: Vec<(usize, usize, &str)> =
        found.iter().map(|pair| (pair.parts[0], pair.parts[1], word(&pair.relation))).collect();
    let expected = [
        (0, 1, "touching"),
        // Their rounded edges are apart.
        (0, 2, "apart"),
        (0, 3, "apart"),
        (1, 2, "touching"),
        (1, 3, "apart"),
        (2, 3, "overlapping"),
    ];
    assert_eq!(words, expected);
    let Relation::Touching { at, .. } = found[0].relation else { unreachable!() };
    assert!((at[0] - 1.5).abs() < 0.2, "{at:?}");
    let Relation::Overlapping { at, volume, .. } = found[5].relation else { unreachable!() };
    assert!((at[1] - 4.25).abs() < 0.25, "{at:?}");
    // The slab 4 <= y <= 4.5 of two rounded cubes: at y, the cross-section of one is that of a rounded square
    // whose half side is 1 + r and radius r, r = sqrt(0.25 - d^2), d the distance to where faces are flat.
    let section = |d: f64| {
        let r = (0.25 - d * d).max(0.0).sqrt();
        4.0 + 8.0 * r + std::f64::consts::PI * r * r
    };
    // Both bounds of the slab are half a unit away from the flat part of one of the cubes.
    let steps = 20_000;
    let exact: f64 = (0..steps)
        .map(|step| {
            let y = 0.5 * (f64::from(step) + 0.5) / f64::from(steps);
            section(y).min(section(0.5 - y))
        })
        .sum::<f64>()
        * 0.5
        / f64::from(steps);
    assert!(volume.low <= exact && exact <= volume.high, "{volume:?} {exact}");
    assert!((volume.estimate - exact).abs() < 0.02 * exact, "{volume:?} {exact}");
}

#[test]
fn no_proof_is_wrong() {
    let mut random = fastrand::Rng::with_seed(190);
    let (mut apart, mut overlapping) = (0, 0);
    for case in 0..200 {
        let mut ball = |name: &str| {
            let mut number = |low: f64, high: f64| low + (high - low) * random.f64();
            let at = [number(-1.5, 1.5), number(-1.5, 1.5), number(-1.5, 1.5)];
            let (r, s) = (number(0.3, 0.9), number(0.2, 0.6));
            let [x, y, z] = at;
            format!(
                "part \"{name}\" {{ translate ({x} {y} {z}) {{ difference {{
                    box {{ half ({s} {r} {s}) surface_radius 0.2 }} point {{ at ({s} 0 0) surface_radius {r} }} }} }} }}\n"
            )
        };
        let text = ball("a") + &ball("b");
        let model = tree(&text);
        let parts = PartSolids::new(&Compiler::new(), &model).unwrap();
        let relation = parts.relation(0, 1, 0.02).unwrap();
        let trees = [model.part(0), model.part(1)];
        let inside = |part: usize, p: [f64; 3]| walk(&trees[part], p).field >= model.iso() + 1e-4;
        let steps = 24;
        let mut common = 0;
        for index in 0..steps * steps * steps {
            let place = [index % steps, index / steps % steps, index / (steps * steps)];
            let p = place.map(|i| -3.0 + 6.0 * (f64::from(i) + 0.5) / f64::from(steps));
            common += i32::from(inside(0, p) && inside(1, p));
        }
        match relation {
            Relation::Apart { .. } => {
                apart += 1;
                assert_eq!(common, 0, "{case}: {text}");
            }
            Relation::Overlapping { at, volume, .. } => {
                overlapping += 1;
                let field = |part: usize| walk(&trees[part], at).field;
                assert!(field(0) > model.iso() && field(1) > model.iso(), "{case}: {text}");
                assert!(volume.low > 0.0 && volume.low <= volume.high, "{case}: {volume:?}");
            }
            _ => {}
        }
    }
    assert!(apart > 20 && overlapping > 20, "{apart} {overlapping}");
}

#[test]
fn distances_are_between_their_bounds() {
    let text =
        "part \"a\" { point { surface_radius 1 } } part \"b\" { point { at (3 4 0) surface_radius 2 } }
        part \"c\" { point { at (0.5 0 0) surface_radius 1 } } part \"d\" { empty }";
    let parts = parts(text);
    let gap = parts.distance(0, 1, 0.1).unwrap().unwrap();
    assert!(gap.low <= 2.0 + 1e-6 && 2.0 <= gap.high + 1e-6 && gap.high - gap.low <= 0.1, "{gap:?}");
    let nearest = [[0.6, 0.8, 0.0], [1.8, 2.4, 0.0]];
    for (point, expected) in gap.points.iter().zip(nearest) {
        assert!((0..3).all(|axis| (point[axis] - expected[axis]).abs() < 0.2), "{gap:?}");
    }
    let inside = parts.distance(0, 2, 1e-2).unwrap().unwrap();
    assert!(inside.low == 0.0 && inside.high <= 1e-2, "{inside:?}");
    assert!(parts.distance(0, 3, 1e-3).unwrap().is_none());
    assert!(parts.distance(0, 1, 0.0).is_err());
}

#[test]
fn points_and_volumes_by_part() {
    let text = cube("a", [0.0; 3]) + &cube("b", [2.0, 0.0, 0.0]);
    let parts = parts(&text);
    let points: Points =
        [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [5.0, 0.0, 0.0]].into_iter().collect();
    assert_eq!(parts.members(&points).unwrap(), [vec![0], vec![0, 1], vec![1], vec![]]);
    let pi = std::f64::consts::PI;
    let exact = 8.0 + 6.0 * 4.0 * 0.5 + 12.0 * 2.0 * pi * 0.25 / 4.0 + 4.0 / 3.0 * pi * 0.125;
    for part in 0..2 {
        let volume = parts.measure(part, Fineness::Resolution(64)).unwrap().volume;
        assert!(volume.low <= exact && exact <= volume.high, "{volume:?} {exact}");
    }
}

fn mesh(text: &str) -> Mesh {
    let settings = Polygonize { fineness: Fineness::Resolution(48), ..Polygonize::default() };
    let tree = tree(text);
    settings.mesh(&Compiler::new(), &tree).run().unwrap().mesh
}

#[test]
fn each_part_has_a_closed_mesh_and_touching_ones_no_crack() {
    let text = cube("a", [0.0; 3]) + &cube("b", [3.0, 0.0, 0.0]);
    let mesh = mesh(&text);
    let pieces = mesh.pieces();
    assert_eq!(pieces.iter().map(|piece| piece.name).collect::<Vec<_>>(), [Some("a"), Some("b")]);
    let [first, second] = [0, 1].map(|place| mesh.piece(&pieces[place]));
    for piece in [&first, &second] {
        assert!(is_closed(piece.positions.len(), &piece.triangles));
        assert!(piece.volume() > 20.0, "{}", piece.volume());
    }
    // The common face, away from its rim.
    let is_on_face = |p: &&[f32; 3]| (p[0] - 1.5).abs() < 0.02 && p[1].abs() < 0.9 && p[2].abs() < 0.9;
    let bits = |mesh: &Mesh| {
        let mut all: Vec<[u32; 3]> =
            mesh.positions.iter().filter(is_on_face).map(|p| p.map(f32::to_bits)).collect();
        all.sort_unstable();
        all
    };
    assert!(bits(&first).len() > 100, "{}", bits(&first).len());
    assert_eq!(bits(&first), bits(&second));
}

#[test]
fn components_are_counted_with_cavities() {
    let text = "difference { union { point { surface_radius 1 } point { at (4 0 0) surface_radius 0.5 } }
        point { surface_radius 0.5 } }";
    let mut volumes: Vec<f64> = mesh(text).components().iter().map(|one| one.volume).collect();
    volumes.sort_by(f64::total_cmp);
    let ball = |r: f64| 4.0 / 3.0 * std::f64::consts::PI * r * r * r;
    let expected = [-ball(0.5), ball(0.5), ball(1.0)];
    assert_eq!(volumes.len(), 3);
    for (found, expected) in volumes.iter().zip(expected) {
        assert!((found - expected).abs() < 0.05 * expected.abs(), "{volumes:?}");
    }
}

#[test]
fn rays_tell_the_part() {
    let text = cube("a", [0.0; 3]) + &cube("b", [4.0, 0.0, 0.0]);
    let tree = tree(&text);
    let tracer = jbt::Tracer::new(&Compiler::new(), &tree, Query::FIELD).unwrap();
    for (x, expected) in [(0.2, 0), (4.1, 1)] {
        let (origin, direction) = ([x, 0.3, 9.0], [0.0, 0.0, -1.0]);
        let ray = jbt::Ray { origin, direction, span: [0.0, 20.0] };
        let hit = tracer.first(&ray, 1e-3).unwrap().expect("it hits a cube");
        assert_eq!(tracer.part(hit.position), Some(expected));
    }
}

#[test]
fn files_have_an_object_for_each_part() {
    let text = cube("Nabe_\u{f1}", [0.0; 3]) + &cube("\u{8f2a}", [4.0, 0.0, 0.0]);
    let mesh = mesh(&text);
    let written = |format: Format| {
        let mut bytes = Vec::new();
        write_with(&mesh, format, &ExportOptions::default(), &mut bytes).unwrap();
        bytes
    };
    let obj = String::from_utf8(written(Format::Obj)).unwrap();
    let objects: Vec<&str> = obj.lines().filter(|line| line.starts_with("o ")).collect();
    assert_eq!(objects, ["o Nabe_\u{f1}", "o \u{8f2a}"]);
    let usda = String::from_utf8(written(Format::Usda)).unwrap();
    assert_eq!(usda.matches("def Mesh").count(), 2);
    assert!(usda.contains("displayName = \"\u{8f2a}\""));

    let glb = written(Format::Glb);
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let names: Vec<&str> =
        json["nodes"].as_array().unwrap().iter().map(|node| node["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["Nabe_\u{f1}", "\u{8f2a}"]);
    let binary = &glb[28 + length..];
    for (place, piece) in mesh.pieces().iter().enumerate() {
        let primitive = &json["meshes"][place]["primitives"][0];
        let elements = |accessor: &serde_json::Value| {
            let accessor = &json["accessors"][accessor.as_u64().unwrap() as usize];
            let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
            let first = view["byteOffset"].as_u64().unwrap() + accessor["byteOffset"].as_u64().unwrap_or(0);
            (first as usize, accessor["count"].as_u64().unwrap() as usize)
        };
        let (first, count) = elements(&primitive["attributes"]["POSITION"]);
        assert_eq!(count, piece.vertices.len());
        let word = |at: usize| u32::from_le_bytes(binary[at..at + 4].try_into().unwrap());
        let x = f32::from_bits(word(first));
        assert_eq!(x.to_bits(), mesh.positions[piece.vertices.start][0].to_bits());
        let (first, count) = elements(&primitive["indices"]);
        assert_eq!(count, 3 * piece.triangles.len());
        let largest = (0..count).map(|index| word(first + 4 * index)).max().unwrap();
        assert_eq!(largest as usize, piece.vertices.len() - 1);
    }
}

/// A plate of balls, `count` along each side and 1 apart, whose middles are moved by `shift` at `height`.
fn plate(count: usize, shift: f64, height: f64, radius: f64) -> String {
    let ball = |i: usize| {
        let (x, y) = (i % count, i / count);
        format!("point {{ at ({} {} {height}) surface_radius {radius} }}", x as f64 + shift, y as f64 + shift)
    };
    (0..count * count).map(ball).collect::<Vec<_>>().join(" ")
}

/// Every ball of one plate is as near to one of the other as the next: a million pairs of leaves and more, of
/// which none can be left out before the end.
#[test]
fn distances_of_a_million_pairs_are_between_their_bounds() {
    const COUNT: usize = 36;
    for (shift, height, radius) in [(0.0, 1.5, 0.25), (0.5, 1.0, 0.25), (0.25, 4.0, 0.4)] {
        let text = format!(
            "part \"a\" {{ union {{ {} }} }} part \"b\" {{ union {{ {} }} }}",
            plate(COUNT, 0.0, 0.0, radius),
            plate(COUNT, shift, height, radius)
        );
        assert!(COUNT.pow(4) > 1_000_000);
        let expected = 2.0f64.mul_add(shift * shift, height * height).sqrt() - 2.0 * radius;
        let tolerance = 0.15;
        let gap = parts(&text).distance(0, 1, tolerance).unwrap().unwrap();
        assert!(gap.low <= expected + 1e-6 && expected <= gap.high + 1e-6, "{expected}: {gap:?}");
        assert!(gap.high - gap.low <= tolerance, "{expected}: {gap:?}");
    }
}

/// Where the work does not do, the bounds are wider, and hold.
#[test]
fn distances_without_end_have_bounds() {
    let wall = |x: f64| format!("box {{ center ({x} 0 0) half (1 30 30) surface_radius 0.1 }}");
    let text = format!("part \"a\" {{ {} }} part \"b\" {{ {} }}", wall(0.0), wall(4.0));
    let gap = parts(&text).distance(0, 1, 1e-4).unwrap().unwrap();
    let expected = 4.0 - 2.0 - 0.2;
    assert!(gap.low <= expected + 1e-6 && expected <= gap.high + 1e-6, "{gap:?}");
    assert!(gap.low > 0.5 * expected && gap.high < 1.5 * expected, "{gap:?}");
}

/// A part: a rounded box about the z axis, by its half sides and its middle.
fn slab(name: &str, half: [f64; 3], z: f64) -> String {
    let [x, y, h] = half;
    format!("part \"{name}\" {{ box {{ center (0 0 {z}) half ({x} {y} {h}) surface_radius 0.1 }} }}\n")
}

/// However thin and wide it is, an overlap is found by a point of it.
#[test]
fn thin_overlaps_are_found() {
    for (half, overlap, tolerance) in [
        ([10.0, 10.0, 0.4], 0.2, 0.02),
        ([10.0, 10.0, 0.4], 0.3, 0.02),
        ([10.0, 10.0, 0.4], 0.2, 0.0001),
        ([10.0, 10.0, 0.4], 0.003, 0.02),
        ([0.4, 0.4, 0.4], 0.015, 0.002),
        ([0.4, 0.4, 0.4], 0.0004, 0.002),
    ] {
        // Not by halves of anything.
        let z = 0.137;
        let text = slab("a", half, z) + &slab("b", half, z + 2.0 * half[2] + 0.2 - overlap);
        let found = parts(&text).relation(0, 1, tolerance).unwrap();
        let Relation::Overlapping { at, volume } = found else { panic!("{half:?} {overlap}: {found:?}") };
        let face = z + half[2] + 0.1;
        assert!(face - overlap <= at[2] && at[2] <= face, "{overlap}: {at:?} {face}");
        // The face has rounded edges, so the common part is a little smaller than a box.
        let exact = 4.0 * half[0] * half[1] * overlap;
        let most = 4.0 * (half[0] + 0.1) * (half[1] + 0.1) * overlap;
        assert!(
            volume.low > 0.0 && volume.low <= most && volume.high >= exact,
            "{overlap}: {volume:?} {exact}"
        );
    }
}

/// What is said of parts that touch holds, and the place is where they do.
#[test]
fn contacts_have_their_place() {
    let ball =
        |name: &str, x: f64| format!("part \"{name}\" {{ point {{ at ({x} 0.3 0.1) surface_radius 1 }} }}\n");
    for apart in [0.0, 0.004] {
        let text = ball("a", -0.7) + &ball("b", 1.3 + apart);
        let found = parts(&text).relation(0, 1, 0.005).unwrap();
        let Relation::Touching { within, at } = found else { panic!("{apart}: {found:?}") };
        let contact = [0.3 + 0.5 * apart, 0.3, 0.1];
        assert!(within <= 0.005, "{found:?}");
        assert!((0..3).all(|axis| (at[axis] - contact[axis]).abs() < 0.01), "{apart}: {at:?}");
    }
    // Faces of a million boxes: it is not decided, and what is said of the size of a common part is true.
    let half = [10.0, 10.0, 0.4];
    let parts = parts(&(slab("a", half, 0.0) + &slab("b", half, 1.0)));
    match parts.relation(0, 1, 1e-4).unwrap() {
        Relation::Undecided { thinner_than, at } => {
            assert!(thinner_than < 0.5 && (at[2] - 0.5).abs() < 0.25 * thinner_than, "{thinner_than} {at:?}");
        }
        other => panic!("{other:?}"),
    }
    let Relation::Touching { within, at } = parts.relation(0, 1, 0.15).unwrap() else { panic!() };
    assert!(within <= 0.15 && (at[2] - 0.5).abs() < 0.01, "{within} {at:?}");
}

#[test]
fn unbounded_parts_have_relations_in_a_region() {
    let text = "part \"ground\" { half_space { normal (0 0 1) surface_radius 0.5 } }
        part \"ball\" { point { at (0 0 1) surface_radius 0.75 } }
        part \"air\" { half_space { at (0 0 4) normal (0 0 -1) surface_radius 0.5 } }";
    let all = parts(text);
    assert!(all.relation(0, 1, 0.01).is_err());
    let inside = all.within(jbt::Box3::new([-3.0; 3], [3.0; 3]));
    let Relation::Overlapping { at, volume } = inside.relation(0, 1, 0.01).unwrap() else { panic!() };
    assert!((0.25..=0.5).contains(&at[2]), "{at:?}");
    let cap = std::f64::consts::PI * 0.0625 * (3.0 * 0.75 - 0.25) / 3.0;
    assert!(volume.low <= cap && cap <= volume.high, "{volume:?} {cap}");
    assert!(matches!(inside.relation(1, 2, 0.01).unwrap(), Relation::Apart { .. }));
    let ground = inside.measure(0, Fineness::Resolution(32)).unwrap().volume;
    assert!(ground.low <= 126.0 && 126.0 <= ground.high, "{ground:?}");
}
