//! The same elsewhere, or deformed: affine maps and warps of trees.

use crate::map::MapKind;
use crate::tree::Tree;
use crate::warp::WarpKind;
use crate::written::{FieldNumber, Written};

impl Tree {
    /// This tree, whose root is a warp, with the warp weighted by the field of another tree, between 0 and 1:
    /// where that is 0, the warp does nothing. On any other node it is an error, which the check tells.
    ///
    /// ```
    /// use jbt_model::builder::{Axis, point, segment};
    /// use jbt_model::model::Model;
    /// use jbt_model::walk::walk;
    ///
    /// let bar = segment([-2.0, 0.0, 0.0], [2.0, 0.0, 0.0], 0.5);
    /// // Pulled up by 1 in the middle, where the weight is 1, and not at the ends.
    /// let pulled = bar.deform([0, 0, 1], [0, 0, 1], 0, [1; 3], [0; 3]);
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

    pub(super) fn mapped(&self, map: MapKind, fields: Vec<FieldNumber>) -> Self {
        Self::new(Written::Map { map, fields }, vec![self.clone()])
    }

    pub(super) fn warped(&self, warp: WarpKind, fields: Vec<FieldNumber>) -> Self {
        Self::new(Written::Warp { warp, fields }, vec![self.clone()])
    }
}
