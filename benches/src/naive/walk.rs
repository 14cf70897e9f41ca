//! A walk over a compact tree, one point at a time, in f32: a decent BlobTree system of today without JIT and
//! SIMD.
//!
//! ```text
//! for step in steps:   leaf    d^2 of the point, taken to the leaf's space if that is another  ->  answer
//!                      open    push a frame that collects the answers of an operator's children
//!                      close   pop it                                                           ->  answer
//!                      and an answer goes into the topmost frame, at once
//! ```
//!
//! What it takes from the literature (Grasberger, Duprat, Wyvill, Lalonde and Rossignac 2016): a linear tree
//! that is walked bottom-up on a small explicit stack, and maps that were multiplied into the leaves
//! beforehand. Operators take in their children one by one, so the stack is as high as the tree is nested.
//! There is no culling: each leaf is evaluated at each point, but leaves out of reach stop at their distance.

use glam::{DVec3, Mat3, Vec3};
use jbt::{CheckedTree, Falloff, Mixing};

use super::compact::{self, Compact, Leaf, Map, Operator, Step, Twist, Warped};
use super::mixing::{Answer, Frame, Values, root};

/// A tree, ready to be walked.
#[derive(Clone, Debug)]
pub struct Walker {
    compact: Compact,
    iso2: f32,
    /// The defaults of all attribute channels; as long as there are channels.
    defaults: Vec<f32>,
    /// For each channel, whether it follows the dominant leaf.
    dominant: Vec<bool>,
}

impl Walker {
    /// The walker of a tree. Cost: linear in the number of paths to nodes.
    #[must_use]
    pub fn new(tree: &CheckedTree) -> Self {
        let follow = |group: &jbt::AttributeGroup| vec![group.mixing == Mixing::Dominant; group.width()];
        Self {
            compact: Compact::new(tree),
            iso2: (2.0 * tree.iso()) as f32,
            defaults: compact::defaults(tree),
            dominant: tree.attributes().iter().flat_map(follow).collect(),
        }
    }

