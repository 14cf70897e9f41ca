//! Models as text, their meshes, and what is measured on these.

use jbt::mesh::Mesh;
use jbt::text::{Options, parse};
use jbt::{Box3, CheckedTree, Compiler, Fineness, Polygonize, Polygonized};

/// A model without its first line.
pub fn tree(text: &str) -> CheckedTree {
    let text = if text.contains("jbt 1") { text.to_owned() } else { format!("jbt 1\n{text}") };
    let model = parse(text.as_bytes(), &Options::default()).unwrap_or_else(|e| panic!("{e:?} in {text}"));
    model.check().unwrap_or_else(|e| panic!("{e:?} in {text}"))
}

/// The mesh of a model with so many cells along the longest side of its support.
pub fn mesh(text: &str, resolution: usize) -> Polygonized {
    mesh_in(text, None, Fineness::Resolution(resolution))
}

/// The mesh of a model in a region.
pub fn mesh_in(text: &str, region: Option<Box3<f64>>, fineness: Fineness) -> Polygonized {
    let polygonize = Polygonize { region, fineness, verify: true, ..Polygonize::default() };
    polygonize.mesh(&Compiler::new(), &tree(text)).run().unwrap_or_else(|e| panic!("{e} in {text}"))
}

pub fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [[f64; 3]; 3] {
    triangle.map(|vertex| mesh.positions[vertex as usize].map(f64::from))
}

pub fn dot(u: [f64; 3], v: [f64; 3]) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

pub fn length(u: [f64; 3]) -> f64 {
    dot(u, u).sqrt()
}

fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// The vector along the normal of a triangle, as long as twice its area.
pub fn area([p, q, r]: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [q, r].map(|end| [0, 1, 2].map(|axis| end[axis] - p[axis]));
    cross(u, v)
}

/// By the divergence theorem.
pub fn volume(mesh: &Mesh) -> f64 {
    let of = |triangle: &[u32; 3]| {
        let corners = corners(mesh, *triangle);
        dot(corners[0], area(corners)) / 6.0
    };
    mesh.triangles.iter().map(of).sum()
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
