//! Colours as screens have them, where values of an attribute may stand. They become linear light as they are
//! read: a model knows no others, and so its printed text does not, either.
//!
//! ```text
//! color "#ff8800" { .. }              three reals; "#f80" is the same
//! glass "#ff880080" { .. }            four, for a group of four: the last one, opacity, is what it is
//! color srgb(1 0.53 0) { .. }         numbers from 0 to 1, which may depend on parameters
//! ```

use super::lex::{Token, TokenKind};
use super::state::Parser;
use super::value::Elements;
use super::words::is_builtin;
use jbt_model::diagnostic::{Diagnostic, Span};
pub use jbt_model::function::Function;
use jbt_model::number::{Number, Step};
use jbt_model::report::clip;
use jbt_model::word::is_statement;

/// The word before three numbers of a screen.
const SRGB: &str = "srgb";

/// Colours that people call by name, as screens take them.
const NAMES: [(&str, &str); 16] = [
    ("red", "#ff0000"),
    ("green", "#008000"),
    ("blue", "#0000ff"),
    ("white", "#ffffff"),
    ("black", "#000000"),
    ("yellow", "#ffff00"),
    ("orange", "#ffa500"),
    ("purple", "#800080"),
    ("pink", "#ffc0cb"),
    ("brown", "#a52a2a"),
    ("gray", "#808080"),
    ("grey", "#808080"),
    ("cyan", "#00ffff"),
    ("magenta", "#ff00ff"),
    ("gold", "#ffd700"),
    ("silver", "#c0c0c0"),
];

/// The functions of other programs that make a colour.
const OTHERS: [&str; 8] = ["srgb", "rgb", "rgba", "hsl", "hsv", "hex", "rgbt", "colour"];

/// From the number that a screen is given to linear light, both from 0 to 1 (IEC 61966-2-1).
pub(crate) fn linear(screen: &Number) -> Number {
    let is_bright = Number::of_step(Step::Call(Function::Step, 2), &[&0.04045.into(), screen]);
    let dark = screen / 12.92;
    let bright = ((screen.max(0.0) + 0.055) / 1.055).powf(2.4);
    // One of the factors is 0 and the other one is 1.
    dark * (1.0 - &is_bright) + bright * is_bright
}

/// The digits of a colour in hex: `#` and 3, 4, 6 or 8 of them.
fn hex_digits(text: &str) -> Option<Vec<u32>> {
    let digits = text.strip_prefix('#')?.chars().map(|c| c.to_digit(16)).collect::<Option<Vec<u32>>>()?;
    matches!(digits.len(), 3 | 4 | 6 | 8).then_some(digits)
}

/// Red, green and blue of a colour in hex, linear, and its opacity if it has one.
fn hex_numbers(text: &str) -> Option<Vec<Number>> {
    let digits = hex_digits(text)?;
    let bytes: Vec<u32> = match digits.len() {
        3 | 4 => digits.iter().map(|digit| digit * 17).collect(),
        _ => digits.as_chunks().0.iter().map(|[high, low]| high * 16 + low).collect(),
    };
    let number = |(channel, byte): (usize, u32)| {
        let screen = Number::from(f64::from(byte) / 255.0);
        if channel < 3 { linear(&screen) } else { screen }
    };
    Some(bytes.into_iter().enumerate().map(number).collect())
}

/// What to write for the name of a colour, or for what makes one elsewhere.
pub(super) fn color_hint(word: &str) -> Option<String> {
    if let Some((_, hex)) = NAMES.iter().find(|(name, _)| name.eq_ignore_ascii_case(word)) {
        return Some(format!("perhaps \"{hex}\""));
    }
    if hex_digits(&format!("#{word}")).is_some() {
        return Some(format!("perhaps \"#{word}\""));
    }
    let known = OTHERS.iter().any(|other| other.eq_ignore_ascii_case(word));
    known.then(|| "a colour is \"#ff8800\", srgb(1 0.53 0), or linear: (1 0.25 0)".to_owned())
}

