//! The place that is nearest to the planes of some crossings.

use jbt_model::eigen::eigen;

use super::crossing::{Crossing, dot};
use crate::boxes::Box3;

/// Eigenvalues below this part of the largest say nothing: of a flat corner, or of a curved side.
const LEAST: f64 = 0.01;

/// What a vertex aims at.
#[derive(Clone, Copy, Debug)]
pub(super) enum EdgeAim {
    /// A corner.
    Point([f64; 3]),
    /// A point of an edge, and the edge's direction.
    Line([f64; 3], [f64; 3]),
}

impl EdgeAim {
    /// The point of a box that is aimed at, if there is any.
    pub(super) fn within(self, Box3 { low, high }: Box3) -> Option<[f64; 3]> {
        let side = |axis: usize| [f64::from(low[axis]), f64::from(high[axis])];
        match self {
            Self::Point(point) => {
                let is_in = |axis: usize| side(axis)[0] <= point[axis] && point[axis] <= side(axis)[1];
                (0..3).all(is_in).then_some(point)
            }
            Self::Line(point, way) => {
                let (mut first, mut last) = (f64::NEG_INFINITY, f64::INFINITY);
                for axis in 0..3 {
                    let ends = side(axis).map(|end| (end - point[axis]) / way[axis]);
                    if way[axis] == 0.0 {
                        if point[axis] < side(axis)[0] || point[axis] > side(axis)[1] {
                            return None;
                        }
                        continue;
                    }
                    first = first.max(ends[0].min(ends[1]));
                    last = last.min(ends[0].max(ends[1]));
                }
                let along = 0.0_f64.max(first).min(last);
                (first <= last).then(|| [0, 1, 2].map(|axis| point[axis] + along * way[axis]))
            }
        }
    }

    /// The nearest point of what is aimed at.
    pub(super) fn point(self) -> [f64; 3] {
        match self {
            Self::Point(point) | Self::Line(point, _) => point,
        }
    }
}

/// Where the planes of the crossings meet: a point, or the line of an edge, nearest to `mean`. `None` if the
/// planes are nearly one.
pub(super) fn aim(crossings: &[Crossing], mean: [f64; 3]) -> Option<EdgeAim> {
    if let &[a, b] = crossings {
        return aim_at_two(a, b, mean);
    }
    let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for crossing in crossings {
        let n = crossing.normal;
        let from: [f64; 3] = std::array::from_fn(|axis| f64::from(crossing.place[axis]) - mean[axis]);
        let height = dot(n, from);
        for row in 0..3 {
            right[row] += n[row] * height;
            for column in 0..3 {
                matrix[row][column] += n[row] * n[column];
            }
        }
    }
    let (values, vectors) = eigen(matrix);
    let largest = values.iter().fold(0.0_f64, |most, &value| most.max(value));
    let counts = values.map(|value| value > LEAST * largest);
    let mut way = [0.0; 3];
    for k in (0..3).filter(|&k| counts[k]) {
        let part = dot(vectors[k], right) / values[k];
        way.iter_mut().zip(vectors[k]).for_each(|(way, c)| *way += part * c);
    }
    let point = [0, 1, 2].map(|axis| mean[axis] + way[axis]);
    match counts.iter().filter(|&&counts| counts).count() {
        3 => Some(EdgeAim::Point(point)),
        2 => Some(EdgeAim::Line(point, vectors[counts.iter().position(|&counts| !counts)?])),
        _ => None,
    }
}

/// The same of two planes, whose matrix has the eigenvalues 1 + c, 1 - c and 0, if c is the product of their
/// unit normals.
fn aim_at_two(a: Crossing, b: Crossing, mean: [f64; 3]) -> Option<EdgeAim> {
    let (n, m) = (a.normal, b.normal);
    let c = dot(n, m);
    if 1.0 - c.abs() <= LEAST * (1.0 + c.abs()) {
        return None;
    }
    let height = |plane: &Crossing| {
        let from = std::array::from_fn(|axis| f64::from(plane.place[axis]) - mean[axis]);
        dot(plane.normal, from)
    };
    let [p, q] = [height(&a), height(&b)];
    let square = 1.0 - c * c;
    let (along_n, along_m) = ((p - c * q) / square, (q - c * p) / square);
    let point = [0, 1, 2].map(|axis| mean[axis] + along_n * n[axis] + along_m * m[axis]);
    let length = square.sqrt();
    let way = [n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2], n[0] * m[1] - n[1] * m[0]];
    Some(EdgeAim::Line(point, way.map(|c| c / length)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crossing(place: [f32; 3], normal: [f64; 3]) -> Crossing {
        Crossing { place, seen: place, normal, signature: Some(0) }
    }

    #[test]
    fn planes_meet_in_points_and_lines() {
        let faces = [
            crossing([0.25, 0.5, 0.0], [0.0, 1.0, 0.0]),
            crossing([0.75, 0.0, 0.25], [1.0, 0.0, 0.0]),
            crossing([0.1, 0.2, 0.625], [0.0, 0.0, 1.0]),
        ];
        let Some(EdgeAim::Point(point)) = aim(&faces, [0.3; 3]) else { panic!("a corner") };
        assert!(point.iter().zip([0.75, 0.5, 0.625]).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-12));
        let Some(EdgeAim::Line(point, way)) = aim(&faces[..2], [0.3; 3]) else { panic!("an edge") };
        assert!(point.iter().zip([0.75, 0.5, 0.3]).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-12));
        assert!((way[2].abs() - 1.0).abs() < 1e-12);
        assert!(aim(&faces[..1], [0.3; 3]).is_none());
    }

    /// Each plane given twice has the line that the two alone have.
    #[test]
    fn two_planes_have_the_line_of_their_matrix() {
        for (bend, is_line) in [(0.9, true), (0.3, true), (0.21, true), (0.19, false), (0.0, false)] {
            let n = [0.48, 0.6, 0.64];
            let across = [0.8, 0.0, -0.6];
            let m = std::array::from_fn(|axis| {
                let bend: f64 = bend;
                (1.0 - bend * bend).sqrt() * n[axis] + bend * across[axis]
            });
            let two = [crossing([0.1, 0.4, 0.3], n), crossing([0.5, 0.2, 0.7], m)];
            let both = [aim(&two, [0.3; 3]), aim(&[two[0], two[1], two[0], two[1]], [0.3; 3])];
            match both {
                [Some(EdgeAim::Line(p, v)), Some(EdgeAim::Line(q, w))] if is_line => {
                    assert!(p.iter().zip(q).all(|(p, q)| (p - q).abs() < 1e-12), "{p:?} {q:?}");
                    assert!(dot(v, w).abs() > 1.0 - 1e-12, "{v:?} {w:?}");
                }
                [None, None] if !is_line => {}
                other => panic!("{bend}: {other:?}"),
            }
        }
    }
}
