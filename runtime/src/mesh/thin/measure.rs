//! The thickness of parts at some points, and so the cells that would show them.

use crate::boxes::Box3;
use crate::mesh::error::MeshError;
use crate::mesh::field::Field;

/// Distances along a ray: the first is a cell, each is a little shorter than the one before, the last is a
/// 64th.
const RUNGS: usize = 13;
/// Both ways along x, y, z and the gradient.
const RAYS: usize = 8;

/// Half of the smallest thickness at some points, or of an upper bound of it; `None` without points.
pub(super) fn cell<F: Field>(
    field: &F,
    axes: &[Vec<f32>; 3],
    iso: f32,
    points: &[[f32; 3]],
) -> Result<Option<f64>, MeshError<F::Error>> {
    let mut thinnest: Option<f32> = None;
    for &point in points {
        let thickness = thickness(field, axes, iso, point)?;
        thinnest = Some(thinnest.map_or(thickness, |thinnest| thinnest.min(thickness)));
    }
    Ok(thinnest.map(|thickness| rounded(0.5 * f64::from(thickness))))
}

/// The shortest chord of a part through a point in it.
fn thickness<F: Field>(
    field: &F,
    axes: &[Vec<f32>; 3],
    iso: f32,
    point: [f32; 3],
) -> Result<f32, MeshError<F::Error>> {
    let cell = axes[0][1] - axes[0][0];
    let ends = |axis: usize| (axes[axis][0], axes[axis][axes[axis].len() - 1]);
    let held = |axis: usize, coordinate: f32| coordinate.clamp(ends(axis).0, ends(axis).1);
    let bounds = Box3 {
        low: [0, 1, 2].map(|axis| held(axis, point[axis] - cell)),
        high: [0, 1, 2].map(|axis| held(axis, point[axis] + cell)),
    };
    let region = field.region(bounds).map_err(MeshError::Field)?;
    let (mut value, mut gradient) = ([0.0], [[0.0]; 3]);
    let [x, y, z] = point.map(|coordinate| [coordinate]);
    let planes = gradient.each_mut().map(|plane| &mut plane[..]);
    field.gradient(&region, &x, &y, &z, &mut value, planes).map_err(MeshError::Field)?;
    let inside = value[0] >= iso;
    let directions = directions(gradient.map(|[component]| component));
    let mut places = [const { Vec::new() }; 3];
    for rung in 0..RUNGS {
        let distance = cell * 0.5_f32.powf(rung as f32 / 2.0);
        for direction in directions {
            for axis in 0..3 {
                places[axis].push(held(axis, point[axis] + distance * direction[axis]));
            }
        }
    }
    let mut values = vec![0.0; RUNGS * RAYS];
    field.field(&region, &places[0], &places[1], &places[2], &mut values).map_err(MeshError::Field)?;
    // The longest distance before the first one outside of the part; half of the shortest distance, if that
    // is outside.
    let free = |ray: usize| {
        let stays = |rung: &usize| (values[rung * RAYS + ray] >= iso) == inside;
        let reached = (0..RUNGS).rev().take_while(stays).last();
        cell * 0.5_f32.powf(reached.map_or(RUNGS as f32 / 2.0, |rung| rung as f32 / 2.0))
    };
    let through = (0..RAYS / 2).map(|ray| free(2 * ray) + free(2 * ray + 1));
    Ok(through.fold(2.0 * cell, f32::min))
}

/// Both ways along the axes and the gradient.
fn directions(gradient: [f32; 3]) -> [[f32; 3]; RAYS] {
    let length = gradient.iter().map(|component| component * component).sum::<f32>().sqrt();
    let along =
        if length.is_finite() && length > 0.0 { gradient.map(|c| c / length) } else { [1.0, 0.0, 0.0] };
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], along];
    std::array::from_fn(|ray| axes[ray / 2].map(|c| if ray % 2 == 0 { c } else { -c }))
}

/// A positive number, rounded down to two digits.
fn rounded(number: f64) -> f64 {
    let scale = 10_f64.powi(1 - number.log10().floor() as i32);
    (number * scale).floor() / scale
}
