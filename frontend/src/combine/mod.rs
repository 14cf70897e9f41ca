//! Combinators: fields of the children become one field. One file per member, one list.
//!
//! A member has one of three forms, and a form has one place in the compiler:
//!
//! ```text
//! fold   sum, Ricci's blend, product, union, intersection     any number of children in any order: rows of tables
//! step   symmetric difference, smooth set operations,         F = step(.. step(step(f_1, f_2), f_3) .., f_n): children in order,
//!        R-functions                                          neighbours of one shape are rows of a table          (`step`)
//! map    complement, clamp, shell, offset                     one child                                            (`unary`)
//! ```
//!
//! and the difference, the first child without the union of the others, whose two sides may be left out where
//! they do not decide.
//!
//! A file states the plain formula in f64 for the oracle, and what the operator does with each row, pair or
//! field for the compiler, with the same formula over the ops. It also says what zeros do to it, because the
//! compiler leaves out what is zero in a box.
//!
//! | member | formula, iso-value c | 0 where | attributes |
//! |---|---|---|---|
//! | sum | `sum f_i` | all are | weights f_i |
//! | ricci n >= 1 | `(sum f_i^n)^(1/n)` | all are | weights f_i^n |
//! | ricci n <= -1 | the same | any is | weights f_i^n |
//! | product | `c prod (f_i / c)` | any is | equal weights |
//! | union, intersection | `max f_i`, `min f_i` | all, any | the winner's |
//! | difference | `min(f_1, max(0, 2 c - f_i))` | the first is | those of who decides |
//! | symmetric difference | `min(max(a, b), max(0, 2 c - min(a, b)))` | all are | those of who decides |
//! | smooth | the set operation, rounded where the fields differ by less than a width | as without `smooth` | weights f_i dF/df_i |
//! | rfunction | Rvachev's functions, less their background | all are | weights f_i dF/df_i |
//! | complement | `2 c - f` | the field is 2 c | the child's |
//! | clamp, shell, offset | see their files | the child is, but for clamps without 0 | the child's |

pub(crate) mod clamp;
pub(crate) mod complement;
pub(crate) mod difference;
pub(crate) mod extent;
pub(crate) mod intersection;
mod member;
pub(crate) mod offset;
pub(crate) mod product;
pub(crate) mod rfunction;
pub(crate) mod ricci;
mod set;
pub(crate) mod shell;
pub(crate) mod smooth;
pub(crate) mod step;
pub(crate) mod sum;
pub(crate) mod symmetric_difference;
pub(crate) mod unary;
pub(crate) mod union;

pub use rfunction::Family;
pub use set::SetOperation;

use step::StepKind;
use unary::UnaryKind;

/// A combinator of one or more children.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Combinator {
    /// The sum of the fields: the plain blend.
    Sum,
    /// Ricci's super-elliptic blend (Ricci 1973) with this exponent: in [1, 1024], where 1 is the sum and
    /// large ones are near the union, or in [-1024, -1], near the intersection.
    Ricci(f64),
    /// The product of the fields, each in units of the iso-value.
    Product,
    /// The largest field.
    Union,
    /// The smallest field.
    Intersection,
    /// The first child without the others.
    Difference,
    /// What is inside of an odd number of the children: of two, inside of exactly one.
    SymmetricDifference,
    /// A set operation that rounds where fields differ by less than this width, which is positive.
    Smooth(SetOperation, f64),
    /// A set operation by Rvachev's functions.
    RFunction(SetOperation, Family),
    /// Inside and outside exchanged.
    Complement,
    /// The field between two numbers.
    Clamp {
        /// The smallest value.
        low: f64,
        /// The largest value.
        high: f64,
    },
    /// A sheet around the surface of this thickness, in units of the field: in (0, 2 iso).
    Shell(f64),
    /// The surface moves to where the field is less than the iso-value by this: below iso.
    Offset(f64),
}

/// What a combinator is to the compiler.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Form {
    /// Operands in any order.
    Fold,
    /// The first child without the others.
    Difference,
    /// Two operands at a time, in order.
    Step(StepKind),
    /// One child.
    Map(UnaryKind),
}