    /// Number of attribute channels: reals of all groups.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.defaults.len()
    }

    /// Number of leaves that are evaluated at each point: shared ones once for each path.
    #[must_use]
    pub fn leaves(&self) -> usize {
        self.compact.values.len() / self.channels()
    }

    /// The field at points (planes of x, y, z). Panics if the lengths differ.
    pub fn field(&self, points: [&[f32]; 3], out: &mut [f32]) {
        let [x, y, z] = points.map(|plane| &plane[..out.len()]);
        let mut frames = Vec::new();
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.field_at(Vec3::new(x[i], y[i], z[i]), &mut frames);
        }
    }

    /// Field, gradient and attributes in one walk: `outs` are the planes of the field, of the gradient's x, y
    /// and z, and of each attribute channel. Panics if the number of planes or their lengths differ.
    pub fn full(&self, points: [&[f32]; 3], outs: &mut [&mut [f32]]) {
        let (first, channels) = outs.split_at_mut(4);
        self.answers::<true>(points, channels, |i, answer| {
            first[0][i] = answer.field;
            for (plane, value) in first[1..].iter_mut().zip(answer.gradient.to_array()) {
                plane[i] = value;
            }
        });
    }

    /// Attributes alone: one plane for each channel. The fields are computed too, since they weigh the
    /// attributes.
    pub fn attributes(&self, points: [&[f32]; 3], outs: &mut [&mut [f32]]) {
        self.answers::<false>(points, outs, |_, _| {});
    }

    fn answers<const GRADIENT: bool>(
        &self,
        [x, y, z]: [&[f32]; 3],
        channels: &mut [&mut [f32]],
        mut take: impl FnMut(usize, &Answer),
    ) {
        assert_eq!(channels.len(), self.channels(), "one plane for each channel");
        let mut frames = Vec::new();
        let mut values = Values::new(&self.defaults, self.dominant.contains(&true));
        for i in 0..x.len() {
            let answer = self.answer_at::<GRADIENT>(Vec3::new(x[i], y[i], z[i]), &mut frames, &mut values);
            take(i, &answer);
            for (channel, plane) in channels.iter_mut().enumerate() {
                plane[i] = values.root(channel, self.dominant[channel]);
            }
        }
    }

    /// The topmost frame is a local, so that a sum's accumulator stays in a register.
    #[inline]
    fn field_at(&self, mut p: Vec3, frames: &mut Vec<FieldFrame>) -> f32 {
        let mut top = FieldFrame::new(Operator::Sum, p);
        for step in &self.compact.steps {
            match step {
                Step::Leaf(leaf) => top.take(self.leaf_field(leaf, p), self.iso2),
                Step::Open(operator) => {
                    frames.push(std::mem::replace(&mut top, FieldFrame::new(*operator, p)));
                    p = self.entered(operator, p);
                }
                Step::Close => {
                    let (answer, outer) = (top.finish(), frames.pop());
                    p = top.p;
                    top = outer.expect("each close has its open");
                    top.take(answer, self.iso2);
                }
            }
        }
        top.finish()
    }

    /// As [`field_at`](Self::field_at); the frame at the bottom takes the root's answer.
    fn answer_at<'a, const GRADIENT: bool>(
        &'a self,
        mut p: Vec3,
        frames: &mut Vec<Frame>,
        values: &mut Values<'a>,
    ) -> Answer {
        let width = self.channels();
        let mut top = Frame::new(Operator::Union, p);
        for step in &self.compact.steps {
            match step {
                Step::Leaf(leaf) => {
                    let start = leaf.values as usize * width;
                    values.set_leaf(&self.compact.values[start..start + width]);
                    let answer = self.leaf_answer::<GRADIENT>(leaf, p);
                    top.take::<GRADIENT>(&answer, self.iso2, values, frames.len());
                }
                Step::Open(operator) => {
                    frames.push(std::mem::replace(&mut top, Frame::new(*operator, p)));
                    values.open(frames.len());
                    p = self.entered(operator, p);
                }
                Step::Close => {
                    let mut answer = top.finish(values, frames.len());
                    values.set_frame();
                    p = top.p;
                    if GRADIENT {
                        answer.gradient = self.left(&top.operator, p, answer.gradient);
                    }
                    top = frames.pop().expect("each close has its open");
                    top.take::<GRADIENT>(&answer, self.iso2, values, frames.len());
                }
            }
        }
        top.lone()
    }

    #[inline(always)]
    fn leaf_field(&self, leaf: &Leaf, p: Vec3) -> f32 {
        let p = self.mapped(leaf.map, p);
        let u = 1.0 - leaf.skeleton.distance_squared(p) * leaf.inverse_square_radius;
        if u > 0.0 { leaf.strength * falloff(leaf.falloff, u) } else { 0.0 }
    }

    #[inline]
    fn leaf_answer<const GRADIENT: bool>(&self, leaf: &Leaf, p: Vec3) -> Answer {
        if !GRADIENT {
            return Answer { field: self.leaf_field(leaf, p), ..Answer::NOTHING };
        }
        let way = leaf.skeleton.way(self.mapped(leaf.map, p));
        let u = 1.0 - way.length_squared() * leaf.inverse_square_radius;
        if u <= 0.0 {
            return Answer::NOTHING;
        }
        let slope = -2.0 * leaf.strength * leaf.inverse_square_radius * falloff_slope(leaf.falloff, u);
        let gradient = self.unmapped(leaf.map, slope * way);
        Answer { field: leaf.strength * falloff(leaf.falloff, u), gradient, share: 1.0 }
    }

    /// A point in the space of a leaf or a warp.
    #[inline]
    fn mapped(&self, map: Option<u32>, p: Vec3) -> Vec3 {
        let Some(index) = map else { return p };
        let Map { linear, translation } = self.compact.maps[index as usize];
        linear * p + translation
    }

    /// A gradient by the coordinates of a leaf or a warp, by those of the point.
    #[inline]
    fn unmapped(&self, map: Option<u32>, gradient: Vec3) -> Vec3 {
        let Some(index) = map else { return gradient };
        let linear: Mat3 = self.compact.maps[index as usize].linear;
        linear.transpose() * gradient
    }

    /// The point inside of an operator.
    #[inline]
    fn entered(&self, operator: &Operator, p: Vec3) -> Vec3 {
        match operator {
            Operator::Twist(twist) => self.twist(twist, p).at,
            Operator::Warp(warped) => self.warped(warped, self.mapped(warped.map, p).as_dvec3()).as_vec3(),
            Operator::Sum
            | Operator::Powers(_)
            | Operator::Ricci(_)
            | Operator::Union
            | Operator::Intersection
            | Operator::Difference => p,
        }
    }

    /// A gradient inside of an operator, as it is outside.
    #[inline]
    fn left(&self, operator: &Operator, p: Vec3, gradient: Vec3) -> Vec3 {
        match operator {
            Operator::Twist(twist) => self.untwist(twist, p, gradient),
            Operator::Warp(warped) => self.unwarped(warped, p, gradient),
            Operator::Sum
            | Operator::Powers(_)
            | Operator::Ricci(_)
            | Operator::Union
            | Operator::Intersection
            | Operator::Difference => gradient,
        }
    }

    /// Where a warp takes a point of its own space.
    fn warped(&self, warped: &Warped, p: DVec3) -> DVec3 {
        match &self.compact.warps[warped.warp as usize] {
            (warp, None) => warp.inverse(p),
            (warp, Some(weight)) => warp.weighted(p, jbt::walk::walk(weight, p.to_array()).field),
        }
    }

    /// The gradient outside of a warp: its transposed Jacobian, by central differences, applied to that
    /// inside.
    fn unwarped(&self, warped: &Warped, p: Vec3, gradient: Vec3) -> Vec3 {
        let (p, step) = (self.mapped(warped.map, p).as_dvec3(), 1e-6);
        let by_p = DVec3::AXES.map(|axis| {
            let change = self.warped(warped, p + step * axis) - self.warped(warped, p - step * axis);
            change.dot(gradient.as_dvec3()) / (2.0 * step)
        });
        self.unmapped(warped.map, DVec3::from_array(by_p).as_vec3())
    }

    // Apart, because coordinates that are chosen by an index live in memory.
    #[inline(never)]
    fn twist(&self, twist: &Twist, p: Vec3) -> Twisted {
        let p = self.mapped(twist.map, p);
        let [h, u, v] = [0, 1, 2].map(|k| (usize::from(twist.axis) + k) % 3);
        let (sin, cos) = (twist.rate * p[h]).sin_cos();
        let mut at = p;
        at[u] = cos * p[u] + sin * p[v];
        at[v] = cos * p[v] - sin * p[u];
        Twisted { at, sin, cos, order: [h, u, v] }
    }

    /// The gradient by `p`, from that by the twisted `p`: the twist's transposed Jacobian applied to it.
    fn untwist(&self, twist: &Twist, p: Vec3, gradient: Vec3) -> Vec3 {
        let Twisted { at, sin, cos, order: [h, u, v] } = self.twist(twist, p);
        let mut by_p = gradient;
        by_p[u] = cos * gradient[u] - sin * gradient[v];
        by_p[v] = sin * gradient[u] + cos * gradient[v];
        by_p[h] += twist.rate * (at[v] * gradient[u] - at[u] * gradient[v]);
        self.unmapped(twist.map, by_p)
    }
}

