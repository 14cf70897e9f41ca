//! RenderMan RIB: the `Blobby` of a scene (RenderMan Interface Specification 3.2, Pixar 2000; Pixar's
//! application note 31).
//!
//! ```text
//! WorldBegin
//! Color [.6 .1 .2]
//! Translate 0 0 5
//! Blobby 2 [ 1001 0 1001 16 0 2 0 1 ]                two ellipsoids and their sum
//!     [ 1 0 0 0 0 1 0 0 0 0 1 0 .6 0 0 1  1 0 0 0 0 1 0 0 0 0 1 0 -.6 0 0 1 ] [ "" ]
//!     "vertex color Cs" [ 1 0 0 0 0 1 ]
//! WorldEnd
//! ```
//!
//! A request is a bare word with the arguments up to the next one. Requests of the look of things are
//! skipped, shapes of other kinds are left out with a warning. Coordinates are those of the world: a
//! `WorldBegin` ends what is said of the camera. Matrices are for row vectors, and the last request acts
//! first.
//!
//! All `Blobby` of a file are one model, their union, with the iso-value 27/64.

mod blobby;
mod request;
mod scan;

use std::collections::HashMap;

use glam::{DAffine3, DVec3};
use jbt_ir::limits::{MAX_BLOCK_DEPTH, MAX_SCENE_BYTES};
use jbt_model::combine::{Combinator, Union};
use jbt_model::diagnostic::{Diagnostic, Diagnostics, Span};
use jbt_model::model::Model;
use jbt_model::orientation::Orientation;
use jbt_model::report::{Report, clip, nearest};
use jbt_model::tree::Tree;

use self::blobby::{BlobbyProgram, ISO, LeafColors, affine, placed};
use self::request::{Request, RibBlock};
use self::scan::{Argument, ArgumentValues, RibScanner};
use super::Imported;
use super::format::{SceneFormatRow, first_line};
use super::tally::LeftOut;

/// A comment that names RenderMan, or a request, comes first.
pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow {
    recognizes: |bytes| {
        let mut words = first_line(bytes).split(u8::is_ascii_whitespace);
        let word = String::from_utf8_lossy(words.next().unwrap_or_default());
        bytes.starts_with(b"##RenderMan RIB") || request::find(&word).is_some()
    },
    ..SceneFormatRow::new(&["rib"], "a RenderMan scene", |bytes, _| rib(bytes))
};

/// The model of the `Blobby` requests of a RenderMan scene or archive (`.rib`).
///
/// # Errors
///
/// All errors of the file, with their places: unreadable numbers, arrays and strings that are not closed,
/// instructions that ask for what is not there, plug-ins, matrices without an inverse, blocks that end
/// without a beginning, a file without a `Blobby`. Binary and compressed files are not read.
pub fn rib(bytes: &[u8]) -> Result<Imported, Diagnostics> {
    Imported::from(bytes, read(bytes))
}

fn read(bytes: &[u8]) -> Result<(Model, Vec<Diagnostic>), Vec<Diagnostic>> {
    if bytes.len() > MAX_SCENE_BYTES {
        let message = format!("the file has {} bytes; at most {MAX_SCENE_BYTES} are read", bytes.len());
        return Err(vec![Diagnostic::limit(None, message)]);
    }
    if bytes.starts_with(&[0x1f, 0x8b]) || bytes.first().is_some_and(|&byte| byte >= 0x80) {
        let message = "the file is compressed or binary RIB";
        let help = "`gunzip`, or `catrib -ascii` of a renderer, makes a text of it";
        return Err(vec![Diagnostic::error(Some(Span::new(0, 1)), message).expected(help)]);
    }
    let mut reader = RibReader::new(bytes);
    if let Err(error) = reader.requests() {
        reader.errors.add_last(error);
    }
    reader.finish(bytes.len())
}

/// What requests set, and blocks bring back.
#[derive(Clone)]
struct Graphics {
    /// From the present space to the world; or the request that made it unusable.
    space: Result<DAffine3, Span>,
    /// The current colour; `None` where it is that of an instance.
    color: Option<[f64; 3]>,
}

