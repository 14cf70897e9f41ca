//! The words of the text format: those that begin nodes, and those of what is no member.

use std::borrow::Cow;
use std::f64::consts::PI;

use jbt_model::combine::CombinatorKind;
use jbt_model::field::Field;
pub use jbt_model::function::Function;
use jbt_model::map::MapKind;
use jbt_model::skeleton::SkeletonKind;
use jbt_model::texture::TextureKind;
use jbt_model::warp::WarpKind;
use jbt_model::word::{OVERRIDE, STYLE, is_statement};

/// The word before the name of an attribute group that is called like a word of the format.
pub(super) const GROUP_NODE: &str = "with";

/// The parameters that every primitive has.
pub const COMMON_FIELDS: [&str; 4] = ["radius", "surface_radius", "falloff", "strength"];

/// The word before the block of a warp that a second child weighs.
pub(super) const WEIGHTED: &str = "weighted";

/// The word for a parameter of a skeleton: its name, after the skeleton's where every primitive has one of
/// that name.
pub(super) fn field_word(kind: SkeletonKind, field: &Field) -> Cow<'static, str> {
    if COMMON_FIELDS.contains(&field.name) {
        Cow::Owned(format!("{}_{}", kind.name(), field.name))
    } else {
        Cow::Borrowed(field.name)
    }
}

/// The word for a formula.
pub(super) const EXPRESSION: &str = "expression";

/// The word for particles.
pub(super) const PARTICLES: &str = "particles";

/// The word for a node whose field is 0 everywhere. A group or a definition may have this name.
pub(super) const EMPTY: &str = "empty";

/// Words that begin a node unless they are the name of a value or a node where one may stand.
pub(super) const NAMES_FIRST: [&str; 2] = [OVERRIDE, STYLE];

/// The other words that begin a node.
pub(super) const OTHERS: [&str; 9] =
    ["use", "blend", "select", "expression", "within", "falloff", "warp", PARTICLES, GROUP_NODE];

/// Whether a word begins a node, or a statement, in every file: a group of this name needs the word `with`
/// before it.
pub(super) fn is_reserved(word: &str) -> bool {
    is_statement(word) || fixed_words().any(|fixed| fixed == word)
}

/// The words that begin a node in every file; one that begins several maps or operators is there as often.
pub(super) fn fixed_words() -> impl Iterator<Item = &'static str> {
    let members = SkeletonKind::ALL.iter().map(|kind| kind.name());
    let warps = WarpKind::ALL.iter().map(|kind| kind.name());
    let maps = MapKind::ALL.iter().map(|kind| kind.name());
    members.chain(warps).chain(CombinatorKind::ALL.iter().map(|kind| kind.name())).chain(OTHERS).chain(maps)
}

pub(super) const CONSTANTS: &[(&str, f64)] = &[("pi", PI)];

/// Whether a word means something else already where a number may stand, so that no parameter may have it.
pub(super) fn is_builtin(word: &str) -> bool {
    is_statement(word) || Function::named(word).is_some_and(Function::is_reserved) || constant(word).is_some()
}

pub(super) fn constant(word: &str) -> Option<f64> {
    CONSTANTS.iter().find(|(name, _)| *name == word).map(|&(_, value)| value)
}

/// The texture that a word names.
pub(super) fn texture_named(word: &str) -> Option<TextureKind> {
    TextureKind::ALL.iter().copied().find(|kind| kind.name() == word)
}

/// Whether a word begins what is no list of numbers.
pub(super) fn is_value_word(word: &str) -> bool {
    word == EXPRESSION || texture_named(word).is_some()
}
