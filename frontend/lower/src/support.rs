//! Supports: where an instance's field can be anything but zero, as the compiled program computes it.
//!
//! A leaf's field is zero where its skeleton is farther away than its radius, and so is, outside of a box,
//! whatever is made of leaves. The program computes in f32, so all boxes are inflated by what rounding may
//! do. With `u = 2^-24`, half a unit in the last place of 1:
//!
//! **The map.** A row holds `R = A^-1` and `t = -R a` for a map `p = A q + a`, each number off by u of
//! itself, and the program takes at most three fused steps for a coordinate, each off by u of what it has so
//! far. So coordinate k is off by at most `4.01 u (sum_j |R_kj p_j| + |t_k|)`, for which 6 u stands here; a
//! subtraction is off by less. With `|p| <= |A| |q| + |a|` this is
//!
//! ```text
//! e(q) <= N |q| + n        N = 6 u |R| |A| + |R A - I|        n = 6 u (|R| |a| + |t|) + |R a + t| + 2^-86
//! ```
//!
//! where the second terms are what R, computed in f64, is no inverse of A by, and 2^-86 is more than
//! underflow takes from numbers of a row, times coordinates up to 2^60.
//!
//! **The distance.** It is that of a [`Metric`](jbt_model::skeleton::Metric): it changes by at most S times
//! the length of e, S the steepness, and is computed with the [`ROUNDING`] of skeletons. With the true
//! distance d, the largest coordinates K of the skeleton in its pose, and the half sizes h of a box around
//! the metric's unit ball, `|q_k| <= K_k + d h_k`. So what is computed is at least `d - S |N K + n| - d S |N
//! h| - ROUNDING (|K| + d) - 2^-73`, which grows with d. Of the Euclidean distance, S is 1 and so are all
//! h_k. Where d is at most r, q is in the skeleton grown by r times the unit ball, whose image reaches as far
//! as the metric says.
//!
//! **The falloff.** It is `max(fma(d^2, -1 / r^2 (1 + u), 1), 0)`: zero, with zero slope, as soon as the
//! computed d is `r (1 + u)`. Whatever the falloff is, it is written in that, and is exactly +0 there. The
//! factors of its derivative are bounded by its steepness.
//!
//! All this takes numbers that do not overflow, so there is a bound of the coordinates at which points are
//! asked, [`LARGEST_COORDINATE`], and rows whose numbers could overflow within it are bounded by nothing.

mod inverse;

use glam::{DAffine3, DVec3};
use jbt_ir::watch;
use rustc_hash::FxHashMap as HashMap;

use self::inverse::{HALF_UNIT, Inverse, LinearFacts, absolute};
use super::instance::{FieldId, InstanceId, InstanceKind, PositionId, Scene};
use super::position::{MapKind, Position};
use super::prune_info::{LARGEST_COORDINATE, Support};
use super::rows::ROWS_AT_ONCE;
use super::run::{LeafNumbers, PointRun};
use super::workers::{Workers, in_parts};
use jbt_model::affine::map_bounds;
use jbt_model::bounds::Bounds;
use jbt_model::check::NodeId;
use jbt_model::combine::ReduceCode;
use jbt_model::combine::extent::Extent;
use jbt_model::skeleton::{Metric, ROUNDING, Skeleton};

/// What numbers of the program may grow to: far from overflow, also if three squares of such numbers are
/// added.
const LARGEST_NUMBER: f64 = (1u64 << 60) as f64;
/// What factors of a derivative may grow to.
const LARGEST_FACTOR: f64 = LARGEST_NUMBER * LARGEST_NUMBER;
/// More than any number of f64 that is made of a few others is off by, relative to the largest of them.
const F64_SLACK: f64 = 1.0 / (1u64 << 44) as f64;
/// A root of a sum of squares of this size may lose all its bits to underflow.
const SMALLEST_ROOT: f64 = 1.0 / (1u128 << 73) as f64;
/// More than any falloff changes by, in radii.
const STEEPEST: f64 = (1 << 20) as f64;
/// Where rounding may take more than this part of a length, nothing is promised.
const LARGEST_PART: f64 = 0.25;

/// All points within a distance of a box.
#[derive(Clone, Copy, Debug)]
struct Rounded {
    core: Bounds,
    radius: f64,
}

impl Rounded {
    const EVERYWHERE: Self = Self { core: Bounds::EVERYWHERE, radius: 0.0 };

