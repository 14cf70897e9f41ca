//! Formulas: the value of each step from those before it, within bounds, and 0 where it has to be.
//!
//! ```text
//! F      the formula of the point in the node's own space, of the children's fields and of numbers of the row
//! field  min(max(F, lowest), largest) + 0      lowest: 0, if F is never negative, else -largest; a NaN ends there too
//!        0 where all children are 0            if F is 0 there for all points, so that children may be left out
//!        0 outside of the box                  if there is one, so that the row may be left out
//! ```
//!
//! The operands of a union or an intersection of bounded fields, of which nothing but the field is asked, are
//! left open: bounds and +0 change neither which of them is chosen nor what is chosen, so they wait until it
//! is. Only a NaN has to be seen to before, where it would not count as the lowest field: a union passes it
//! over anyway, as far as its start is as low.

use jbt_ir::{Domain, FunctionBuilder, Origin, Value};
use rustc_hash::FxHashSet;

use super::{Emitter, Reduce, Task};
use crate::columns;
use crate::instance::InstanceKind;
use crate::mixing::{Answer, GroupAnswer, weighted};
use crate::recipe::RowPlace;
use crate::slopes::{Tape, slopes};
use jbt_model::combine::{Extreme, ReduceCode};
use jbt_model::expression::{Form, LARGEST_FIELD, Operand};

/// What a union is as code.
const UNION: ReduceCode = ReduceCode::Choice(Extreme::Largest);

/// What a formula is about.
struct Leaves {
    point: Option<[Value; 3]>,
    fields: Vec<Value>,
    numbers: Vec<Value>,
}

impl Leaves {
    fn of(&self, operand: Operand) -> Value {
        match operand {
            Operand::Coordinate(axis) => {
                self.point.expect("a formula with coordinates asks for the point")[axis as usize]
            }
            Operand::Child(child) => self.fields[child as usize],
            Operand::Number(number) => self.numbers[number as usize],
            Operand::Step(_) => unreachable!("a step is no leaf"),
        }
    }
}

/// The same fields, no two of them one value: children that share a field have slopes of their own.
fn distinct(d: &mut FunctionBuilder, mut fields: Vec<Value>) -> Vec<Value> {
    let mut seen = FxHashSet::default();
    for field in &mut fields {
        while !seen.insert(*field) && !d.is_full() {
            // The larger of a number and itself is that number, to the bit, and moves with it.
            *field = d.max(*field, *field);
        }
    }
    fields
}

