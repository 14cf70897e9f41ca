//! Answers about rays.

use std::sync::Arc;

use crate::buffer::{Layout, Samples};
use crate::points::Points;

/// The hits of a packet of rays, ordered by ray, then by t.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Hits {
    /// For each ray where its hits begin, and the end: the hits of ray r are `starts[r]..starts[r + 1]`.
    pub starts: Vec<u32>,
    /// The t of each hit on its ray.
    pub t: Vec<f64>,
    /// Whether the ray enters there: from `field < iso` to `field >= iso`.
    pub entering: Vec<bool>,
    /// The position of each hit, where the samples were taken: origin + t * direction, relative to the
    /// model's origin and rounded to f32. It is on the inner side: the field is at least the iso-value.
    pub positions: Points,
    /// The answers to the tracer's query at these positions.
    pub samples: Samples,
    /// For each ray, the number of distances to skeletons that were evaluated for it: at points, and its
    /// share of the boxes' distances.
    pub evaluations: Vec<f32>,
}

impl Hits {
    /// The number of hits.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether nothing was hit.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// The indices of a ray's hits. Panics if there is no such ray.
    #[must_use]
    pub fn of(&self, ray: usize) -> std::ops::Range<usize> {
        self.starts[ray] as usize..self.starts[ray + 1] as usize
    }

    /// One hit. Panics if there is no such hit.
    pub(super) fn get(&self, index: usize, layout: &Arc<Layout>) -> Hit {
        Hit {
            t: self.t[index],
            position: self.positions.get(index),
            entering: self.entering[index],
            layout: Arc::clone(layout),
            answers: self.samples.planes().iter().map(|plane| plane[index]).collect(),
        }
    }
}

/// The rays of a packet that are blocked.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Blocked {
    /// For each ray, whether it changes its side of the surface.
    pub blocked: Vec<bool>,
    /// For each ray, the number of distances to skeletons that were evaluated for it: at points, and its
    /// share of the boxes' distances.
    pub evaluations: Vec<f32>,
}

/// Where a ray hits the surface.
#[derive(Clone, PartialEq, Debug)]
pub struct Hit {
    /// The parameter on the ray.
    pub t: f64,
    /// The position, relative to the model's origin, where the samples were taken: on the inner side, so the
    /// field is at least the iso-value.
    pub position: [f32; 3],
    /// Whether the ray enters: from `field < iso` to `field >= iso`.
    pub entering: bool,
    layout: Arc<Layout>,
    answers: Vec<f32>,
}

impl Hit {
    /// The field: about the iso-value.
    #[must_use]
    pub fn value(&self) -> f32 {
        self.answers[0]
    }

    /// The gradient of the field; `None` if the query has none.
    #[must_use]
    pub fn gradient(&self) -> Option<[f32; 3]> {
        self.layout.gradient(&self.answers).copied()
    }

    /// The unit normal, outwards: opposite to the gradient. `None` if the query has no gradient, or if the
    /// gradient vanishes.
    #[must_use]
    pub fn normal(&self) -> Option<[f32; 3]> {
        crate::probe::normal(self.gradient()?)
    }

    /// The channels of an attribute group; `None` if there is no such group or it was not asked for.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&[f32]> {
        let (plane, width) = self.layout.attribute(name)?;
        Some(&self.answers[plane..plane + width])
    }

    /// The colour; `None` if attributes were not asked for.
    #[must_use]
    pub fn color(&self) -> Option<[f32; 3]> {
        self.attribute("color")?.try_into().ok()
    }
}
