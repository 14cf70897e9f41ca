//! Pipes: straight pieces, and arcs where they bend, less the same with the inner diameters.
//!
//! ```text
//!      ______________                at a point with the bend radius R and the turn a, an arc about a
//!     |   straight   `-.             centre beside the point replaces what is within R tan(a / 2) of it
//!     |______________  |  arc
//!                    `\|
//!                      | |           a straight piece has flat ends, and radii that change evenly
//! ```
//!
//! Pieces meet at flat ends, where the field of their union would fall to that of the surface. So where a
//! piece goes on without a turn, a ball is there too, which both pieces hold together.

use glam::{DAffine3, DVec3};
use jbt_ir::limits::MAX_SKELETON_POINTS;
use jbt_model::bounds::Bounds;
use jbt_model::builder::{x, y, z};
use jbt_model::skeleton::Point;
use jbt_model::tree::Tree;

use super::cone;
use super::make::{Flaw, LeafStyle, SolidLeaf, formula, frame, grown, length, upright};

/// The smallest turn, in radians, that is one.
const SMALLEST_TURN: f64 = 1e-6;

/// Numbers of a point in the file: position, inner and outer diameter, bend radius.
type PipePoint = [f64; 6];

/// A part of the middle line.
#[derive(Clone, Copy)]
enum PipePiece {
    /// From a place to another, with radii there.
    Straight { from: DVec3, to: DVec3, radii: [f64; 2] },
    /// About a centre, `bend` from it; `towards` the middle of the arc, half an angle to both sides.
    Arc { center: DVec3, normal: DVec3, towards: DVec3, half_angle: f64, bend: f64, radius: f64 },
    /// What fills the place where two pieces go on.
    Joint { at: DVec3, radius: f64 },
}

/// A pipe through points.
pub(super) fn pipe(points: &[PipePoint], style: LeafStyle) -> Result<SolidLeaf, Flaw> {
    if points.len() < 2 || points.len() > MAX_SKELETON_POINTS {
        return Err(format!("it has {} points, and 2 to {MAX_SKELETON_POINTS} are read", points.len()));
    }
    let outer = pieces(points, 4, 0.0);
    let bounds = outer.iter().fold(Bounds::EMPTY, |all, piece| all.hull(piece.bounds()));
    let mut trees = trees(&outer, style)?;
    if trees.is_empty() {
        return Err("it has no thickness".to_owned());
    }
    let mut nodes = 2 * trees.len() + 1;
    let mut tree = union(&mut trees);
    // The hole goes on beyond the ends, so that no skin is left there.
    let widest = points.iter().map(|point| point[4]).fold(0.0, f64::max);
    let mut holes = self::trees(&pieces(points, 3, widest), style)?;
    if !holes.is_empty() {
        nodes += 2 * holes.len() + 2;
        tree = Tree::difference([tree, union(&mut holes)]);
    }
    Ok(SolidLeaf { tree, bounds, nodes, has_radius: true })
}

fn union(trees: &mut Vec<Tree>) -> Tree {
    if trees.len() == 1 { trees.remove(0) } else { Tree::union(std::mem::take(trees)) }
}