    fn bounds(self) -> Bounds {
        self.core.grown(self.radius)
    }
}

/// The supports of all instances of a scene, each in the space in which it is asked.
pub(super) struct Supports<'a> {
    scene: &'a Scene<'a>,
    fields: Vec<Rounded>,
    /// Of runs of particles: each by itself, and where all of them can be negative.
    runs: HashMap<FieldId, (Vec<Support>, Bounds)>,
    /// Of leaves whose pieces count near themselves only.
    pieces: HashMap<FieldId, Vec<Rounded>>,
    /// By instance.
    extents: Vec<Extent>,
}

impl<'a> Supports<'a> {
    /// Finds them, children before parents.
    pub(super) fn new(scene: &'a Scene<'a>, workers: &dyn Workers) -> Self {
        let sizes = sizes(scene);
        let (mut pieces, mut runs) = (HashMap::default(), HashMap::default());
        let field = |index| {
            let id = FieldId(index as u32);
            if let Some(run) = &scene.field(id).run {
                let (each, extent) = supports_of_run(scene, (id, run), &sizes, workers);
                runs.insert(id, (each, extent.negative));
                return Rounded { core: extent.support, radius: 0.0 };
            }
            let (field, skeleton) = (scene.field(id), &scene.primitive(id).skeleton);
            let numbers = scene.leaf_numbers(field, 0);
            let facts = LinearFacts::new(field.code.map, &field.map);
            let space = sizes[scene.position(field.position).space.0 as usize];
            let leaf = Leaf::new((skeleton, numbers), (field.map, field.scale, &facts), space);
            if field.code.skeleton.pieces().is_some_and(|pieces| pieces.local) {
                pieces.insert(id, leaf.pieces());
            }
            leaf.whole()
        };
        watch::take(scene.fields.len() * size_of::<Rounded>() + scene.instances.len() * size_of::<Extent>());
        let fields = (0..scene.fields.len()).map(field).collect();
        let mut supports =
            Self { scene, fields, runs, pieces, extents: Vec::with_capacity(scene.instances.len()) };
        for index in 0..scene.instances.len() {
            let extent = supports.find(InstanceId(index as u32));
            // Whatever is empty is empty in every direction, so that it adds nothing to a box around several.
            supports
                .extents
                .push(extent.map(|bounds| if bounds.is_empty() { Bounds::EMPTY } else { bounds }));
        }
        supports
    }

    /// The support of an instance: round for a leaf, a box otherwise.
    pub(super) fn of(&self, id: InstanceId) -> Support {
        match &self.scene.instance(id).kind {
            InstanceKind::Leaf { field, .. } => self.of_field(*field),
            InstanceKind::Warp { .. }
            | InstanceKind::Reduce { .. }
            | InstanceKind::Expression { .. }
            | InstanceKind::Select { .. }
            | InstanceKind::Map { .. }
            | InstanceKind::Difference { .. } => Support::around(self.extents[id.0 as usize].support, 0.0),
        }
    }

    /// The support of a leaf's field.
    pub(super) fn of_field(&self, id: FieldId) -> Support {
        let Rounded { core, radius } = self.fields[id.0 as usize];
        Support::around(core, radius)
    }

    /// The supports of a run's particles, which are asked for once.
    pub(super) fn take_run(&mut self, id: FieldId) -> Vec<Support> {
        self.runs.get_mut(&id).map(|(each, _)| std::mem::take(each)).unwrap_or_default()
    }

    /// Where a piece of a leaf is near enough to count.
    pub(super) fn of_piece(&self, id: FieldId, piece: u32) -> Support {
        let piece = self.pieces.get(&id).map(|pieces| pieces[piece as usize]);
        piece.map_or(Support::EVERYWHERE, |Rounded { core, radius }| Support::around(core, radius))
    }

