//! What an operator collects when field, gradient and attributes come out of one walk.
//!
//! A child weighs `max(0, f_i dF/df_i)`; means and dominant leaves are kept unnormalised while children
//! answer one by one, and normalised when the operator closes. Attributes live in one buffer, a place for
//! each depth of the stack.

use glam::Vec3;

use super::compact::Operator;

/// What is known at a node, but for its attributes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    pub(super) field: f32,
    pub(super) gradient: Vec3,
    /// The share of the dominant leaf in the total weight.
    pub(super) share: f32,
}

impl Answer {
    /// The answer of a leaf that is out of reach.
    pub(super) const NOTHING: Self = Self { field: 0.0, gradient: Vec3::ZERO, share: 1.0 };
}

/// The attributes of frames, a place for each depth of the stack, and of the child that answers: means and,
/// if some group asks for them, those of the dominant leaf.
pub(super) struct Values<'a> {
    defaults: &'a [f32],
    dominance: bool,
    mean: Vec<f32>,
    dominant: Vec<f32>,
    /// The attributes of the leaf that answers; otherwise a frame answers that has just been closed.
    leaf: Option<&'a [f32]>,
}

impl<'a> Values<'a> {
    pub(super) fn new(defaults: &'a [f32], dominance: bool) -> Self {
        let room = || vec![0.0; 2 * defaults.len()];
        Self { defaults, dominance, mean: room(), dominant: room(), leaf: None }
    }

    /// The value of a channel at the root, after a walk.
    pub(super) fn root(&self, channel: usize, dominant: bool) -> f32 {
        if dominant { self.dominant[channel] } else { self.mean[channel] }
    }

    /// Makes room for the frame at `depth` and its children, and clears the frame's sums.
    pub(super) fn open(&mut self, depth: usize) {
        let (start, width) = (depth * self.defaults.len(), self.defaults.len());
        if self.mean.len() < start + 2 * width {
            self.mean.resize(start + 2 * width, 0.0);
            self.dominant.resize(start + 2 * width, 0.0);
        }
        self.mean[start..start + width].fill(0.0);
    }

    /// A leaf answers.
    #[inline]
    pub(super) fn set_leaf(&mut self, values: &'a [f32]) {
        self.leaf = Some(values);
    }

    /// A frame answers that was one deeper than the one it answers to.
    pub(super) fn set_frame(&mut self) {
        self.leaf = None;
    }

    /// What the frame at `depth` keeps, and what its child has.
    fn pair<'b>(
        buffer: &'b mut [f32],
        leaf: Option<&'b [f32]>,
        width: usize,
        depth: usize,
    ) -> (&'b mut [f32], &'b [f32]) {
        let (frames, child) = buffer.split_at_mut((depth + 1) * width);
        (&mut frames[depth * width..], leaf.unwrap_or(&child[..width]))
    }

    #[inline]
    fn add(&mut self, depth: usize, weight: f32) {
        let (sums, values) = Self::pair(&mut self.mean, self.leaf, self.defaults.len(), depth);
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += weight * value;
        }
    }

    fn take_dominant(&mut self, depth: usize) {
        if self.dominance {
            let (kept, values) = Self::pair(&mut self.dominant, self.leaf, self.defaults.len(), depth);
            kept.copy_from_slice(values);
        }
    }

    fn take_all(&mut self, depth: usize) {
        let (kept, values) = Self::pair(&mut self.mean, self.leaf, self.defaults.len(), depth);
        kept.copy_from_slice(values);
        self.take_dominant(depth);
    }

    fn scale(&mut self, depth: usize, factor: f32) {
        let width = self.defaults.len();
        for sum in &mut self.mean[depth * width..][..width] {
            *sum *= factor;
        }
    }

    fn set_defaults(&mut self, depth: usize) {
        let start = depth * self.defaults.len();
        self.mean[start..][..self.defaults.len()].copy_from_slice(self.defaults);
        if self.dominance {
            self.dominant[start..][..self.defaults.len()].copy_from_slice(self.defaults);
        }
    }
}

/// An operator, as far as its children have answered.
pub(super) struct Frame {
    pub(super) operator: Operator,
    /// The point outside of the operator.
    pub(super) p: Vec3,
    first: bool,
    /// The field so far; of Ricci's blend, the largest operand so far.
    field: f32,
    /// The gradient so far; of Ricci's blend, the sum of `(f_i / largest)^(n - 1) grad f_i`.
    gradient: Vec3,
    /// The weights so far; of Ricci's blend, relative to the largest operand.
    total: f32,
    /// The largest weight of a leaf; of operators with a winner, its share in the winner.
    best: f32,
}

impl Frame {
    pub(super) fn new(operator: Operator, p: Vec3) -> Self {
        Self { operator, p, first: true, field: 0.0, gradient: Vec3::ZERO, total: 0.0, best: 0.0 }
    }

