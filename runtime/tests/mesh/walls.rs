//! Where the field jumps, vertices are on the wall and have its normal, whatever the field inside does.

use jbt::mesh::{Lattice, MeshReport, Options, check_manifold, extract};
use jbt::{Box3, Compiler, Engine, Fineness, Polygonize, Polygonized};
use jbt_testkit::scene::tree;
use jbt_testkit::vector::{dot, length};

use crate::fields::{Closed, Sample};
use crate::models::{cell, mesh, mesh_in, volume};
use crate::topology::{bits, without_boxes};

/// Half of a box of edge 2: where x y z is positive, in checkerboard octants. Near the coordinate planes the
/// inner field is near the iso-value.
const OCTANTS: &str = "within (-1 -1 -1) to (1 1 1) { expression { 0.5 + x * y * z } }";

/// Along how many axes a cell has one of these coordinates; with two or more of them it may hold an edge of
/// the solid.
fn planes_through([low, high]: [[f64; 3]; 2]) -> usize {
    let has = |axis: usize| [-1.0, 0.0, 1.0].iter().any(|c| (low[axis]..=high[axis]).contains(c));
    (0..3).filter(|&axis| has(axis)).count()
}

/// Vertices are within 1e-3 cells of the walls, but in cells that hold an edge of the solid; and there the
/// normals are those of the walls.
#[track_caller]
fn assert_octants(made: &Polygonized, volume_off: f64) {
    let cell_size = made.lattice.spacing();
    assert!(made.report.closed);
    assert!((volume(&made.mesh) / 4.0 - 1.0).abs() < volume_off, "volume {}", volume(&made.mesh));
    let (mut on_walls, mut flat) = (0, std::collections::BTreeMap::<(usize, bool), Vec<f32>>::new());
    for (&position, &normal) in made.mesh.positions.iter().zip(&made.mesh.normals) {
        if planes_through(cell(made, position)) > 1 {
            continue;
        }
        let near = |level: f64| {
            (0..3).find(|&axis| (f64::from(position[axis]).abs() - level).abs() < 1e-3 * cell_size)
        };
        let Some(axis) = near(1.0) else {
            assert!(near(0.0).is_some(), "{position:?} is on no wall, and not on a coordinate plane");
            continue;
        };
        let mut expected = [0.0; 3];
        expected[axis] = position[axis].signum();
        assert!(normal == expected, "{normal:?} at {position:?}");
        flat.entry((axis, position[axis] > 0.0)).or_default().push(position[axis]);
        on_walls += 1;
    }
    assert!(on_walls > made.mesh.positions.len() / 4, "{on_walls} of {}", made.mesh.positions.len());
    assert_eq!(flat.len(), 6);
    for levels in flat.values() {
        assert!(levels.iter().all(|level| level == &levels[0]), "a wall that is not flat");
    }
}

/// With perfect walls and vertices in the means of their crossings the cut edges take 0.3 % at 64 cells and
/// 0.1 % at 128.
#[test]
fn the_walls_of_within_are_where_they_are() {
    for (resolution, off) in [(32, 0.015), (64, 0.004), (128, 0.001)] {
        assert_octants(&mesh(OCTANTS, resolution), off);
    }
    // Walls that do not lie along the lattice.
    let region = Some(Box3::new([-2.0; 3], [2.03, 2.05, 2.07]));
    assert_octants(&mesh_in(OCTANTS, region, Fineness::Resolution(96)), 0.006);
}

/// How far a vertex may be from a wall, in cells.
const NEAR: f64 = 1e-3;
/// The diagonal of a cell.
const DIAGONAL: f64 = 1.733;

/// Whether an inner field like this, at a distance of two cells, is still above the iso-value, with cells of
/// this size. Its second derivatives are at most 50.
fn is_inside(field: f64, slope: f64, size: f64) -> bool {
    let reach = 2.0 * DIAGONAL * size;
    field - 0.5 > slope * reach + 25.0 * reach * reach
}

/// Checks the vertices of `wall and inner >= 0.5`. `wall` is the distance to the wall, with signs, and the
/// normal of the wall; `inner` is the field inside, and the length of its gradient. A vertex is on the wall
/// or on the surface inside; where both are within a diagonal it may be anywhere between. Returns how many
/// are on the wall and nowhere else.
#[track_caller]
fn assert_on_walls(
    made: &Polygonized,
    wall: impl Fn([f64; 3]) -> (f64, [f64; 3]),
    inner: impl Fn([f64; 3]) -> (f64, f64),
) -> usize {
    assert!(made.report.closed);
    let size = made.lattice.spacing();
    let mut count = 0;
    for (&position, &normal) in made.mesh.positions.iter().zip(&made.mesh.normals) {
        let point = position.map(f64::from);
        let (distance, expected) = wall(point);
        let (field, slope) = inner(point);
        let to_inner = (field - 0.5).abs() / slope.max(1e-9);
        if is_inside(field, slope, size) {
            assert!(distance.abs() < NEAR * size, "{point:?} is {} cells off the wall", distance / size);
            assert!(dot(normal.map(f64::from), expected) > 0.97, "{normal:?} at {point:?}, not {expected:?}");
            count += 1;
        } else {
            let to_either = distance.abs().min(to_inner);
            assert!(to_either < DIAGONAL * size, "{point:?} is {} cells off", to_either / size);
        }
    }
    assert!(count > made.mesh.positions.len() / 10, "{count} of {}", made.mesh.positions.len());
    count
}

