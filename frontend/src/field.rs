//! Named parameters of the members of the open sets (skeletons, falloffs, warps): one description serves the text
//! parser, the printer, the check and the documentation.

/// What a parameter may be.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum FieldKind {
    /// Any finite number.
    Real,
    /// A finite number of at least [`jbt_ir::limits::MIN_LENGTH`].
    Positive,
    /// A finite number of at least 0.
    NonNegative,
    /// A number in a range, ends included.
    Within {
        /// The smallest one.
        least: f64,
        /// The largest one.
        most: f64,
    },
    /// One of these words; stored as its place, from 0.
    Choice(&'static [&'static str]),
    /// A whole number from 0 to [`jbt_ir::limits::MAX_COPIES`].
    Count,
    /// An angle in degrees, from 0 to 360.
    Degrees,
    /// Three finite numbers: a position.
    Position,
    /// Three finite numbers of at least 0: sizes along the axes.
    Extents,
    /// Three finite numbers of at least [`jbt_ir::limits::MIN_LENGTH`]: factors along the axes.
    Stretches,
    /// Three finite numbers, not all zero: a direction, normalised before use.
    Direction,
    /// One of the words x, y, z; stored as the unit vector of that axis.
    Axis,
    /// Any number of positions, at most [`jbt_ir::limits::MAX_SKELETON_POINTS`].
    Positions,
    /// Any number of finite numbers of at least 0, as many at most.
    Lengths,
    /// One of the words yes and no; stored as 1 and 0.
    Flag,
}

/// A parameter of a member.
#[derive(Clone, PartialEq, Debug)]
pub struct Field {
    /// Its name in the text format.
    pub name: &'static str,
    /// What it may be.
    pub kind: FieldKind,
    /// What it is when it is not written; `None`: it has to be written.
    pub default: Option<FieldValue>,
}

/// The value of a parameter.
#[derive(Clone, PartialEq, Debug)]
pub enum FieldValue {
    /// One number.
    Real(f64),
    /// Three numbers.
    Vector([f64; 3]),
    /// Any number of numbers.
    Reals(Vec<f64>),
    /// Any number of vectors.
    Vectors(Vec<[f64; 3]>),
}

impl FieldValue {
    /// The number. Panics on anything else: the kind of the field has excluded it.
    #[must_use]
    pub fn real(&self) -> f64 {
        match self {
            Self::Real(value) => *value,
            Self::Vector(_) | Self::Reals(_) | Self::Vectors(_) => {
                panic!("the field is a number by its kind")
            }
        }
    }

    /// The vector. Panics on anything else: the kind of the field has excluded it.
    #[must_use]
    pub fn vector(&self) -> [f64; 3] {
        match self {
            Self::Vector(value) => *value,
            Self::Real(_) | Self::Reals(_) | Self::Vectors(_) => panic!("the field is a vector by its kind"),
        }
    }

    /// The numbers of a list. Panics on anything else: the kind of the field has excluded it.
    #[must_use]
    pub fn reals(&self) -> &[f64] {
        match self {
            Self::Reals(values) => values,
            Self::Real(_) | Self::Vector(_) | Self::Vectors(_) => panic!("the field is a list by its kind"),
        }
    }

    /// The vectors of a list. Panics on anything else: the kind of the field has excluded it.
    #[must_use]
    pub fn vectors(&self) -> &[[f64; 3]] {
        match self {
            Self::Vectors(values) => values,
            Self::Real(_) | Self::Vector(_) | Self::Reals(_) => panic!("the field is a list by its kind"),
        }
    }
}

/// What every member of an open set has: a name, and parameters that can be written and read back.
pub trait Member: Sized {
    /// The word of the text format.
    const NAME: &'static str;
    /// The parameters, in the order in which they print.
    const FIELDS: &'static [Field];

    /// The member with these parameters: one value for each of [`FIELDS`](Self::FIELDS), of its kind.
    fn from_fields(values: &[FieldValue]) -> Self;

    /// The parameters: what [`from_fields`](Self::from_fields) was given.
    fn to_fields(&self) -> Vec<FieldValue>;
}
