//! Parts as solids: which one a point is in, and what two of them have in common.
//!
//! ```text
//!  +-----+   +-----+      apart         no point of one is within the tolerance of a point of the other
//!  +-----+-----+          touching      neither could be proven, down to boxes of the tolerance
//!  +---+=+---+            overlapping   a box is inside of both
//! ```
//!
//! What is said to be apart or to overlap is proven by ranges of both fields over boxes, so it holds for
//! every value that a kernel gives there: see `overlap`.

use jbt_ir::watch;
use jbt_model::check::CheckedTree;
use jbt_model::combine::Intersection;
use jbt_model::diagnostic::Diagnostics;

use super::gap::{Gap, gap};
use super::overlap::{LeftBoxes, PairFound, PairSearch, grown};
use super::{Measure, MeasureError, Measures, RegionError, Solid};
use crate::boxes::Box3;
use crate::compiler::Compiler;
use crate::debug::brief_debug;
use crate::error::{Classified, CompileError, ErrorKind, EvalError, compiled_within_memory, within_memory};
use crate::evaluator::Evaluator;
use crate::points::Points;
use crate::polygonize::Fineness;
use crate::support::{NoBox, around_in_f32};

/// Cells along the longest side of what two parts have in common, for its volume.
const VOLUME_CELLS: usize = 64;

/// The parts of a model, each compiled as a solid of its own, in the coordinates of the model.
///
/// ```
/// use jbt::solid::{PartSolids, Relation};
/// let text = br#"jbt 1 part "hub" { box { half (1 1 1) surface_radius 0.5 } }
///     part "pin" { translate (1.5 0 0) { box { half (1 1 1) surface_radius 0.5 } } }"#;
/// let tree = jbt::text::parse(text, &Default::default())?.check()?;
/// let parts = PartSolids::new(&jbt::Compiler::new(), &tree)?;
/// let Relation::Overlapping { volume, .. } = parts.relation(0, 1, 0.02)? else { panic!() };
/// assert!(volume.low > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct PartSolids {
    compiler: Compiler,
    tree: CheckedTree,
    solids: Vec<(String, Solid)>,
    /// Where parts are looked at, if not all over.
    region: Option<Box3>,
}

brief_debug!(PartSolids, "PartSolids", this: parts = this.solids.len());

/// What two parts have to do with each other.
#[derive(Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub enum Relation {
    /// Proven: no point of one is as near as this to a point of the other.
    Apart {
        /// The tolerance that was asked for.
        more_than: f64,
    },
    /// Neither is proven, down to boxes no larger than the tolerance: in those that are left, points of one
    /// may be as near as the tolerance to points of the other, or in both. No middle of a box is in both, so
    /// no ball is whose diameter is twice the side of the boxes, but for what is due to rounding.
    Touching {
        /// The longest side of the boxes that are left.
        within: f64,
        /// A point of one of them, in the world: where the smaller of both fields is largest.
        at: [f64; 3],
    },
    /// Neither is proven, and the work was used up before boxes were as small as the tolerance: points may be
    /// as near as that to each other, or in both.
    Undecided {
        /// No ball of this diameter is in both, but for what is due to rounding: twice the longest side of
        /// the boxes that are left.
        thinner_than: f64,
        /// A point of one of them, in the world: where the smaller of both fields is largest.
        at: [f64; 3],
    },
    /// Proven: a box is inside of both.
    Overlapping {
        /// The middle of such a box, in the world.
        at: [f64; 3],
        /// What they have in common.
        volume: super::Volume,
    },
}

/// Two parts, by their places among the parts, and what is known of them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PartPair {
    /// Their places.
    pub parts: [usize; 2],
    /// What they have to do with each other.
    pub relation: Relation,
}

/// Why parts were not compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartError {
    /// The tolerance is not finite and greater than 0.
    #[error("the tolerance must be a finite number greater than 0, and it is {tolerance}")]
    Tolerance {
        /// What was given.
        tolerance: f64,
    },
    /// A part reaches to infinity.
    #[error("the part `{name}` is unbounded: it needs a region")]
    Unbounded {
        /// Its name.
        name: String,
    },
    /// A part could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A field could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// What parts have in common could not be measured.
    #[error(transparent)]
    Measure(#[from] MeasureError),
}

