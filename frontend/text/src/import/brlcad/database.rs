//! A database of named objects, as all of its readers make it.

use std::collections::HashMap;

use jbt_ir::limits::MAX_NODES;
use jbt_model::attribute::Precedence;
use jbt_model::constant::{LARGEST_CONSTANT, LeafConstant};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::{Report, clip};
use jbt_model::word::{begins_name, continues_name, is_statement};

use super::solid::DatabaseSolid;

/// Letters of a name that its node has.
const LONGEST_NAME: usize = 128;

/// The objects of a file, in its order.
pub(super) struct Database<'a> {
    bytes: &'a [u8],
    /// The objects.
    pub(super) objects: Vec<Object>,
    by_name: HashMap<&'a [u8], u32>,
    /// Colours of regions that state none, by ranges of region numbers.
    pub(super) palette: Vec<PaletteRange>,
    /// Members of all combinations so far.
    pub(super) members: usize,
    pub(super) errors: Report,
    pub(super) warnings: Report,
}

/// Something with a name.
pub(super) struct Object {
    /// Its name: bytes of the file.
    pub(super) name: Span,
    /// Where it stands.
    pub(super) span: Span,
    /// What it is.
    pub(super) content: ObjectContent,
    /// What is said of it besides.
    pub(super) properties: Properties,
}

/// What an object is.
pub(super) enum ObjectContent {
    /// A set of points by itself.
    Solid(DatabaseSolid),
    /// Members, and how they are combined.
    Combination(Combination),
    /// A kind that is not read, by its name.
    Foreign(String),
    /// Text without a shape, as a title.
    Text,
}

/// What is said of an object beside its shape.
#[derive(Clone, Default, Debug)]
pub(super) struct Properties {
    /// Whether it is one piece of one material.
    pub(super) is_region: bool,
    /// Its colour, as screens have it.
    pub(super) color: Option<[u8; 3]>,
    /// Whether its colour and its shader hold for everything below.
    pub(super) inherits: bool,
    /// The number of a region.
    pub(super) region: Option<i64>,
    /// What is not solid, by its number; 0 is nothing special.
    pub(super) aircode: Option<i64>,
    /// The material of a region, by its number in a table of the user (GIFT).
    pub(super) material: Option<i64>,
    /// The material of a region, by its name.
    pub(super) material_name: Option<String>,
    /// What its surface looks like, in the words of a shader.
    pub(super) shader: Option<String>,
}

/// The colour of regions whose numbers are in a range.
pub(super) struct PaletteRange {
    pub(super) first: i64,
    pub(super) last: i64,
    pub(super) color: [u8; 3],
}

impl PaletteRange {
    /// The first number and the last one, and red, green and blue.
    pub(super) fn of(numbers: &[i64]) -> Option<Self> {
        let &[first, last, r, g, b] = numbers else { return None };
        let byte = |number: i64| u8::try_from(number).ok();
        Some(Self { first, last, color: [byte(r)?, byte(g)?, byte(b)?] })
    }
}

/// Members, and how they are combined.
#[derive(Default)]
pub(super) struct Combination {
    /// The members, in the order in which [`ProgramStep::Member`] takes them.
    pub(super) members: Vec<MemberUse>,
    /// Matrices of members, by rows.
    pub(super) matrices: Vec<[f64; 16]>,
    /// What is done, in postfix order; nothing stands for the union of all.
    pub(super) steps: Vec<ProgramStep>,
}

/// A use of an object.
#[derive(Clone, Copy)]
pub(super) struct MemberUse {
    /// Its name: bytes of the file.
    pub(super) name: Span,
    /// Its matrix, by the place in the list.
    pub(super) matrix: Option<u32>,
}

/// A step of a combination.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum ProgramStep {
    /// The next member.
    Member,
    Union,
    Intersection,
    Difference,
    /// What is in exactly one of two.
    Exclusive,
    /// What is outside.
    Complement,
}

impl ProgramStep {
    /// How many values it takes.
    pub(super) const fn takes(self) -> usize {
        match self {
            Self::Member => 0,
            Self::Complement => 1,
            Self::Union | Self::Intersection | Self::Difference | Self::Exclusive => 2,
        }
    }
}