impl Emitter<'_> {
    /// The answer of a formula whose children have theirs.
    pub(super) fn express(&mut self, place: RowPlace) {
        let instance = self.scene.instance(self.at(place).instance());
        let InstanceKind::Expression { position, children, .. } = &instance.kind else {
            unreachable!("only formulas are expressed")
        };
        let form = self.scene.expression(instance.node).form();
        let answers = self.answers.split_off(self.answers.len() - children.len());
        let point = form.asks_point().then(|| {
            let kind = self.scene.position(*position).kind();
            let row = self.columns(place, columns::map(kind));
            let (_, outer) = *self.points.last().expect("a space is open");
            kind.emit(&mut self.builder, outer, &row)
        });
        let numbers = self.columns(place, columns::formula(form));
        let weighs = !self.mixing.is_empty() && answers.len() > 1;
        let fields: Vec<Value> = answers.iter().map(|answer| answer.field).collect();
        let fields = if weighs { distinct(&mut self.builder, fields) } else { fields };
        let leaves = Leaves { point, fields, numbers };
        let before = self.builder.set_origin(Origin::CREASE);
        let mut tape = Tape::new(&mut self.builder, weighs);
        let value = form.emit(&mut tape, |operand| leaves.of(operand))[0];
        let tape = tape.finish();
        self.builder.set_origin(before);
        let lowest = if instance.non_negative { 0.0 } else { -LARGEST_FIELD };
        let vanishes = self.scene.vanishes(instance.node);
        let field = if !vanishes && !form.bounded && self.leaves_open() {
            self.opened(value, lowest)
        } else {
            self.bounded(value, form, &leaves, lowest, vanishes)
        };
        let groups = match &answers[..] {
            [] => self.leaf_attributes(place),
            [child] => self.passed_on(child),
            _ if weighs => {
                let slopes = slopes(&mut self.builder, &tape, value, &leaves.fields);
                self.weighted_by(&answers, &slopes)
            }
            _ => Vec::new(),
        };
        self.builder.set_origin(Origin::SHARED);
        self.answers.push(Answer::new(field, groups));
    }

    /// Whether what is emitted now is the operand of an operator that keeps it within bounds.
    fn leaves_open(&self) -> bool {
        let Some(Reduce { operator, .. }) = self.reduces.last() else { return false };
        let is_operand = matches!(self.tasks.last(), Some(Task::Meet));
        is_operand && operator.bounded && operator.only_chooses() && self.probes.is_none()
    }

    /// A value as such an operator takes it.
    fn opened(&mut self, value: Value, lowest: f32) -> Value {
        let reduce = self.reduces.last_mut().expect("it is the operand of an operator");
        reduce.open = true;
        let start = if reduce.operator.non_negative { 0.0 } else { -LARGEST_FIELD };
        if reduce.operator.code == UNION && lowest.to_bits() == start.to_bits() {
            return value;
        }
        let lowest = self.builder.constant(lowest);
        self.builder.max(value, lowest)
    }

    /// The field of an operator whose operands were left open.
    pub(super) fn closed(&mut self, code: ReduceCode, field: Value) -> Value {
        let d = &mut self.builder;
        let (zero, largest) = (d.constant(0.0), d.constant(LARGEST_FIELD));
        // An intersection begins with the largest.
        let field = if code == UNION { d.min(field, largest) } else { field };
        d.add(field, zero)
    }

    /// The field of a formula with this value.
    fn bounded(&mut self, value: Value, form: &Form, leaves: &Leaves, lowest: f32, vanishes: bool) -> Value {
        let d = &mut self.builder;
        let (zero, lowest) = (d.constant(0.0), d.constant(lowest));
        let largest = d.constant(LARGEST_FIELD);
        // In this order a NaN gives the lowest.
        let field = d.max(value, lowest);
        let field = d.min(field, largest);
        // No field is -0: sums and unions must not depend on what adds nothing.
        let mut field = d.add(field, zero);
        if vanishes {
            let silent: Vec<Value> = leaves.fields.iter().map(|&field| d.eq(field, zero)).collect();
            // Without children it is the number 0.
            if let Some(all) = silent.into_iter().reduce(|all, one| d.both(all, one)) {
                field = d.select(all, zero, field);
            }
        }
        if let (Some(sides), Some(point)) = (form.box_numbers(&leaves.numbers), leaves.point) {
            // The walls of a box have edges.
            let before = d.set_origin(Origin::CREASE);
            for axis in (0..3).rev() {
                let above = d.le(sides[axis], point[axis]);
                let below = d.le(point[axis], sides[axis + 3]);
                let inside = d.both(above, below);
                field = d.select(inside, field, zero);
            }
            d.set_origin(before);
        }
        field
    }

    /// The attributes of an only child, where it has a field.
    fn passed_on(&mut self, child: &Answer) -> Vec<GroupAnswer> {
        let d = &mut self.builder;
        let zero = d.constant(0.0);
        let silent = d.eq(child.field, zero);
        let groups = child.groups.iter().zip(&self.defaults).map(|(group, default)| {
            let channels = group.channels.iter().zip(default);
            let channels = channels.map(|(&channel, &default)| d.select(silent, default, channel));
            let channels = channels.collect();
            let share = group.share.map(|share| {
                let one = d.constant(1.0);
                d.select(silent, one, share)
            });
            GroupAnswer { channels, share, numbers: false }
        });
        groups.collect()
    }

    /// The attributes of several children, by what they contribute.
    fn weighted_by(&mut self, answers: &[Answer], slopes: &[Value]) -> Vec<GroupAnswer> {
        let d = &mut self.builder;
        let zero = d.constant(0.0);
        let weight = |d: &mut FunctionBuilder, (answer, &slope): (&Answer, &Value)| {
            let product = d.mul(answer.field, slope);
            // A NaN has no weight.
            let positive = d.lt(zero, product);
            d.select(positive, product, zero)
        };
        let weights: Vec<Value> = answers.iter().zip(slopes).map(|pair| weight(d, pair)).collect();
        weighted(d, &self.mixing, answers, &weights, &self.defaults)
    }
}
