//! The stages of a mesh that take long and are divided among threads.

use crate::progress::{Cancelled, Progress};

/// A stage of the work.
#[derive(Clone, Copy, Debug)]
pub(crate) enum MeshStage {
    /// The boxes of the lattice.
    Divide,
    /// The field at the points of bricks.
    Lattice,
    /// Everything at the vertices.
    Vertices,
    /// Parts that are thinner than a cell.
    Thin,
}

impl MeshStage {
    /// Where it begins and ends in the whole work. A guess, for a progress bar.
    fn span(self) -> [f64; 2] {
        match self {
            Self::Divide => [0.0, 0.1],
            Self::Lattice => [0.1, 0.6],
            Self::Vertices => [0.6, 0.97],
            Self::Thin => [0.97, 1.0],
        }
    }

    /// Begins it.
    pub(crate) fn begin(self, progress: &Progress<'_>) -> Result<(), Cancelled> {
        progress.begin(self.span())
    }
}
