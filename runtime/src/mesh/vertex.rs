//! Vertices: where they start, how they are pulled onto the surface, and what they carry.

use jbt_ir::limits::MAX_ATTRIBUTE_WIDTH;
use rayon::prelude::*;

use super::cell::{EDGE_CORNERS, sheets};
use super::crossing::{Cell, Crossings, Layer};
use super::progress::{Phase, Progress};
use super::sample::Grid;
use super::settle::{Place, Stray, settle};
use super::surface::unit;
use super::{Attribute, Field, Mesh, MeshError, Options};

/// Vertices that are evaluated in one call.
const BATCH: usize = 1024;

/// A vertex before it is pulled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    position: [f32; 3],
    /// The cell that it stays in.
    cell: [u32; 3],
    /// The cell's corners that its sheet separates: those outside and those inside, a bit for each corner.
    corners: [u8; 2],
}

/// One vertex for each sheet of each crossing cell, at the mean of the sheet's crossings.
pub(crate) fn start(grid: &Grid, crossings: &Crossings) -> Vec<Vertex> {
    let of_layer = |(z, layer): (usize, &Layer)| {
        let mut vertices = Vec::with_capacity(layer.vertices);
        for y in 0..layer.rows() {
            for cell in layer.row(y) {
                start_cell(grid, cell, [cell.x as usize, y, z], &mut vertices);
            }
        }
        vertices
    };
    crossings.layers.par_iter().enumerate().map(of_layer).collect::<Vec<_>>().concat()
}

fn start_cell(grid: &Grid, cell: &Cell, place: [usize; 3], vertices: &mut Vec<Vertex>) {
    let sheets = sheets(cell.signs, cell.flips);
    let corners = grid.corners(place);
    let coordinate =
        |axis: usize, corner: usize| f64::from(grid.axes[axis][place[axis] + (corner >> axis & 1)]);
    let mut sums = [([0.0_f64; 3], 0_u32, [0_u8; 2]); 4];
    for (edge, &[low, high]) in EDGE_CORNERS.iter().enumerate() {
        let Some(sheet) = sheets.of_edge(edge) else { continue };
        let t = crossing(grid.iso, corners[low], corners[high]);
        let (sum, count, sides) = &mut sums[sheet as usize];
        for corner in [low, high] {
            sides[usize::from(cell.signs >> corner & 1)] |= 1 << corner;
        }
        for (axis, sum) in sum.iter_mut().enumerate() {
            let (from, to) = (coordinate(axis, low), coordinate(axis, high));
            *sum += from + t * (to - from);
        }
        *count += 1;
    }
    for (sum, count, corners) in sums.into_iter().take(sheets.count() as usize) {
        let mean = sum.map(|sum| (sum / f64::from(count)) as f32);
        let cell = place.map(|index| index as u32);
        // The mean is in the cell, and rounding to f32, which the sides of the cell are in, does not take it out.
        vertices.push(Vertex { position: mean, cell, corners });
    }
}

/// Where along an edge the surface crosses, from 0 to 1, if the field is linear there; the middle if a corner has no number.
fn crossing(iso: f32, low: f32, high: f32) -> f64 {
    let (iso, low, high) = (f64::from(iso), f64::from(low), f64::from(high));
    let t = (iso - low) / (high - low);
    if (0.0..=1.0).contains(&t) && low.is_finite() && high.is_finite() { t } else { 0.5 }
}

/// The low and the high corner of a cell.
fn bounds(axes: &[Vec<f32>; 3], cell: [u32; 3]) -> [[f32; 3]; 2] {
    [0, 1].map(|side| [0, 1, 2].map(|axis| axes[axis][cell[axis] as usize + side]))
}

/// A run of vertices and where their answers go.
struct Batch<'a> {
    vertices: &'a [Vertex],
    positions: &'a mut [[f32; 3]],
    normals: &'a mut [[f32; 3]],
    /// For each attribute, its values at these vertices.
    attributes: Vec<&'a mut [f32]>,
}

