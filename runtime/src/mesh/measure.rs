//! Measures of a mesh: its bounds, its area and its volume.

use crate::boxes::Box3;
use crate::parallel::*;

use super::area::area_vector;
use super::indexed::Mesh;

/// Triangles or vertices that a thread takes at a time. Sums over triangles are sums of these parts' sums,
/// for any number of threads.
const PART: usize = 1 << 14;

impl Mesh {
    /// The smallest box that holds all positions, relative to the mesh's origin, in units of the model.
    /// `None` without positions.
    #[must_use]
    pub fn bounds(&self) -> Option<Box3> {
        let both = |a: Box3, b: Box3| Box3 {
            low: [0, 1, 2].map(|axis| a.low[axis].min(b.low[axis])),
            high: [0, 1, 2].map(|axis| a.high[axis].max(b.high[axis])),
        };
        let point = |&position: &[f32; 3]| Box3::new(position, position);
        let part = |part: &[[f32; 3]]| part.iter().map(point).reduce(both);
        let parts: Vec<Option<Box3>> = scatter(|_| self.positions.par_chunks(PART).map(part).collect());
        parts.into_iter().flatten().reduce(both)
    }

    /// The area of all triangles together, in squared units of the model: half the lengths of the cross
    /// products of their edges, in f64.
    #[must_use]
    pub fn area(&self) -> f64 {
        let twice = |&triangle: &[u32; 3]| {
            let vector = area_vector(self.corners(triangle));
            vector.iter().map(|c| c * c).sum::<f64>().sqrt()
        };
        0.5 * self.sum(twice)
    }

    /// The volume that the mesh encloses, in cubed units of the model: by the divergence theorem, the sum of
    /// the signed tetrahedra between each triangle and the middle of the bounds, in f64. It is negative for a
    /// mesh that is inside out.
    ///
    /// Only a closed mesh encloses a volume: for other meshes this number depends on their position and means
    /// nothing.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let bounds = self.bounds().unwrap_or_default();
        // Far from the origin, tetrahedra to the origin would be so large that the volume's digits were lost.
        let middle: [f64; 3] =
            std::array::from_fn(|axis| 0.5 * (f64::from(bounds.low[axis]) + f64::from(bounds.high[axis])));
        let six = |&triangle: &[u32; 3]| {
            let corners = self.corners(triangle);
            let (vector, [corner, ..]) = (area_vector(corners), corners);
            (0..3).map(|axis| vector[axis] * (f64::from(corner[axis]) - middle[axis])).sum::<f64>()
        };
        self.sum(six) / 6.0
    }

    /// The sum of a number of each triangle.
    fn sum(&self, number: impl Fn(&[u32; 3]) -> f64 + Sync) -> f64 {
        let part = |part: &[[u32; 3]]| part.iter().map(&number).sum::<f64>();
        let parts: Vec<f64> = scatter(|_| self.triangles.par_chunks(PART).map(part).collect());
        parts.into_iter().sum()
    }

    fn corners(&self, [a, b, c]: [u32; 3]) -> [[f32; 3]; 3] {
        let corner = |vertex: u32| self.positions[vertex as usize];
        [corner(a), corner(b), corner(c)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block with sides 2, 3 and 5 around a place, turned outwards.
    fn block(place: [f32; 3]) -> Mesh {
        let corner = |index: usize| {
            let side = |axis: usize, half: f32| if index >> axis & 1 == 1 { half } else { -half };
            [place[0] + side(0, 1.0), place[1] + side(1, 1.5), place[2] + side(2, 2.5)]
        };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() }
    }

    #[test]
    fn a_block_has_the_size_of_a_block() {
        // Far away too, where the tetrahedra to the origin would be 10^15 times as large as the block.
        for place in [[0.0; 3], [7.0, -3.0, 11.0], [131_072.0, -524_288.0, 65_536.0]] {
            let mut mesh = block(place);
            assert_eq!((mesh.volume(), mesh.area()), (30.0, 62.0));
            let bounds = mesh.bounds().unwrap();
            assert!(bounds.contains(place));
            assert_eq!([0, 1, 2].map(|axis| bounds.high[axis] - bounds.low[axis]), [2.0, 3.0, 5.0]);
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
            assert_eq!((mesh.volume(), mesh.area()), (-30.0, 62.0));
        }
    }

    #[test]
    fn nothing_has_no_size() {
        let empty = Mesh::default();
        assert_eq!((empty.bounds(), empty.volume(), empty.area()), (None, 0.0, 0.0));
        let mut point = block([1.0; 3]);
        point.positions = vec![[1.0, 2.0, 3.0]];
        point.triangles = vec![[0, 0, 0]];
        assert_eq!(point.bounds(), Some(Box3::new([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])));
        assert_eq!((point.volume(), point.area()), (0.0, 0.0));
    }
}
