//! Every command does what its help says.

use crate::folder::{BLOB, Folder, SCENE};

fn folder() -> Folder {
    Folder::new().with("scene.jbt", SCENE).with("scene.blob", BLOB).with("points.csv", points())
}

/// Points on a grid, in columns that stand anywhere.
fn points() -> String {
    let mut text = "name,z,y,x\n".to_owned();
    for index in 0..300 {
        let at = |step: usize| (index * step % 17) as f32 / 8.0 - 1.0;
        text += &format!("\"p, {index}\",{},{},{}\n", at(1), at(3), at(5));
    }
    text
}

#[test]
fn mesh_writes_every_format_and_says_what_it_took() {
    let folder = folder();
    for (name, magic) in [("a.glb", "glTF"), ("a.ply", "ply\n"), ("a.obj", ""), ("a.STL", "")] {
        let ran = folder.jbt(&["mesh", "scene.jbt", "-o", name, "--resolution", "24"]).code(0);
        assert!(ran.stdout().starts_with(&format!("{name}: ")), "{}", ran.stdout());
        for word in ["triangles", "vertices", "closed", "evaluations", "compile", "total"] {
            assert!(ran.stdout().contains(word), "{word}: {}", ran.stdout());
        }
        assert_eq!(ran.stderr(), "");
        assert!(folder.read(name).starts_with(magic.as_bytes()));
        assert!(folder.read(name).len() > 1000);
    }
    let quiet = folder.jbt(&["mesh", "scene.jbt", "-o", "b.glb", "--resolution", "24", "--quiet"]).code(0);
    assert_eq!((quiet.stdout(), quiet.stderr()), (String::new(), String::new()));
    assert_eq!(folder.read("a.glb"), folder.read("b.glb"));
}

#[test]
fn meshes_of_printers_are_small_flat_and_of_few_materials() {
    let folder = folder().with("ball.jbt", "jbt 1 color (1 0 0) { point { at (1 2 3) surface_radius 1 } }");
    let made = |more: &[&str]| {
        let start =
            ["mesh", "ball.jbt", "-o", "a.3mf", "--force", "--resolution", "48", "--verify", "--json"];
        let report = folder.jbt(&[&start[..], more].concat()).code(0).json();
        assert_eq!(report["closed"], true, "{more:?}");
        let number = |key: &str| report[key].as_f64().unwrap();
        (number("triangles"), number("volume"), report["bounds"][2].as_f64().unwrap())
    };
    let (triangles, volume, low) = made(&[]);
    let (fewer, smaller, _) = made(&["--simplify", "20%"]);
    assert!(fewer <= 0.21 * triangles && (smaller / volume - 1.0).abs() < 0.02, "{fewer} of {triangles}");
    let (few, smaller, _) = made(&["--simplify", "0.02"]);
    assert!(few < 0.2 * triangles && (smaller / volume - 1.0).abs() < 0.04, "{few} of {triangles}");
    let (_, cut, bottom) = made(&["--flat-bottom", "0.5"]);
    assert!((bottom - (low + 0.5)).abs() < 1e-3, "{bottom} {low}");
    // A cap of height 1/2 is missing.
    let cap = std::f64::consts::PI * 0.25 * (3.0 - 0.5) / 3.0;
    assert!((cut - (volume - cap)).abs() < 0.02, "{cut} {volume}");
    let ran = folder.jbt(&["mesh", "ball.jbt", "-o", "a.glb", "--palette", "4"]).code(2);
    assert!(ran.stderr().contains("--palette"), "{}", ran.stderr());
    folder.jbt(&["mesh", "ball.jbt", "-o", "a.glb", "--simplify", "0%"]).code(2);
    let nothing = |option: &str, value: &str| {
        folder.jbt(&["mesh", "ball.jbt", "-o", "none.glb", option, value]).code(2).says("leaves nothing");
    };
    nothing("--simplify", "100");
    nothing("--flat-bottom", "100");
    assert!(!folder.path("none.glb").exists());
}

#[test]
fn sequences_are_meshed_frame_by_frame_and_go_on() {
    let mut folder = Folder::new();
    for frame in 8..12 {
        let text = format!("x,y,z,heat\n0,0,0,1\n0.5,0,{},3\n", f64::from(frame) / 20.0);
        folder = folder.with(&format!("f_{frame}.csv"), text);
    }
    let folder = folder.with("f_12.csv", "x,y,z\n0,nan,0\n");
    let start = ["mesh", "f_{}.csv", "-o", "out_{}.glb", "--radius", "0.4", "--resolution", "16"];
    let colored = ["--values", "heat", "--color-by", "heat", "--ramp", "grey", "--jobs", "2"];
    let ran = folder.jbt(&[&start[..], &colored].concat()).code(1);
    assert!(ran.stderr().contains("f_12.csv"), "{}", ran.stderr());
    for frame in 8..12 {
        assert!(folder.read(&format!("out_{frame}.glb")).starts_with(b"glTF"));
        assert!(ran.stdout().contains(&format!("out_{frame}.glb")), "{}", ran.stdout());
    }
    let again = folder.jbt(&[&start[..], &colored].concat()).code(1);
    assert!(again.stderr().contains("4 frames are newer"), "{}", again.stderr());
    assert_eq!(again.stdout(), "");
    let many = folder.jbt(&[&start[..], &["--jobs", "65535", "--force"]].concat()).code(1);
    assert!(many.stderr().contains("--jobs asks for 65535 processes; 256 do the work"), "{}", many.stderr());
    folder.jbt(&["mesh", "f_{}.csv", "-o", "out.glb", "--radius", "0.4"]).code(2);
    folder.jbt(&["mesh", "g_{}.csv", "-o", "out_{}.glb", "--radius", "0.4"]).code(4);
    let missing = folder.jbt(&["mesh", "f_8.csv", "-o", "o.glb", "--radius", "0.4", "--color-by", "cold"]);
    assert!(missing.code(2).stderr().contains("cold"));
}

