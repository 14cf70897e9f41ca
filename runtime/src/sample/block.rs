//! Samples of a block of lattice points.

/// The answers at the points of a block of a lattice.
#[derive(Clone, PartialEq, Debug)]
pub struct Block {
    indices: [[u32; 2]; 3],
    planes: Vec<Vec<f32>>,
}

impl Block {
    /// A block of these points, with as many answers in each plane, or one for all.
    pub(super) fn new(indices: [[u32; 2]; 3], planes: Vec<Vec<f32>>) -> Self {
        Self { indices, planes }
    }

    /// The lattice indices of its first point.
    #[must_use]
    pub fn first(&self) -> [usize; 3] {
        self.indices.map(|[first, _]| first as usize)
    }

    /// Its points along x, y and z.
    #[must_use]
    pub fn points(&self) -> [usize; 3] {
        self.indices.map(|[first, end]| (end - first) as usize)
    }

    /// The answers, plane by plane in the order of the evaluator's layout: x fastest, then y, then z; or a
    /// single number in each plane, if all points of the block have the same answers.
    #[must_use]
    pub fn planes(&self) -> &[Vec<f32>] {
        &self.planes
    }

    /// Whether all of its points have the same answers, of which one is kept.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.planes[0].len() == 1
    }

    /// The answer in a plane at the point that is so far from the first one.
    #[must_use]
    pub fn get(&self, plane: usize, [x, y, z]: [usize; 3]) -> f32 {
        let [nx, ny, nz] = self.points();
        assert!(x < nx && y < ny && z < nz, "the point is in the block");
        let plane = &self.planes[plane];
        if plane.len() == 1 { plane[0] } else { plane[(z * ny + y) * nx + x] }
    }

    /// How far its points are from the first one, x fastest.
    pub(super) fn places(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [x, y, z] = self.points();
        (0..z).flat_map(move |z| (0..y).flat_map(move |y| (0..x).map(move |x| [x, y, z])))
    }

    /// The lattice indices of the point that is so far from the first one.
    pub(super) fn index(&self, at: [usize; 3]) -> [u32; 3] {
        [0, 1, 2].map(|axis| self.indices[axis][0] + at[axis] as u32)
    }

    /// Copies its answers to where they stand in the planes of a whole lattice.
    pub(super) fn copy_to(&self, lattice: [usize; 3], dense: &mut [Vec<f32>]) {
        let ([x, y, z], [nx, ny, nz]) = (self.first(), self.points());
        for (plane, dense) in self.planes.iter().zip(dense) {
            for k in 0..nz {
                for j in 0..ny {
                    let row = &mut dense[((z + k) * lattice[1] + y + j) * lattice[0] + x..][..nx];
                    if self.is_constant() {
                        row.fill(plane[0]);
                    } else {
                        row.copy_from_slice(&plane[(k * ny + j) * nx..][..nx]);
                    }
                }
            }
        }
    }
}