/// The gyroid with its period, and the length of its gradient.
fn gyroid(scale: f64) -> impl Fn([f64; 3]) -> (f64, f64) {
    move |p| {
        let [(sx, cx), (sy, cy), (sz, cz)] = p.map(|c| (scale * c).sin_cos());
        let gradient = [cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz].map(|c| scale * c);
        (0.6 + sx * cy + sy * cz + sz * cx, length(gradient))
    }
}

const GYROID: &str = "0.6 + sin(5 * x) * cos(5 * y) + sin(5 * y) * cos(5 * z) + sin(5 * z) * cos(5 * x)";

#[test]
fn walls_of_balls_and_half_spaces_by_predicates() {
    let ball = |p: [f64; 3]| (length(p) - 0.9, p.map(|c| c / length(p)));
    let bounds = "within (-1.1 -1.1 -1.1) to (1.1 1.1 1.1)";
    // A field that is never near the iso-value: all of the surface is the wall.
    let text = format!(
        "{bounds} {{ expression {{ step(length(x, y, z), 0.9) * (0.8 + 0.2 * sin(7 * x) * cos(5 * y)) }} }}"
    );
    for resolution in [16, 33, 64] {
        let made = mesh(&text, resolution);
        assert_on_walls(&made, ball, |_| (1e9, 0.0));
        assert_eq!(made.report.jump_vertices, made.mesh.positions.len() as u64);
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 0.9_f64.powi(3);
        let off = volume(&made.mesh) / exact - 1.0;
        assert!(off.abs() < 1.5 * made.lattice.spacing().powi(2), "volume off by {off}");
    }
    let text = format!("{bounds} {{ expression {{ step(length(x, y, z), 0.9) * ({GYROID}) }} }}");
    assert_on_walls(&mesh(&text, 80), ball, gyroid(5.0));
    // A slanted half space with the gyroid inside; the box ends it far away.
    let normal = [1.0, 0.7, 0.2].map(|c| c / 1.53_f64.sqrt());
    let half = |p: [f64; 3]| {
        let box_side = (0..3).map(|axis| p[axis].abs() - 1.1).fold(f64::MIN, f64::max);
        let plane = dot(p, normal) - 0.3 / 1.53_f64.sqrt();
        let side = [0, 1, 2].map(|axis| if p[axis].abs() - 1.1 == box_side { p[axis].signum() } else { 0.0 });
        if plane.abs() < box_side.abs() { (plane, normal) } else { (box_side, side) }
    };
    let text = format!("{bounds} {{ expression {{ step(x + 0.7 * y + 0.2 * z, 0.3) * ({GYROID}) }} }}");
    let made = mesh(&text, 80);
    let size = made.lattice.spacing();
    let on_plane = made.mesh.positions.iter().zip(&made.mesh.normals).filter(|(p, _)| {
        let p = p.map(f64::from);
        let (inner, slope) = gyroid(5.0)(p);
        let is_far = is_inside(inner, slope, size);
        let (distance, side) = half(p);
        is_far && side == normal && distance.abs() < size && p.iter().all(|c| c.abs() < 1.1 - 3.0 * size)
    });
    let mut count = 0;
    for (position, found) in on_plane {
        let (distance, _) = half(position.map(f64::from));
        assert!(distance.abs() < NEAR * size, "{position:?} is {} cells off", distance / size);
        assert!(dot(found.map(f64::from), normal) > 0.999, "{found:?} at {position:?}");
        count += 1;
    }
    assert!(count > 500, "{count}");
}

