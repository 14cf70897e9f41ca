//! Primitives: SCALIS points, segments and triangles, and distances.

use glam::DVec3;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::falloff::Falloff;
use jbt_model::kind::Primitive;
use jbt_model::report::clip;
use jbt_model::skeleton::{Point, RoundCone, Segment, Skeleton, Sphere, Triangle};
use jbt_model::term::Term;
use jbt_model::tree::Tree;

use super::json::JsonValue;
use super::reader::TreeReader;
use super::scalis::{self, PEAK, Vertex, dot, from, square};

/// A tree, and the box that the library gives it.
pub(super) struct Placed {
    pub(super) tree: Tree,
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Placed {
    /// A tree in the hull of cubes about places, by their half edges.
    fn around(tree: Tree, cubes: &[(DVec3, f64)]) -> Self {
        let low = cubes.iter().map(|&(at, by)| at - by).reduce(DVec3::min).unwrap_or_default();
        let high = cubes.iter().map(|&(at, by)| at + by).reduce(DVec3::max).unwrap_or_default();
        Self { tree, low, high }
    }
}

/// How a SCALIS primitive fills the space around its skeleton.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ScalisVolume {
    Distance,
    Convolution,
}

/// A formula that is 0 outside of a box.
fn formula(term: Term, cubes: &[(DVec3, f64)]) -> Tree {
    let hull = Placed::around(Tree::expression(0.0), cubes);
    Tree::expression_within(term, hull.low.to_array(), hull.high.to_array())
}

fn leaf(skeleton: impl Into<Skeleton>, radius: f64, strength: f64) -> Tree {
    let skeleton = skeleton.into();
    Tree::new(Primitive { skeleton, falloff: Falloff::Wyvill, radius, strength }, Vec::new())
}

