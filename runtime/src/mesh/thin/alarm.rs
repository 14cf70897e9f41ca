//! What the search for thin parts finds in a block.

/// Something thin in a block.
pub(super) struct Alarm {
    pub(super) place: [u32; 3],
    pub(super) point: [f32; 3],
    /// Votes, or enough for an alarm of its own.
    pub(super) weight: u32,
}

/// The weight that makes an alarm, in a group of blocks that touch: votes of vertices, of which a groove or a
/// tip has a few.
pub(super) const ALARM: u32 = 24;
