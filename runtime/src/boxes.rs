//! Boxes of space, and what a field knows about them: what division, meshing and sampling rest on.

use std::error::Error;

use smallvec::SmallVec;

/// A closed axis-aligned box: its sides belong to it. Corners are finite and in order where a function says
/// so.
///
/// In f32 its coordinates count from the origin of a model, as those of programs do; in f64 they may be those
/// of the world.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Box3<T = f32> {
    /// The smallest corner.
    pub low: [T; 3],
    /// The largest corner.
    pub high: [T; 3],
}

impl<T: Copy> Box3<T> {
    /// The box between two corners.
    #[must_use]
    pub const fn new(low: [T; 3], high: [T; 3]) -> Self {
        Self { low, high }
    }

    /// The box between what becomes of the corners.
    #[must_use]
    pub fn map<U>(self, corner: impl Fn([T; 3]) -> [U; 3]) -> Box3<U> {
        Box3 { low: corner(self.low), high: corner(self.high) }
    }

    /// One of its eight corners: the high side along x, y and z for the bits 0, 1 and 2.
    pub(crate) fn corner(&self, bits: usize) -> [T; 3] {
        [0, 1, 2].map(|axis| [self.low, self.high][bits >> axis & 1][axis])
    }
}

impl<T: Copy + PartialOrd> Box3<T> {
    /// Whether a point is in it, sides included.
    #[must_use]
    pub fn contains(&self, point: [T; 3]) -> bool {
        (0..3).all(|axis| (self.low[axis]..=self.high[axis]).contains(&point[axis]))
    }

    /// Whether two boxes have a point in common.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }
}

impl Box3 {
    /// The smallest box that has both in it. What is not a number in one is that of the other.
    pub(crate) fn joined(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis].min(other.low[axis])),
            high: std::array::from_fn(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    /// What is in both; not [full](Self::is_full) if nothing is.
    pub(crate) fn common(&self, other: &Self) -> Self {
        Self {
            low: [0, 1, 2].map(|axis| self.low[axis].max(other.low[axis])),
            high: [0, 1, 2].map(|axis| self.high[axis].min(other.high[axis])),
        }
    }

    /// The smallest box that holds some points; `None` if there are none, or if a coordinate is not finite.
    #[must_use]
    pub(crate) fn around(points: &[[f32; 3]]) -> Option<Self> {
        let (&first, rest) = points.split_first()?;
        let hold = |bounds: Self, point: &[f32; 3]| Self {
            low: [0, 1, 2].map(|axis| bounds.low[axis].min(point[axis])),
            high: [0, 1, 2].map(|axis| bounds.high[axis].max(point[axis])),
        };
        let is_finite = points.iter().flatten().all(|x| x.is_finite());
        is_finite.then(|| rest.iter().fold(Self::new(first, first), hold))
    }

    /// Whether its corners are finite, and in order along each axis; a box may be flat.
    #[must_use]
    pub fn is_proper(&self) -> bool {
        (0..3).all(|axis| {
            let (low, high) = (self.low[axis], self.high[axis]);
            low.is_finite() && high.is_finite() && low <= high
        })
    }

    /// Whether it can be divided: it is proper, not flat, and its sides have a length in f32.
    pub(crate) fn is_full(&self) -> bool {
        let full = (0..3).all(|axis| self.low[axis] < self.high[axis]);
        full && self.is_proper() && self.longest_side().is_finite()
    }

    /// Its longest side.
    #[must_use]
    pub fn longest_side(&self) -> f32 {
        (0..3).fold(0.0, |longest: f32, axis| longest.max(self.high[axis] - self.low[axis]))
    }

    /// The middle of its side along an axis: strictly inside, unless no f32 is.
    #[must_use]
    pub fn middle(&self, axis: usize) -> f32 {
        0.5 * self.low[axis] + 0.5 * self.high[axis]
    }

    /// Its middle.
    pub(crate) fn center(&self) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.middle(axis))
    }

    /// Equal parts of it, so many along each axis, x fastest; fewer where f32 has no more numbers
    /// between the sides.
    pub(crate) fn cut(&self, counts: [usize; 3]) -> Vec<Self> {
        let sides: [Vec<f32>; 3] = [0, 1, 2].map(|axis| {
            let (low, high) = (f64::from(self.low[axis]), f64::from(self.high[axis]));
            let side = |part: usize| (low + (high - low) * part as f64 / counts[axis] as f64) as f32;
            let mut sides: Vec<f32> = (0..=counts[axis]).map(side).collect();
            sides.dedup();
            if sides.len() == 1 {
                // A flat box is one part.
                sides.push(sides[0]);
            }
            sides
        });
        let mut parts = Vec::new();
        for z in sides[2].windows(2) {
            for y in sides[1].windows(2) {
                for x in sides[0].windows(2) {
                    parts.push(Self::new([x[0], y[0], z[0]], [x[1], y[1], z[1]]));
                }
            }
        }
        parts
    }

    /// Its halves along its longer sides: sides that are much shorter than the longest stay whole. The box
    /// alone if it cannot be cut.
    pub(crate) fn halved(&self) -> Vec<Self> {
        let longest = self.longest_side();
        let is_long = |axis: usize| self.high[axis] - self.low[axis] > 0.5 * longest;
        self.cut([0, 1, 2].map(|axis| 1 + usize::from(is_long(axis))))
    }
}