/// A box that is turned, with the gyroid inside: flat walls, to the precision of halved edges.
#[test]
fn walls_of_turned_boxes() {
    let text = format!(
        "rotate axis y degrees 30 {{ rotate axis x degrees 20 {{ within (-1 -0.8 -0.6) to (1 0.8 0.6) {{ expression {{ {GYROID} }} }} }} }}"
    );
    let (sin_y, cos_y) = 30_f64.to_radians().sin_cos();
    let (sin_x, cos_x) = 20_f64.to_radians().sin_cos();
    // To the space of the box.
    let inner = move |[x, y, z]: [f64; 3]| {
        let [x, y, z] = [cos_y * x - sin_y * z, y, sin_y * x + cos_y * z];
        [x, cos_x * y + sin_x * z, -sin_x * y + cos_x * z]
    };
    let made = mesh(&text, 90);
    let (size, half) = (made.lattice.spacing(), [1.0, 0.8, 0.6]);
    let (mut counts, mut rough) = ([0_usize; 3], 0);
    for (position, normal) in made.mesh.positions.iter().zip(&made.mesh.normals) {
        let point = inner(position.map(f64::from));
        let (field, slope) = gyroid(5.0)(point);
        let walls = [0, 1, 2].map(|axis| point[axis].abs() - half[axis]);
        let close = (0..3).filter(|&axis| walls[axis] > -2.0 * size).count();
        if close != 1 || !is_inside(field, slope, size) {
            continue;
        }
        let axis = (0..3).find(|&axis| walls[axis] > -2.0 * size).expect("one is close");
        assert!(walls[axis].abs() < NEAR * size, "{point:?} is {} cells off", walls[axis] / size);
        let normal = inner(normal.map(f64::from));
        // Where a wall cuts off a corner of a cell that is hardly larger than what its crossings are off, the
        // normal is rough.
        let along = normal[axis] * point[axis].signum();
        assert!(along > 0.5, "{normal:?} at {point:?}");
        rough += usize::from(along < 0.999);
        counts[axis] += 1;
    }
    assert!(counts.iter().all(|&count| count > 300), "{counts:?}");
    assert!(50 * rough < counts.iter().sum::<usize>(), "{rough} of {counts:?}");
}

/// A ball of radius 0.83 with a jump, with an inner field that is near the iso-value along planes.
fn jump(p: [f32; 3]) -> Sample {
    let [x, y, z] = p;
    if x * x + y * y + z * z < 0.83 * 0.83 { (0.5 + x * y, [y, x, 0.0]) } else { (0.1 * x, [0.1, 0.0, 0.0]) }
}

#[test]
fn walls_have_the_same_bits_for_any_threads_bricks_and_engines() {
    let lattice = Lattice::covering([-1.0; 3], [1.0; 3], 0.037).unwrap();
    let run = |threads: usize, brick: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = Options { brick: Some(brick), ..Options::default() };
        let (mesh, report) = pool.install(|| extract(&Closed(jump), &lattice, &options).run()).unwrap();
        assert!(report.jump_vertices > 1000);
        assert_eq!(check_manifold(mesh.positions.len(), &mesh.triangles), Ok(()));
        (bits(&mesh), without_boxes(report))
    };
    let expected = run(1, 8);
    for (threads, brick) in [(4, 8), (1, 2), (3, 4), (2, 16), (1, 32)] {
        assert!(run(threads, brick) == expected, "{threads} threads, bricks of {brick}");
    }
    let polygonize = Polygonize { fineness: Fineness::Resolution(24), ..Polygonize::default() };
    let tree = tree(OCTANTS);
    let made = |engine| polygonize.mesh(&Compiler::for_engine(engine), &tree).run().unwrap();
    let expected = made(Engine::Scalar);
    for engine in [Engine::Lanes, Engine::Jit] {
        assert!(made(engine).mesh == expected.mesh, "{}", engine.name());
    }
}

/// What a smooth surface pays for walls: nothing is evaluated on its account. A crease pays for a few
/// halvings, and jumps nowhere.
#[test]
fn smooth_surfaces_have_no_walls() {
    let blobs =
        "sum { point { at (-0.4 0 0) surface_radius 0.31 } point { at (0.4 0.1 0) surface_radius 0.4 } }";
    let MeshReport { jump_evaluations, jump_vertices, .. } = mesh(blobs, 64).report;
    assert_eq!((jump_evaluations, jump_vertices), (0, 0));
    let crease =
        "union { point { at (-0.4 0 0) surface_radius 0.5 } point { at (0.4 0.1 0) surface_radius 0.5 } }";
    let made = mesh(crease, 64);
    assert_eq!(made.report.jump_vertices, 0);
    assert!(made.report.jump_evaluations < made.mesh.positions.len() as u64, "{:?}", made.report);
    // Steep, but no jump: 0 to 1 within a tenth of a cell.
    let steep =
        "within (-1 -1 -1) to (1 1 1) { expression { 1 / (1 + exp(400 * (length(x, y, z) - 0.7))) } }";
    let made = mesh(steep, 40);
    assert_eq!(made.report.jump_vertices, 0);
    for position in &made.mesh.positions {
        let off = (length(position.map(f64::from)) - 0.7) / made.lattice.spacing();
        assert!(off.abs() < 0.01, "{off} cells off");
    }
}

/// Attributes are those of the inside, and not of the emptiness beyond the wall.
#[test]
fn walls_have_the_attributes_of_the_inside() {
    let text = "within (-1 -1 -1) to (1 1 1) { color (0.2 0.4 0.6) { expression { 1 + 0.3 * x } } }";
    let made = mesh(text, 20);
    let color = made.mesh.attributes.iter().find(|attribute| attribute.name == "color").expect("a color");
    for value in color.values.as_chunks::<3>().0 {
        assert_eq!(value, &[0.2, 0.4, 0.6]);
    }
}