impl Combinator {
    /// The word of the text format.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sum => "sum",
            Self::Ricci(_) => "ricci",
            Self::Product => "product",
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
            Self::SymmetricDifference => "symmetric_difference",
            Self::Smooth(SetOperation::Union, _) => "smooth_union",
            Self::Smooth(SetOperation::Intersection, _) => "smooth_intersection",
            Self::Smooth(SetOperation::Difference, _) => "smooth_difference",
            Self::RFunction(..) => "rfunction",
            Self::Complement => "complement",
            Self::Clamp { .. } => "clamp",
            Self::Shell(_) => "shell",
            Self::Offset(_) => "offset",
        }
    }

    /// What it is to the compiler.
    pub(crate) const fn form(self) -> Form {
        match self {
            Self::Sum | Self::Ricci(_) | Self::Product | Self::Union | Self::Intersection => Form::Fold,
            Self::Difference => Form::Difference,
            Self::SymmetricDifference => Form::Step(StepKind::SymmetricDifference),
            Self::Smooth(set, _) => Form::Step(StepKind::Smooth(set)),
            Self::RFunction(set, family) => Form::Step(StepKind::RFunction(set, family.kind())),
            Self::Complement => Form::Map(UnaryKind::Complement),
            Self::Clamp { .. } => Form::Map(UnaryKind::Clamp),
            Self::Shell(_) => Form::Map(UnaryKind::Shell),
            Self::Offset(_) => Form::Map(UnaryKind::Offset),
        }
    }

    /// Its numbers, which may follow parameters.
    pub(crate) fn numbers(self) -> Vec<f64> {
        match self {
            Self::Sum
            | Self::Product
            | Self::Union
            | Self::Intersection
            | Self::Difference
            | Self::SymmetricDifference
            | Self::Complement => Vec::new(),
            Self::Ricci(number) | Self::Smooth(_, number) | Self::Shell(number) | Self::Offset(number) => {
                vec![number]
            }
            Self::RFunction(_, family) => family.number().into_iter().collect(),
            Self::Clamp { low, high } => vec![low, high],
        }
    }

    /// The same with other numbers: as many as [`numbers`](Self::numbers) are.
    pub(crate) fn with_numbers(self, numbers: &[f64]) -> Self {
        match self {
            Self::Sum
            | Self::Product
            | Self::Union
            | Self::Intersection
            | Self::Difference
            | Self::SymmetricDifference
            | Self::Complement => self,
            Self::Ricci(_) => Self::Ricci(numbers[0]),
            Self::Smooth(set, _) => Self::Smooth(set, numbers[0]),
            Self::RFunction(set, family) => Self::RFunction(set, family.with_numbers(numbers)),
            Self::Clamp { .. } => Self::Clamp { low: numbers[0], high: numbers[1] },
            Self::Shell(_) => Self::Shell(numbers[0]),
            Self::Offset(_) => Self::Offset(numbers[0]),
        }
    }

    /// Whether a single child answers as if the operator were not there.
    #[must_use]
    pub const fn passes_single(self) -> bool {
        match self {
            Self::Union | Self::Intersection | Self::Product => true,
            Self::Difference | Self::SymmetricDifference | Self::Smooth(..) | Self::RFunction(..) => true,
            Self::Sum | Self::Ricci(_) => false,
            Self::Complement | Self::Clamp { .. } | Self::Shell(_) | Self::Offset(_) => false,
        }
    }

    /// Whether what its numbers may be depends on the iso-value.
    pub(crate) const fn asks_iso(self) -> bool {
        matches!(self, Self::Shell(_) | Self::Offset(_))
    }

    /// The field of the node from its children's fields, plainly.
    #[must_use]
    pub fn field(self, fields: &[f64], iso: f64) -> f64 {
        match self {
            Self::Sum => sum::field(fields),
            Self::Ricci(n) => ricci::field(fields, n),
            Self::Product => product::field(fields, iso),
            Self::Union => union::field(fields),
            Self::Intersection => intersection::field(fields),
            Self::Difference => difference::field(fields, iso),
            Self::SymmetricDifference | Self::Smooth(..) | Self::RFunction(..) => {
                self.as_step(|kind, number| kind.fold(number, fields, iso).0)
            }
            Self::Complement | Self::Clamp { .. } | Self::Shell(_) | Self::Offset(_) => {
                self.as_map(|kind, numbers| kind.field(fields[0], numbers, iso))
            }
        }
    }

    /// How much each child contributes, `max(0, f_i dF/df_i)` up to a common factor: what mixes attributes.
    ///
    /// By Euler's identity these add up to F for operators that are homogeneous of degree 1. What is
    /// subtracted counts by its complement, where it is there.
    #[must_use]
    pub fn weights(self, fields: &[f64], iso: f64) -> Vec<f64> {
        match self {
            Self::Sum => sum::weights(fields),
            Self::Ricci(n) => ricci::weights(fields, n),
            Self::Product => product::weights(fields, iso),
            Self::Union | Self::Intersection | Self::Difference => {
                let (winner, weight) = (self.winner(fields, iso), self.field(fields, iso).max(0.0));
                (0..fields.len()).map(|child| if Some(child) == winner { weight } else { 0.0 }).collect()
            }
            Self::SymmetricDifference | Self::Smooth(..) | Self::RFunction(..) => {
                self.as_step(|kind, number| kind.fold(number, fields, iso).1)
            }
            Self::Complement | Self::Clamp { .. } | Self::Shell(_) | Self::Offset(_) => {
                let seen = fields[0] > 0.0 && self.field(fields, iso) > 0.0;
                vec![if seen { 1.0 } else { 0.0 }]
            }
        }
    }

    /// The child that decides, where one does.
    #[must_use]
    pub fn winner(self, fields: &[f64], iso: f64) -> Option<usize> {
        match self {
            Self::Union => Some(union::winner(fields)),
            Self::Intersection => Some(intersection::winner(fields)),
            Self::Difference => Some(difference::winner(fields, iso)),
            Self::Sum | Self::Ricci(_) | Self::Product => None,
            Self::SymmetricDifference | Self::Smooth(..) | Self::RFunction(..) => None,
            Self::Complement | Self::Clamp { .. } | Self::Shell(_) | Self::Offset(_) => None,
        }
    }

    /// How far the fields are from where another child would win, or another formula hold; infinity if
    /// nothing is decided.
    #[must_use]
    pub fn kink_distance(self, fields: &[f64], iso: f64) -> f64 {
        match self {
            Self::Ricci(n) if n < 0.0 => ricci::kink_distance(fields),
            Self::Sum | Self::Ricci(_) | Self::Product => f64::INFINITY,
            Self::Union => union::kink_distance(fields),
            Self::Intersection => intersection::kink_distance(fields),
            Self::Difference => difference::kink_distance(fields, iso),
            Self::SymmetricDifference | Self::Smooth(..) | Self::RFunction(..) => {
                self.as_step(|kind, number| kind.kink_distance(number, fields, iso))
            }
            Self::Complement | Self::Clamp { .. } | Self::Shell(_) | Self::Offset(_) => {
                self.as_map(|kind, numbers| kind.kink_distance(fields[0], numbers, iso))
            }
        }
    }

    /// The kind of a step, and its number.
    pub(crate) fn step(self) -> Option<(StepKind, f64)> {
        match self.form() {
            Form::Step(kind) => Some((kind, self.numbers().first().copied().unwrap_or(0.0))),
            Form::Fold | Form::Difference | Form::Map(_) => None,
        }
    }

    /// What a step answers.
    fn as_step<T>(self, ask: impl FnOnce(StepKind, f64) -> T) -> T {
        let (kind, number) = self.step().expect("only steps are asked as steps");
        ask(kind, number)
    }

    /// What a map answers.
    fn as_map<T>(self, ask: impl FnOnce(UnaryKind, &[f64]) -> T) -> T {
        match self.form() {
            Form::Map(kind) => ask(kind, &self.numbers()),
            Form::Fold | Form::Difference | Form::Step(_) => unreachable!("only maps are asked as maps"),
        }
    }
}
