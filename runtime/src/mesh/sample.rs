//! The field at every lattice point, once each, in bricks and on all threads.

use rayon::prelude::*;

use super::progress::{Phase, Progress};
use super::{Field, Lattice, MeshError, Options, Sides};

/// The field on a lattice.
pub(crate) struct Grid {
    /// The coordinates of the points along x, y and z.
    pub(crate) axes: [Vec<f32>; 3],
    /// The field at the points, x fastest, then y, then z.
    pub(crate) field: Vec<f32>,
    /// Inside is `field >= iso`.
    pub(crate) iso: f32,
}

impl Grid {
    /// Points along an axis.
    pub(crate) fn points(&self, axis: usize) -> usize {
        self.axes[axis].len()
    }

    /// Cells along x, y and z.
    pub(crate) fn cells(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.points(axis) - 1)
    }

    /// The field along the points (., y, z).
    pub(crate) fn row(&self, y: usize, z: usize) -> &[f32] {
        let length = self.points(0);
        let start = (z * self.points(1) + y) * length;
        &self.field[start..start + length]
    }

    /// The field at the corners of a cell; corner `a + 2 b + 4 c` is `cell + [a, b, c]`.
    pub(crate) fn corners(&self, [x, y, z]: [usize; 3]) -> [f32; 8] {
        let [p, q, r, s] = [self.row(y, z), self.row(y + 1, z), self.row(y, z + 1), self.row(y + 1, z + 1)];
        [p[x], p[x + 1], q[x], q[x + 1], r[x], r[x + 1], s[x], s[x + 1]]
    }

    /// Which corners of a cell are inside, a bit each.
    pub(crate) fn signs(&self, cell: [usize; 3]) -> u8 {
        let corners = self.corners(cell).into_iter().enumerate();
        corners.fold(0, |signs, (corner, field)| signs | u8::from(field >= self.iso) << corner)
    }

    /// The sides of the lattice with a point inside.
    pub(crate) fn cut_sides(&self) -> Sides {
        let [_, ny, nz] = self.cells();
        let mut sides = Sides::default();
        for z in 0..=nz {
            for y in 0..=ny {
                let row = self.row(y, z);
                sides.low[0] |= row[0] >= self.iso;
                sides.high[0] |= row[row.len() - 1] >= self.iso;
                if y == 0 || y == ny || z == 0 || z == nz {
                    let any = row.iter().any(|&field| field >= self.iso);
                    sides.low[1] |= any && y == 0;
                    sides.high[1] |= any && y == ny;
                    sides.low[2] |= any && z == 0;
                    sides.high[2] |= any && z == nz;
                }
            }
        }
        sides
    }
}

/// A row of bricks along x, which is what a thread takes at a time: a range of y, a range of z, and the field there.
struct Beam<'a> {
    y: usize,
    z: usize,
    /// For each z of the beam, the rows of its y.
    slices: Vec<&'a mut [f32]>,
}

/// Evaluates the field at every point of a lattice.
pub(crate) fn sample<F: Field>(
    field: &F,
    lattice: &Lattice,
    options: &Options,
    progress: &Progress<'_>,
) -> Result<Grid, MeshError<F::Error>> {
    let axes = lattice.axes();
    let mut values = allocate(lattice.point_count())?;
    let beams = beams(&mut values, &axes, options.brick);
    let total = beams.len();
    progress.begin(Phase::Lattice)?;
    beams.into_par_iter().try_for_each_init(Scratch::default, |scratch, beam| {
        sample_beam(field, &axes, options.brick, beam, scratch)?;
        progress.advance(Phase::Lattice, total)
    })?;
    Ok(Grid { axes, field: values, iso: options.iso })
}

/// Zeros, or an error where the allocator would have aborted.
fn allocate<E: std::error::Error + 'static>(points: usize) -> Result<Vec<f32>, MeshError<E>> {
    // Zeroed memory comes from the system page by page when the threads first touch it, which is faster than to fill it
    // here; but only `try_reserve` can fail. So the room is asked for first.
    let mut room = Vec::<f32>::new();
    room.try_reserve_exact(points).map_err(|_| MeshError::Memory { points })?;
    drop(room);
    Ok(vec![0.0; points])
}

/// Divides the field among beams.
fn beams<'a>(values: &'a mut [f32], axes: &[Vec<f32>; 3], brick: usize) -> Vec<Beam<'a>> {
    let [nx, ny, nz] = [axes[0].len(), axes[1].len(), axes[2].len()];
    let mut beams: Vec<Beam<'a>> = Vec::with_capacity(ny.div_ceil(brick) * nz.div_ceil(brick));
    for (z, plane) in values.chunks_exact_mut(nx * ny).enumerate() {
        let layer = z / brick * ny.div_ceil(brick);
        for (block, slice) in plane.chunks_mut(nx * brick).enumerate() {
            if z % brick == 0 {
                beams.push(Beam { y: block * brick, z, slices: Vec::with_capacity(brick.min(nz - z)) });
            }
            beams[layer + block].slices.push(slice);
        }
    }
    beams
}

/// The points and the answers of one brick.
#[derive(Default)]
struct Scratch {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    field: Vec<f32>,
}

fn sample_beam<F: Field>(
    field: &F,
    axes: &[Vec<f32>; 3],
    brick: usize,
    beam: Beam<'_>,
    scratch: &mut Scratch,
) -> Result<(), MeshError<F::Error>> {
    let Beam { y, z, mut slices } = beam;
    let nx = axes[0].len();
    let (rows, planes) = (slices[0].len() / nx, slices.len());
    for start in (0..nx).step_by(brick) {
        let xs = &axes[0][start..nx.min(start + brick)];
        let Scratch { x: px, y: py, z: pz, field: values } = &mut *scratch;
        px.clear();
        py.clear();
        pz.clear();
        for &z in &axes[2][z..z + planes] {
            for &y in &axes[1][y..y + rows] {
                px.extend_from_slice(xs);
                py.resize(px.len(), y);
            }
            pz.resize(px.len(), z);
        }
        values.resize(px.len(), 0.0);
        field.field(px, py, pz, values).map_err(MeshError::Field)?;
        let targets = slices.iter_mut().flat_map(|slice| slice.chunks_exact_mut(nx));
        for (target, source) in targets.zip(values.chunks_exact(xs.len())) {
            target[start..start + xs.len()].copy_from_slice(source);
        }
    }
    Ok(())
}
