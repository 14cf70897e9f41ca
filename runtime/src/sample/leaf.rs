//! Leaves of a volume: cubes of 8^3 points, whose points have masks.

/// The binary logarithm of the points along a side of a leaf.
pub(super) const LEAF: u32 = 3;

/// A bit for each point of a leaf, by its [offset].
pub(super) type LeafMask = [u64; 8];

/// Whether a mask has a point.
pub(super) fn has(mask: &LeafMask, offset: usize) -> bool {
    mask[offset >> 6] >> (offset & 63) & 1 == 1
}

/// The place of a child in a node, or of a point in a leaf: z is fastest.
pub(super) fn offset([x, y, z]: [u32; 3], side: u32) -> usize {
    let part = |axis: u32| (axis & ((1 << side) - 1)) as usize;
    part(x) << (2 * side) | part(y) << side | part(z)
}
