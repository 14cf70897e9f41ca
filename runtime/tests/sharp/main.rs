//! Edges and corners of the surface: vertices are on them, normals and attributes are split there, and smooth
//! models keep their bits.
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

mod cube;

use std::collections::BTreeMap;

use jbt::mesh::{Mesh, check_manifold};
use jbt::{Compiler, Engine, Fineness, LiveMesh, Polygonize, Polygonized};
use jbt_testkit::scene::tree;

use cube::Cube;

fn settings(cell: f64, sharp: bool) -> Polygonize {
    Polygonize { fineness: Fineness::Cell(cell), sharp, verify: true, ..Polygonize::default() }
}

fn mesh(text: &str, cell: f64, sharp: bool) -> Polygonized {
    settings(cell, sharp).mesh(&Compiler::new(), &tree(text)).run().unwrap()
}

#[track_caller]
fn assert_sound(made: &Polygonized) {
    assert!(made.report.closed);
    check_manifold(made.mesh.positions.len(), &made.mesh.triangles).unwrap();
}

/// The ways to cut a cube of half side `a` out of space.
fn cubes(a: f64) -> Vec<(&'static str, String)> {
    vec![
        (
            "formula",
            format!("expression within (-2 -2 -2) to (2 2 2) {{ 0.5 + {a} - max(abs(x), abs(y), abs(z)) }}"),
        ),
        ("within", format!("within (-{a} -{a} -{a}) to ({a} {a} {a}) {{ point {{ radius 9 }} }}")),
        (
            "rfunction",
            format!(
                "rfunction intersection alpha 1 {{
                    expression within (-2 -2 -2) to (2 2 2) {{ 0.5 + {a} - abs(x) }}
                    expression within (-2 -2 -2) to (2 2 2) {{ 0.5 + {a} - abs(y) }}
                    expression within (-2 -2 -2) to (2 2 2) {{ 0.5 + {a} - abs(z) }}
                }}"
            ),
        ),
        (
            "intersection",
            format!(
                "intersection {{
                    expression within (-2 -2 -2) to (2 2 2) {{ 0.5 + {a} - abs(x) }}
                    expression within (-2 -2 -2) to (2 2 2) {{ 0.5 + {a} - abs(y) }}
                    expression within (-2 -2 -2) to (2 2 2) {{ 0.5 + {a} - abs(z) }}
                }}"
            ),
        ),
        ("half-spaces", half_spaces(a)),
    ]
}

/// Faces of three kinds, which are rows of three tables.
fn half_spaces(a: f64) -> String {
    let face = |n: usize, more: &str| {
        let (axis, side) = (n / 2, if n.is_multiple_of(2) { 1.0 } else { -1.0 });
        let [normal, at] = [side, side * (a - 0.1)].map(|along| {
            let mut vector = [0.0; 3];
            vector[axis] = along;
            let [x, y, z] = vector;
            format!("({x} {y} {z})")
        });
        format!("half_space {{ at {at} normal {normal} surface_radius 0.1 {more} }}")
    };
    let kinds = ["", "strength 2", "falloff linear"];
    let faces: Vec<String> = (0..6).map(|n| face(n, kinds[n / 2])).collect();
    format!("intersection {{ {} }}", faces.join(" "))
}

#[track_caller]
fn assert_exact(name: &str, cube: &Cube, [usual, made]: &[Polygonized; 2]) {
    assert_sound(made);
    let found = cube.judge(made, usual);
    println!("{name}: {found:?}");
    assert!(found.cells >= 8 + 12 * 10, "{name}: {found:?}");
    assert!(found.worst < 1e-3, "{name}: {found:?}");
    assert!(found.worst_corner < 1e-3, "{name}: {found:?}");
    assert_eq!(found.folded, 0, "{name}");
}

