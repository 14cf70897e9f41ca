//! Shapes of a scene: blobs with their places, and the names of what is no blob.

use std::sync::Arc;

use glam::DAffine3;
use jbt_model::diagnostic::Span;
use jbt_model::skeleton::Skeleton;

/// A linear colour.
pub(super) type Color = [f64; 3];

/// A component of a blob.
#[derive(Clone)]
pub(super) struct Component {
    pub(super) skeleton: Skeleton,
    pub(super) radius: f64,
    pub(super) strength: f64,
    /// From its own space to the blob's.
    pub(super) map: DAffine3,
    pub(super) color: Option<Color>,
    pub(super) span: Span,
}

/// A blob in its own space.
#[derive(Clone)]
pub(super) struct PovBlob {
    pub(super) threshold: f64,
    pub(super) components: Vec<Component>,
    /// Its own transformations.
    pub(super) map: DAffine3,
    pub(super) color: Option<Color>,
    pub(super) span: Span,
}

/// A blob at a place.
#[derive(Clone)]
pub(super) struct PlacedBlob {
    pub(super) blob: Arc<PovBlob>,
    /// From where the blob's own transformations lead, to the world.
    pub(super) map: DAffine3,
    /// What the shapes around it give, if it has no colour of its own.
    pub(super) color: Option<Color>,
    /// Why its shape would be another one.
    pub(super) fault: Option<Arc<str>>,
}

/// What a name, a group or a scene holds.
#[derive(Clone, Default)]
pub(super) struct PovShapes {
    pub(super) blobs: Vec<PlacedBlob>,
    /// Words for the shapes that are no blobs, each once, and the first ones alone.
    pub(super) others: Vec<String>,
}

/// How many words for other shapes are kept.
const MOST_OTHERS: usize = 8;

impl PovShapes {
    /// A shape that is no blob.
    pub(super) fn other(word: &str) -> Self {
        Self { blobs: Vec::new(), others: vec![word.to_owned()] }
    }

    pub(super) fn add(&mut self, shapes: Self) {
        self.blobs.extend(shapes.blobs);
        for word in shapes.others {
            if self.others.len() < MOST_OTHERS && !self.others.contains(&word) {
                self.others.push(word);
            }
        }
    }
}
