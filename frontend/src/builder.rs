//! Building trees in Rust: constructors for primitives, operators for combinators, postfix methods for everything that has one child.
//!
//! The peanut: two balls that grow together, each with its colour.
//!
//! ```
//! use jbt_frontend::builder::point;
//! use jbt_frontend::model::Model;
//! use jbt_frontend::walk::walk;
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
//! | `a + b` | sum: the plain blend |
//! | `a.ricci(n, &b)`, `Tree::blend(n, [a, b, c])` | Ricci's blend |
//! | `a \| b` | union |
//! | `a & b` | intersection |
//! | `a - b` | difference |
//! | `a ^ b` | symmetric difference |
//! | `!a` | complement |
//! | `Tree::product([a, b])` | product |
//! | `a.smooth_union(width, &b)`, and so on, `Tree::smooth(set, width, [a, b, c])` | smooth set operations |
//! | `Tree::rfunction(set, alpha, [a, b])`, `rfunction_power`, `rfunction_order` | set operations by R-functions |
//! | `a.clamp(low, high)`, `a.shell(thickness)`, `a.offset(by)` | maps of the field |
//! | `Tree::select(which, [a, b, c])` | one of them |
//! | `Tree::expression(0.7 * a.field() * b.field() + x())` | a formula of fields and coordinates |
//!
//! Wherever a number is asked for, one that follows a parameter will do; it can be set again without compiling anything:
//!
//! ```
//! use jbt_frontend::builder::{param, point};
//! use jbt_frontend::model::Model;
//!
//! let bulge = param("bulge", 0.6);
//! let drop = point([0.0; 3], &bulge * 2.0) + point((0.0, 0.0, 1.0 + bulge.sqrt()), bulge);
//! let tree = Model::new(drop).check().unwrap();
//! assert_eq!(tree.support().high()[0], 1.2);
//! let fat = tree.with_parameters(&[("bulge", 1.0)]).unwrap();
//! assert_eq!(fat.support().high(), [2.0, 2.0, 3.0]);
//! ```
//!
//! Trees are shared, not copied: `&a + &a` has one leaf under two edges. Anything can be built; [`Model::check`](crate::model::Model::check)
//! says whether it makes sense.

mod falloff;
mod pattern;
mod primitive;

use std::ops::{Add, BitAnd, BitOr, BitXor, Not, Sub};

use glam::DVec3;

use crate::combine::{Combinator, Family, SetOperation};
use crate::field::FieldValue;
use crate::recipe::{
    Angle, AttributeRecipe, FalloffRecipe, FieldNumber, Map, Recipe, TexturedRecipe, UvRecipe,
};
use crate::tree::{NodeKind, Primitive, Tree};
use crate::warp::WarpKind;

pub use self::falloff::{arctan, blanc, blinn, degree, inverse_power};
pub use self::primitive::{
    arc, bezier, catmull_rom, cone, cuboid, cylinder, disc, ellipsoid, half_space, helix, lmetric, point,
    polygon, polyline, primitive, rectangle, ring, round_cone, segment, sphere, superquadric, torus,
    triangle,
};
pub use crate::falloff::Edge;
pub use crate::number::{Number, Vector, param};
pub use crate::term::{Term, x, y, z};
pub use pattern::{Pattern, checker, gradient, marble, noise, rings, stripes};

fn vector(value: impl Into<Vector>) -> FieldNumber {
    FieldNumber::Vector(value.into().0)
}

fn real(value: impl Into<Number>) -> FieldNumber {
    FieldNumber::Real(value.into())
}

fn numbers<T: Into<Number> + Clone>(values: &[T]) -> Vec<Number> {
    values.iter().cloned().map(Into::into).collect()
}

impl Tree {
    /// A combinator over children, in order.
    #[must_use]
    pub fn combine(combinator: Combinator, children: impl IntoIterator<Item = Self>) -> Self {
        Self::new(NodeKind::Combine(combinator), children.into_iter().collect())
    }

    /// An operator whose numbers may follow parameters.
    fn operator(
        combinator: Combinator,
        numbers: impl IntoIterator<Item = Number>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        let numbers = numbers.into_iter().collect();
        Self::of(Recipe::Combine { combinator, numbers }, children.into_iter().collect())
    }

