//! Rows: a small model, and what is known about it.

use jbt::{CheckedTree, Model};

/// A model with answers that were worked out by hand.
pub struct Row {
    /// What is special about it, among the rows of its member.
    pub name: &'static str,
    /// The model, without the `jbt 1` that it begins with.
    pub text: String,
    /// Points and the field there.
    pub fields: Vec<([f64; 3], f64)>,
    /// Points and attributes there.
    pub attributes: Vec<Attributes>,
    /// Where to look, if the support has no end in some direction.
    pub unbounded: Option<[[f64; 3]; 2]>,
}

/// The value of an attribute group at a point.
pub struct Attributes {
    /// The name of the group.
    pub group: &'static str,
    /// The point.
    pub at: [f64; 3],
    /// One real for each channel.
    pub values: Vec<f64>,
}

/// A row: a model (what follows `jbt 1`), and points with the field there. Some of the points are those where
/// formulas break: on skeletons, axes and rims.
pub fn row(name: &'static str, text: impl Into<String>, fields: &[([f64; 3], f64)]) -> Row {
    Row { name, text: text.into(), fields: fields.to_vec(), attributes: Vec::new(), unbounded: None }
}

impl Row {
    /// What an attribute group is at a point.
    pub fn attribute(mut self, group: &'static str, at: [f64; 3], values: &[f64]) -> Self {
        self.attributes.push(Attributes { group, at, values: values.to_vec() });
        self
    }

    /// The support has no end in some direction; points are taken between these corners.
    pub fn unbounded(mut self, low: [f64; 3], high: [f64; 3]) -> Self {
        self.unbounded = Some([low, high]);
        self
    }
}

/// A member of a family and its rows.
pub struct Member {
    /// The name of its variant.
    pub name: &'static str,
    /// At least one.
    pub rows: Vec<Row>,
}

/// The names of those members of a family that a model contains.
pub type Found = fn(&Model, &CheckedTree) -> Vec<&'static str>;

/// An open set.
pub struct Family {
    /// Its name, for messages.
    pub name: &'static str,
    /// Its members.
    pub members: Vec<Member>,
    /// The names of those members that a model contains.
    pub found: Found,
}

/// The rows of every variant of an enum, and `name`, which gives a value's variant.
///
/// `members! { Warp { Twist(_) => vec![row(..), row(..)], .. } }`: there is no way to write a wildcard for
/// variants, so the compiler asks for those that are missing.
macro_rules! members {
    ($kind:ident { $(
        $variant:ident $(($($part:pat),+))? $({ $($field:tt)* })? => $rows:expr
    ),+ $(,)? }) => {
        /// The name of a value's variant.
        const fn name(kind: &$kind) -> &'static str {
            match kind { $( $kind::$variant $(($($part),+))? $({ $($field)* })? => stringify!($variant), )+ }
        }

        fn members() -> Vec<$crate::row::Member> {
            vec![$( $crate::row::Member { name: stringify!($variant), rows: $rows }, )+]
        }
    };
}
pub(crate) use members;
