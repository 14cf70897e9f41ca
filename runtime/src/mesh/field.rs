//! The interface of a field to the mesher.

use smallvec::SmallVec;

use crate::boxes::Divisible;

/// Planes of attributes, one for each channel, as [`Field::all`] takes them: in no memory of their own if
/// they are as few as most models have.
pub(crate) type AttributePlanes<'a> = SmallVec<[&'a mut [f32]; 8]>;

/// The cost of the field at a point: for counters, and to choose the size of bricks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct FieldWork {
    /// Evaluations of distances to skeletons, or another count of the field's choice.
    pub evaluations: u64,
    /// Ops: a measure of the time.
    pub ops: u64,
}

/// A field over space, with ranges and regions of boxes.
///
/// ```text
///     region(lattice)                              what matters in the whole lattice
///       └─ split(region, 8 halves)             those without surface are dropped, by their ranges;
///          │                                   the others have regions, and so on
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

    /// The cost of the field at a point of a region.
    fn work(&self, region: &Self::Region) -> FieldWork;

    /// Whether the surface may have edges and corners: whether [`decided`](Self::decided) tells crossings
    /// apart. By default it has none.
    fn is_sharp(&self) -> bool {
        false
    }

    /// The field, its gradient and its signature at each point: a number that tells which operands decide
    /// about the field there, as the winner of a union. An edge of the surface is where it changes. A field
    /// without edges has one signature.
    ///
    /// # Errors
    /// Any error of the evaluation; the mesher stops and returns it.
    fn decided(
        &self,
        region: &Self::Region,
        [x, y, z]: [&[f32]; 3],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
        signature: &mut [f32],
    ) -> Result<(), Self::Error> {
        signature.fill(0.0);
        self.gradient(region, x, y, z, field, gradient)
    }

    /// The field at each point, all of which are in the region's box. Inside is `field >= iso`; NaN is
    /// outside.
    ///
    /// # Errors
    /// Any error of the evaluation; the mesher stops and returns it.
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
    /// Any error of the evaluation; the mesher stops and returns it.
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
    /// Any error of the evaluation; the mesher stops and returns it.
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
