//! Building trees in Rust: constructors for primitives, operators for combinators, postfix methods for
//! everything that has one child.
//!
//! The peanut: two balls that grow together, each with its colour.
//!
//! ```
//! use jbt_model::builder::point;
//! use jbt_model::model::Model;
//! use jbt_model::walk::walk;
//!
//! let red = point([0.0, 0.4, 0.0], 1.0).color([1.0, 0.0, 0.0]);
//! let blue = point([0.0, -0.4, 0.0], 1.0).color([0.0, 0.0, 1.0]);
//! let peanut = Model::new(red + blue).check().unwrap();
//!
//! let sample = walk(&peanut, [0.0, 0.1, 0.0]);
//! assert!((sample.field - 1.294976).abs() < 1e-12);
//! assert!((sample.attributes[0][0] - 0.613892).abs() < 1e-6, "mostly red up here");
//! ```
//!
//! | Rust | node |
//! |---|---|
//! | `a + b`, `Tree::sum([a, b, c])`, `trees.into_iter().sum()` | sum: the plain blend |
//! | `a.ricci(n, &b)`, `Tree::blend(n, [a, b, c])` | Ricci's blend |
//! | `a \| b`, `Tree::union([a, b, c])` | union |
//! | `a & b`, `Tree::intersection([a, b, c])` | intersection |
//! | `a - b`, `Tree::difference([a, b, c])` | difference |
//! | `a ^ b`, `Tree::symmetric_difference([a, b, c])` | symmetric difference |
//! | `a += b`, `\|=`, `&=`, `-=`, `^=` | the same, grown in place |
//! | `!a` | complement |
//! | `Tree::product([a, b])` | product |
//! | `a.smooth_union(width, &b)`, and so on, `Tree::smooth(set, width, [a, b, c])` | smooth set operations |
//! | `Tree::rfunction(set, alpha, [a, b])`, `rfunction_power`, `rfunction_order` | set operations by R-functions |
//! | `a.clamp(low, high)`, `a.shell(thickness)`, `a.offset(by)` | maps of the field |
//! | `Tree::select(which, [a, b, c])` | one of them |
//! | `Tree::expression(0.7 * a.field() * b.field() + x())` | a formula of fields and coordinates |
//!
//! No line here defines `Tree::union`, `Tree::product` and so on: `constructor.rs` makes them of the
//! descriptions (`member!`). `Tree::blend` and `Tree::smooth` are in `operator.rs`, for any number of
//! children.
//!
//! Numbers may be `f64`, `f32` or integers: `point([0, 1, 0], 1)`. Wherever a number is asked for, one that
//! depends on a parameter will do; it can be set again without compiling anything:
//!
//! ```
//! use jbt_model::builder::{param, point};
//! use jbt_model::model::Model;
//!
//! let bulge = param("bulge", 0.6);
//! let drop = point([0.0; 3], &bulge * 2.0) + point((0.0, 0.0, 1.0 + bulge.sqrt()), bulge);
//! let tree = Model::new(drop).check().unwrap();
//! assert_eq!(tree.support().high()[0], 1.2);
//! let fat = tree.with_parameters(&[("bulge", 1.0)]).unwrap();
//! assert_eq!(fat.support().high(), [2.0, 2.0, 3.0]);
//! ```
//!
//! Trees are shared, not copied: `&a + &a` has one leaf under two edges. Anything can be built;
//! [`Model::check`](crate::model::Model::check) says whether it makes sense.

mod argument;
mod attribute;
mod constructor;
mod operator;
mod particles;
mod pattern;
mod place;
mod primitive;

use crate::kind::{NodeKind, Primitive};
use crate::tree::{DEFAULT_ISO, Tree};
use crate::written::{FieldNumber, Written, WrittenFalloff};

use self::argument::{real, vector, vectors};
pub use self::constructor::*;
pub use self::particles::{particles, surface_particles};
pub use self::pattern::Pattern;
use self::primitive::leaf;
pub use self::primitive::{primitive, surface};
pub use crate::axis::Axis;
pub use crate::falloff::Edge;
pub use crate::function::Function;
pub use crate::number::{Number, Rows, Vector, param};
pub use crate::scopes::{ScopeError, Scopes};
pub use crate::term::{Term, x, y, z};

