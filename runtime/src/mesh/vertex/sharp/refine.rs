//! A second aim of vertices on curved edges, with planes close by. Vertices that may not go as far as to
//! their edge are pulled onto the surface.
//!
//! ```text
//!   ---x-._           x  a crossing: its plane touches a curved side a cell away from the edge, so planes of
//!       p-_`. v          crossings meet at v, off the surface
//!          `v'        p  a point of the side close to v: planes through such points meet at v'
//!            |
//! ```

use super::super::super::field::Field;
use super::candidate::{Candidate, clamped};
use super::crossing::{Crossing, dot};
use super::probe::{DecidedPoint, decided};
use super::quadric::{self, EdgeAim};

/// How far the points are from the vertex, in cells: at first as far as the vertex may be off, then close.
const WAYS: [f64; 3] = [1.0 / 2.0, 1.0 / 4.0, 1.0 / 16.0];
/// How far a vertex may go at each look, in cells.
const FARTHEST: f64 = 0.25;
/// Steps of a vertex that does not reach its edge.
const PULLS: usize = 2;

/// Aims again with vertices between sides that do not jump. Returns the number of points at which the
/// gradient was evaluated. `region` holds the homes of the vertices.
pub(super) fn refine<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    candidates: &mut [Candidate<'_>],
) -> Result<u64, F::Error> {
    let mut curved: Vec<Curved<'_, '_>> =
        candidates.iter_mut().filter(|one| !one.is_at_jump()).map(Curved::new).collect();
    let mut asked = 0;
    for way in WAYS {
        let points: Vec<[f32; 3]> = curved.iter().flat_map(|one| one.beside(way)).collect();
        asked += points.len() as u64;
        let mut found = decided(field, region, &points)?.into_iter().zip(points);
        for one in &mut curved {
            one.look(iso, &mut found);
        }
    }
    curved.retain(|one| one.candidate.is_off_edge || one.is_unmet);
    for _ in 0..PULLS {
        let points: Vec<[f32; 3]> = curved.iter().map(|one| one.candidate.position).collect();
        asked += points.len() as u64;
        for (one, at) in curved.iter_mut().zip(decided(field, region, &points)?) {
            one.candidate.pull(iso, &at);
        }
    }
    Ok(asked)
}

/// A vertex between curved sides.
struct Curved<'c, 'a> {
    candidate: &'c mut Candidate<'a>,
    /// For each side, what is known of it closest to the vertex.
    planes: Vec<Crossing>,
    /// Whether a side was not met at the last look, as another one decides there, or their planes do not meet
    /// close by.
    is_unmet: bool,
}

impl<'c, 'a> Curved<'c, 'a> {
    fn new(candidate: &'c mut Candidate<'a>) -> Self {
        let planes = candidate.nearest().collect();
        Self { candidate, planes, is_unmet: false }
    }

    /// For each side a point close to the vertex, on the way to the side's plane, within the cell and the
    /// vertex's home: there the region knows the field.
    fn beside(&self, way: f64) -> impl Iterator<Item = [f32; 3]> {
        let from = self.candidate.position.map(f64::from);
        let Candidate { sheet, home, .. } = &*self.candidate;
        let (size, reach) = (f64::from(sheet.size), sheet.cell.joined(home));
        self.planes.iter().map(move |plane| {
            let along: [f64; 3] = std::array::from_fn(|axis| f64::from(plane.place[axis]) - from[axis]);
            let part = way * size / dot(along, along).sqrt();
            let part = if part < 1.0 { part } else { 1.0 };
            clamped(std::array::from_fn(|axis| from[axis] + part * along[axis]), reach)
        })
    }

    /// Puts the vertex where the planes meet that touch the sides at these points, if that is close.
    fn look(&mut self, iso: f32, found: &mut impl Iterator<Item = (DecidedPoint, [f32; 3])>) {
        self.is_unmet = false;
        for (plane, (at, point)) in self.planes.iter_mut().zip(found) {
            let is_met = Some(at.signature) == plane.signature;
            match at.normal().filter(|_| is_met) {
                Some(normal) => {
                    let on = |axis: usize| (f64::from(point[axis]) + at.height(iso) * normal[axis]) as f32;
                    *plane = Crossing { place: std::array::from_fn(on), normal, ..*plane };
                }
                None => self.is_unmet = true,
            }
        }
        let one = &mut *self.candidate;
        if one.is_off_edge {
            return;
        }
        let from = one.position.map(f64::from);
        let to = quadric::aim(&self.planes, from).map(EdgeAim::point).filter(|to| {
            let way: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
            dot(way, way).sqrt() <= FARTHEST * f64::from(one.sheet.size)
        });
        let Some(to) = to else {
            self.is_unmet = true;
            return;
        };
        one.position = clamped(to, one.home);
        one.is_off_edge = one.position != to.map(|c| c as f32);
    }
}
