//! Answers at points: arrays in, arrays out, nothing in between.
//!
//! ```text
//! points in pieces that take 20 to 50 ms:     without the interpreter's lock
//!     parts of 4,096 points on all threads:
//!         planes of f32 about the origin    run as they are
//!         anything else                     512 points at a time become planes on the stack
//!     between pieces                        signals
//! ```

use std::ops::Range;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use jbt::{CheckedTree, Counters, EvalError, Evaluator};
use numpy::{PyReadwriteArray2, PyUntypedArrayMethods as _};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::columns::{Coordinates, PointColumn, columns, copy_to, planes};
use crate::error::{OrRaise as _, refused};
use crate::work::{CallEffort, lock, pool};

/// Points that one thread evaluates at once.
const PART: usize = 4096;
/// Points that become planes at once.
const TRANSPOSED: usize = 512;
/// Points of the smallest piece, for one thread.
const LEAST: usize = 64;
/// Distances to skeletons of the first piece, which are one for a point at least: some milliseconds.
const FIRST: u64 = 1 << 23;
/// How long a piece should take.
const PIECE: [Duration; 2] = [Duration::from_millis(20), Duration::from_millis(50)];

/// What answers a query at points. Threads may share it.
#[pyclass(frozen, module = "jbt._jbt", name = "Evaluator")]
pub(crate) struct PyEvaluator {
    /// What is used at present: an update puts another one in its place.
    present: Mutex<PresentEvaluator>,
}

#[derive(Clone)]
struct PresentEvaluator {
    evaluator: Arc<Evaluator>,
    tree: CheckedTree,
    /// What earlier ones did.
    done: [u64; 6],
}

/// Why points were not evaluated.
enum PointsError {
    Eval(EvalError),
    /// A coordinate of this point is NaN.
    NotANumber(usize),
}

impl From<EvalError> for PointsError {
    fn from(error: EvalError) -> Self {
        Self::Eval(error)
    }
}

impl PyEvaluator {
    pub(crate) fn new(evaluator: Evaluator, tree: CheckedTree) -> Self {
        let evaluator = Arc::new(evaluator);
        Self { present: Mutex::new(PresentEvaluator { evaluator, tree, done: [0; 6] }) }
    }

    fn present(&self) -> PresentEvaluator {
        lock(&self.present).clone()
    }
}

fn numbers(counters: &Counters) -> [u64; 6] {
    [
        counters.calls,
        counters.points,
        counters.lanes,
        counters.primitive_evaluations,
        counters.evaluations_pruned,
        counters.evaluations_avoided,
    ]
}

#[pymethods]
impl PyEvaluator {
    /// Names of the planes: `field`, `gx`, `gy`, `gz`, `color.r`, ...
    fn names(&self) -> Vec<String> {
        self.present().evaluator.layout().names().to_vec()
    }

    /// The groups: name, first plane, number of planes.
    fn groups(&self) -> Vec<(String, usize, usize)> {
        let present = self.present();
        let groups = present.evaluator.layout().attributes();
        groups.map(|(name, first, width)| (name.to_owned(), first, width)).collect()
    }

