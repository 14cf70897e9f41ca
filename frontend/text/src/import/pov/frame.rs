//! What is open while a scene is run: blobs, components, groups, looks. Each token goes to the innermost one.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::skeleton::{Point, Segment};

use super::amount::Amount;
use super::colors;
use super::scan::Token;
use super::script::{Script, Value};
use super::shape::{Blob, Color, Component, PlacedBlob, Shapes};
use super::transform;

/// Something that is open.
pub(super) enum Frame {
    /// A declaration that waits for its value.
    Declaration(String),
    Blob(Blob),
    Component(ComponentFrame),
    Group(GroupFrame),
    Look(LookFrame),
    Skip(SkipFrame),
    Transform(DAffine3),
}

/// A component of a blob.
pub(super) struct ComponentFrame {
    is_sphere: bool,
    arguments: Vec<(Amount, Span)>,
    map: DAffine3,
    color: Option<Color>,
}

/// Shapes that are one object.
pub(super) struct GroupFrame {
    word: &'static str,
    /// Whether it is more than the union of its shapes.
    is_set_operation: bool,
    shapes: Shapes,
    count: usize,
    map: DAffine3,
    color: Option<Color>,
}

/// A pigment, a texture, a material.
pub(super) struct LookFrame {
    depth: usize,
    color: Option<Color>,
    /// Whether it gives the colour of what has none.
    is_default: bool,
}

/// What is left out; its braces are counted.
pub(super) struct SkipFrame {
    word: String,
    depth: usize,
}

/// Groups, and whether they are more than a union.
const GROUPS: [(&str, bool); 5] =
    [("object", false), ("union", false), ("merge", false), ("intersection", true), ("difference", true)];

/// Shapes that are no blobs.
const SHAPES: [&str; 29] = [
    "bicubic_patch",
    "box",
    "cone",
    "cubic",
    "cylinder",
    "disc",
    "height_field",
    "isosurface",
    "julia_fractal",
    "lathe",
    "lemon",
    "mesh",
    "mesh2",
    "ovus",
    "parametric",
    "plane",
    "poly",
    "polygon",
    "polynomial",
    "prism",
    "quadric",
    "quartic",
    "smooth_triangle",
    "sor",
    "sphere",
    "sphere_sweep",
    "superellipsoid",
    "torus",
    "triangle",
];

/// Modifiers in braces that have no effect on a field.
const BRACES: [&str; 8] =
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

/// Smallest strength and squared radius of a component that counts, as in the original.
const NOTHING: f64 = 1e-10;

/// What became of a modifier.
enum Modifier {
    Map(DAffine3),
    /// It was read, or its braces are open now.
    Done,
    /// It is none.
    None,
}

impl Frame {
    /// The look of what has none.
    pub(super) fn default_look() -> Self {
        Self::Look(LookFrame { depth: 1, color: None, is_default: true })
    }

    fn skip(word: &str) -> Self {
        Self::Skip(SkipFrame { word: word.to_owned(), depth: 1 })
    }

    /// How messages call it.
    fn word(&self) -> &str {
        match self {
            Self::Declaration(_) => "declaration",
            Self::Blob(_) => "blob",
            Self::Component(_) => "component",
            Self::Group(group) => group.word,
            Self::Look(_) => "texture",
            Self::Skip(skip) => &skip.word,
            Self::Transform(_) => "transform",
        }
    }
}

