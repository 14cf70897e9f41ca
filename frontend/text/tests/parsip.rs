//! ParsIP scenes: every published sample against independently computed values, every kind of node by a scene
//! of our own, and what strangers send.
//!
//! The samples are those of the folder `parsip`, see `jbt_testkit::samples`.

use std::fmt::Write as _;

use glam::DVec3;
use jbt_ir::limits;
use jbt_model::attribute::AttributeGroup;
use jbt_model::diagnostic::{Diagnostic, Severity};
use jbt_model::walk::{walk, walk_gradient};
use jbt_testkit::samples;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::import::{Imported, parsip};

/// Field and colour of a scene.
fn evaluate(scene: &Imported, p: [f64; 3]) -> (f64, Vec<f64>) {
    let sample = walk(&scene.model.check().unwrap(), p);
    (sample.field, sample.attributes[0].clone())
}

fn field(scene: &Imported, p: [f64; 3]) -> f64 {
    evaluate(scene, p).0
}

fn close(found: &[f64], expected: &[f64], tolerance: f64) -> bool {
    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < tolerance)
}

fn message(bytes: &[u8], diagnostics: &[Diagnostic]) -> String {
    let source = jbt_model::diagnostic::Source { name: "scene", text: bytes };
    diagnostics.iter().map(|diagnostic| source.render(diagnostic) + "\n").collect()
}

#[test]
fn every_sample_agrees_with_its_oracle() {
    let Some(folder) = samples::folder("parsip") else { return };
    let mut files = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let Some("blob" | "scene") = path.extension().and_then(|extension| extension.to_str()) else {
            continue;
        };
        files += 1;
        let bytes = std::fs::read(&path).unwrap();
        let scene = parsip(&bytes).unwrap_or_else(|errors| panic!("{}", message(&bytes, &errors)));
        assert_eq!(message(&bytes, &scene.warnings), "", "{}", path.display());
        assert_eq!(scene.model.attributes, [AttributeGroup::color()]);
        let tree = scene.model.check().unwrap_or_else(|errors| panic!("{}", message(&bytes, &errors)));
        assert_reads_back(&scene.model);
        let mut rows = csv::Reader::from_path(path.with_extension("oracle.csv")).unwrap();
        let mut count = 0;
        for row in rows.deserialize() {
            let [x, y, z, value, r, g, b, gx, gy, gz]: [f64; 10] = row.unwrap();
            let place = format!("{} at {x} {y} {z}", path.display());
            let found = walk(&tree, [x, y, z]);
            assert!((found.field - value).abs() < 1e-8, "{place}: field {}, expected {value}", found.field);
            if value > 0.0 {
                let color = &found.attributes[0];
                assert!(close(color, &[r, g, b], 1e-8), "{place}: {color:?}, expected {r} {g} {b}");
            }
            let length = (gx * gx + gy * gy + gz * gz).sqrt();
            let slope = walk_gradient(&tree, [x, y, z], 1e-6);
            let tolerance = 1e-5 * (1.0 + length);
            assert!(close(&slope, &[gx, gy, gz], tolerance), "{place}: {slope:?}, expected {gx} {gy} {gz}");
            count += 1;
        }
        assert!(count >= 500, "{}", path.display());
    }
    assert_eq!(files, 11);
}

/// The text of a scene with these nodes; the first is the root.
fn scene(nodes: &[&str]) -> String {
    let mut text = String::new();
    for (id, node) in nodes.iter().enumerate() {
        let operator = i32::from(node.contains("OperatorType"));
        let _ = writeln!(text, "[BLOBNODE {id}]\nIsOperator={operator}\n{}", node.replace("; ", "\n"));
    }
    text + "[Global]\nRootIDs=(0)\n"
}

fn read(nodes: &[&str]) -> Imported {
    let imported = read_odd(nodes);
    assert_eq!(imported.warnings.list(), [], "{nodes:?}");
    imported
}

/// A scene that may have warnings.
fn read_odd(nodes: &[&str]) -> Imported {
    let text = scene(nodes);
    let imported =
        parsip(text.as_bytes()).unwrap_or_else(|errors| panic!("{}", message(text.as_bytes(), &errors)));
    imported.model.check().unwrap_or_else(|errors| panic!("{}", message(text.as_bytes(), &errors)));
    imported
}

/// The falloff at a squared distance.
fn at(square: f64) -> f64 {
    (1.0 - square).powi(3)
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found}, expected {expected}");
}

