//! The area of the surface in a box, by its crossings with the lines of a lattice.
//!
//! ```text
//!     |   |             2 x 2 lines along each axis, cut into 4 segments each; anywhere in their quarter of the box.
//!  ---o---o--.          A crossing (o) is on a segment whose ends are on different sides.
//!     |   |   \         Its share of the area is the cross-section of its line times |n_k|:
//!  ---+---+----o--      n is the normal there, k the axis of the line.
//!     |   |    |
//! ```
//!
//! Over a random shift of the lattice, the number of crossings along `k` is the integral of `|n_k|` over the
//! surface by the cross-section of a line. With the weight `|n_k|`, three axes together give the integral of
//! `n . n`, which is the area. The ends of a line are places of the next box, too, with the same bits. So
//! every crossing has one box, also where a flat face lies in the plane between two boxes.
//!
//! Near a convex edge a line may enter and leave within one segment, so edges lose area in proportion to the
//! length `h` of a segment. What segments of twice that length would miss is seen: two neighbours that are
//! both crossed. Counting those twice extrapolates to `h = 0`. What is left is of the order of `h^2` for
//! smooth surfaces, and for edges of the order of `h`: an edge of length `l` with two faces of 90 degrees is
//! off by at most `l h / 4`. Where lines are in a box is scattered, or flat faces and edges along an axis
//! would meet all of them alike.

use super::{Solid, SolidBatch};
use crate::boxes::{Box3, Divisible as _};
use crate::error::EvalError;
use crate::evaluator::Evaluator;
use crate::prune::Region;

/// Lines along an axis, in each of the two directions across it.
const LINES: usize = 2;
/// Segments of a line: an even number.
const SEGMENTS: usize = 4;
/// Their ends.
const PLACES: usize = SEGMENTS + 1;
/// A crossing of a smooth surface is within this part of a segment from where a linear field has it.
const NEAR: f64 = 0.1;
/// Between places as near as that, a smooth field rises by less than this part of what it rises by along the
/// segment.
const NEAR_RISE: f32 = 0.4;
/// Halvings that locate a crossing which is not there.
const HALVINGS: usize = 12;
/// After so many halvings the rise of the field between the ends is noted. The other halvings make it 1/64 of
/// that where the field is steep.
const NOTED: usize = 6;
/// The surface is a wall, a jump of the field, if the rise does not shrink to this part.
const WALL_RISE: f32 = 0.25;
/// What is probed around a crossing with a wall reaches so far, in segments.
const PROBE: f64 = 0.5;

/// What the lines of a box have met.
pub(super) struct Crossed {
    /// The area in the box.
    pub(super) area: f64,
    /// The part of the lines that is inside, in [0, 1], if the box has a wall: no linear field tells it then.
    pub(super) walled_part: Option<f64>,
}

/// Asks the lines of a box; `normals` answers the field and its gradient.
pub(super) fn crossed(
    solid: &Solid,
    normals: &Evaluator,
    bounds: &Box3,
    region: &Region,
) -> Result<Crossed, EvalError> {
    LineLattice { solid, normals, bounds, region }.ask()
}

/// Lines in a box.
struct LineLattice<'a> {
    solid: &'a Solid,
    normals: &'a Evaluator,
    bounds: &'a Box3,
    region: &'a Region,
}

/// A segment that the surface crosses.
struct SolidCrossing {
    axis: usize,
    /// Its ends, which differ along the axis alone: the one inside, the one outside.
    ends: [[f32; 3]; 2],
    /// The field there.
    values: [f32; 2],
    /// Where the surface crosses it, along the axis.
    place: f64,
    is_wall: bool,
    /// How often it counts.
    weight: f64,
    /// The whole segment, before anything was halved: its inner and its outer end along the axis.
    segment: [f64; 2],
}

impl SolidCrossing {
    fn new(axis: usize, ends: [[f32; 3]; 2], values: [f32; 2]) -> Self {
        let segment = ends.map(|end| f64::from(end[axis]));
        Self { axis, ends, values, place: segment[0], is_wall: false, weight: 1.0, segment }
    }

    /// The rise of the field from the outer end to the inner one. Infinite if an end is no number.
    fn rise(&self) -> f32 {
        let rise = self.values[0] - self.values[1];
        if rise.is_nan() { f32::INFINITY } else { rise }
    }

