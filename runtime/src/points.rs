//! Points: as planes of x, y and z, and whatever else holds points.

use std::ops::Range;

use jbt_model::origin::ModelOrigin;

/// A point of f32: an array, or a type of another library (features `glam` and `mint`).
pub trait AsPoint {
    /// Its coordinates.
    fn coordinates(&self) -> [f32; 3];
}

impl AsPoint for [f32; 3] {
    fn coordinates(&self) -> [f32; 3] {
        *self
    }
}

/// Points of other libraries, by their coordinates.
#[cfg(any(feature = "glam", feature = "mint"))]
macro_rules! points {
    ($($type:ty)+) => { $(
        impl AsPoint for $type {
            fn coordinates(&self) -> [f32; 3] {
                [self.x, self.y, self.z]
            }
        }
    )+ };
}

#[cfg(feature = "glam")]
points! { glam::Vec3 glam::Vec3A }
#[cfg(feature = "mint")]
points! { mint::Point3<f32> mint::Vector3<f32> }

impl<T: AsPoint + ?Sized> AsPoint for &T {
    fn coordinates(&self) -> [f32; 3] {
        (**self).coordinates()
    }
}

/// Any number of points that can be evaluated as they are: [`Points`], and slices, arrays and vectors of
/// [points](AsPoint).
///
/// Kernels run over planes. Points that are none are brought into planes block by block, on the stack.
pub trait AsPoints: Sync {
    /// Number of points.
    fn count(&self) -> usize;

    /// Writes the coordinates of points from `start` on, as many as a plane is long. The planes are equally
    /// long, and there are as many points.
    fn copy_to(&self, start: usize, planes: [&mut [f32]; 3]);

    /// Where their coordinates count from: the origin of the world, but for [`Points`] about another one.
    fn origin(&self) -> ModelOrigin {
        ModelOrigin::WORLD
    }

    /// The planes of all points, if that is how they are kept: nothing is copied then.
    fn planes(&self) -> Option<[&[f32]; 3]> {
        None
    }
}

impl<T: AsPoint + Sync> AsPoints for [T] {
    fn count(&self) -> usize {
        self.len()
    }

    fn copy_to(&self, start: usize, [x, y, z]: [&mut [f32]; 3]) {
        let points = &self[start..][..x.len()];
        for (((point, x), y), z) in points.iter().zip(x).zip(y).zip(z) {
            [*x, *y, *z] = point.coordinates();
        }
    }
}

impl<T: AsPoint + Sync, const N: usize> AsPoints for [T; N] {
    fn count(&self) -> usize {
        N
    }

    fn copy_to(&self, start: usize, planes: [&mut [f32]; 3]) {
        self.as_slice().copy_to(start, planes);
    }
}

impl<T: AsPoint + Sync> AsPoints for Vec<T> {
    fn count(&self) -> usize {
        self.len()
    }

    fn copy_to(&self, start: usize, planes: [&mut [f32]; 3]) {
        self.as_slice().copy_to(start, planes);
    }
}

impl<P: AsPoints + ?Sized> AsPoints for &P {
    fn count(&self) -> usize {
        (**self).count()
    }

    fn copy_to(&self, start: usize, planes: [&mut [f32]; 3]) {
        (**self).copy_to(start, planes);
    }

    fn origin(&self) -> ModelOrigin {
        (**self).origin()
    }

    fn planes(&self) -> Option<[&[f32]; 3]> {
        (**self).planes()
    }
}

/// Points in space: three planes of equal length, and the origin from which their coordinates count.
///
/// Any f32 may be a coordinate. An infinity counts as the largest finite number of its sign; a point with a
/// NaN has a field that is NaN, which is
/// outside (see [`Evaluator::eval`](crate::Evaluator::eval)).
///
/// ```
/// use jbt::Points;
/// let mut points = Points::from(&[[0.0, 0.1, 0.0], [0.3, 0.0, 0.0]]);
/// points.extend([[1.0, 2.0, 3.0]]);
/// assert_eq!(points.iter().last(), Some([1.0, 2.0, 3.0]));
/// assert_eq!(points.planes()[2], [0.0, 0.0, 3.0]);
/// ```
///
/// They count from the origin of the world, unless they were made [about](Self::about) another one. An
/// evaluator moves points that count from another origin than its model; far away it is better to give it
/// points about its own, which are rounded there:
///
/// ```
/// use jbt::{Evaluator, Model, Query, build::point};
/// let tree = Model::new(point([1e6, 0.0, 0.0], 1.0)).check().unwrap();
/// let evaluator = Evaluator::compile(&tree, Query::FIELD).unwrap();
/// let mut points = evaluator.points();
/// points.push_world([1e6 + 0.7, 0.0, 0.001]);
/// assert_eq!(points.get(0), [0.7, 0.0, 0.001]);
/// let mut samples = evaluator.samples();
/// evaluator.eval(&points, &mut samples).unwrap();
/// let oracle = jbt::walk::walk(&tree, points.world(0)).field;
/// assert!((f64::from(samples.field()[0]) - oracle).abs() < 1e-6);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "Vec<[f32; 3]>", into = "Vec<[f32; 3]>"))]
pub struct Points {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    origin: ModelOrigin,
}

impl Points {
    /// No points.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// No points yet, and room for as many.
    #[must_use]
    pub fn with_capacity(points: usize) -> Self {
        let plane = || Vec::with_capacity(points);
        Self { x: plane(), y: plane(), z: plane(), origin: ModelOrigin::WORLD }
    }

    /// No points; coordinates of those to come count from an origin.
    #[must_use]
    pub fn about(origin: ModelOrigin) -> Self {
        Self { origin, ..Self::default() }
    }

