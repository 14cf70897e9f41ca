//! The same elsewhere, or deformed: affine maps and warps of trees.

use glam::DVec3;

use super::{Number, Rows, Vector, real, vector};
use crate::field::FieldValue;
use crate::map::MapKind;
use crate::recipe::{FieldNumber, Recipe};
use crate::tree::Tree;
use crate::warp::WarpKind;

impl Tree {
    /// Shifted.
    #[must_use]
    pub fn translate(&self, by: impl Into<Vector>) -> Self {
        self.mapped(MapKind::Translate, vec![vector(by)])
    }

    /// Turned about an axis through the origin, right-handed. Quarter turns are exact.
    #[must_use]
    pub fn rotate(&self, axis: impl Into<Vector>, degrees: impl Into<Number>) -> Self {
        self.mapped(MapKind::RotateDegrees, vec![vector(axis), real(degrees)])
    }

    /// Scaled about the origin.
    #[must_use]
    pub fn scale(&self, by: impl Into<Number>) -> Self {
        self.mapped(MapKind::Scale, vec![real(by)])
    }

    /// Scaled about the origin, by another factor along each axis; a negative one mirrors.
    #[must_use]
    pub fn scale_axes(&self, by: impl Into<Vector>) -> Self {
        self.mapped(MapKind::ScaleAxes, vec![vector(by)])
    }

    /// A mirror image in the plane through the origin that is normal to `axis`, of any length.
    #[must_use]
    pub fn reflect(&self, axis: impl Into<Vector>) -> Self {
        self.mapped(MapKind::Reflect, vec![vector(axis)])
    }

    /// Scaled about the origin along a direction of any length; a negative factor mirrors.
    #[must_use]
    pub fn stretch(&self, axis: impl Into<Vector>, by: impl Into<Number>) -> Self {
        self.mapped(MapKind::Stretch, vec![vector(axis), real(by)])
    }

    /// Sheared: what is at height h along a direction of any length moves by h times `by`.
    #[must_use]
    pub fn shear(&self, axis: impl Into<Vector>, by: impl Into<Vector>) -> Self {
        self.mapped(MapKind::Shear, vec![vector(axis), vector(by)])
    }

    /// Mapped by a 3x4 matrix, given by rows, that takes this tree's space to its parent's: the last column is the shift.
    #[must_use]
    pub fn affine(&self, rows: impl Into<Rows>) -> Self {
        let rows = rows.into().0.into_iter().flatten().collect();
        self.mapped(MapKind::Affine, vec![FieldNumber::Reals(rows)])
    }

    fn mapped(&self, map: MapKind, fields: Vec<FieldNumber>) -> Self {
        Self::of(Recipe::Map { map, fields }, vec![self.clone()])
    }

    /// Twisted about a coordinate axis through the origin, by `rate` radians for each unit of length, right-handed.
    #[must_use]
    pub fn twist(&self, axis: Axis, rate: impl Into<Number>) -> Self {
        self.warped(WarpKind::Twist(0), vec![axis.field(), real(rate)])
    }

    /// Tapered along a coordinate axis through the origin: between two heights the scale across it goes from `start` to `end`, and stays what it is beyond
    /// them. See [`Taper`](struct@crate::warp::Taper).
    #[must_use]
    pub fn taper<T: Into<Number>, S: Into<Number>>(
        &self,
        axis: Axis,
        [from, to]: [T; 2],
        [start, end]: [S; 2],
    ) -> Self {
        self.warped(WarpKind::Taper(0), vec![axis.field(), real(from), real(to), real(start), real(end)])
    }

    /// Bent about a coordinate axis: the spine, which runs along the axis behind it (y for x, z for y, x for z), turns by `rate` radians for each unit
    /// of length between two places; the origin stays. See [`Bend`](struct@crate::warp::Bend).
    #[must_use]
    pub fn bend<T: Into<Number>>(&self, axis: Axis, rate: impl Into<Number>, [from, to]: [T; 2]) -> Self {
        self.bend_at(axis, rate, [from.into(), to.into()], 0.0)
    }