/// The pieces with the diameters in this column; both ends are drawn out by a length.
fn pieces(points: &[PipePoint], column: usize, drawn_out: f64) -> Vec<PipePiece> {
    let at = |index: usize| DVec3::from_slice(&points[index][..3]);
    let radius = |index: usize| 0.5 * points[index][column].max(0.0);
    let last = points.len() - 1;
    let mut pieces = Vec::with_capacity(2 * points.len());
    // Where the straight piece begins that is under way, and whether pieces join there without a kink.
    let (mut start, mut joins) = (at(0), false);
    for (index, point) in points.iter().enumerate().skip(1) {
        let bend = if index < last { bend(at(index - 1), at(index), at(index + 1), point[5]) } else { None };
        let cut = bend.as_ref().map_or(DVec3::ZERO, |bend| bend.first);
        let (mut from, mut to) = (start, at(index) + cut);
        let mut radii = [radius(index - 1), radius(index)];
        let ahead = (at(index) - at(index - 1)).normalize_or_zero();
        let length = (to - from).dot(ahead);
        if length > 0.0 && radii != [0.0; 2] {
            let slope = (radii[1] - radii[0]) / length;
            if joins {
                let radius = radii[0] / (1.0 + slope * slope).sqrt();
                pieces.push(PipePiece::Joint { at: from, radius: radius.min(length) });
            }
            if index == 1 {
                let by = drawn(radii[0], -slope, drawn_out);
                from -= ahead * by;
                radii[0] -= slope * by;
            }
            if index == last {
                let by = drawn(radii[1], slope, drawn_out);
                to += ahead * by;
                radii[1] += slope * by;
            }
            pieces.push(PipePiece::Straight { from, to, radii });
        }
        let Some(bend) = bend else {
            joins = index < last && is_straight(at(index - 1), at(index), at(index + 1));
            start = at(index);
            continue;
        };
        let radius = radius(index);
        if radius > 0.0 {
            let arc_length = bend.radius * bend.half_angle;
            pieces.push(PipePiece::Arc {
                center: bend.center,
                normal: bend.normal,
                towards: bend.towards,
                half_angle: bend.half_angle,
                bend: bend.radius,
                radius,
            });
            if length > 0.0 {
                pieces.push(PipePiece::Joint { at: to, radius: radius.min(arc_length).min(length) });
            }
        }
        start = at(index) + bend.second;
        joins = true;
    }
    narrowed(pieces)
}

/// How far an end can be drawn out on which the radius changes: to its tip.
fn drawn(radius: f64, slope: f64, by: f64) -> f64 {
    if slope < 0.0 { by.min(radius / -slope) } else { by }
}

/// Joints within both of their neighbours: within a length of each, and within a cone that narrows.
fn narrowed(mut pieces: Vec<PipePiece>) -> Vec<PipePiece> {
    for at in 1..pieces.len().saturating_sub(1) {
        let sides = [pieces[at - 1], pieces[at + 1]];
        if let PipePiece::Joint { radius, .. } = &mut pieces[at] {
            for side in sides {
                *radius = radius.min(side.holds());
            }
        }
    }
    pieces
}

/// An arc in place of a kink.
struct PipeBend {
    /// Where it begins and ends, from the point.
    first: DVec3,
    second: DVec3,
    center: DVec3,
    normal: DVec3,
    towards: DVec3,
    half_angle: f64,
    radius: f64,
}

/// The turn at a point, and the directions to its neighbours.
fn turn(before: DVec3, at: DVec3, after: DVec3) -> (f64, DVec3, DVec3) {
    let (back, ahead) = ((before - at).normalize_or_zero(), (after - at).normalize_or_zero());
    // The angle by its sine and its cosine: exact for small ones too.
    (back.cross(ahead).length().atan2(-back.dot(ahead)), back, ahead)
}

fn is_straight(before: DVec3, at: DVec3, after: DVec3) -> bool {
    turn(before, at, after).0 <= SMALLEST_TURN
}

/// The bend at a point; none where the line goes straight on, turns back, or has a bend radius of 0.
fn bend(before: DVec3, at: DVec3, after: DVec3, radius: f64) -> Option<PipeBend> {
    let (angle, back, ahead) = turn(before, at, after);
    let half_angle = 0.5 * angle;
    if angle <= SMALLEST_TURN || std::f64::consts::PI - angle <= SMALLEST_TURN || radius <= 0.0 {
        return None;
    }
    let cut = radius * half_angle.tan();
    let inwards = (back + ahead).normalize_or_zero();
    let center = at + inwards * (radius / half_angle.cos());
    let normal = back.cross(ahead).normalize_or_zero();
    let (first, second) = (back * cut, ahead * cut);
    Some(PipeBend { first, second, center, normal, towards: -inwards, half_angle, radius })
}