/// Where a twist takes a point.
struct Twisted {
    at: Vec3,
    sin: f32,
    cos: f32,
    /// The axis and the two coordinates that turn.
    order: [usize; 3],
}

/// The field of an operator, as far as its children have answered.
struct FieldFrame {
    operator: Operator,
    /// The point outside of the operator.
    p: Vec3,
    /// The field so far; of Ricci's blend, the largest operand so far.
    field: f32,
    /// Of Ricci's blend, the sum of powers relative to the largest operand; of a difference, the number of
    /// children so far.
    sum: f32,
}

impl FieldFrame {
    #[inline]
    fn new(operator: Operator, p: Vec3) -> Self {
        let field = match operator {
            Operator::Sum
            | Operator::Powers(_)
            | Operator::Ricci(_)
            | Operator::Difference
            | Operator::Twist(_)
            | Operator::Warp(_) => 0.0,
            Operator::Union => f32::NEG_INFINITY,
            Operator::Intersection => f32::INFINITY,
        };
        Self { operator, p, field, sum: 0.0 }
    }

    #[inline(always)]
    fn take(&mut self, field: f32, iso2: f32) {
        match self.operator {
            Operator::Sum => self.field += field,
            Operator::Powers(n) => self.power(field, |x| x.powi(n)),
            Operator::Ricci(n) => self.power(field, |x| x.powf(n)),
            Operator::Twist(_) | Operator::Warp(_) => self.field = field,
            Operator::Union => self.field = self.field.max(field),
            Operator::Intersection => self.field = self.field.min(field),
            Operator::Difference => {
                let first = self.sum == 0.0;
                self.field = if first { field } else { self.field.min((iso2 - field).max(0.0)) };
                self.sum += 1.0;
            }
        }
    }

