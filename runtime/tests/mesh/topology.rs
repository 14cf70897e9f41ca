//! Closed and manifold for any signs whatever, and the same bits however the work is divided.

use jbt::mesh::{Lattice, Mesh, MeshReport, Options, check_manifold, extract, is_closed};

use crate::fields::{Closed, Sample, cubic, hash, signs, sphere, torus, union};

fn mesh(field: impl Fn([f32; 3]) -> Sample + Sync, cells: [usize; 3]) -> (Mesh, MeshReport) {
    extract(&Closed(field), &Lattice::new([0.0; 3], 1.0, cells).unwrap(), &Options::default()).run().unwrap()
}

#[track_caller]
fn assert_manifold(mesh: &Mesh, report: &MeshReport, what: impl Fn() -> String) {
    assert!(report.closed && !report.cut_sides.any(), "{}", what());
    assert_eq!(check_manifold(mesh.positions.len(), &mesh.triangles), Ok(()), "{}", what());
}

/// Twice the area of the projections of all triangles, with signs: zero for a closed surface.
fn total_area_vector(mesh: &Mesh) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for triangle in &mesh.triangles {
        let [p, q, r] = triangle.map(|v| mesh.positions[v as usize].map(f64::from));
        for (axis, sum) in sum.iter_mut().enumerate() {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            *sum += (q[b] - p[b]) * (r[c] - p[c]) - (q[c] - p[c]) * (r[b] - p[b]);
        }
    }
    sum
}

#[test]
fn every_case_of_one_cell() {
    for case in 0..256_u32 {
        let inside = |p: [i64; 3]| {
            p.iter().all(|&c| c == 1 || c == 2)
                && case >> ((p[0] - 1) + 2 * (p[1] - 1) + 4 * (p[2] - 1)) & 1 == 1
        };
        let (mesh, report) = mesh(signs(inside), [3; 3]);
        assert_manifold(&mesh, &report, || format!("case {case:08b}"));
        assert_eq!(mesh.triangles.is_empty(), case == 0);
        assert!(total_area_vector(&mesh).iter().all(|c| c.abs() < 1e-4));
    }
}

#[test]
fn every_case_of_two_cells_along_every_axis() {
    let mut flipped = 0;
    for axis in 0..3 {
        for case in 0..4096_u32 {
            let inside = |p: [i64; 3]| {
                let q = [p[axis] - 1, p[(axis + 1) % 3] - 1, p[(axis + 2) % 3] - 1];
                let within = (0..3).contains(&q[0]) && (0..2).contains(&q[1]) && (0..2).contains(&q[2]);
                within && case >> (q[0] + 3 * q[1] + 6 * q[2]) & 1 == 1
            };
            let mut cells = [3; 3];
            cells[axis] = 4;
            let (mesh, report) = mesh(signs(inside), cells);
            assert_manifold(&mesh, &report, || format!("axis {axis}, case {case:012b}"));
            flipped += report.flipped_faces;
        }
    }
    // The rule for bad faces is needed, and the same number of times along each axis.
    assert!(flipped > 0 && flipped.is_multiple_of(3), "{flipped}");
}

#[test]
fn noise_is_closed_and_manifold() {
    let mut flipped = 0;
    for seed in 0..60 {
        // From rare specks over a sponge to rare holes.
        let density = 10 + seed % 9 * 10;
        let n = 24;
        let inside = |p: [i64; 3]| p.iter().all(|&c| c > 0 && c < n) && hash(seed, p) % 100 < density;
        let (mesh, report) = mesh(signs(inside), [n as usize; 3]);
        assert_manifold(&mesh, &report, || format!("seed {seed}"));
        flipped += report.flipped_faces;
        assert!(mesh.triangles.len() > 1000);
    }
    assert!(flipped > 1000, "{flipped}");
}

/// By construction, as by looking at every edge.
#[test]
fn a_closed_mesh_is_told_from_an_open_one() {
    let mut seen = [[0; 2]; 2];
    for seed in 0..4000 {
        let density = [3, 10, 50, 97][seed as usize % 4];
        let cells = [0, 1, 2].map(|axis| 1 + (hash(seed, [axis, 7, 7]) % 7) as usize);
        let lattice = Lattice::new([0.0; 3], 1.0, cells).unwrap();
        let field = Closed(signs(|p| hash(seed, p) % 100 < density));
        let options = Options { verify: false, brick: Some(2 << (seed % 3)), ..Options::default() };
        let (mesh, report) = extract(&field, &lattice, &options).run().unwrap();
        assert_eq!(report.closed, is_closed(mesh.positions.len(), &mesh.triangles), "seed {seed}");
        let is_some = !mesh.triangles.is_empty() && report.cut_sides.any();
        seen[usize::from(is_some)][usize::from(report.closed)] += 1;
    }
    assert!(seen[1].into_iter().all(|count| count > 50) && seen[0][1] > 50, "{seen:?}");
}

