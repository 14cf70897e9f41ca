//! Particles as instances: the sum of a leaf, or two, that each stand for many rows.
//!
//! What tells the code of points of one node apart is whether they have a strength. So there are at most two
//! *runs*: particles that have one code, and are rows of one table.

use super::find::Finder;
use super::{BindingsId, FieldId, InstanceKind, LeafCode, LeafField, PositionId};
use crate::run::PointRun;
use jbt_model::check::NodeId;
use jbt_model::combine::{OperatorForm, Sum};
use jbt_model::particles::{Particles, PerParticle};
use jbt_model::skeleton::{Skeleton, SkeletonKind};
use jbt_model::written::Written;

impl Finder<'_> {
    /// The instance of particles: the sum of their runs.
    pub(super) fn particles(
        &mut self,
        node: NodeId,
        particles: &Particles,
        position: PositionId,
        bindings: BindingsId,
    ) -> InstanceKind {
        let bindings = self.without_own(particles, bindings);
        let runs = self.runs(node, particles);
        let mut children = Vec::with_capacity(runs.len());
        for (run, strong) in runs {
            let rows = run.len() as u32;
            let field = self.run_field(node, particles, position, (run, strong));
            let computed = self.computed(bindings, (node, rows), position);
            let leaf = InstanceKind::Leaf { field, bindings, computed };
            children.push(self.push(node, position, leaf));
        }
        let operator = Sum {}.into();
        let OperatorForm::Reduce(code) = jbt_model::combine::Combinator::form(operator, false) else {
            unreachable!("a sum is a fold")
        };
        InstanceKind::Reduce { operator, code, children }
    }

    /// The bindings of particles, without groups of which they have values of their own that count.
    fn without_own(&mut self, particles: &Particles, bindings: BindingsId) -> BindingsId {
        if particles.values().is_empty() {
            return bindings;
        }
        self.bound.clear();
        self.bound.extend_from_slice(self.scene.bindings(bindings));
        for (group, bound) in self.scene.tree.attributes().iter().zip(&mut self.bound) {
            let stays = bound.is_some_and(|bound| self.scene.overrides(bound));
            if particles.values_of(&group.name).is_some() && !stays {
                *bound = None;
            }
        }
        self.push_bindings()
    }

    /// Which particles have one code, that of the first one first, and whether their strength is a number of
    /// their rows.
    fn runs(&self, node: NodeId, particles: &Particles) -> Vec<(PointRun, bool)> {
        // There are at most limits::MAX_PARTICLES.
        let all = particles.len() as u32;
        let depends = self.scene.tree.dependent(node).is_some_and(Written::strength_depends_on_parameters);
        let strengths = match particles.strengths() {
            PerParticle::All(strength) => {
                let run = PointRun::all(all, *strength >= 0.0 && !depends);
                return vec![(run, depends || *strength != 1.0)];
            }
            PerParticle::Each(strengths) => strengths,
        };
        let is_strong = |place: usize| strengths.at(place) != 1.0;
        let first = is_strong(0);
        if (1..particles.len()).all(|place| is_strong(place) == first) {
            let non_negative = strengths.iter().all(|strength| strength >= 0.0);
            return vec![(PointRun::all(all, non_negative), first)];
        }
        let run = |strong: bool, places: u32| {
            let chosen: Box<[u32]> = (0..all).filter(|&place| is_strong(place as usize) == strong).collect();
            let non_negative = chosen.iter().all(|&place| strengths.at(place as usize) >= 0.0);
            (PointRun::some(chosen, places, non_negative), strong)
        };
        vec![run(first, 0), run(!first, all)]
    }

    /// The field of a run. It is no other's, whatever is bound above: particles that stand at one place with
    /// different attributes are rows twice.
    fn run_field(
        &mut self,
        node: NodeId,
        particles: &Particles,
        position: PositionId,
        (run, strong): (PointRun, bool),
    ) -> FieldId {
        let written = self.scene.tree.dependent(node);
        let depends = written.is_some_and(Written::falloff_depends_on_parameters);
        let first: Skeleton = particles.point(run.place(0)).into();
        let (map, scale, inverse) = self.scene.position(position).of_skeleton(&first, false);
        let falloff = particles.falloff().code(depends);
        let code = LeafCode { map: inverse, skeleton: SkeletonKind::Point, falloff, strong };
        let run = Some(Box::new(run));
        self.scene.has_runs = true;
        self.scene.fields.push(LeafField { node, position, uses: 1, map, scale, code, run });
        FieldId(self.scene.fields.len() as u32 - 1)
    }
}
