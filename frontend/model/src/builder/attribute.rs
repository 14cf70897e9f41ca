//! Attributes of trees: numbers, patterns and the uv of skeletons.

use super::{Number, Pattern, Vector};
use crate::attribute::Precedence;
use crate::constant::LeafConstant;
use crate::tree::Tree;
use crate::word::normalized;
use crate::written::{Written, WrittenAttribute, WrittenTextured, WrittenUv};

fn numbers<T: Into<Number> + Clone>(values: &[T]) -> Vec<Number> {
    values.iter().cloned().map(Into::into).collect()
}

impl Tree {
    /// Coloured: linear red, green and blue for every leaf below that has no nearer colour.
    #[must_use]
    pub fn color(&self, rgb: impl Into<Vector>) -> Self {
        self.attribute("color", &rgb.into().0)
    }

    /// With an attribute for every leaf below that has no nearer one of this name.
    #[must_use]
    pub fn attribute<T: Into<Number> + Clone>(&self, name: &str, values: &[T]) -> Self {
        self.given(name, WrittenAttribute::Numbers(numbers(values)))
    }

    /// With a constant for every leaf below that has no nearer one of this name: text or a whole number, as a
    /// material or the number of a part. The [owner](crate::owner::Owner::constants) of a point answers it.
    #[must_use]
    pub fn constant(&self, name: &str, value: impl Into<LeafConstant>) -> Self {
        let (name, value) = (normalized(name).into(), value.into());
        let written = Written::Constant { name, value, precedence: Precedence::Nearest };
        Self::new(written, vec![self.clone()])
    }

    /// With a pattern of two values for every leaf below: `a` where it is 0, `b` where it is 1, mixed in
    /// between. It lies in the space of this tree: maps of the whole move it, maps below do not.
    ///
    /// ```
    /// use jbt_model::builder::{checker, point};
    /// use jbt_model::model::Model;
    /// use jbt_model::walk::walk;
    ///
    /// let ball = point([0.0; 3], 1.0).textured("color", checker(0.5), &[1.0, 0.0, 0.0], &[0.0, 0.0, 1.0]);
    /// let tree = Model::new(ball.translate([5.0, 0.0, 0.0])).check().unwrap();
    /// assert_eq!(walk(&tree, [5.1, 0.1, 0.1]).attributes[0], [1.0, 0.0, 0.0]);
    /// assert_eq!(walk(&tree, [4.9, 0.1, 0.1]).attributes[0], [0.0, 0.0, 1.0]);
    /// ```
    #[must_use]
    pub fn textured<T: Into<Number> + Clone>(&self, name: &str, pattern: Pattern, a: &[T], b: &[T]) -> Self {
        let Pattern { texture, fields } = pattern;
        let (a, b) = (numbers(a), numbers(b));
        self.given(name, WrittenAttribute::Textured(WrittenTextured { texture, fields, a, b }))
    }

    /// With the uv of its skeleton for every leaf below, in a group of two reals: see
    /// [`SkeletonMember::uv`](crate::skeleton::SkeletonMember::uv).
    #[must_use]
    pub fn uv(&self, name: &str) -> Self {
        self.uv_mapped(name, [1.0; 2], 0.0, [0.0; 2])
    }

    /// [`Tree::uv`], scaled, then turned about (0, 0), then shifted.
    #[must_use]
    pub fn uv_mapped<T: Into<Number>>(
        &self,
        name: &str,
        scale: [T; 2],
        degrees: impl Into<Number>,
        shift: [T; 2],
    ) -> Self {
        let (scale, shift) = (scale.map(Into::into), shift.map(Into::into));
        self.given(name, WrittenAttribute::Uv(WrittenUv { scale, degrees: degrees.into(), shift }))
    }

    pub(crate) fn given(&self, name: &str, value: WrittenAttribute) -> Self {
        let written =
            Written::Attribute { name: normalized(name).into(), value, precedence: Precedence::Nearest };
        Self::new(written, vec![self.clone()])
    }
}
