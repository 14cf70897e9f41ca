//! What a model says besides its tree, as bytes: iso-value, origin, orientation, groups of attributes.

use jbt_model::attribute::{AttributeGroup, GroupKind, Mixing};
use jbt_model::check::CheckedTree;
use jbt_model::model::Model;
use jbt_model::orientation::{Handed, ModelUp, Orientation};
use jbt_model::origin::ModelOrigin;

use crate::bytes::{ByteReader, ByteWriter, FormatError};

/// Writes it.
pub(super) fn write(tree: &CheckedTree, writer: &mut ByteWriter) {
    writer.f64(tree.iso());
    tree.origin().point().into_iter().for_each(|x| writer.f64(x));
    let Orientation { up, handed } = tree.orientation();
    writer.u8(place(&ModelUp::ALL, up));
    writer.u8(place(&Handed::ALL, handed));
    writer.count(tree.attributes().len());
    for AttributeGroup { name, default, mixing, kind, titles } in tree.attributes() {
        writer.text(name);
        writer.u8(place(&Mixing::ALL, *mixing));
        writer.u8(place(&GroupKind::ALL, *kind));
        writer.count(default.len());
        default.iter().for_each(|&number| writer.f64(number));
        writer.count(titles.len());
        titles.iter().for_each(|title| writer.text(title));
    }
}

/// Reads it: a model of which everything but the tree counts.
pub(super) fn read(reader: &mut ByteReader<'_>) -> Result<CheckedTree, FormatError> {
    let iso = reader.f64()?;
    let origin = [reader.f64()?, reader.f64()?, reader.f64()?];
    if origin.iter().any(|x| !x.is_finite()) {
        return Err(reader.error("an origin is finite"));
    }
    let (up, handed) = (reader.one_of(&ModelUp::ALL)?, reader.one_of(&Handed::ALL)?);
    let mut attributes = Vec::new();
    for _ in 0..reader.count(26)? {
        let name = reader.text()?.into();
        let (mixing, kind) = (reader.one_of(&Mixing::ALL)?, reader.one_of(&GroupKind::ALL)?);
        let count = reader.count(8)?;
        let default = (0..count).map(|_| reader.f64()).collect::<Result<Vec<_>, _>>()?;
        let titles = reader.count(8)?;
        if titles != 0 && titles != default.len() {
            return Err(reader.error("a group has a title for each real, or none"));
        }
        let titles = (0..titles).map(|_| Ok(reader.text()?.to_owned()));
        let titles = titles.collect::<Result<_, FormatError>>()?;
        attributes.push(AttributeGroup { name, default, mixing, kind, titles });
    }
    let anything = jbt_model::builder::point([0, 0, 0], 1);
    let model = Model {
        iso: iso.into(),
        attributes,
        orientation: Orientation { up, handed },
        ..Model::new(anything)
    };
    let tree = model.check().map_err(|wrong| {
        let first = wrong.iter().next().map_or_else(String::new, |one| one.message.clone());
        reader.error(format!("the head of the model: {first}"))
    })?;
    Ok(tree.with_origin(ModelOrigin::new(origin)))
}

/// The place of one of a list.
pub(super) fn place<T: PartialEq>(all: &[T], one: T) -> u8 {
    all.iter().position(|known| *known == one).expect("the list has them all") as u8
}
