//! The product, each field in units of the iso-value: `F = iso prod (f_i / iso)`, for two `f_1 f_2 / iso`.
//!
//! It is an intersection that blends: 0 as soon as one field is, and iso where all are. A child whose field
//! is iso changes nothing, a larger one fattens the others. (ParsIP's smooth difference `a (1 - b)`, whose
//! iso is 1/2, is half the product of a and the complement of b.) `f_i dF/df_i` is F for every child, so
//! attributes mix with equal weights, where F is positive.

use jbt_ir::Domain;

use super::member::{Finished, Fold, Met, Operator, Setting};
use crate::member::member;

member! {
    /// The product of the fields, each in units of the iso-value: an intersection that blends.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Product = "product" {}
}

impl Operator for Product {}

impl Fold for Product {
    type Code = ();
    const PASSES_SINGLE: bool = true;
    const IS_STEEP: bool = true;

    fn code(self, _: bool) {}

    fn field(self, fields: &[f64], iso: f64) -> f64 {
        iso * fields.iter().map(|f| f / iso).product::<f64>()
    }

    fn weights(self, fields: &[f64], iso: f64) -> Vec<f64> {
        let weight = if self.field(fields, iso) > 0.0 { 1.0 } else { 0.0 };
        vec![weight; fields.len()]
    }

    fn is_non_negative(self, children: bool) -> bool {
        children
    }

    fn absorbs((): ()) -> bool {
        true
    }

    /// The product of no operands: iso.
    fn start<D: Domain>((): (), d: &mut D, setting: Setting<'_, D::Real>) -> Vec<D::Real> {
        let half = d.constant(0.5);
        vec![d.mul(setting.iso2, half)]
    }

    /// A zero makes it a zero of some sign, for good.
    fn meet<D: Domain>(
        (): (),
        d: &mut D,
        so_far: &[D::Real],
        operand: D::Real,
        setting: Setting<'_, D::Real>,
        weighs: bool,
    ) -> Met<D::Real> {
        let two = d.constant(2.0);
        let inverse = d.div(two, setting.iso2);
        let relative = d.mul(operand, inverse);
        let product = d.mul(so_far[0], relative);
        Met { so_far: vec![product], weight: weighs.then(|| d.constant(1.0)), rescale: None }
    }

    fn has_total((): (), _: bool) -> bool {
        true
    }

    /// No zero is negative.
    fn finish<D: Domain>(
        (): (),
        d: &mut D,
        so_far: &[D::Real],
        total: Option<D::Real>,
        _: Setting<'_, D::Real>,
    ) -> Finished<D::Real> {
        let zero = d.constant(0.0);
        let field = d.add(so_far[0], zero);
        Finished { field, total: total.unwrap_or(field), seen: field }
    }
}