#[test]
fn noise_that_the_region_cuts_is_open_but_sound() {
    for seed in 0..10 {
        let (mesh, report) = mesh(signs(|p| hash(seed, p) & 1 == 1), [12; 3]);
        assert!(!report.closed && report.cut_sides.low == [true; 3] && report.cut_sides.high == [true; 3]);
        // An edge has two triangles in opposite directions, or one: never more.
        let mut edges = std::collections::HashMap::<(u32, u32), u32>::new();
        let mut used = vec![false; mesh.positions.len()];
        for &[p, q, r] in &mesh.triangles {
            for edge in [(p, q), (q, r), (r, p)] {
                *edges.entry(edge).or_default() += 1;
                used[edge.0 as usize] = true;
            }
        }
        assert!(edges.values().all(|&count| count == 1));
        assert!(used.into_iter().all(|used| used));
    }
}

#[test]
fn vertices_stay_in_their_cells() {
    // A gradient that has nothing to do with the field pulls far and anywhere.
    let field = |p: [f32; 3]| {
        let q = p.map(|c| c.round() as i64);
        let inside = q.iter().all(|&c| c > 0 && c < 10) && hash(5, q) & 1 == 1;
        (if inside { 1.0 } else { 0.0 }, [p[1] * 0.1, -p[0], 1e-3])
    };
    let lattice = Lattice::new([0.0; 3], 1.0, [10; 3]).unwrap();
    let pulled =
        |pulls| extract(&Closed(field), &lattice, &Options { pulls, ..Options::default() }).run().unwrap();
    let ((start, _), (end, report)) = (pulled(0), pulled(5));
    assert_manifold(&end, &report, String::new);
    assert_eq!(start.positions.len(), end.positions.len());
    let mut moved = 0;
    for (start, end) in start.positions.iter().zip(&end.positions) {
        // Without pulls a vertex is the mean of midpoints of edges, and so strictly within its cell.
        assert!(start.iter().zip(end).all(|(start, end)| (start.floor()..=start.ceil()).contains(end)));
        moved += usize::from(start != end);
    }
    assert!(moved * 2 > start.positions.len());
}

/// All bits of a mesh.
pub fn bits(mesh: &Mesh) -> Vec<u32> {
    let reals = mesh.positions.iter().chain(&mesh.normals).flatten().map(|c| c.to_bits());
    let attributes =
        mesh.attributes.iter().flat_map(|attribute| attribute.values.iter().map(|v| v.to_bits()));
    reals.chain(attributes).chain(mesh.triangles.iter().flatten().copied()).collect()
}

/// What does not depend on the bricks.
pub fn without_boxes(mut report: MeshReport) -> MeshReport {
    // Neighbouring bricks look for jumps on the edges between them, each by itself.
    (report.boxes, report.bricks, report.jump_evaluations) = (0, 0, 0);
    report
}

#[test]
fn the_same_bits_for_any_threads_and_bricks() {
    let blobs = union(union(torus(0.8, 0.3), sphere([0.1, 0.0, 0.5], 0.45)), cubic(0.9));
    let smooth = (Lattice::covering([-1.3, -1.25, -0.7], [1.3, 1.25, 1.2], 0.041).unwrap(), Closed(blobs));
    let inside = |p: [i64; 3]| p.iter().all(|&c| c > 0 && c < 40) && hash(9, p) & 1 == 1;
    let rough = (Lattice::new([0.0; 3], 1.0, [40, 40, 40]).unwrap(), Closed(signs(inside)));
    let run = |threads: usize, brick: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = Options { brick: Some(brick), ..Options::default() };
        pool.install(|| {
            let (a, report_a) = extract(&smooth.1, &smooth.0, &options).run().unwrap();
            let (b, report_b) = extract(&rough.1, &rough.0, &options).run().unwrap();
            assert!(report_a.closed && report_b.closed);
            (bits(&a), without_boxes(report_a), bits(&b), without_boxes(report_b))
        })
    };
    let expected = run(1, 8);
    for (threads, brick) in [(4, 8), (1, 2), (4, 4), (3, 16), (2, 32)] {
        assert!(run(threads, brick) == expected, "{threads} threads, bricks of {brick}");
    }
}
