//! The columns of rows: what each is called, and its number.
//!
//! A column stands once, here. Its name is made of what all rows of a table have in common, which is an
//! argument. Its number is made of what stands at its place in a row, which the [recipe](super::recipe)
//! gives.

use std::iter::repeat_n;

use glam::{DMat3, DVec3};

use super::computed::{Computed, attribute as given};
use super::instance::Scene;
use super::names::Hoist;
use super::position::MapKind;
use super::recipe::{ColumnNumbers, Member};
use jbt_ir::limits::MAX_ATTRIBUTE_WIDTH;
use jbt_model::attribute::{AttributeGroup, AttributeValue, Textured};
use jbt_model::expression::Form;
use jbt_model::falloff::FalloffKind;
use jbt_model::skeleton::{BEYOND, SkeletonKind};
use jbt_model::texture::TextureKind;
use jbt_model::warp::WarpCode;

/// Neighbouring columns.
pub(super) struct Columns<N> {
    pub(super) names: N,
    /// As many as there are names.
    pub(super) numbers: ColumnNumbers,
}

/// The names of columns.
pub(super) trait Names: IntoIterator<Item: AsRef<str>> {}

impl<N: IntoIterator<Item: AsRef<str>>> Names for N {}

fn columns<N: Names>(
    names: N,
    numbers: impl Fn(&Scene<'_>, Member, &mut Vec<f64>) + Send + Sync + 'static,
) -> Columns<N> {
    Columns { names, numbers: Box::new(numbers) }
}

/// Twice the iso-value.
pub(super) fn iso2() -> Columns<impl Names> {
    columns(["iso2"], |scene, _, row| row.push(2.0 * scene.tree.iso()))
}

/// The place of an operand in the file.
pub(super) fn order() -> Columns<impl Names> {
    columns(["order"], |_, operand, row| {
        let (Member::Operand { order, .. } | Member::Particle { order, .. }) = operand else {
            unreachable!("only operands have an order")
        };
        row.push(f64::from(order));
    })
}

/// The channels of an attribute group, with these numbers.
fn channels(
    group: &AttributeGroup,
    numbers: impl for<'s> Fn(&'s Scene<'_>, Member) -> &'s [f64] + Send + Sync + 'static,
) -> Columns<impl Names> {
    let names = (0..group.width()).map(|index| group.channel(index));
    columns(names, move |scene, member, row| row.extend(numbers(scene, member)))
}

/// The default of the attribute group with this index.
pub(super) fn default(group: &AttributeGroup, index: usize) -> Columns<impl Names> {
    channels(group, move |scene, _| &scene.tree.attributes()[index].default)
}

/// What a leaf has of the attribute group with this index, if that is not computed at the point.
pub(super) fn attribute(group: &AttributeGroup, index: usize) -> Columns<impl Names> {
    let names = (0..group.width()).map(|index| group.channel(index));
    columns(names, move |scene, leaf, row| {
        let group = &scene.tree.attributes()[index];
        // Directions that several leaves share stand at the start of their space.
        if let Member::Hoisted(Hoist::Computed(id)) = leaf {
            let Computed { node, map, .. } = scene.computed(id);
            let AttributeValue::Numbers(numbers) = given(scene.tree, *node) else {
                unreachable!("the kind is that of the node")
            };
            push_turned(group, &map.matrix3, numbers, row);
            return;
        }
        let (bindings, _) = leaf.attributes(scene);
        // What particles are bound to besides their own values overrides these.
        if bindings[index].is_none()
            && let Some((particles, place)) = leaf.one_of(scene)
            && let Some(values_of) = particles.values_of(&group.name)
        {
            let position = scene.field(leaf.field(scene)).position;
            let mut room = [0.0; MAX_ATTRIBUTE_WIDTH];
            let values = &mut room[..group.width()];
            values.iter_mut().zip(values_of.of(place)).for_each(|(value, given)| *value = given);
            push_turned(group, &scene.position(position).map.matrix3, values, row);
            return;
        }
        let at = bindings[index].and_then(|bound| bound.at);
        let given: &[f64] = match bindings[index].map(|bound| given(scene.tree, bound.node)) {
            None => &group.default,
            Some(AttributeValue::Numbers(numbers)) => numbers,
            Some(AttributeValue::Textured(_) | AttributeValue::Uv(_) | AttributeValue::Expressed(_)) => {
                unreachable!("it is computed")
            }
        };
        match at {
            Some(at) => push_turned(group, &scene.position(at).map.matrix3, given, row),
            None => row.extend(given),
        }
    })
}

/// The values of a group as a space has them, by the linear part of the map to it.
fn push_turned(group: &AttributeGroup, map: &DMat3, values: &[f64], row: &mut Vec<f64>) {
    match *values {
        [x, y, z] if group.turns() => row.extend((*map * DVec3::new(x, y, z)).to_array()),
        _ => row.extend(values),
    }
}

/// The linear part of the map of what is computed of a group of directions, row by row.
pub(super) fn turn_of_computed(group: usize) -> Columns<impl Names> {
    let names = ["txx", "txy", "txz", "tyx", "tyy", "tyz", "tzx", "tzy", "tzz"];
    columns(names, move |scene, member, row| {
        row.extend(computed(scene, member, group).map.matrix3.transpose().to_cols_array());
    })
}

/// The inverse of the map of a leaf, a warp or a formula.
pub(super) fn map(kind: MapKind) -> Columns<impl Names> {
    columns(kind.columns(), move |scene, member, row| {
        member.with_map(scene, |map| kind.push_columns(map, row));
    })
}

/// The inverse of the map of what is computed of an attribute group.
pub(super) fn map_of_computed(kind: MapKind, group: usize) -> Columns<impl Names> {
    columns(kind.columns(), move |scene, member, row| {
        kind.push_columns(&member.map_of_computed(scene, group), row);
    })
}

/// A warp.
pub(super) fn warp(code: &WarpCode) -> Columns<impl Names> {
    columns(code.columns(), |scene, warp, row| scene.warp(warp.node(scene)).columns(row))
}

/// How many times as large as it was written the skeleton of a leaf is in its pose.
fn scale(scene: &Scene<'_>, leaf: Member) -> f64 {
    scene.field(leaf.field(scene)).scale
}

/// The support radius of a leaf in its pose.
fn reach(scene: &Scene<'_>, leaf: Member) -> f64 {
    let (field, numbers) = leaf.leaf(scene);
    field.scale * numbers.radius
}

/// The skeleton of a leaf.
pub(super) fn skeleton(kind: SkeletonKind) -> Columns<impl Names> {
    columns(kind.columns(), |scene, member, row| {
        scene.primitive(member.field(scene)).skeleton.columns(scale(scene, member), row);
    })
}

/// A distance that is beyond the support of a leaf, in its pose.
pub(super) fn beyond() -> Columns<impl Names> {
    columns(["beyond"], |scene, member, row| {
        row.push(BEYOND * reach(scene, member));
    })
}

/// `-1 / R^2`, with the support radius of a leaf in its pose.
pub(super) fn neg_inv_r2() -> Columns<impl Names> {
    columns(["neg_inv_r2"], |scene, member, row| {
        row.push(-reach(scene, member).powi(-2));
    })
}

/// The falloff of a leaf.
pub(super) fn falloff(kind: FalloffKind) -> Columns<impl Names> {
    columns(kind.columns(), move |scene, member, row| member.numbers(scene).falloff.columns(kind, row))
}

/// The strength of a leaf.
pub(super) fn strength() -> Columns<impl Names> {
    columns(["strength"], |scene, member, row| row.push(member.numbers(scene).strength))
}

/// An operator, whose columns have these names.
pub(super) fn operator(names: &'static [&'static str]) -> Columns<impl Names> {
    columns(names, |scene, member, row| {
        let depends = scene.tree.dependent(member.node(scene)).is_some();
        member.operator(scene).push_columns(depends, scene.tree.iso(), row);
    })
}