    /// Along its axis: from the inner end, at 0, to the outer one, at 1.
    fn along(&self, part: f64) -> f64 {
        let [inner, outer] = self.ends.map(|end| f64::from(end[self.axis]));
        inner + (outer - inner) * part
    }

    /// The point at a place along its axis.
    fn point(&self, along: f64) -> [f32; 3] {
        let mut point = self.ends[0];
        point[self.axis] = along as f32;
        point
    }

    /// The part of the segment at which a linear field crosses.
    fn linear(&self, iso: f32) -> f64 {
        let part = f64::from(self.values[0] - iso) / f64::from(self.rise());
        if (0.0..=1.0).contains(&part) { part } else { 0.5 }
    }
}

impl LineLattice<'_> {
    fn side(&self, axis: usize) -> f64 {
        f64::from(self.bounds.high[axis]) - f64::from(self.bounds.low[axis])
    }

    /// A coordinate at a part of the box, from 0 to 1. The ends of the box are met exactly.
    fn coordinate(&self, axis: usize, part: f64) -> f32 {
        let (low, high) = (self.bounds.low[axis], self.bounds.high[axis]);
        ((f64::from(low) + self.side(axis) * part) as f32).clamp(low, high)
    }

    /// Where a line is in its part of the cross-section of the box, in [0, 1) along each direction: anywhere,
    /// but always the same for all boxes in a row along the line.
    fn scattered(&self, axis: usize, across: [usize; 2], line: usize) -> [f64; 2] {
        let start = mixed((axis * LINES * LINES + line) as u64);
        let bits = across.map(|other| u64::from((self.bounds.low[other] + 0.0).to_bits()));
        let hash = bits.iter().fold(start, |hash, bits| mixed(hash ^ bits));
        [hash >> 32, hash & 0xffff_ffff].map(|bits| bits as f64 / (1_u64 << 32) as f64)
    }

    fn ask(&self) -> Result<Crossed, EvalError> {
        let (mut crossings, mut inside) = self.crossings()?;
        locate(self.solid, self.region, &mut crossings)?;
        let normals = self.normals_at(&crossings)?;
        let (mut area, mut has_wall) = (0.0, false);
        for (crossing, normal) in crossings.iter().zip(&normals) {
            let axis = crossing.axis;
            let section = self.side((axis + 1) % 3) * self.side((axis + 2) % 3) / (LINES * LINES) as f64;
            area += section * normal[axis].abs() * crossing.weight;
            has_wall |= crossing.is_wall;
            // So far the segment counts as half inside.
            let [inner, outer] = crossing.segment;
            inside += (crossing.place - 0.5 * (inner + outer)) * (outer - inner).signum() / self.side(axis);
        }
        let part = (inside / (3 * LINES * LINES) as f64).clamp(0.0, 1.0);
        Ok(Crossed { area, walled_part: has_wall.then_some(part) })
    }

    /// The crossed segments, and how much of the lines is inside, in sides of the box, where a crossed
    /// segment counts as half.
    fn crossings(&self) -> Result<(Vec<SolidCrossing>, f64), EvalError> {
        let mut batch = SolidBatch::default();
        for axis in 0..3 {
            let across = [(axis + 1) % 3, (axis + 2) % 3];
            for line in 0..LINES * LINES {
                let mut point = [0.0; 3];
                let scattered = self.scattered(axis, across, line);
                for ((other, index), part) in
                    across.into_iter().zip([line % LINES, line / LINES]).zip(scattered)
                {
                    point[other] = self.coordinate(other, (index as f64 + part) / LINES as f64);
                }
                for place in 0..PLACES {
                    point[axis] = self.coordinate(axis, place as f64 / SEGMENTS as f64);
                    batch.push(point);
                }
            }
        }
        let values = batch.values(self.solid, self.region)?.to_vec();
        let is_inside = |index: usize| values[index] >= self.solid.iso;
        let is_crossed = |index: usize| is_inside(index) != is_inside(index + 1);
        let (mut found, mut inside) = (Vec::new(), 0.0);
        for line in 0..3 * LINES * LINES {
            for segment in 0..SEGMENTS {
                let low = line * PLACES + segment;
                let axis = line / (LINES * LINES);
                let length = f64::from(batch.points[axis][low + 1]) - f64::from(batch.points[axis][low]);
                let ends_inside = u8::from(is_inside(low)) + u8::from(is_inside(low + 1));
                inside += 0.5 * f64::from(ends_inside) * length / self.side(axis);
                if is_crossed(low) {
                    let ends = if is_inside(low) { [low, low + 1] } else { [low + 1, low] };
                    let (points, fields) = (ends.map(|n| batch.point(n)), ends.map(|n| values[n]));
                    let mut crossing = SolidCrossing::new(axis, points, fields);
                    // The other half of the segment of twice the length.
                    let other = line * PLACES + (segment ^ 1);
                    crossing.weight = if is_crossed(other) { 2.0 } else { 1.0 };
                    found.push(crossing);
                }
            }
        }
        Ok((found, inside))
    }

    /// The unit normal at each crossing: of the gradient, or of the wall.
    fn normals_at(&self, crossings: &[SolidCrossing]) -> Result<Vec<[f64; 3]>, EvalError> {
        let mut batch = SolidBatch::default();
        crossings.iter().for_each(|crossing| batch.push(crossing.point(crossing.place)));
        let mut planes = [0; 4].map(|_| vec![0.0_f32; crossings.len()]);
        let points = batch.points.each_ref().map(Vec::as_slice);
        self.normals.eval_region(self.region, points, &mut planes.each_mut().map(Vec::as_mut_slice))?;
        let mut around = None;
        let mut normals = Vec::with_capacity(crossings.len());
        for (index, crossing) in crossings.iter().enumerate() {
            let slope = [1, 2, 3].map(|plane| -f64::from(planes[plane][index]));
            let found = if crossing.is_wall { None } else { unit(slope) };
            let found = match found {
                Some(normal) => Some(normal),
                None => self.wall_normal(crossing, &mut around)?.or(unit(slope)),
            };
            normals.push(found.unwrap_or_else(|| unit_along(crossing.axis)));
        }
        Ok(normals)
    }

    /// How far a wall is probed around a crossing.
    fn reach(&self) -> f64 {
        PROBE * (0..3).map(|axis| self.side(axis)).fold(f64::INFINITY, f64::min) / SEGMENTS as f64
    }

    /// The normal of the wall at a crossing, from where the wall is nearby. `around` is the region of all
    /// that is probed, once it is known.
    ///
    /// The sides of the 26 places around the crossing tell the axis that the wall is most across. Four lines
    /// along this axis, beside the crossing, meet the wall at places whose differences are its slopes.
    fn wall_normal(
        &self,
        crossing: &SolidCrossing,
        around: &mut Option<Region>,
    ) -> Result<Option<[f64; 3]>, EvalError> {
        let reach = self.reach();
        if around.is_none() {
            // A cube of one reach around the crossing, and lines of two reaches that end beyond the box.
            let low = self.bounds.low.map(|x| ((f64::from(x) - 3.0 * reach) as f32).next_down());
            let high = self.bounds.high.map(|x| ((f64::from(x) + 3.0 * reach) as f32).next_up());
            *around = Some(self.solid.pruner.region(Box3::new(low, high))?);
        }
        let Some(region) = around else { return Ok(None) };
        let mut at = crossing.ends[0].map(f64::from);
        at[crossing.axis] = crossing.place;
        let Some((axis, sign)) = self.main_axis(region, at, reach)? else { return Ok(None) };
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let mut batch = SolidBatch::default();
        let offsets = across.map(|other| [-1.0, 1.0].map(|offset| (other, offset * reach)));
        for (other, offset) in offsets.into_iter().flatten() {
            for end in [-2.0, 2.0] {
                let mut point = at;
                point[other] += offset;
                point[axis] += sign * end * reach;
                batch.push(point.map(|x| x as f32));
            }
        }
        let values = batch.values(self.solid, region)?.to_vec();
        let inside = |index: usize| values[index] >= self.solid.iso;
        let (mut lines, mut which) = (Vec::new(), Vec::new());
        for line in 0..4 {
            let (inner, outer) = (2 * line, 2 * line + 1);
            if inside(inner) && !inside(outer) {
                let ends = [inner, outer];
                lines.push(SolidCrossing::new(axis, ends.map(|n| batch.point(n)), ends.map(|n| values[n])));
                which.push(line);
            }
        }
        halve(self.solid, region, &mut lines.iter_mut().collect::<Vec<_>>())?;
        let mut normal = [0.0; 3];
        normal[axis] = sign;
        for (n, other) in across.into_iter().enumerate() {
            let rise = |line: usize| {
                let met = which.iter().position(|&found| found == line)?;
                Some(lines[met].place - at[axis])
            };
            let slope = match (rise(2 * n), rise(2 * n + 1)) {
                (Some(below), Some(above)) => (above - below) / (2.0 * reach),
                (Some(below), None) => -below / reach,
                (None, Some(above)) => above / reach,
                (None, None) => 0.0,
            };
            normal[other] = -sign * slope;
        }
        Ok(unit(normal))
    }

    /// The axis that the surface is most across at a place, and the direction along it that leads outside.
    fn main_axis(
        &self,
        region: &Region,
        at: [f64; 3],
        reach: f64,
    ) -> Result<Option<(usize, f64)>, EvalError> {
        let mut batch = SolidBatch::default();
        let offset = |place: usize| [place % 3, place / 3 % 3, place / 9].map(|step| step as f64 - 1.0);
        for place in 0..27 {
            let offset = offset(place);
            batch.push(std::array::from_fn(|axis| (at[axis] + reach * offset[axis]) as f32));
        }
        let mut outward = [0.0; 3];
        for (place, inside) in batch.sides(self.solid, region)?.into_iter().enumerate() {
            for (sum, offset) in outward.iter_mut().zip(offset(place)) {
                *sum += if inside { -offset } else { offset };
            }
        }
        let axis =
            (1..3).fold(0, |best, axis| if outward[axis].abs() > outward[best].abs() { axis } else { best });
        Ok((outward[axis] != 0.0).then(|| (axis, outward[axis].signum())))
    }
}