struct RibReader<'a> {
    scanner: RibScanner<'a>,
    now: Graphics,
    blocks: Vec<(RibBlock, Span, Graphics)>,
    /// Class and type of declared parameters, by name.
    declared: HashMap<String, String>,
    /// The shapes that are kept under a handle.
    objects: HashMap<String, Vec<Tree>>,
    /// The handle of the object that is being kept.
    open: Option<String>,
    /// Whether a motion block has had its first request.
    motion: Option<bool>,
    trees: Vec<Tree>,
    errors: Report,
    left_out: LeftOut,
    warnings: Vec<Diagnostic>,
}

impl<'a> RibReader<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            scanner: RibScanner::new(bytes),
            now: Graphics { space: Ok(DAffine3::IDENTITY), color: Some([1.0; 3]) },
            blocks: Vec::new(),
            declared: HashMap::new(),
            objects: HashMap::new(),
            open: None,
            motion: None,
            trees: Vec::new(),
            errors: Report::default(),
            left_out: LeftOut::default(),
            warnings: Vec::new(),
        }
    }

    /// All requests, in order. An error is one that nothing can be read behind.
    fn requests(&mut self) -> Result<(), Diagnostic> {
        while let Some(span) = self.scanner.request()? {
            let word = self.scanner.text(span);
            let Some(request) = request::find(&word) else {
                self.left_out.note_as(span, &word, || unknown(&word));
                continue;
            };
            if self.is_later_moment(request, span) {
                continue;
            }
            match request {
                Request::Look => {}
                Request::Shape => {
                    self.left_out.note(span, &format!("{word} is no blob and is left out"));
                }
                Request::LeftOut(does) => {
                    let arguments = self.scanner.arguments()?;
                    let name = arguments.iter().find_map(|argument| self.lone_text(argument));
                    let name = name.map_or_else(String::new, |name| format!(" \"{}\"", clip(&name)));
                    self.left_out.note(span, &format!("{word}{name} {does}: that is left out"));
                }
                Request::Unusable => self.now.space = Err(span),
                _ => {
                    let arguments = self.scanner.arguments()?;
                    if let Err(error) = self.act(request, span, &arguments) {
                        self.errors.add(|| error);
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether this is a request of a motion block that says how things are at a later moment.
    fn is_later_moment(&mut self, request: Request, span: Span) -> bool {
        match (request, self.motion) {
            (Request::MotionBegin, _) => {
                self.motion = Some(false);
                self.left_out.note(span, "a motion block: its first moment is read");
                true
            }
            (Request::MotionEnd, _) => {
                self.motion = None;
                true
            }
            (_, Some(true)) => true,
            (_, Some(false)) => {
                self.motion = Some(true);
                false
            }
            (_, None) => false,
        }
    }

    /// A request that changes the state, or brings a shape.
    fn act(&mut self, request: Request, span: Span, arguments: &[Argument]) -> Result<(), Diagnostic> {
        let numbers = |count| numbers(span, arguments, count);
        match request {
            Request::WorldBegin => {
                self.begin(RibBlock::World, span)?;
                self.now.space = Ok(DAffine3::IDENTITY);
            }
            Request::Begin(block) => self.begin(block, span)?,
            Request::End(block) => self.end(block, span)?,
            Request::Translate => self.concat(span, Some(DAffine3::from_translation(vector(&numbers(3)?)))),
            Request::Scale => {
                let scale = vector(&numbers(3)?);
                self.concat(span, (scale.cmpne(DVec3::ZERO).all()).then(|| DAffine3::from_scale(scale)));
            }
            Request::Rotate => {
                let numbers = numbers(4)?;
                let axis = vector(&numbers[1..]).try_normalize();
                let turn = axis.map(|axis| DAffine3::from_axis_angle(axis, numbers[0].to_radians()));
                self.concat(span, turn);
            }
            Request::ConcatTransform => self.concat(span, affine(&numbers(16)?)),
            Request::Transform => self.now.space = affine(&numbers(16)?).ok_or(span),
            Request::Identity => self.now.space = Ok(DAffine3::IDENTITY),
            Request::Color => self.now.color = Some(vector(&numbers(3)?).into()),
            Request::Declare => self.declare(span, arguments)?,
            Request::Blobby => self.blobby(span, arguments)?,
            Request::ObjectBegin => {
                let handle = self.handle(span, arguments)?;
                if self.open.is_some() {
                    return Err(Diagnostic::error(Some(span), "an object begins within an object"));
                }
                self.begin(RibBlock::Object, span)?;
                self.now = Graphics { space: Ok(DAffine3::IDENTITY), color: None };
                self.objects.insert(handle.clone(), Vec::new());
                self.open = Some(handle);
            }
            Request::ObjectEnd => {
                self.end(RibBlock::Object, span)?;
                self.open = None;
            }
            Request::ObjectInstance => self.instance(span, arguments)?,
            Request::MotionBegin
            | Request::MotionEnd
            | Request::Look
            | Request::Shape
            | Request::Unusable
            | Request::LeftOut(_) => {}
        }
        Ok(())
    }

    fn begin(&mut self, block: RibBlock, span: Span) -> Result<(), Diagnostic> {
        if self.blocks.len() == MAX_BLOCK_DEPTH {
            let message = format!("more than {MAX_BLOCK_DEPTH} blocks within each other");
            return Err(Diagnostic::limit(Some(span), message));
        }
        self.blocks.push((block, span, self.now.clone()));
        Ok(())
    }

    fn end(&mut self, block: RibBlock, span: Span) -> Result<(), Diagnostic> {
        let name = block.name();
        match self.blocks.pop() {
            Some((begun, _, before)) if begun == block => {
                let color = if block == RibBlock::Transform { self.now.color } else { before.color };
                self.now = Graphics { color, ..before };
                Ok(())
            }
            Some(other) => {
                let begun = other.0.name();
                self.blocks.push(other);
                let error = Diagnostic::error(Some(span), format!("{name}End within {begun}Begin"));
                Err(error.expected(format!("expected {begun}End")))
            }
            None => Err(Diagnostic::error(Some(span), format!("{name}End without {name}Begin"))),
        }
    }

    /// The map acts before the present one. One that is `None` makes the space unusable.
    fn concat(&mut self, span: Span, map: Option<DAffine3>) {
        let map = map.filter(DAffine3::is_finite).ok_or(span);
        self.now.space = self.now.space.and_then(|space| Ok(space * map?));
    }

    fn declare(&mut self, span: Span, arguments: &[Argument]) -> Result<(), Diagnostic> {
        let texts: Vec<String> = arguments.iter().filter_map(|one| self.lone_text(one)).collect();
        let [name, declaration] = <[String; 2]>::try_from(texts)
            .map_err(|_| Diagnostic::error(Some(span), "Declare takes a name and a declaration"))?;
        self.declared.insert(name, declaration);
        Ok(())
    }

    fn lone_text(&self, argument: &Argument) -> Option<String> {
        match &argument.values {
            ArgumentValues::Texts(texts) => texts.first().map(|&text| self.scanner.text(text)),
            ArgumentValues::Numbers(_) => None,
        }
    }

    /// The handle of an object: a number or a string.
    fn handle(&self, span: Span, arguments: &[Argument]) -> Result<String, Diagnostic> {
        let handle = arguments.first().and_then(|argument| match &argument.values {
            ArgumentValues::Numbers(numbers) => numbers.first().map(f64::to_string),
            ArgumentValues::Texts(_) => self.lone_text(argument),
        });
        handle.ok_or_else(|| Diagnostic::error(Some(span), "the object has no handle"))
    }

    /// The shapes of an object once more, in the present space and colour.
    fn instance(&mut self, span: Span, arguments: &[Argument]) -> Result<(), Diagnostic> {
        let handle = self.handle(span, arguments)?;
        let Some(trees) = self.objects.get(&handle).filter(|_| self.open.is_none()) else {
            let message = format!("there is no object {} here", clip(&handle));
            return Err(Diagnostic::error(Some(span), message));
        };
        let space = self.space()?;
        let tree = match trees.as_slice() {
            [] => return Ok(()),
            [tree] => tree.clone(),
            several => Tree::at(span, Combinator::from(Union {}), several.to_vec()),
        };
        self.trees.push(placed(colored(tree, self.now.color), &space).located(span));
        Ok(())
    }

    /// The present space, if it can be used.
    fn space(&self) -> Result<DAffine3, Diagnostic> {
        self.now.space.map_err(|culprit| {
            let what = self.scanner.text(culprit);
            let error = Diagnostic::error(Some(culprit), format!("no shape can be placed by this {what}"));
            error.expected("expected an affine map that has an inverse")
        })
    }

    /// A `Blobby` in the present space.
    fn blobby(&mut self, span: Span, arguments: &[Argument]) -> Result<(), Diagnostic> {
        let [count, codes, floats, rest @ ..] = arguments else {
            return Err(usage(span));
        };
        let (
            ArgumentValues::Numbers(count),
            ArgumentValues::Numbers(code_numbers),
            ArgumentValues::Numbers(float_numbers),
        ) = (&count.values, &codes.values, &floats.values)
        else {
            return Err(usage(span));
        };
        let (texts, parameters) = strings(rest);
        let texts: Vec<String> = texts.iter().map(|&text| self.scanner.text(text)).collect();
        let program = BlobbyProgram {
            codes: code_numbers,
            floats: float_numbers,
            texts: &texts,
            span: codes.span,
            floats_span: floats.span,
        };
        let instructions = program.instructions()?;
        let leaves = instructions.iter().filter(|(code, _)| *code >= 1000).count();
        if count.as_slice() != [leaves as f64] {
            let said = count.first().copied().unwrap_or(f64::NAN);
            let message = format!("the Blobby says that it has {said} leaves, and has {leaves}");
            self.warnings
                .extend((self.warnings.len() < 50).then(|| Diagnostic::warning(Some(span), message)));
        }
        let (colors, common) = self.colors(leaves, parameters)?;
        let field = program.field(&instructions, &colors)?;
        let space = self.space()?;
        let tree = self.bounded(span, field);
        let tree = placed(colored(tree, common.or(self.now.color)), &space).located(span);
        match self.open.as_ref().and_then(|handle| self.objects.get_mut(handle)) {
            Some(object) => object.push(tree),
            None => self.trees.push(tree),
        }
        Ok(())
    }

    /// A field that is 0 beyond the supports of its leaves, where it can be.
    fn bounded(&mut self, span: Span, field: blobby::BlobbyField) -> Tree {
        if field.far == 0.0 {
            return field.tree;
        }
        if field.far >= ISO || field.bounds.is_empty() {
            let message = "the Blobby is inside of its surface everywhere beyond its leaves";
            self.left_out.note(span, message);
            return field.tree;
        }
        self.left_out.note(span, "the constant field of a Blobby ends at the box of its leaves");
        field.tree.within(field.bounds.min.to_array(), field.bounds.max.to_array())
    }

    /// The colours of a `Blobby`: of each leaf, or of all.
    fn colors(
        &mut self,
        leaves: usize,
        parameters: &[Argument],
    ) -> Result<(LeafColors, Option<[f64; 3]>), Diagnostic> {
        let mut colors = (LeafColors::Common, None);
        for pair in parameters.chunks(2) {
            let Some(name) = self.lone_text(&pair[0]) else {
                return Err(Diagnostic::error(Some(pair[0].span), "expected the name of a parameter"));
            };
            let words: Vec<&str> = name.split_whitespace().collect();
            let (own, class) = match words.as_slice() {
                [own] => (*own, self.declared.get(*own).cloned().unwrap_or_default()),
                [class @ .., own] => (*own, class.join(" ")),
                [] => ("", String::new()),
            };
            if own != "Cs" {
                let message = format!("the parameter {} of a Blobby is left out", clip(own));
                self.left_out.note(pair[0].span, &message);
                continue;
            }
            let Some(Argument { values: ArgumentValues::Numbers(numbers), span, .. }) = pair.get(1) else {
                return Err(Diagnostic::error(Some(pair[0].span), "the colour Cs has no numbers"));
            };
            let is_one = class.starts_with("constant") || class.starts_with("uniform");
            let is_each = class.starts_with("vertex") || class.starts_with("varying");
            if numbers.len() == 3 && !is_each {
                colors = (LeafColors::Common, Some(vector(numbers).into()));
            } else if numbers.len() == 3 * leaves && !is_one {
                let each = numbers.chunks_exact(3).map(|one| [one[0], one[1], one[2]]);
                colors = (LeafColors::Each(each.collect()), None);
            } else {
                let message = format!("the colour Cs has {} numbers", numbers.len());
                let error = Diagnostic::error(Some(*span), message);
                let each = 3 * leaves;
                return Err(error.expected(if is_one {
                    "expected 3".to_owned()
                } else if is_each {
                    format!("expected {each}, 3 for each leaf")
                } else {
                    format!("expected 3, or {each}, 3 for each leaf")
                }));
            }
        }
        Ok(colors)
    }

    fn finish(mut self, length: usize) -> Result<(Model, Vec<Diagnostic>), Vec<Diagnostic>> {
        let mut warnings = std::mem::take(&mut self.warnings);
        if let Some((block, span, _)) = self.blocks.last() {
            let message = format!("{}Begin has no end", block.name());
            warnings.push(Diagnostic::warning(Some(*span), message));
        }
        warnings.extend(std::mem::take(&mut self.left_out).finish());
        if self.trees.is_empty() && self.errors.is_empty() {
            let end = Some(Span::new(length, length));
            self.errors.add(|| Diagnostic::error(end, "the file has no Blobby"));
        }
        if !self.errors.is_empty() {
            return Err([self.errors.finish(), warnings].concat());
        }
        let root = if self.trees.len() == 1 { self.trees.remove(0) } else { Tree::union(self.trees) };
        Ok((Model { iso: ISO.into(), orientation: Orientation::Y_LEFT, ..Model::new(root) }, warnings))
    }
}

/// The strings of a `Blobby`, if it has them, and its parameters: a lone string before another one is an
/// array of one.
fn strings(rest: &[Argument]) -> (&[Span], &[Argument]) {
    let is_name = |argument: Option<&Argument>| {
        argument.is_none_or(|one| matches!(one.values, ArgumentValues::Texts(_)))
    };
    match rest {
        [Argument { values: ArgumentValues::Texts(texts), is_lone, .. }, rest @ ..]
            if !is_lone || is_name(rest.first()) =>
        {
            (texts, rest)
        }
        [Argument { values: ArgumentValues::Numbers(numbers), is_lone: false, .. }, rest @ ..]
            if numbers.is_empty() =>
        {
            (&[], rest)
        }
        _ => (&[], rest),
    }
}

fn usage(span: Span) -> Diagnostic {
    let error = Diagnostic::error(Some(span), "the Blobby is not complete");
    error.expected("expected a number of leaves, [codes], [numbers], [strings]")
}

/// As many numbers as a request takes, in an array or without.
fn numbers(span: Span, arguments: &[Argument], count: usize) -> Result<Vec<f64>, Diagnostic> {
    let mut all = Vec::with_capacity(count);
    for argument in arguments {
        match &argument.values {
            ArgumentValues::Numbers(numbers) => all.extend(numbers),
            ArgumentValues::Texts(_) => {
                return Err(Diagnostic::error(Some(argument.span), "a string").expected("expected a number"));
            }
        }
    }
    if all.len() != count {
        let error = Diagnostic::error(Some(span), format!("the request has {} numbers", all.len()));
        return Err(error.expected(format!("expected {count}")));
    }
    Ok(all)
}

fn vector(numbers: &[f64]) -> DVec3 {
    DVec3::from_slice(numbers)
}

/// A tree whose leaves have this colour, unless they have their own. White is what leaves have without one.
fn colored(tree: Tree, color: Option<[f64; 3]>) -> Tree {
    match color {
        None | Some([1.0, 1.0, 1.0]) => tree,
        Some(color) => tree.color(color),
    }
}

fn unknown(word: &str) -> String {
    let near = nearest(word, request::names());
    let near = near.map_or_else(String::new, |near| format!("; perhaps {near}"));
    format!("{} is no request that is known{near}", clip(word))
}
