//! Meshes of fewer triangles, by meshoptimizer (Kapoulkine 2016-2026): edges are collapsed while the
//! quadratic error is small (Garland and Heckbert 1997).
//!
//! Vertices of the result are vertices of the mesh, with their normals and attributes, so nothing is
//! interpolated. Collapses keep what is closed closed. Borders of colours and creases count as errors, so
//! they are what stays longest.

use meshopt::{SimplifyOptions, VertexDataAdapter, simplify_with_attributes_and_locks};

use super::indexed::{Attribute, Creases, Mesh};

/// When to stop.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Simplify {
    /// At this part of the triangles, from 0 to 1; or before, where no collapse is left.
    Ratio(f64),
    /// Before the surface moves by more than this, in units of the model. An estimate by the quadratic error,
    /// which counts borders of colours too.
    Tolerance(f64),
}

/// The most channels of attributes whose borders count.
const CHANNELS: usize = 16;
/// How much a difference of 1 in a channel counts, as a part of the mesh's extent.
const WEIGHT: f32 = 0.02;

impl Mesh {
    /// The mesh with fewer triangles.
    ///
    /// ```
    /// use jbt::mesh::Simplify;
    /// let tree = jbt::Model::new(jbt::build::point([0, 0, 0], 1)).check()?;
    /// let made = jbt::Polygonize::default().mesh(&jbt::Compiler::new(), &tree).run()?;
    /// let small = made.mesh.simplified(Simplify::Ratio(0.1));
    /// assert!(small.triangles.len() <= made.mesh.triangles.len() / 9);
    /// assert!(jbt::mesh::is_closed(small.positions.len(), &small.triangles));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn simplified(&self, until: Simplify) -> Self {
        let split = self.split();
        let indices = split.triangles.as_flattened();
        let (target, error) = match until {
            Simplify::Ratio(ratio) => {
                ((ratio.clamp(0.0, 1.0) * self.triangles.len() as f64).ceil() as usize * 3, f32::MAX)
            }
            Simplify::Tolerance(tolerance) => (0, tolerance.max(0.0) as f32),
        };
        let bytes: Vec<u8> =
            split.positions.as_flattened().iter().flat_map(|real| real.to_le_bytes()).collect();
        let Ok(vertices) = VertexDataAdapter::new(&bytes, 12, 0) else { return self.clone() };
        let (values, width) = channels(&split);
        let options = SimplifyOptions::ErrorAbsolute;
        let found = if width == 0 || indices.is_empty() {
            meshopt::simplify(indices, &vertices, target, error, options, None)
        } else {
            let locks = vec![false; split.positions.len()];
            let weights = vec![WEIGHT; width];
            simplify_with_attributes_and_locks(
                indices,
                &vertices,
                &values,
                &weights,
                4 * width,
                &locks,
                target,
                error,
                options,
                None,
            )
        };
        self.chosen(&found)
    }

    /// The mesh of these triangles of [`split`](Self::split) vertices.
    fn chosen(&self, indices: &[u32]) -> Self {
        let (count, creases) = (self.positions.len(), &self.creases);
        let (mut names, mut sides) = (vec![None; count], vec![None; creases.vertices.len()]);
        let (mut vertices, mut shown) = (Vec::new(), Vec::new());
        let mut made = Self {
            origin: self.origin,
            orientation: self.orientation,
            attributes: self
                .attributes
                .iter()
                .map(|Attribute { name, width, .. }| Attribute {
                    name: name.clone(),
                    width: *width,
                    values: Vec::new(),
                })
                .collect(),
            ..Self::default()
        };
        for triangle in indices.as_chunks::<3>().0 {
            let mut corners = [0; 3];
            for (n, &index) in triangle.iter().enumerate() {
                let side = (index as usize).checked_sub(count);
                let vertex = side.map_or(index, |side| creases.vertices[side]);
                corners[n] = *names[vertex as usize].get_or_insert_with(|| {
                    vertices.push(vertex as usize);
                    vertices.len() as u32 - 1
                });
                if let Some(side) = side {
                    let corner = 3 * made.triangles.len() as u32 + n as u32;
                    let name = *sides[side].get_or_insert_with(|| {
                        shown.push(side);
                        shown.len() as u32 - 1
                    });
                    made.creases.corners.push([corner, name]);
                }
            }
            made.triangles.push(corners);
        }
        made.positions = vertices.iter().map(|&vertex| self.positions[vertex]).collect();
        made.normals = vertices.iter().map(|&vertex| self.normals[vertex]).collect();
        for (to, from) in made.attributes.iter_mut().zip(&self.attributes) {
            vertices.iter().for_each(|&vertex| to.values.extend_from_slice(from.at(vertex)));
        }
        let names = |side: &usize| names[creases.vertices[*side] as usize].unwrap_or(0);
        made.creases = Creases {
            vertices: shown.iter().map(names).collect(),
            normals: shown.iter().map(|&side| creases.normals[side]).collect(),
            attributes: if shown.is_empty() { Vec::new() } else { self.sides_of(&shown) },
            corners: made.creases.corners,
        };
        made
    }

    /// The values of the attributes at some sides.
    fn sides_of(&self, sides: &[usize]) -> Vec<Vec<f32>> {
        let both = self.attributes.iter().zip(&self.creases.attributes);
        both.map(|(Attribute { width, .. }, values)| {
            sides.iter().flat_map(|&side| values[side * width..][..*width].iter().copied()).collect()
        })
        .collect()
    }
}

/// Channels of attributes, side by side for each vertex, each in units of its range; and how many they are.
fn channels(mesh: &Mesh) -> (Vec<f32>, usize) {
    let mut planes: Vec<Vec<f32>> = Vec::new();
    for Attribute { width, values, .. } in &mesh.attributes {
        for channel in 0..*width {
            let of =
                || values.iter().skip(channel).step_by(*width).copied().filter(|value| value.is_finite());
            let (low, high) = (of().fold(f32::MAX, f32::min), of().fold(f32::MIN, f32::max));
            if high > low && planes.len() < CHANNELS {
                let scaled = |&value: &f32| {
                    let scaled = (value - low) / (high - low);
                    if scaled.is_finite() { scaled } else { 0.0 }
                };
                planes.push(values.iter().skip(channel).step_by(*width).map(scaled).collect());
            }
        }
    }
    let width = planes.len();
    let all = (0..mesh.positions.len()).flat_map(|vertex| planes.iter().map(move |plane| plane[vertex]));
    (all.collect(), width)
}
