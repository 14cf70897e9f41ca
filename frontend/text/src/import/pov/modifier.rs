//! Modifiers: transformations and looks of components, blobs and groups.

use glam::DAffine3;
use jbt_model::diagnostic::{Diagnostic, Span};

use super::open::{LookFrame, Modifier, PovFrame};
use super::scan::PovToken;
use super::script::{PovValue, Script};
use super::transform;

/// Modifiers in braces that have no effect on a field.
pub(super) const BRACES: [&str; 8] =
    ["finish", "normal", "interior", "photons", "bounded_by", "interior_texture", "media", "radiosity"];

/// Modifiers of one word, with or without `on` or `off`, that have no effect on a field.
const FLAGS: [&str; 11] = [
    "sturm",
    "hierarchy",
    "no_shadow",
    "no_image",
    "no_reflection",
    "no_radiosity",
    "hollow",
    "double_illuminate",
    "cutaway_textures",
    "split_union",
    "uv_mapping",
];

impl Script<'_> {
    /// A modifier of a component, a blob or a group, whose word has been read.
    pub(super) fn modifier(&mut self, word: &str, span: Span) -> Result<Modifier, Diagnostic> {
        let at = self.scanner.peek()?.1;
        match word {
            "translate" | "rotate" | "scale" => {
                let amount = self.expression()?;
                let by = self.reals(amount, at)?;
                Ok(Modifier::Map(match word {
                    "translate" => DAffine3::from_translation(by),
                    "rotate" => DAffine3::from_mat3(transform::rotation(by)),
                    _ => transform::scale(by),
                }))
            }
            "matrix" => self.matrix(span).map(Modifier::Map),
            "transform" => {
                let (token, at) = self.scanner.next()?;
                match token {
                    PovToken::Mark(b'{') => self.open(PovFrame::Transform(DAffine3::IDENTITY), span)?,
                    PovToken::Word => match self.value(self.scanner.word(at)) {
                        Some(&PovValue::Transform(map)) => return Ok(Modifier::Map(map)),
                        _ => return Err(self.unknown(at)),
                    },
                    _ => return Err(self.scanner.unexpected(token, at)),
                }
                Ok(Modifier::Done)
            }
            "pigment" | "texture" | "material" => {
                self.scanner.expect(b'{')?;
                let frame = LookFrame { depth: 1, color: None, is_default: false };
                self.open(PovFrame::Look(frame), span)?;
                Ok(Modifier::Done)
            }
            "inverse" => {
                self.left_out.note(span, "inverse is not read: the inside stays the inside");
                Ok(Modifier::Done)
            }
            "clipped_by" => {
                self.left_out.note(span, "clipped_by is not read: nothing is cut off");
                self.begin_skipped(word, span)
            }
            _ if BRACES.contains(&word) => self.begin_skipped(word, span),
            _ if FLAGS.contains(&word) => {
                let next = self.scanner.peek_word()?;
                if matches!(next, Some("on" | "off" | "yes" | "no" | "true" | "false")) {
                    self.scanner.next()?;
                }
                Ok(Modifier::Done)
            }
            _ => Ok(Modifier::None),
        }
    }

    pub(super) fn begin_skipped(&mut self, word: &str, span: Span) -> Result<Modifier, Diagnostic> {
        self.scanner.expect(b'{')?;
        self.open(PovFrame::skip(word), span)?;
        Ok(Modifier::Done)
    }

    /// `<` twelve numbers `>`.
    pub(super) fn matrix(&mut self, span: Span) -> Result<DAffine3, Diagnostic> {
        self.scanner.expect(b'<')?;
        let mut rows = [0.0; 12];
        for (place, slot) in rows.iter_mut().enumerate() {
            if place > 0 {
                self.scanner.expect(b',')?;
            }
            let at = self.scanner.peek()?.1;
            let amount = self.expression()?;
            *slot = self.real(amount, at)?;
        }
        self.scanner.expect(b'>')?;
        let map = transform::matrix(&rows);
        if map.matrix3.determinant().is_normal() {
            return Ok(map);
        }
        Err(Diagnostic::error(Some(span), "the matrix has no inverse"))
    }
}
