//! Meshes by hand against the oracle and against the compiler's mesher.

use jbt::mesh::check_manifold;
use jbt::walk::{walk, walk_gradient};
use jbt::{Box3, Compiler, Fineness, Polygonize};

use crate::model::{ISO, blobs, tree};

use crate::limit::dense::Row;
use crate::limit::vector::run_plain;

use super::cull::{Candidates, Cull};
use super::finish::{Finish, Starts, Vertices};
use super::sample::{CORNERS, Sample, Samples};
use super::{Lattice, Mesh, mesh};

/// A lattice around all blobs. Its last bricks are not whole.
fn lattice(cells: usize) -> Lattice {
    Lattice { origin: [-1.5; 3], cell: 3.0 / cells as f32, counts: [cells + 1; 3] }
}

fn in_pool(threads: usize, make: impl FnOnce() -> Mesh + Send) -> Mesh {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(make)
}

#[test]
fn a_mesh_is_a_closed_manifold_also_where_faces_are_flipped() {
    let mut flipped = 0;
    for (count, cells) in [(1, 12), (64, 50), (512, 40), (4096, 70)] {
        let mesh = mesh(&blobs(count, 1), &lattice(cells), ISO);
        assert!(!mesh.triangles.is_empty());
        assert_eq!(check_manifold(mesh.positions.len(), &mesh.triangles), Ok(()), "{count} blobs");
        flipped += mesh.statistics.flipped_faces;
    }
    assert!(flipped > 0, "some model has a face to flip");
}

#[test]
fn vertices_are_on_the_surface_with_its_normals_and_colours() {
    let model = blobs(64, 2);
    let (tree, mesh) = (tree(&model), mesh(&model, &lattice(64), ISO));
    assert_eq!((mesh.normals.len(), mesh.colors.len()), (mesh.positions.len(), mesh.positions.len()));
    let mut errors = Vec::new();
    for index in (0..mesh.positions.len()).step_by(7) {
        let p = mesh.positions[index].map(f64::from);
        let (expected, slope) = (walk(&tree, p), walk_gradient(&tree, p, 1e-5));
        errors.push((expected.field - f64::from(ISO)).abs());
        let length = slope.iter().map(|slope| slope * slope).sum::<f64>().sqrt();
        for (axis, slope) in slope.into_iter().enumerate() {
            let normal = f64::from(mesh.normals[index][axis]);
            assert!((normal + slope / length).abs() < 1e-3, "the normal {normal} at {p:?}");
            let color = f64::from(mesh.colors[index][axis]);
            assert!((color - expected.attributes[0][axis]).abs() < 1e-3, "the colour {color} at {p:?}");
        }
    }
    errors.sort_by(f64::total_cmp);
    // Where the surface leaves a cell through an edge, its vertex may be held at the side of the cell.
    assert!(errors[errors.len() * 99 / 100] < 1e-4 && errors[errors.len() - 1] < 0.02, "{errors:?}");
}

#[test]
fn the_mesh_does_not_depend_on_the_threads() {
    let (model, lattice) = (blobs(512, 3), lattice(70));
    let one = in_pool(1, || mesh(&model, &lattice, ISO));
    assert_eq!(one, in_pool(2, || mesh(&model, &lattice, ISO)));
}

#[test]
fn the_compiler_makes_as_many_triangles() {
    let (model, cells) = (blobs(64, 4), 64);
    let by_hand = mesh(&model, &lattice(cells), ISO);
    let settings = Polygonize {
        region: Some(Box3::new([-1.5; 3], [1.5; 3])),
        fineness: Fineness::Cell(3.0 / cells as f64),
        verify: true,
        ..Polygonize::default()
    };
    let compiled = settings.mesh(&Compiler::new(), &tree(&model)).run().expect("blobs have a mesh");
    // A corner that is on the surface to within rounding may be inside for one of them only.
    assert!(by_hand.triangles.len().abs_diff(compiled.mesh.triangles.len()) <= 8);
}

#[test]
fn where_there_is_no_surface_there_is_no_mesh() {
    assert_eq!(mesh(&[], &lattice(20), ISO).triangles, [[0; 3]; 0]);
    assert_eq!(mesh(&blobs(64, 1), &lattice(20), 1e6).triangles, [[0; 3]; 0]);
    // All of it is inside.
    let tiny = Lattice { origin: blobs(1, 1)[0].center, cell: 1e-3, counts: [10; 3] };
    let inside = mesh(&blobs(1, 1), &tiny, ISO);
    assert_eq!((inside.triangles.len(), inside.statistics.bricks), (0, 0));
}

/// What registers of N reals find out about a brick: the rows that reach it, its samples, and its vertices.
fn brick<const N: usize>() -> (Vec<u32>, Samples, Vertices) {
    let rows: Vec<Row> = blobs(200, 6).iter().map(Row::new).collect();
    let (low, high) = ([-0.3; 3], [0.3; 3]);
    let mut reached = Candidates::default();
    let from = &Candidates::all(&rows);
    let bounds = run_plain::<N, _>(Cull { from, to: &mut reached, low, high });
    assert!(bounds.lower < ISO && bounds.upper > ISO);
    let rows: Vec<Row> = reached.indices.iter().map(|&index| rows[index as usize]).collect();
    let axis = std::array::from_fn(|n| -0.3 + 0.075 * n as f32);
    let mut samples = Samples::new();
    run_plain::<N, _>(Sample { rows: &rows, axes: [axis; 3], iso: ISO, samples: &mut samples });
    let mut starts = Starts::new();
    for n in 0..37 {
        let corner = [n % 8, n / 8 % 8, n / 64].map(|at| axis[at]);
        starts.push(corner.map(|x| x + 0.03), corner, corner.map(|x| x + 0.075));
    }
    let mut vertices = Vertices::default();
    run_plain::<N, _>(Finish { rows: &rows, iso: ISO, starts: &mut starts, vertices: &mut vertices });
    (reached.indices, samples, vertices)
}

#[test]
fn registers_of_any_width_make_one_mesh() {
    let ((rows, samples, vertices), (wide_rows, wide_samples, wide_vertices)) = (brick::<8>(), brick::<16>());
    assert!(rows.len() > 20, "many blobs reach the brick");
    assert_eq!(rows, wide_rows);
    assert!(samples.is_crossed());
    for layer in 0..CORNERS {
        assert_eq!(
            samples.values[layer][..CORNERS * CORNERS],
            wide_samples.values[layer][..CORNERS * CORNERS]
        );
    }
    assert_eq!(vertices.len(), 37);
    assert_eq!((vertices.positions, vertices.normals), (wide_vertices.positions, wide_vertices.normals));
    assert_eq!(vertices.colors, wide_vertices.colors);
}