    /// [`bend`](Self::bend) where another place of the spine stays.
    #[must_use]
    pub fn bend_at<T: Into<Number>>(
        &self,
        axis: Axis,
        rate: impl Into<Number>,
        [from, to]: [T; 2],
        center: impl Into<Number>,
    ) -> Self {
        self.warped(WarpKind::Bend(0), vec![axis.field(), real(rate), real(from), real(to), real(center)])
    }

    /// What is on the positive side of a coordinate plane, on both sides: the plane through the origin across the axis.
    #[must_use]
    pub fn mirror(&self, axis: Axis) -> Self {
        self.warped(WarpKind::Mirror(0), vec![axis.field()])
    }

    /// Copies along a coordinate axis, `spacing` from each to the next, the child being the first of `count`; 0 for no end, to both
    /// sides. See [`Repeat`](struct@crate::warp::Repeat).
    #[must_use]
    pub fn repeat(&self, axis: Axis, spacing: impl Into<Number>, count: impl Into<Number>) -> Self {
        self.warped(WarpKind::Repeat(0), vec![axis.field(), real(spacing), real(count)])
    }

    /// `count` copies about a coordinate axis through the origin, at equal angles. See [`RepeatAround`](struct@crate::warp::RepeatAround).
    #[must_use]
    pub fn repeat_around(&self, axis: Axis, count: impl Into<Number>) -> Self {
        self.warped(WarpKind::RepeatAround(0), vec![axis.field(), real(count)])
    }

    /// Pulled: what is at `from` appears at `to`, and nothing moves that is `radius` or more away from there. See
    /// [`SpaceMap`](struct@crate::warp::SpaceMap).
    #[must_use]
    pub fn space_map(
        &self,
        from: impl Into<Vector>,
        to: impl Into<Vector>,
        radius: impl Into<Number>,
    ) -> Self {
        self.warped(WarpKind::SpaceMap(0), vec![vector(from), vector(to), real(radius)])
    }

    /// Scaled about `center`, turned about an axis through it, and moved: an affine map to be [weighted](Self::weighted). See
    /// [`Deform`](struct@crate::warp::Deform).
    #[must_use]
    pub fn deform(
        &self,
        by: impl Into<Vector>,
        (axis, degrees): (impl Into<Vector>, impl Into<Number>),
        size: impl Into<Vector>,
        center: impl Into<Vector>,
    ) -> Self {
        let fields = vec![vector(by), vector(axis), real(degrees), vector(size), vector(center)];
        self.warped(WarpKind::Deform(0), fields)
    }

    /// This tree, whose root is a warp, with the warp weighted by the field of another tree, between 0 and 1: where that is 0, the warp does
    /// nothing. On any other node it is an error, which the check tells.
    ///
    /// ```
    /// use jbt_frontend::builder::{Axis, point, segment};
    /// use jbt_frontend::model::Model;
    /// use jbt_frontend::walk::walk;
    ///
    /// let bar = segment([-2.0, 0.0, 0.0], [2.0, 0.0, 0.0], 0.5);
    /// // Pulled up by 1 in the middle, where the weight is 1, and not at the ends.
    /// let pulled = bar.deform([0.0, 0.0, 1.0], ([0.0, 0.0, 1.0], 0.0), [1.0; 3], [0.0; 3]);
    /// let weighted = pulled.weighted(&point([0.0, 0.0, 1.0], 1.5));
    /// let tree = Model::new(weighted).check().unwrap();
    /// assert_eq!(walk(&tree, [0.0, 0.0, 1.0]).field, 1.0);
    /// assert_eq!(walk(&tree, [2.0, 0.0, 0.0]).field, 1.0);
    /// ```
    #[must_use]
    pub fn weighted(&self, weight: &Self) -> Self {
        let children = self.node().children().iter().chain([weight]).cloned().collect();
        self.with_children(children)
    }

    fn warped(&self, warp: WarpKind, fields: Vec<FieldNumber>) -> Self {
        Self::of(Recipe::Warp { warp, fields }, vec![self.clone()])
    }
}

/// A coordinate axis.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

impl Axis {
    /// The value of the parameter `axis` of a warp.
    fn field(self) -> FieldNumber {
        FieldValue::Vector(DVec3::AXES[self as usize].to_array()).into()
    }
}