#[test]
fn every_leaf() {
    let of = |node: &str, p: [f64; 3]| field(&read(&[node]), p);
    near(of("PrimitiveType=POINT; position=(1, 0, 0)", [1.5, 0.0, 0.0]), at(0.25));
    near(of("SkeletonType=point", [0.0, 0.5, 0.0]), at(0.25));
    let line = "PrimitiveType=LINE; start=(0, 0, 0); end=(1, 0, 0)";
    near(of(line, [0.5, 0.5, 0.0]), at(0.25));
    near(of(line, [1.5, 0.0, 0.0]), at(0.25));
    let cylinder = "PrimitiveType=CYLINDER; position=(0, 0, 1); direction=(0, 0, 2); radius=0.5; height=2";
    near(of(cylinder, [0.0, 0.0, 3.5]), at(0.25));
    near(of(cylinder, [0.0, 0.0, 0.5]), at(0.25));
    near(of(cylinder, [1.0, 0.0, 2.0]), at(0.25));
    near(of(cylinder, [1.0, 0.0, 3.5]), at(0.5));
    near(of(&cylinder.replace("height=2", "height=0"), [0.9, 0.0, 1.3]), at(0.25));
    let disc = "PrimitiveType=DISC; direction=(0, 3, 0); radius=1";
    near(of(disc, [0.5, 0.5, 0.0]), at(0.25));
    near(of(disc, [1.3, 0.4, 0.0]), at(0.25));
    near(of(&disc.replace("DISC", "RING"), [0.5, 0.5, 0.0]), at(0.5));
    let cube = "PrimitiveType=CUBE; position=(1, 1, 1); side=1";
    near(of(cube, [2.3, 2.4, 1.9]), at(0.25));
    near(of(cube, [0.0, 0.0, 0.0]), 1.0);
    let triangle = "PrimitiveType=TRIANGLE; corner0=(0, 0, 0); corner1=(2, 0, 0); corner2=(0, 2, 0)";
    near(of(triangle, [0.5, 0.5, 0.5]), at(0.25));
    near(of(triangle, [-0.5, 0.5, 0.0]), at(0.25));
    near(of("PrimitiveType=NULL", [0.0, 0.0, 0.0]), 0.0);
}

#[test]
fn maps_scale_first_and_translate_last() {
    // Scaled by (2, 1, 1), turned by 90 degrees about z (a quaternion of length 2), moved by (0, 0, 3).
    let node = "PrimitiveType=POINT; AffineScale=(2, 1, 1); AffineRotate=(0, 0, 1.4142135623730951, 1.4142135623730951); \
                AffineTranslate=(0, 0, 3)";
    let scene = read(&[node]);
    near(field(&scene, [0.0, 1.0, 3.0]), at(0.25));
    near(field(&scene, [0.5, 0.0, 3.0]), at(0.25));
}

#[test]
fn warps_ask_at_the_changed_point() {
    let of = |warp: &str, p: [f64; 3]| {
        let warp = format!("OperatorType={warp}; ChildrenCount=1; ChildrenIDs=(1)");
        let leaf = "PrimitiveType=POINT; position=(0.2, 0.5, 0.3)";
        let scene = read_odd(&[&warp, leaf]);
        assert_reads_back(&scene.model);
        field(&scene, p)
    };
    let asked = |q: [f64; 3]| at(DVec3::from(q).distance_squared(DVec3::new(0.2, 0.5, 0.3)));
    let p = [0.3, 0.4, 0.25];
    let [x, y, z] = p;
    near(of("TAPER", p), asked([x, y, z * (1.0 + x)]));
    near(of("TAPER; factor=-0.7; base axis=1; taper axis=0", p), asked([x * (1.0 - 0.7 * y), y, z]));
    near(of("TAPER; factor=2; base axis=0; taper axis=0", p), asked([x, y * (1.0 + 2.0 * x), z]));
    near(of("TAPER; factor=2; base axis=2; taper axis=2", p), asked([x * (1.0 + 2.0 * z), y, z]));
    near(of("SHEAR", p), asked([x + z, y, z]));
    near(of("SHEAR; factor=-0.5; base axis=2; shear axis=1", p), asked([x, y, z - 0.5 * y]));
    near(of("BEND; rate=0", p), asked(p));
    for (rate, center, left, right) in [(1.0, 0.5, 0.0, 1.0), (-2.0f64, 0.2, -0.5, 0.3)] {
        let (across, up) = (y - center, z - 1.0 / rate);
        let ends = [rate * (left - center), rate * (right - center)];
        let turn = (rate.signum() * across).atan2(-rate.signum() * up);
        let turn = turn.clamp(ends[0].min(ends[1]), ends[0].max(ends[1]));
        let (sin, cos) = turn.sin_cos();
        let bent = [x, turn / rate + center + across * cos + up * sin, 1.0 / rate - across * sin + up * cos];
        let bend = format!("BEND; rate={rate}; center={center}; left bound={left}; right bound={right}");
        near(of(&bend, p), asked(bent));
    }
}