/// A ball: its size, its volume and its area are those of the mesh, a little below the exact ones; half of it
/// encloses nothing.
#[test]
fn mesh_measures_what_it_has_made() {
    let folder = folder().with("ball.jbt", "jbt 1 point { at (1 2 3) surface_radius 1 }");
    let ran = folder.jbt(&["mesh", "ball.jbt", "-o", "a.glb", "--resolution", "64", "--json"]).code(0);
    let report = ran.json();
    let numbers = |key: &str| -> Vec<f64> {
        report[key].as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
    };
    let near = |found: f64, exact: f64, part: f64| {
        assert!(found < exact * (1.0 + 1e-6) && found > exact * (1.0 - part), "{found}, exactly {exact}");
    };
    numbers("size").into_iter().for_each(|side| near(side, 2.0, 0.005));
    let bounds = numbers("bounds");
    for axis in 0..3 {
        assert!((0.5 * (bounds[axis] + bounds[axis + 3]) - (axis + 1) as f64).abs() < 1e-3, "{bounds:?}");
    }
    let ball = std::f64::consts::PI * 4.0;
    near(report["volume"].as_f64().unwrap(), ball / 3.0, 0.01);
    near(report["area"].as_f64().unwrap(), ball, 0.01);
    assert_eq!((&report["up"], &report["colors"]), (&"y".into(), &"linear".into()));
    let ran = folder.jbt(&["mesh", "ball.jbt", "-o", "a.stl", "--resolution", "64"]).code(0);
    assert!(
        ran.stdout().contains("\n  size         ") && ran.stdout().contains(", volume 4.1"),
        "{}",
        ran.stdout()
    );

    let cut = ["mesh", "ball.jbt", "-o", "a.stl", "--resolution", "64", "--region=-1,0,1,1,4,5", "--json"];
    let report = folder.jbt(&cut).code(0).json();
    assert!(report["volume"].is_null() && report["colors"].is_null() && report["up"] == "z");
    // The mesh ends in the last cells before the cut.
    near(report["area"].as_f64().unwrap(), 0.5 * ball, 0.05);
    let text = folder.jbt(&cut[..cut.len() - 1]).code(0).stdout();
    assert!(text.contains("volume none (open), area 6."), "{text}");

    let far = ["mesh", "ball.jbt", "-o", "b.obj", "--region", "8,8,8,9,9,9", "--resolution", "4", "--json"];
    let report = folder.jbt(&far).code(0).json();
    assert!(report["size"].is_null() && report["bounds"].is_null());
    assert_eq!((&report["volume"], &report["area"]), (&0.0.into(), &0.0.into()));
}

#[test]
fn mesh_reports_for_machines() {
    let ran =
        folder().jbt(&["mesh", "scene.jbt", "-o", "a.ply", "--cell", "0.1", "--engine", "lanes", "--json"]);
    let ran = ran.code(0);
    let report = ran.json();
    for key in ["triangles", "vertices", "field_evaluations", "gradient_evaluations", "full_evaluations"] {
        assert!(report[key].as_u64().is_some_and(|count| count > 0), "{key}");
    }
    for key in ["compile_ms", "total_ms"] {
        assert!(report[key].as_f64().is_some_and(|time| time > 0.0), "{key}");
    }
    assert_eq!(report["closed"], true);
    assert_eq!(report["cut_sides"], "none");
    assert_eq!(report["engine"], "lanes");
    assert_eq!(report["cell"], 0.1);
    assert_eq!(report["warnings"], serde_json::json!([]));
    assert_eq!(report["region"].as_array().map(Vec::len), Some(6));
    // Three leaves stand in this scene at different places; everything is evaluated once at a vertex.
    let points = ["field_evaluations", "gradient_evaluations", "full_evaluations"];
    let points: u64 = points.iter().filter_map(|key| report[key].as_u64()).sum();
    let evaluations = report["primitive_evaluations"].as_u64().unwrap();
    assert!(points < evaluations && evaluations < 3 * points, "{evaluations} at {points} points");
    let count = |value: &serde_json::Value| value.as_u64().expect("a count");
    let stages = ["lattice", "pulls", "vertices"].map(|stage| &report["stages"][stage]);
    assert_eq!(stages.map(|stage| count(&stage["points"])).iter().sum::<u64>(), points);
    assert_eq!(stages.map(|stage| count(&stage["evaluations"])).iter().sum::<u64>(), evaluations);
    let avoided = ["avoided_by_support", "avoided_by_interval"].map(|key| count(&report[key]));
    assert_eq!(
        count(&stages[0]["evaluations"]) + avoided[0] + avoided[1],
        count(&report["dense_evaluations"])
    );
    assert!(avoided.iter().all(|&avoided| avoided > 0));
    assert_eq!(report["full_evaluations"], report["vertices"]);
    // Euler: a closed surface has an even number of triangles, and two for each vertex but for its genus.
    let count = |key: &str| report[key].as_i64().unwrap();
    assert_eq!((count("triangles") - 2 * count("vertices")) % 4, 0);
}

