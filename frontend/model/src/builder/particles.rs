//! Particles: the sum of any number of points, from arrays.

use super::Number;
use crate::attribute::Precedence;
use crate::combine::CombinatorKind;
use crate::particles::{NumberArray, ParticleValues, PerParticle};
use crate::tree::Tree;
use crate::word::normalized;
use crate::written::{ParticleRadius, Written, WrittenParticles};

/// The sum of points at these places, as one node: the same field, bit for bit, as that of a sum of `point`s
/// in this order. Each is the soft object's ball of strength 1 at first, whose field reaches zero at
/// `support_radius`: one number for all, or one for each.
///
/// Arrays are taken as they are, f32 or f64, and shared; see [`NumberArray`] for what is one.
///
/// ```
/// use jbt_model::builder::{particles, point};
/// use jbt_model::model::Model;
/// use jbt_model::tree::Tree;
/// use jbt_model::walk::walk;
///
/// let places = vec![[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0]];
/// let cloud = particles(places, vec![1.0_f32, 2.0]).colors(vec![[1.0_f32, 0.0, 0.0], [0.0, 0.0, 1.0]]);
/// let tree = Model::new(cloud.falloff(jbt_model::falloff::Falloff::Wyvill)).check().unwrap();
/// assert_eq!(tree.nodes().len(), 1);
/// assert_eq!(tree.support().high(), [3.0, 2.0, 2.0]);
/// assert_eq!(walk(&tree, [2.5, 0.0, 0.0]).attributes[0], [0.0, 0.0, 1.0], "nothing but the second one");
///
/// let written_out = Tree::sum([point([0.0; 3], 1.0), point([1.0, 0.0, 0.0], 2.0)]);
/// assert_eq!(particles([[0.0; 3], [1.0, 0.0, 0.0]], vec![1.0, 2.0]).as_points(), written_out);
/// ```
#[must_use]
pub fn particles(positions: impl Into<NumberArray>, support_radius: impl Into<PerParticle<Number>>) -> Tree {
    let radius = ParticleRadius::Support(support_radius.into());
    Tree::new(WrittenParticles::new(positions, radius), Vec::new())
}

/// As [`particles`], with the radius at which each alone meets the iso-value of the model: of balls that
/// somebody sees, such as atoms.
#[must_use]
pub fn surface_particles(
    positions: impl Into<NumberArray>,
    surface_radius: impl Into<PerParticle<Number>>,
) -> Tree {
    let radius = ParticleRadius::Surface(surface_radius.into());
    Tree::new(WrittenParticles::new(positions, radius), Vec::new())
}

/// Changes of all particles below.
impl Tree {
    /// The same with these strengths of particles, wherever there are any: one for each.
    /// ([`strength`](Self::strength) gives all primitives one.)
    #[must_use]
    pub fn strengths(&self, strengths: impl Into<NumberArray>) -> Self {
        let strengths = strengths.into();
        self.map_particles(|particles| WrittenParticles {
            strength: PerParticle::Each(strengths.clone()),
            ..particles
        })
    }

    /// The same with these colours of particles: linear red, green and blue for each.
    /// ([`color`](Self::color) gives all leaves below one.)
    #[must_use]
    pub fn colors(&self, rgb: impl Into<NumberArray>) -> Self {
        self.values("color", 3, rgb)
    }

    /// The same with these values of particles in an attribute group of this width: so many numbers for each,
    /// one particle after the other. ([`attribute`](Self::attribute) gives all leaves below the same.)
    #[must_use]
    pub fn values(&self, name: &str, width: usize, numbers: impl Into<NumberArray>) -> Self {
        let values = ParticleValues { name: normalized(name).into(), width, numbers: numbers.into() };
        self.map_particles(|particles| particles.with_values(values.clone()))
    }

    /// The same, but each particle is a node: a sum of points instead of each node of particles. A million of
    /// them take a second and a gigabyte. Panics if arrays have other lengths than they should.
    #[must_use]
    pub fn as_points(&self) -> Self {
        self.rewrite(|tree| {
            let Written::Particles(particles) = tree.node().written() else { return None };
            let point = |(written, values): (Written, Vec<_>)| {
                let leaf = Self::new(written, Vec::new());
                let give = |tree: Self, (name, value): (std::sync::Arc<str>, _)| {
                    Self::new(Written::Attribute { name, value, precedence: Precedence::Nearest }, vec![tree])
                };
                values.into_iter().fold(leaf, give)
            };
            let points = particles.points().into_iter().map(point);
            Some(Self::operator(CombinatorKind::Sum, Vec::new(), points))
        })
    }

    fn map_particles(&self, mut change: impl FnMut(WrittenParticles) -> WrittenParticles) -> Self {
        self.rewrite(|tree| match tree.node().written() {
            Written::Particles(particles) => Some(tree.with_written(change((**particles).clone()).into())),
            Written::Primitive { .. }
            | Written::Combine { .. }
            | Written::Expression(_)
            | Written::Select(_)
            | Written::Map { .. }
            | Written::Warp { .. }
            | Written::FormulaWarp(_)
            | Written::Attribute { .. }
            | Written::Constant { .. } => None,
        })
    }
}
