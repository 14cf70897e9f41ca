//! What every texture implements.

use glam::DVec3;
use jbt_ir::Domain;

use crate::member::Member;

/// What a texture states about itself.
pub trait TextureMember: Member {
    /// What is wrong with the parameters beyond their kinds: a message and what is expected.
    fn fault(&self) -> Option<(String, String)> {
        None
    }

    /// The number at `p`, in f64: from 0 to 1.
    fn value(&self, p: DVec3) -> f64;

    /// The distance of `p` from the nearest jump of the number; infinity if it never jumps.
    fn kink_distance(&self, p: DVec3) -> f64;

    /// The part of the parameters that selects code. With `depends`, the numbers depend on parameters of the
    /// model, so the code must serve all values.
    fn variant(&self, depends: bool) -> u8 {
        let _ = depends;
        0
    }

    /// Names of the columns of a row, for a variant.
    fn columns(variant: u8) -> &'static [&'static str];

    /// The numbers of a row: one for each of [`columns`](Self::columns).
    fn push_columns(&self, variant: u8, row: &mut Vec<f64>);

    /// The number at `p`, over the ops; `row` holds the columns of a texture with this variant.
    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> D::Real;
}
