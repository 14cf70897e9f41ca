//! Samples, as structures of arrays: one plane of numbers for each answer.

use std::ops::Range;

use jbt_ir::memory::NoMemory;
use jbt_model::attribute::AttributeGroup;
use jbt_model::query::{AnswerKind, Planes, Query};
use jbt_model::word::normalized;

/// Which plane holds what: the [answers](AnswerKind::ALL) in their order, as far as they were asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    names: Vec<String>,
    answers: Vec<(AnswerKind, Range<usize>)>,
    groups: Vec<(AttributeGroup, usize)>,
}

impl Layout {
    /// The layout of a query's answers about a model with these attributes.
    pub(crate) fn new(query: Query, attributes: &[AttributeGroup]) -> Self {
        let (mut names, mut answers, mut groups) = (Vec::new(), Vec::new(), Vec::new());
        for answer in query.answers() {
            let first = names.len();
            match answer.row().planes {
                Planes::Named(planes) => names.extend(planes.iter().map(|&name| name.to_owned())),
                Planes::Channels => {
                    for group in attributes {
                        groups.push((group.clone(), names.len()));
                        names.extend((0..group.width()).map(|channel| group.title(channel)));
                    }
                }
            }
            answers.push((answer, first..names.len()));
        }
        Self { names, answers, groups }
    }

    /// Names of the planes: `field`, `gx`, `gy`, `gz`, `color.r`, ...
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The planes of an answer; `None` if it was not asked for.
    #[must_use]
    pub fn planes(&self, answer: AnswerKind) -> Option<Range<usize>> {
        self.answers.iter().find(|(known, _)| *known == answer).map(|(_, planes)| planes.clone())
    }

    /// The gradient among numbers in the order of the planes; `None` if it was not asked for.
    pub(crate) fn gradient<'a, T>(&self, planes: &'a [T]) -> Option<&'a [T; 3]> {
        planes[self.planes(AnswerKind::Gradient)?].as_array()
    }

    /// Names of the attribute groups, their first plane and their number of planes.
    pub fn attributes(&self) -> impl Iterator<Item = (&str, usize, usize)> {
        self.groups.iter().map(|(group, plane)| (&*group.name, *plane, group.width()))
    }

    /// What is answered, plane by plane, where there is no place: NaN for field and gradient, and the
    /// defaults of attributes.
    pub(crate) fn blanks(&self) -> Vec<f32> {
        let mut blanks = vec![f32::NAN; self.names.len()];
        for (group, first) in &self.groups {
            for (blank, &default) in blanks[*first..].iter_mut().zip(&group.default) {
                // No answer is -0.
                *blank = default as f32 + 0.0;
            }
        }
        blanks
    }

    /// The first plane of an attribute group and its number of planes.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<(usize, usize)> {
        let name = normalized(name);
        self.attributes().find(|(group, ..)| *group == name).map(|(_, plane, width)| (plane, width))
    }
}

/// The answers at points: one plane for each, in the order of a [`Layout`].
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    layout: Layout,
    planes: Vec<Vec<f32>>,
}

impl Samples {
    /// Room for answers of this layout; empty so far.
    #[must_use]
    pub fn new(layout: Layout) -> Self {
        let planes = vec![Vec::new(); layout.names.len()];
        Self { layout, planes }
    }

    /// Answers that are there already: a plane for each name of the layout, all of one length.
    pub(crate) fn from_planes(layout: Layout, planes: Vec<Vec<f32>>) -> Self {
        debug_assert_eq!(planes.len(), layout.names.len(), "a plane for each name");
        Self { layout, planes }
    }

    /// Makes room for this many points. Keeps what is allocated.
    pub fn resize(&mut self, points: usize) {
        for plane in &mut self.planes {
            plane.resize(points, 0.0);
        }
    }

    /// The same, if the memory is to be had.
    ///
    /// # Errors
    /// It is not.
    pub fn try_resize(&mut self, points: usize) -> Result<(), NoMemory> {
        let bytes = points.saturating_mul(size_of::<f32>());
        for plane in &mut self.planes {
            let more = points.saturating_sub(plane.len());
            plane.try_reserve_exact(more).map_err(|_| NoMemory { bytes })?;
            plane.resize(points, 0.0);
        }
        Ok(())
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.planes[0].len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.planes[0].is_empty()
    }

    /// Which plane holds what.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// All planes, in the order of the layout's names.
    #[must_use]
    pub fn planes(&self) -> &[Vec<f32>] {
        &self.planes
    }

    /// All planes, to be written.
    pub(crate) fn planes_mut(&mut self) -> Vec<&mut [f32]> {
        self.planes.iter_mut().map(Vec::as_mut_slice).collect()
    }

    /// The field at every point.
    #[must_use]
    pub fn field(&self) -> &[f32] {
        &self.planes[0]
    }

    /// The gradient of the field at every point, by components; `None` if it was not asked for.
    #[must_use]
    pub fn gradient(&self) -> Option<[&[f32]; 3]> {
        self.layout.gradient(&self.planes).map(|gradient| gradient.each_ref().map(Vec::as_slice))
    }

    /// The channels of an attribute group at every point; `None` if there is no such group or it was not
    /// asked for.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&[Vec<f32>]> {
        let (plane, width) = self.layout.attribute(name)?;
        Some(&self.planes[plane..plane + width])
    }

    /// Linear red, green and blue at every point; `None` if attributes were not asked for. Every model has
    /// the group `color`, white by default.
    #[must_use]
    pub fn colors(&self) -> Option<[&[f32]; 3]> {
        let [red, green, blue] = self.attribute("color")? else { return None };
        Some([red, green, blue])
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Samples {
    /// A map from the names of planes to their numbers.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.layout.names().iter().zip(&self.planes))
    }
}
