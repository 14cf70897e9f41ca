//! What the writers of mesh files have in common: how they see a mesh, and how they fail.

use std::collections::HashSet;
use std::io::{self, Write};

use serde_json::{Value, json};
use thiserror::Error;

use jbt_ir::watch::{self, Stopped};
use jbt_model::constant::{ConstantValues, LeafConstant};

use crate::parallel::*;

use crate::mesh::{Attribute, Mesh};
use crate::span::span;

/// Why a writer stopped.
#[derive(Debug, Error)]
pub(super) enum WriteError {
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] io::Error),
    /// The format counts in 32 bits, and this is more: bytes or triangles.
    #[error("{0} are too many")]
    TooLarge(u64),
    /// Nobody wants the file any more.
    #[error("cancelled")]
    Cancelled,
}

impl From<Stopped> for WriteError {
    fn from(_: Stopped) -> Self {
        Self::Cancelled
    }
}

/// The linear colours of a mesh, if it has the attribute `color` of width 3: one for each vertex.
pub(super) fn colors(mesh: &Mesh) -> Option<&[[f32; 3]]> {
    let color = mesh.attributes.iter().find(|attribute| is_color(attribute));
    // Without a rest: the check has counted them.
    color.map(|attribute| attribute.values.as_chunks().0)
}

fn is_color(attribute: &Attribute) -> bool {
    attribute.name == "color" && attribute.width == 3
}

/// The uv of a mesh, if it has the attribute `uv` of width 2: as many chunks of two as vertices.
pub(super) fn uvs(mesh: &Mesh) -> Option<&[f32]> {
    mesh.attributes.iter().find(|attribute| is_uv(attribute)).map(|attribute| attribute.values.as_slice())
}

fn is_uv(attribute: &Attribute) -> bool {
    attribute.name == "uv" && attribute.width == 2
}

/// A real as formats without infinities and NaN have it: those are 0.
pub(super) fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

/// An attribute and the names that a file has for it.
pub(super) struct NamedAttribute<'a> {
    pub(super) names: Vec<String>,
    pub(super) attribute: &'a Attribute,
}

/// The attributes besides the colour and the uv. `spell` turns a stem of ASCII letters, digits and
/// underscores, and a width, into the names that the file needs; a number after the stem keeps them apart
/// from the names of the others and from reserved ones.
pub(super) fn others<'a>(
    mesh: &'a Mesh,
    reserved: &[&str],
    spell: fn(&str, usize) -> Vec<String>,
) -> Vec<NamedAttribute<'a>> {
    let known = [mesh.attributes.iter().position(is_color), mesh.attributes.iter().position(is_uv)];
    let mut taken: HashSet<String> = reserved.iter().map(|&name| name.to_owned()).collect();
    let mut named = Vec::new();
    for (index, attribute) in mesh.attributes.iter().enumerate() {
        if known.contains(&Some(index)) {
            continue;
        }
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let stem = match attribute.name.as_str() {
            "" => "attribute".to_owned(),
            name => name.chars().map(plain).collect(),
        };
        let mut names = spell(&stem, attribute.width);
        let mut number = 2;
        while names.iter().any(|name| taken.contains(name)) {
            names = spell(&format!("{stem}_{number}"), attribute.width);
            number += 1;
        }
        taken.extend(names.iter().cloned());
        named.push(NamedAttribute { names, attribute });
    }
    named
}

/// Items that a thread turns into bytes at a time.
const BLOCK: usize = 1 << 14;
/// Bytes of an item, about: a list of them grows.
const ITEM_BYTES: usize = 64;
/// Blocks whose bytes are in memory at once.
const BLOCKS: usize = 32;
/// Bytes that are written between two looks at whether the file is still wanted: archives compress them.
const PIECE: usize = 1 << 16;

/// Writes the bytes of items, one after the other. All threads make bytes, from the index of an item each.
pub(super) fn write_items(
    out: &mut impl Write,
    count: usize,
    bytes: impl Fn(usize, &mut Vec<u8>) -> io::Result<()> + Sync,
) -> Result<(), WriteError> {
    let block = |first: usize| {
        span!("bytes");
        watch::go_on()?;
        let mut block = Vec::new();
        watch::take(BLOCK * ITEM_BYTES);
        (first..count.min(first + BLOCK)).try_for_each(|item| bytes(item, &mut block))?;
        Ok(block)
    };
    for first in (0..count).step_by(BLOCK * BLOCKS) {
        let firsts: Vec<usize> = (first..count.min(first + BLOCK * BLOCKS)).step_by(BLOCK).collect();
        let blocks: Vec<Result<Vec<u8>, WriteError>> =
            scatter(|watches| firsts.into_par_iter().map(|first| watches.hold(|| block(first))).collect());
        for block in blocks {
            for piece in block?.chunks(PIECE) {
                watch::go_on()?;
                out.write_all(piece)?;
            }
        }
    }
    Ok(())
}

/// Makes something of each item, and looks now and then whether it is still wanted.
pub(super) fn of_each<T, R>(items: &[T], make: impl Fn(&T) -> R) -> Result<Vec<R>, Stopped> {
    const ITEMS: usize = 1 << 12;
    watch::take(items.len() * size_of::<R>());
    let mut made = Vec::with_capacity(items.len());
    for part in items.chunks(ITEMS) {
        watch::go_on()?;
        made.extend(part.iter().map(&make));
    }
    Ok(made)
}

/// Appends reals as little-endian bytes.
#[inline]
pub(super) fn push_reals(bytes: &mut Vec<u8>, values: impl IntoIterator<Item = f32>) {
    values.into_iter().for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
}

/// Appends three words as little-endian bytes.
#[inline]
pub(super) fn push_three(bytes: &mut Vec<u8>, words: [u32; 3]) {
    let mut three = [0; 12];
    for (place, word) in three.as_chunks_mut().0.iter_mut().zip(words) {
        *place = word.to_le_bytes();
    }
    bytes.extend_from_slice(&three);
}

/// A constant as JSON: a number or a string.
#[must_use]
pub fn constant_json(constant: &LeafConstant) -> Value {
    match constant {
        LeafConstant::Whole(number) => json!(number),
        LeafConstant::Text(text) => json!(text),
    }
}

/// The values of a constant in one line: text as it is, and several with commas between.
pub(super) fn told(constant: &ConstantValues) -> String {
    let value = |value: &LeafConstant| match value {
        LeafConstant::Whole(number) => number.to_string(),
        LeafConstant::Text(text) => in_one_line(text),
    };
    constant.values.iter().map(value).collect::<Vec<_>>().join(", ")
}

/// Text for a line of its own: nothing but the check keeps line ends out, and options are anybody's.
pub(super) fn in_one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}
