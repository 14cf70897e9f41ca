//! Folds over one row that may not be active: the children of a selector.
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

use jbt_ir::{Domain, Rule};

use super::{Emitter, Task};
use crate::mixing::{Answer, GroupAnswer};
use crate::recipe::RowPlace;
use jbt_model::attribute::Mixing;

impl Emitter<'_> {
    /// A selector: its accumulators, and what is to be done for its children.
    pub(super) fn select(&mut self, place: RowPlace) {
        self.tasks.push(Task::FinishSelect);
        for child in self.operands(place).rev() {
            self.tasks.extend([Task::CloseChild, Task::Use(RowPlace::ROW), Task::OpenChild(child)]);
        }
        let zero = self.builder.constant(0.0);
        let shares = self.mixing.iter().filter(|mixing| **mixing == Mixing::Dominant).count();
        let width = 1 + self.defaults.iter().map(Vec::len).sum::<usize>() + shares;
        self.selects.push(vec![zero; width]);
    }

    pub(super) fn open_child(&mut self, place: RowPlace) {
        let state = self.selects.last().expect("children belong to selectors").clone();
        let is_bare = self.scene.demand.is_bare(self.at(place).instance());
        self.open_only(place, if is_bare { Rule::Never } else { Rule::Neutral }, &state);
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
        *self.selects.last_mut().expect("children belong to selectors") = state;
    }

    pub(super) fn finish_select(&mut self) {
        let mut values = self.selects.pop().expect("it was begun").into_iter();
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
        self.answers.push(Answer::new(field, groups));
    }
}
