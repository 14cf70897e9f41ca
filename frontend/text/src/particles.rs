//! Particles in a text: the block of a node whose points are lists.
//!
//! ```text
//! particles { at ((0 0 0) (1 0 0) (2 0 0)) radius 1 color ((1 0 0) (0 1 0) (0 0 1)) strength (1 1 0.5) }
//! ```
//!
//! A number stands for all of them; a list, in which no number depends on a parameter, has one for each.

use super::expression::{ExpressionPlace, ParsedOperand};
use super::lex::{Token, TokenKind};
use super::state::Parser;
use super::words::{COMMON_FIELDS, GROUP_NODE, PARTICLES};
use jbt_model::attribute::AttributeGroup;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::falloff::Falloff;
use jbt_model::number::Number;
use jbt_model::particles::{NumberArray, ParticleValues, PerParticle};
use jbt_model::report::{clip, nearest};
use jbt_model::tree::Tree;
use jbt_model::word::is_statement;
use jbt_model::written::{ParticleRadius, WrittenFalloff, WrittenParticles};

/// The parameter for positions.
pub(super) const AT: &str = "at";

/// The parameter for a file that has the particles, and those for what its columns are.
pub(super) const FILE_WORDS: [&str; 3] = ["file", "columns", "values"];

/// What has been read of particles.
#[derive(Default)]
struct ParticleParts {
    at: Option<NumberArray>,
    /// What stands in quotes behind each of [`FILE_WORDS`].
    file: [Option<Token>; 3],
    radius: Option<PerParticle<Number>>,
    surface_radius: Option<PerParticle<Number>>,
    falloff: Option<WrittenFalloff>,
    strength: Option<PerParticle<Number>>,
    values: Vec<ParticleValues>,
    /// A list has an error, which has been reported.
    broken: bool,
}

/// A list of numbers, or of vectors.
struct ParsedArray {
    numbers: Vec<f64>,
    /// Whether it is one of vectors.
    nested: bool,
    span: Span,
}