/// What is known of the values in a box: an enclosing interval. `[-inf, inf]` says nothing, and admits NaN;
/// any other range promises numbers.
pub type Range = [f32; 2];

/// The range that says nothing.
pub const ANYTHING: Range = [f32::NEG_INFINITY, f32::INFINITY];

/// Boxes that are asked about at once.
pub const MAX_PARTS: usize = 8;

/// A field that can be asked about boxes.
///
/// A *region* is what is known of a box: which parts of the model matter in it. The region of a part is found
/// from that of the whole, which is cheaper than from nothing.
pub trait Divisible: Sync {
    /// What can go wrong with an evaluation.
    type Error: Error + Send + 'static;
    /// What is known of a box. `()` for a field that knows nothing.
    type Region: Send + Sync;

    /// The region of a proper box.
    ///
    /// # Errors
    /// Whatever the field reports.
    fn region(&self, bounds: Box3) -> Result<Self::Region, Self::Error>;

    /// For each of up to [`MAX_PARTS`] proper boxes inside a region, a range of the field.
    ///
    /// # Errors
    /// Whatever the evaluation reports.
    fn ranges(&self, region: &Self::Region, boxes: &[Box3], ranges: &mut [Range]) -> Result<(), Self::Error>;

    /// The regions of up to [`MAX_PARTS`] proper boxes inside a region, appended to `parts`.
    ///
    /// # Errors
    /// Whatever the evaluation reports.
    fn narrow(
        &self,
        region: &Self::Region,
        boxes: &[Box3],
        parts: &mut Vec<Self::Region>,
    ) -> Result<(), Self::Error>;

    /// The regions of the wanted ones of up to [`MAX_PARTS`] proper boxes inside a region, appended to
    /// `parts`. `wants` is asked once about each box, in their order: by the box's index and its range. The
    /// result is that of [`ranges`](Self::ranges) and then [`narrow`](Self::narrow); a field may share work
    /// of both.
    ///
    /// # Errors
    /// Whatever the evaluation reports.
    fn split(
        &self,
        region: &Self::Region,
        boxes: &[Box3],
        wants: &mut dyn FnMut(usize, Range) -> bool,
        parts: &mut Vec<Self::Region>,
    ) -> Result<(), Self::Error> {
        let mut ranges = [ANYTHING; MAX_PARTS];
        let ranges = &mut ranges[..boxes.len()];
        self.ranges(region, boxes, ranges)?;
        let (_, kept) = wanted(boxes, &mut |lane| wants(lane, ranges[lane]));
        if kept.is_empty() { Ok(()) } else { self.narrow(region, &kept, parts) }
    }
}

/// A list of at most as many as there are parts.
type OfParts<T> = SmallVec<[T; MAX_PARTS]>;

/// The boxes that are wanted, by their indices, with these.
pub(crate) fn wanted(
    boxes: &[Box3],
    wants: &mut dyn FnMut(usize) -> bool,
) -> (OfParts<usize>, OfParts<Box3>) {
    let lanes: OfParts<usize> = (0..boxes.len()).filter(|&lane| wants(lane)).collect();
    let kept = lanes.iter().map(|&lane| boxes[lane]).collect();
    (lanes, kept)
}
