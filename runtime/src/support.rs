//! Where a question about a model is asked if nobody says where: in the box of the model's support, grown a
//! little.

use jbt_model::check::CheckedTree;

use crate::boxes::Box3;

/// Why a model has no box of its own.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum NoBox {
    /// Its field is zero everywhere.
    Empty,
    /// Its field may differ from zero arbitrarily far away.
    Unbounded,
}

/// The part of the support's longest side by which the box exceeds it: more than f32 is off by, so that
/// rounded coordinates of the sides are outside.
pub(crate) const MARGIN: f64 = 1.0 / 512.0;

/// The box of a model's support and a little more, about the model's origin.
pub(crate) fn around(tree: &CheckedTree) -> Result<Box3<f64>, NoBox> {
    let support = tree.local_support();
    if support.is_empty() {
        return Err(NoBox::Empty);
    }
    if !support.is_finite() {
        return Err(NoBox::Unbounded);
    }
    let grown = support.grown(support.longest_side() * MARGIN);
    Ok(Box3::new(grown.low(), grown.high()))
}

/// As [`around`], rounded outwards.
pub(crate) fn around_in_f32(tree: &CheckedTree) -> Result<Box3, NoBox> {
    let Box3 { low, high } = around(tree)?;
    Ok(Box3::new(low.map(|side| (side as f32).next_down()), high.map(|side| (side as f32).next_up())))
}
