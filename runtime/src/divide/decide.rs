//! What decides about a box, and what it may say.

use super::cell::Cell;
use crate::boxes::Divisible;

/// What to do with a box. `D` is what the decider gives each box on its way down.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Decision<D> {
    /// Two parts, below and above a place strictly inside the box.
    Split {
        /// 0, 1 or 2.
        axis: usize,
        /// The coordinate that both parts have.
        at: f32,
        /// What the parts carry: below, above.
        data: [D; 2],
    },
    /// Eight parts around a point strictly inside the box.
    Octants {
        /// The corner that all parts have.
        at: [f32; 3],
        /// What the parts carry: x fastest, then y, then z.
        data: [D; 8],
    },
    /// The box is kept, with its region.
    Leaf,
    /// The box is done with.
    Stop,
}

/// What decides about each box, from the box and what it carries.
pub type Decide<'a, F, D> =
    dyn Fn(&Cell<'_, F>, &D) -> Result<Decision<D>, <F as Divisible>::Error> + Sync + 'a;
