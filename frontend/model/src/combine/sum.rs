//! The sum of fields: the blend that made blobs famous (Blinn 1982). Homogeneous of degree 1, so the weight
//! of a child is its field.

use jbt_ir::Domain;

use super::member::{Finished, Fold, Met, Operator, Setting};
use crate::member::member;
use crate::skeleton::positive_part;

member! {
    /// The sum of the fields: the plain blend.
    ///
    /// ```
    /// use jbt_model::builder::point;
    /// use jbt_model::tree::Tree;
    ///
    /// let ball = |x: i32| point([x, 0, 0], 1);
    /// let row = Tree::sum((0..3).map(ball));
    /// assert_eq!(row, (0..3).map(ball).sum());
    /// let mut grown = ball(0) + ball(1);
    /// grown += ball(2);
    /// assert_eq!(row, grown);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Sum = "sum" {}
}

impl Operator for Sum {}

impl Fold for Sum {
    type Code = ();

    fn code(self, _: bool) {}

    fn field(self, fields: &[f64], _: f64) -> f64 {
        fields.iter().sum()
    }

    fn weights(self, fields: &[f64], _: f64) -> Vec<f64> {
        fields.iter().map(|f| f.max(0.0)).collect()
    }

    fn is_non_negative(self, children: bool) -> bool {
        children
    }

    /// A partial sum that is negative has no weight as a whole, though parts of it have.
    fn flattens(self, non_negative: bool) -> bool {
        non_negative
    }

    fn absorbs((): ()) -> bool {
        false
    }

    fn start<D: Domain>((): (), d: &mut D, _: Setting<'_, D::Real>) -> Vec<D::Real> {
        vec![d.constant(0.0)]
    }

    fn meet<D: Domain>(
        (): (),
        d: &mut D,
        so_far: &[D::Real],
        operand: D::Real,
        setting: Setting<'_, D::Real>,
        weighs: bool,
    ) -> Met<D::Real> {
        let sum = d.add(so_far[0], operand);
        let mut weight = || if setting.non_negative { operand } else { positive_part(d, operand) };
        Met { so_far: vec![sum], weight: weighs.then(&mut weight), rescale: None }
    }

    fn has_total((): (), non_negative: bool) -> bool {
        !non_negative
    }

    fn finish<D: Domain>(
        (): (),
        _: &mut D,
        so_far: &[D::Real],
        total: Option<D::Real>,
        _: Setting<'_, D::Real>,
    ) -> Finished<D::Real> {
        let total = total.unwrap_or(so_far[0]);
        Finished { field: so_far[0], total, seen: total }
    }
}