#[test]
fn where_parsip_does_something_else_a_warning_says_so() {
    let warned = |node: &str| {
        let scene = read_odd(&[node, "PrimitiveType=POINT"]);
        scene.warnings.iter().map(|warning| warning.message.clone()).collect::<Vec<_>>().join("; ")
    };
    let warp = |name: &str| warned(&format!("OperatorType={name}; ChildrenCount=1; ChildrenIDs=(1)"));
    assert!(warp("BEND").contains("ParsIP's own evaluator applies the bend"), "{}", warp("BEND"));
    assert!(warp("TAPER; base axis=2; taper axis=1").contains("scales x"));
    assert_eq!(warp("TAPER"), "");
    assert_eq!(warp("SHEAR"), "");
    let quadric = "PrimitiveType=QUADRICPOINT; radius=1";
    assert!(!warned(quadric).contains("leaves out"));
    assert!(warned(&format!("{quadric}; AffineScale=(2, 2, 2)")).contains("leaves out the map"));
}

#[test]
fn a_quadric_point_has_a_radius_and_a_strength_of_its_own() {
    let of = |node: &str, p: [f64; 3]| field(&read_odd(&[node]), p);
    let node = "PrimitiveType=QUADRICPOINT; position=(1, 0, 0); radius=2; scale=0.8";
    near(of(node, [2.0, 0.0, 0.0]), 0.8 * 0.75 * 0.75);
    near(of(node, [1.0, 0.0, 2.1]), 0.0);
    near(of("PrimitiveType=QUADRICPOINT; radius=1", [0.5, 0.0, 0.0]), 0.75 * 0.75);
    // Its map counts.
    near(of(&format!("{node}; AffineScale=(2, 2, 2)"), [4.0, 0.0, 0.0]), 0.8 * 0.75 * 0.75);
}

#[test]
fn a_smooth_difference_is_a_product() {
    let of = |list: &str, count: usize, p: [f64; 3]| {
        let node = format!("OperatorType=SMOOTH DIFFERENCE; ChildrenCount={count}; ChildrenIDs={list}");
        evaluate(&read_odd(&[&node, A, B]), p)
    };
    let p = [0.4, 0.0, 0.0];
    let (a, b) = (at(0.16), at(0.36));
    near(of("(1, 2)", 2, p).0, a * (1.0 - b));
    near(of("(1, 2, 2)", 3, p).0, a * (1.0 - b) * (1.0 - b));
    near(of("(1)", 1, p).0, a);
    assert_eq!(of("(1, 2)", 2, p).1, [1.0, 0.0, 0.0]);
}

/// Two points at distance 1, a red and a blue one.
const A: &str = "PrimitiveType=POINT; MtrlDiffused=(1, 0, 0, 1)";
const B: &str = "PrimitiveType=POINT; position=(1, 0, 0); MtrlDiffused=(0, 0, 1, 1)";

#[test]
fn every_operator() {
    let p = [0.4, 0.0, 0.0];
    let (a, b) = (at(0.16), at(0.36));
    let of = |operator: &str| {
        let operator = format!("OperatorType={operator}; ChildrenCount=2; ChildrenIDs=(1,2)");
        field(&read(&[&operator, A, B]), p)
    };
    near(of("UNION"), a);
    near(of("Intersection"), b);
    near(of("DIFFERENCE"), a.min(1.0 - b));
    for sum in ["BLEND", "blend", "GRADIENT BLEND", "FASTQUADRICPOINTSET", "FASTQUADRATICPOINTSET"] {
        near(of(sum), a + b);
    }
    for root in ["RICCI BLEND", "RICCI BLEND; power=2.000000", "RICCI BLEND; power=0"] {
        near(of(root), a.hypot(b));
    }
    near(of("RICCI BLEND; power=3"), (a.powi(3) + b.powi(3)).cbrt());
    let range = "OperatorType=UNION; ChildrenCount=2; ChildrenIDsUseRange=1; ChildrenIDsRange=(1, 2)";
    near(field(&read(&[range, A, B]), p), a);
    for pass in ["CACHE", "TEXTURE"] {
        let pass =
            format!("OperatorType={pass}; ChildrenCount=1; ChildrenIDs=(1); AffineTranslate=(-1, 0, 0)");
        near(field(&read(&[&pass, B]), p), a);
    }
}