impl TreeReader<'_> {
    fn vertices<const N: usize>(&self, node: JsonValue) -> Result<[Vertex; N], Diagnostic> {
        let list = self.needed(node, "v")?;
        let all = self.json.values(list).take(N + 1).map(|vertex| {
            Ok(Vertex { at: self.point(vertex, "position")?, thickness: self.positive(vertex, "thickness")? })
        });
        let all: Vec<Vertex> = all.collect::<Result<_, Diagnostic>>()?;
        all.try_into().map_err(|_| {
            let count = self.json.values(list).count();
            self.error(list, format!("the node has {count} vertices")).expected(format!("expected {N}"))
        })
    }

    fn volume(&self, node: JsonValue) -> Result<ScalisVolume, Diagnostic> {
        let (word, value) = self.needed_text(node, "volType")?;
        match word {
            "dist" => Ok(ScalisVolume::Distance),
            "convol" => Ok(ScalisVolume::Convolution),
            _ => {
                Err(self.error(value, "the volType is not known").expected("expected \"dist\" or \"convol\""))
            }
        }
    }

    fn density(&mut self, node: JsonValue) -> Result<f64, Diagnostic> {
        let density = self.number_or(node, "density", 1.0)?;
        self.negative |= density < 0.0;
        Ok(density)
    }

    /// The error about a convolution whose thickness changes too fast.
    fn steep(&self, node: JsonValue) -> Diagnostic {
        let error = self.error(node, "the thickness changes by half the length or more");
        error.expected("expected a convolution that changes less, or \"dist\"")
    }

    pub(super) fn scalis_point(&mut self, node: JsonValue) -> Result<Placed, Diagnostic> {
        let [vertex] = self.vertices(node)?;
        self.volume(node)?;
        let density = self.density(node)?;
        let tree = leaf(Point { at: vertex.at }, 2.0 * vertex.thickness, PEAK * density);
        let materials = self.materials::<1>(node)?;
        let tree = self.clothed(tree, &materials, Vec::new);
        Ok(Placed::around(tree, &[(vertex.at, 2.0 * vertex.thickness)]))
    }

    pub(super) fn scalis_segment(&mut self, node: JsonValue) -> Result<Placed, Diagnostic> {
        let vertices: [Vertex; 2] = self.vertices(node)?;
        let [a, b] = vertices;
        let density = self.density(node)?;
        let cubes = vertices.map(|vertex| (vertex.at, 2.0 * vertex.thickness));
        let tree = match self.volume(node)? {
            ScalisVolume::Distance if a.thickness == b.thickness => {
                leaf(Segment { from: a.at, to: b.at }, 2.0 * a.thickness, PEAK * density)
            }
            ScalisVolume::Distance => formula(scalis::kernel(&scalis::segment(vertices).1, density), &cubes),
            ScalisVolume::Convolution => {
                formula(scalis::line(vertices).ok_or_else(|| self.steep(node))?, &cubes)
            }
        };
        // By the foot of the perpendicular, whatever the field takes.
        let parts = || {
            let along = b.at - a.at;
            let length = along.length_squared();
            let part = if length > 0.0 { dot(&from(a.at), along / length) } else { 0.0.into() };
            let part = part.clamp(0.0, 1.0);
            vec![1.0 - &part, part]
        };
        let materials = self.materials::<2>(node)?;
        let tree = self.clothed(tree, &materials, parts);
        Ok(Placed::around(tree, &cubes))
    }

    pub(super) fn scalis_triangle(&mut self, node: JsonValue) -> Result<Placed, Diagnostic> {
        let vertices: [Vertex; 3] = self.vertices(node)?;
        let [a, b, c] = vertices;
        let density = self.density(node)?;
        let cubes = vertices.map(|vertex| (vertex.at, 2.0 * vertex.thickness));
        let longest = (b.at - a.at).length_squared().max((c.at - a.at).length_squared());
        if (b.at - a.at).cross(c.at - a.at).length() <= 1e-9 * longest {
            return Err(self.error(node, "the triangle has no area"));
        }
        let even = a.thickness == b.thickness && b.thickness == c.thickness;
        let tree = match self.volume(node)? {
            ScalisVolume::Distance if even => {
                leaf(Triangle { a: a.at, b: b.at, c: c.at }, 2.0 * a.thickness, PEAK * density)
            }
            ScalisVolume::Distance => formula(scalis::kernel(&scalis::triangle(vertices).1, density), &cubes),
            ScalisVolume::Convolution => {
                formula(scalis::surface(vertices).ok_or_else(|| self.steep(node))?, &cubes)
            }
        };
        let parts = || scalis::triangle(vertices).0.to_vec();
        let materials = self.materials::<3>(node)?;
        let tree = self.clothed(tree, &materials, parts);
        Ok(Placed::around(tree, &cubes))
    }

    /// A distance, and what becomes of it: 1 where it is 0, nothing from the scale on.
    pub(super) fn distance(&mut self, node: JsonValue) -> Result<Placed, Diagnostic> {
        let functor = self.needed(node, "f")?;
        let (kind, value) = self.needed_text(functor, "type")?;
        if kind != "Poly6DistanceFunctor" {
            let message = format!("the functor {} has no numbers in the file", clip(kind));
            return Err(self.error(value, message).expected("expected Poly6DistanceFunctor"));
        }
        let scale = self.positive(functor, "scale")?;
        let mut shape = self.needed(node, "sdfRoot")?;
        if self.needed_text(shape, "type")?.0 == "SDFNode" {
            let children = self.needed(shape, "children")?;
            let mut all = self.json.values(children);
            shape = match (all.next(), all.next()) {
                (Some(one), None) => one,
                _ => return Err(self.error(children, "an SDFNode has one child")),
            };
        }
        let balls = self.balls(shape)?;
        let cubes: Vec<(DVec3, f64)> = balls.iter().map(|&(at, radius)| (at, radius + scale)).collect();
        if balls.iter().all(|&(_, radius)| radius == 0.0) {
            let message = "a point or a segment as a distance has a surface without thickness";
            self.left_out.note(self.json.span(shape), message);
        }
        let tree = match *balls.as_slice() {
            [(center, radius)] if radius >= scale => {
                leaf(Sphere { center, radius: radius - scale }, 2.0 * scale, PEAK)
            }
            [(from, one), (to, other)] if one.min(other) >= scale => leaf(
                RoundCone { from, to, from_radius: one - scale, to_radius: other - scale },
                2.0 * scale,
                PEAK,
            ),
            _ => {
                let part = (distance(&balls) * (0.5 / scale) + 0.5).max(0.0);
                formula((1.0 - part.square()).max(0.0).powf(3.0) * PEAK, &cubes)
            }
        };
        let materials = self.materials::<1>(node)?;
        let tree = self.clothed(tree, &materials, Vec::new);
        Ok(Placed::around(tree, &cubes))
    }

    /// A shape as the hull of one ball or two.
    fn balls(&self, shape: JsonValue) -> Result<Vec<(DVec3, f64)>, Diagnostic> {
        let radius = |name: &str| {
            let value = self.needed(shape, name)?;
            let radius = self.number(value)?;
            if radius < 0.0 {
                return Err(self
                    .error(value, format!("the radius is {radius}"))
                    .expected("expected at least 0"));
            }
            Ok(radius)
        };
        let (kind, value) = self.needed_text(shape, "type")?;
        Ok(match kind {
            "SDFPoint" => vec![(self.point(shape, "p")?, 0.0)],
            "SDFSphere" => vec![(self.point(shape, "p")?, radius("r")?)],
            "SDFSegment" => vec![(self.point(shape, "p1")?, 0.0), (self.point(shape, "p2")?, 0.0)],
            "SDFCapsule" => {
                vec![(self.point(shape, "p1")?, radius("r1")?), (self.point(shape, "p2")?, radius("r2")?)]
            }
            _ => {
                let error = self.error(value, format!("the distance {} is not known", clip(kind)));
                return Err(error.expected("expected SDFPoint, SDFSphere, SDFSegment or SDFCapsule"));
            }
        })
    }
}

/// The distance from the hull of one ball or two, negative within.
fn distance(balls: &[(DVec3, f64)]) -> Term {
    let ball = |(at, radius): (DVec3, f64)| square(&from(at)).sqrt() - radius;
    let &[one, other] = balls else { return ball(balls[0]) };
    let length = one.0.distance(other.0);
    if (one.1 - other.1).abs() >= length {
        return ball(if one.1 > other.1 { one } else { other });
    }
    // The nearest ball of the cone is where the line to its middle is as steep as the cone.
    let unit = (other.0 - one.0) / length;
    let slope = (other.1 - one.1) / length;
    let w = from(one.0);
    let along = dot(&w, unit);
    let aside = (square(&w) - along.square()).max(0.0).sqrt();
    let place = (&along + aside * (slope / (1.0 - slope * slope).sqrt())).clamp(0.0, length);
    let off: [Term; 3] = [0, 1, 2].map(|axis| &w[axis] - &place * unit[axis]);
    square(&off).sqrt() - (one.1 + place * slope)
}
