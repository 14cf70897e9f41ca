//! Connected components of a mesh: surfaces that no triangle connects.
//!
//! Vertices of one triangle are connected.

use super::indexed::Mesh;
use crate::boxes::Box3;
use crate::union_find::root;

/// A connected component of a mesh.
#[derive(Clone, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshComponent {
    /// The first of its triangles.
    pub first: usize,
    /// How many triangles it has.
    pub triangles: usize,
    /// The smallest box around it, relative to the mesh's origin, in units of the model.
    pub bounds: Box3,
    /// The volume that it encloses if it is closed, in cubed units of the model; negative for the wall of a
    /// cavity.
    pub volume: f64,
}

impl Mesh {
    /// The components, in the order of their first triangles.
    ///
    /// ```
    /// use jbt::{Compiler, Model, Polygonize, build::point};
    /// let tree = Model::new(point([0, 0, 0], 1) + point([5, 0, 0], 1)).check()?;
    /// let mesh = Polygonize::default().mesh(&Compiler::new(), &tree).run()?.mesh;
    /// let found = mesh.components();
    /// assert_eq!(found.len(), 2);
    /// assert!(found.iter().all(|one| one.volume > 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn components(&self) -> Vec<MeshComponent> {
        let mut roots: Vec<u32> = (0..self.positions.len() as u32).collect();
        for &[a, b, c] in &self.triangles {
            let a = root(&mut roots, a);
            let b = root(&mut roots, b);
            roots[b as usize] = a;
            let c = root(&mut roots, c);
            roots[c as usize] = a;
        }
        let mut places: Vec<u32> = vec![u32::MAX; self.positions.len()];
        let mut found: Vec<MeshComponent> = Vec::new();
        for (index, triangle) in self.triangles.iter().enumerate() {
            let corners = triangle.map(|vertex| self.positions[vertex as usize]);
            let of = root(&mut roots, triangle[0]) as usize;
            if places[of] == u32::MAX {
                places[of] = found.len() as u32;
                let bounds = Box3::new(corners[0], corners[0]);
                found.push(MeshComponent { first: index, triangles: 0, bounds, volume: 0.0 });
            }
            let component = &mut found[places[of] as usize];
            component.triangles += 1;
            for corner in corners {
                for (axis, x) in corner.into_iter().enumerate() {
                    component.bounds.low[axis] = component.bounds.low[axis].min(x);
                    component.bounds.high[axis] = component.bounds.high[axis].max(x);
                }
            }
            // From a corner of its first triangle: digits are not lost far from the origin.
            let about = self.positions[self.triangles[component.first][0] as usize].map(f64::from);
            component.volume += tetrahedron(corners, about);
        }
        found
    }
}

/// The signed volume between a triangle and a point.
fn tetrahedron(corners: [[f32; 3]; 3], about: [f64; 3]) -> f64 {
    let [a, b, c] = corners
        .map(|corner| -> [f64; 3] { std::array::from_fn(|axis| f64::from(corner[axis]) - about[axis]) });
    let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
    (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
}
