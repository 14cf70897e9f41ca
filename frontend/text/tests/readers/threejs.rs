//! Trees of three-js-blobtree.

use std::fmt::Write as _;

use jbt_model::walk::walk;
use jbt_testkit::samples;
use jbt_text::import::{Imported, threejs};

use crate::common::{SOON, bad, compare, ends, field, files, good, messages, near, truncated};

#[test]
fn every_sample_agrees_with_its_table() {
    let Some(folder) = samples::folder("threejs") else { return };
    let files = files(&folder, "json");
    for (name, bytes) in &files {
        truncated(threejs, bytes);
        if name == "sdf_segment.json" {
            let errors = messages(bytes, &threejs(bytes).unwrap_err());
            assert!(
                errors.contains("scene:15:13: error: the functor DistanceFunctor has no numbers"),
                "{errors}"
            );
            continue;
        }
        let imported = good(threejs, bytes);
        let table = folder.join(name.replace(".json", ".oracle.csv"));
        // The library lets what a difference takes away give its colour too.
        let colored = name != "difference.json";
        // Integrals over triangles are sums.
        let exact = if matches!(name.as_str(), "scalis.json" | "all_nodes.json") { 2e-6 } else { 1e-8 };
        compare(&imported.model, &table, ["lr", "lg", "lb"], exact, &|_| colored);
    }
    assert_eq!(files.len(), 13);
}

const BIRD: &[u8] = include_bytes!("files/bird.json");

/// `K(q)`: the kernel at a squared distance in units of the thickness.
fn kernel(q: f64) -> f64 {
    64.0 / 27.0 * (1.0 - q / 4.0).max(0.0).powi(3)
}