    /// Takes in the answer of a child; `depth` is this frame's.
    #[inline(always)]
    pub(super) fn take<const GRADIENT: bool>(
        &mut self,
        child: &Answer,
        iso2: f32,
        values: &mut Values,
        depth: usize,
    ) {
        match self.operator {
            Operator::Sum => {
                self.field += child.field;
                self.gradient += child.gradient;
                self.weigh(child.field, child, values, depth);
            }
            Operator::Powers(n) => self.power::<GRADIENT>(child, values, depth, |x| x.powi(n - 1)),
            Operator::Ricci(n) => self.power::<GRADIENT>(child, values, depth, |x| x.powf(n - 1.0)),
            Operator::Twist(_) | Operator::Warp(_) => self.win(child, values, depth),
            Operator::Union | Operator::Intersection | Operator::Difference if self.first => {
                self.win(child, values, depth);
            }
            Operator::Union if child.field > self.field => self.win(child, values, depth),
            Operator::Intersection if child.field < self.field => self.win(child, values, depth),
            Operator::Union | Operator::Intersection => {}
            Operator::Difference => self.subtract(child, iso2, values, depth),
        }
        self.first = false;
    }

    #[inline]
    fn weigh(&mut self, weight: f32, child: &Answer, values: &mut Values, depth: usize) {
        if weight > 0.0 {
            self.total += weight;
            values.add(depth, weight);
            if weight * child.share > self.best {
                self.best = weight * child.share;
                values.take_dominant(depth);
            }
        }
    }

    /// `power(x)` is `x^(n - 1)`.
    fn power<const GRADIENT: bool>(
        &mut self,
        child: &Answer,
        values: &mut Values,
        depth: usize,
        power: impl Fn(f32) -> f32,
    ) {
        if child.field <= 0.0 {
            return;
        }
        if child.field > self.field {
            let ratio = self.field / child.field;
            let less = power(ratio);
            self.gradient *= less;
            self.total *= less * ratio;
            self.best *= less * ratio;
            values.scale(depth, less * ratio);
            self.field = child.field;
        }
        let ratio = child.field / self.field;
        let less = power(ratio);
        if GRADIENT {
            self.gradient += less * child.gradient;
        }
        self.weigh(less * ratio, child, values, depth);
    }

    fn win(&mut self, child: &Answer, values: &mut Values, depth: usize) {
        self.field = child.field;
        self.gradient = child.gradient;
        self.best = child.share;
        values.take_all(depth);
    }

    /// The second child of a difference: what is subtracted.
    fn subtract(&mut self, child: &Answer, iso2: f32, values: &mut Values, depth: usize) {
        let cut = iso2 - child.field;
        if cut.max(0.0) >= self.field {
            return;
        }
        self.field = cut.max(0.0);
        self.gradient = if cut > 0.0 { -child.gradient } else { Vec3::ZERO };
        if child.field > 0.0 {
            self.best = child.share;
            values.take_all(depth);
        }
    }

    /// The answer of the only child, whose attributes it has at its depth.
    pub(super) fn lone(&self) -> Answer {
        Answer { field: self.field, gradient: self.gradient, share: self.best }
    }

    /// The answer of the operator; its attributes stay at `depth`.
    #[inline]
    pub(super) fn finish(&self, values: &mut Values, depth: usize) -> Answer {
        let (field, gradient, weight) = match self.operator {
            Operator::Sum => (self.field, self.gradient, self.total),
            Operator::Powers(n) => self.root(root(self.total, n)),
            Operator::Ricci(n) => self.root(self.total.powf(1.0 / n)),
            Operator::Union | Operator::Intersection | Operator::Difference => {
                (self.field, self.gradient, self.field)
            }
            Operator::Twist(_) | Operator::Warp(_) => {
                return self.lone();
            }
        };
        if weight <= 0.0 {
            values.set_defaults(depth);
            return Answer { field, gradient, share: 1.0 };
        }
        if let Operator::Sum | Operator::Powers(_) | Operator::Ricci(_) = self.operator {
            values.scale(depth, 1.0 / weight);
            return Answer { field, gradient, share: self.best / weight };
        }
        Answer { field, gradient, share: self.best }
    }

    /// Ricci's blend: `F = m r` and `grad F = G / r^(n - 1)`, where `r^n` is the total weight S, so that
    /// `r^(n - 1) = S / r`.
    fn root(&self, root: f32) -> (f32, Vec3, f32) {
        let gradient = if self.total > 0.0 { self.gradient * (root / self.total) } else { Vec3::ZERO };
        (self.field * root, gradient, self.total)
    }
}

/// The n-th root.
pub(super) fn root(x: f32, n: i32) -> f32 {
    if n == 2 { x.sqrt() } else { x.powf(1.0 / n as f32) }
}
