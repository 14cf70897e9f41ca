//! What an edit has changed of a live mesh.

use std::ops::Range;

/// Where a brick is in the buffers of a live mesh.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BrickRanges {
    /// Its place, in units of bricks from the first corner that the lattice had at first. It names the brick.
    pub place: [i32; 3],
    /// Its vertices.
    pub vertices: Range<usize>,
    /// Its triangles. Their corners may be vertices of bricks beside it, too.
    pub triangles: Range<usize>,
}

/// A brick with another content than before, and what of it is other.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BrickUpdate {
    /// Where it is now: in other ranges than before, if it has outgrown them.
    pub brick: BrickRanges,
    /// Whether positions are other ones.
    pub positions: bool,
    /// Whether normals are other ones.
    pub normals: bool,
    /// Whether attributes are other ones.
    pub attributes: bool,
    /// Whether triangles are other ones.
    pub triangles: bool,
}

/// What an edit has changed of a live mesh. Bricks are in Morton order.
///
/// Whoever has copies of the buffers copies the ranges of [`written_vertices`](Self::written_vertices) and
/// [`written_triangles`](Self::written_triangles), into longer copies if the buffers have grown.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub struct LiveChange {
    /// Bricks that the surface crosses no more, and where they were.
    pub removed: Vec<BrickRanges>,
    /// Bricks that the surface did not cross before.
    pub added: Vec<BrickRanges>,
    /// Bricks that were there, and have another content.
    pub changed: Vec<BrickUpdate>,
    /// Whether a buffer is longer than before.
    pub grown: bool,
    /// Whether the names or widths of attributes are other ones: then the buffers of attributes are new.
    pub relaid: bool,
    /// Ranges of triangles that were given up.
    pub(super) cleared: Vec<Range<usize>>,
}

impl LiveChange {
    /// Whether nothing has changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.removed.is_empty() && self.added.is_empty() && self.changed.is_empty()
    }

    /// The ranges of vertices with other positions, normals or attributes: ascending, apart, and joined where
    /// they touch.
    #[must_use]
    pub fn written_vertices(&self) -> Vec<Range<usize>> {
        let added = self.added.iter().map(|brick| brick.vertices.clone());
        let other = |change: &&BrickUpdate| change.positions || change.normals || change.attributes;
        let changed = self.changed.iter().filter(other).map(|change| change.brick.vertices.clone());
        joined(added.chain(changed))
    }

    /// The ranges of triangles that are other ones, those that were given up among them: ascending, apart,
    /// and joined where they touch.
    #[must_use]
    pub fn written_triangles(&self) -> Vec<Range<usize>> {
        let added = self.added.iter().map(|brick| brick.triangles.clone());
        let changed = self.changed.iter().filter(|change| change.triangles);
        joined(
            added
                .chain(changed.map(|change| change.brick.triangles.clone()))
                .chain(self.cleared.iter().cloned()),
        )
    }
}

/// Ranges that overlap or touch, as one.
fn joined(ranges: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = ranges.filter(|range| !range.is_empty()).collect();
    ranges.sort_unstable_by_key(|range| range.start);
    ranges.dedup_by(|next, last| {
        let touches = next.start <= last.end;
        if touches {
            last.end = last.end.max(next.end);
        }
        touches
    });
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_joined() {
        let ranges = [7..9, 0..2, 2..3, 4..4, 8..8, 5..6, 7..8];
        assert_eq!(joined(ranges.into_iter()), [0..3, 5..6, 7..9]);
        assert!(LiveChange::default().is_empty());
    }
}