#[test]
fn an_unbounded_model_needs_a_region() {
    let folder = folder().with("half.jbt", "jbt 1 half_space { normal (1 1 1) radius 1 }");
    for command in ["mesh", "sample"] {
        let out = if command == "mesh" { "a.obj" } else { "a.npy" };
        let ran = folder.jbt(&[command, "half.jbt", "-o", out, "--resolution", "8"]).code(2);
        ran.says("the model is unbounded: its mesh needs a region; --region gives it one");
        let region = ["--resolution", "8", "--region", "-1,-1,-1,1,1,1"];
        folder.jbt(&[&[command, "half.jbt", "-o", out], &region[..]].concat()).code(0);
    }
    folder
        .jbt(&["stats", "half.jbt"])
        .code(2)
        .says("the model is unbounded: it needs a region; --region gives it one");
    let checked = folder.jbt(&["check", "half.jbt"]).code(0);
    assert!(checked.stdout().contains("unbounded: a mesh needs a region"), "{}", checked.stdout());
}

#[test]
fn a_region_that_cuts_the_surface_is_told() {
    let folder = folder();
    let arguments = ["mesh", "scene.jbt", "-o", "a.obj", "--cell", "0.1", "--region", "-2,-2,-2,0.5,2,2"];
    let ran =
        folder.jbt(&arguments).code(0).says("jbt: warning: the region cuts the surface at its sides +x");
    assert!(ran.stdout().contains("open (cut at +x)"));
    let json = folder.jbt(&[&arguments[..], &["--json"]].concat()).code(0).json();
    assert_eq!((&json["closed"], &json["cut_sides"]), (&false.into(), &"+x".into()));
    assert_eq!(json["warnings"].as_array().map(Vec::len), Some(1));
    let far =
        folder.jbt(&["mesh", "scene.jbt", "-o", "b.obj", "--region", "8,8,8,9,9,9", "--resolution", "4"]);
    far.code(0).says("the mesh is empty");
}

#[test]
fn threads_and_engines_give_equal_meshes() {
    let folder = folder();
    let runs = [["1", "jit"], ["2", "jit"], ["7", "jit"], ["2", "lanes"], ["2", "scalar"]];
    let meshes = runs.map(|[threads, engine]| {
        let ran = folder.jbt(&[
            "mesh",
            "scene.jbt",
            "-o",
            "a.glb",
            "--resolution",
            "20",
            "--threads",
            threads,
            "--engine",
            engine,
        ]);
        ran.code(0);
        folder.read("a.glb")
    });
    for (mesh, run) in meshes.iter().zip(runs) {
        assert!(*mesh == meshes[0], "{run:?}");
    }
}

#[test]
fn streams_instead_of_files() {
    let folder = folder();
    folder.jbt(&["mesh", "scene.jbt", "-o", "a.obj", "--resolution", "16"]).code(0);
    let piped = ["mesh", "-", "-o", "-", "--format", "obj", "--resolution", "16"];
    let ran = folder.jbt_with_input(&piped, SCENE.as_bytes()).code(0).says("triangles");
    assert!(ran.stdout_bytes() == folder.read("a.obj"));

    folder.jbt(&["eval", "scene.blob", "--points", "points.csv", "-o", "a.csv"]).code(0);
    let from_stdin = ["eval", "-", "--points", "points.csv", "-o", "-"];
    let ran = folder.jbt_with_input(&from_stdin, BLOB.as_bytes()).code(0);
    assert!(ran.stdout_bytes() == folder.read("a.csv"));
    let ran = folder.jbt_with_input(&["eval", "scene.blob", "--points", "-", "-o", "-"], points().as_bytes());
    assert!(ran.code(0).stdout_bytes() == folder.read("a.csv"));
}