/// Finds where segments are crossed. Where the surface is not where a linear field has it, or the field
/// jumps, segments are halved.
fn locate(solid: &Solid, region: &Region, crossings: &mut [SolidCrossing]) -> Result<(), EvalError> {
    let mut batch = SolidBatch::default();
    for crossing in &mut *crossings {
        let part = crossing.linear(solid.iso);
        crossing.place = crossing.along(part);
        for part in [part - NEAR, part + NEAR] {
            batch.push(crossing.point(crossing.along(part.clamp(0.0, 1.0))));
        }
    }
    if crossings.is_empty() {
        return Ok(());
    }
    let values = batch.values(solid, region)?;
    let pairs = crossings.iter_mut().zip(values.chunks_exact(2));
    let is_near = |crossing: &SolidCrossing, [inner, outer]: [f32; 2]| {
        inner >= solid.iso && outer < solid.iso && inner - outer < NEAR_RISE * crossing.rise()
    };
    let far = pairs.filter(|(crossing, near)| !is_near(crossing, [near[0], near[1]]));
    halve(solid, region, &mut far.map(|(crossing, _)| crossing).collect::<Vec<_>>())
}

/// Halves segments towards their crossings, and tells walls.
fn halve(solid: &Solid, region: &Region, crossings: &mut [&mut SolidCrossing]) -> Result<(), EvalError> {
    let mut batch = SolidBatch::default();
    let mut noted = Vec::new();
    for halving in 0..if crossings.is_empty() { 0 } else { HALVINGS } {
        if halving == NOTED {
            noted = crossings.iter().map(|crossing| crossing.rise()).collect();
        }
        batch.clear();
        crossings.iter().for_each(|crossing| batch.push(crossing.point(crossing.along(0.5))));
        let values = batch.values(solid, region)?.to_vec();
        for (index, (crossing, value)) in crossings.iter_mut().zip(values).enumerate() {
            // A NaN is outside.
            let end = if value >= solid.iso { 0 } else { 1 };
            crossing.ends[end] = batch.point(index);
            crossing.values[end] = value;
        }
    }
    for (crossing, noted) in crossings.iter_mut().zip(noted) {
        crossing.place = crossing.along(0.5);
        crossing.is_wall = crossing.rise() > WALL_RISE * noted;
    }
    Ok(())
}

/// A vector of length 1; `None` for a vector without a direction.
fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| vector.map(|x| x / length))
}

/// A number whose bits all depend on all bits of another one (Steele, Lea and Flood 2014, "Fast splittable
/// pseudorandom number generators").
fn mixed(number: u64) -> u64 {
    let number = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let number = (number ^ number >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let number = (number ^ number >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    number ^ number >> 31
}

fn unit_along(axis: usize) -> [f64; 3] {
    std::array::from_fn(|other| if other == axis { 1.0 } else { 0.0 })
}