fn vertex([x, y, z]: [f64; 3], thickness: f64) -> String {
    format!(r#"{{"position": {{"x": {x}, "y": {y}, "z": {z}}}, "thickness": {thickness}}}"#)
}

/// A primitive with these vertices, all of the default material.
fn scalis(volume: &str, density: f64, vertices: &[([f64; 3], f64)]) -> String {
    let kind = ["ScalisPoint", "ScalisSegment", "ScalisTriangle"][vertices.len() - 1];
    let all: Vec<String> = vertices.iter().map(|&(at, thickness)| vertex(at, thickness)).collect();
    let materials = vec!["{}"; vertices.len()].join(", ");
    format!(
        r#"{{"type": "{kind}", "volType": "{volume}", "density": {density}, "materials": [{materials}], "v": [{}]}}"#,
        all.join(", ")
    )
}

fn point(x: f64, thickness: f64) -> String {
    scalis("dist", 1.0, &[([x, 0.0, 0.0], thickness)])
}

fn over(kind: &str, members: &str, children: &[String]) -> String {
    format!(r#"{{"type": "{kind}", {members} "children": [{}]}}"#, children.join(", "))
}

/// The field of one node at a point.
fn at(node: &str, p: [f64; 3]) -> f64 {
    field(threejs, node, p)
}

#[test]
fn operators() {
    let (a, b) = (point(0.0, 1.0), point(1.0, 1.0));
    let p = [0.4, 0.0, 0.0];
    let (fa, fb) = (kernel(0.16), kernel(0.36));
    let both = [a.clone(), b.clone()];
    near(at(&over("RicciNode", r#""ricci_n": 1,"#, &both), p), fa + fb);
    near(at(&over("RicciNode", r#""ricci_n": 3,"#, &both), p), (fa.powi(3) + fb.powi(3)).cbrt());
    near(at(&over("RicciNode", r#""ricci": 2,"#, &both), p), fa.hypot(fb));
    near(at(&over("RootNode", r#""ricci_n": 2,"#, &both), p), fa.hypot(fb));
    near(at(&over("RootNode", "", &both), p), (fa.powi(64) + fb.powi(64)).powf(1.0 / 64.0));
    near(at(&over("MinNode", "", &both), p), fb);
    near(at(&over("MaxNode", "", &both), p), fa);
    near(at(&over("DifferenceNode", "", &both), p), fa - fb);
    near(at(&over("DifferenceNode", r#""alpha": 0.5,"#, &both), p), fa - fb.sqrt());
    near(at(&over("Node", r#""alpha": 2,"#, &both), p), 0.0);
    near(at(&over("MinNode", "", std::slice::from_ref(&a)), p), fa);
    // A field below 0 does not count in a blend.
    let negative = scalis("dist", -1.0, &[([0.0; 3], 1.0)]);
    near(at(&over("RicciNode", r#""ricci_n": 1,"#, &[b, negative]), p), fb);
}

#[test]
fn scales_and_twists_are_about_the_middle_of_a_box() {
    // The box of two points of thickness 1 is that of their supports: its middle is 2.
    let two = over("MaxNode", "", &[point(0.0, 1.0), point(4.0, 1.0)]);
    let scaled =
        over("ScaleNode", r#""scale_x": 2, "scale_y": 1, "scale_z": 0.5,"#, std::slice::from_ref(&two));
    near(at(&scaled, [-2.0, 0.0, 0.0]), kernel(0.0));
    near(at(&scaled, [6.0, 0.0, 0.5]), kernel(1.0));
    near(at(&scaled, [6.0, 1.0, 0.0]), kernel(1.0));
    let twisted = over(
        "TwistNode",
        r#""twist_amout": 1.5, "axis_x": 0, "axis_y": 1, "axis_z": 0,"#,
        std::slice::from_ref(&two),
    );
    // At a height y, what is asked is turned by 1.5 y about the middle, from x to z.
    let (height, angle) = (0.5, 0.75f64);
    let q = [2.0 + 2.0 * angle.cos(), height, -2.0 * angle.sin()];
    near(at(&twisted, q), kernel(0.25));
    let last = over(
        "ScaleNode",
        r#""scale_x": 1, "scale_y": 1, "scale_z": 1,"#,
        &[point(0.0, 1.0), point(9.0, 1.0)],
    );
    let imported = good(threejs, last.as_bytes());
    assert!(messages(last.as_bytes(), &imported.warnings).contains("before the last one are left out"));
    near(walk(&imported.model.check().unwrap(), [0.0; 3]).field, 0.0);
    near(walk(&imported.model.check().unwrap(), [9.0, 0.0, 0.0]).field, kernel(0.0));
}

/// The smallest q of a skeleton whose places are mixtures of its vertices, by trying many.
fn smallest(vertices: &[([f64; 3], f64)], p: [f64; 3]) -> f64 {
    let mut least = f64::INFINITY;
    let steps = 400;
    for i in 0..=steps {
        for j in 0..=steps - i {
            let mut parts = vec![f64::from(i), f64::from(j), f64::from(steps - i - j)];
            if vertices.len() == 2 {
                parts = vec![f64::from(i), f64::from(steps - i)];
            }
            let of = |value: &dyn Fn(usize) -> f64| {
                parts.iter().enumerate().map(|(k, part)| part / f64::from(steps) * value(k)).sum::<f64>()
            };
            let t = of(&|k| vertices[k].1);
            let distance = (0..3).map(|axis| (p[axis] - of(&|k| vertices[k].0[axis])).powi(2)).sum::<f64>();
            least = least.min(distance / (t * t));
        }
    }
    least
}

#[test]
fn distances_in_units_of_the_thickness() {
    let segment = [([0.0, 0.0, 0.0], 1.0), ([3.0, 1.0, 0.0], 2.0)];
    let triangle = [([0.0, 0.0, 0.0], 1.0), ([3.0, 0.0, 0.0], 1.5), ([1.0, 2.0, 1.0], 0.5)];
    let even = triangle.map(|(at, _)| (at, 1.2));
    for p in [
        [1.0, 1.5, 0.3],
        [-1.0, 0.2, 0.1],
        [4.0, 2.0, 1.0],
        [1.2, 0.6, 0.9],
        [0.5, 1.4, -0.6],
        [2.0, -0.8, 0.2],
    ] {
        for skeleton in [&segment[..], &triangle, &even] {
            let found = at(&scalis("dist", 1.25, skeleton), p);
            let expected = 1.25 * kernel(smallest(skeleton, p));
            assert!((found - expected).abs() < 1e-4, "{p:?}: {found}, expected {expected}");
        }
    }
}

#[test]
fn convolutions_are_one_at_the_thickness() {
    let long = scalis("convol", 7.0, &[([-50.0, 0.0, 0.0], 1.0), ([50.0, 0.0, 0.0], 1.0)]);
    near(at(&long, [0.3, 0.6, 0.8]), 1.0);
    let large = scalis(
        "convol",
        1.0,
        &[([-50.0, -50.0, 0.0], 1.0), ([50.0, -50.0, 0.0], 1.0), ([0.0, 50.0, 0.0], 1.0)],
    );
    assert!((at(&large, [0.3, 0.6, 1.0]) - 1.0).abs() < 1e-6);
    near(at(&large, [0.3, 0.6, 2.0]), 0.0);
    let steep = scalis("convol", 1.0, &[([0.0; 3], 1.0), ([2.0, 0.0, 0.0], 2.0)]);
    assert!(bad(threejs, &steep).contains("the thickness changes by half the length or more"));
}

fn sdf(scale: f64, shape: &str) -> String {
    format!(
        r#"{{"type": "SDFRootNode", "materials": [{{}}], "f": {{"type": "Poly6DistanceFunctor", "scale": {scale}}}, "sdfRoot": {shape}}}"#
    )
}

#[test]
fn distances_become_fields() {
    let of = |d: f64| 64.0 / 27.0 * (1.0 - (d / 4.0 + 0.5).max(0.0).powi(2)).max(0.0).powi(3);
    for radius in [3.0, 1.0] {
        let ball =
            sdf(2.0, &format!(r#"{{"type": "SDFSphere", "p": {{"x": 1, "y": 0, "z": 0}}, "r": {radius}}}"#));
        for x in [0.0, 0.5, 2.0, 4.5] {
            near(at(&ball, [1.0 + x, 0.0, 0.0]), of(x - radius));
        }
        let other = radius + 0.5;
        let capsule = sdf(
            2.0,
            &format!(
                r#"{{"type": "SDFNode", "children": [{{"type": "SDFCapsule", "p1": {{"x": 0, "y": 0, "z": 0}}, "r1": {radius}, "p2": {{"x": 4, "y": 0, "z": 0}}, "r2": {other}}}]}}"#
            ),
        );
        // On the normal of the cone, whose sine is 1/8.
        let (sine, cosine) = (0.125, (1.0f64 - 1.0 / 64.0).sqrt());
        let (along, off) = (2.0, radius + 0.25 + 0.4);
        near(at(&capsule, [along - off * sine, off * cosine, 0.0]), of(0.4));
        near(at(&capsule, [-radius - 0.3, 0.0, 0.0]), of(0.3));
        near(at(&capsule, [4.0 + other + 0.3, 0.0, 0.0]), of(0.3));
    }
    let inner = sdf(
        2.0,
        r#"{"type": "SDFCapsule", "p1": {"x": 0, "y": 0, "z": 0}, "r1": 1.5, "p2": {"x": 1, "y": 0, "z": 0}, "r2": 0.2}"#,
    );
    near(at(&inner, [2.0, 0.0, 0.0]), of(0.5));
    for shape in [
        r#"{"type": "SDFPoint", "p": {"x": 0, "y": 0, "z": 0}}"#,
        r#"{"type": "SDFSegment", "p1": {"x": 0, "y": 0, "z": 0}, "p2": {"x": 1, "y": 0, "z": 0}}"#,
    ] {
        let text = sdf(2.0, shape);
        let imported = good(threejs, text.as_bytes());
        assert!(messages(text.as_bytes(), &imported.warnings).contains("without thickness"));
        near(walk(&imported.model.check().unwrap(), [-0.5, 0.0, 0.0]).field, of(0.5));
    }
}

/// The values of an attribute group at a point.
fn attribute(imported: &Imported, group: usize, p: [f64; 3]) -> Vec<f64> {
    walk(&imported.model.check().unwrap(), p).attributes[group].clone()
}

#[test]
fn materials_are_laid_over_skeletons() {
    let segment = scalis("dist", 1.0, &[([0.0; 3], 1.0), ([4.0, 0.0, 0.0], 1.5)]);
    let materials =
        r##"[{"color": "#ff0000", "roughness": 0.2}, {"color": 255, "roughness": 0.6, "metalness": 1}]"##;
    let imported = good(threejs, segment.replace("[{}, {}]", materials).as_bytes());
    let names: Vec<&str> = imported.model.attributes.iter().map(|group| &*group.name).collect();
    assert_eq!(names, ["color", "rough", "metal"]);
    for (x, part) in [(-1.0, 0.0), (1.0, 0.25), (5.0, 1.0)] {
        let p = [x, 0.3, 0.0];
        assert_eq!(attribute(&imported, 0, p), [1.0 - part, 0.0, part]);
        assert!((attribute(&imported, 1, p)[0] - (0.2 + 0.4 * part)).abs() < 1e-12);
        assert_eq!(attribute(&imported, 2, p), [part]);
    }
    let plain = good(threejs, segment.as_bytes());
    assert_eq!(plain.model.attributes.len(), 1);
    let grey = ((170.0 / 255.0 + 0.055) / 1.055f64).powf(2.4);
    assert_eq!(attribute(&plain, 0, [1.0, 0.0, 0.0]), [grey; 3]);
    let triangle = scalis("dist", 1.0, &[([0.0; 3], 1.0), ([4.0, 0.0, 0.0], 1.5), ([0.0, 4.0, 0.0], 1.0)]);
    let colors = r##"[{"color": "#ff0000"}, {"color": "#00ff00"}, {"color": "#0000ff"}]"##;
    let imported = good(threejs, triangle.replace("[{}, {}, {}]", colors).as_bytes());
    let close = |p: [f64; 3], expected: [f64; 3]| {
        let found = attribute(&imported, 0, p);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} at {p:?}");
    };
    close([1.0, 2.0, 0.0], [0.25, 0.25, 0.5]);
    close([-0.5, 2.0, 0.0], [0.5, 0.0, 0.5]);
    close([-0.5, -0.5, 0.3], [1.0, 0.0, 0.0]);
    let glowing = segment.replacen("{}", r##"{"emissive": "#102030"}"##, 1);
    let imported = good(threejs, glowing.as_bytes());
    assert!(
        messages(glowing.as_bytes(), &imported.warnings)
            .contains("emissive colours of materials are left out")
    );
}

#[test]
fn the_example_is_read() {
    let imported = good(threejs, BIRD);
    assert_eq!(messages(BIRD, &imported.warnings), "");
    let tree = imported.model.check().unwrap();
    assert_eq!(tree.iso(), 1.0);
    assert!(walk(&tree, [2.4, 1.7, 0.0]).field > 2.0);
    truncated(threejs, BIRD);
}

#[test]
fn errors_have_places() {
    let node = point(0.0, 1.0);
    for (text, message) in [
        (String::new(), "scene:1:1: error: the file ends here"),
        ("[1, 2".to_owned(), "expected `,` or `]`"),
        ("{\"a\" 1}".to_owned(), "scene:1:6: error: this is no JSON"),
        ("{\"a\": 1,}".to_owned(), "expected a name in quotes"),
        ("[1,]".to_owned(), "expected a value"),
        ("[01]".to_owned(), "expected a number"),
        ("[1.]".to_owned(), "expected a digit"),
        ("[nan]".to_owned(), "expected a value"),
        ("\"a\nb\"".to_owned(), "the string is not closed in its line"),
        ("{} {}".to_owned(), "expected the end of the file"),
        ("[]".to_owned(), "scene:1:1: error: this is no object"),
        ("{}".to_owned(), "the object has no \"type\""),
        (r#"{"type": "Root"}"#.to_owned(), "there is no node of the type Root"),
        (r#"{"type": "RootNode"}"#.to_owned(), "the object has no \"children\""),
        (r#"{"type": "RootNode", "children": []}"#.to_owned(), "scene:1:34: error: the node has no children"),
        (over("RicciNode", "", std::slice::from_ref(&node)), "the object has no \"ricci_n\""),
        (
            over("RicciNode", r#""ricci_n": 0.5,"#, std::slice::from_ref(&node)),
            "the exponent of the blend is 0.5",
        ),
        (
            over("RicciNode", r#""ricci_n": 1e9,"#, std::slice::from_ref(&node)),
            "expected a number from 1 to 1024",
        ),
        (over("DifferenceNode", "", std::slice::from_ref(&node)), "a difference has two children"),
        (over("Node", "", std::slice::from_ref(&node)), "there is no node of the type Node"),
        (over("ScaleNode", r#""scale_x": 0,"#, std::slice::from_ref(&node)), "the scale has a 0"),
        (
            over("TwistNode", r#""axis_y": 0,"#, std::slice::from_ref(&node)),
            "the axis of the twist has no length",
        ),
        (over("RootNode", r#""iso": 0,"#, std::slice::from_ref(&node)), "the iso is 0"),
        (node.replace("\"thickness\": 1", "\"thickness\": 0"), "the thickness is 0"),
        (node.replace("\"thickness\": 1", "\"thickness\": 1e999"), "this is no finite number"),
        (node.replace("\"x\": 0, ", ""), "the object has no \"x\""),
        (node.replace("dist", "mass"), "the volType is not known"),
        (node.replace("[{}]", "[]"), "the node has 0 materials"),
        (node.replace("[{}]", "[3]"), "a material is an object"),
        (node.replace("{}", r#"{"color": "red"}"#), "this is no colour"),
        (node.replace("ScalisPoint", "ScalisSegment"), "the node has 1 vertices"),
        (scalis("dist", 1.0, &[([0.0; 3], 1.0); 3]), "the triangle has no area"),
        (sdf(0.0, "{}"), "the scale is 0"),
        (sdf(1.0, r#"{"type": "SDFTorus"}"#), "the distance SDFTorus is not known"),
        (sdf(1.0, r#"{"type": "SDFSphere", "p": {"x": 0, "y": 0, "z": 0}, "r": -1}"#), "the radius is -1"),
    ] {
        let found = bad(threejs, &text);
        assert!(found.contains(message), "{text}\n{found}");
    }
}

#[test]
fn hostile_files_end_soon() {
    let chain = |depth: usize| {
        let mut text = String::new();
        for _ in 0..depth {
            text += r#"{"type": "RicciNode", "ricci_n": 2, "children": ["#;
        }
        text += &point(0.0, 1.0);
        for _ in 0..depth {
            text += "]}";
        }
        text
    };
    let mut wide = r#"{"type": "RootNode", "children": ["#.to_owned();
    for at in 0..30_000 {
        let _ = write!(wide, "{}, ", point(f64::from(at), 1.0));
    }
    wide += &point(0.0, 1.0);
    wide += "]}";
    let all = [
        chain(1000),
        chain(20_000),
        wide,
        (0..200).fold(point(1.0, 1.0), |tree, _| over("ScaleNode", r#""scale_x": 1.1,"#, &[tree])),
        "[".repeat(1_000_000),
        "{\"a\":".repeat(500_000),
        "[".repeat(60_000) + &"]".repeat(60_000),
        format!("[{}1]", "1,".repeat(5_000_000)),
        format!("{{{}\"type\": 1}}", "\"type\": \"x\", ".repeat(300_000)),
        "\"".repeat(1_000_001),
        "\"\\".repeat(500_000),
        "1".repeat(10_000_000),
        "-".repeat(1_000_000),
        point(1e300, 1e300),
        point(1e-300, 1e-300),
        scalis("convol", 1e300, &[([1e15, 0.0, 0.0], 1.0), ([-1e15, 0.0, 0.0], 1e10)]),
        over("TwistNode", r#""twist_amout": 1e300,"#, &[point(0.0, 1.0)]),
        over("ScaleNode", r#""scale_x": 1e300, "scale_y": 1e-300,"#, &[point(0.0, 1.0)]),
        format!(r#"{{"type": "MinNode", "children": {}}}"#, "[".repeat(100_000)),
    ];
    for text in all {
        let took = ends(threejs, text.as_bytes());
        assert!(took < SOON, "{took:?}: {}", &text[..60.min(text.len())]);
    }
    let mut bytes = BIRD.to_vec();
    bytes[12] = 0xff;
    assert!(messages(&bytes, &threejs(&bytes).unwrap_err()).contains("the string is not UTF-8"));
}

#[test]
fn numbers_that_make_no_model_have_a_place() {
    let text = format!(
        "{{\"type\": \"RootNode\", \"children\": [\n{{\"type\": \"ScalisPoint\", \"volType\": \"dist\", \"density\": 1,\n \
         \"materials\": [{{}}], \"v\": [{}]}}]}}",
        vertex([0.0; 3], 1e15)
    );
    let said = crate::common::no_model(threejs, &text);
    assert!(said.starts_with("scene:2:1: error: the radius is 2000000000000000"), "{said}");
}
