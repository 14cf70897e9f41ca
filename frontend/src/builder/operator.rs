//! Trees of several children: combinators by their names and by Rust's operators, maps of one field, and
//! selectors.

use std::iter::{Product, Sum};
use std::ops::{
    Add, AddAssign, BitAnd, BitAndAssign, BitOr, BitOrAssign, BitXor, BitXorAssign, Not, Sub, SubAssign,
};

use super::Number;
use crate::combine::{Combinator, Family, SetOperation};
use crate::tree::Tree;
use crate::written::Written;

impl Tree {
    /// A combinator over children, in order.
    #[must_use]
    pub fn combine(combinator: Combinator, children: impl IntoIterator<Item = Self>) -> Self {
        Self::new(combinator, children.into_iter().collect())
    }

    /// An operator whose numbers may follow parameters.
    fn operator(
        combinator: Combinator,
        numbers: impl IntoIterator<Item = Number>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        let numbers = numbers.into_iter().collect();
        Self::new(Written::Combine { combinator, numbers }, children.into_iter().collect())
    }

    /// The sum of fields: the plain blend.
    ///
    /// ```
    /// use jbt_frontend::builder::point;
    /// use jbt_frontend::tree::Tree;
    ///
    /// let ball = |x: i32| point([x, 0, 0], 1);
    /// let row = Tree::sum((0..3).map(ball));
    /// assert_eq!(row, (0..3).map(ball).sum());
    /// let mut grown = ball(0) + ball(1);
    /// grown += ball(2);
    /// assert_eq!(row, grown);
    /// ```
    #[must_use]
    pub fn sum(children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::Sum, children)
    }

    /// The largest field: what is inside of any.
    #[must_use]
    pub fn union(children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::Union, children)
    }

    /// The smallest field: what is inside of all.
    #[must_use]
    pub fn intersection(children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::Intersection, children)
    }

    /// What is inside of the first and of no other.
    #[must_use]
    pub fn difference(children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::Difference, children)
    }

    /// What is inside of an odd number of them.
    #[must_use]
    pub fn symmetric_difference(children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::SymmetricDifference, children)
    }

    /// Ricci's blend with exponent `n`: in [1, 1024], where 1 is the sum and large ones are near the union,
    /// or in [-1024, -1], near the intersection.
    #[must_use]
    pub fn blend(n: impl Into<Number>, children: impl IntoIterator<Item = Self>) -> Self {
        Self::operator(Combinator::Ricci(0.0), [n.into()], children)
    }

    /// [`Tree::blend`] of two.
    #[must_use]
    pub fn ricci(&self, n: impl Into<Number>, other: &Self) -> Self {
        Self::blend(n, [self.clone(), other.clone()])
    }

    /// The product of fields, each in units of the iso-value: an intersection that blends.
    #[must_use]
    pub fn product(children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::Product, children)
    }

    /// Union, intersection or difference that rounds where fields differ by less than `width`, in units of
    /// the field.
    #[must_use]
    pub fn smooth(
        set: SetOperation,
        width: impl Into<Number>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        Self::operator(Combinator::Smooth(set, 0.0), [width.into()], children)
    }

    /// [`Tree::smooth`] union of two.
    #[must_use]
    pub fn smooth_union(&self, width: impl Into<Number>, other: &Self) -> Self {
        Self::smooth(SetOperation::Union, width, [self.clone(), other.clone()])
    }

    /// [`Tree::smooth`] intersection of two.
    #[must_use]
    pub fn smooth_intersection(&self, width: impl Into<Number>, other: &Self) -> Self {
        Self::smooth(SetOperation::Intersection, width, [self.clone(), other.clone()])
    }

    /// [`Tree::smooth`] difference of two.
    #[must_use]
    pub fn smooth_difference(&self, width: impl Into<Number>, other: &Self) -> Self {
        Self::smooth(SetOperation::Difference, width, [self.clone(), other.clone()])
    }

    /// Union, intersection or difference by R_alpha, with alpha in [-0.9, 1]: 0 is R_0, 1 the maximum or
    /// minimum.
    #[must_use]
    pub fn rfunction(
        set: SetOperation,
        alpha: impl Into<Number>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        Self::operator(Combinator::RFunction(set, Family::Alpha(0.0)), [alpha.into()], children)
    }

    /// Union, intersection or difference by R_p, with p in [1.1, 64].
    #[must_use]
    pub fn rfunction_power(
        set: SetOperation,
        power: impl Into<Number>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        Self::operator(Combinator::RFunction(set, Family::Power(0.0)), [power.into()], children)
    }

    /// Union, intersection or difference by R_0^m, which has m continuous derivatives; m is 1 to 4.
    #[must_use]
    pub fn rfunction_order(set: SetOperation, order: u32, children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::RFunction(set, Family::Order(order)), children)
    }

    /// Inside and outside exchanged: `2 iso - f`. It is unbounded.
    #[must_use]
    pub fn complement(&self) -> Self {
        Self::combine(Combinator::Complement, [self.clone()])
    }

    /// The field, but at least `low` and at most `high`.
    #[must_use]
    pub fn clamp(&self, low: impl Into<Number>, high: impl Into<Number>) -> Self {
        let clamp = Combinator::Clamp { low: 0.0, high: 0.0 };
        Self::operator(clamp, [low.into(), high.into()], [self.clone()])
    }

    /// A sheet around the surface; `thickness` is in units of the field and below twice the iso-value.
    #[must_use]
    pub fn shell(&self, thickness: impl Into<Number>) -> Self {
        Self::operator(Combinator::Shell(0.0), [thickness.into()], [self.clone()])
    }

    /// The surface moved to where the field is less than the iso-value by this; outwards if it is positive.
    #[must_use]
    pub fn offset(&self, by: impl Into<Number>) -> Self {
        Self::operator(Combinator::Offset(0.0), [by.into()], [self.clone()])
    }

    /// The child whose place, from 0, is nearest to `which`; the others do not count. `which` is a parameter
    /// as a rule.
    ///
    /// ```
    /// use jbt_frontend::builder::{param, point};
    /// use jbt_frontend::model::Model;
    /// use jbt_frontend::tree::Tree;
    ///
    /// let frames = (1..4).map(|size| point([0.0; 3], f64::from(size)));
    /// let tree = Model::new(Tree::select(param("frame", 0.0), frames)).check().unwrap();
    /// let last = tree.with_parameters(&[("frame", 2.0)]).unwrap();
    /// assert_eq!((tree.support().high(), last.support().high()), ([1.0; 3], [3.0; 3]));
    /// ```
    #[must_use]
    pub fn select(which: impl Into<Number>, children: impl IntoIterator<Item = Self>) -> Self {
        Self::new(Written::Select(which.into()), children.into_iter().collect())
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident $combinator:ident),+ $(,)?) => { $(
        operators! { @ Tree, Tree, $trait $method $combinator }
        operators! { @ Tree, &Tree, $trait $method $combinator }
        operators! { @ &Tree, Tree, $trait $method $combinator }
        operators! { @ &Tree, &Tree, $trait $method $combinator }
    )+ };
    (@ $left:ty, $right:ty, $trait:ident $method:ident $combinator:ident) => {
        impl $trait<$right> for $left {
            type Output = Tree;

            fn $method(self, other: $right) -> Tree {
                Tree::combine(Combinator::$combinator, [self.clone(), other.clone()])
            }
        }
    };
}