/// A cube along the lattice, with its faces anywhere between lattice planes.
#[test]
fn a_cube_along_the_lattice_is_exact() {
    for a in [0.7, 0.73, 0.75, 0.81, 0.8125] {
        for (name, text) in cubes(a) {
            let made = [false, true].map(|sharp| mesh(&format!("jbt 1 {text}"), 0.125, sharp));
            assert_exact(&format!("{name} {a}"), &Cube::along_axes(a, 0.0), &made);
        }
    }
}

/// A cube with all faces in lattice planes.
#[test]
fn a_cube_on_the_lattice_is_exact() {
    let compiler = Compiler::new();
    let lattice = mesh(&format!("jbt 1 {}", cubes(0.75)[0].1), 0.125, true).lattice;
    let planes: Vec<f32> = (0..=lattice.cells()[0]).map(|n| lattice.coordinate(0, n)).collect();
    for (half, centre) in [(0.75, -0.007_812_5), (0.8125, 0.054_687_5)] {
        assert!([centre - half, centre + half].iter().all(|&face| planes.contains(&(face as f32))));
        for (name, text) in cubes(half) {
            // Their faces are not to the bit where the planes are, so the cells beside may have them.
            if name == "half-spaces" {
                continue;
            }
            let text = format!("jbt 1 translate ({centre} {centre} {centre}) {{ {text} }}");
            let compiled = compiler.compile(&tree(&text));
            let made =
                [false, true].map(|sharp| settings(0.125, sharp).over(&compiled, &lattice).run().unwrap());
            assert_exact(&format!("{name} {half}"), &Cube::along_axes(half, centre), &made);
        }
    }
}

#[test]
fn turned_cubes_have_sharp_edges() {
    let mut random = fastrand::Rng::with_seed(11);
    for (name, text) in cubes(0.8) {
        let (mut cells, mut good, mut worst, mut folded, mut before) = (0, 0, 0.0_f64, 0, 0);
        let mut corners = 0;
        for _ in 0..6 {
            let axis = [0; 3].map(|_| 2.0 * random.f64() - 1.0);
            let degrees = 180.0 * random.f64();
            let [x, y, z] = axis;
            let text = format!("jbt 1 rotate axis ({x} {y} {z}) degrees {degrees} {{ {text} }}");
            let cube = Cube::turned(0.8, axis, degrees);
            let [usual, made] = [false, true].map(|sharp| mesh(&text, 0.08, sharp));
            assert_sound(&made);
            let found = cube.judge(&made, &usual);
            assert_eq!(found.worse, 0, "{name}");
            (cells, good) = (cells + found.cells, good + found.good);
            (worst, folded) = (worst.max(found.worst), folded + found.folded);
            let usual_folded = cube.judge(&usual, &usual).folded;
            assert!(found.folded <= usual_folded, "{name}: {found:?}, {usual_folded} folded before");
            before += usual_folded;
            corners += found.corners[0];
            assert_eq!(found.corners[1], 0, "{name}: {found:?}");
        }
        println!(
            "{name}: {good} of {cells} feature cells, worst {worst:.4} cells, {corners} of 48 corners, \
             {folded} folded, {before} before"
        );
        assert!(cells > 1_000);
        // The others are close to cells that the surface goes through twice, whose vertices stay.
        assert!(corners >= 46, "{name}: {corners} corners");
        assert!(good as f64 >= 0.99 * cells as f64, "{name}: {good} of {cells}");
        assert!(worst < 0.5, "{name}: {worst}");
    }
}

