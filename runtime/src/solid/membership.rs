//! Membership: which side of the surface points are on, and whether the surface may pass near them.
//!
//! ```text
//! points ── hull of their cubes ── one range decides them all ─────────────► done
//!                │ undecided
//!                └─ halves, each with the rows that reach it ── ... ── up to 8 points
//!                        a range for each cube ── decided ─────────────────► done
//!                                │ undecided
//!                                └─ corners and middles on both sides ─────► surface
//!                                └─ octants of what is left, some rounds
//! ```

use std::collections::VecDeque;

use jbt_ir::limits::MAX_MEMBERSHIP_BOXES;
use jbt_ir::watch;

use super::{Solid, SolidBatch};
use crate::boxes::{ANYTHING, Box3, Divisible as _, MAX_PARTS};
use crate::error::{Classified, ErrorKind, EvalError, within_memory};
use crate::parallel::{join, scatter};
use crate::points::Points;
use crate::prune::Region;

/// Where a point is.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Membership {
    /// Inside: so is every f32 point of the cube around it.
    Inside,
    /// Outside: so is every f32 point of the cube around it. A field that is not a number is outside.
    Outside,
    /// The surface may pass through the cube around the point: there are points of both sides in it, or it
    /// could not be proven in a bounded number of steps that there are none.
    Surface,
}

impl Membership {
    /// The word of reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inside => "inside",
            Self::Outside => "outside",
            Self::Surface => "surface",
        }
    }

    const fn of(inside: bool) -> Self {
        if inside { Self::Inside } else { Self::Outside }
    }
}

/// Why a membership is not known.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MembershipError {
    /// The distance is negative, infinite or not a number.
    #[error("the distance to the surface must be a finite number of at least 0, and it is {eps}")]
    Distance {
        /// What was given.
        eps: f32,
    },
    /// A point is infinite or not a number.
    #[error("point {index} has a coordinate that is not a finite number: {point:?}")]
    Point {
        /// Which one.
        index: usize,
        /// Where it is.
        point: [f32; 3],
    },
    /// The field could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
}

impl Classified for MembershipError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Distance { .. } | Self::Point { .. } => ErrorKind::Argument,
            Self::Eval(error) => error.kind(),
        }
    }
}

/// What a question takes for a point: its place twice, its number, its answer twice.
const POINT_BYTES: usize = 6 * size_of::<f32>() + size_of::<usize>() + 2 * size_of::<Membership>();

impl Solid {
    /// Where a point is: see [`memberships`](Self::memberships).
    ///
    /// # Errors
    /// Those of [`memberships`](Self::memberships).
    pub fn membership(&self, point: [f32; 3], eps: f32) -> Result<Membership, MembershipError> {
        let mut points = self.field.points();
        points.push(point);
        Ok(self.memberships(&points, eps)?[0])
    }

    /// Where points are: inside, outside, or where the surface may pass within `eps` of them in the maximum
    /// norm, in units of the model: through the cube of half edge `eps` around the point, rounded outwards.
    /// With `eps` 0 a point is inside if its field is at least the iso-value, else outside.
    ///
    /// *Inside* and *outside* are proven for the whole cube; *surface* is the answer wherever that does not
    /// succeed with [`MAX_MEMBERSHIP_BOXES`] ranges. Points near each other share what they take, so many at
    /// once cost less than one after the other. Runs on the threads of the rayon pool in which this is
    /// called; the answers do not depend on them.
    ///
    /// # Errors
    /// A distance or a point that is not finite, or a negative distance. Want of memory.
    pub fn memberships(&self, points: &Points, eps: f32) -> Result<Vec<Membership>, MembershipError> {
        if !(eps >= 0.0 && eps.is_finite()) {
            return Err(MembershipError::Distance { eps });
        }
        within_memory(|| self.memberships_of(points, eps))
    }

    fn memberships_of(&self, points: &Points, eps: f32) -> Result<Vec<Membership>, MembershipError> {
        watch::take(points.len() * POINT_BYTES);
        let moved = (points.origin() != self.field.origin()).then(|| points.moved(self.field.origin()));
        let planes = moved.as_ref().unwrap_or(points).planes();
        let point = |index: usize| planes.map(|plane| plane[index]);
        if let Some(index) = (0..points.len()).find(|&index| point(index).iter().any(|x| !x.is_finite())) {
            return Err(MembershipError::Point { index, point: point(index) });
        }
        let question = MembershipQuestion { solid: self, planes, eps };
        let mut order: Vec<usize> = (0..points.len()).collect();
        let mut found = vec![Membership::Outside; points.len()];
        if !order.is_empty() {
            question.group(None, &mut order, &mut found)?;
        }
        let mut answers = found.clone();
        for (&index, &answer) in order.iter().zip(&found) {
            answers[index] = answer;
        }
        Ok(answers)
    }
}

/// What is asked.
struct MembershipQuestion<'a> {
    solid: &'a Solid,
    planes: [&'a [f32]; 3],
    eps: f32,
}

