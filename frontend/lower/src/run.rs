//! Runs: particles that have one code, as the rows of a table.

use jbt_model::falloff::Falloff;

/// The particles of a node that have one code, in their order.
#[derive(Clone, Debug)]
pub(crate) struct PointRun {
    /// Their places in the arrays of the node; if there are none, it is all of them.
    chosen: Option<Box<[u32]>>,
    count: u32,
    /// How many places in the order of operands are taken once this run has been met: those of all particles
    /// of the node for its last run, none for another one.
    pub(crate) places: u32,
    /// Whether no field of them can be negative.
    pub(crate) non_negative: bool,
}

impl PointRun {
    /// All particles of a node, so many.
    pub(crate) fn all(count: u32, non_negative: bool) -> Self {
        Self { chosen: None, count, places: count, non_negative }
    }

    /// Those at these places.
    pub(crate) fn some(chosen: Box<[u32]>, places: u32, non_negative: bool) -> Self {
        Self { count: chosen.len() as u32, chosen: Some(chosen), places, non_negative }
    }

    /// How many there are, at least one.
    pub(crate) fn len(&self) -> usize {
        self.count as usize
    }

    /// The place in the arrays of the node of the one with this number.
    pub(crate) fn place(&self, number: usize) -> usize {
        self.chosen.as_ref().map_or(number, |chosen| chosen[number] as usize)
    }
}

/// The numbers of a leaf in its pose but for its skeleton: of a primitive, or of one of particles.
#[derive(Clone, Copy)]
pub(crate) struct LeafNumbers<'a> {
    pub(crate) radius: f64,
    pub(crate) strength: f64,
    pub(crate) falloff: &'a Falloff,
}
