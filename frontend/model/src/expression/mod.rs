//! Expressions: fields and attributes that are given by a formula of the coordinates, of other fields, and of
//! numbers.
//!
//! ```text
//! expression { 1 - sqrt(x^2 + y^2) / (1 + bulge) }                       a leaf of its own
//! expression { 0.7 * field(a) * field(b) - 0.3 * field(c)^2 }            arithmetic on three subtrees
//! expression { r = sqrt(x^2 + y^2), r - 0.1 * sin(8 * r) }               a definition, which is computed once
//! expression within (-1 -1 -1) to (1 1 1) { x * y * z }                  exactly 0 outside of a box
//! color expression { (0.5 + 0.5 * sin(x), y, 0.2) } { .. }               an attribute of the leaves below
//! ```
//!
//! The shape of the formula ([`Form`]) is code; its numbers are numbers of a row. `x y z` are coordinates of
//! the node's own space: maps above the node act on them as on a skeleton.
//!
//! # Undefined operations
//!
//! All formulas have a value everywhere, because engines have to agree and rows that add nothing must not
//! show:
//!
//! * a quotient by 0 is 0, and so are 0 to a negative power and a remainder by 0;
//! * a root, and a power whose exponent is no whole literal, take negative operands as 0;
//! * `ln` takes operands below the smallest normal f32, 2^-126, as that number; `asin` and `acos` clamp to
//!   [-1, 1];
//! * rounding functions take numbers beyond 2^22 as whole;
//! * the field is clamped to [`LARGEST_FIELD`] in magnitude, overflow included; NaN counts as the lowest
//!   field: 0, if the form of the formula shows that it is never negative, else `-LARGEST_FIELD`.
//!
//! # Where the field is zero
//!
//! A formula is 0 outside of its box, if it has one. If it is 0 where all its children are 0, for all
//! coordinates ([`Expression::vanishes`]), it reaches no further than its children. Any other expression
//! reaches everywhere.
//!
//! # Falloffs
//!
//! The falloff `linear` is 1 - r, where r is the distance over the radius. So a formula of r reads a
//! primitive with that falloff:
//!
//! ```text
//! let cone = point { radius 2 falloff linear }
//! expression { r = 1 - field(cone), (1 - r)^2 * (1 + 2 * r) }            in Rust `point(..).falloff_by(|r| ..)`
//! ```
//!
//! Beyond the radius r stays 1. If the formula is exactly 0 at r = 1, the field is exactly 0 there and is
//! pruned like others; it need not be monotone.
//!
//! # Attributes
//!
//! An expression without children is a leaf: it has the attributes of the nodes above it. With one child it
//! passes on the child's attributes, where the child has a field. With several children it mixes theirs with
//! the weights `max(0, f_i dF/df_i)`.
//!
//! An attribute may be an expression itself: one value for each channel, of coordinates and numbers, but
//! without fields. There NaN counts as 0, and overflow ends at [`LARGEST_FIELD`] too.

mod form;
mod growth;
mod operand;
mod operation;
mod write;

use std::sync::Arc;

use glam::DVec3;

use crate::bounds::Bounds;
use crate::falloff::Falloff;
use crate::function::Function;
use crate::number::{Binary, Number, Step};

pub use form::Form;
pub use form::{Assembled, Assembler, Draft};
pub use operand::Operand;
pub use write::{FormulaSteps, write};

/// The largest magnitude of the field of an expression and of an attribute value: 2^100. Sums and products
/// with ordinary fields stay finite.
pub const LARGEST_FIELD: f32 = 1.267_650_6e30;

/// A formula with its numbers, of a field or of the values of an attribute group.
#[derive(Clone, PartialEq, Debug)]
pub struct Expression {
    pub(crate) form: Arc<Form>,
    /// The numbers of the formula, in the order of its steps; then the corners of the box, if there is one.
    pub(crate) numbers: Vec<f64>,
}

impl Expression {
    /// How its numbers are used.
    #[must_use]
    pub fn form(&self) -> &Form {
        &self.form
    }

    /// How its numbers are used, for whoever keeps it longer than the formula.
    #[must_use]
    pub fn shared_form(&self) -> Arc<Form> {
        Arc::clone(&self.form)
    }

    /// Its numbers, and then the smallest and the largest corner of its box, if it has one.
    #[must_use]
    pub fn numbers(&self) -> &[f64] {
        &self.numbers
    }

    /// Its [numbers](Self::numbers), with the corners of its box relative to a point.
    pub fn numbers_from(&self, point: DVec3) -> impl Iterator<Item = f64> {
        let first = self.numbers.len() - self.form.box_numbers(&self.numbers).map_or(0, <[f64]>::len);
        let from = move |place: usize| if place < first { 0.0 } else { point[(place - first) % 3] };
        self.numbers.iter().enumerate().map(move |(place, number)| number - from(place))
    }

