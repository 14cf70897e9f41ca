//! Names: of what stands where, and of what is hoisted.

/// The name of an instance.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(super) struct InstanceId(pub(super) u32);

/// The name of a field of a leaf: a leaf at a position, whatever its attributes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(super) struct FieldId(pub(super) u32);

/// The name of a position: an affine map in a space.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct PositionId(pub(super) u32);

/// The name of a set of attribute bindings.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct BindingsId(pub(super) u32);

/// A space in which points are asked: the world, or the inside of a warp.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(super) struct SpaceId(pub(super) u32);

/// The name of a computed value: a function in coordinates.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(super) struct ComputedId(pub(super) u32);

/// What has to be computed at the start of a space, in this order.
#[derive(Clone, Copy, Debug)]
pub(super) enum Hoist {
    Field(FieldId),
    /// An attribute value that several leaves share.
    Computed(ComputedId),
    /// The point in a space that several lead into, and what is hoisted to its start.
    Space(SpaceId),
    Instance(InstanceId),
}
