//! Asking about one point, in any order, for one evaluation.

use std::cell::OnceCell;

use jbt_ir::watch::Watches;

use crate::debug::brief_debug;
use crate::evaluator::Evaluator;

/// One point of a model: what is asked was declared by the evaluator's query, and everything is computed by
/// the first question.
///
/// ```
/// # use jbt::{Evaluator, Model, Query, build::point};
/// # let tree = Model::new(point([0.0; 3], 1.0).color([1.0, 0.0, 0.0])).check().unwrap();
/// let evaluator = Evaluator::compile(&tree, Query::ALL).unwrap();
/// let probe = evaluator.probe([0.5, 0.0, 0.0]);
/// assert_eq!(probe.value(), 0.5);
/// assert_eq!(probe.normal(), Some([1.0, 0.0, 0.0]));
/// assert_eq!(probe.color(), Some([1.0, 0.0, 0.0]));
/// assert_eq!(evaluator.counters().points, 1);
/// ```
pub struct Probe<'a> {
    evaluator: &'a Evaluator,
    point: [f32; 3],
    answers: OnceCell<Vec<f32>>,
}

brief_debug!(Probe<'_>, "Probe", this: point = this.point, answers = this.answers.get());

impl Evaluator {
    /// Begins to ask about one point, whose coordinates count from the [origin](Self::origin).
    ///
    /// It has no error: the first answer panics if there is no memory for a program that it needs.
    #[must_use]
    pub fn probe(&self, point: [f32; 3]) -> Probe<'_> {
        Probe::new(self, point)
    }
}

impl<'a> Probe<'a> {
    fn new(evaluator: &'a Evaluator, point: [f32; 3]) -> Self {
        Self { evaluator, point, answers: OnceCell::new() }
    }

    fn answers(&self) -> &[f32] {
        self.answers.get_or_init(|| {
            let mut answers = vec![0.0; self.evaluator.layout().names().len()];
            let [x, y, z] = &self.point;
            let planes = [x, y, z].map(std::slice::from_ref);
            let mut out: Vec<&mut [f32]> = answers.iter_mut().map(std::slice::from_mut).collect();
            // It has no error to answer, so nobody stops it.
            let asked = Watches::NONE.hold(|| self.evaluator.eval_planes(planes, &mut out));
            // One point fits planes of one, so the error is want of memory.
            asked.unwrap_or_else(|error| panic!("a point could not be evaluated: {error}"));
            answers
        })
    }

    /// The field.
    #[must_use]
    pub fn value(&self) -> f32 {
        self.answers()[0]
    }

    /// The gradient of the field; `None` if the query has none.
    #[must_use]
    pub fn gradient(&self) -> Option<[f32; 3]> {
        self.evaluator.layout().gradient(self.answers()).copied()
    }

    /// The unit normal, away from the inside; `None` if the query has no gradient or it vanishes here.
    #[must_use]
    pub fn normal(&self) -> Option<[f32; 3]> {
        normal(self.gradient()?)
    }

    /// The channels of an attribute group; `None` if there is no such group or it was not asked for.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&[f32]> {
        let (plane, width) = self.evaluator.layout().attribute(name)?;
        Some(&self.answers()[plane..plane + width])
    }

    /// The colour.
    #[must_use]
    pub fn color(&self) -> Option<[f32; 3]> {
        self.attribute("color")?.try_into().ok()
    }
}

/// The unit vector against a gradient; `None` if it has no direction.
pub(crate) fn normal(gradient: [f32; 3]) -> Option<[f32; 3]> {
    let gradient = gradient.map(f64::from);
    let length = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| gradient.map(|g| (-g / length + 0.0) as f32))
}