#[test]
fn colours_are_mixed_by_field() {
    let scene = read(&["OperatorType=RICCI BLEND; power=2; ChildrenCount=2; ChildrenIDs=(1, 2)", A, B]);
    let (a, b) = (at(0.16), at(0.36));
    let (_, color) = evaluate(&scene, [0.4, 0.0, 0.0]);
    let total = a * a + b * b;
    assert!(close(&color, &[a * a / total, 0.0, b * b / total], 1e-12), "{color:?}");
}

#[test]
fn twists_turn_as_the_format_says() {
    // The child's point is (u cos t - v sin t, u sin t + v cos t), t = k p_a, (u, v) the other axes in the
    // order x, y, z.
    let p = DVec3::new(0.3, -0.2, 0.7);
    for axis in 0..3 {
        let (u, v) = [(1, 2), (0, 2), (0, 1)][axis];
        let t = 1.3 * p[axis];
        let mut q = p;
        q[u] = p[u] * t.cos() - p[v] * t.sin();
        q[v] = p[u] * t.sin() + p[v] * t.cos();
        let twist = format!("OperatorType=TWIST; factor=1.3; axis={axis}; ChildrenCount=1; ChildrenIDs=(1)");
        let point = format!("PrimitiveType=POINT; position=({}, {}, {})", q.x, q.y, q.z);
        near(field(&read(&[&twist, &point]), p.into()), 1.0);
    }
}

#[test]
fn instances_share_their_origin() {
    let union = "OperatorType=UNION; ChildrenCount=2; ChildrenIDs=(1, 2)";
    let instance = "PrimitiveType=INSTANCE; AffineTranslate=(0, 3, 0); OriginalNodeIndex=2; OriginalNodeIsOp=0; \
                    OriginalNodeType=0; MtrlDiffused=(0, 1, 0, 1)";
    let origin = "PrimitiveType=POINT; AffineTranslate=(1, 0, 0); MtrlDiffused=(0, 0, 1, 1)";
    let scene = read(&[union, instance, origin]);
    let (value, color) = evaluate(&scene, [1.0, 3.5, 0.0]);
    near(value, at(0.25));
    assert_eq!(color, [0.0, 0.0, 1.0], "the origin's colour, not the instance's");
    let children = scene.model.root.node().children();
    assert_eq!(children[0].node().children()[0].identity(), children[1].identity());
}

#[test]
fn bytes_and_lines() {
    let text = "\r\0\n# comment\n[blobnode 12]\0\r\n  isoperator = 0\0\r\nPRIMITIVETYPE=po\0int\nradius=what\nPosition=( 1 ,0,0 )\n\
                [GLOBAL]\nrootids=( 12 )";
    let scene = parsip(text.as_bytes()).unwrap();
    near(field(&scene, [1.5, 0.0, 0.0]), at(0.25));
    let span = scene.model.root.node().span().unwrap();
    assert_eq!(&text[span.start as usize..span.end as usize], "[blobnode 12]");
}

/// The places and messages of what is wrong, one to a line: errors of what could not be read, else warnings.
fn complaints(text: &str) -> String {
    let list = parsip(text.as_bytes()).map_or_else(|errors| errors, |imported| imported.warnings);
    let line = |diagnostic: &Diagnostic| {
        let place = diagnostic.span.map_or("", |span| &text[span.start as usize..span.end as usize]);
        let help = diagnostic.help.as_ref().map(|help| format!(" | {help}")).unwrap_or_default();
        format!("{place} -> {}{help}\n", diagnostic.message)
    };
    list.iter().map(line).collect()
}

