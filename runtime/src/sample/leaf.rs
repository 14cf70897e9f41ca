//! Leaves of a volume: cubes of 8^3 points, and where they are in the tree of the file.

use std::collections::BTreeMap;

use jbt_ir::watch;

/// The binary logarithm of the points along a side of a leaf; then of children along a side of the nodes
/// above.
pub(super) const LEAF: u32 = 3;
pub(super) const LOWER: u32 = 4;
pub(super) const UPPER: u32 = 5;

/// The leaves that are not outside altogether, in the order of the file.
pub(super) type VdbLeaves = BTreeMap<VdbPlace, VdbLeaf>;

/// The leaf at a place, which is made if there is none.
pub(super) fn leaf_at(leaves: &mut VdbLeaves, place: VdbPlace) -> &mut VdbLeaf {
    leaves.entry(place).or_insert_with(|| {
        // Nodes of the map are half full at least.
        watch::take(2 * (size_of::<VdbPlace>() + size_of::<VdbLeaf>()));
        VdbLeaf::default()
    })
}

/// The points of a leaf: which are active, which are inside, and the values of the former, point by point; no
/// values at all if none is active.
#[derive(Clone, Debug, Default)]
pub(super) struct VdbLeaf {
    pub(super) active: LeafMask,
    pub(super) inside: LeafMask,
    pub(super) values: Vec<f32>,
}

impl VdbLeaf {
    /// Makes a point active, and gives it these values.
    pub(super) fn put(&mut self, offset: usize, values: &[f32]) {
        self.active.add(offset);
        watch::take_for(&self.values, 512 * values.len() - self.values.len());
        self.values.resize(512 * values.len(), 0.0);
        self.values[offset * values.len()..][..values.len()].copy_from_slice(values);
    }

    /// Whether all of it is inside, and nothing is active: then it is no leaf but a tile.
    pub(super) fn is_tile(&self) -> bool {
        self.active.is_empty() && self.inside.is_full()
    }
}

/// A bit for each point of a leaf, by its [offset].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct LeafMask(pub(super) [u64; 8]);

impl LeafMask {
    pub(super) fn has(&self, offset: usize) -> bool {
        self.0[offset >> 6] >> (offset & 63) & 1 == 1
    }

    pub(super) fn add(&mut self, offset: usize) {
        self.0[offset >> 6] |= 1 << (offset & 63);
    }

    /// How many points it has.
    pub(super) fn count(&self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0 == [0; 8]
    }

    pub(super) fn is_full(&self) -> bool {
        self.0 == [u64::MAX; 8]
    }
}

/// Where a leaf is: the indices of its node of 4096^3, and its offsets in the nodes below. Its order is that
/// of the file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct VdbPlace {
    pub(super) upper: [u32; 3],
    pub(super) lower: usize,
    pub(super) leaf: usize,
}

impl VdbPlace {
    /// The place of a leaf, by its indices.
    pub(super) fn of(leaf: [u32; 3]) -> Self {
        let lower = leaf.map(|axis| axis >> LOWER);
        Self {
            upper: lower.map(|axis| axis >> UPPER),
            lower: offset(lower, UPPER),
            leaf: offset(leaf, LOWER),
        }
    }

    /// The indices of its first point.
    pub(super) fn corner(self) -> [u32; 3] {
        let inner = |offset: usize, side: u32, axis: usize| {
            offset as u32 >> (side * (2 - axis as u32)) & ((1 << side) - 1)
        };
        [0, 1, 2].map(|axis| {
            let lower = self.upper[axis] << UPPER | inner(self.lower, UPPER, axis);
            (lower << LOWER | inner(self.leaf, LOWER, axis)) << LEAF
        })
    }

    /// The place of the leaf that has a point.
    pub(super) fn around(point: [u32; 3]) -> Self {
        Self::of(point.map(|axis| axis >> LEAF))
    }
}

/// The place of a child in a node, or of a point in a leaf: z is fastest.
pub(super) fn offset([x, y, z]: [u32; 3], side: u32) -> usize {
    let part = |axis: u32| (axis & ((1 << side) - 1)) as usize;
    part(x) << (2 * side) | part(y) << side | part(z)
}
