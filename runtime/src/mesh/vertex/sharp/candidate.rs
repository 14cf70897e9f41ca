//! A vertex that may be on an edge, with its crossings by their sides.

use super::super::super::area::unit;
use super::super::super::brick::Bricks;
use super::super::sheet::{Sheet, Start};
use super::super::side::SharpSide;
use super::crossing::{Crossing, SHARP, dot};
use super::probe::DecidedPoint;
use super::quadric::{self, EdgeAim};
use crate::boxes::Box3;

/// A vertex that may be on an edge.
pub(super) struct Candidate<'a> {
    pub(super) sheet: &'a Sheet,
    pub(super) crossings: Vec<Crossing>,
    pub(super) mean: [f64; 3],
    /// For each crossing, its side.
    pub(super) sides: Vec<usize>,
    pub(super) count: usize,
    pub(super) position: [f32; 3],
    /// The box in which it is placed.
    pub(super) home: Box3,
    /// Whether the position is beyond the cell.
    pub(super) is_beyond: bool,
    /// Whether the edge is not within its reach.
    pub(super) is_off_edge: bool,
}

impl<'a> Candidate<'a> {
    /// A vertex on an edge; `None` if its crossings have no sharp edge between them.
    pub(super) fn new(sheet: &'a Sheet, crossings: Vec<Crossing>) -> Option<Self> {
        let mut mean = [0.0; 3];
        for crossing in &crossings {
            mean.iter_mut().zip(crossing.place).for_each(|(sum, c)| *sum += f64::from(c));
        }
        let mean = mean.map(|sum| sum / crossings.len() as f64);
        let (sides, count) = grouped(&crossings);
        let is_sharp = (0..crossings.len()).any(|a| {
            (0..a).any(|b| sides[a] != sides[b] && dot(crossings[a].normal, crossings[b].normal) < SHARP)
        });
        // Normals of walls that are found with few numbers in between may be wrong.
        let along: f64 =
            crossings.iter().map(|crossing| dot(crossing.normal, sheet.outward.map(f64::from))).sum();
        let Start { bounds, .. } = sheet.start;
        let position = bounds.low;
        (is_sharp && along > 0.0).then_some(Self {
            sheet,
            crossings,
            mean,
            sides,
            count,
            position,
            home: bounds,
            is_beyond: false,
            is_off_edge: false,
        })
    }

    /// Places it in a box.
    pub(super) fn put(&mut self, position: [f32; 3], home: Box3) {
        (self.position, self.home) = (position, home);
    }

    /// Pulls it onto the surface, as what is at it says, in its home: where it meets a side, along that side.
    pub(super) fn pull(&mut self, iso: f32, at: &DecidedPoint) {
        let Some(normal) = at.normal() else { return };
        let (from, Box3 { low, high }) = (self.position.map(f64::from), self.home);
        let (mut to, mut along, mut height) = (from, normal, at.height(iso));
        // Each turn but the last one meets a side.
        for _ in 0..3 {
            let square = dot(along, along);
            if square == 0.0 {
                break;
            }
            let mut is_met = false;
            for axis in (0..3).filter(|&axis| along[axis] != 0.0) {
                let [low, high] = [low, high].map(|corner| f64::from(corner[axis]));
                let next = from[axis] + height / square * along[axis];
                to[axis] = next.clamp(low, high);
                if to[axis] != next {
                    height -= (to[axis] - from[axis]) * normal[axis];
                    (along[axis], is_met) = (0.0, true);
                    break;
                }
            }
            if !is_met {
                break;
            }
        }
        self.position = clamped(to, self.home);
    }

    /// Where the planes of its crossings meet.
    pub(super) fn aim(&self) -> Option<EdgeAim> {
        quadric::aim(&self.crossings, self.mean)
    }

    /// Where the planes of two sides meet, for all pairs; those with the most crossings first.
    pub(super) fn edges(&self) -> Vec<EdgeAim> {
        let crossings = |side: usize| self.sides.iter().filter(|&&of| of == side).count();
        let mut sides: Vec<usize> = (0..self.count).collect();
        sides.sort_by_key(|&side| usize::MAX - crossings(side));
        let pairs = (1..self.count).flat_map(|b| (0..b).map(move |a| [a, b]));
        let aims = pairs.filter_map(|pair| {
            let chosen = pair.map(|n| sides[n]);
            let both = self.crossings.iter().zip(&self.sides).filter(|(_, side)| chosen.contains(side));
            let both: Vec<Crossing> = both.map(|(crossing, _)| *crossing).collect();
            quadric::aim(&both, self.mean).filter(|aim| matches!(aim, EdgeAim::Line(..)))
        });
        aims.collect()
    }