#[test]
fn eval_answers_in_order_and_engines_agree() {
    let folder = folder();
    for query in ["field", "gradient", "attributes", "all"] {
        let answers = ["scalar", "lanes", "jit"].map(|engine| {
            let arguments = ["eval", "scene.jbt", "--points", "points.csv", "--query", query];
            folder.jbt(&[&arguments[..], &["--engine", engine, "-o", "a.csv"]].concat()).code(0);
            String::from_utf8(folder.read("a.csv")).unwrap()
        });
        assert!(answers.iter().all(|answer| *answer == answers[0]), "{query}");
        let header = match query {
            "field" => "x,y,z,field",
            "gradient" => "x,y,z,field,gx,gy,gz",
            "attributes" => "x,y,z,field,color.r,color.g,color.b,rough",
            _ => "x,y,z,field,gx,gy,gz,color.r,color.g,color.b,rough",
        };
        let mut lines = answers[0].lines();
        assert_eq!(lines.next(), Some(header));
        let rows: Vec<Vec<f32>> =
            lines.map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect();
        assert_eq!(rows.len(), 300);
        for (index, row) in rows.iter().enumerate() {
            let at = |step: usize| (index * step % 17) as f32 / 8.0 - 1.0;
            assert_eq!(row[..3], [at(5), at(3), at(1)]);
            assert_eq!(row.len(), header.split(',').count());
        }
    }
}

/// The falloff of a ParsIP point is (1 - d^2)^3: 1 at its centre, 27/64 half way.
#[test]
fn eval_gives_known_values() {
    let folder = folder().with("p.csv", "x,y,z\n0.25,0,0\n-0,0,5\n");
    let ran = folder.jbt(&["eval", "scene.blob", "--points", "p.csv", "--query", "all", "-o", "-"]).code(0);
    let stdout = ran.stdout();
    let rows: Vec<Vec<f32>> =
        stdout.lines().skip(1).map(|line| line.split(',').map(|n| n.parse().unwrap()).collect()).collect();
    assert!((rows[0][3] - 2.0 * (15.0_f32 / 16.0).powi(3)).abs() < 1e-6, "{stdout}");
    assert!(rows[0][4].abs() < 1e-6 && rows[0][5] == 0.0 && rows[0][6] == 0.0, "{stdout}");
    assert!((rows[0][7] - 0.5).abs() < 1e-6 && (rows[0][9] - 0.5).abs() < 1e-6, "{stdout}");
    assert_eq!(rows[1][3..7], [0.0; 4], "far away");
    assert!(stdout.lines().nth(2).is_some_and(|line| line.starts_with("-0,0,5,0,")), "{stdout}");
}

#[test]
fn eval_of_many_points_and_of_none() {
    let many: String = (0..40_000).map(|index| format!("{index},0,0\n")).collect();
    let folder = folder().with("many.csv", format!("x,y,z\n{many}")).with("none.csv", "x,y,z\n");
    let ran = folder.jbt(&["eval", "scene.jbt", "--points", "many.csv", "-o", "-"]).code(0);
    assert_eq!(ran.stdout().lines().count(), 40_001);
    assert!(ran.stdout().lines().last().is_some_and(|line| line == "39999,0,0,0"));
    for threads in ["1", "2", "7"] {
        let arguments = ["eval", "scene.jbt", "--points", "many.csv", "--threads", threads, "-o", "-"];
        assert!(folder.jbt(&arguments).code(0).stdout() == ran.stdout(), "{threads} threads");
    }
    folder.jbt(&["eval", "scene.jbt", "--points", "many.csv", "--threads", "0", "-o", "-"]).code(2);
    let ran = folder.jbt(&["eval", "scene.jbt", "--points", "none.csv", "-o", "-"]).code(0);
    assert_eq!(ran.stdout(), "x,y,z,field\n");
}

#[test]
fn points_have_lines_as_on_any_system() {
    let text = "x,y,z\n0.5,0,0\n\n0,0.25,0.5\n";
    let folder = folder().with("p.csv", text);
    let plain = folder.jbt(&["eval", "scene.jbt", "--points", "p.csv", "-o", "-"]).code(0).stdout();
    assert_eq!(plain.lines().count(), 3);
    for end in ["\r\n", "\r"] {
        let folder = folder.jbt_with_input(
            &["eval", "scene.jbt", "--points", "-", "-o", "-"],
            text.replace('\n', end).as_bytes(),
        );
        assert_eq!(folder.code(0).stdout(), plain, "{end:?}");
    }
    let bad = text.replace("0.25", "q").replace('\n', "\r");
    let ran = folder.jbt_with_input(&["eval", "scene.jbt", "--points", "-", "-o", "-"], bad.as_bytes());
    let told = ran.code(1).says("<stdin>:4:3: error: `q` is not a number").stderr();
    assert!(!told.contains("\\u{d}"), "{told}");
}

#[test]
fn definitions_set_parameters() {
    let folder = folder().with("p.csv", "x,y,z\n0.5,0,0.6\n");
    let eval = |extra: &[&str]| {
        let arguments = ["eval", "scene.jbt", "--points", "p.csv", "-o", "-"];
        folder.jbt(&[&arguments[..], extra].concat()).code(0).stdout()
    };
    assert_ne!(eval(&[]), eval(&["-D", "bulge=0.9"]));
    assert_eq!(
        eval(&["-D", "bulge=0.9"]),
        eval(&["-Dbulge=2", "--define", "bulge=0.9"]),
        "the last one counts"
    );
}