/// Pulls the vertices onto the surface and evaluates everything at them, once; also says at how many points the gradient was asked. A vertex at which the gradient vanishes or
/// is no number has the normal zero.
pub(crate) fn finish<F: Field>(
    field: &F,
    axes: &[Vec<f32>; 3],
    options: &Options,
    vertices: Vec<Vertex>,
    progress: &Progress<'_>,
) -> Result<(Mesh, u64), MeshError<F::Error>> {
    let count = vertices.len();
    let attributes = field.attributes();
    if let Some((name, width)) =
        attributes.iter().find(|(_, width)| !(1..=MAX_ATTRIBUTE_WIDTH).contains(width))
    {
        return Err(MeshError::Width { name: name.clone(), width: *width });
    }
    let widths: Vec<usize> = attributes.iter().map(|(_, width)| *width).collect();
    let attribute =
        |(name, width): (String, usize)| Attribute { name, width, values: vec![0.0; width * count] };
    let mut mesh = Mesh {
        positions: vec![[0.0; 3]; count],
        normals: vec![[0.0; 3]; count],
        attributes: attributes.into_iter().map(attribute).collect(),
        triangles: Vec::new(),
    };
    let mut batches: Vec<Batch<'_>> = vertices
        .chunks(BATCH)
        .zip(mesh.positions.chunks_mut(BATCH).zip(mesh.normals.chunks_mut(BATCH)))
        .map(|(vertices, (positions, normals))| Batch {
            vertices,
            positions,
            normals,
            attributes: Vec::new(),
        })
        .collect();
    for attribute in &mut mesh.attributes {
        for (batch, values) in batches.iter_mut().zip(attribute.values.chunks_mut(BATCH * attribute.width)) {
            batch.attributes.push(values);
        }
    }
    let total = batches.len();
    progress.begin(Phase::Vertices)?;
    let finish = |batch| {
        let evaluations = finish_batch(field, axes, options, &widths, batch).map_err(MeshError::Field)?;
        progress.advance(Phase::Vertices, total)?;
        Ok(evaluations)
    };
    let evaluations = batches.into_par_iter().map(finish).try_reduce(|| 0, |a, b| Ok(a + b))?;
    Ok((mesh, evaluations))
}

fn finish_batch<F: Field>(
    field: &F,
    axes: &[Vec<f32>; 3],
    options: &Options,
    widths: &[usize],
    batch: Batch<'_>,
) -> Result<u64, F::Error> {
    let Batch { vertices, positions, normals, attributes } = batch;
    let plane = || vec![0.0_f32; vertices.len()];
    let mut point = [0, 1, 2].map(|axis| vertices.iter().map(|v| v.position[axis]).collect::<Vec<f32>>());
    let mut values = plane();
    let mut gradient = [plane(), plane(), plane()];
    for _ in 0..options.pulls {
        let [x, y, z] = &point;
        field.gradient(x, y, z, &mut values, gradient.each_mut().map(Vec::as_mut_slice))?;
        for (i, vertex) in vertices.iter().enumerate() {
            let position = point.each_ref().map(|plane| plane[i]);
            let slope = gradient.each_ref().map(|plane| plane[i]);
            let pulled = pull(options.iso, position, values[i], slope, bounds(axes, vertex.cell));
            for (plane, coordinate) in point.iter_mut().zip(pulled) {
                plane[i] = coordinate;
            }
        }
    }

    let mut evaluations = (options.pulls * vertices.len()) as u64;
    if options.pulls > 0 {
        let [x, y, z] = &point;
        field.gradient(x, y, z, &mut values, gradient.each_mut().map(Vec::as_mut_slice))?;
        evaluations += vertices.len() as u64;
        let stray = |i: usize| {
            let place = Place { bounds: bounds(axes, vertices[i].cell), corners: vertices[i].corners };
            let position = point.each_ref().map(|plane| plane[i]);
            let slope = gradient.each_ref().map(|plane| plane[i]);
            Stray::new(options.iso, i, place, position, values[i], slope)
        };
        let mut strays: Vec<Stray> = (0..vertices.len()).filter_map(stray).collect();
        evaluations += settle(field, options.iso, &mut strays)?;
        for stray in &strays {
            for (plane, coordinate) in point.iter_mut().zip(stray.best()) {
                plane[stray.index] = coordinate;
            }
        }
    }

    let mut planes: Vec<Vec<f32>> = widths.iter().flat_map(|&width| (0..width).map(|_| plane())).collect();
    let mut borrowed: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    let [x, y, z] = &point;
    field.all(x, y, z, &mut values, gradient.each_mut().map(Vec::as_mut_slice), &mut borrowed)?;
    for (i, (position, normal)) in positions.iter_mut().zip(normals).enumerate() {
        *position = point.each_ref().map(|plane| plane[i]);
        *normal = unit(gradient.each_ref().map(|plane| -f64::from(plane[i]))).unwrap_or([0.0; 3]);
    }
    let mut next = planes.iter();
    for (target, &width) in attributes.into_iter().zip(widths) {
        for (component, plane) in next.by_ref().take(width).enumerate() {
            for (value, &source) in target.iter_mut().skip(component).step_by(width).zip(plane) {
                *value = source;
            }
        }
    }
    Ok(evaluations)
}