#[test]
fn normals_and_attributes_are_split_and_positions_are_not() {
    let text = "jbt 1 union {
        color (1 0 0) { expression within (-2 -2 -2) to (2 2 2) { 0.5 + 0.8 - max(abs(x), abs(y), abs(z)) } }
        color (0 0 1) { expression within (-2 -2 -2) to (2 2 2) { 0.5 + 0.5 - max(abs(x), abs(y), abs(z - 0.9)) } }
    }";
    let made = mesh(text, 0.08, true);
    assert_sound(&made);
    let mesh = &made.mesh;
    let split = mesh.split();
    assert!(split.positions.len() > mesh.positions.len());
    assert_eq!(split.triangles.len(), mesh.triangles.len());
    let colors = split.colors().unwrap();
    for (triangle, shared) in split.triangles.iter().zip(&mesh.triangles) {
        for (&vertex, &before) in triangle.iter().zip(shared) {
            assert_eq!(split.positions[vertex as usize], mesh.positions[before as usize]);
        }
        let p = triangle.map(|vertex| split.positions[vertex as usize]);
        let [u, v] = [1, 2].map(|n| [0, 1, 2].map(|axis| f64::from(p[n][axis] - p[0][axis])));
        let area = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = area.iter().map(|c| c * c).sum::<f64>().sqrt();
        // Each face has its own normal and colour at all corners.
        if length > 1e-3 * 0.08 * 0.08 {
            for &vertex in triangle {
                let normal = split.normals[vertex as usize];
                let dot: f64 = (0..3).map(|axis| area[axis] / length * f64::from(normal[axis])).sum();
                assert!(dot > 0.99, "{p:?}: {normal:?} {dot}");
                assert!([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].contains(&colors[vertex as usize]));
            }
            assert_eq!(colors[triangle[0] as usize], colors[triangle[1] as usize]);
            assert_eq!(colors[triangle[0] as usize], colors[triangle[2] as usize]);
        }
    }
}

/// Bits of everything.
fn bits(mesh: &Mesh) -> String {
    let mut parts = vec![format!("{:?}", mesh.triangles), format!("{:?}", mesh.creases.corners)];
    let mut reals = |reals: &[f32]| {
        parts.push(reals.iter().map(|real| format!("{:x} ", real.to_bits())).collect());
    };
    reals(mesh.positions.as_flattened());
    reals(mesh.normals.as_flattened());
    reals(mesh.creases.normals.as_flattened());
    mesh.attributes.iter().for_each(|attribute| reals(&attribute.values));
    mesh.creases.attributes.iter().for_each(|values| reals(values));
    parts.concat()
}

#[test]
fn smooth_models_keep_their_bits() {
    for text in [
        // As coarse as cells may be: by its angles it would be sharp.
        "jbt 1 point { surface_radius 0.2 }",
        "jbt 1 sum { point { radius 1 } translate (0.6 0.1 0) { box { half (0.4 0.3 0.2) radius 0.3 } } }",
        "jbt 1 blend ricci 4 { twist axis z rate 1 { segment { from (0 0 0) to (1 0 0) radius 0.5 } } point { radius 0.8 } }",
        "jbt 1 smooth_union width 0.2 { point { radius 1 } translate (0.9 0 0) { point { radius 1 } } }",
    ] {
        let made = [false, true].map(|sharp| mesh(text, 0.15, sharp));
        assert!(bits(&made[0].mesh) == bits(&made[1].mesh), "{text}");
        assert_eq!(made[1].report.sharp_vertices, 0);
    }
}

#[test]
fn engines_and_threads_agree() {
    let text = &format!("jbt 1 rotate axis (1 2 3) degrees 31 {{ {} }}", cubes(0.8)[3].1);
    let tree = tree(text);
    let first = bits(&mesh(text, 0.1, true).mesh);
    for engine in [Engine::Scalar, Engine::Lanes] {
        let made = settings(0.1, true).mesh(&Compiler::for_engine(engine), &tree).run().unwrap();
        assert!(bits(&made.mesh) == first, "{engine:?}");
    }
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let made = pool.install(|| mesh(text, 0.1, true));
        assert!(bits(&made.mesh) == first, "{threads} threads");
    }
}

