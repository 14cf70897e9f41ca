//! One description of a member: its struct, its parameters, and all that follows from them. Members are
//! skeletons, falloffs, operators, warps, textures and maps; their lists are *open sets*: one may add.
//!
//! ```text
//! member! {
//!     /// A flat round plate.
//!     #[derive(Clone, Copy, PartialEq, Debug)]
//!     pub struct Disc = "disc" {
//!         /// Its middle.
//!         pub center: DVec3 [Position] = Vector([0.0; 3]),
//!         /// How far it reaches from the middle.
//!         pub radius: f64 [NonNegative],
//!     }
//! }
//! ```
//!
//! | part | what it is |
//! |---|---|
//! | `"disc"` | the word of the text format |
//! | `center: DVec3` | a field of the struct: its name is that of the text format, its type is one that implements `ParameterType` |
//! | `[Position]` | the [`FieldKind`](crate::field::FieldKind): what the value may be |
//! | `= Vector([0.0; 3])` | the [`FieldValue`] that counts where the parameter is not written; without one, it has to be |
//!
//! `member!` writes the struct and its [`Member`]. It also defines the macro `describe!` of the file, which
//! hands the description on to another macro: constructors of the [builder](crate::builder) are made of it. A
//! file describes one member.

use std::sync::Arc;

use glam::DVec3;

use crate::axis::Axis;
use crate::field::{Field, FieldValue};

/// What every member of an open set has: a name, and parameters that can be written and read back.
pub trait Member: Sized {
    /// The word of the text format.
    const NAME: &'static str;
    /// The parameters, in the order in which they print.
    const FIELDS: &'static [Field];

    /// The member with these parameters: one value for each of [`FIELDS`](Self::FIELDS), of its kind. Panics
    /// if there are more or fewer.
    fn from_fields(values: &[FieldValue]) -> Self;

    /// The parameters: what [`from_fields`](Self::from_fields) was given.
    fn to_fields(&self) -> Vec<FieldValue>;
}

/// The positions of a member.
pub type Positions = Arc<[DVec3]>;

/// The lengths of a member.
pub type Lengths = Arc<[f64]>;

/// The rows of a 3x4 matrix, the last column of which is the shift.
pub type Matrix = [[f64; 4]; 3];

/// A type that a field of a member may have.
pub(crate) trait ParameterType {
    /// The parameter from its value. Panics if that is of another shape: the kind of the field has excluded
    /// it.
    fn read(value: &FieldValue) -> Self;

    /// Its value.
    fn write(&self) -> FieldValue;
}

impl ParameterType for f64 {
    fn read(value: &FieldValue) -> Self {
        value.real()
    }

    fn write(&self) -> FieldValue {
        FieldValue::Real(*self)
    }
}

impl ParameterType for u32 {
    fn read(value: &FieldValue) -> Self {
        value.real() as Self
    }

    fn write(&self) -> FieldValue {
        FieldValue::Real(f64::from(*self))
    }
}

impl ParameterType for bool {
    fn read(value: &FieldValue) -> Self {
        value.real() != 0.0
    }

    fn write(&self) -> FieldValue {
        FieldValue::Real(f64::from(u8::from(*self)))
    }
}

impl ParameterType for DVec3 {
    fn read(value: &FieldValue) -> Self {
        value.vector().into()
    }

    fn write(&self) -> FieldValue {
        FieldValue::Vector(self.to_array())
    }
}

impl ParameterType for Axis {
    fn read(value: &FieldValue) -> Self {
        Self::along(value.vector())
    }

    fn write(&self) -> FieldValue {
        FieldValue::Vector(self.unit().to_array())
    }
}

impl ParameterType for Positions {
    fn read(value: &FieldValue) -> Self {
        value.vectors().iter().map(|&point| point.into()).collect()
    }

    fn write(&self) -> FieldValue {
        FieldValue::Vectors(self.iter().map(DVec3::to_array).collect())
    }
}

impl ParameterType for Lengths {
    fn read(value: &FieldValue) -> Self {
        value.reals().into()
    }

    fn write(&self) -> FieldValue {
        FieldValue::Reals(self.to_vec())
    }
}

impl ParameterType for Matrix {
    fn read(value: &FieldValue) -> Self {
        let (rows, _) = value.reals().as_chunks::<4>();
        std::array::from_fn(|row| rows[row])
    }

    fn write(&self) -> FieldValue {
        FieldValue::Reals(self.as_flattened().to_vec())
    }
}

/// Describes a member. See the module.
macro_rules! member {
    (
        $(#[$($attribute:tt)*])*
        pub struct $name:ident = $word:literal {
            $(
                $(#[$about:meta])*
                pub $field:ident: $type:ident [$kind:expr] $(= $default:expr)?,
            )*
        }
    ) => {
        $(#[$($attribute)*])*
        pub struct $name {
            $( $(#[$about])* pub $field: $type, )*
        }

        impl $crate::member::Member for $name {
            const NAME: &'static str = $word;
            const FIELDS: &'static [$crate::field::Field] = &[$( $crate::field::Field {
                name: stringify!($field),
                kind: {
                    #[allow(unused_imports)]
                    use $crate::field::FieldKind::*;
                    $kind
                },
                default: $crate::member::default!($($default)?),
            } ),*];

            fn from_fields(values: &[$crate::field::FieldValue]) -> Self {
                let [$($field),*] = values else { panic!("a value for each parameter") };
                Self { $( $field: $crate::member::ParameterType::read($field) ),* }
            }

            fn to_fields(&self) -> Vec<$crate::field::FieldValue> {
                vec![$( $crate::member::ParameterType::write(&self.$field) ),*]
            }
        }

        $crate::member::describe! { ($) $(#[$($attribute)*])* $name { $( $field: $type ($($default)?) )* } }
    };
}

/// The default of a parameter, if it has one.
macro_rules! default {
    () => {
        None
    };
    ($default:expr) => {{
        #[allow(unused_imports)]
        use $crate::field::FieldOf::*;
        Some($default)
    }};
}

/// Defines the macro `describe!` of a member's file: `describe! { then with these words }` is
/// `then! { with these words; attributes Name { field: Type (default) .. } }`.
macro_rules! describe {
    (($d:tt) $($description:tt)*) => {
        #[allow(unused_macros)]
        macro_rules! describe {
            ($d then:ident $d ($d words:tt)*) => {
                $d then! { $d ($d words)*; $($description)* }
            };
        }
        #[allow(unused_imports)]
        pub(crate) use describe;
    };
}

/// Defines the macro `each!` of a list: `each! { then words }` hands the description of each member on to
/// `then!`, behind the words and the name of its file.
macro_rules! each {
    (($d:tt) $folder:ident $($member:ident)+) => {
        macro_rules! each {
            ($d then:ident $d ($d words:tt)*) => {
                $( $crate::$folder::$member! { $d then $d ($d words)* $member } )+
            };
        }
        pub(crate) use each;
    };
}

pub(crate) use {default, describe, each, member};