    /// The box outside of which it is 0, in its own space.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let corner = |at: &[f64]| DVec3::new(at[0], at[1], at[2]);
        let sides = self.form.box_numbers(&self.numbers)?;
        Some(Bounds::new(corner(&sides[..3]), corner(&sides[3..])))
    }

    /// Whether it is 0 wherever all its children are 0, for all coordinates. Without children: whether it is
    /// written as the number 0.
    #[must_use]
    pub fn vanishes(&self) -> bool {
        self.form.vanishes(|number| Some(self.numbers[number]))
    }

    /// Whether its field is never negative, derived from the same facts about its children.
    #[must_use]
    pub fn non_negative(&self, children: &[bool]) -> bool {
        self.form.non_negative(children, |number| self.numbers[number] >= 0.0)
    }

    /// Whether a point is in the box; true without a box.
    fn contains(&self, p: DVec3) -> bool {
        self.bounds().is_none_or(|bounds| p.cmpge(bounds.min).all() && p.cmple(bounds.max).all())
    }

    /// The field at a point of its own space, where the children have these fields, in f64.
    #[must_use]
    pub fn field(&self, p: DVec3, children: &[f64]) -> f64 {
        if !self.contains(p) || (children.iter().all(|field| *field == 0.0) && self.vanishes()) {
            return 0.0;
        }
        let largest = f64::from(LARGEST_FIELD);
        let value = self.form.value(&self.numbers, p, children);
        // The oracle does not define NaN; any number in the range will do.
        if value.is_nan() { -largest } else { value.clamp(-largest, largest) }
    }

    /// The weight of each of several children: `max(0, f_i dF/df_i)`, by central differences.
    #[must_use]
    pub fn weights(&self, p: DVec3, children: &[f64]) -> Vec<f64> {
        if !self.contains(p) {
            return vec![0.0; children.len()];
        }
        let mut moved = children.to_vec();
        let mut weight = |child: usize| {
            let (field, step) = (children[child], 1e-6);
            let mut at = |value: f64| {
                moved[child] = value;
                self.form.value(&self.numbers, p, &moved)
            };
            let slope = (at(field + step) - at(field - step)) / (2.0 * step);
            at(field);
            (field * slope).max(0.0)
        };
        (0..children.len()).map(&mut weight).collect()
    }

    /// The values of an attribute group at a point of the attribute node's space, in f64.
    #[must_use]
    pub fn values(&self, p: DVec3) -> Vec<f64> {
        let largest = f64::from(LARGEST_FIELD);
        let kept = |value: f64| if value.is_nan() { 0.0 } else { value.clamp(-largest, largest) };
        self.form.values(&self.numbers, p, &[]).into_iter().map(kept).collect()
    }

    /// The distance of the point from the nearest jump or kink of the formula, in the units of the operands
    /// that are compared there.
    #[must_use]
    pub fn kink_distance(&self, p: DVec3, children: &[f64]) -> f64 {
        let rim = self.bounds().map_or(f64::INFINITY, |bounds| {
            let (low, high) = ((p - bounds.min).abs(), (p - bounds.max).abs());
            low.min(high).min_element()
        });
        if !self.contains(p) {
            return rim;
        }
        self.form.kink_distance(&self.numbers, p, children).min(rim)
    }
}

/// A formula whose numbers may depend on parameters.
#[derive(Clone, PartialEq, Debug)]
pub struct Formula {
    /// How the numbers are used.
    pub form: Arc<Form>,
    /// The numbers, in the order in which the form asks for them; then the corners of the box, if there is
    /// one.
    pub numbers: Vec<Number>,
}

impl Formula {
    /// A formula, and the box outside of which it is 0: the corners, smallest first.
    pub fn new(assembled: Assembled, bounds: Option<[[Number; 3]; 2]>) -> Self {
        let Assembled { mut form, mut numbers, .. } = assembled;
        if let Some(corners) = bounds {
            form.bounded = true;
            numbers.extend(corners.into_iter().flatten());
        }
        Self { form: Arc::new(form), numbers }
    }

    /// The falloff of a distance, where the field of the only child is the distance.
    pub fn fading(falloff: Falloff, radius: Number) -> Self {
        let mut assembler = Assembler::default();
        let divide = Step::Binary(Binary::Divide);
        let distance = assembler.apply(&divide, vec![Draft::Child(0), Draft::Constant(radius)]);
        let field = assembler.apply(&Step::Call(Function::falloff(falloff), 1), vec![distance]);
        Self::new(assembler.finish(&[field]), None)
    }

    /// The field that is 0 everywhere: that of the node `empty`.
    #[must_use]
    pub fn zero() -> Self {
        Self::new(Assembler::default().finish(&[Draft::Constant(0.0.into())]), None)
    }

    /// Whether it is [`zero`](Self::zero).
    #[must_use]
    pub fn is_zero(&self) -> bool {
        let plain = |number: &Number| !number.depends_on_parameters() && number.value().to_bits() == 0;
        *self.form == *Self::zero().form && self.numbers.iter().all(plain)
    }

    /// The corners of its box, if it has one, smallest first.
    pub(crate) fn corners(&self) -> &[Number] {
        self.form.box_numbers(&self.numbers).unwrap_or_default()
    }

    /// The expression with the current values of the numbers.
    pub(crate) fn expression(&self) -> Expression {
        Expression { form: Arc::clone(&self.form), numbers: self.numbers.iter().map(Number::value).collect() }
    }
}

impl From<&Expression> for Formula {
    fn from(expression: &Expression) -> Self {
        Self {
            form: Arc::clone(&expression.form),
            numbers: expression.numbers.iter().map(|&number| number.into()).collect(),
        }
    }
}