    /// What runs it.
    #[getter]
    fn engine(&self) -> &'static str {
        self.present().evaluator.engine().name()
    }

    /// Where its coordinates count from.
    #[getter]
    fn origin(&self) -> [f64; 3] {
        self.present().evaluator.origin().point()
    }

    /// The iso-value.
    #[getter]
    fn iso(&self) -> f64 {
        self.present().tree.iso()
    }

    /// Parameters: name and value.
    fn parameters(&self) -> Vec<(String, f64)> {
        let tree = self.present().tree;
        tree.parameters().iter().map(|one| (one.name().to_owned(), one.value())).collect()
    }

    /// What it has done: calls, points, lanes, evaluations, pruned and avoided ones.
    fn counters(&self) -> [u64; 6] {
        let PresentEvaluator { evaluator, done, .. } = self.present();
        let now = numbers(&evaluator.counters());
        std::array::from_fn(|index| now[index] + done[index])
    }

    /// Takes other values of parameters.
    fn update(&self, py: Python<'_>, settings: Vec<(String, f64)>) -> PyResult<()> {
        let PresentEvaluator { evaluator, tree, .. } = self.present();
        let borrowed: Vec<(&str, f64)> =
            settings.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let tree = tree.with_parameters(&borrowed).or_raise(py)?;
        let (before, edited) = (Arc::clone(&evaluator), tree.clone());
        let updated = CallEffort::quiet(py).run(move |_| before.updated(&edited))?;
        let done = self.counters();
        *lock(&self.present) = PresentEvaluator { evaluator: Arc::new(updated), tree, done };
        Ok(())
    }

    /// The answers at points into an array of one row for each plane. `nan`: whether points with NaN are
    /// evaluated; otherwise they are an error.
    fn eval(
        &self,
        py: Python<'_>,
        points: [Coordinates<'_>; 3],
        mut out: PyReadwriteArray2<'_, f32>,
        threads: Option<usize>,
        nan: bool,
    ) -> PyResult<()> {
        let evaluator = self.present().evaluator;
        let (columns, count) = columns(&points)?;
        let names = evaluator.layout().names().len();
        if out.shape() != [names, count] {
            let shape = out.shape();
            return Err(refused(format!("out: expected the shape ({names}, {count}), got {shape:?}")));
        }
        let whole = out.as_slice_mut();
        let whole = whole.map_err(|_| refused("out: expected a C-contiguous array"))?;
        if count == 0 {
            return Ok(());
        }
        let mut rows: Vec<&mut [f32]> = whole.chunks_exact_mut(count).collect();
        let pool = (threads != Some(1) && count > PART).then(|| pool(py, threads)).transpose()?;
        let work = PointWork { evaluator: &evaluator, columns, nan };
        let threads = pool.as_ref().map_or(1, |pool| pool.current_num_threads());
        let least = LEAST * threads;
        // Other work of a point takes as long as some distances.
        let first = FIRST / evaluator.evaluations_per_point().saturating_add(64);
        let (mut start, mut size) = (0, least.max(first as usize * threads));
        while start < count {
            let piece = start..count.min(start + size);
            let answers: Vec<&mut [f32]> = rows.iter_mut().map(|row| split(row, piece.len())).collect();
            let begun = Instant::now();
            let done = py.detach(|| match &pool {
                None => work.part(piece.clone(), answers),
                Some(pool) => pool.install(|| work.parts(piece.clone(), threads, answers)),
            });
            done.map_err(|failed| match failed {
                PointsError::Eval(error) => crate::error::raised(py, &error),
                PointsError::NotANumber(index) => {
                    let [x, y, z] = work.columns.map(|column| column.at(index));
                    refused(format!(
                        "points: point {index} is ({x}, {y}, {z}): expected numbers; \
                         nan=\"propagate\" gives NaN as its field"
                    ))
                }
            })?;
            start = piece.end;
            if start < count {
                py.check_signals()?;
                let took = begun.elapsed();
                if took < PIECE[0] {
                    size *= 2;
                } else if took > PIECE[1] {
                    size = (size / 2).max(least);
                }
            }
        }
        Ok(())
    }
}

/// The beginning of a plane; what is left stays in its place.
fn split<'s>(plane: &mut &'s mut [f32], count: usize) -> &'s mut [f32] {
    let (first, rest) = std::mem::take(plane).split_at_mut(count);
    *plane = rest;
    first
}

/// What is evaluated where.
struct PointWork<'a> {
    evaluator: &'a Evaluator,
    columns: [PointColumn<'a>; 3],
    /// Whether points with NaN are evaluated.
    nan: bool,
}

impl PointWork<'_> {
    /// The answers at a range of points, on all threads.
    fn parts(
        &self,
        points: Range<usize>,
        threads: usize,
        mut answers: Vec<&mut [f32]>,
    ) -> Result<(), PointsError> {
        let size = points.len().div_ceil(threads).next_multiple_of(LEAST).min(PART);
        let parts: Vec<(Range<usize>, Vec<&mut [f32]>)> = points
            .clone()
            .step_by(size)
            .map(|start| {
                let part = start..points.end.min(start + size);
                let rows = answers.iter_mut().map(|plane| split(plane, part.len())).collect();
                (part, rows)
            })
            .collect();
        parts.into_par_iter().try_for_each(|(part, answers)| self.part(part, answers))
    }

    /// The answers at a range of points.
    fn part(&self, points: Range<usize>, mut answers: Vec<&mut [f32]>) -> Result<(), PointsError> {
        let origin = self.evaluator.origin();
        if let Some(planes) = planes(&self.columns, origin) {
            let planes = planes.map(|plane| &plane[points.clone()]);
            self.evaluator.eval_planes(planes, &mut answers)?;
            return self.judge(points.start, answers[0]);
        }
        let mut scratch = [[0.0; TRANSPOSED]; 3];
        let mut block = Vec::with_capacity(answers.len());
        let mut start = points.start;
        while start < points.end {
            let some = TRANSPOSED.min(points.end - start);
            copy_to(&self.columns, start, origin, scratch.each_mut().map(|plane| &mut plane[..some]));
            block.extend(answers.iter_mut().map(|plane| split(plane, some)));
            self.evaluator.eval_planes(scratch.each_ref().map(|plane| &plane[..some]), &mut block)?;
            self.judge(start, block[0])?;
            block.clear();
            start += some;
        }
        Ok(())
    }

    /// The field is NaN where a coordinate is, and nowhere else.
    fn judge(&self, start: usize, field: &[f32]) -> Result<(), PointsError> {
        // Without a way out of the loop it is one of vectors.
        let any = field.iter().fold(false, |any, value| any | value.is_nan());
        if self.nan || !any {
            return Ok(());
        }
        let index = field.iter().position(|value| value.is_nan()).unwrap_or_default();
        Err(PointsError::NotANumber(start + index))
    }
}