impl Classified for PartError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Tolerance { .. } => ErrorKind::Argument,
            Self::Unbounded { .. } => ErrorKind::Unbounded,
            Self::Compile(error) => error.kind(),
            Self::Eval(error) => error.kind(),
            Self::Measure(error) => error.kind(),
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        match self {
            Self::Compile(error) => error.diagnostics(),
            Self::Measure(error) => error.diagnostics(),
            Self::Tolerance { .. } | Self::Unbounded { .. } | Self::Eval(_) => None,
        }
    }
}

impl PartSolids {
    /// The solids of all parts; of a model without parts there are none.
    ///
    /// # Errors
    /// A part is beyond a limit, or the engine cannot be had.
    pub fn new(compiler: &Compiler, tree: &CheckedTree) -> Result<Self, CompileError> {
        compiled_within_memory(|| Self::of_all(compiler, tree))
    }

    fn of_all(compiler: &Compiler, tree: &CheckedTree) -> Result<Self, CompileError> {
        let solid = |(index, part): (usize, &jbt_model::check::PartRoot<'_>)| {
            Ok((part.name.to_owned(), Solid::new(compiler, &tree.part(index))?))
        };
        let solids = tree.parts().iter().enumerate().map(solid).collect::<Result<_, CompileError>>()?;
        Ok(Self { compiler: compiler.clone(), tree: tree.clone(), solids, region: None })
    }

    /// The same parts, of which only what is in a box is looked at: unbounded ones need one. Corners are
    /// those of the world.
    #[must_use]
    pub fn within(self, region: Box3<f64>) -> Self {
        let origin = self.tree.origin();
        Self { region: Some(region.map(|corner| origin.rounded(corner))), ..self }
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.solids.len()
    }

