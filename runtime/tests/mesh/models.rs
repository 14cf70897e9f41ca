//! Meshes of models that are written as text.

use jbt::mesh::Mesh;
use jbt::{Box3, Compiler, Fineness, Polygonize, Polygonized};
use jbt_testkit::scene::tree;
use jbt_testkit::surface;

/// The mesh of a model with so many cells along the longest side of its support.
pub fn mesh(text: &str, resolution: usize) -> Polygonized {
    mesh_in(text, None, Fineness::Resolution(resolution))
}

/// The mesh of a model in a region.
pub fn mesh_in(text: &str, region: Option<Box3<f64>>, fineness: Fineness) -> Polygonized {
    let polygonize = Polygonize { region, fineness, verify: true, ..Polygonize::default() };
    polygonize.mesh(&Compiler::new(), &tree(text)).run().unwrap_or_else(|e| panic!("{e} in {text}"))
}

/// The volume in a closed mesh.
pub fn volume(mesh: &Mesh) -> f64 {
    surface::volume(&mesh.positions, &mesh.triangles)
}

/// The low and the high corner of the cell that a point is in.
pub fn cell(made: &Polygonized, point: [f32; 3]) -> [[f64; 3]; 2] {
    let (origin, spacing) = (made.lattice.origin(), made.lattice.spacing());
    let low = [0, 1, 2].map(|axis| {
        let index = ((f64::from(point[axis]) - origin[axis]) / spacing).floor();
        origin[axis] + spacing * index
    });
    [low, low.map(|c| c + spacing)]
}
