//! Skeletons in f32, for one point at a time: the squared distance, and the way from the nearest point of the
//! skeleton.
//!
//! The gradient of a squared distance is twice the way from the nearest point, whatever the skeleton.

use glam::{DVec3, Vec3};
use jbt::internals::model::skeleton;

/// The straight line between two points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    from: Vec3,
    /// A unit vector; zero if the ends are equal.
    along: Vec3,
    length: f32,
}

/// A circle or a disc or a cylinder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    middle: Vec3,
    /// A unit vector.
    axis: Vec3,
    radius: f32,
}

/// A filled triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    sides: [Segment; 3],
    /// Unit vectors in the plane, away from the inside; zero for a triangle without area.
    outwards: [Vec3; 3],
    normal: Vec3,
}

/// A skeleton of any kind. Big ones are boxed, so that a leaf fits into a cache line.
#[derive(Clone, Debug)]
pub(super) enum Skeleton {
    Point(Vec3),
    Segment(Segment),
    Disc(Round),
    Ring(Round),
    Cylinder {
        round: Round,
        half: f32,
    },
    Box {
        middle: Vec3,
        half: Vec3,
    },
    Triangle(Box<Triangle>),
    /// A kind that no case has: by its plain formula in f64.
    Plain(Box<skeleton::Skeleton>),
}

/// To both sides, where the way is found by differences.
const STEP: f64 = 1e-5;

impl Skeleton {
    /// The skeleton, with what is derived from its parameters computed in f64.
    pub(super) fn new(skeleton: &skeleton::Skeleton) -> Self {
        match skeleton {
            skeleton::Skeleton::Point(point) => Self::Point(point.at.as_vec3()),
            skeleton::Skeleton::Segment(segment) => Self::Segment(Segment::new(segment.from, segment.to)),
            skeleton::Skeleton::Disc(disc) => Self::Disc(Round::new(disc.center, disc.normal, disc.radius)),
            skeleton::Skeleton::Ring(ring) => Self::Ring(Round::new(ring.center, ring.normal, ring.radius)),
            skeleton::Skeleton::Cylinder(cylinder) => {
                let along = cylinder.to - cylinder.from;
                let half = (0.5 * along.length()) as f32;
                let along = if along == DVec3::ZERO { DVec3::Z } else { along };
                let round = Round::new(cylinder.from.midpoint(cylinder.to), along, cylinder.radius);
                Self::Cylinder { round, half }
            }
            skeleton::Skeleton::Cuboid(cuboid) => {
                Self::Box { middle: cuboid.center.as_vec3(), half: cuboid.half.as_vec3() }
            }
            skeleton::Skeleton::Triangle(triangle) => Self::Triangle(Box::new(Triangle::new(triangle))),
            skeleton::Skeleton::Sphere(_)
            | skeleton::Skeleton::Torus(_)
            | skeleton::Skeleton::Cone(_)
            | skeleton::Skeleton::RoundCone(_)
            | skeleton::Skeleton::Rectangle(_)
            | skeleton::Skeleton::Arc(_)
            | skeleton::Skeleton::Helix(_)
            | skeleton::Skeleton::HalfSpace(_)
            | skeleton::Skeleton::Ellipsoid(_)
            | skeleton::Skeleton::LMetric(_)
            | skeleton::Skeleton::Polyline(_)
            | skeleton::Skeleton::Polygon(_)
            | skeleton::Skeleton::Bezier(_)
            | skeleton::Skeleton::CatmullRom(_)
            | skeleton::Skeleton::Superquadric(_) => Self::Plain(Box::new(skeleton.clone())),
        }
    }

    /// The squared distance from `p`.
    #[inline(always)]
    pub(super) fn distance_squared(&self, p: Vec3) -> f32 {
        match self {
            Self::Point(at) => (p - at).length_squared(),
            Self::Segment(segment) => segment.way(p).length_squared(),
            Self::Disc(_)
            | Self::Ring(_)
            | Self::Cylinder { .. }
            | Self::Box { .. }
            | Self::Triangle(_)
            | Self::Plain(_) => self.larger_distance_squared(p),
        }
    }

    // Apart, so that the loop over the commonest leaves stays small.
    #[inline(never)]
    fn larger_distance_squared(&self, p: Vec3) -> f32 {
        match self {
            Self::Disc(round) => {
                let (h, rho, _) = round.cylindrical(p);
                h * h + (rho - round.radius).max(0.0).powi(2)
            }
            Self::Ring(round) => {
                let (h, rho, _) = round.cylindrical(p);
                h * h + (rho - round.radius).powi(2)
            }
            Self::Cylinder { round, half } => {
                let (h, rho, _) = round.cylindrical(p);
                (h.abs() - half).max(0.0).powi(2) + (rho - round.radius).max(0.0).powi(2)
            }
            Self::Plain(skeleton) => skeleton.distance_squared(p.as_dvec3()) as f32,
            Self::Point(_) | Self::Segment(_) | Self::Box { .. } | Self::Triangle(_) => {
                self.way(p).length_squared()
            }
        }
    }

