//! The columns of rows: what each is called, and its number.
//!
//! ```text
//! code  (emit)   a scribe that declares columns by their names, and answers the values in them
//! rows  (rows)   a scribe that pushes their numbers: of the first row of a table, it compares the names with those declared
//! ```
//!
//! A column stands here once, with both. The numbers are not asked for where there is only code to write, and
//! the names are not made where there are only numbers to write. Numbers are derived in f64.

use glam::{DAffine3, DVec3};

use super::instance::{FieldId, LeafField, Scene, SpaceId};
use super::position::MapKind;
use jbt_model::attribute::{AttributeGroup, UvMap};
use jbt_model::check::NodeId;
use jbt_model::combine::Combinator;
use jbt_model::expression::Expression;
use jbt_model::skeleton::{BEYOND, Skeleton};
use jbt_model::texture::{Texture, TextureKind};

/// Who goes through the columns of a row.
pub(super) trait Scribe {
    /// What columns are to it.
    type Row;

    /// The next columns: as many names as numbers are pushed.
    fn columns<N: AsRef<str>>(
        &mut self,
        names: impl IntoIterator<Item = N>,
        numbers: impl FnOnce(&mut Vec<f64>),
    ) -> Self::Row;
}

/// Twice the iso-value.
pub(super) fn iso2<S: Scribe>(s: &mut S, scene: &Scene<'_>) -> S::Row {
    s.columns(["iso2"], |row| row.push(2.0 * scene.tree.iso()))
}

/// The place of an operand in the file.
pub(super) fn order<S: Scribe>(s: &mut S, place: u32) -> S::Row {
    s.columns(["order"], |row| row.push(f64::from(place)))
}

/// The channels of an attribute group.
pub(super) fn channels<S: Scribe>(s: &mut S, group: &AttributeGroup, numbers: &[f64]) -> S::Row {
    s.columns((0..group.width()).map(|index| group.channel(index)), |row| row.extend(numbers))
}

/// The inverse of a map.
pub(super) fn map<S: Scribe>(s: &mut S, kind: MapKind, map: &DAffine3) -> S::Row {
    s.columns(kind.columns(), |row| kind.push_columns(map, row))
}

/// The warp at whose inside a space is.
pub(super) fn warp<S: Scribe>(s: &mut S, scene: &Scene<'_>, space: SpaceId) -> S::Row {
    let warp = scene.warp(scene.inside(space).expect("the world is no warp's inside").warp);
    let names = std::iter::once_with(|| warp.code().columns()).flatten();
    s.columns(names, |row| warp.columns(row))
}

/// The skeleton of a leaf.
pub(super) fn skeleton<S: Scribe>(s: &mut S, scene: &Scene<'_>, field: FieldId) -> S::Row {
    let LeafField { scale, code, .. } = scene.field(field);
    s.columns(code.skeleton.columns(), |row| scene.primitive(field).skeleton.columns(*scale, row))
}

/// A distance that is beyond the support of a leaf, in its pose.
pub(super) fn beyond<S: Scribe>(s: &mut S, scene: &Scene<'_>, field: FieldId) -> S::Row {
    s.columns(["beyond"], |row| row.push(BEYOND * scene.field(field).scale * scene.primitive(field).radius))
}

/// `-1 / R^2`, with the support radius of a leaf in its pose.
pub(super) fn slope<S: Scribe>(s: &mut S, scene: &Scene<'_>, field: FieldId) -> S::Row {
    let radius = |row: &mut Vec<f64>| {
        row.push(-(scene.field(field).scale * scene.primitive(field).radius).powi(-2));
    };
    s.columns(["neg_inv_r2"], radius)
}

/// The falloff of a leaf.
pub(super) fn falloff<S: Scribe>(s: &mut S, scene: &Scene<'_>, field: FieldId) -> S::Row {
    let kind = scene.field(field).code.falloff;
    s.columns(kind.columns(), |row| scene.primitive(field).falloff.columns(kind, row))
}

/// The strength of a leaf.
pub(super) fn strength<S: Scribe>(s: &mut S, scene: &Scene<'_>, field: FieldId) -> S::Row {
    s.columns(["strength"], |row| row.push(scene.primitive(field).strength))
}

/// An operator, whose columns have these names.
pub(super) fn operator<S: Scribe>(
    s: &mut S,
    scene: &Scene<'_>,
    node: NodeId,
    operator: Combinator,
    names: &[&str],
) -> S::Row {
    let numbers = |row: &mut Vec<f64>| {
        operator.push_columns(scene.tree.written(node).is_some(), scene.tree.iso(), row);
    };
    s.columns(names, numbers)
}

/// A formula, the corners of whose box are counted from a point.
pub(super) fn formula<S: Scribe>(s: &mut S, expression: &Expression, from: DVec3) -> S::Row {
    let names = std::iter::repeat_n("number", expression.form().numbers());
    s.columns(names, |row| row.extend(expression.numbers_from(from)))
}

/// A texture, as code of this kind.
pub(super) fn texture<S: Scribe>(s: &mut S, kind: TextureKind, texture: &Texture) -> S::Row {
    s.columns(kind.columns(), |row| kind.push_columns(texture, row))
}

/// The uv of a skeleton.
pub(super) fn uv<S: Scribe>(s: &mut S, skeleton: &Skeleton) -> S::Row {
    s.columns(skeleton.kind().uv_columns(), |row| skeleton.uv_columns(row))
}

/// A map of uv.
pub(super) fn uv_map<S: Scribe>(s: &mut S, map: &UvMap) -> S::Row {
    s.columns(["uu", "uv", "u", "vu", "vv", "v"], |row| row.extend(map.matrix().as_flattened()))
}
