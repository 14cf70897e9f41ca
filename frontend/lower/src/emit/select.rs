//! Folds over one row that may not be active: the children of a selector, and what is hoisted though some
//! choices do without it.
//!
//! ```text
//! select a, b, c:   v0 = 0
//!                   v1 = fold table of a, only, from v0: yield a
//!                   v2 = fold table of b, only, from v1: yield b      of the three rows one is active: its answer passes through
//!                   v3 = fold table of c, only, from v2: yield c
//! ```
//!
//! The active row may be left out where its field is zero: then what stands is 0, with attributes that are 0
//! too. No operator looks at the attributes of a field of 0, but the model's own answer does, so the rows of
//! a selector that answers for the whole model always stay.

use jbt_ir::{Domain, Rule, Value};

use super::super::mixing::{Answer, GroupAnswer};
use super::parts::Select;
use super::{Emitter, Task};
use crate::instance::{FieldId, InstanceId, SpaceId};
use crate::shape::Hoist;
use jbt_model::attribute::Mixing;

impl Emitter<'_> {
    /// Leaves the parts of a selector on the tasks.
    pub(super) fn select(&mut self, children: &[InstanceId]) {
        self.tasks.push(Task::FinishSelect);
        for &child in children.iter().rev() {
            self.tasks.extend([Task::CloseChild, Task::Use(child), Task::OpenChild(child)]);
        }
        self.tasks.push(Task::BeginSelect);
    }

    pub(super) fn begin_select(&mut self) {
        let zero = self.builder.constant(0.0);
        let shares = self.mixing.iter().filter(|mixing| **mixing == Mixing::Dominant).count();
        let width = 1 + self.defaults.iter().map(Vec::len).sum::<usize>() + shares;
        self.selects.push(Select { state: vec![zero; width] });
    }

    pub(super) fn open_child(&mut self, id: InstanceId) {
        let state = self.selects.last().expect("children belong to selectors").state.clone();
        let name = self.group_name(id);
        let rule = if self.scene.demand.is_bare(id) { Rule::Never } else { Rule::Neutral };
        self.open_only(&name, self.scene.instance(id).space, rule, &state);
    }

    pub(super) fn close_child(&mut self) {
        let answer = self.answers.pop().expect("the child has been defined");
        let one = self.builder.constant(1.0);
        let mut next = vec![answer.field];
        for (group, mixing) in answer.groups.iter().zip(&*self.mixing) {
            next.extend(&group.channels);
            match mixing {
                Mixing::Blend => {}
                Mixing::Dominant => next.push(group.share.unwrap_or(one)),
            }
        }
        let width = next.len();
        let state = self.close_only(next, width);
        self.selects.last_mut().expect("children belong to selectors").state = state;
    }

    pub(super) fn finish_select(&mut self) {
        let state = self.selects.pop().expect("it was begun").state;
        let mut values = state.into_iter();
        let mut value = || values.next().expect("as many as there are accumulators");
        let field = value();
        let groups = self.defaults.iter().zip(&*self.mixing).map(|(default, mixing)| GroupAnswer {
            channels: default.iter().map(|_| value()).collect(),
            share: match mixing {
                Mixing::Blend => None,
                Mixing::Dominant => Some(value()),
            },
            numbers: false,
        });
        let groups = groups.collect();
        self.answers.push(Answer { field, groups });
    }

    /// The field of a leaf that several instances share.
    pub(super) fn hoist_field(&mut self, field: FieldId) -> Value {
        if !self.guards_hoisted(Hoist::Field(field)) {
            return self.leaf(field);
        }
        let name = self.scene.field(field).code.skeleton.name();
        let space = self.scene.position(self.scene.field(field).position).space;
        // A leaf that is zero keeps its attributes, which are not in here.
        let [value] = self.guarded(name, space, Rule::Neutral, |emitter| [emitter.leaf(field)]);
        value
    }

    /// The point inside a warp that several instances share.
    pub(super) fn hoist_point(&mut self, space: SpaceId) -> [Value; 3] {
        if !self.guards_hoisted(Hoist::Space(space)) {
            return self.point_inside(space);
        }
        let inside = self.scene.inside(space).expect("the world is not hoisted");
        let name = self.scene.warp(inside.warp).name();
        let outside = self.scene.position(inside.position).space;
        // A point is no field: where it is zero says nothing.
        self.guarded(name, outside, Rule::Never, |emitter| emitter.point_inside(space))
    }

    /// Values that are computed in a row of their own; zeros where that is not active.
    fn guarded<const N: usize>(
        &mut self,
        name: &str,
        space: SpaceId,
        rule: Rule,
        compute: impl FnOnce(&mut Self) -> [Value; N],
    ) -> [Value; N] {
        let zero = self.builder.constant(0.0);
        self.open_only(name, space, rule, &[zero; N]);
        let next = compute(self);
        let results = self.close_only(next.to_vec(), N);
        results.try_into().expect("a fold has as many results as accumulators")
    }
}
