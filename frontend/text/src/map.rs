//! Affine maps of a text: what stands behind their words.

use super::block::{Begun, Head};
use super::lex::Token;
use super::state::Parser;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::field::{Field, FieldKind};
use jbt_model::map::MapKind;
use jbt_model::written::{FieldNumber, Written};

impl<'a> Parser<'a> {
    /// The map that begins with this word, which has been taken.
    pub(super) fn map(&mut self, start: Token, word: &str) -> Begun<'a> {
        let kinds: Vec<MapKind> = MapKind::named(word).collect();
        let read = match kinds[..] {
            [kind] => self.only_map(start, kind),
            _ if kinds.iter().all(|kind| kind.is_named()) => self.map_in_units(start, word, &kinds),
            _ => Some(self.number_or_vector(&kinds)),
        };
        let Some((map, fields)) = read else { return self.block(start, Head::Broken) };
        self.unary(start, Some(Written::Map { map, fields }))
    }

    /// What stands behind a word that begins one map; nothing, after a message, if it cannot be read.
    fn only_map(&mut self, start: Token, kind: MapKind) -> Option<(MapKind, Vec<FieldNumber>)> {
        let name = kind.name();
        let fields = match kind.fields() {
            fields if kind.is_named() => {
                self.slots(fields, &format!("`{name}`")).complete(self, start, name)?
            }
            fields => fields.iter().map(|field| self.field_value(field.kind)).collect(),
        };
        Some((kind, fields))
    }

    /// A map by one number, or by three.
    fn number_or_vector(&mut self, kinds: &[MapKind]) -> (MapKind, Vec<FieldNumber>) {
        let of = |one: bool| {
            let is_one = |kind: &&MapKind| kind.fields()[0].kind == FieldKind::Real;
            *kinds.iter().find(|kind| is_one(kind) == one).expect("a map for each")
        };
        match self.number_or_elements() {
            None => (of(true), vec![FieldNumber::Real(f64::NAN.into())]),
            Some(all) if all.count == 1 => (of(true), vec![FieldNumber::Real(all.numbers[0].clone())]),
            Some(all) => (of(false), vec![FieldNumber::Vector(self.sized::<3>(all))]),
        }
    }

    /// A map with an axis, and with an angle in one of several units, which tells the kind.
    fn map_in_units(
        &mut self,
        start: Token,
        word: &str,
        kinds: &[MapKind],
    ) -> Option<(MapKind, Vec<FieldNumber>)> {
        if self.peek().is(b'(') {
            let expected = format!("expected an axis and an angle: {word} axis z degrees 90 {{ .. }}");
            self.expected_at(self.peek(), &expected);
            self.skip_arguments();
            return None;
        }
        let units = kinds.iter().map(|kind| &kind.fields()[1]);
        let fields: Vec<Field> = kinds[0].fields()[..1].iter().chain(units.clone()).cloned().collect();
        let mut slots = self.slots(&fields, &format!("`{word}`"));
        let axis = slots.take(0);
        let mut angles =
            kinds.iter().enumerate().filter_map(|(index, kind)| Some((*kind, slots.take(index + 1)?)));
        let (angle, other) = (angles.next(), angles.next());
        let span = Span::new(start.start, self.previous_end());
        let (Some((kind, angle)), None) = (angle, other) else {
            let names: Vec<String> = units.map(|unit| format!("`{}`", unit.name)).collect();
            self.report_and_mute(|| {
                Diagnostic::error(Some(span), format!("`{word}` has no angle, or two"))
                    .expected(format!("expected one of {}", names.join(" and ")))
            });
            return None;
        };
        let Some(axis) = axis else {
            self.report_and_mute(|| {
                Diagnostic::error(Some(span), format!("`{word}` has no axis"))
                    .expected("expected `axis x`, `axis y`, `axis z` or `axis (a b c)`")
            });
            return None;
        };
        Some((kind, vec![axis, angle]))
    }
}