#[test]
fn show_prints_every_stage() {
    let folder = folder();
    let tree = folder.jbt(&["show", "scene.blob", "--stage", "tree"]).code(0).stdout();
    let again = Folder::new().with("tree.jbt", &tree);
    assert_eq!(again.jbt(&["show", "tree.jbt", "--stage", "tree"]).code(0).stdout(), tree);
    let rust = folder.jbt(&["show", "scene.jbt", "--stage", "rust"]).code(0).stdout();
    assert!(rust.contains("pub fn model() -> jbt::Model {") && rust.contains("let arm = segment("), "{rust}");
    let stages = ["ir", "gradient", "legalize", "constant-folding", "simplify", "cse", "dce", "schedule"];
    for stage in stages {
        let text = folder.jbt(&["show", "scene.jbt", "--stage", stage]).code(0).stdout();
        assert!(text.starts_with("function "), "{stage}: {text}");
        assert_eq!(text.contains("gx"), stage != "ir", "{stage}");
    }
    let field =
        folder.jbt(&["show", "scene.jbt", "--stage", "schedule", "--query", "field"]).code(0).stdout();
    assert!(field.contains("(x, y, z) -> (field)"), "{field}");
    if cfg!(feature = "jit") {
        let clif = folder.jbt(&["show", "scene.jbt", "--stage", "clif"]).code(0).stdout();
        assert!(clif.contains("f32x4"), "{clif}");
        let asm = folder.jbt(&["show", "scene.jbt", "--stage", "asm"]).code(0).stdout();
        assert!(asm.contains("vfmadd"), "{asm}");
        // On any machine.
        for (level, register) in [("avx2", "ymm0"), ("avx512vl", "{1to8}"), ("avx512", "{1to16}")] {
            let arguments = ["show", "scene.jbt", "--stage", "asm", "--level", level];
            let asm = folder.jbt(&arguments).code(0).stdout();
            assert!(asm.contains("vfmadd") && asm.contains(register), "{level}: {asm}");
        }
    }
    let unknown =
        folder.jbt(&["show", "scene.jbt", "--stage", "nonsense"]).code(2).says("has no stage `nonsense`");
    for stage in stages {
        assert!(unknown.stderr().contains(stage), "{stage}");
    }
    folder
        .jbt(&["show", "scene.jbt", "--stage", "gradient", "--query", "field"])
        .code(2)
        .says("has no stage");
}

/// The same bytes at every level that this CPU has, and an error that lists them for others.
#[test]
fn levels_change_no_byte() {
    let folder = folder();
    let mut meshes = Vec::new();
    for level in jbt::Level::ALL {
        for engine in ["lanes", "jit"] {
            let arguments =
                ["mesh", "scene.jbt", "-o", "m.ply", "--force", "--engine", engine, "--level", level.name()];
            if level.is_available() {
                folder.jbt(&arguments).code(0);
                meshes.push(folder.read("m.ply"));
            } else {
                folder
                    .jbt(&arguments)
                    .code(2)
                    .says(&format!("this CPU has no level {level}; it has baseline"));
            }
        }
    }
    assert!(meshes.len() >= 2 && meshes.iter().all(|mesh| *mesh == meshes[0]));
}

#[test]
fn count_compares_with_separate_walks() {
    let folder = folder();
    let report = folder.jbt(&["count", "scene.jbt", "--json"]).code(0).json();
    assert_eq!(report["instances"], 3);
    let queries = report["queries"].as_array().unwrap();
    let found: Vec<_> = queries
        .iter()
        .map(|q| {
            (q["query"].as_str().unwrap(), q["separate"].as_u64().unwrap(), q["fused"].as_u64().unwrap())
        })
        .collect();
    assert_eq!(found, [("field", 3, 3), ("gradient", 15, 3), ("attributes", 6, 3), ("all", 18, 3)]);
    let leaves = report["leaves"].as_array().unwrap();
    assert_eq!(leaves.len(), 2, "the segment is one leaf that is used twice");
    assert_eq!(
        (&leaves[0]["kind"], &leaves[0]["line"], &leaves[0]["uses"]),
        (&"segment".into(), &4.into(), &2.into())
    );
    assert_eq!(leaves[0]["evaluations"]["all"], 2);
    assert_eq!(
        (&leaves[1]["kind"], &leaves[1]["line"], &leaves[1]["uses"]),
        (&"point".into(), &8.into(), &1.into())
    );

    let table = folder.jbt(&["count", "scene.jbt", "--query", "all"]).code(0).stdout();
    for words in ["4:11", "6.00", "separate = walks x uses", "lattice: ", "in support", "for each pair"] {
        assert!(table.contains(words), "{words}: {table}");
    }
    assert!(!table.contains("attributes  "), "one query only: {table}");
}

