//! An indexed triangle mesh: the result of meshing.

use std::borrow::Cow;

use jbt_model::orientation::{Handed, Orientation};
use jbt_model::origin::ModelOrigin;
use jbt_model::word::normalized;

use crate::points::Points;

/// Named reals at each vertex of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Attribute {
    /// The name, as in the model.
    pub name: String,
    /// Reals per vertex, 1 to [`MAX_ATTRIBUTE_WIDTH`](jbt_ir::limits::MAX_ATTRIBUTE_WIDTH).
    pub width: usize,
    /// `width` reals for each vertex, one vertex after the other.
    pub values: Vec<f32>,
}

/// Corners of triangles at which normals and attributes are not those of the vertex. Each is that of a *side*
/// of a vertex: a smooth part of the surface that ends there.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Creases {
    /// The vertex of each side, ascending.
    pub vertices: Vec<u32>,
    /// The unit normal of each side.
    pub normals: Vec<[f32; 3]>,
    /// For each attribute of the mesh, its values at each side, one side after the other. Empty where there
    /// are no sides.
    pub attributes: Vec<Vec<f32>>,
    /// Which corner shows which side: three times the triangle plus the corner, and the side. Ascending.
    pub corners: Vec<[u32; 2]>,
}

/// An indexed triangle mesh with normals and attributes.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mesh {
    /// The origin of positions, in the world: the model's origin, 0 for most models. A mesh of a field that
    /// is no model has the origin 0.
    pub origin: [f64; 3],
    /// How the model stands whose coordinates these are: files show it the right way up.
    #[cfg_attr(feature = "serde", serde(default))]
    pub orientation: Orientation,
    /// One for each vertex, from the origin.
    pub positions: Vec<[f32; 3]>,
    /// One for each vertex, of length 1, away from the inside.
    pub normals: Vec<[f32; 3]>,
    /// Each has values for every vertex.
    pub attributes: Vec<Attribute>,
    /// Three indices of vertices each, counter-clockwise when seen from outside, in right-handed axes.
    pub triangles: Vec<[u32; 3]>,
    /// Where corners of triangles have other normals and attributes than their vertices: at edges and
    /// corners of the surface. See [`split`](Self::split).
    #[cfg_attr(feature = "serde", serde(default))]
    pub creases: Creases,
    /// The parts of a model that has some, in order: each a closed surface of its own, with its own vertices.
    /// Empty for one solid.
    #[cfg_attr(feature = "serde", serde(default))]
    pub parts: Vec<MeshPart>,
}

/// A part of a mesh: its vertices and triangles follow those of the part before.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshPart {
    /// Its name.
    pub name: String,
    /// How many vertices there are up to its last one.
    pub vertices: usize,
    /// How many triangles there are up to its last one.
    pub triangles: usize,
}

impl Attribute {
    /// The reals of a vertex. Panics if there is no such vertex.
    #[must_use]
    pub fn at(&self, vertex: usize) -> &[f32] {
        &self.values[vertex * self.width..][..self.width]
    }
}

impl Mesh {
    /// The mirror image in right-handed axes of a mesh in left-handed ones; else the same.
    #[must_use]
    pub fn right_handed(&self) -> Cow<'_, Self> {
        if self.orientation.handed == Handed::Right {
            return Cow::Borrowed(self);
        }
        let mirrored =
            |points: &[[f32; 3]]| points.iter().map(|&point| self.orientation.right_handed(point)).collect();
        Cow::Owned(Self {
            origin: self.orientation.right_handed(self.origin),
            orientation: Orientation { handed: Handed::Right, ..self.orientation },
            positions: mirrored(&self.positions),
            normals: mirrored(&self.normals),
            attributes: self.attributes.clone(),
            // A mirror turns every triangle around.
            triangles: self.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
            parts: self.parts.clone(),
            creases: self.mirrored_creases(),
        })
    }

    fn mirrored_creases(&self) -> Creases {
        let mut creases = self.creases.clone();
        creases.normals.iter_mut().for_each(|normal| *normal = self.orientation.right_handed(*normal));
        for [corner, _] in &mut creases.corners {
            *corner = *corner - *corner % 3 + [0, 2, 1][*corner as usize % 3];
        }
        creases.corners.sort_unstable();
        creases
    }

    /// The attribute of this name.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        let name = normalized(name);
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// Linear red, green and blue for each vertex; `None` if the mesh has no attribute `color` of three
    /// reals.
    ///
    /// ```
    /// use jbt::{Compiler, Model, Polygonize, build::point};
    /// let tree = Model::new(point([0, 0, 0], 1).color([1.0, 0.5, 0.0])).check()?;
    /// let mesh = Polygonize::default().mesh(&Compiler::new(), &tree).run()?.mesh;
    /// assert!(mesh.colors().ok_or("no colours")?.iter().all(|&color| color == [1.0, 0.5, 0.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn colors(&self) -> Option<&[[f32; 3]]> {
        let color = self.attribute("color").filter(|color| color.width == 3)?;
        Some(color.values.as_chunks().0)
    }

    /// The positions as points to evaluate.
    #[must_use]
    pub fn points(&self) -> Points {
        let mut points = Points::about(ModelOrigin::new(self.origin));
        self.positions.iter().for_each(|&position| points.push(position));
        points
    }

    /// Whether positions are world coordinates.
    #[must_use]
    pub fn is_about_world(&self) -> bool {
        ModelOrigin::new(self.origin).is_world()
    }

    /// The position of a vertex in the world. Panics if there is no such vertex.
    #[must_use]
    pub fn world(&self, vertex: usize) -> [f64; 3] {
        ModelOrigin::new(self.origin).world(self.positions[vertex].map(f64::from))
    }
}