    /// For each side, the crossing that is nearest to its position.
    pub(super) fn nearest(&self) -> impl Iterator<Item = Crossing> {
        let distance = |crossing: &Crossing| {
            let way =
                std::array::from_fn(|axis| f64::from(crossing.place[axis]) - f64::from(self.position[axis]));
            dot(way, way)
        };
        (0..self.count).filter_map(move |side| {
            let both = self.crossings.iter().zip(&self.sides);
            let mine = both.filter(|(_, of)| **of == side).map(|(one, _)| *one);
            mine.min_by(|a, b| distance(a).total_cmp(&distance(b)))
        })
    }

    /// Whether the field jumps at one of its crossings.
    pub(super) fn is_at_jump(&self) -> bool {
        self.crossings.iter().any(|crossing| crossing.signature.is_none())
    }

    /// A point a little outside of its position and one inside, within the lattice.
    pub(super) fn across(&self, bricks: &Bricks) -> [[f32; 3]; 2] {
        /// How far, in cells.
        const WAY: f32 = 1.0 / 64.0;
        let mut sum = [0.0; 3];
        for side in 0..self.count {
            let of_side = self.crossings.iter().zip(&self.sides).filter(|(_, of)| **of == side);
            let mut normal = [0.0; 3];
            of_side.for_each(|(crossing, _)| {
                normal.iter_mut().zip(crossing.normal).for_each(|(sum, c)| *sum += c);
            });
            let normal = unit(normal).unwrap_or_default();
            sum.iter_mut().zip(normal).for_each(|(sum, c)| *sum += f64::from(c));
        }
        let normal = unit(sum).unwrap_or_default();
        [WAY, -WAY].map(|way| {
            [0, 1, 2].map(|axis| {
                let axes = &bricks.axes[axis];
                let at = self.position[axis] + way * self.sheet.size * normal[axis];
                at.clamp(axes[0], axes[axes.len() - 1])
            })
        })
    }

    /// The sides, with the means of what is at their crossings.
    pub(super) fn sides(&self, channels: usize, attribute: &dyn Fn(usize, usize) -> f32) -> Vec<SharpSide> {
        let side = |side: usize| {
            let mine: Vec<usize> = (0..self.sides.len()).filter(|&n| self.sides[n] == side).collect();
            let (mut edges, mut sum) = (0, [0.0; 3]);
            for &n in &mine {
                edges |= 1 << self.sheet.edges()[n];
                sum.iter_mut().zip(self.crossings[n].normal).for_each(|(sum, c)| *sum += c);
            }
            let normal = unit(sum).unwrap_or_else(|| self.crossings[mine[0]].normal.map(|c| c as f32));
            let mean = |channel: usize| {
                let sum: f64 = mine.iter().map(|&n| f64::from(attribute(channel, n))).sum();
                (sum / mine.len() as f64) as f32
            };
            SharpSide { edges, normal, attributes: (0..channels).map(mean).collect() }
        };
        (0..self.count).map(side).collect()
    }
}

/// The side of each crossing, and the number of sides: crossings of one signature; at jumps, which have none,
/// those with normals near that of the first.
fn grouped(crossings: &[Crossing]) -> (Vec<usize>, usize) {
    let mut first: Vec<usize> = Vec::new();
    let sides = crossings.iter().enumerate().map(|(n, crossing)| {
        let alike = |&of: &usize| {
            let other = &crossings[of];
            match (crossing.signature, other.signature) {
                (Some(a), Some(b)) => a == b,
                (None, None) => dot(crossing.normal, other.normal) >= SHARP,
                (Some(_), None) | (None, Some(_)) => false,
            }
        };
        first.iter().position(alike).unwrap_or_else(|| {
            first.push(n);
            first.len() - 1
        })
    });
    let sides: Vec<usize> = sides.collect();
    (sides, first.len())
}

/// A point within a box.
pub(super) fn clamped(point: [f64; 3], Box3 { low, high }: Box3) -> [f32; 3] {
    [0, 1, 2].map(|axis| (point[axis] as f32).clamp(low[axis], high[axis]))
}
