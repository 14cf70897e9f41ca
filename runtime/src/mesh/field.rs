//! What the mesher asks of a field.

use crate::region::Divisible;

/// What the field at a point takes: for counters, and to choose the size of bricks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Work {
    /// Distances to skeletons, or whatever else is worth counting.
    pub evaluations: u64,
    /// Ops: a measure of the time.
    pub ops: u64,
}

/// A field over space, and what it knows of boxes.
///
/// ```text
///     region(lattice)                              what matters in the whole lattice
///       └─ ranges(region, 8 halves) ──► drop those without surface
///          narrow(region, the others) ──► their regions, and so on
///             └─ field, gradient, all(region of a brick, points in it)
/// ```
///
/// All slices of points and answers in one call have the same length, which is at least 1 and otherwise free.
/// The mesher calls from many threads at once. An answer at a point must have the same bits in every region
/// that contains the point, and must not depend on the points beside it; then the mesh does not depend on how
/// the points were grouped.
pub trait Field: Divisible {
    /// The names and widths (1 to 4 reals) of the attributes that [`Field::all`] answers, in its order.
    fn attributes(&self) -> Vec<(String, usize)>;

    /// What the field at a point of a region takes.
    fn work(&self, region: &Self::Region) -> Work;

    /// The field at each point, all of which are in the region's box. Inside is `field >= iso`; NaN is
    /// outside.
    ///
    /// # Errors
    /// Whatever the evaluation reports; the mesher stops and hands it on.
    fn field(
        &self,
        region: &Self::Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
    ) -> Result<(), Self::Error>;

    /// The field and its gradient at each point, to pull vertices onto the surface. The points are in the
    /// region's box.
    ///
    /// # Errors
    /// Whatever the evaluation reports; the mesher stops and hands it on.
    fn gradient(
        &self,
        region: &Self::Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
    ) -> Result<(), Self::Error>;

    /// The field, its gradient and every attribute at each point, all of which are in the region's box. There
    /// is one plane for each real of each attribute, in the order of [`Field::attributes`].
    ///
    /// # Errors
    /// Whatever the evaluation reports; the mesher stops and hands it on.
    // Three coordinates and three kinds of answers, each a plane.
    #[allow(clippy::too_many_arguments)]
    fn all(
        &self,
        region: &Self::Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
        attributes: &mut [&mut [f32]],
    ) -> Result<(), Self::Error>;
}