impl Parser<'_> {
    /// Whether a colour is next, also one that is not written as it should be, as the values of a group of so
    /// many reals.
    pub(super) fn begins_color(&self, width: Option<usize>) -> bool {
        self.peek().kind == TokenKind::Quoted || self.begins_srgb() || self.hex_in_comment(width).is_some()
    }

    pub(super) fn begins_srgb(&self) -> bool {
        self.peek_word() == Some(SRGB) && self.peek_behind().is(b'(')
    }

    /// The colour that is next. Nothing after an error.
    pub(super) fn color(&mut self, width: Option<usize>) -> Option<Elements> {
        if let Some(span) = self.hex_in_comment(width) {
            let hex = self.source(span);
            self.report(|| {
                Diagnostic::error(Some(span), format!("`{hex}` begins a comment"))
                    .expected(format!("a colour stands in quotes: \"{hex}\""))
            });
            self.resume(span.end as usize);
            let mut numbers = hex_numbers(hex)?;
            // One message is enough.
            numbers.truncate(width.unwrap_or(numbers.len()));
            return Some(Elements { count: numbers.len(), numbers, span });
        }
        let token = self.next();
        let all = if token.kind == TokenKind::Quoted { self.quoted(token) } else { self.srgb(token) }?;
        if all.count == 4 && width == Some(3) {
            self.report(|| {
                Diagnostic::error(Some(all.span), "this colour has an opacity, and the group has 3 reals")
                    .expected("expected red, green and blue alone")
            });
            return None;
        }
        Some(all)
    }

    fn quoted(&mut self, token: Token) -> Option<Elements> {
        let text = self.text(token).trim_matches('"');
        let numbers = hex_numbers(text);
        if numbers.is_none() {
            self.report(|| {
                let message = format!("`{}` is no colour", clip(text));
                Diagnostic::error(Some(token.span()), message).expected(color_hint(text).unwrap_or_else(
                    || {
                        "expected \"#rrggbb\" or \"#rgb\", and with an opacity \"#rrggbbaa\" or \"#rgba\""
                            .to_owned()
                    },
                ))
            });
        }
        let numbers = numbers?;
        Some(Elements { count: numbers.len(), numbers, span: token.span() })
    }

    /// What follows the word `srgb`.
    fn srgb(&mut self, word: Token) -> Option<Elements> {
        let mut all = self.elements()?;
        all.span.start = word.start as u32;
        if !matches!(all.count, 3 | 4) {
            self.report(|| {
                let plural = if all.count == 1 { "" } else { "s" };
                Diagnostic::error(Some(all.span), format!("{} number{plural}", all.count))
                    .expected("expected red, green and blue: srgb(1 0.53 0)")
            });
            return None;
        }
        let outside = all.numbers.iter().map(Number::value).find(|x| *x < 0.0 || *x > 1.0);
        if let Some(number) = outside {
            self.report(|| {
                Diagnostic::error(Some(all.span), format!("{number} is no part of a colour")).expected(
                    "expected numbers from 0 to 1: bytes are divided by 255, or stand as \"#ff8800\"",
                )
            });
            return None;
        }
        for number in &mut all.numbers[..3] {
            *number = linear(number);
        }
        Some(all)
    }

    /// A colour in hex without its quotes, which the rest of the line has become a comment with.
    ///
    /// It is one as long as what stands behind the comment could not be meant: a comment may begin with such
    /// letters, too (`#add`).
    fn hex_in_comment(&self, width: Option<usize>) -> Option<Span> {
        let token = self.peek();
        let gap = Span::new(self.previous_end(), token.start);
        let text = self.source(gap);
        let hash = text.find(|c| c != ' ' && c != '\t').filter(|_| matches!(width, Some(3 | 4)))?;
        let rest = &text[hash..];
        let word = rest.strip_prefix('#')?;
        let length = word.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(word.len());
        hex_digits(&rest[..=length])?;
        let block = rest[length + 1..].trim_start().starts_with('{');
        let is_value = match token.kind {
            TokenKind::Number | TokenKind::Quoted => true,
            TokenKind::Mark(mark) => matches!(mark, b'(' | b'-' | b'+'),
            TokenKind::Word if self.begins_srgb() => true,
            TokenKind::Word => {
                let word = self.text(token);
                let number = self.parameter(word).is_some() || (is_builtin(word) && !is_statement(word));
                !block && (number || super::words::is_value_word(word))
            }
            TokenKind::Unknown | TokenKind::End => false,
        };
        let start = gap.start as usize + hash;
        (!is_value).then(|| Span::new(start, start + 1 + length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_screens_curve() {
        let of = |screen: f64| linear(&screen.into()).value();
        assert_eq!((of(0.0), of(1.0)), (0.0, 1.0));
        assert_eq!(of(0.04), 0.04 / 12.92);
        assert!((of(188.0 / 255.0) - 0.5).abs() < 0.003, "{}", of(188.0 / 255.0));
        // The two parts meet.
        assert!((of(0.040_449_999) - of(0.040_450_001)).abs() < 1e-7);
    }

    #[test]
    fn hex_of_every_length() {
        let values =
            |text: &str| hex_numbers(text).map(|all| all.iter().map(Number::value).collect::<Vec<_>>());
        let orange = values("#ff8800").unwrap();
        assert_eq!((orange[0], orange[2], orange.len()), (1.0, 0.0, 3));
        assert!((orange[1] - ((0x88 as f64 / 255.0 + 0.055) / 1.055).powf(2.4)).abs() < 1e-15);
        assert_eq!(values("#F80"), Some(orange.clone()));
        assert_eq!(values("#f80c"), values("#FF8800cc"));
        assert_eq!(values("#ff880080").unwrap()[3], 128.0 / 255.0);
        for bad in ["", "#", "ff8800", "#ff88001", "#gg0000", "# f80", "##f80", "#é0a"] {
            assert_eq!(values(bad), None, "{bad}");
        }
    }
}
