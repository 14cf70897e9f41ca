//! The models that something live is given, and the check of the last one.

use jbt_model::check::{CheckedModel, CheckedTree};
use jbt_model::model::Model;

use crate::error::CompileError;

/// A state of a model that a live mesh or contour takes: a [`Model`], or its check.
///
/// A model whose tree shares most of its nodes with the model before is checked, and lowered, where it
/// differs ([`CheckedModel`]). A check of a model says nothing about another one, so a [`CheckedTree`] is
/// lowered as a whole, unless it was made of the present one by
/// [parameters](CheckedTree::with_parameters).
#[derive(Clone, Copy, Debug)]
pub enum ModelState<'a> {
    /// A model, which is to be checked.
    Model(&'a Model),
    /// A checked model.
    Checked(&'a CheckedTree),
}

impl<'a> From<&'a Model> for ModelState<'a> {
    fn from(model: &'a Model) -> Self {
        Self::Model(model)
    }
}

impl<'a> From<&'a CheckedTree> for ModelState<'a> {
    fn from(tree: &'a CheckedTree) -> Self {
        Self::Checked(tree)
    }
}

/// The check of the last model that was given as a model. It may be one that was refused later on.
#[derive(Default)]
pub(super) struct LastModel(Option<CheckedModel>);

impl LastModel {
    /// The check of a model: of what differs from the last one.
    pub(super) fn check<'a>(
        &mut self,
        model: impl Into<ModelState<'a>>,
    ) -> Result<CheckedTree, CompileError> {
        let model = match model.into() {
            ModelState::Checked(tree) => return Ok(tree.clone()),
            ModelState::Model(model) => model,
        };
        let checked = match &mut self.0 {
            Some(checked) => {
                checked.edit(model)?;
                checked
            }
            none => none.insert(CheckedModel::new(model)?),
        };
        Ok(checked.tree().clone())
    }
}