operators! {
    Add add Sum,
    BitOr bitor Union,
    BitAnd bitand Intersection,
    Sub sub Difference,
    BitXor bitxor SymmetricDifference,
}

macro_rules! assignments {
    ($($trait:ident $method:ident $combinator:ident),+ $(,)?) => { $(
        impl $trait for Tree {
            /// A root that is this operator already, without other parameters, gets one more child: a loop
            /// gives one node, and no chain of them.
            fn $method(&mut self, other: Self) {
                if *self.node().written() == Written::from(Combinator::$combinator) {
                    self.push(other);
                } else {
                    *self = Self::combine(Combinator::$combinator, [self.clone(), other]);
                }
            }
        }

        impl $trait<&Self> for Tree {
            fn $method(&mut self, other: &Self) {
                $trait::$method(self, other.clone());
            }
        }
    )+ };
}

assignments! {
    AddAssign add_assign Sum,
    BitOrAssign bitor_assign Union,
    BitAndAssign bitand_assign Intersection,
    SubAssign sub_assign Difference,
    BitXorAssign bitxor_assign SymmetricDifference,
}

impl Sum for Tree {
    /// [`Tree::sum`]; of nothing it is a node without children, which the check refuses.
    fn sum<I: Iterator<Item = Self>>(trees: I) -> Self {
        Self::combine(Combinator::Sum, trees)
    }
}

impl<'a> Sum<&'a Self> for Tree {
    fn sum<I: Iterator<Item = &'a Self>>(trees: I) -> Self {
        trees.cloned().sum()
    }
}

impl Product for Tree {
    /// [`Tree::product`]; of nothing it is a node without children, which the check refuses.
    fn product<I: Iterator<Item = Self>>(trees: I) -> Self {
        Self::combine(Combinator::Product, trees)
    }
}

impl<'a> Product<&'a Self> for Tree {
    fn product<I: Iterator<Item = &'a Self>>(trees: I) -> Self {
        Product::product(trees.cloned())
    }
}

impl Not for Tree {
    type Output = Self;

    fn not(self) -> Self {
        self.complement()
    }
}

impl Not for &Tree {
    type Output = Tree;

    fn not(self) -> Tree {
        self.complement()
    }
}