/// Changes of all primitives below.
impl Tree {
    /// The same with this falloff in every primitive: one by its name, or one with parameters, which may
    /// follow those of the model.
    ///
    /// ```
    /// use jbt_model::builder::{Edge, blinn, param, point};
    /// use jbt_model::falloff::Falloff;
    ///
    /// let cubic = point([0.0; 3], 1.0).falloff(Falloff::Wyvill);
    /// let gaussian = point([0.0; 3], 1.0).falloff(blinn(param("hardness", 3.0), 1.0, Edge::Smooth));
    /// ```
    #[must_use]
    pub fn falloff(&self, falloff: impl Into<WrittenFalloff>) -> Self {
        let falloff = falloff.into();
        self.map_written(|written| written.with_falloff(falloff.clone()))
    }

    /// The same with this strength in every primitive; negative ones push surfaces away.
    #[must_use]
    pub fn strength(&self, strength: impl Into<Number>) -> Self {
        let strength = strength.into();
        self.map_written(|written| written.with_strength(strength.clone()))
    }

    /// The same with every primitive, and with particles, written in another way.
    fn map_written(&self, mut change: impl FnMut(Written) -> Written) -> Self {
        self.rewrite(|tree| {
            let written = tree.node().written();
            written.falloff().map(|_| tree.with_written(change(written.clone())))
        })
    }

    /// The same with these radii for every curve and polyline, which become tubes: one for all points, or one
    /// for each. The support radius is measured from the tube.
    ///
    /// ```
    /// use jbt_model::builder::polyline;
    /// use jbt_model::model::Model;
    /// use jbt_model::walk::walk;
    ///
    /// let horn = polyline([[0.0; 3], [5.0, 0.0, 0.0]], 2.0).radii([2.0, 1.0]);
    /// let tree = Model::new(horn).check().unwrap();
    /// // The field is 1 in the tube, and 1/2 at half the support radius from it.
    /// assert_eq!(walk(&tree, [0.0, 1.5, 0.0]).field, 1.0);
    /// assert_eq!(walk(&tree, [-3.0, 0.0, 0.0]).field, 0.5);
    /// ```
    #[must_use]
    pub fn radii(&self, radii: impl IntoIterator<Item = impl Into<Number>>) -> Self {
        self.with_field("radii", &FieldNumber::Reals(radii.into_iter().map(Into::into).collect()))
    }

    /// The same with every curve and polyline, where that may be, led back from the last point to the first.
    #[must_use]
    pub fn closed(&self) -> Self {
        self.with_field("closed", &real(1.0))
    }

    /// The same with another value of a parameter of skeletons, wherever there is one of this name.
    fn with_field(&self, name: &str, value: &FieldNumber) -> Self {
        self.rewrite(|tree| {
            let mut written = tree.node().written().clone();
            let Written::Primitive { skeleton, fields, .. } = &mut written else { return None };
            let index = skeleton.fields().iter().position(|field| field.name == name)?;
            fields[index] = value.clone();
            Some(tree.with_written(written))
        })
    }

    /// The same with every primitive changed; particles stay as they are. Numbers that the change leaves
    /// alone follow their parameters still. The change sees the present values, and the support radius that a
    /// surface radius gives at the usual iso-value; a primitive that has no surface there stays as it is.
    #[must_use]
    pub fn map_primitives(&self, mut change: impl FnMut(&mut Primitive)) -> Self {
        self.rewrite(|tree| {
            let written = tree.node().written();
            if !written.is_primitive() {
                return None;
            }
            let Ok(NodeKind::Primitive(old)) = written.evaluated(DEFAULT_ISO) else { return None };
            let mut leaf = old.clone();
            change(&mut leaf);
            Some(tree.with_written(written.changed(&old, &leaf)))
        })
    }
}

#[cfg(test)]
mod tests;
