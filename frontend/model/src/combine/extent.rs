//! Where a node's field can be something else than zero, and where it can be negative, from where its
//! children's can.
//!
//! Both are needed: the smaller of a negative field and zero is the negative field, so an intersection
//! reaches out of a child as far as the others can be negative.

use super::member::OperatorReach;
use crate::bounds::Bounds;

/// Boxes outside of which a field is zero, and not negative.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Extent {
    /// The field is 0 outside.
    pub support: Bounds,
    /// The field is not negative outside.
    pub negative: Bounds,
}

impl Extent {
    /// Both boxes by the same map.
    pub fn map(self, mut map: impl FnMut(Bounds) -> Bounds) -> Self {
        Self { support: map(self.support), negative: map(self.negative) }
    }

    /// That of a warp over a child with this, in which points move where another field, of extent `weight`,
    /// is not 0: elsewhere they stay.
    pub fn weighted(self, weight: &Self) -> Self {
        self.map(|bounds| if bounds.is_empty() { bounds } else { bounds.hull(weight.support) })
    }

    /// The hull of all.
    pub(super) fn any(children: &[Self]) -> Self {
        let hull = |of: fn(&Self) -> Bounds| children.iter().map(of).fold(Bounds::EMPTY, Bounds::hull);
        Self { support: hull(|child| child.support), negative: hull(|child| child.negative) }
    }

    /// What all have in common.
    pub(super) fn all(children: &[Self]) -> Self {
        let common = |of: fn(&Self) -> Bounds| {
            let common = children.iter().map(of).fold(Bounds::EVERYWHERE, Bounds::intersection);
            if common.is_empty() { Bounds::EMPTY } else { common }
        };
        Self { support: common(|child| child.support), negative: common(|child| child.negative) }
    }

    /// That of an operator that can be something else than 0 there.
    pub(super) fn reaching(reach: OperatorReach, children: &[Self]) -> Self {
        match reach {
            OperatorReach::Any => {
                Self { support: Self::any(children).support, negative: Self::all(children).negative }
            }
            OperatorReach::Both => {
                let negative = Self::any(children).negative;
                Self { support: Self::all(children).support.hull(negative), negative }
            }
            OperatorReach::Left => children[0],
        }
    }
}
