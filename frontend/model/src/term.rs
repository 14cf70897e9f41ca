//! Formulas of fields in Rust: coordinates, fields of trees and numbers, with arithmetic.
//!
//! ```
//! use jbt_model::builder::{param, point, x, y};
//! use jbt_model::model::Model;
//! use jbt_model::tree::Tree;
//! use jbt_model::walk::walk;
//!
//! // A cone, which grows with a parameter.
//! let cone = Tree::expression(1.0 - (x() * x() + y() * y()).sqrt() / (1.0 + param("bulge", 1.0)));
//! assert_eq!(walk(&Model::new(cone).check().unwrap(), [0.0, 1.0, 5.0]).field, 0.5);
//!
//! // Liming's blend of three fields: + - * / of fields are arithmetic.
//! let [a, b, c] = [0.0, 1.0, 2.0].map(|at| point([at, 0.0, 0.0], 3.0));
//! let blend = Tree::expression(0.7 * a.field() * b.field() - 0.3 * c.field().powf(2.0));
//! assert!(Model::new(blend).check().unwrap().support().is_finite());
//! ```

use std::collections::HashMap;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use crate::expression::{Assembled, Assembler, Draft, Formula};
use crate::falloff::Falloff;
use crate::function::Function;
use crate::number::{Binary, Number, Step, Vector};
use crate::tree::Tree;
use crate::written::{Written, WrittenAttribute};

/// A part of the formula of a field. Cloning one is cheap, and what is used several times is computed once.
#[derive(Clone)]
pub struct Term(Arc<TermNode>);

enum TermKind {
    Coordinate(u8),
    Field(Tree),
    Constant(Number),
    Step(Step),
}

struct TermNode {
    kind: TermKind,
    operands: Vec<Term>,
}

impl Drop for TermNode {
    /// Without recursion, as trees are dropped.
    fn drop(&mut self) {
        let mut list = std::mem::take(&mut self.operands);
        while let Some(term) = list.pop() {
            if let Some(mut node) = Arc::into_inner(term.0) {
                list.append(&mut node.operands);
            }
        }
    }
}

/// The first coordinate of the point, in the expression's own space.
#[must_use]
pub fn x() -> Term {
    Term::leaf(TermKind::Coordinate(0))
}

/// The second coordinate.
#[must_use]
pub fn y() -> Term {
    Term::leaf(TermKind::Coordinate(1))
}

/// The third coordinate.
#[must_use]
pub fn z() -> Term {
    Term::leaf(TermKind::Coordinate(2))
}

