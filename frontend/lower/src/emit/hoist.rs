//! What is hoisted: computed where its space begins, for all of its uses. What some choices of selectors do
//! without is computed in a row of its own, which may not be active.

use jbt_ir::{Domain as _, Rule, Value};

use super::parts::GuardStart;
use super::{Emitter, Task};
use crate::instance::SpaceId;
use crate::recipe::{Lead, Member, RowPlace};
use crate::shape::Hoist;

impl Emitter<'_> {
    /// Puts what is hoisted to the start of a space on top of the tasks.
    pub(super) fn hoist_all(&mut self, space: SpaceId) {
        for &hoist in self.shapes.hoists(space).iter().rev() {
            let places = self.lead(Lead::Hoisted(hoist));
            self.tasks.extend(places.map(Task::Hoist));
        }
    }

    pub(super) fn hoist(&mut self, place: RowPlace) {
        let Member::Hoisted(hoist) = self.at(place) else { unreachable!("hoists have places of their own") };
        let guarded = self.shapes.guards_hoisted(self.scene, hoist, self.builder.fold_depth());
        match hoist {
            Hoist::Field(field) => {
                // A leaf that is zero keeps its attributes, which are not in here.
                let guard = guarded.then_some(Rule::Neutral);
                let [value] = self.guarded(guard, place, |emitter, leaf| [emitter.leaf(leaf)]);
                self.kept_fields.insert(field, value);
            }
            // If anybody asks for attributes.
            Hoist::Computed(_) if self.groups.is_empty() => {}
            Hoist::Computed(id) => {
                let channels = self.computed(place, id, self.scene.group_of(id));
                self.kept_computed.insert(id, channels);
            }
            Hoist::Space(space) => {
                // A point is no field: where it is zero says nothing.
                let point = self.guarded(guarded.then_some(Rule::Never), place, Self::point_inside);
                self.kept_points.insert(space, point);
                self.tasks.push(Task::LeaveSpace);
                self.enter_space(space, point);
            }
            Hoist::Instance(id) if guarded => {
                self.tasks.extend([Task::Keep(id), Task::CloseGuard(None), Task::Use(RowPlace::ROW)]);
                self.tasks.push(Task::OpenGuard(place, GuardStart::Zero));
            }
            Hoist::Instance(id) => self.tasks.extend([Task::Keep(id), Task::Use(place)]),
        }
    }

    /// Values that are computed here, or under a guard with this rule; zeros where its row is not active.
    fn guarded<const N: usize>(
        &mut self,
        guard: Option<Rule>,
        place: RowPlace,
        compute: impl FnOnce(&mut Self, RowPlace) -> [Value; N],
    ) -> [Value; N] {
        let Some(rule) = guard else { return compute(self, place) };
        let zero = self.builder.constant(0.0);
        self.open_only(place, rule, &[zero; N]);
        let next = compute(self, RowPlace::ROW);
        let results = self.close_only(next.to_vec(), N);
        results.try_into().expect("a fold has as many results as accumulators")
    }
}