/// A formula.
pub(super) fn formula(form: &Form) -> Columns<impl Names> {
    columns(repeat_n("number", form.numbers()), |scene, member, row| {
        row.extend(scene.expression(member.node(scene)).numbers_from(member.shift(scene)));
    })
}

/// What is computed of an attribute group for a leaf, or for all that share it.
fn computed<'s>(scene: &'s Scene<'_>, member: Member, group: usize) -> &'s Computed {
    scene.computed(member.computed(scene, group).expect("it is no number"))
}

/// A texture, as code of this kind.
pub(super) fn texture(kind: TextureKind, group: usize) -> Columns<impl Names> {
    columns(kind.columns(), move |scene, member, row| {
        kind.push_columns(&computed(scene, member, group).textured(scene.tree).texture, row);
    })
}

/// The channels of one side of a texture.
pub(super) fn side(group: &AttributeGroup, index: usize, of: fn(&Textured) -> &[f64]) -> Columns<impl Names> {
    let names = (0..group.width()).map(|channel| group.channel(channel));
    columns(names, move |scene, member, row| {
        let computed = computed(scene, member, index);
        let values = of(computed.textured(scene.tree));
        push_turned(&scene.tree.attributes()[index], &computed.map.matrix3, values, row);
    })
}

/// The uv of a skeleton.
pub(super) fn uv(kind: SkeletonKind, group: usize) -> Columns<impl Names> {
    columns(kind.uv_columns(), move |scene, member, row| {
        computed(scene, member, group).uv(scene.tree).0.uv_columns(row);
    })
}

/// The map of uv.
pub(super) fn uv_map(group: usize) -> Columns<impl Names> {
    columns(["uu", "uv", "u", "vu", "vv", "v"], move |scene, member, row| {
        row.extend(computed(scene, member, group).uv(scene.tree).1.matrix().as_flattened());
    })
}

/// A formula that is an attribute.
pub(super) fn formula_of_attribute(form: &Form, group: usize) -> Columns<impl Names> {
    columns(repeat_n("number", form.numbers()), move |scene, member, row| {
        row.extend(computed(scene, member, group).formula(scene.tree).numbers_from(DVec3::ZERO));
    })
}