impl MembershipQuestion<'_> {
    fn point(&self, index: usize) -> [f32; 3] {
        self.planes.map(|plane| plane[index])
    }

    /// The cube around a point.
    fn cube(&self, index: usize) -> Box3 {
        let point = self.point(index);
        if self.eps == 0.0 {
            return Box3::new(point, point);
        }
        Box3::new(
            point.map(|x| (x - self.eps).next_down().max(f32::MIN)),
            point.map(|x| (x + self.eps).next_up().min(f32::MAX)),
        )
    }

    /// Answers for some points of a region, which are put into another order with their answers.
    fn group(
        &self,
        around: Option<&Region>,
        order: &mut [usize],
        answers: &mut [Membership],
    ) -> Result<(), EvalError> {
        let hull = order.iter().map(|&index| self.cube(index)).reduce(|all, cube| {
            let low = [0, 1, 2].map(|axis| all.low[axis].min(cube.low[axis]));
            Box3::new(low, [0, 1, 2].map(|axis| all.high[axis].max(cube.high[axis])))
        });
        let Some(hull) = hull else { return Ok(()) };
        let region = match around {
            Some(around) => self.narrowed(around, hull)?,
            None => self.solid.pruner.region(hull)?,
        };
        let mut range = [ANYTHING];
        self.solid.pruner.ranges(&region, &[hull], &mut range)?;
        if let Some(inside) = self.solid.side(range[0]) {
            answers.fill(Membership::of(inside));
            return Ok(());
        }
        if order.len() <= MAX_PARTS {
            return self.each(&region, order, answers);
        }
        let axis = (0..3).fold(0, |longest, axis| {
            let side = |axis: usize| hull.high[axis] - hull.low[axis];
            if side(axis) > side(longest) { axis } else { longest }
        });
        let middle = order.len() / 2;
        let along = |index: &usize| self.planes[axis][*index];
        order.select_nth_unstable_by(middle, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
        let (order, rest) = order.split_at_mut(middle);
        let (answers, others) = answers.split_at_mut(middle);
        // As deep as the number of points has binary digits.
        let (below, above) = scatter(|watches| {
            join(
                || watches.hold(|| self.group(Some(&region), order, answers)),
                || watches.hold(|| self.group(Some(&region), rest, others)),
            )
        });
        below.and(above)
    }

    fn narrowed(&self, around: &Region, bounds: Box3) -> Result<Region, EvalError> {
        let mut parts = Vec::with_capacity(1);
        self.solid.pruner.narrow(around, &[bounds], &mut parts)?;
        Ok(parts.pop().expect("one box has one region"))
    }

    /// Answers for up to [`MAX_PARTS`] points of a region.
    fn each(&self, region: &Region, order: &[usize], answers: &mut [Membership]) -> Result<(), EvalError> {
        let mut batch = SolidBatch::default();
        order.iter().for_each(|&index| batch.push(self.point(index)));
        let sides = batch.sides(self.solid, region)?;
        if self.eps == 0.0 {
            answers.iter_mut().zip(sides).for_each(|(answer, inside)| *answer = Membership::of(inside));
            return Ok(());
        }
        let cubes: Vec<Box3> = order.iter().map(|&index| self.cube(index)).collect();
        let mut ranges = [ANYTHING; MAX_PARTS];
        self.solid.pruner.ranges(region, &cubes, &mut ranges[..cubes.len()])?;
        for (((answer, cube), range), inside) in answers.iter_mut().zip(&cubes).zip(ranges).zip(sides) {
            let same = match self.solid.side(range) {
                Some(_) => true,
                None => self.is_on_one_side(region, *cube, inside)?,
            };
            *answer = if same { Membership::of(inside) } else { Membership::Surface };
        }
        Ok(())
    }

    /// Whether it can be proven that all points of a cube are on this side.
    fn is_on_one_side(&self, around: &Region, cube: Box3, inside: bool) -> Result<bool, EvalError> {
        let mut batch = SolidBatch::default();
        for corner in 0..8 {
            batch.push([0, 1, 2].map(
                |axis| {
                    if corner >> axis & 1 == 0 { cube.low[axis] } else { cube.high[axis] }
                },
            ));
        }
        if batch.sides(self.solid, around)?.iter().any(|&side| side != inside) {
            return Ok(false);
        }
        let mut open = VecDeque::from([(cube, around.clone())]);
        let mut asked = 0;
        while let Some((bounds, around)) = open.pop_front() {
            let parts = bounds.cut([2; 3]);
            if parts.len() == 1 || asked >= MAX_MEMBERSHIP_BOXES {
                return Ok(false);
            }
            asked += parts.len();
            let region = self.narrowed(&around, bounds)?;
            let mut ranges = [ANYTHING; MAX_PARTS];
            self.solid.pruner.ranges(&region, &parts, &mut ranges[..parts.len()])?;
            batch.clear();
            for (&part, range) in parts.iter().zip(ranges) {
                match self.solid.side(range) {
                    Some(side) if side != inside => return Ok(false),
                    Some(_) => {}
                    None => {
                        batch.push(part.center());
                        open.push_back((part, region.clone()));
                    }
                }
            }
            if batch.sides(self.solid, &region)?.iter().any(|&side| side != inside) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}