macro_rules! unary {
    ($($(#[doc = $doc:literal])+ $name:ident $function:ident;)+) => { $(
        $(#[doc = $doc])+
        #[must_use]
        pub fn $name(&self) -> Self {
            Self::step(Step::Call(Function::$function, 1), [self.clone()])
        }
    )+ };
}

impl Term {
    fn leaf(kind: TermKind) -> Self {
        Self(Arc::new(TermNode { kind, operands: Vec::new() }))
    }

    fn step(step: Step, operands: impl IntoIterator<Item = Self>) -> Self {
        Self(Arc::new(TermNode { kind: TermKind::Step(step), operands: operands.into_iter().collect() }))
    }

    /// The value of any function; `operands` are as many as its [`arity`](Function::arity) allows.
    ///
    /// ```
    /// use jbt_model::builder::{point, x, y, z};
    /// use jbt_model::function::Function;
    /// use jbt_model::term::Term;
    /// let distance = Term::of_function(Function::Length, [x(), y(), z()]);
    /// # let _ = distance;
    /// ```
    #[must_use]
    pub fn of_function(function: Function, operands: impl IntoIterator<Item = Self>) -> Self {
        let operands: Vec<Self> = operands.into_iter().collect();
        Self::step(Step::Call(function, operands.len() as u32), operands)
    }

    fn call<const N: usize>(function: Function, operands: [Self; N]) -> Self {
        Self::step(Step::Call(function, N as u32), operands)
    }

    unary! {
        /// The square root; of negative numbers 0.
        sqrt Sqrt;
        /// The sine of radians.
        sin Sin;
        /// The cosine of radians.
        cos Cos;
        /// The tangent of radians.
        tan Tan;
        /// The arc sine, in radians.
        asin Asin;
        /// The arc cosine, in radians.
        acos Acos;
        /// The arc tangent, in radians.
        atan Atan;
        /// The magnitude.
        abs Abs;
        /// -1, 0 or 1.
        sign Sign;
        /// Down to a whole number.
        floor Floor;
        /// Up to a whole number.
        ceil Ceil;
        /// To the nearest whole number, ties to the even one.
        round Round;
        /// e to this power.
        exp Exp;
        /// The natural logarithm; of what is not positive, that of the smallest normal f32.
        ln Ln;
        /// Its square.
        square Square;
    }

    /// The smaller one.
    #[must_use]
    pub fn min(&self, other: impl Into<Self>) -> Self {
        Self::call(Function::Min, [self.clone(), other.into()])
    }

    /// The larger one.
    #[must_use]
    pub fn max(&self, other: impl Into<Self>) -> Self {
        Self::call(Function::Max, [self.clone(), other.into()])
    }

    /// Not below `low`, and not above `high`.
    #[must_use]
    pub fn clamp(&self, low: impl Into<Self>, high: impl Into<Self>) -> Self {
        Self::call(Function::Clamp, [self.clone(), low.into(), high.into()])
    }

    /// From this to `other`, as `part` goes from 0 to 1.
    #[must_use]
    pub fn mix(&self, other: impl Into<Self>, part: impl Into<Self>) -> Self {
        Self::call(Function::Mix, [self.clone(), other.into(), part.into()])
    }

    /// 0 below `edge`, else 1.
    #[must_use]
    pub fn step_at(&self, edge: impl Into<Self>) -> Self {
        Self::call(Function::Step, [edge.into(), self.clone()])
    }

    /// What is left after whole multiples of `by`.
    #[must_use]
    pub fn modulo(&self, by: impl Into<Self>) -> Self {
        Self::call(Function::Mod, [self.clone(), by.into()])
    }

    /// The angle of the point (`other`, this), in radians.
    #[must_use]
    pub fn atan2(&self, other: impl Into<Self>) -> Self {
        Self::call(Function::Atan2, [self.clone(), other.into()])
    }

    /// To a power: a whole literal one of any number, any other of a number that is not negative.
    #[must_use]
    pub fn powf(&self, exponent: impl Into<Self>) -> Self {
        Self::step(Step::Binary(Binary::Power), [self.clone(), exponent.into()])
    }

    /// The falloff of this as a distance, of which 1 is the end; negative distances count as 0.
    #[must_use]
    pub fn falloff(&self, falloff: impl Into<Falloff>) -> Self {
        Self::call(Function::falloff(falloff.into()), [self.clone()])
    }

    /// The node of this formula, which is 0 outside of a box, if there is one.
    fn tree(&self, bounds: Option<[Vector; 2]>) -> Tree {
        let (assembled, children) = Self::assemble(&[self]);
        let formula = Formula::new(assembled, bounds.map(|corners| corners.map(|corner| corner.0)));
        Tree::new(Written::Expression(formula), children)
    }

    /// The formula with these values, and the trees for whose fields it asks.
    fn assemble(values: &[&Self]) -> (Assembled, Vec<Tree>) {
        let (mut assembler, mut children) = (Assembler::default(), Vec::new());
        let mut places: HashMap<usize, u32> = HashMap::new();
        let mut done: HashMap<*const TermNode, Draft> = HashMap::new();
        let mut stack: Vec<_> = values.iter().rev().map(|&term| (term, false)).collect();
        while let Some((term, opened)) = stack.pop() {
            let node = &*term.0;
            if done.contains_key(&Arc::as_ptr(&term.0)) {
                continue;
            }
            if !opened && !node.operands.is_empty() {
                stack.push((term, true));
                stack.extend(node.operands.iter().rev().map(|operand| (operand, false)));
                continue;
            }
            let draft = match &node.kind {
                TermKind::Coordinate(axis) => Draft::Coordinate(*axis),
                TermKind::Constant(number) => Draft::Constant(number.clone()),
                TermKind::Field(tree) => {
                    let next = children.len() as u32;
                    let place = *places.entry(tree.identity()).or_insert(next);
                    if place == next {
                        children.push(tree.clone());
                    }
                    Draft::Child(place)
                }
                TermKind::Step(step) => {
                    let operands = node.operands.iter().map(|operand| done[&Arc::as_ptr(&operand.0)].clone());
                    let operands = operands.collect();
                    assembler.apply(step, operands)
                }
            };
            done.insert(Arc::as_ptr(&term.0), draft);
        }
        let values: Vec<Draft> = values.iter().map(|term| done[&Arc::as_ptr(&term.0)].clone()).collect();
        let assembled = assembler.finish(&values);
        let children = assembled.children.iter().map(|&child| children[child as usize].clone()).collect();
        (assembled, children)
    }
}

impl Tree {
    /// A field that is given by a formula. See [`expression`](crate::expression).
    #[must_use]
    pub fn expression(formula: impl Into<Term>) -> Self {
        formula.into().tree(None)
    }

    /// A field that is given by a formula, and 0 outside of the box between two corners.
    #[must_use]
    pub fn expression_within(
        formula: impl Into<Term>,
        low: impl Into<Vector>,
        high: impl Into<Vector>,
    ) -> Self {
        formula.into().tree(Some([low.into(), high.into()]))
    }

    /// Deformed by three formulas of the point, which say where this tree is asked: it appears where they
    /// lead to it. They ask for no fields. See [`FormulaWarp`](struct@crate::warp::FormulaWarp).
    ///
    /// It reaches everywhere, as far as anybody knows; [`within`](Self::within) a box it ends there.
    ///
    /// ```
    /// use jbt_model::builder::{point, x, y, z};
    /// use jbt_model::model::Model;
    /// use jbt_model::walk::walk;
    ///
    /// let wave = point([0.0; 3], 1.0).warp([x() - 0.5 * (y() * 2.0).sin(), y(), z()]);
    /// let wave = wave.within([-2.0; 3], [2.0; 3]);
    /// let tree = Model::new(wave).check().unwrap();
    /// let expected = walk(&Model::new(point([0.0; 3], 1.0)).check().unwrap(), [0.1, 0.3, 0.0]).field;
    /// assert!((walk(&tree, [0.1 + 0.5 * 0.6f64.sin(), 0.3, 0.0]).field - expected).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn warp<T: Into<Term>>(&self, coordinates: [T; 3]) -> Self {
        let coordinates = coordinates.map(Into::into);
        let (assembled, _) = Term::assemble(&coordinates.each_ref());
        Self::new(Written::FormulaWarp(Formula::new(assembled, None)), vec![self.clone()])
    }

    /// With a formula for every leaf below: one value for each channel of the group, of the coordinates in
    /// the space of this tree. It may ask for no fields. See [`expression`](crate::expression).
    ///
    /// ```
    /// use jbt_model::builder::{point, x, y};
    /// use jbt_model::model::Model;
    /// use jbt_model::walk::walk;
    ///
    /// let ball = point([0.0; 3], 2.0).expressed("color", [0.5 + 0.5 * x(), y().abs(), 0.2.into()]);
    /// let tree = Model::new(ball.translate([5.0, 0.0, 0.0])).check().unwrap();
    /// assert_eq!(walk(&tree, [6.0, -0.25, 0.0]).attributes[0], [1.0, 0.25, 0.2]);
    /// ```
    #[must_use]
    pub fn expressed(&self, name: &str, values: impl IntoIterator<Item = impl Into<Term>>) -> Self {
        let values: Vec<Term> = values.into_iter().map(Into::into).collect();
        let (assembled, _) = Term::assemble(&values.iter().collect::<Vec<_>>());
        self.given(name, WrittenAttribute::Expressed(Formula::new(assembled, None)))
    }

    /// The same with the falloff of every primitive given by a formula of r, the distance over the radius of
    /// support, from 0 at the skeleton to 1.
    ///
    /// Where r is 1 the formula has to be 0 exactly, as computed in f64: then the field is exactly 0 from
    /// there on, and reaches as far as before. One that is not reaches everywhere. Between 0 and 1 it may
    /// rise and fall. It is the same as an expression over primitives with the falloff
    /// [`Linear`](Falloff::Linear), of which r is `1 - field`. So a surface radius, which is turned into one
    /// of support by a falloff, is by that one.
    ///
    /// ```
    /// use jbt_model::builder::point;
    /// use jbt_model::model::Model;
    /// use jbt_model::walk::walk;
    ///
    /// // A ball in a shell: cos^2(3 pi r / 2) (1 - r).
    /// let ripple = |r: &jbt_model::builder::Term| (4.712 * r).cos().square() * (1.0 - r);
    /// let tree = Model::new(point([0.0; 3], 2.0).falloff_by(|r| ripple(&r))).check().unwrap();
    /// assert_eq!(walk(&tree, [0.0; 3]).field, 1.0);
    /// assert!((walk(&tree, [0.0, 4.0 / 3.0, 0.0]).field - 1.0 / 3.0).abs() < 1e-3);
    /// assert!(tree.support().is_finite());
    /// ```
    #[must_use]
    pub fn falloff_by(&self, formula: impl Fn(Term) -> Term) -> Self {
        // A formula is about one field, so each particle becomes a node.
        self.as_points().rewrite(|tree| {
            let Written::Primitive { strength, .. } = tree.node().written() else { return None };
            let cone = tree.falloff(Falloff::Linear).strength(1.0);
            let field = formula(1.0 - cone.field());
            let is_plain = !strength.depends_on_parameters() && strength.value() == 1.0;
            Some(Self::expression(if is_plain { field } else { field * strength.clone() }))
        })
    }

    /// Its field as a part of a formula, where `+ - * /` are arithmetic.
    #[must_use]
    pub fn field(&self) -> Term {
        Term::leaf(TermKind::Field(self.clone()))
    }

    /// Its field, and 0 outside of the box between two corners.
    #[must_use]
    pub fn within(&self, low: impl Into<Vector>, high: impl Into<Vector>) -> Self {
        Self::expression_within(self.field(), low, high)
    }

    /// A falloff of its field as a distance, which ends at `radius`; negative distances count as 0.
    #[must_use]
    pub fn fading(&self, falloff: impl Into<Falloff>, radius: impl Into<Number>) -> Self {
        let formula = Formula::fading(falloff.into(), radius.into());
        Self::new(Written::Expression(formula), vec![self.clone()])
    }
}

impl From<f64> for Term {
    fn from(number: f64) -> Self {
        Self::leaf(TermKind::Constant(number.into()))
    }
}

macro_rules! constants {
    ($($type:ty)+) => { $(
        impl From<$type> for Term {
            /// The same number, exactly.
            fn from(number: $type) -> Self {
                Self::from(f64::from(number))
            }
        }
    )+ };
}

constants! { f32 i8 i16 i32 u8 u16 u32 }

impl From<Number> for Term {
    fn from(number: Number) -> Self {
        Self::leaf(TermKind::Constant(number))
    }
}

impl From<&Number> for Term {
    fn from(number: &Number) -> Self {
        number.clone().into()
    }
}

impl From<&Self> for Term {
    fn from(term: &Self) -> Self {
        term.clone()
    }
}

impl fmt::Debug for Term {
    /// The expression that it makes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.tree(None), f)
    }
}