    /// Relative to the largest operand, no power overflows.
    fn power(&mut self, field: f32, power: impl Fn(f32) -> f32) {
        if field > self.field {
            self.sum = self.sum * power(self.field / field) + 1.0;
            self.field = field;
        } else if field > 0.0 {
            self.sum += power(field / self.field);
        }
    }

    #[inline]
    fn finish(&self) -> f32 {
        match self.operator {
            Operator::Powers(n) => self.field * root(self.sum, n),
            Operator::Ricci(n) => self.field * self.sum.powf(1.0 / n),
            Operator::Sum
            | Operator::Union
            | Operator::Intersection
            | Operator::Difference
            | Operator::Twist(_)
            | Operator::Warp(_) => self.field,
        }
    }
}

/// The field at `u = 1 - d^2 / R^2`, for u in (0, 1].
#[inline]
fn falloff(falloff: Falloff, u: f32) -> f32 {
    match falloff {
        Falloff::Soft => u * u * (5.0 / 9.0 + 4.0 / 9.0 * u),
        Falloff::Wyvill => u * u * u,
        Falloff::Quartic
        | Falloff::Metaball
        | Falloff::Hermite
        | Falloff::Quintic
        | Falloff::Linear
        | Falloff::Degree(_)
        | Falloff::Blinn(_)
        | Falloff::ArcTan(_)
        | Falloff::InversePower(_)
        | Falloff::Blanc(_) => falloff.value(1.0 - f64::from(u)) as f32,
    }
}

/// Its derivative by u.
#[inline]
fn falloff_slope(falloff: Falloff, u: f32) -> f32 {
    match falloff {
        Falloff::Soft => u * (10.0 / 9.0 + 12.0 / 9.0 * u),
        Falloff::Wyvill => 3.0 * u * u,
        Falloff::Quartic
        | Falloff::Metaball
        | Falloff::Hermite
        | Falloff::Quintic
        | Falloff::Linear
        | Falloff::Degree(_)
        | Falloff::Blinn(_)
        | Falloff::ArcTan(_)
        | Falloff::InversePower(_)
        | Falloff::Blanc(_) => {
            // No model that is timed has these: central differences, inside of the support.
            let s = 1.0 - f64::from(u);
            let step = 1e-6 * s.min(1.0 - s);
            let rise = falloff.value(s - step) - falloff.value(s + step);
            if step > 0.0 { (rise / (2.0 * step)) as f32 } else { 0.0 }
        }
    }
}
