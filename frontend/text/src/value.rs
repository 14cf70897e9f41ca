//! Values of parameters: numbers, vectors, axes, words.

use jbt_ir::limits::MAX_SKELETON_POINTS;

use jbt_ir::limits::MAX_ATTRIBUTE_WIDTH;

use super::expression::{ExpressionPlace, ParsedOperand};
use super::lex::TokenKind;
use super::state::Parser;
use super::words::COMMON_FIELDS;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::field::{FieldKind, FieldValue};
use jbt_model::number::Number;
use jbt_model::report::nearest;
use jbt_model::written::FieldNumber;

/// The most elements that a vector may have: those of the widest attribute. A 3x4 matrix has 12.
const LONGEST: usize = MAX_ATTRIBUTE_WIDTH;

/// The elements of a vector.
pub(super) struct Elements {
    /// The first ones, at most [`LONGEST`].
    pub(super) numbers: Vec<Number>,
    /// How many there are.
    pub(super) count: usize,
    pub(super) span: Span,
}

impl Elements {
    fn one(operand: ParsedOperand) -> Self {
        Self { numbers: vec![operand.number], count: 1, span: operand.span }
    }
}

impl Parser<'_> {
    /// `( a b c )`, with blanks or commas between. Nothing after an error.
    pub(super) fn elements(&mut self) -> Option<Elements> {
        let open = self.peek();
        if let Some(all) = self.bound_elements() {
            return Some(all);
        }
        if self.accept(b'(').is_none() {
            self.expected_at(open, "expected a vector: ( .. )");
            return None;
        }
        let mut all = Elements { numbers: Vec::new(), count: 0, span: open.span() };
        while !self.peek().is(b')') {
            if self.vector_is_cut_off() {
                self.report_and_mute(|| Diagnostic::error(Some(open.span()), "this `(` is not closed"));
                return None;
            }
            if all.count > 0 {
                self.accept(b',');
            }
            let element = self.expression(ExpressionPlace::Element);
            if self.is_muted() {
                self.skip_to_close();
                return None;
            }
            all.count += 1;
            if all.count <= LONGEST {
                all.numbers.push(element.number);
            }
        }
        all.span.end = self.next().end as u32;
        Some(all)
    }

    /// A number, or a vector. A vector of one element is a number in parentheses, which an operator may
    /// follow.
    pub(super) fn number_or_elements(&mut self) -> Option<Elements> {
        self.number_or_elements_in(ExpressionPlace::Alone)
    }

    /// The same, in a list as well.
    pub(super) fn number_or_elements_in(&mut self, place: ExpressionPlace) -> Option<Elements> {
        if !self.peek().is(b'(') {
            if let Some(all) = self.bound_elements() {
                return Some(all);
            }
            let operand = self.expression(place);
            return (!self.is_muted()).then(|| Elements::one(operand));
        }
        let all = self.elements()?;
        let [number] = all.numbers.as_slice() else {
            return Some(all);
        };
        let first = ParsedOperand { number: number.clone(), span: all.span };
        let operand = self.expression_from(place, &first);
        (!self.is_muted()).then(|| Elements::one(operand))
    }

    /// Whether what is next belongs to what stands around a vector, so that its `)` must be missing.
    pub(super) fn vector_is_cut_off(&self) -> bool {
        let token = self.peek();
        let brace = token.is(b'{') || token.is(b'}');
        let field = self
            .peek_word()
            .is_some_and(|word| COMMON_FIELDS.contains(&word) && self.parameter(word).is_none());
        brace || field || token.kind == TokenKind::End
    }

    /// Past the `)` of a vector that has an error, if it comes before the end of the block.
    pub(super) fn skip_to_close(&mut self) {
        let mut depth = 0usize;
        loop {
            match self.peek().kind {
                TokenKind::Mark(b'(') => depth += 1,
                TokenKind::Mark(b')') if depth == 0 => {
                    self.next();
                    self.report_again();
                    return;
                }
                TokenKind::Mark(b')') => depth -= 1,
                TokenKind::Mark(b'{' | b'}') | TokenKind::End => return,
                TokenKind::Mark(_)
                | TokenKind::Word
                | TokenKind::Number
                | TokenKind::Quoted
                | TokenKind::Unknown => {}
            }
            self.next();
        }
    }

    /// A vector of `N` elements; NaNs after an error.
    pub(super) fn vector<const N: usize>(&mut self) -> [Number; N] {
        let Some(all) = self.elements() else {
            return std::array::from_fn(|_| f64::NAN.into());
        };
        self.sized(all)
    }

    /// The elements, if they are `N`; else a message and NaNs.
    pub(super) fn sized<const N: usize>(&mut self, all: Elements) -> [Number; N] {
        if all.count != N {
            self.wrong_count(&all, N);
        }
        // As long as the first ones are all.
        <[Number; N]>::try_from(all.numbers)
            .ok()
            .filter(|_| all.count == N)
            .unwrap_or_else(|| std::array::from_fn(|_| f64::NAN.into()))
    }

    pub(super) fn wrong_count(&mut self, all: &Elements, expected: usize) {
        let plural = if all.count == 1 { "" } else { "s" };
        let wanted = if expected == 1 { "" } else { "s" };
        self.report(|| {
            Diagnostic::error(Some(all.span), format!("{} number{plural}", all.count))
                .expected(format!("expected {expected} number{wanted}"))
        });
    }

    /// The values of an attribute group; zeros after an error. The width is nothing if it has an error
    /// itself.
    pub(super) fn group_values(&mut self, width: Option<usize>) -> Vec<Number> {
        let zeros = vec![Number::from(0.0); width.unwrap_or(1)];
        let all = if self.begins_color(width) { self.color(width) } else { self.number_or_elements() };
        let Some(all) = all else {
            return zeros;
        };
        match width {
            Some(width) if all.count == width => all.numbers,
            Some(width) => {
                self.wrong_count(&all, width);
                zeros
            }
            None => zeros,
        }
    }

    /// The value of a parameter of this kind; NaN after an error.
    pub(super) fn field_value(&mut self, kind: FieldKind) -> FieldNumber {
        match kind {
            FieldKind::Real
            | FieldKind::Positive
            | FieldKind::NonNegative
            | FieldKind::Degrees
            | FieldKind::Count
            | FieldKind::Whole { .. }
            | FieldKind::Within { .. } => FieldNumber::Real(self.expression(ExpressionPlace::Alone).number),
            FieldKind::Position | FieldKind::Extents | FieldKind::Stretches => {
                FieldNumber::Vector(self.vector())
            }
            FieldKind::Direction => match self.axis_word() {
                Some(axis) => FieldValue::Vector(axis).into(),
                None => FieldNumber::Vector(self.vector()),
            },
            FieldKind::Choice(words) => FieldValue::Real(self.choice(words)).into(),
            FieldKind::Positions => FieldNumber::Vectors(match self.bound_list(3) {
                Some(list) => list.into_iter().filter_map(|numbers| numbers.try_into().ok()).collect(),
                None => self.list(Self::vector),
            }),
            FieldKind::Lengths => FieldNumber::Reals(match self.bound_list(1) {
                Some(list) => list.into_iter().flatten().collect(),
                None => self.list(|parser| parser.expression(ExpressionPlace::Element).number),
            }),
            FieldKind::Flag => FieldValue::Real(self.flag()).into(),
            FieldKind::Rows => FieldNumber::Reals(self.vector::<12>().into()),
            FieldKind::Axis => {
                let axis = self.axis_word().unwrap_or_else(|| {
                    self.expected_at(self.peek(), "expected one of x, y, z");
                    [f64::NAN; 3]
                });
                FieldValue::Vector(axis).into()
            }
        }
    }

    /// The place of the word that is next; NaN after an error.
    fn choice(&mut self, words: &[&str]) -> f64 {
        let found = self.peek_word().and_then(|word| words.iter().position(|known| *known == word));
        match found {
            Some(place) => {
                self.next();
                place as f64
            }
            None => {
                let near = self.peek_word().and_then(|word| nearest(word, words.iter().copied()));
                let expected = match near {
                    Some(near) => format!("perhaps `{near}`"),
                    None => format!("expected one of {}", words.join(", ")),
                };
                self.expected_at(self.peek(), &expected);
                f64::NAN
            }
        }
    }

    /// `( a b c )` of any number of elements, with blanks or commas between; those before an error, or up to
    /// the limit.
    fn list<T>(&mut self, mut element: impl FnMut(&mut Self) -> T) -> Vec<T> {
        let mut all = Vec::new();
        let open = self.peek();
        if self.accept(b'(').is_none() {
            self.expected_at(open, "expected a list: ( .. )");
            return all;
        }
        let mut count = 0;
        while !self.peek().is(b')') {
            if self.vector_is_cut_off() {
                self.report_and_mute(|| Diagnostic::error(Some(open.span()), "this `(` is not closed"));
                return all;
            }
            if count > 0 {
                self.accept(b',');
            }
            let next = element(self);
            if self.is_muted() {
                self.skip_to_close();
                return all;
            }
            count += 1;
            if count <= MAX_SKELETON_POINTS {
                all.push(next);
            }
        }
        let span = Span { start: open.start as u32, end: self.next().end as u32 };
        if count > MAX_SKELETON_POINTS {
            self.report(|| {
                Diagnostic::limit(Some(span), format!("a list of {count} elements"))
                    .expected(format!("expected at most {MAX_SKELETON_POINTS}"))
            });
        }
        all
    }

    /// 1 for the word yes, 0 for no; NaN after an error.
    fn flag(&mut self) -> f64 {
        let value = match self.peek_word() {
            Some("yes") => 1.0,
            Some("no") => 0.0,
            Some(_) | None => {
                self.expected_at(self.peek(), "expected one of yes, no");
                return f64::NAN;
            }
        };
        self.next();
        value
    }

    /// The unit vector of the axis that is named next.
    fn axis_word(&mut self) -> Option<[f64; 3]> {
        let axis = match self.peek_word()? {
            "x" => [1.0, 0.0, 0.0],
            "y" => [0.0, 1.0, 0.0],
            "z" => [0.0, 0.0, 1.0],
            _ => return None,
        };
        self.next();
        Some(axis)
    }
}
