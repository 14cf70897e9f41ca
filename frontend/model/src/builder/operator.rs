//! Trees of several children: what the descriptions of operators do not give, Rust's operators, and
//! selectors.

use std::iter::{Product, Sum};
use std::ops::{
    Add, AddAssign, BitAnd, BitAndAssign, BitOr, BitOrAssign, BitXor, BitXorAssign, Not, Sub, SubAssign,
};

use super::{Number, real};
use crate::combine::{Combinator, CombinatorKind, SetOperation};
use crate::tree::Tree;
use crate::written::{FieldNumber, Written};

impl Tree {
    /// An operator over children, in order.
    #[must_use]
    pub fn combine(operator: impl Into<Combinator>, children: impl IntoIterator<Item = Self>) -> Self {
        Self::new(operator.into(), children.into_iter().collect())
    }

    /// An operator whose numbers may depend on parameters.
    pub(super) fn operator(
        combinator: CombinatorKind,
        fields: Vec<FieldNumber>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        Self::new(Written::Combine { combinator, fields }, children.into_iter().collect())
    }

    /// Ricci's blend with exponent `n`: in [1, 1024], where 1 is the sum and large ones are near the union,
    /// or in [-1024, -1], near the intersection.
    #[must_use]
    pub fn blend(n: impl Into<Number>, children: impl IntoIterator<Item = Self>) -> Self {
        Self::operator(CombinatorKind::Ricci, vec![real(n)], children)
    }

    /// Union, intersection or difference that rounds where fields differ by less than `width`, in units of
    /// the field.
    #[must_use]
    pub fn smooth(
        set: SetOperation,
        width: impl Into<Number>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        Self::operator(Combinator::smooth(set, 0.0).kind(), vec![real(width)], children)
    }

    /// The child whose place, from 0, is nearest to `which`; the others do not count. `which` is a parameter
    /// as a rule.
    ///
    /// ```
    /// use jbt_model::builder::{param, point};
    /// use jbt_model::model::Model;
    /// use jbt_model::tree::Tree;
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
                Tree::operator(CombinatorKind::$combinator, Vec::new(), [self.clone(), other.clone()])
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
                let operator = CombinatorKind::$combinator;
                if matches!(self.node().written(), Written::Combine { combinator, .. } if *combinator == operator) {
                    self.push(other);
                } else {
                    *self = Self::operator(operator, Vec::new(), [self.clone(), other]);
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
        Self::operator(CombinatorKind::Sum, Vec::new(), trees)
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
        Self::operator(CombinatorKind::Product, Vec::new(), trees)
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