#[test]
fn everything_wrong_has_its_place() {
    let point = "PrimitiveType=POINT";
    let check = |text: &str, expected: &str| {
        let found = complaints(text);
        assert!(found.contains(expected), "{expected:?} is not in {found:?}");
    };
    let one = |node: &str, expected: &str| check(&scene(&[node, point]), expected);
    check("", " -> the file names no root");
    check("[Global]\n", "[Global] -> the file names no root");
    check("[Global]\nRootIDs=(7)", "(7) -> there is no node 7");
    check("[Global]\nRootIDs=(7, 8)", "(7, 8) -> the file has 2 roots");
    check("[Global]\nRootIDs=7", "7 -> `RootIDs` is 7 | expected node numbers");
    check("[BLOBNODE x]\n[Global", "[BLOBNODE x] -> a node without a number");
    check("[Global", "[Global -> a heading without its `]`");
    one("PrimitiveType=SPHRE", "SPHRE -> no primitive is called SPHRE | known are POINT");
    one("PrimitiveType=PIONT", "PIONT -> no primitive is called PIONT | perhaps POINT");
    one("PrimitiveType=QUADRICPOINT", "node 0 has no `radius`");
    one("OperatorType=PCM; ChildrenCount=1; ChildrenIDs=(1)", "PCM -> PCM (contact of two bodies");
    for warp in ["TAPER; base axis=3", "TAPER; taper axis=-1", "SHEAR; shear axis=x", "BEND; rate=fast"] {
        one(&format!("OperatorType={warp}; ChildrenCount=1; ChildrenIDs=(1)"), " -> `");
    }
    one("OperatorType=MELT; ChildrenCount=1; ChildrenIDs=(1)", "MELT -> no operator is called MELT");
    one("AffineScale=(1, 0, 1); PrimitiveType=POINT", "(1, 0, 1) -> node 0 has a scale factor of zero");
    one("AffineRotate=(0, 0, 0, 0); PrimitiveType=POINT", "(0, 0, 0, 0) -> the rotation of node 0 is zero");
    one(
        "AffineTranslate=(0, nan, 0); PrimitiveType=POINT",
        "(0, nan, 0) -> `AffineTranslate` is (0, nan, 0)",
    );
    one(
        "AffineTranslate=(0, 0); PrimitiveType=POINT",
        "(0, 0) -> `AffineTranslate` is (0, 0) | expected 3 numbers",
    );
    one("PrimitiveType=CUBE", "[BLOBNODE 0] -> node 0 has no `side`");
    one("PrimitiveType=CUBE; side=1e999", "1e999 -> `side` is 1e999 | expected a number");
    one("PrimitiveType=CUBE; side=-1", "-1 -> `side` is -1 | expected at least 0");
    one("PrimitiveType=DISC; radius=1; direction=(0,0,0)", "(0,0,0) -> the direction is zero");
    one("OperatorType=UNION; ChildrenCount=0; ChildrenIDs=()", "() -> the operator 0 has no children");
    one(
        "OperatorType=UNION; ChildrenCount=2; ChildrenIDs=(1)",
        "2 -> `ChildrenCount` is 2, and the list has 1",
    );
    one("OperatorType=UNION; ChildrenCount=1; ChildrenIDs=(9)", "(9) -> there is no node 9");
    one("OperatorType=UNION; ChildrenIDs=(1, 1)", "(1, 1) -> node 1 is a child more than once");
    one("OperatorType=CACHE; ChildrenIDs=(1, 1)", "(1, 1) -> CACHE of node 0 has 2 children");
    one(
        "OperatorType=UNION; ChildrenIDsUseRange=1; ChildrenIDsRange=(1, 9223372036854775807)",
        "expected (first, last), of nodes of the file",
    );
    one("OperatorType=UNION; ChildrenIDsUseRange=1; ChildrenIDsRange=(1, 0)", "expected (first, last)");
    one("OperatorType=UNION; ChildrenIDs=(0)", "(0) -> node 0 contains itself");
    one("PrimitiveType=INSTANCE; OriginalNodeIndex=0", "0 -> node 0 contains itself");
    one("OperatorType=TWIST; axis=3; ChildrenIDs=(1)", "3 -> `axis` is 3 | expected 0, 1 or 2");
    one(point, "[BLOBNODE 1] -> node 1 is not used");
    check(&(scene(&[point]) + "[BLOBNODE 0]"), "[BLOBNODE 0] -> a second node 0; the first one counts");
    check(
        &scene(&["PrimitiveType=POINT; primitivetype=CUBE"]),
        "a second `PrimitiveType`; the first one counts",
    );
    check(&(scene(&[point]) + "CountPrimitives=5"), "5 -> `CountPrimitives` is 5, and the file has 1");
    check(&(scene(&[point]) + "what is this"), "what is this -> a line that is neither");
    check(&(scene(&[point]) + "[Wall]"), "[Wall] -> the section [Wall] is unknown");
}