    /// Ricci's blend with exponent `n`: in [1, 1024], where 1 is the sum and large ones are near the union, or in [-1024, -1], near the
    /// intersection.
    #[must_use]
    pub fn blend(n: impl Into<Number>, children: impl IntoIterator<Item = Self>) -> Self {
        Self::operator(Combinator::Ricci(0.0), [n.into()], children)
    }

    /// [`Tree::blend`] of two.
    #[must_use]
    pub fn ricci(&self, n: impl Into<Number>, other: &Self) -> Self {
        Self::blend(n, [self.clone(), other.clone()])
    }

    /// The product of fields, each in units of the iso-value: an intersection that blends.
    #[must_use]
    pub fn product(children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::Product, children)
    }

    /// Union, intersection or difference that rounds where fields differ by less than `width`, in units of the field.
    #[must_use]
    pub fn smooth(
        set: SetOperation,
        width: impl Into<Number>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        Self::operator(Combinator::Smooth(set, 0.0), [width.into()], children)
    }

    /// [`Tree::smooth`] union of two.
    #[must_use]
    pub fn smooth_union(&self, width: impl Into<Number>, other: &Self) -> Self {
        Self::smooth(SetOperation::Union, width, [self.clone(), other.clone()])
    }

    /// [`Tree::smooth`] intersection of two.
    #[must_use]
    pub fn smooth_intersection(&self, width: impl Into<Number>, other: &Self) -> Self {
        Self::smooth(SetOperation::Intersection, width, [self.clone(), other.clone()])
    }

    /// [`Tree::smooth`] difference of two.
    #[must_use]
    pub fn smooth_difference(&self, width: impl Into<Number>, other: &Self) -> Self {
        Self::smooth(SetOperation::Difference, width, [self.clone(), other.clone()])
    }

    /// Union, intersection or difference by R_alpha, with alpha in [-0.9, 1]: 0 is R_0, 1 the maximum or minimum.
    #[must_use]
    pub fn rfunction(
        set: SetOperation,
        alpha: impl Into<Number>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        Self::operator(Combinator::RFunction(set, Family::Alpha(0.0)), [alpha.into()], children)
    }

    /// Union, intersection or difference by R_p, with p in [1.1, 64].
    #[must_use]
    pub fn rfunction_power(
        set: SetOperation,
        power: impl Into<Number>,
        children: impl IntoIterator<Item = Self>,
    ) -> Self {
        Self::operator(Combinator::RFunction(set, Family::Power(0.0)), [power.into()], children)
    }

    /// Union, intersection or difference by R_0^m, which has m continuous derivatives; m is 1 to 4.
    #[must_use]
    pub fn rfunction_order(set: SetOperation, order: u32, children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::RFunction(set, Family::Order(order)), children)
    }

    /// Inside and outside exchanged: `2 iso - f`. It is unbounded.
    #[must_use]
    pub fn complement(&self) -> Self {
        Self::combine(Combinator::Complement, [self.clone()])
    }

    /// The field, but at least `low` and at most `high`.
    #[must_use]
    pub fn clamp(&self, low: impl Into<Number>, high: impl Into<Number>) -> Self {
        let clamp = Combinator::Clamp { low: 0.0, high: 0.0 };
        Self::operator(clamp, [low.into(), high.into()], [self.clone()])
    }

    /// A sheet around the surface; `thickness` is in units of the field and below twice the iso-value.
    #[must_use]
    pub fn shell(&self, thickness: impl Into<Number>) -> Self {
        Self::operator(Combinator::Shell(0.0), [thickness.into()], [self.clone()])
    }

    /// The surface moved to where the field is less than the iso-value by this; outwards if it is positive.
    #[must_use]
    pub fn offset(&self, by: impl Into<Number>) -> Self {
        Self::operator(Combinator::Offset(0.0), [by.into()], [self.clone()])
    }

    /// The child whose place, from 0, is nearest to `which`; the others do not count. `which` is a parameter as a rule.
    ///
    /// ```
    /// use jbt_frontend::builder::{param, point};
    /// use jbt_frontend::model::Model;
    /// use jbt_frontend::tree::Tree;
    ///
    /// let frames = (1..4).map(|size| point([0.0; 3], f64::from(size)));
    /// let tree = Model::new(Tree::select(param("frame", 0.0), frames)).check().unwrap();
    /// let last = tree.with_parameters(&[("frame", 2.0)]).unwrap();
    /// assert_eq!((tree.support().high(), last.support().high()), ([1.0; 3], [3.0; 3]));
    /// ```
    #[must_use]
    pub fn select(which: impl Into<Number>, children: impl IntoIterator<Item = Self>) -> Self {
        Self::of(Recipe::Select(which.into()), children.into_iter().collect())
    }

    /// The same with this falloff in every primitive: one by its name, or one with parameters, which may follow those of the model.
    ///
    /// ```
    /// use jbt_frontend::builder::{Edge, blinn, param, point};
    /// use jbt_frontend::falloff::Falloff;
    ///
    /// let cubic = point([0.0; 3], 1.0).falloff(Falloff::Wyvill);
    /// let gaussian = point([0.0; 3], 1.0).falloff(blinn(param("hardness", 3.0), 1.0, Edge::Smooth));
    /// ```
    #[must_use]
    pub fn falloff(&self, falloff: impl Into<FalloffRecipe>) -> Self {
        let falloff = falloff.into();
        if !falloff.follows() {
            let falloff = falloff.falloff();
            return self.map_primitives(|leaf| leaf.falloff = falloff);
        }
        self.map_recipes(|recipe| recipe.with_falloff(falloff.clone()))
    }

    /// The same with this strength in every primitive; negative ones push surfaces away.
    #[must_use]
    pub fn strength(&self, strength: impl Into<Number>) -> Self {
        let strength = strength.into();
        if !strength.follows() {
            return self.map_primitives(|leaf| leaf.strength = strength.value());
        }
        self.map_recipes(|recipe| recipe.with_strength(strength.clone()))
    }

    /// The same with the recipe of every primitive changed.
    fn map_recipes(&self, mut change: impl FnMut(Recipe) -> Recipe) -> Self {
        self.rewrite(|tree| {
            let recipe = match (tree.node().recipe(), tree.node().kind()) {
                (Some(recipe), NodeKind::Primitive(_)) => Recipe::clone(recipe),
                (None, NodeKind::Primitive(leaf)) => Recipe::of_primitive(leaf),
                (
                    _,
                    NodeKind::Combine(_)
                    | NodeKind::Expression(_)
                    | NodeKind::Select(_)
                    | NodeKind::Affine(_)
                    | NodeKind::Warp(_)
                    | NodeKind::Attribute { .. },
                ) => return None,
            };
            Some(tree.with_recipe(change(recipe)))
        })
    }

    /// The same with these radii for every curve and polyline, which become tubes: one for all points, or one for each. The support radius is
    /// measured from the tube.
    ///
    /// ```
    /// use jbt_frontend::builder::polyline;
    /// use jbt_frontend::model::Model;
    /// use jbt_frontend::walk::walk;
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
            let NodeKind::Primitive(leaf) = tree.node().kind() else { return None };
            let index = leaf.skeleton.kind().fields().iter().position(|field| field.name == name)?;
            let mut recipe = tree
                .node()
                .recipe()
                .map_or_else(|| Recipe::of_primitive(leaf), |recipe| Recipe::clone(recipe));
            if let Recipe::Primitive { fields, .. } = &mut recipe {
                fields[index] = value.clone();
            }
            Some(tree.with_recipe(recipe))
        })
    }

    /// The same with every primitive changed. Numbers that the change leaves alone follow their parameters still.
    #[must_use]
    pub fn map_primitives(&self, mut change: impl FnMut(&mut Primitive)) -> Self {
        self.rewrite(|tree| match tree.node().kind() {
            NodeKind::Primitive(old) => {
                let mut leaf = old.clone();
                change(&mut leaf);
                Some(match tree.node().recipe() {
                    Some(recipe) => tree.with_recipe(recipe.changed(old, &leaf)),
                    None => Self::assemble(NodeKind::Primitive(leaf), None, Vec::new(), tree.node().span()),
                })
            }
            NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. } => None,
        })
    }

    /// Shifted.
    #[must_use]
    pub fn translate(&self, by: impl Into<Vector>) -> Self {
        self.mapped(Map::Translate(by.into().0))
    }

    /// Turned about an axis through the origin, right-handed. Quarter turns are exact.
    #[must_use]
    pub fn rotate(&self, axis: impl Into<Vector>, degrees: impl Into<Number>) -> Self {
        self.mapped(Map::Rotate { axis: axis.into().0, angle: Angle::Degrees(degrees.into()) })
    }

    /// Scaled about the origin.
    #[must_use]
    pub fn scale(&self, by: impl Into<Number>) -> Self {
        self.mapped(Map::Scale(by.into()))
    }

    /// Scaled about the origin, by another factor along each axis; a negative one mirrors.
    #[must_use]
    pub fn scale_axes(&self, by: impl Into<Vector>) -> Self {
        self.mapped(Map::ScaleAxes(by.into().0))
    }

    /// A mirror image in the plane through the origin that is normal to `axis`, of any length.
    #[must_use]
    pub fn reflect(&self, axis: impl Into<Vector>) -> Self {
        self.mapped(Map::Reflect(axis.into().0))
    }

    /// Scaled about the origin along a direction of any length; a negative factor mirrors.
    #[must_use]
    pub fn stretch(&self, axis: impl Into<Vector>, by: impl Into<Number>) -> Self {
        self.mapped(Map::Stretch { axis: axis.into().0, by: by.into() })
    }

    /// Sheared: what is at height h along a direction of any length moves by h times `by`.
    #[must_use]
    pub fn shear(&self, axis: impl Into<Vector>, by: impl Into<Vector>) -> Self {
        self.mapped(Map::Shear { axis: axis.into().0, by: by.into().0 })
    }

    /// Mapped by a 3x4 matrix, given by rows, that takes this tree's space to its parent's: the last column is the shift.
    #[must_use]
    pub fn affine<T: Into<Number>>(&self, rows: [[T; 4]; 3]) -> Self {
        let [[xx, xy, xz, x], [yx, yy, yz, y], [zx, zy, zz, z]] = rows.map(|row| row.map(Into::into));
        self.mapped(Map::Affine(Box::new([xx, xy, xz, x, yx, yy, yz, y, zx, zy, zz, z])))
    }

    fn mapped(&self, map: Map) -> Self {
        Self::of(Recipe::Map(map), vec![self.clone()])
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

    /// Coloured: linear red, green and blue for every leaf below that has no nearer colour.
    #[must_use]
    pub fn color(&self, rgb: impl Into<Vector>) -> Self {
        self.attribute("color", &rgb.into().0)
    }

    /// With an attribute for every leaf below that has no nearer one of this name.
    #[must_use]
    pub fn attribute<T: Into<Number> + Clone>(&self, name: &str, values: &[T]) -> Self {
        self.given(name, AttributeRecipe::Numbers(numbers(values)))
    }

    /// With a pattern of two values for every leaf below: `a` where it is 0, `b` where it is 1, mixed in between. It lies in the space of
    /// this tree: maps of the whole move it, maps below do not.
    ///
    /// ```
    /// use jbt_frontend::builder::{checker, point};
    /// use jbt_frontend::model::Model;
    /// use jbt_frontend::walk::walk;
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
        self.given(name, AttributeRecipe::Textured(TexturedRecipe { texture, fields, a, b }))
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
        self.given(name, AttributeRecipe::Uv(UvRecipe { scale, degrees: degrees.into(), shift }))
    }

    pub(crate) fn given(&self, name: &str, value: AttributeRecipe) -> Self {
        Self::of(Recipe::Attribute { name: name.into(), value }, vec![self.clone()])
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

macro_rules! operators {
    ($($trait:ident $method:ident $combinator:ident),+ $(,)?) => { $(
        operators! { @ Tree, Tree, $trait $method $combinator }
        operators! { @ Tree, &Tree, $trait $method $combinator }
        operators! { @ &Tree, Tree, $trait $method $combinator }
        operators! { @ &Tree, &Tree, $trait $method $combinator }
    )+ };
    (@ $left:ty, $right:ty, $trait:ident $method:ident $combinator:ident) => {
        impl $trait<$right> for $left {
            type Output = Tree;

            fn $method(self, other: $right) -> Tree {
                Tree::combine(Combinator::$combinator, [self.clone(), other.clone()])
            }
        }
    };
}

operators! {
    Add add Sum,
    BitOr bitor Union,
    BitAnd bitand Intersection,
    Sub sub Difference,
    BitXor bitxor SymmetricDifference,
}

impl Not for Tree {
    type Output = Self;

    fn not(self) -> Self {
        self.complement()
    }
}

impl Not for &Tree {
    type Output = Tree;

    fn not(self) -> Tree {
        self.complement()
    }
}

#[cfg(test)]
mod tests;