    /// The way from the nearest point of the skeleton to `p`.
    #[inline(always)]
    pub(super) fn way(&self, p: Vec3) -> Vec3 {
        match self {
            Self::Point(at) => p - at,
            Self::Segment(segment) => segment.way(p),
            Self::Disc(_)
            | Self::Ring(_)
            | Self::Cylinder { .. }
            | Self::Box { .. }
            | Self::Triangle(_)
            | Self::Plain(_) => self.larger_way(p),
        }
    }

    #[inline(never)]
    fn larger_way(&self, p: Vec3) -> Vec3 {
        match self {
            Self::Point(_) | Self::Segment(_) => self.way(p),
            Self::Disc(round) => {
                let (h, rho, off) = round.cylindrical(p);
                h * round.axis + part((rho - round.radius).max(0.0), rho) * off
            }
            Self::Ring(round) => {
                let (h, rho, off) = round.cylindrical(p);
                h * round.axis + part(rho - round.radius, rho) * off
            }
            Self::Cylinder { round, half } => {
                let (h, rho, off) = round.cylindrical(p);
                let past = h - h.clamp(-half, *half);
                past * round.axis + part((rho - round.radius).max(0.0), rho) * off
            }
            Self::Box { middle, half } => {
                let v = p - middle;
                v - v.clamp(-half, *half)
            }
            Self::Triangle(triangle) => triangle.way(p),
            Self::Plain(skeleton) => {
                let at = |v: DVec3| skeleton.distance_squared(p.as_dvec3() + v);
                let slope = |axis: DVec3| (at(STEP * axis) - at(-STEP * axis)) / (4.0 * STEP);
                DVec3::from_array(DVec3::AXES.map(slope)).as_vec3()
            }
        }
    }
}

impl Segment {
    fn new(from: DVec3, to: DVec3) -> Self {
        let along = to - from;
        Self {
            from: from.as_vec3(),
            along: along.normalize_or_zero().as_vec3(),
            length: along.length() as f32,
        }
    }

    #[inline]
    fn way(&self, p: Vec3) -> Vec3 {
        let v = p - self.from;
        v - v.dot(self.along).clamp(0.0, self.length) * self.along
    }
}

impl Round {
    fn new(middle: DVec3, axis: DVec3, radius: f64) -> Self {
        let axis = axis.normalize_or_zero().as_vec3();
        Self { middle: middle.as_vec3(), axis, radius: radius as f32 }
    }

    /// The height along the axis, the distance from it, and the way from it.
    #[inline]
    fn cylindrical(&self, p: Vec3) -> (f32, f32, Vec3) {
        let v = p - self.middle;
        let h = v.dot(self.axis);
        let off = v - h * self.axis;
        (h, off.length(), off)
    }
}

impl Triangle {
    fn new(triangle: &skeleton::Triangle) -> Self {
        let (a, b, c) = (triangle.a, triangle.b, triangle.c);
        let ends = [(a, b), (b, c), (c, a)];
        let normal = (b - a).cross(c - a);
        let longest = ends.iter().map(|(from, to)| from.distance_squared(*to)).fold(0.0, f64::max);
        // A triangle flatter than rounding has no inside; its sides are all there is of it.
        let normal = if normal.length() <= 1e-12 * longest { DVec3::ZERO } else { normal.normalize() };
        Self {
            sides: ends.map(|(from, to)| Segment::new(from, to)),
            outwards: ends.map(|(from, to)| (to - from).cross(normal).normalize_or_zero().as_vec3()),
            normal: normal.as_vec3(),
        }
    }

    fn way(&self, p: Vec3) -> Vec3 {
        let inside =
            self.sides.iter().zip(self.outwards).all(|(side, outwards)| (p - side.from).dot(outwards) < 0.0);
        if inside {
            return (p - self.sides[0].from).dot(self.normal) * self.normal;
        }
        let nearer = |a: Vec3, b: Vec3| if b.length_squared() < a.length_squared() { b } else { a };
        nearer(nearer(self.sides[0].way(p), self.sides[1].way(p)), self.sides[2].way(p))
    }
}

/// `a / whole`, and 0 on the axis, where there is no way off it.
#[inline]
fn part(a: f32, whole: f32) -> f32 {
    if whole > 0.0 { a / whole } else { 0.0 }
}