impl PipePiece {
    /// The largest radius of a ball about an end that it holds half of.
    fn holds(self) -> f64 {
        match self {
            Self::Straight { from, to, radii: [a, b] } => {
                let length = (to - from).length();
                let slope = (b - a) / length;
                a.max(b).min(length) / (1.0 + slope * slope).sqrt()
            }
            // The far end of the arc cuts off what is beyond it.
            Self::Arc { half_angle, bend, radius, .. } => {
                radius.min((bend - radius).max(0.0) * (2.0 * half_angle).min(1.5).sin())
            }
            Self::Joint { .. } => f64::INFINITY,
        }
    }

    fn bounds(self) -> Bounds {
        let ring = |at: DVec3, normal: DVec3, radius: f64| {
            let half = normal.map(|n| (1.0 - n * n).max(0.0).sqrt() * radius);
            Bounds::new(at - half, at + half)
        };
        match self {
            Self::Straight { from, to, radii } => {
                let along = (to - from).normalize_or_zero();
                ring(from, along, radii[0]).hull(ring(to, along, radii[1]))
            }
            Self::Arc { center, normal, towards, half_angle, bend, radius } => {
                let ball = |at: DVec3| Bounds::new(at - radius, at + radius);
                let across = normal.cross(towards);
                let on = |angle: f64| center + bend * (towards * angle.cos() + across * angle.sin());
                let mut all = ball(on(-half_angle)).hull(ball(on(half_angle)));
                // Where the circle goes farthest along an axis, if that is on the arc.
                for axis in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                    let angle = axis.dot(across).atan2(axis.dot(towards));
                    if angle.abs() < half_angle {
                        all = all.hull(ball(on(angle)));
                    }
                }
                all
            }
            Self::Joint { .. } => Bounds::EMPTY,
        }
    }

    fn tree(self, style: LeafStyle) -> Result<Option<Tree>, Flaw> {
        Ok(Some(match self {
            Self::Straight { from, to, radii: [a, b] } => {
                let along = to - from;
                let [first, second, _] = upright(along.normalize_or_zero());
                cone::cone(from, along, [[first * a, second * a], [first * b, second * b]], style)?.tree
            }
            Self::Joint { radius, .. } if radius <= 0.0 => return Ok(None),
            Self::Joint { at, radius } => grown(Point { at }, radius),
            Self::Arc { center, normal, towards, half_angle, bend, radius } => {
                let frame = frame(center, [towards, normal.cross(towards), normal])?;
                arc(&frame, half_angle, bend, radius)
            }
        }))
    }
}

/// A part of a torus about z, to both sides of the x axis.
fn arc(frame: &DAffine3, half_angle: f64, bend: f64, radius: f64) -> Tree {
    let scale = 0.5 / radius;
    let tube = 1.0 - scale * length(&(length(&x(), &y()) - bend), &z());
    let (sine, cosine) = (half_angle.sin() * scale, half_angle.cos() * scale);
    let wedge = 0.5 - (cosine * y().abs() - sine * x());
    let out = bend + 2.0 * radius;
    // The wedge ends a radius beside its planes.
    let wide = (out * half_angle.sin() + radius).min(out);
    let inner = ((bend - 2.0 * radius).max(0.0) * half_angle.cos() - radius).max(-out);
    let low = if half_angle < std::f64::consts::FRAC_PI_2 { inner } else { -out };
    let within = Bounds::new(DVec3::new(low, -wide, -2.0 * radius), DVec3::new(out, wide, 2.0 * radius));
    formula(tube.min(wedge), within, frame)
}

fn trees(pieces: &[PipePiece], style: LeafStyle) -> Result<Vec<Tree>, Flaw> {
    let mut trees = Vec::with_capacity(pieces.len());
    for piece in pieces {
        trees.extend(piece.tree(style)?);
    }
    Ok(trees)
}