    fn find(&self, id: InstanceId) -> Extent {
        watch::look();
        let of = |id: &InstanceId| self.extents[id.0 as usize];
        let all = |children: &[InstanceId]| children.iter().map(of).collect::<Vec<_>>();
        let (instance, iso) = (self.scene.instance(id), self.scene.tree.iso());
        match &instance.kind {
            InstanceKind::Leaf { field, .. } => {
                let support = self.fields[field.0 as usize].bounds();
                if let Some(&(_, negative)) = self.runs.get(field) {
                    return Extent { support, negative };
                }
                let signed = self.scene.primitive(*field).strength < 0.0;
                Extent { support, negative: if signed { support } else { Bounds::EMPTY } }
            }
            InstanceKind::Warp { position, child, weight: Some(weight), .. } => {
                let position = self.scene.position(*position);
                of(child).map(|bounds| around_map(position, bounds)).weighted(&of(weight))
            }
            InstanceKind::Warp { position, inside, child, weight: None } => {
                let warp = self.scene.warp(self.scene.insides[inside.0 as usize - 1].warp);
                let position = self.scene.position(*position);
                of(child).map(|bounds| around_map(position, warp.reach(bounds)))
            }
            InstanceKind::Reduce { operator, children, .. } => operator.extent(&all(children), iso),
            InstanceKind::Difference { left, .. } => of(left),
            InstanceKind::Map { child, .. } => self.scene.combinator(instance.node).extent(&[of(child)], iso),
            InstanceKind::Expression { position, shift, children, .. } => {
                let support = self.of_expression(instance.node, (*position, *shift), &all(children));
                let negative = if instance.non_negative { Bounds::EMPTY } else { support };
                Extent { support, negative }
            }
            InstanceKind::Select { children, chosen } => of(&children[*chosen]),
        }
    }

    /// Where a formula's field can be something else than zero.
    fn of_expression(
        &self,
        node: NodeId,
        (position, shift): (PositionId, DVec3),
        children: &[Extent],
    ) -> Bounds {
        let reach = if self.scene.vanishes(node) {
            children.iter().fold(Bounds::EMPTY, |all, child| all.hull(child.support))
        } else {
            Bounds::EVERYWHERE
        };
        match self.scene.expression(node).bounds() {
            None => reach,
            // The program compares with these sides as they are in f32.
            Some(bounds) => {
                let Bounds { min, max } = bounds.moved(-shift);
                let sides = Bounds::new(min.as_vec3().as_dvec3(), max.as_vec3().as_dvec3());
                around_map(self.scene.position(position), sides).intersection(reach)
            }
        }
    }
}

/// How large the numbers of a space may become.
#[derive(Clone, Copy)]
struct Sizes {
    /// A bound of coordinates, in magnitude.
    coordinates: f64,
    /// A bound of the sum of a coordinate's derivatives along the axes of the world, in magnitude.
    derivatives: f64,
}

/// The sizes of all spaces, the world first. A space comes after the one in which its warp stands.
fn sizes(scene: &Scene<'_>) -> Vec<Sizes> {
    let mut slopes = None;
    let mut sizes = vec![Sizes { coordinates: f64::from(LARGEST_COORDINATE), derivatives: 1.0 }];
    for inside in &scene.insides {
        let position = scene.position(inside.position);
        let outer = sizes[position.space.0 as usize].after(&Inverse::new(position.kind(), &position.map));
        let growth = scene.warp(inside.warp).growth(outer.coordinates);
        let (mut coordinates, mut derivatives) = (growth.coordinates, outer.derivatives * growth.derivatives);
        if let Some(weight) = inside.weight {
            // The way from a point to where it is taken, and as it moves with the weight.
            let slope = slopes.get_or_insert_with(|| slopes_of(scene))[weight.0 as usize];
            coordinates += outer.coordinates;
            derivatives +=
                2.0 * outer.derivatives + coordinates * slope * sizes[position.space.0 as usize].derivatives;
        }
        // What is too large stays so, whatever a map behind it does.
        let fits = outer.coordinates <= LARGEST_NUMBER && derivatives <= LARGEST_FACTOR;
        let coordinates = if fits { coordinates } else { f64::INFINITY };
        sizes.push(Sizes { coordinates, derivatives });
    }
    sizes
}

