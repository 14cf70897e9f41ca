//! Beams: the space around rays that go about the same way.

use super::boxes::{BoxNode, Corners, EightLanes, NOWHERE, RayPart, SLACK, WIDE, cross, dot, joined};

/// The least mean of unit directions of a bundle.
const STRAIGHT: f32 = 0.9;
/// A bound of the rounding of a plane, as a part of all lengths in it.
const ROUNDING: f32 = 1e-5;

/// The space that some segments go through: what is on the inner side of four planes, and where they begin.
pub struct SegmentBeam {
    /// Normals, outwards, and the largest product of a point of the beam with each.
    planes: [([f32; 3], f32); 4],
    origins: Corners,
}

impl SegmentBeam {
    /// The beam of segments that go about the same way; `None` if they do not.
    ///
    /// Along the mean direction, `across(t) = across(0) + t * slope` for each segment, so the largest of all
    /// at both ends bounds them between.
    #[inline(always)]
    pub fn new(segments: &[RayPart]) -> Option<Self> {
        let mut mean = [0.0_f32; 3];
        for segment in segments {
            mean = [0, 1, 2].map(|axis| mean[axis] + segment.direction[axis]);
        }
        let length = dot(mean, mean).sqrt();
        if length < STRAIGHT * segments.len() as f32 {
            return None;
        }
        let ahead = mean.map(|x| x / length);
        let least =
            (0..3).fold(0, |best, axis| if ahead[axis].abs() < ahead[best].abs() { axis } else { best });
        let mut along = [0.0; 3];
        along[least] = 1.0;
        let right = cross(ahead, along);
        let right = right.map(|x| x / dot(right, right).sqrt());
        let aside = [right, cross(ahead, right)];
        let mut origins = NOWHERE;
        let mut depths = [f32::INFINITY, f32::NEG_INFINITY];
        for segment in segments {
            let depth = dot(segment.origin, ahead);
            origins = joined(origins, &[segment.origin, segment.origin]);
            depths = [depths[0].min(depth), depths[1].max(depth + segment.reach)];
        }
        let mut ends = [[f32::NEG_INFINITY; 4]; 2];
        for segment in segments {
            let (from, speed) = (dot(segment.origin, ahead), 1.0 / dot(segment.direction, ahead));
            for (ends, depth) in ends.iter_mut().zip(depths) {
                let t = (depth - from) * speed;
                for (axis, aside) in aside.iter().enumerate() {
                    let across = dot(segment.origin, *aside) + t * dot(segment.direction, *aside);
                    ends[2 * axis] = ends[2 * axis].max(across);
                    ends[2 * axis + 1] = ends[2 * axis + 1].max(-across);
                }
            }
        }
        let size = (0..3).fold(depths[1] - depths[0], |size: f32, axis| {
            size.max(origins[0][axis].abs()).max(origins[1][axis].abs())
        });
        let planes = std::array::from_fn(|plane| {
            let slope = (ends[1][plane] - ends[0][plane]) / (depths[1] - depths[0]).max(f32::MIN_POSITIVE);
            let sign = if plane % 2 == 0 { 1.0 } else { -1.0 };
            let normal = [0, 1, 2].map(|axis| sign * aside[plane / 2][axis] - slope * ahead[axis]);
            (normal, ends[0][plane] - slope * depths[0] + ROUNDING * (1.0 + slope.abs()) * size)
        });
        Some(Self { planes, origins })
    }

    /// For each box that reaches into the beam a bound of its distance from where the beam begins;
    /// infinity for the others.
    #[inline(always)]
    pub fn enter(&self, node: &BoxNode) -> EightLanes {
        let mut outside = [0_u32; WIDE];
        for ([x, y, z], most) in &self.planes {
            let side =
                |axis: usize, normal: f32| if normal > 0.0 { &node.low[axis] } else { &node.high[axis] };
            let corner = [side(0, *x), side(1, *y), side(2, *z)];
            for i in 0..WIDE {
                outside[i] |= u32::from(corner[0][i] * x + corner[1][i] * y + corner[2][i] * z > *most);
            }
        }
        let mut square = [0.0_f32; WIDE];
        for axis in 0..3 {
            for (i, square) in square.iter_mut().enumerate() {
                let below = node.low[axis][i] - self.origins[1][axis];
                let above = self.origins[0][axis] - node.high[axis][i];
                let gap = if below > above { below } else { above };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                *square += gap * gap;
            }
        }
        let mut distances = [f32::INFINITY; WIDE];
        for i in 0..WIDE {
            distances[i] = if outside[i] == 0 { square[i].sqrt() / SLACK } else { f32::INFINITY };
        }
        distances
    }
}