impl<'a> Database<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            objects: Vec::new(),
            by_name: HashMap::new(),
            palette: Vec::new(),
            members: 0,
            errors: Report::default(),
            warnings: Report::default(),
        }
    }

    /// The bytes of a place.
    pub(super) fn at(&self, span: Span) -> &'a [u8] {
        &self.bytes[span.start as usize..span.end as usize]
    }

    /// The bytes of a place as text, for messages.
    pub(super) fn text(&self, span: Span) -> String {
        String::from_utf8_lossy(self.at(span)).into_owned()
    }

    /// The name of an object, as a node may have it.
    pub(super) fn node_name(&self, object: u32) -> String {
        let name = self.text(self.objects[object as usize].name);
        let letter = |c: char| if continues_name(c) { c } else { '_' };
        let name: String = name.chars().take(LONGEST_NAME).map(letter).collect();
        if name.starts_with(begins_name) && !is_statement(&name) { name } else { format!("o_{name}") }
    }

    /// The object of this name.
    pub(super) fn find(&self, name: &[u8]) -> Option<u32> {
        self.by_name.get(name).copied()
    }

    /// Adds an object. Of two with one name the first one counts.
    pub(super) fn add(&mut self, object: Object) {
        let (name, span) = (self.at(object.name), object.span);
        if self.by_name.contains_key(name) {
            let shown = clip(&self.text(object.name));
            self.warnings.add(|| {
                Diagnostic::warning(
                    Some(span),
                    format!("a second object is called `{shown}`; the first counts"),
                )
            });
            return;
        }
        self.by_name.insert(name, self.objects.len() as u32);
        self.objects.push(object);
    }

    /// Counts members of combinations. False, with a message, if there are too many.
    pub(super) fn count_members(&mut self, count: usize, span: Span) -> bool {
        self.members = self.members.saturating_add(count);
        let fits = self.members <= MAX_NODES;
        if !fits {
            let message = format!("the combinations of the file have more than {MAX_NODES} members");
            self.errors.add_last(Diagnostic::limit(Some(span), message));
        }
        fits
    }

    /// The colour that the palette has for a region.
    pub(super) fn palette_color(&self, region: i64) -> Option<[u8; 3]> {
        let range = self.palette.iter().find(|range| (range.first..=range.last).contains(&region));
        range.map(|range| range.color)
    }

    /// Takes a property of an object: the key and the value of an attribute. What is no property of these is
    /// nothing to a shape.
    pub(super) fn set(&mut self, properties: &mut Properties, key: &[u8], value: &[u8], span: Span) {
        let word = String::from_utf8_lossy(value);
        let is_yes = !matches!(word.trim(), "" | "0" | "no" | "n" | "N");
        match key {
            b"region" => properties.is_region = is_yes,
            b"inherit" => properties.inherits = is_yes,
            b"region_id" | b"id" => properties.region = word.trim().parse().ok(),
            b"aircode" | b"air" => properties.aircode = word.trim().parse().ok(),
            b"material_name" | b"material" if !word.trim().is_empty() => {
                properties.material_name = Some(line_of(&word));
            }
            b"material_id" | b"giftmater" | b"GIFTmater" | b"mat" => {
                properties.material = word.trim().parse().ok();
            }
            b"oshader" | b"shader" if !word.trim().is_empty() => properties.shader = Some(line_of(&word)),
            b"color" | b"rgb" => match color(&word) {
                Some(color) => properties.color = Some(color),
                None => {
                    let shown = clip(&word);
                    self.warnings.add(|| {
                        Diagnostic::warning(Some(span), format!("`{shown}` is no colour"))
                            .expected("expected red, green and blue from 0 to 255, as 255/128/0")
                    });
                }
            },
            _ => {}
        }
    }
}

/// A text without what ends a line or a quote.
pub(super) fn line_of(text: &str) -> String {
    let kept = |c: char| match c {
        '"' => '\'',
        c if c.is_control() => ' ',
        c => c,
    };
    text.trim().chars().map(kept).collect()
}

impl Properties {
    /// Whether solids below have a colour or constants of it.
    pub(super) fn has_looks(&self) -> bool {
        self.color.is_some() || self.constants().next().is_some()
    }

    /// Which of several colours or shaders on the way down counts.
    pub(super) fn of_looks(&self) -> Precedence {
        if self.inherits { Precedence::Override } else { Precedence::Nearest }
    }

    /// The constants of the solids below. Numbers count for regions alone.
    pub(super) fn constants(&self) -> impl Iterator<Item = (&'static str, LeafConstant, Precedence)> {
        let fits = |number: &i64| number.unsigned_abs() <= LARGEST_CONSTANT.unsigned_abs();
        let numbers = [
            ("region_id", self.region),
            ("aircode", self.aircode.filter(|&code| code != 0)),
            ("material_id", self.material),
        ];
        let numbers = numbers.into_iter().filter(|_| self.is_region);
        let numbers = numbers
            .filter_map(move |(name, number)| Some((name, number.filter(fits)?.into(), Precedence::Nearest)));
        let material = self.material_name.clone().filter(|_| self.is_region);
        let texts =
            [("material", material, Precedence::Nearest), ("shader", self.shader.clone(), self.of_looks())];
        numbers.chain(texts.into_iter().filter_map(|(name, text, how)| Some((name, text?.into(), how))))
    }
}

/// A colour: three bytes between slashes, blanks or commas.
pub(super) fn color(text: &str) -> Option<[u8; 3]> {
    let mut parts = text.split(['/', ' ', ',', '\t']).filter(|part| !part.is_empty());
    let color = [parts.next()?.parse().ok()?, parts.next()?.parse().ok()?, parts.next()?.parse().ok()?];
    parts.next().is_none().then_some(color)
}