/// One ball on a lattice that anybody can count: what `jbt mesh` asks, and the points that are nearer than
/// its radius.
#[test]
fn count_tells_what_matters_on_the_lattice_of_mesh() {
    let ball = "jbt 1 let ball = point { radius 0.95 } union { use ball color (1 0 0) { use ball } }";
    let folder = folder().with("ball.jbt", ball);
    let lattice = ["--cell", "0.25", "--region", "-1,-1,-1,1,1,7"];
    let report = folder.jbt(&[&["count", "ball.jbt", "--json"][..], &lattice].concat()).code(0).json();
    let axis = |last: i32| (-4..=last).map(|index| f64::from(index) / 4.0);
    let all = axis(4).flat_map(|x| axis(4).flat_map(move |y| axis(28).map(move |z| x * x + y * y + z * z)));
    let inside = all.clone().filter(|square| *square < 0.95 * 0.95).count() as u64;
    let points = all.count() as u64;
    assert_eq!((&report["points"], &report["pairs_in_support"]), (&points.into(), &inside.into()));
    assert_eq!((&report["uses"], &report["instances"]), (&2.into(), &1.into()));
    assert_eq!(report["evaluations"], points);
    let (mesh, stages) = (&report["mesh"], &report["mesh"]["stages"]);
    let of = |value: &serde_json::Value| value.as_u64().expect("a count");
    assert_eq!(stages["division"]["interval_evaluations"], report["interval_evaluations"]);
    assert!(of(&report["interval_evaluations"]) > 0);
    let avoided = of(&mesh["avoided_by_support"]) + of(&mesh["avoided_by_interval"]);
    assert_eq!(of(&stages["lattice"]["evaluations"]) + avoided, points, "done or avoided");
    assert_eq!(report["waste"].as_f64(), Some(points as f64 / inside as f64));
    assert_eq!(report["lattice"]["cells"], serde_json::json!([8, 8, 32]));
    assert_eq!(report["leaves"][0]["pairs_in_support"].as_u64(), Some(inside));
    let all = &report["queries"][3];
    let counts = ["walks", "separate", "cached", "fused"].map(|key| all[key].as_u64().unwrap());
    assert_eq!(counts, [6, 12, 4, 1]);
    let totals = ["separate", "cached", "fused"].map(|key| all["total"][key].as_u64().unwrap());
    assert_eq!(totals, [12 * points, 4 * points, points]);

    let mesh = [&["mesh", "ball.jbt", "-o", "a.obj", "--json", "--resolution", "20"][..]].concat();
    let mesh = folder.jbt(&mesh).code(0).json();
    let report = folder.jbt(&["count", "ball.jbt", "--json", "--resolution", "20"]).code(0).json();
    assert_eq!(report["points"], mesh["dense_evaluations"], "of one primitive");
    assert_eq!(report["mesh"]["stages"], mesh["stages"]);
    assert_eq!(report["lattice"]["region"], mesh["region"]);
}

#[test]
fn count_needs_no_lattice() {
    let empty = "jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }";
    let folder = folder().with("empty.jbt", empty);
    let ran = folder.jbt(&["count", "empty.jbt", "--json"]).code(0).says("nothing is counted on a lattice");
    let report = ran.json();
    assert_eq!((&report["points"], &report["pairs_in_support"]), (&0.into(), &0.into()));
    assert!(report["waste"].is_null() && report["lattice"].is_null());
    assert_eq!(report["queries"][0]["fused"], 2);
    // What was asked for has to be possible.
    folder.jbt(&["count", "empty.jbt", "--cell", "0.1"]).code(1).says("the model is empty");
    folder.jbt(&["count", "scene.jbt", "--cell", "-1"]).code(2).says("greater than zero");
    folder.jbt(&["count", "scene.jbt", "--resolution", "0"]).code(2).says("at least one cell");
}