/// Where vertices go back, they do in live meshes: after edits around them, and in their own bricks.
#[test]
fn live_meshes_unfold_as_full_ones() {
    for text in cubes(0.8).iter().take(2).map(|(_, text)| text) {
        let text = format!(
            "jbt 1 param turn = 0 param x = 3 union {{ rotate axis (1 2 3) degrees turn {{ {text} }}
            translate (x 0.3 0.2) {{ point {{ radius 0.9 }} }} }}"
        );
        let compiler = Compiler::new();
        let mut live = LiveMesh::new(&compiler, &tree(&text), settings(0.08, true)).run().unwrap();
        let mut random = fastrand::Rng::with_seed(3);
        for edit in 0..24 {
            let (turn, x) = (180.0 * random.f64(), 1.0 + 0.5 * random.f64());
            // Every other edit leaves the cube where it is.
            let edits = [("x", x), ("turn", turn)];
            live.set(&edits[..1 + edit % 2]).run().unwrap();
            let full = settings(0.08, true).over(live.compiled(), live.lattice()).run().unwrap();
            assert!(bits(&live.compact()) == bits(&full.mesh), "edit {edit}");
        }
    }
}

/// A live mesh after edits is that of a full run.
#[test]
fn live_meshes_are_sharp_too() {
    let text = "jbt 1 param a = 0.5 param turn = 0
        union {
            rotate axis (1 2 3) degrees 31 {
                expression within (-2 -2 -2) to (2 2 2) { 0.5 + 0.8 - max(abs(x), abs(y), abs(z)) }
            }
            translate (a 0.3 1) {
                difference { point { radius 1.2 } rotate axis x degrees turn { box { half (0.3 0.3 0.3) radius 0.4 } } }
            }
        }";
    let compiler = Compiler::new();
    let tree = tree(text);
    let mut live = LiveMesh::new(&compiler, &tree, settings(0.09, true)).run().unwrap();
    let mut random = fastrand::Rng::with_seed(3);
    for _ in 0..6 {
        let [a, turn] = [0.9 * random.f64(), 180.0 * random.f64()];
        live.set(&[("a", a), ("turn", turn)]).run().unwrap();
        let edited = tree.with_parameters(&[("a", a), ("turn", turn)]).unwrap();
        let compiled = compiler.compile(&edited);
        let full = settings(0.09, true).over(&compiled, live.lattice()).run().unwrap();
        assert!(full.report.sharp_vertices > 100);
        assert!(bits(&live.compact()) == bits(&full.mesh), "{a} {turn}");
    }
}

/// The volume of a mesh with edges is that of the solid.
#[test]
fn volumes_are_exact_where_faces_are_flat() {
    for (name, text) in cubes(0.8) {
        let text = format!("jbt 1 rotate axis (1 2 3) degrees 31 {{ {text} }}");
        let error =
            [false, true].map(|sharp| (mesh(&text, 0.1, sharp).mesh.volume() / 1.6_f64.powi(3) - 1.0).abs());
        println!("{name}: {error:?}");
        assert!(error[1] < 4e-4 && error[1] < 0.1 * error[0], "{name}: {error:?}");
    }
}

/// What is on several edges at once: of members that decide, each has some.
#[test]
fn members_that_decide_have_edges() {
    let scenes: BTreeMap<&str, &str> = BTreeMap::from([
        ("difference", "difference { point { radius 1 } translate (0.7 0 0) { point { radius 1 } } }"),
        ("mirror", "mirror axis x { translate (0.3 0 0) { point { radius 1 } } }"),
        ("union", "union { point { radius 1 } translate (0.7 0 0) { point { radius 1 } } }"),
        (
            "symmetric",
            "symmetric_difference { point { radius 1 } translate (0.7 0 0) { point { radius 1 } } }",
        ),
        ("rfunction", "rfunction union { point { radius 1 } translate (0.7 0 0) { point { radius 1 } } }"),
        ("lmetric", "lmetric { exponent 60 surface_radius 0.6 }"),
        (
            "mod",
            "expression within (-1 -1 -1) to (1 1 1) { 0.5 + 0.3 - abs(mod(x + 4, 0.5) - 0.25) - abs(z) }",
        ),
    ]);
    for (name, text) in scenes {
        let made = mesh(&format!("jbt 1 {text}"), 0.05, true);
        println!("{name}: {}", made.report.sharp_vertices);
        assert!(made.report.sharp_vertices > 20, "{name}");
        check_manifold(made.mesh.positions.len(), &made.mesh.triangles).unwrap();
    }
}
