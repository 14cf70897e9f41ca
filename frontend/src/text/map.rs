//! Affine maps of a text.

use super::block::{Begun, Head};
use super::lex::Token;
use super::state::Parser;
use super::words::ROTATE;
use crate::diagnostic::{Diagnostic, Span};
use crate::field::Field;
use crate::recipe::{Angle, FieldNumber, Map, Recipe};

impl Parser<'_> {
    /// The block of a map, which has to be one.
    pub(super) fn map(&mut self, start: Token, map: Map) -> Begun {
        if let Err(fault) = map.affine() {
            let span = Span::new(start.start, self.previous_end());
            self.report(|| fault.at(Some(span)));
        }
        self.unary(start, Some(Recipe::Map(map)))
    }

    pub(super) fn rotate(&mut self, start: Token) -> Begun {
        if self.peek().is(b'(') {
            self.expected_at(self.peek(), "expected an axis and an angle: rotate axis z degrees 90 { .. }");
            self.skip_arguments();
            return self.block(start, Head::Broken);
        }
        let mut slots = self.slots(ROTATE, "`rotate`");
        let [axis, degrees, radians] = [0, 1, 2].map(|index| slots.take(index));
        let span = Span::new(start.start, self.previous_end());
        let angle = match (degrees, radians) {
            (Some(FieldNumber::Real(degrees)), None) => Angle::Degrees(degrees),
            (None, Some(FieldNumber::Real(radians))) => Angle::Radians(radians),
            _ => {
                self.lose_place(|| {
                    Diagnostic::error(Some(span), "`rotate` has no angle, or two")
                        .expected("expected one of `degrees` and `radians`")
                });
                return self.block(start, Head::Broken);
            }
        };
        let Some(FieldNumber::Vector(axis)) = axis else {
            self.lose_place(|| {
                Diagnostic::error(Some(span), "`rotate` has no axis")
                    .expected("expected `axis x`, `axis y`, `axis z` or `axis (a b c)`")
            });
            return self.block(start, Head::Broken);
        };
        self.map(start, Map::Rotate { axis, angle })
    }

    /// A map with an axis, and with a number or a vector that says how far.
    pub(super) fn map_along(&mut self, start: Token, fields: &'static [Field], name: &str) -> Begun {
        let values = self.slots(fields, &format!("`{name}`")).complete(self, start, name);
        let mut values = values.into_iter().flatten();
        let map = match (values.next(), values.next()) {
            (Some(FieldNumber::Vector(axis)), None) => Map::Reflect(axis),
            (Some(FieldNumber::Vector(axis)), Some(FieldNumber::Real(by))) => Map::Stretch { axis, by },
            (Some(FieldNumber::Vector(axis)), Some(FieldNumber::Vector(by))) => Map::Shear { axis, by },
            // What was not read, and what the description of these maps does not ask for.
            (Some(FieldNumber::Real(_) | FieldNumber::Reals(_) | FieldNumber::Vectors(_)) | None, _)
            | (Some(FieldNumber::Vector(_)), Some(FieldNumber::Reals(_) | FieldNumber::Vectors(_))) => {
                return self.block(start, Head::Broken);
            }
        };
        self.map(start, map)
    }

    pub(super) fn scale(&mut self, start: Token) -> Begun {
        let map = match self.number_or_elements() {
            None => Map::Scale(f64::NAN.into()),
            Some(all) if all.count == 1 => Map::Scale(all.numbers[0].clone()),
            Some(all) => Map::ScaleAxes(self.sized::<3>(all)),
        };
        self.map(start, map)
    }
}