/// A ball of radius 1: everything is known.
#[test]
fn stats_measures_the_solid() {
    let folder = folder().with("ball.jbt", "jbt 1 color (1 0 0) { point { surface_radius 1 } }");
    let arguments = ["stats", "ball.jbt", "--region", "-2,-2,-2,2,2,2", "--tolerance", "0.001", "--json"];
    let stats = |extra: &[&str]| folder.jbt(&[&arguments[..], extra].concat()).code(0).json();
    let report = stats(&["--depth", "5"]);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let near = |value: &serde_json::Value, expected: f64, by: f64| {
        assert!((number(value) - expected).abs() < by, "{value} is not {expected}");
    };
    let volume = 4.0 / 3.0 * std::f64::consts::PI;
    near(&report["volume"]["estimate"], volume, 0.03);
    near(&report["area"], 3.0 * volume, 0.1);
    assert!(number(&report["volume"]["low"]) < volume && volume < number(&report["volume"]["high"]));
    for (index, side) in [-1.0, -1.0, -1.0, 1.0, 1.0, 1.0].into_iter().enumerate() {
        near(&report["tight"]["outer"][index], side, 0.0011);
        near(&report["tight"]["inner"][index], side, 0.0011);
    }
    assert_eq!((&report["tight"]["converged"], &report["cell"]), (&true.into(), &0.125.into()));
    let shares = ["solid", "air", "surface"].map(|key| number(&report["shares"][key]));
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{shares:?}");
    assert_eq!(report["contents"], serde_json::json!({ "mean": 1.0, "most": 1 }));
    let division = &report["division"];
    assert_eq!(division["levels"].as_array().map(Vec::len), Some(6));
    let count = |key: &str| division[key].as_u64().unwrap();
    assert_eq!(count("boxes"), 1 + 8 * count("splits"));
    assert_eq!(count("boxes"), ["splits", "solid", "air", "surface"].map(count).iter().sum::<u64>());
    for key in ["points", "evaluations", "ranges", "interval_evaluations"] {
        assert!(report[key].as_u64().is_some_and(|count| count > 0), "{key}");
    }
    assert_eq!(stats(&["--resolution", "32"])["division"], *division);
    assert_eq!(stats(&["--cell", "0.125"])["division"], *division);

    let text = folder.jbt(&["stats", "ball.jbt", "--depth", "4"]).code(0).stdout();
    for words in
        ["ball.jbt: volume 4.", "tight        (-1.0", "at least", "primitives in a surface box", "depth"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    let far = folder.jbt(&["stats", "ball.jbt", "--region", "2,2,2,3,3,3", "--json"]).code(0);
    let far = far.says("no point of the region is inside").json();
    assert!(far["tight"]["outer"].is_null() && far["center"].is_null());
    assert_eq!(far["volume"], serde_json::json!({ "low": 0.0, "high": 0.0, "estimate": 0.0 }));
}

#[test]
fn stats_refuses_what_makes_no_sense() {
    let empty = "jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }";
    let folder = folder().with("empty.jbt", empty);
    folder.jbt(&["stats", "empty.jbt"]).code(1).says("the model is empty");
    let stats = |extra: &[&str]| folder.jbt(&[&["stats", "scene.jbt"], extra].concat());
    stats(&["--cell", "-1"]).code(2).says("greater than zero");
    stats(&["--resolution", "0"]).code(2).says("at least one cell");
    stats(&["--depth", "2", "--cell", "1"]).code(2).says("cannot be used with");
    stats(&["--depth", "21"]).code(2).says("--depth");
    stats(&["--depth", "3", "--tolerance", "0"]).code(2).says("greater than 0");
    stats(&["--depth", "3", "--tolerance", "nan"]).code(2).says("greater than 0");
    stats(&["--cell", "1e-300"]).code(3).says("jbt: limit: ");
}

#[test]
fn check_summarises_a_good_scene() {
    let folder = folder();
    let text = folder.jbt(&["check", "scene.jbt"]).code(0).stdout();
    for words in [
        "scene.jbt: no errors",
        "leaves       2",
        "instances  3",
        "bounds       (",
        "rough (1 x f32, dominant)",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let quiet = folder.jbt(&["check", "scene.blob", "-q"]).code(0);
    assert_eq!((quiet.stdout(), quiet.stderr()), (String::new(), String::new()));
}

#[test]
fn help_and_version() {
    let folder = Folder::new();
    assert_eq!(folder.jbt(&["--version"]).code(0).stdout(), concat!("jbt ", env!("CARGO_PKG_VERSION"), "\n"));
    let all = folder.jbt(&["--help"]).code(0).stdout();
    assert!(all.contains("(.vm)"), "{all}");
    for command in
        ["mesh", "render", "contour", "sample", "eval", "convert", "show", "count", "stats", "check"]
    {
        assert!(all.contains(command));
        let help = folder.jbt(&[command, "--help"]).code(0).stdout();
        assert!(help.contains("SCENE"));
        let flat = help.split_whitespace().collect::<Vec<_>>().join(" ");
        for ending in [".jbt", ".blob", ".scene", ".vm", ".pov", ".rib", ".json"] {
            assert!(flat.contains(ending), "{command}: {ending}: {help}");
        }
    }
}

/// The array of one ball, as numpy would read it.
#[test]
fn sample_writes_an_array() {
    let folder = folder().with("ball.jbt", "jbt 1 point { radius 1 }");
    let lattice = ["--cell", "0.5", "--region", "-1,-1,-1,1,1,1.5"];
    let report =
        folder.jbt(&[&["sample", "ball.jbt", "-o", "a.npy", "--json"][..], &lattice].concat()).code(0);
    let report = report.json();
    assert_eq!(
        (&report["points"], &report["planes"]),
        (&serde_json::json!([5, 5, 6]), &serde_json::json!(["field"]))
    );
    let file = folder.read("a.npy");
    let header = String::from_utf8_lossy(&file[..128]).into_owned();
    assert!(header.contains("'fortran_order': True, 'shape': (5, 5, 6)"), "{header}");
    let numbers: Vec<f32> =
        file[128..].as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    assert_eq!(numbers.len(), 150);
    // The middle of the ball, and half a radius beside it along x.
    let at = |x: usize, y: usize, z: usize| numbers[(z * 5 + y) * 5 + x];
    assert_eq!((at(2, 2, 2), at(3, 2, 2), at(2, 2, 5)), (1.0, 0.5, 0.0));

    let all = folder.jbt(
        &[&["sample", "ball.jbt", "-o", "-", "--format", "npy", "--query", "all", "-q"][..], &lattice]
            .concat(),
    );
    assert_eq!(all.code(0).stdout_bytes().len(), 128 + 4 * 150 * 7);
    folder.jbt(&[&["sample", "ball.jbt", "-o", "a.vdb"][..], &lattice].concat()).code(0);
    assert!(folder.read("a.vdb").starts_with(b" BDV"));
    let levels = [&["sample", "ball.jbt", "-o", "b.vdb", "--level-set"][..], &lattice].concat();
    folder.jbt(&levels).code(0).says("distances of the level set are those of tangents");
    let file = folder.read("b.vdb");
    let has = |word: &str| file.windows(word.len()).any(|bytes| bytes == word.as_bytes());
    assert!(has("level set") && has("surface") && !has("density") && !has("gradient"));
    folder.jbt(&["sample", "ball.jbt", "-o", "a.npy", "--level-set"]).code(2).says("written as .vdb");
    let huge = ["sample", "ball.jbt", "-o", "b.npy", "--resolution", "5000"];
    folder.jbt(&huge).code(3).says("more than 1073741824 numbers");
    folder.jbt(&["sample", "ball.jbt", "-o", "b.npy", "--cell", "0"]).code(2);
}

/// From a screen's number to linear light, through the field, and back to a screen's number in the file.
#[test]
fn a_colour_in_hex_comes_out_as_it_went_in() {
    let folder = folder();
    for color in ["\"#ff8800\"", "\"#f80\"", "srgb(1 136/255 0)"] {
        let text = format!("jbt 1 color {color} {{ point {{ surface_radius 1 }} }}");
        let folder = Folder::new().with("ball.jbt", text);
        folder.jbt(&["mesh", "ball.jbt", "-o", "ball.obj", "--resolution", "8"]).code(0);
        let file = String::from_utf8(folder.read("ball.obj")).unwrap();
        let vertices = file.lines().filter_map(|line| line.strip_prefix("v "));
        let colors: Vec<Vec<f64>> = vertices
            .map(|line| line.split(' ').skip(3).map(|word| word.parse().unwrap()).collect())
            .collect();
        assert!(colors.len() > 10);
        for found in colors {
            let bytes: Vec<f64> = found.iter().map(|x| x * 255.0).collect();
            assert!((bytes[0] - 255.0).abs() < 0.01 && (bytes[1] - 136.0).abs() < 0.01, "{color}: {bytes:?}");
            assert!(bytes[2].abs() < 0.01 && bytes.len() == 3, "{color}: {bytes:?}");
        }
    }
    let told = folder.with("bare.jbt", "jbt 1\ncolor #ff8800 { point { surface_radius 1 } }\n");
    let told =
        told.jbt(&["check", "bare.jbt"]).code(1).says("bare.jbt:2:7: error: `#ff8800` begins a comment");
    assert_eq!(told.stderr().matches("error: ").count(), 1, "{}", told.stderr());
}

#[test]
fn parts_thinner_than_a_cell_are_told() {
    let scene = "jbt 1 union { point { surface_radius 0.5 } \
                 segment { from (1 -1 1) to (1.2 1 0.9) surface_radius 0.005 } }";
    let folder = folder().with("hair.jbt", scene);
    let arguments = ["mesh", "hair.jbt", "-o", "a.obj", "--force", "--cell", "0.05"];
    let ran = folder.jbt(&arguments).code(0).says("1 place may hold parts thinner than a cell, near (");
    ran.says("); try --cell 0.00");
    let json = folder.jbt(&[&arguments[..], &["--json"]].concat()).code(0).json();
    let warning = json["warnings"][0].as_str().expect("it warns");
    assert!(warning.starts_with("1 place may hold parts thinner than a cell, near (1"), "{warning}");
    let thin = &json["thin"];
    assert_eq!((&thin["places"], thin["near"].as_array().map(Vec::len)), (&1.into(), Some(1)));
    assert!(thin["missed"].as_u64().is_some_and(|missed| missed > 4), "{thin}");
    let cell = thin["cell"].as_f64().expect("it advises");
    assert!((0.002..=0.005).contains(&cell), "{cell}");
    for key in ["shredded", "unproven", "boxes", "evaluations", "interval_evaluations"] {
        assert!(thin[key].is_u64(), "{key}");
    }
    // As fine as advised, the hair is there.
    let cell = cell.to_string();
    let region = ["--cell", &cell, "--region", "1,-0.1,0.9,1.2,0.1,1", "--json"];
    let fine = folder.jbt(&[&["mesh", "hair.jbt", "-o", "b.obj"], &region[..]].concat()).code(0).json();
    assert_eq!(fine["thin"]["places"], 0);
    assert!(fine["triangles"].as_u64().is_some_and(|triangles| triangles > 100));

    let ran = folder.jbt(&[&arguments[..], &["--no-thin", "--json"]].concat()).code(0).json();
    assert_eq!((&ran["warnings"], &ran["thin"]), (&serde_json::json!([]), &serde_json::Value::Null));
}