/// Newton's step along the gradient, within a box.
///
/// A step that would leave the box goes as far as its sides and spends what is left along them, so that a surface which
/// leaves the box beside the vertex is still met. Where the gradient vanishes or is no number, the position stays.
pub(super) fn pull(
    iso: f32,
    position: [f32; 3],
    field: f32,
    gradient: [f32; 3],
    [low, high]: [[f32; 3]; 2],
) -> [f32; 3] {
    if gradient.iter().any(|g| !g.is_finite()) {
        return position;
    }
    let mut point = position;
    // By how much the field, were it linear, has still to rise.
    let mut rest = iso - field;
    // Every round but the last stops one more axis at a side.
    for _ in 0..3 {
        let along = [0, 1, 2].map(|axis| {
            let slope = gradient[axis];
            let limit = if rest * slope > 0.0 { high[axis] } else { low[axis] };
            if point[axis] == limit { 0.0 } else { slope }
        });
        let step = rest / (along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
        if !step.is_finite() {
            break;
        }
        let aim = [0, 1, 2].map(|axis| point[axis] + step * along[axis]);
        let next = [0, 1, 2].map(|axis| aim[axis].clamp(low[axis], high[axis]));
        rest -= (0..3).map(|axis| along[axis] * (next[axis] - point[axis])).sum::<f32>();
        point = next;
        if next == aim {
            break;
        }
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: [[f32; 3]; 2] = [[-10.0; 3], [10.0; 3]];

    #[test]
    fn a_pull_solves_a_linear_field_at_once() {
        // f = 2 x - y + 1 is 0.5 on the plane that this ends on.
        let [x, y, z] = pull(0.5, [1.0, 1.0, 7.0], 2.0, [2.0, -1.0, 0.0], BOX);
        assert!((2.0 * x - y + 0.5).abs() < 1e-6);
        assert_eq!(z, 7.0);
    }

    #[test]
    fn a_pull_goes_on_along_the_sides_of_its_box() {
        // The plain step towards x + 2 y + 4 z = 6 would end at z = 8 / 7.
        let unit = [[0.0; 3], [1.0; 3]];
        let [x, y, z] = pull(6.0, [0.0; 3], 0.0, [1.0, 2.0, 4.0], unit);
        assert_eq!(z, 1.0);
        assert!((x + 2.0 * y + 4.0 * z - 6.0).abs() < 1e-6);
        // Out of reach: the nearest corner.
        assert_eq!(pull(9.0, [0.0; 3], 0.0, [1.0, 2.0, 4.0], unit), [1.0; 3]);
        assert_eq!(pull(-9.0, [0.5; 3], 0.0, [1.0, 2.0, -4.0], unit), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn a_pull_goes_nowhere_without_a_gradient() {
        let pull = |field, gradient| pull(0.5, [0.25; 3], field, gradient, BOX);
        assert_eq!(pull(0.4, [0.0; 3]), [0.25; 3]);
        assert_eq!(pull(0.5, [0.0; 3]), [0.25; 3]);
        assert_eq!(pull(0.4, [1e-30, 0.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(0.4, [f32::NAN, 1.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(0.4, [f32::INFINITY, 1.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(0.4, [f32::MAX, 1.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(f32::NAN, [1.0, 0.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(f32::INFINITY, [1.0, 0.0, 0.0]), [0.25; 3]);
    }

    #[test]
    fn a_crossing_is_on_its_edge() {
        assert_eq!(crossing(0.5, 0.0, 1.0), 0.5);
        assert_eq!(crossing(0.5, 1.0, 0.0), 0.5);
        assert_eq!(crossing(0.25, 0.0, 1.0), 0.25);
        assert_eq!(crossing(0.5, 0.5, 0.0), 0.0);
        assert_eq!(crossing(0.5, f32::NAN, 0.9), 0.5);
        assert_eq!(crossing(0.5, f32::NEG_INFINITY, 0.9), 0.5);
        assert_eq!(crossing(0.5, f32::MIN, f32::MAX), 0.5);
    }
}