    /// Where their coordinates count from.
    #[must_use]
    pub fn origin(&self) -> ModelOrigin {
        self.origin
    }

    /// The same points, their coordinates counting from another origin: moved in f64 and rounded once.
    #[must_use]
    pub fn moved(&self, origin: ModelOrigin) -> Self {
        let mut moved = Self::about(origin);
        (0..self.len()).for_each(|index| moved.push_world(self.world(index)));
        moved
    }

    /// Points from their planes, which count from the origin of the world.
    ///
    /// # Errors
    /// The lengths, if they differ.
    pub fn from_planes(x: Vec<f32>, y: Vec<f32>, z: Vec<f32>) -> Result<Self, LengthError> {
        if x.len() != y.len() || x.len() != z.len() {
            return Err(LengthError { lengths: [x.len(), y.len(), z.len()] });
        }
        Ok(Self { x, y, z, origin: ModelOrigin::WORLD })
    }

    /// Points from planes of equal length.
    pub(crate) fn from_planes_about(origin: ModelOrigin, [x, y, z]: [Vec<f32>; 3]) -> Self {
        debug_assert!(x.len() == y.len() && x.len() == z.len(), "the planes are equally long");
        Self { x, y, z, origin }
    }

    /// Adds a point of the world: what is left of it from the origin is rounded to f32.
    pub fn push_world(&mut self, point: [f64; 3]) {
        self.push(self.origin.rounded(point));
    }

    /// Adds a point, its coordinates counting from the origin.
    pub fn push(&mut self, point: impl AsPoint) {
        let [x, y, z] = point.coordinates();
        self.x.push(x);
        self.y.push(y);
        self.z.push(z);
    }

    /// Forgets all points, and keeps the memory.
    pub fn clear(&mut self) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// The planes of x, y and z.
    #[must_use]
    pub fn planes(&self) -> [&[f32]; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// Where one point is in the world. Panics if there are not as many.
    #[must_use]
    pub fn world(&self, index: usize) -> [f64; 3] {
        self.origin.world(self.get(index).map(f64::from))
    }

    /// One point, from the origin. Panics if there are not as many.
    #[must_use]
    pub fn get(&self, index: usize) -> [f32; 3] {
        [self.x[index], self.y[index], self.z[index]]
    }

    /// All points, in order, from the origin.
    #[must_use]
    pub fn iter(&self) -> PointsIter<'_> {
        PointsIter { points: self, range: 0..self.len() }
    }
}

impl AsPoints for Points {
    fn count(&self) -> usize {
        self.len()
    }

    fn copy_to(&self, start: usize, planes: [&mut [f32]; 3]) {
        for (plane, own) in planes.into_iter().zip(self.planes()) {
            plane.copy_from_slice(&own[start..][..plane.len()]);
        }
    }

    fn origin(&self) -> ModelOrigin {
        self.origin
    }

    fn planes(&self) -> Option<[&[f32]; 3]> {
        Some(self.planes())
    }
}

impl<T: AsPoint> Extend<T> for Points {
    fn extend<I: IntoIterator<Item = T>>(&mut self, points: I) {
        let points = points.into_iter();
        let room = points.size_hint().0;
        [&mut self.x, &mut self.y, &mut self.z].into_iter().for_each(|plane| plane.reserve(room));
        points.for_each(|point| self.push(point));
    }
}

impl<T: AsPoint> FromIterator<T> for Points {
    fn from_iter<I: IntoIterator<Item = T>>(points: I) -> Self {
        let mut all = Self::new();
        all.extend(points);
        all
    }
}

impl<T: AsPoint> From<&[T]> for Points {
    fn from(points: &[T]) -> Self {
        points.iter().collect()
    }
}

impl<T: AsPoint, const N: usize> From<&[T; N]> for Points {
    fn from(points: &[T; N]) -> Self {
        points.iter().collect()
    }
}

impl<T: AsPoint, const N: usize> From<[T; N]> for Points {
    fn from(points: [T; N]) -> Self {
        points.into_iter().collect()
    }
}

impl<T: AsPoint> From<&Vec<T>> for Points {
    fn from(points: &Vec<T>) -> Self {
        points.iter().collect()
    }
}

impl<T: AsPoint> From<Vec<T>> for Points {
    fn from(points: Vec<T>) -> Self {
        points.into_iter().collect()
    }
}

impl From<Points> for Vec<[f32; 3]> {
    /// The points in the world, rounded there.
    fn from(points: Points) -> Self {
        if points.origin.is_world() {
            return points.iter().collect();
        }
        points.moved(ModelOrigin::WORLD).iter().collect()
    }
}

impl<'a> IntoIterator for &'a Points {
    type Item = [f32; 3];
    type IntoIter = PointsIter<'a>;

    fn into_iter(self) -> PointsIter<'a> {
        self.iter()
    }
}

/// The points of [`Points`], in order.
#[derive(Clone, Debug)]
pub struct PointsIter<'a> {
    points: &'a Points,
    range: Range<usize>,
}

impl Iterator for PointsIter<'_> {
    type Item = [f32; 3];

    fn next(&mut self) -> Option<[f32; 3]> {
        self.range.next().map(|index| self.points.get(index))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.range.size_hint()
    }
}

impl DoubleEndedIterator for PointsIter<'_> {
    fn next_back(&mut self) -> Option<[f32; 3]> {
        self.range.next_back().map(|index| self.points.get(index))
    }
}

impl ExactSizeIterator for PointsIter<'_> {}

/// Planes of different lengths were given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the planes of x, y and z have {}, {} and {} points", lengths[0], lengths[1], lengths[2])]
#[non_exhaustive]
pub struct LengthError {
    /// The lengths of x, y and z.
    pub lengths: [usize; 3],
}
