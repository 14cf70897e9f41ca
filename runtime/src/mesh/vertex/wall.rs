//! Vertices where the field jumps: at the walls of `within`, of predicates, of any field that ends without a
//! slope.
//!
//! ```text
//!                  wall
//!     o------------x--o        x  a crossing: within 2^-13 of its edge, by halving
//!     |      m      \ |        m  the mean of the crossings: on the wall, if that is flat
//!     |        --> n \|        n  the normal of the polygon of crossings
//!     o---------------x        a wall that is curved is followed along n, by half a cell to both sides of m
//! ```
//!
//! The value at a point does not tell the distance to the wall, so closeness to the iso-value is no
//! criterion: a point inside and a point outside bracket the wall. The vertex of a sheet with jumps on some
//! edges and smooth crossings on others bends around an edge of the solid, and is found in the same way.

use super::super::field::Field;
use super::bracket::{Bracket, BracketPoints, CrossedEdge, CrossedEdges};
use super::sheet::{Sheet, Start};
use crate::boxes::Box3;

/// Halvings along the normal.
const HALVINGS: usize = 12;
/// The mean of the crossings counts as on the wall if the wall is within this part of a cell.
const NEAR: f32 = 1.0 / 2048.0;

/// A vertex at a jump.
pub(super) struct Wall {
    /// The index of the vertex in the brick.
    pub(super) vertex: usize,
    /// Its position.
    pub(super) position: [f32; 3],
    /// A point inside next to it, where attributes are evaluated.
    pub(super) inside: [f32; 3],
    /// The unit normal away from the inside, if one is known.
    pub(super) normal: Option<[f32; 3]>,
    bounds: Box3,
    size: f32,
}

impl Wall {
    /// The vertex of a sheet, at the mean of its crossings.
    pub(super) fn new(sheet: &Sheet, crossed: &CrossedEdges) -> Self {
        let mut sum = [0.0; 3];
        for edge in sheet.crossed(crossed) {
            sum.iter_mut().zip(edge.crossing()).for_each(|(sum, c)| *sum += f64::from(c));
        }
        let count = sheet.numbers().len() as f64;
        let Start { vertex, bounds, .. } = sheet.start;
        let position = clamp(sum.map(|sum| (sum / count) as f32), bounds);
        let distance = |p: [f32; 3]| (0..3).map(|axis| (p[axis] - position[axis]).powi(2)).sum::<f32>();
        let inner = sheet.crossed(crossed).filter(|edge| edge.is_jump()).map(CrossedEdge::inside);
        let inside = inner.min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(position);
        let normal = sheet.normal(crossed);
        Self { vertex, position, inside, normal, bounds, size: sheet.size }
    }

    /// The two points `way` cells from its position along its normal, clamped to its bounds: the outer point
    /// first. Without a normal both are its position.
    fn across(&self, way: f32) -> [[f32; 3]; 2] {
        let normal = self.normal.unwrap_or([0.0; 3]);
        let end = |way: f32| {
            clamp([0, 1, 2].map(|axis| self.position[axis] + way * self.size * normal[axis]), self.bounds)
        };
        [end(way), end(-way)]
    }
}

fn clamp(point: [f32; 3], Box3 { low, high }: Box3) -> [f32; 3] {
    [0, 1, 2].map(|axis| point[axis].clamp(low[axis], high[axis]))
}

/// Moves vertices from the means of their crossings onto curved walls. Returns the number of points
/// evaluated.
pub(super) fn follow<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    walls: &mut [Wall],
) -> Result<u64, F::Error> {
    let (mut points, mut asked) = (BracketPoints::default(), 0);
    let holds = |bracket: &Bracket| bracket.values.map(|value| value >= iso) == [false, true];
    let near = across(field, region, &mut points, walls.iter(), NEAR)?;
    asked += 2 * near.len() as u64;
    let mut rest: Vec<&mut Wall> = Vec::new();
    for (wall, near) in walls.iter_mut().zip(near) {
        if holds(&near) {
            wall.inside = near.ends[1];
        } else {
            rest.push(wall);
        }
    }
    let far = across(field, region, &mut points, rest.iter().map(|wall| &**wall), 0.5)?;
    asked += 2 * far.len() as u64;
    let mut far: Vec<(&mut Wall, Bracket)> =
        rest.into_iter().zip(far).filter(|(_, far)| holds(far)).collect();
    let mut brackets: Vec<&mut Bracket> = far.iter_mut().map(|(_, bracket)| bracket).collect();
    asked += points.halve(field, region, iso, &mut brackets, HALVINGS)?;
    for (wall, bracket) in far {
        (wall.position, wall.inside) = (bracket.middle(), bracket.ends[1]);
    }
    Ok(asked)
}

/// The points `way` cells from vertices along their normals, with the field there.
fn across<'a, F: Field>(
    field: &F,
    region: &F::Region,
    points: &mut BracketPoints,
    walls: impl IntoIterator<Item = &'a Wall>,
    way: f32,
) -> Result<Vec<Bracket>, F::Error> {
    let ends: Vec<[[f32; 3]; 2]> = walls.into_iter().map(|wall| wall.across(way)).collect();
    let values = points.ask(field, region, ends.iter().copied().flatten())?;
    let brackets = ends.iter().zip(values.as_chunks().0);
    Ok(brackets.map(|(&ends, &values)| Bracket { ends, values }).collect())
}