#[test]
fn a_cycle_through_an_instance() {
    let text = scene(&[
        "OperatorType=UNION; ChildrenCount=2; ChildrenIDs=(1, 2)",
        "PrimitiveType=POINT",
        "OperatorType=BLEND; ChildrenCount=1; ChildrenIDs=(3)",
        "PrimitiveType=INSTANCE; OriginalNodeIndex=0",
    ]);
    assert_eq!(complaints(&text), "0 -> node 0 contains itself\n");
}

#[test]
fn a_place_after_dropped_bytes() {
    let text = "[BLOBNODE 0]\0\r\nIs\0Operator=0\0\r\nPrimitiveType=CUBE\0\r\nside=o\0ne\0\r\n[Global]\nRootIDs=(0)\0";
    assert_eq!(complaints(text), "o\0ne -> `side` is one | expected a number\n");
}

/// Runs on a stack that a recursion over the depth of the scene would overflow.
fn on_a_small_stack(test: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(256 << 10).spawn(test).unwrap().join().unwrap();
}

#[test]
fn a_hundred_thousand_operators_deep() {
    on_a_small_stack(|| {
        let deep = 100_000;
        let mut text = String::new();
        for id in 0..deep {
            let _ =
                write!(text, "[BLOBNODE {id}]\nIsOperator=1\nOperatorType=BLEND\nChildrenIDs=({})\n", id + 1);
        }
        let _ = write!(text, "[BLOBNODE {deep}]\nPrimitiveType=POINT\n[Global]\nRootIDs=(0)");
        let scene = parsip(text.as_bytes()).unwrap();
        let mut depth = 0;
        let mut tree = &scene.model.root;
        while let Some(child) = tree.node().children().first() {
            (tree, depth) = (child, depth + 1);
        }
        assert_eq!(depth, deep);
        let cycle = text.replace(
            &format!("[BLOBNODE {deep}]\nPrimitiveType=POINT"),
            "[BLOBNODE 100000]\nPrimitiveType=INSTANCE\nOriginalNodeIndex=0",
        );
        assert_eq!(complaints(&cycle), "0 -> node 0 contains itself\n");
    });
}

#[test]
fn limits_hold() {
    let long = vec![b'\n'; limits::MAX_SCENE_BYTES + 1];
    assert_eq!(parsip(&long).unwrap_err()[0].severity, Severity::Limit);
    assert_eq!(parsip(&long[1..]).unwrap_err()[0].severity, Severity::Error);
    let many = scene(&["OperatorType=UNION; ChildrenIDs=(9)"]) + &"[BLOBNODE x]\n".repeat(1000);
    assert_eq!(parsip(many.as_bytes()).unwrap_err().len(), limits::MAX_ERRORS + 1);
}

#[test]
fn garbage_never_panics() {
    let good = scene(&[
        "OperatorType=UNION; ChildrenCount=2; ChildrenIDs=(1, 2)",
        "PrimitiveType=DISC; direction=(0, 0, 1); radius=1",
        "OperatorType=TWIST; axis=1; ChildrenCount=1; ChildrenIDsUseRange=1; ChildrenIDsRange=(3, 3)",
        "PrimitiveType=CYLINDER; direction=(0, 0, 1); radius=1; height=2; AffineScale=(1, 2, 3)",
    ]);
    let inside = |bytes: &[u8]| {
        let list = parsip(bytes).map_or_else(|errors| errors, |imported| imported.warnings);
        for span in list.iter().filter_map(|diagnostic| diagnostic.span) {
            assert!(span.start <= span.end && span.end as usize <= bytes.len());
        }
    };
    for end in 0..good.len() {
        inside(&good.as_bytes()[..end]);
    }
    let mut rng = fastrand::Rng::with_seed(3);
    for _ in 0..5_000 {
        let mut bytes = good.clone().into_bytes();
        for _ in 0..rng.usize(1..5) {
            let at = rng.usize(..bytes.len());
            match rng.u8(..3) {
                0 => bytes[at] = rng.u8(..),
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, *rng.choice(b"[]=(),0\n\r\0").unwrap()),
            }
        }
        inside(&bytes);
    }
}