/// Bounds of how fast the fields of instances change in their space, far above what they do: they are there
/// to exclude overflow.
fn slopes_of(scene: &Scene<'_>) -> Vec<f64> {
    let mut slopes: Vec<f64> = Vec::with_capacity(scene.instances.len());
    for instance in &scene.instances {
        let of = |id: &InstanceId| slopes[id.0 as usize];
        let slope = match &instance.kind {
            InstanceKind::Leaf { field, .. } => {
                let leaf = scene.field(*field);
                let rows = absolute(leaf.code.map.inverse(&leaf.map).matrix3) * DVec3::ONE;
                let slope = |metric: f64, place: usize| {
                    let LeafNumbers { radius, strength, .. } = scene.leaf_numbers(leaf, place);
                    STEEPEST * strength.abs() * rows.max_element() * metric / (leaf.scale * radius)
                };
                match &leaf.run {
                    None => slope(scene.primitive(*field).skeleton.metric().steepness(), 0),
                    Some(run) => (0..run.len()).map(|number| slope(1.0, run.place(number))).sum(),
                }
            }
            // Behind a warp nothing is known, nor of formulas.
            InstanceKind::Warp { .. } | InstanceKind::Expression { .. } | InstanceKind::Map { .. } => {
                f64::INFINITY
            }
            InstanceKind::Reduce { code: ReduceCode::Step(_), .. } => f64::INFINITY,
            InstanceKind::Reduce { code: ReduceCode::Fold(code), .. } if code.is_steep() => f64::INFINITY,
            InstanceKind::Reduce { code: ReduceCode::Fold(_) | ReduceCode::Choice(_), children, .. }
            | InstanceKind::Select { children, .. } => children.iter().map(of).sum(),
            InstanceKind::Difference { left, right } => of(left) + of(right),
        };
        slopes.push(slope);
    }
    slopes
}

impl Sizes {
    /// The sizes behind a map; twice what it is without rounding.
    fn after(self, inverse: &Inverse) -> Self {
        let sums = absolute(inverse.back.matrix3) * DVec3::ONE;
        let shifts = inverse.back.translation.abs();
        Self {
            coordinates: 2.0 * (self.coordinates * sums + shifts).max_element(),
            derivatives: 2.0 * self.derivatives * sums.max_element(),
        }
    }
}

/// The supports of a run's particles, and where all of them are.
fn supports_of_run(
    scene: &Scene<'_>,
    (id, run): (FieldId, &PointRun),
    sizes: &[Sizes],
    workers: &dyn Workers,
) -> (Vec<Support>, Extent) {
    let field = scene.field(id);
    let particles = scene.particles(field.node);
    let facts = LinearFacts::new(field.code.map, &field.map);
    let space = sizes[scene.position(field.position).space.0 as usize];
    watch::take(run.len() * size_of::<Support>());
    let mut supports = vec![Support::EVERYWHERE; run.len()];
    let nothing = Extent { support: Bounds::EMPTY, negative: Bounds::EMPTY };
    let parts = in_parts(workers, &mut supports, ROWS_AT_ONCE, |first, part| {
        let mut extent = nothing;
        for (number, support) in (first..).zip(part) {
            let place = run.place(number);
            let skeleton = particles.point(place).into();
            let map = scene.leaf_map(field, place);
            let numbers = scene.leaf_numbers(field, place);
            let rounded = Leaf::new((&skeleton, numbers), (map, field.scale, &facts), space).whole();
            *support = Support::around(rounded.core, rounded.radius);
            extent.support = extent.support.hull(rounded.bounds());
            if numbers.strength < 0.0 {
                extent.negative = extent.negative.hull(rounded.bounds());
            }
        }
        extent
    });
    let both = |all: Extent, part: Extent| Extent {
        support: all.support.hull(part.support),
        negative: all.negative.hull(part.negative),
    };
    (supports, parts.into_iter().fold(nothing, both))
}

/// A leaf, and how far its field reaches from its skeleton.
struct Leaf<'a> {
    skeleton: &'a Skeleton,
    /// Of its support.
    radius: f64,
    /// From the skeleton's own space to the one in which it is asked.
    map: DAffine3,
    /// How far, along each axis of that space; nothing, if that is not known.
    reach: Option<Reach>,
}

/// How far a field reaches from a box around its skeleton.
enum Reach {
    /// From a box that is grown by the one, in all directions alike by the other.
    Round(f64, f64),
    /// Along each axis.
    Axes(DVec3),
}

