//! A finding of the search for thin parts.

/// A thin part in a block.
pub(super) struct Alarm {
    pub(super) place: [u32; 3],
    pub(super) point: [f32; 3],
    /// Votes of vertices, or [`ALARM`] where one finding is enough.
    pub(super) weight: u32,
}

/// The weight that makes an alarm, summed over a group of blocks that touch. A groove or a tip gets only a
/// few votes of vertices.
pub(super) const ALARM: u32 = 24;