impl Parser<'_> {
    /// Particles whose word, `start`, has just been taken.
    pub(super) fn particles(&mut self, start: Token) -> Tree {
        self.count_node(start.span());
        let Some(open) = self.open() else { return self.broken.clone() };
        let mut parts = ParticleParts::default();
        loop {
            let token = self.peek();
            match token.kind {
                TokenKind::Mark(b'}') => {
                    self.report_again();
                    self.next();
                    break;
                }
                TokenKind::Word if !is_statement(self.text(token)) => {
                    self.next();
                    self.particle_field(token, &mut parts);
                }
                TokenKind::Word | TokenKind::End => {
                    self.unclosed(open.start as u32, token);
                    return self.broken.clone();
                }
                TokenKind::Mark(_) | TokenKind::Number | TokenKind::Quoted | TokenKind::Unknown => {
                    self.expected_at(token, "expected a parameter or `}`");
                    self.skip_token();
                }
            }
        }
        self.finished_particles(Span::new(start.start, self.previous_end()), parts)
    }

    /// A parameter of particles whose word, `token`, has just been taken.
    fn particle_field(&mut self, token: Token, parts: &mut ParticleParts) {
        let word = self.text(token);
        if let Some(place) = FILE_WORDS.iter().position(|known| *known == word)
            && self.peek().kind == TokenKind::Quoted
            && self.group(word).is_none()
        {
            self.report_again();
            let quoted = self.next();
            self.once(&mut parts.file[place], quoted, token);
            return;
        }
        let named = if word == GROUP_NODE { self.peek_word().map(|name| (self.next(), name)) } else { None };
        let (at, name) = named.unwrap_or((token, word));
        let is_field = named.is_none() && (word == AT || COMMON_FIELDS.contains(&word));
        let group = self.attributes.iter().find(|group| !is_field && &*group.name == name).cloned();
        if !is_field && group.is_none() {
            if !self.is_muted() {
                self.unknown_particle_field(at, name);
            }
            return;
        }
        self.report_again();
        if let Some(group) = group {
            return self.particle_values(at, &group, parts);
        }
        match word {
            AT => match self.array(3) {
                Some(array) if array.nested || array.numbers.is_empty() => {
                    self.once(&mut parts.at, array.numbers.into(), token);
                }
                Some(array) => {
                    self.report(|| {
                        Diagnostic::error(Some(array.span), "numbers where positions should be")
                            .expected("expected a list of positions: ((x y z) (x y z) ..)")
                    });
                    parts.broken = true;
                }
                None => parts.broken = true,
            },
            "falloff" => {
                if let Some(falloff) = self.falloff(false) {
                    self.once(&mut parts.falloff, falloff, token);
                }
            }
            _ => {
                let Some(numbers) = self.per_particle() else {
                    parts.broken = true;
                    return;
                };
                let slot = match word {
                    "radius" => &mut parts.radius,
                    "surface_radius" => &mut parts.surface_radius,
                    _ => &mut parts.strength,
                };
                self.once(slot, numbers, token);
            }
        }
    }

    /// A number for all, or a list.
    fn per_particle(&mut self) -> Option<PerParticle<Number>> {
        if !self.peek().is(b'(') {
            let operand = self.expression(ExpressionPlace::Alone);
            return (!self.is_muted()).then_some(PerParticle::All(operand.number));
        }
        let (open, mut whole) = (self.next(), true);
        let first = self.expression(ExpressionPlace::Element);
        if self.is_muted() {
            self.skip_to_close();
            return None;
        }
        if self.peek().is(b')') {
            // One number in parentheses, which an operator may follow.
            let span = Span { end: self.next().end as u32, ..open.span() };
            let first = ParsedOperand { number: first.number, span };
            let operand = self.expression_from(ExpressionPlace::Alone, &first);
            return (!self.is_muted()).then_some(PerParticle::All(operand.number));
        }
        let mut numbers = vec![self.plain(&first, &mut whole)];
        while !self.peek().is(b')') {
            if self.vector_is_cut_off() {
                self.report_and_mute(|| Diagnostic::error(Some(open.span()), "this `(` is not closed"));
                return None;
            }
            self.accept(b',');
            numbers.push(self.plain_element(&mut whole)?);
        }
        self.next();
        whole.then(|| PerParticle::Each(numbers.into()))
    }

    /// The values of particles in a group.
    fn particle_values(&mut self, token: Token, group: &AttributeGroup, parts: &mut ParticleParts) {
        let width = group.width();
        let numbers: Vec<f64> = if self.peek().is(b'(') {
            let Some(array) = self.array(width) else {
                parts.broken = true;
                return;
            };
            if !array.nested && width > 1 && array.numbers.len() != width {
                let count = array.numbers.len();
                self.report(|| {
                    Diagnostic::error(Some(array.span), format!("{count} numbers"))
                        .expected(format!("expected {width} numbers for all, or a list of vectors"))
                });
                parts.broken = true;
                return;
            }
            array.numbers
        } else {
            let from = self.peek().start;
            let values = self.group_values(Some(width));
            let span = Span::new(from, self.previous_end());
            if values.iter().any(Number::depends_on_parameters) {
                self.depends_in_list(span);
                parts.broken = true;
            }
            values.iter().map(Number::value).collect()
        };
        let name = group.name.clone();
        if parts.values.iter().any(|values| values.name == name) {
            let word = self.text(token);
            self.report(|| Diagnostic::error(Some(token.span()), format!("a second `{word}`")));
        }
        parts.values.push(ParticleValues { name, width, numbers: numbers.into() });
    }

    /// `( .. )` of plain numbers, or of vectors of `width` of them. Nothing after an error.
    fn array(&mut self, width: usize) -> Option<ParsedArray> {
        let open = self.peek();
        if self.accept(b'(').is_none() {
            self.expected_at(open, "expected a list: ( .. )");
            return None;
        }
        let nested = self.peek().is(b'(');
        let (mut numbers, mut whole, mut vector) = (Vec::new(), true, None);
        loop {
            let token = self.peek();
            if self.vector_is_cut_off() {
                self.report_and_mute(|| Diagnostic::error(Some(open.span()), "this `(` is not closed"));
                return None;
            }
            match vector {
                // In a vector that began at this token, behind so many numbers.
                Some((begin, first)) if token.is(b')') => {
                    let span = Span { end: self.next().end as u32, ..Token::span(begin) };
                    whole &= self.has_width(span, numbers.len() - first, width);
                    vector = None;
                    self.accept(b',');
                }
                None if token.is(b')') => break,
                None if nested => match self.accept(b'(') {
                    Some(begin) => vector = Some((begin, numbers.len())),
                    None => {
                        self.expected_at(token, "expected ( .. ), as before it");
                        self.skip_to_close();
                        return None;
                    }
                },
                Some(_) | None => {
                    numbers.push(self.plain_element(&mut whole)?);
                    self.accept(b',');
                }
            }
        }
        let span = Span { end: self.next().end as u32, ..open.span() };
        whole.then_some(ParsedArray { numbers, nested, span })
    }

    /// A number of a list. `whole` is false after one that depends on a parameter.
    fn plain_element(&mut self, whole: &mut bool) -> Option<f64> {
        let element = self.expression(ExpressionPlace::Element);
        if self.is_muted() {
            self.skip_to_close();
            return None;
        }
        Some(self.plain(&element, whole))
    }

    fn plain(&mut self, element: &ParsedOperand, whole: &mut bool) -> f64 {
        if element.number.depends_on_parameters() {
            self.depends_in_list(element.span);
            *whole = false;
        }
        element.number.value()
    }

    fn depends_in_list(&mut self, span: Span) {
        self.report(|| {
            Diagnostic::error(Some(span), "a number of particles depends on a parameter")
                .expected("expected a plain number; one radius or strength for all of them may follow one")
        });
    }

    fn has_width(&mut self, span: Span, count: usize, width: usize) -> bool {
        if count != width {
            let (plural, wanted) =
                if count == 1 { ("", "s") } else { ("s", if width == 1 { "" } else { "s" }) };
            self.report(|| {
                Diagnostic::error(Some(span), format!("{count} number{plural}"))
                    .expected(format!("expected {width} number{wanted}"))
            });
        }
        count == width
    }

    fn unknown_particle_field(&mut self, token: Token, name: &str) {
        let groups: Vec<String> = self.attributes.iter().map(|group| group.name.to_string()).collect();
        self.report_and_mute(|| {
            let message = format!("`{PARTICLES}` has no parameter `{}`", clip(name));
            let error = Diagnostic::error(Some(token.span()), message);
            let known = || [AT].into_iter().chain(COMMON_FIELDS).chain(groups.iter().map(String::as_str));
            error.expected(match nearest(name, known()) {
                Some(near) => format!("perhaps `{near}`"),
                None => format!("it has {}", known().collect::<Vec<_>>().join(", ")),
            })
        });
    }

    fn finished_particles(&mut self, span: Span, parts: ParticleParts) -> Tree {
        let ParticleParts { at, file, radius, surface_radius, falloff, strength, values, broken } = parts;
        if broken {
            return self.broken.clone();
        }
        let radius = match (radius, surface_radius) {
            (Some(_), Some(_)) => {
                self.report(|| {
                    Diagnostic::error(Some(span), "`surface_radius` and `radius` of one node")
                        .expected("expected one of them")
                });
                return self.broken.clone();
            }
            (Some(radius), None) => Some(ParticleRadius::Support(radius)),
            (None, radius) => radius.map(ParticleRadius::Surface),
        };
        let [file, columns, arrays] = file;
        if let Some(file) = file {
            if at.is_some() {
                self.report(|| {
                    Diagnostic::error(Some(span), "`at` and `file` of one node")
                        .expected("expected one of them")
                });
                return self.broken.clone();
            }
            let quoted = [columns, arrays].map(|words| self.quoted_words(words));
            let Some(mut written) = self.particle_file(file, quoted, radius.is_some()) else {
                return self.broken.clone();
            };
            written.radius = radius.unwrap_or(written.radius);
            written.strength = strength.unwrap_or(written.strength);
            written.falloff = falloff.unwrap_or(written.falloff);
            let written = values.into_iter().fold(written, WrittenParticles::with_values);
            return Tree::at(span, written, Vec::new());
        }
        let (Some(positions), Some(radius)) = (at.clone(), radius.clone()) else {
            let missing = [(at.is_none(), "`at`"), (radius.is_none(), "`radius`")];
            let missing: Vec<&str> = missing.into_iter().filter(|it| it.0).map(|it| it.1).collect();
            self.report(|| {
                let message = format!("`{PARTICLES}` needs {}", missing.join(" and "));
                Diagnostic::error(Some(span), message)
            });
            return self.broken.clone();
        };
        let written = WrittenParticles {
            positions,
            radius,
            strength: strength.unwrap_or_else(|| 1.0.into()),
            falloff: falloff.unwrap_or_else(|| Falloff::Soft.into()),
            values: values.into(),
        };
        Tree::at(span, written, Vec::new())
    }
}