impl<'a> Leaf<'a> {
    /// A skeleton with its numbers, under the map from its pose, in which it is so many times as large, in a
    /// space of these sizes.
    fn new(
        (skeleton, numbers): (&'a Skeleton, LeafNumbers<'_>),
        (map, scale, facts): (DAffine3, f64, &LinearFacts),
        sizes: Sizes,
    ) -> Self {
        let map = &map;
        let radius = scale * numbers.radius;
        let slope = radius.powi(-2);
        let inverse = facts.inverse(map);
        let unposed = match skeleton {
            // Without an inverse, because there are many of them.
            Skeleton::Point(point) => DAffine3::from_translation(-point.at),
            posed => posed.pose().inverse(),
        };
        let to_pose = DAffine3::from_scale(DVec3::splat(scale)) * unposed;
        let pose = skeleton.bounds_under(&to_pose);
        let size = pose.min.abs().max(pose.max.abs());
        let whole = *map * to_pose;

        let asked = sizes.after(&inverse);
        let factor = slope * numbers.strength.abs().max(1.0) * numbers.falloff.steepness();
        let (metric, nearness) = (skeleton.metric(), radius.recip().max(1.0));
        let steepness = metric.steepness();
        // Terms of a norm have their weights, and the largest of them, as divisors.
        let weights = if metric == Metric::EUCLIDEAN {
            0.0
        } else {
            factor * steepness.max(1.0).powi(2) * asked.coordinates.max(1.0) * nearness
        };
        let divisors = nearness.powi(skeleton.kind().divisors() - 1) / SMALLEST_ROOT;
        let small = slope >= f64::from(f32::MIN_POSITIVE)
            && asked.coordinates * steepness.max(1.0) <= LARGEST_NUMBER
            && weights <= LARGEST_FACTOR
            && asked.derivatives * asked.coordinates <= LARGEST_FACTOR
            // A derivative of a distance from an axis has that distance as its divisor.
            && factor * size.max_element() * divisors <= LARGEST_FACTOR
            && factor * asked.coordinates <= LARGEST_FACTOR;
        let part = steepness * (inverse.relative * metric.half()).length() + ROUNDING;
        // Written so that a NaN is no promise either.
        if !(small && part <= LARGEST_PART) {
            return Self { skeleton, radius: numbers.radius, map: whole, reach: None };
        }
        let lost = steepness * (inverse.relative * size + inverse.fixed).length()
            + ROUNDING * size.max_element()
            + SMALLEST_ROOT;
        let reach = (radius * (1.0 + 4.0 * HALF_UNIT) + lost) / (1.0 - part);

        let own = skeleton.bounds();
        let own = scale * own.min.abs().max(own.max.abs()).max_element();
        let slack = F64_SLACK
            * (2.0 * facts.longest * (own + reach * metric.half().max_element())
                + map.translation.abs().max_element());
        let reach = if facts.rigid && metric == Metric::EUCLIDEAN {
            Reach::Round(slack, reach * (1.0 + 1e-10))
        } else {
            Reach::Axes(slack + reach * metric.reach(map.matrix3))
        };
        Self { skeleton, radius: numbers.radius, map: whole, reach: Some(reach) }
    }

    /// The support of the field.
    fn whole(&self) -> Rounded {
        self.around(self.skeleton.bounds_under(&self.map))
    }

    /// The support of each piece: where it is near enough to count.
    fn pieces(&self) -> Vec<Rounded> {
        let pieces = self.skeleton.piece_bounds_under(self.radius, &self.map);
        pieces.into_iter().map(|piece| self.around(piece)).collect()
    }

    /// What is in reach of a part of the skeleton in this box.
    fn around(&self, part: Bounds) -> Rounded {
        match self.reach {
            None => Rounded::EVERYWHERE,
            Some(Reach::Round(slack, radius)) => Rounded { core: part.grown(slack), radius },
            Some(Reach::Axes(reach)) => {
                Rounded { core: Bounds::new(part.min - reach, part.max + reach), radius: 0.0 }
            }
        }
    }
}

/// A box such that the program takes no point outside of it into `bounds`, by the inverse of a position's
/// map.
fn around_map(position: &Position, bounds: Bounds) -> Bounds {
    if bounds.is_empty() {
        return Bounds::EMPTY;
    }
    let (map, kind) = (&position.map, position.kind());
    if kind == MapKind::Identity {
        return bounds;
    }
    let inverse = Inverse::new(kind, map);
    // Where the computed point is in the box, the true one is within e of it: e <= part (size + e) + fixed.
    let size = bounds.min.abs().max(bounds.max.abs()).max_element();
    let part = (inverse.relative * DVec3::ONE).max_element();
    if !(size.is_finite() && part <= LARGEST_PART) {
        return Bounds::EVERYWHERE;
    }
    let error = (part * size + inverse.fixed.max_element()) / (1.0 - part);
    let image = map_bounds(map, bounds.grown(error));
    let sums = absolute(map.matrix3) * DVec3::splat(size + error) + map.translation.abs();
    image.grown(F64_SLACK * sums.max_element())
}