    /// Whether the model has no parts.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.solids.is_empty()
    }

    /// The name of a part. Panics if there is no such part, as all that takes the place of one.
    #[must_use]
    pub fn name(&self, part: usize) -> &str {
        &self.solids[part].0
    }

    /// A part as a solid.
    #[must_use]
    pub fn solid(&self, part: usize) -> &Solid {
        &self.solids[part].1
    }

    /// The parts that a point is in, for each of some points.
    ///
    /// # Errors
    /// A field could not be evaluated.
    pub fn members(&self, points: &Points) -> Result<Vec<Vec<usize>>, EvalError> {
        within_memory(|| self.members_of(points))
    }

    fn members_of(&self, points: &Points) -> Result<Vec<Vec<usize>>, EvalError> {
        let each = size_of::<Vec<usize>>() + (self.len().next_power_of_two() + 2) * size_of::<usize>();
        watch::take(points.len() * each);
        let mut members = vec![Vec::new(); points.len()];
        for (part, (_, solid)) in self.solids.iter().enumerate() {
            let field: &Evaluator = solid.evaluator();
            let mut samples = field.samples();
            field.par_eval(points, &mut samples)?;
            for (member, &value) in members.iter_mut().zip(samples.field()) {
                if value >= solid.iso {
                    member.push(part);
                }
            }
        }
        Ok(members)
    }

    /// What two parts have to do with each other, where points that are as near as the tolerance, in units of
    /// the model, count as touching. A smaller tolerance finds thinner overlaps and gaps, and takes longer.
    ///
    /// The volume of what they have in common is that of 64 cells along its longest side.
    ///
    /// # Errors
    /// See [`PartError`].
    pub fn relation(&self, a: usize, b: usize, tolerance: f64) -> Result<Relation, PartError> {
        let tolerance = checked(tolerance)?;
        within_memory(|| self.relation_of(a, b, tolerance))
    }

    fn relation_of(&self, a: usize, b: usize, tolerance: f32) -> Result<Relation, PartError> {
        let apart = Relation::Apart { more_than: f64::from(tolerance) };
        let Some(common) = self.common(a, b, tolerance)? else { return Ok(apart) };
        match PairSearch::new([self.solid(a), self.solid(b)], common, tolerance).run()? {
            PairFound::Nothing => Ok(apart),
            PairFound::Left(LeftBoxes { longest, are_small, best }) => {
                let (longest, at) = (f64::from(longest), self.world(best));
                Ok(if are_small {
                    Relation::Touching { within: longest, at }
                } else {
                    Relation::Undecided { thinner_than: 2.0 * longest, at }
                })
            }
            PairFound::Both(bounds) => {
                let roots = self.tree.parts();
                let pair = self.tree.joined(&[roots[a].node, roots[b].node], Intersection {});
                let solid = Solid::new(&self.compiler, &pair)?;
                let settings = Measure { region: Some(common), fineness: Fineness::Resolution(VOLUME_CELLS) };
                let mut volume = solid.measure(&settings).run()?.volume;
                // The box that proves it counts, however small it is.
                volume.low = volume.low.max(super::measure::volume_of(&bounds));
                Ok(Relation::Overlapping { at: self.world(bounds.center()), volume })
            }
        }
    }

    /// All pairs of parts, in order.
    ///
    /// # Errors
    /// Those of [`relation`](Self::relation).
    pub fn relations(&self, tolerance: f64) -> Result<Vec<PartPair>, PartError> {
        let pairs = (0..self.len()).flat_map(|a| (a + 1..self.len()).map(move |b| [a, b]));
        pairs
            .map(|[a, b]| Ok(PartPair { parts: [a, b], relation: self.relation(a, b, tolerance)? }))
            .collect()
    }

    /// The distance between two parts: how far apart their nearest points are, 0 where they have points in
    /// common. `None` if one of them is empty, or so thin that no point of it is found.
    ///
    /// The bracket is as narrow as the tolerance, unless
    /// [`MAX_GAP_PAIRS`](jbt_ir::limits::MAX_GAP_PAIRS), [`MAX_GAP_WORK`](jbt_ir::limits::MAX_GAP_WORK) or
    /// [`MAX_GAP_BYTES`](jbt_ir::limits::MAX_GAP_BYTES) is used up: parallel walls have so many nearest
    /// points that it can be wider. It holds all the same, however many leaves the parts have.
    ///
    /// # Errors
    /// See [`PartError`].
    pub fn distance(&self, a: usize, b: usize, tolerance: f64) -> Result<Option<Gap>, PartError> {
        let tolerance = checked(tolerance)?;
        let (Some(first), Some(second)) = (self.bounds(a)?, self.bounds(b)?) else { return Ok(None) };
        let found = within_memory(|| gap([self.solid(a), self.solid(b)], [first, second], tolerance))?;
        Ok(found.map(|gap| Gap { points: gap.points.map(|point| self.tree.origin().world(point)), ..gap }))
    }

    /// The measures of a part: its volume between bounds, its area and its centre of mass.
    ///
    /// # Errors
    /// Those of [`Solid::measure`]; an empty part has the volume 0.
    pub fn measure(&self, part: usize, fineness: Fineness) -> Result<Measures, MeasureError> {
        let region = match (self.region, self.bounds(part)) {
            (Some(_), Ok(None)) => return Ok(Measures::default()),
            (Some(_), Ok(bounds)) => bounds,
            (None, _) | (_, Err(_)) => None,
        };
        match self.solid(part).measure(&Measure { region, fineness }).run() {
            Err(MeasureError::Region(RegionError::Empty)) => Ok(Measures::default()),
            measured => measured,
        }
    }

    /// A box around the support of a part, as far as it is looked at; `None` if it is empty.
    fn bounds(&self, part: usize) -> Result<Option<Box3>, PartError> {
        let bounds = match (around_in_f32(self.solid(part).tree()), self.region) {
            (Ok(bounds), Some(region)) => bounds.common(&region),
            (Ok(bounds), None) => bounds,
            (Err(NoBox::Empty), _) => return Ok(None),
            (Err(NoBox::Unbounded), Some(region)) => region,
            (Err(NoBox::Unbounded), None) => {
                return Err(PartError::Unbounded { name: self.name(part).to_owned() });
            }
        };
        Ok(bounds.is_full().then_some(bounds))
    }

    /// Where both may have points that are as near as the tolerance.
    fn common(&self, a: usize, b: usize, tolerance: f32) -> Result<Option<Box3>, PartError> {
        let (Some(first), Some(second)) = (self.bounds(a)?, self.bounds(b)?) else { return Ok(None) };
        let common = grown(&first, tolerance).common(&grown(&second, tolerance));
        Ok(common.is_full().then_some(common))
    }

    fn world(&self, point: [f32; 3]) -> [f64; 3] {
        self.tree.origin().world(point.map(f64::from))
    }
}

fn checked(tolerance: f64) -> Result<f32, PartError> {
    let rounded = tolerance as f32;
    if rounded > 0.0 && rounded.is_finite() { Ok(rounded) } else { Err(PartError::Tolerance { tolerance }) }
}