impl Neg for Term {
    type Output = Self;

    fn neg(self) -> Self {
        Self::step(Step::Negate, [self])
    }
}

impl Neg for &Term {
    type Output = Term;

    fn neg(self) -> Term {
        -self.clone()
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident $binary:ident),+ $(,)?) => { $(
        impl<T: Into<Self>> $trait<T> for Term {
            type Output = Self;

            fn $method(self, other: T) -> Self {
                Self::step(Step::Binary(Binary::$binary), [self, other.into()])
            }
        }

        impl<T: Into<Term>> $trait<T> for &Term {
            type Output = Term;

            fn $method(self, other: T) -> Term {
                Term::step(Step::Binary(Binary::$binary), [self.clone(), other.into()])
            }
        }
        operators! { @ $trait $method $binary f64, Term }
        operators! { @ $trait $method $binary f64, &Term }
        operators! { @ $trait $method $binary i32, Term }
        operators! { @ $trait $method $binary i32, &Term }
        operators! { @ $trait $method $binary Number, Term }
        operators! { @ $trait $method $binary Number, &Term }
        operators! { @ $trait $method $binary &Number, Term }
        operators! { @ $trait $method $binary &Number, &Term }
    )+ };
    (@ $trait:ident $method:ident $binary:ident $left:ty, $right:ty) => {
        impl $trait<$right> for $left {
            type Output = Term;

            fn $method(self, other: $right) -> Term {
                Term::step(Step::Binary(Binary::$binary), [Term::from(self), other.clone()])
            }
        }
    };
}

operators! {
    Add add Add,
    Sub sub Subtract,
    Mul mul Multiply,
    Div div Divide,
}
