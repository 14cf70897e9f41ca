//! Where a node's field can be something else than zero, and where it can be negative, from where its
//! children's can.
//!
//! Both are needed: the smaller of a negative field and zero is the negative field, so an intersection
//! reaches out of a child as far as the others can be negative.

use super::member::Reach;
use super::unary::UnaryKind;
use super::{Combinator, Form};
use crate::bounds::Bounds;

/// Boxes outside of which a field is zero, and not negative.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Extent {
    pub(crate) support: Bounds,
    pub(crate) negative: Bounds,
}

impl Extent {
    /// Both boxes by the same map.
    pub(crate) fn map(self, mut map: impl FnMut(Bounds) -> Bounds) -> Self {
        Self { support: map(self.support), negative: map(self.negative) }
    }

    /// That of a warp over a child with this, in which points move where another field, of extent `weight`,
    /// is not 0: elsewhere they stay.
    pub(crate) fn weighted(self, weight: &Self) -> Self {
        self.map(|bounds| if bounds.is_empty() { bounds } else { bounds.hull(weight.support) })
    }

    /// That of a node over children with these.
    pub(crate) fn of(combinator: Combinator, children: &[Self], iso: f64) -> Self {
        let (supports, negatives) =
            (children.iter().map(|child| child.support), children.iter().map(|child| child.negative));
        let any = || supports.clone().fold(Bounds::EMPTY, Bounds::hull);
        let all = || common(supports.clone());
        let any_negative = || negatives.clone().fold(Bounds::EMPTY, Bounds::hull);
        let all_negative = || common(negatives.clone());
        let (support, negative) = match combinator {
            Combinator::Sum | Combinator::Ricci(1.0) => (any(), any_negative()),
            Combinator::Ricci(n) if n < 0.0 => (all(), Bounds::EMPTY),
            Combinator::Ricci(_) | Combinator::RFunction(..) => (any(), Bounds::EMPTY),
            Combinator::Product => {
                let signed = !any_negative().is_empty();
                (all(), if signed { all() } else { Bounds::EMPTY })
            }
            Combinator::Union => (any(), all_negative()),
            Combinator::Intersection => (all().hull(any_negative()), any_negative()),
            Combinator::Difference => (children[0].support, children[0].negative),
            Combinator::SymmetricDifference | Combinator::Smooth(..) => {
                let reach = combinator.step().map_or(Reach::Any, |(kind, _)| kind.reach());
                match reach {
                    Reach::Any => (any(), all_negative()),
                    Reach::Both => (all().hull(any_negative()), any_negative()),
                    Reach::Left => (children[0].support, children[0].negative),
                }
            }
            Combinator::Complement
            | Combinator::Clamp { .. }
            | Combinator::Shell(_)
            | Combinator::Offset(_) => return Self::of_map(combinator, children[0], iso),
        };
        Self { support, negative }
    }

    fn of_map(combinator: Combinator, child: Self, iso: f64) -> Self {
        let at_zero = combinator.field(&[0.0], iso);
        let support = if at_zero == 0.0 { child.support } else { Bounds::EVERYWHERE };
        let negative = match combinator.form() {
            _ if at_zero < 0.0 => Bounds::EVERYWHERE,
            // Only what exceeds twice the iso-value.
            Form::Map(UnaryKind::Complement) => child.support,
            Form::Map(kind) if kind.is_non_negative(false, &combinator.numbers(), true) => Bounds::EMPTY,
            Form::Map(_) | Form::Fold | Form::Difference | Form::Step(_) => child.negative,
        };
        Self { support, negative }
    }
}

/// What boxes have in common.
fn common(bounds: impl Iterator<Item = Bounds>) -> Bounds {
    let common = bounds.fold(Bounds::EVERYWHERE, Bounds::intersection);
    if common.is_empty() { Bounds::EMPTY } else { common }
}