impl Script<'_> {
    /// Runs the scene to its end.
    pub(super) fn run(&mut self) -> Result<(), Diagnostic> {
        loop {
            let (token, span) = self.scanner.next()?;
            match (token, self.frames.last().map(|(frame, _)| frame)) {
                (Token::End, _) => return self.finished(),
                (Token::Mark(b'#'), _) => self.directive()?,
                (_, None) => self.top(token, span)?,
                (_, Some(Frame::Blob(_))) => self.in_blob(token, span)?,
                (_, Some(Frame::Component(_))) => self.in_component(token, span)?,
                (_, Some(Frame::Group(_))) => self.in_group(token, span)?,
                (_, Some(Frame::Look(_))) => self.in_look(token, span)?,
                (_, Some(Frame::Skip(_))) => self.in_skipped(token, span)?,
                (_, Some(Frame::Transform(_))) => self.in_transform(token, span)?,
                (_, Some(Frame::Declaration(_))) => {
                    return Err(self.scanner.unexpected(token, span).expected("expected a value"));
                }
            }
        }
    }

    /// Everything has to be closed at the end.
    fn finished(&self) -> Result<(), Diagnostic> {
        if let Some((frame, span)) = self.frames.last() {
            let message = format!("the {} is not closed", frame.word());
            return Err(Diagnostic::error(Some(*span), message).expected("expected `}`"));
        }
        match self.blocks.last() {
            Some((_, span)) => {
                Err(Diagnostic::error(Some(*span), "the directive has no end").expected("expected `#end`"))
            }
            None => Ok(()),
        }
    }

    /// A token that belongs to nothing.
    fn top(&mut self, token: Token, span: Span) -> Result<(), Diagnostic> {
        match token {
            Token::Mark(b';' | b',') => Ok(()),
            Token::Word => {
                let word = self.scanner.word(span);
                if self.begin_shapes(word, span)? {
                    return Ok(());
                }
                match self.scanner.peek()?.0 {
                    Token::Mark(b'{') => {
                        self.scanner.next()?;
                        if word != "global_settings" {
                            self.left_out.note(span, &format!("{word} is left out"));
                        }
                        self.open(Frame::skip(word), span)
                    }
                    Token::Mark(b'(') => {
                        self.left_out.note(span, &format!("the macro {word} is not run"));
                        self.skip_balanced(b'(', b')')
                    }
                    _ => Err(self.scanner.unexpected(token, span)),
                }
            }
            _ => Err(self.scanner.unexpected(token, span)),
        }
    }

    /// Begins a shape, whose word has been read. False if it is none.
    fn begin_shapes(&mut self, word: &str, span: Span) -> Result<bool, Diagnostic> {
        let group = GROUPS.iter().find(|(known, _)| *known == word);
        let is_other = SHAPES.contains(&word);
        if word != "blob" && group.is_none() && !is_other {
            return Ok(false);
        }
        self.scanner.expect(b'{')?;
        let frame = match group {
            Some(&(word, is_set_operation)) => Frame::Group(GroupFrame {
                word,
                is_set_operation,
                shapes: Shapes::default(),
                count: 0,
                map: DAffine3::IDENTITY,
                color: None,
            }),
            None if is_other => Frame::skip(word),
            None => Frame::Blob(Blob {
                threshold: 1.0,
                components: Vec::new(),
                map: DAffine3::IDENTITY,
                color: None,
                span,
            }),
        };
        self.open(frame, span)?;
        Ok(true)
    }

    /// The value of a declaration; `None` if it comes when something that is open now is closed.
    pub(super) fn begin_value(&mut self, name: &str, span: Span) -> Result<Option<Value>, Diagnostic> {
        let place = self.scanner.place();
        let Some(word) = self.scanner.peek_word()? else {
            return self.expression().map(|amount| Some(Value::Amount(amount)));
        };
        if colors::begins(word) {
            return self.color().map(|amount| Some(Value::Amount(amount)));
        }
        let word_span = self.scanner.next()?.1;
        let opens = self.scanner.peek()?.0 == Token::Mark(b'{');
        if let Some(value) = self.value(word).filter(|value| !matches!(value, Value::Amount(_))) {
            let value = value.clone();
            if let Value::Shapes(shapes) = &value {
                self.spend(shapes.blobs.len(), span)?;
            }
            if matches!(self.scanner.peek()?.0, Token::Mark(b'(')) {
                self.skip_balanced(b'(', b')')?;
                return Ok(Some(Value::Amount(Amount::Unknown(word_span))));
            }
            return Ok(Some(value));
        }
        if !opens && !matches!(word, "function" | "array" | "spline") {
            self.scanner.go(place);
            return self.expression().map(|amount| Some(Value::Amount(amount)));
        }
        self.open(Frame::Declaration(name.to_owned()), span)?;
        if self.begin_shapes(word, word_span)? {
            return Ok(None);
        }
        match self.scanner.peek()?.0 {
            Token::Mark(b'(') => self.skip_balanced(b'(', b')')?,
            Token::Mark(b'[') => {
                while self.scanner.peek()?.0 == Token::Mark(b'[') {
                    self.skip_balanced(b'[', b']')?;
                }
                if self.scanner.peek()?.0 != Token::Mark(b'{') {
                    self.frames.pop();
                    return Ok(Some(Value::Other));
                }
            }
            _ => {}
        }
        self.scanner.expect(b'{')?;
        let frame = match word {
            "pigment" | "texture" | "material" => {
                Frame::Look(LookFrame { depth: 1, color: None, is_default: false })
            }
            "transform" => Frame::Transform(DAffine3::IDENTITY),
            _ => Frame::skip(word),
        };
        self.open(frame, word_span)?;
        Ok(None)
    }

    /// Hands what was closed to what is open around it.
    fn deliver(&mut self, value: Value, span: Span) -> Result<(), Diagnostic> {
        match (self.frames.last_mut().map(|(frame, _)| frame), value) {
            (Some(Frame::Declaration(_)), value) => {
                if let Some((Frame::Declaration(name), _)) = self.frames.pop() {
                    self.declare(&name, value);
                }
                self.scanner.accept(b';')?;
            }
            (Some(Frame::Group(group)), Value::Shapes(shapes)) => {
                group.count += 1;
                group.shapes.add(Arc::unwrap_or_clone(shapes));
            }
            (Some(Frame::Group(GroupFrame { color, .. })), Value::Look(look)) => *color = look.or(*color),
            (Some(Frame::Blob(Blob { color, .. })), Value::Look(look)) => *color = look.or(*color),
            (Some(Frame::Component(ComponentFrame { color, .. })), Value::Look(look)) => {
                *color = look.or(*color);
            }
            (Some(Frame::Group(GroupFrame { map, .. })), Value::Transform(new))
            | (Some(Frame::Blob(Blob { map, .. })), Value::Transform(new))
            | (Some(Frame::Component(ComponentFrame { map, .. })), Value::Transform(new))
            | (Some(Frame::Transform(map)), Value::Transform(new)) => *map = new * *map,
            (None, Value::Shapes(shapes)) => {
                for word in &shapes.others {
                    self.left_out.note(span, &format!("{word} is no blob and is left out"));
                }
                self.scene.add(Arc::unwrap_or_clone(shapes));
            }
            (
                _,
                Value::Shapes(_) | Value::Look(_) | Value::Transform(_) | Value::Amount(_) | Value::Other,
            ) => {}
        }
        Ok(())
    }

    /// A modifier of a component, a blob or a group, whose word has been read.
    fn modifier(&mut self, word: &str, span: Span) -> Result<Modifier, Diagnostic> {
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
                    Token::Mark(b'{') => self.open(Frame::Transform(DAffine3::IDENTITY), span)?,
                    Token::Word => match self.value(self.scanner.word(at)) {
                        Some(&Value::Transform(map)) => return Ok(Modifier::Map(map)),
                        _ => return Err(self.unknown(at)),
                    },
                    _ => return Err(self.scanner.unexpected(token, at)),
                }
                Ok(Modifier::Done)
            }
            "pigment" | "texture" | "material" => {
                self.scanner.expect(b'{')?;
                let frame = LookFrame { depth: 1, color: None, is_default: false };
                self.open(Frame::Look(frame), span)?;
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

    fn begin_skipped(&mut self, word: &str, span: Span) -> Result<Modifier, Diagnostic> {
        self.scanner.expect(b'{')?;
        self.open(Frame::skip(word), span)?;
        Ok(Modifier::Done)
    }

    /// `<` twelve numbers `>`.
    fn matrix(&mut self, span: Span) -> Result<DAffine3, Diagnostic> {
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

    fn in_blob(&mut self, token: Token, span: Span) -> Result<(), Diagnostic> {
        match token {
            Token::Mark(b'}') => return self.close_blob(),
            Token::Mark(b',') => return Ok(()),
            Token::Word => {}
            _ => return Err(self.scanner.unexpected(token, span).expected("expected a component")),
        }
        let word = self.scanner.word(span);
        match word {
            "threshold" => {
                let at = self.scanner.peek()?.1;
                let amount = self.expression()?;
                let threshold = self.real(amount, at)?;
                if threshold <= 0.0 {
                    let error = Diagnostic::error(Some(at), format!("the threshold is {threshold}"));
                    return Err(error.expected("expected a number above 0"));
                }
                self.with_blob(|blob| blob.threshold = threshold);
                Ok(())
            }
            "sphere" | "cylinder" => {
                self.spend(4, span)?;
                self.scanner.expect(b'{')?;
                let frame = ComponentFrame {
                    is_sphere: word == "sphere",
                    arguments: Vec::new(),
                    map: DAffine3::IDENTITY,
                    color: None,
                };
                self.open(Frame::Component(frame), span)
            }
            "component" => self.old_component(span),
            _ => match self.modifier(word, span)? {
                Modifier::Map(map) => {
                    self.with_blob(|blob| blob.map = map * blob.map);
                    Ok(())
                }
                Modifier::Done => Ok(()),
                Modifier::None => self.blob_name(word, span),
            },
        }
    }

    fn with_blob(&mut self, change: impl FnOnce(&mut Blob)) {
        if let Some((Frame::Blob(blob), _)) = self.frames.last_mut() {
            change(blob);
        }
    }

    /// A name in a blob: that of another blob, which this one begins with.
    fn blob_name(&mut self, word: &str, span: Span) -> Result<(), Diagnostic> {
        let known = match self.value(word) {
            Some(Value::Shapes(shapes)) if shapes.blobs.len() == 1 => Some(shapes.blobs[0].clone()),
            _ => None,
        };
        if let Some(placed) = known {
            self.spend(4 * placed.blob.components.len(), span)?;
            self.with_blob(|blob| {
                let Blob { threshold, components, map, color, .. } = (*placed.blob).clone();
                *blob = Blob { threshold, components, map: placed.map * map, color, span: blob.span };
            });
            return Ok(());
        }
        let shown = self.scanner.shown(span);
        let error = if self.scanner.peek()?.0 == Token::Mark(b'(') {
            Diagnostic::error(Some(span), format!("the macro `{shown}` is called in a blob, and is not run"))
        } else {
            Diagnostic::error(Some(span), format!("unexpected `{shown}`"))
        };
        Err(error.expected("expected a component, a transformation or a pigment"))
    }

    /// `component strength, radius, <centre>`, without braces.
    fn old_component(&mut self, span: Span) -> Result<(), Diagnostic> {
        self.spend(4, span)?;
        let mut arguments = Vec::with_capacity(3);
        for _ in 0..3 {
            self.scanner.accept(b',')?;
            let at = self.scanner.peek()?.1;
            arguments.push((self.expression()?, at));
        }
        arguments.reverse();
        let frame = ComponentFrame { is_sphere: true, arguments, map: DAffine3::IDENTITY, color: None };
        self.add_component(frame, span)
    }

    fn in_component(&mut self, token: Token, span: Span) -> Result<(), Diagnostic> {
        match token {
            Token::Mark(b'}') => {
                let Some((Frame::Component(frame), begin)) = self.frames.pop() else { return Ok(()) };
                return self.add_component(frame, begin);
            }
            Token::Mark(b',') => return Ok(()),
            Token::Word => {
                let word = self.scanner.word(span);
                if word == "strength" {
                    return Ok(());
                }
                match self.modifier(word, span)? {
                    Modifier::Map(map) => {
                        if let Some((Frame::Component(frame), _)) = self.frames.last_mut() {
                            frame.map = map * frame.map;
                        }
                        return Ok(());
                    }
                    Modifier::Done => return Ok(()),
                    Modifier::None => {}
                }
            }
            Token::End
            | Token::Text
            | Token::Number(_)
            | Token::Mark(_)
            | Token::AtMost
            | Token::AtLeast
            | Token::Unequal => {}
        }
        self.scanner.go(span.start as usize);
        let amount = self.expression()?;
        if let Some((Frame::Component(frame), _)) = self.frames.last_mut() {
            if frame.arguments.len() == 4 {
                return Err(Diagnostic::error(Some(span), "the component has too many numbers"));
            }
            frame.arguments.push((amount, span));
        }
        Ok(())
    }

    /// A component that is complete.
    fn add_component(&mut self, frame: ComponentFrame, span: Span) -> Result<(), Diagnostic> {
        let ComponentFrame { is_sphere, arguments, map, color } = frame;
        let needed = if is_sphere { 3 } else { 4 };
        if arguments.len() != needed {
            let message = format!("the component has {} of {needed} arguments", arguments.len());
            let error = Diagnostic::error(Some(span), message);
            return Err(error.expected(if is_sphere {
                "expected sphere { centre, radius, strength }"
            } else {
                "expected cylinder { end, end, radius, strength }"
            }));
        }
        let places = needed - 2;
        let ends: Vec<DVec3> = arguments[..places]
            .iter()
            .map(|&(amount, at)| self.reals(amount, at))
            .collect::<Result<_, _>>()?;
        let radius = self.real(arguments[places].0, arguments[places].1)?.abs();
        let strength = self.real(arguments[places + 1].0, arguments[places + 1].1)?;
        if strength.abs() < NOTHING || radius * radius < NOTHING {
            self.left_out.note(span, "a component without strength or radius is left out");
            return Ok(());
        }
        let skeleton = match ends.as_slice() {
            [from, to] if from != to => Segment { from: *from, to: *to }.into(),
            _ => Point { at: ends[0] }.into(),
        };
        self.with_blob(|blob| {
            blob.components.push(Component { skeleton, radius, strength, map, color, span });
        });
        Ok(())
    }

    fn close_blob(&mut self) -> Result<(), Diagnostic> {
        let Some((Frame::Blob(mut blob), span)) = self.frames.pop() else { return Ok(()) };
        blob.color = blob.color.or(self.default_color);
        let mut shapes = Shapes::default();
        if blob.components.is_empty() {
            self.left_out.note(span, "the blob has no components");
        } else {
            let blob = Arc::new(blob);
            shapes.blobs.push(PlacedBlob { blob, map: DAffine3::IDENTITY, color: None, fault: None });
        }
        self.deliver(Value::Shapes(Arc::new(shapes)), span)
    }

    fn in_group(&mut self, token: Token, span: Span) -> Result<(), Diagnostic> {
        match token {
            Token::Mark(b'}') => return self.close_group(),
            Token::Mark(b',' | b';') => return Ok(()),
            Token::Word => {}
            _ => return Err(self.scanner.unexpected(token, span).expected("expected a shape")),
        }
        let word = self.scanner.word(span);
        if self.begin_shapes(word, span)? {
            return Ok(());
        }
        match self.modifier(word, span)? {
            Modifier::Map(map) => {
                if let Some((Frame::Group(group), _)) = self.frames.last_mut() {
                    group.map = map * group.map;
                }
                return Ok(());
            }
            Modifier::Done => return Ok(()),
            Modifier::None => {}
        }
        if let Some(Value::Shapes(shapes)) = self.value(word) {
            let shapes = Arc::clone(shapes);
            self.spend(1 + shapes.blobs.len(), span)?;
            return self.deliver(Value::Shapes(shapes), span);
        }
        match self.scanner.peek()?.0 {
            Token::Mark(b'{') => {
                self.scanner.next()?;
                self.open(Frame::skip(word), span)
            }
            Token::Mark(b'(') => {
                self.left_out.note(span, &format!("the macro {word} is not run"));
                self.skip_balanced(b'(', b')')
            }
            _ => {
                self.left_out.note(span, &format!("{word} is not known and is left out"));
                self.deliver(Value::Shapes(Arc::new(Shapes::other(word))), span)
            }
        }
    }

    fn close_group(&mut self) -> Result<(), Diagnostic> {
        let Some((Frame::Group(group), span)) = self.frames.pop() else { return Ok(()) };
        let GroupFrame { word, is_set_operation, mut shapes, count, map, color } = group;
        self.spend(shapes.blobs.len(), span)?;
        if is_set_operation && shapes.blobs.is_empty() {
            shapes = Shapes::other(word);
        }
        let fault: Option<Arc<str>> = (is_set_operation && count > 1).then(|| {
            let others = if shapes.others.is_empty() { "blobs".to_owned() } else { shapes.others.join(", ") };
            format!("a blob in {} {word} with other shapes: {others}", article(word)).into()
        });
        for placed in &mut shapes.blobs {
            placed.map = map * placed.map;
            placed.color = placed.color.or(color);
            placed.fault = placed.fault.take().or_else(|| fault.clone());
        }
        if fault.is_some() {
            // They are named in the fault.
            shapes.others.clear();
        }
        self.deliver(Value::Shapes(Arc::new(shapes)), span)
    }

    fn in_look(&mut self, token: Token, span: Span) -> Result<(), Diagnostic> {
        match token {
            Token::Mark(b'{') => self.with_look(|look| look.depth += 1),
            Token::Mark(b'}') => {
                self.with_look(|look| look.depth -= 1);
                let Some((Frame::Look(LookFrame { depth: 0, color, is_default }), _)) = self.frames.last()
                else {
                    return Ok(());
                };
                let (color, is_default) = (*color, *is_default);
                self.frames.pop();
                if is_default {
                    self.default_color = color;
                    return Ok(());
                }
                return self.deliver(Value::Look(color), span);
            }
            Token::Word => return self.word_of_look(span),
            _ => {}
        }
        Ok(())
    }

    fn with_look(&mut self, change: impl FnOnce(&mut LookFrame)) {
        if let Some((Frame::Look(look), _)) = self.frames.last_mut() {
            change(look);
        }
    }

    fn word_of_look(&mut self, span: Span) -> Result<(), Diagnostic> {
        let word = self.scanner.word(span);
        if colors::begins(word) {
            self.scanner.go(span.start as usize);
            let amount = self.color()?;
            let color = self.linear(amount);
            if color.is_none() {
                self.left_out.note(span, "a colour that is not known is left out");
            }
            self.with_look(|look| look.color = color);
            return Ok(());
        }
        if matches!(word, "quick_color" | "quick_colour") {
            return if self.is_color_next()? {
                self.color().map(|_| ())
            } else {
                self.expression().map(|_| ())
            };
        }
        if matches!(word, "pigment" | "texture" | "material") {
            return Ok(());
        }
        if matches!(word, "translate" | "rotate" | "scale") {
            return self.expression().map(|_| ());
        }
        if self.scanner.peek()?.0 == Token::Mark(b'{') {
            if !BRACES.contains(&word) && word != "transform" {
                self.left_out.note(span, &format!("{word} gives no colour that is read"));
            }
            self.scanner.next()?;
            return self.open(Frame::skip(word), span);
        }
        match self.named_color(word) {
            Some(color) => self.with_look(|look| look.color = color.or(look.color)),
            None => self.left_out.note(span, &format!("{word} gives no colour that is read")),
        }
        if self.scanner.peek()?.0 == Token::Mark(b'(') {
            self.skip_balanced(b'(', b')')?;
        }
        Ok(())
    }

    /// What is left out calls for random numbers all the same.
    fn in_skipped(&mut self, token: Token, span: Span) -> Result<(), Diagnostic> {
        let Some((Frame::Skip(skip), _)) = self.frames.last_mut() else { return Ok(()) };
        match token {
            Token::Mark(b'{') => skip.depth += 1,
            Token::Mark(b'}') => {
                skip.depth -= 1;
                if skip.depth == 0 {
                    let word = std::mem::take(&mut skip.word);
                    let begin = self.frames.pop().map_or(span, |(_, begin)| begin);
                    let is_shape = SHAPES.contains(&word.as_str());
                    let shapes = || Value::Shapes(Arc::new(Shapes::other(&word)));
                    let value = if is_shape { shapes() } else { Value::Other };
                    return self.deliver(value, begin);
                }
            }
            Token::Word => match self.scanner.word(span) {
                "rand" => {
                    self.scanner.go(span.start as usize);
                    self.expression()?;
                }
                "assumed_gamma" => return self.assumed_gamma(span),
                _ => {}
            },
            _ => {}
        }
        Ok(())
    }

    fn in_transform(&mut self, token: Token, span: Span) -> Result<(), Diagnostic> {
        match token {
            Token::Mark(b'}') => {
                let Some((Frame::Transform(map), begin)) = self.frames.pop() else { return Ok(()) };
                return self.deliver(Value::Transform(map), begin);
            }
            Token::Mark(b',') => return Ok(()),
            Token::Word => {}
            _ => return Err(self.scanner.unexpected(token, span).expected("expected a transformation")),
        }
        let word = self.scanner.word(span);
        let map = match self.modifier(word, span)? {
            Modifier::Map(map) => map,
            Modifier::Done => return Ok(()),
            Modifier::None => match (word, self.value(word)) {
                ("inverse", _) => DAffine3::IDENTITY,
                (_, Some(&Value::Transform(map))) => map,
                _ => return Err(self.scanner.unexpected(token, span).expected("expected a transformation")),
            },
        };
        if let Some((Frame::Transform(so_far), _)) = self.frames.last_mut() {
            *so_far = map * *so_far;
        }
        Ok(())
    }
}

fn article(word: &str) -> &'static str {
    if word.starts_with('i') { "an" } else { "a" }
}
