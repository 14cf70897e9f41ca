//! Operators: fields of the children become one field. One file per member, one list.
//!
//! A member has one of these forms, and a form has one place in the compiler:
//!
//! ```text
//! fold        sum, Ricci's blend, product         any number of children in any order, each with a weight: rows of tables
//! choice      union, intersection                 any number of children in any order, one of which wins: rows of tables
//! difference  the first child without the         its two sides may be left out where they do not decide
//!             union of the others
//! step        symmetric difference, smooth set    F = step(.. step(step(f_1, f_2), f_3) .., f_n): children in order,
//!             operations, R-functions             neighbours of one shape are rows of a table
//! map         complement, clamp, shell, offset    one child
//! ```
//!
//! A file states the plain formula in f64 for the oracle, and what the operator does with each row, pair or
//! field for the compiler, with the same formula over the ops. It also says what zeros do to it, because the
//! compiler leaves out what is zero in a box. The traits are in `member`; what the members of a form have in
//! common is in `form`. To add one: write its file, add its line to the list below.
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

use jbt_ir::{Domain, Rule};

use crate::diagnostic::Diagnostic;
use crate::field::{Field, FieldValue};
use crate::member::Member as _;

pub mod difference;
mod enclosed;
pub mod extent;
mod extreme;
mod form;
mod limit;
mod member;
mod reduce;
mod rvachev;
mod set;
mod set_step;
mod smooth;

pub use extreme::Extreme;
pub use member::Syntax;
pub use member::{Finished, Met, PairResult, Setting, TakesApart};
pub use set::SetOperation;

use enclosed::enclosed;
use extent::Extent;
use form::{Choices, Differences, Folds, Maps, Plain, Steps};
use member::{Choice, Fold, Operator, Step, Unary};

/// What an operator is to the compiler: whatever selects code, without numbers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum OperatorForm {
    /// A fold, a choice or a step: any number of operands, which may be rows of a fold of the IR.
    Reduce(ReduceCode),
    /// The first child without the others.
    Difference,
    /// One child.
    Map(MapCode),
}

/// What an operator of any number of operands is as code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum ReduceCode {
    /// Operands in any order, each with a weight.
    Fold(FoldCode),
    /// Operands in any order, one of which wins.
    Choice(Extreme),
    /// Two operands at a time, in the order of the file.
    Step(StepCode),
}

macro_rules! operators {
    (
        fold { $($fold_file:ident :: $fold:ident),+ $(,)? }
        choice { $($choice_file:ident :: $choice:ident),+ $(,)? }
        difference { $difference_file:ident :: $difference:ident $(,)? }
        step { $($step_file:ident :: $step:ident),+ $(,)? }
        map { $($map_file:ident :: $map:ident),+ $(,)? }
    ) => {
        $( mod $fold_file; )+
        $( mod $choice_file; )+
        $( mod $step_file; )+
        $( mod $map_file; )+

        members! {
            $( $fold_file $fold Folds, )+
            $( $choice_file $choice Choices, )+
            $difference_file $difference Differences,
            $( $step_file $step Steps, )+
            $( $map_file $map Maps, )+
        }

        /// The descriptions of operators of any number of children.
        pub(crate) mod several {
            $crate::member::each! {
                ($) combine $($fold_file)+ $($choice_file)+ $difference_file $($step_file)+
            }
        }

        /// The descriptions of operators of one child.
        pub(crate) mod single {
            $crate::member::each! { ($) combine $($map_file)+ }
        }

        /// What of a fold selects code.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum FoldCode { $( #[doc = concat!("Of [`", stringify!($fold), "`].")] $fold(<$fold as Fold>::Code), )+ }

        impl FoldCode {
            /// Whether slopes of the field are not bounded by the sum of those of the operands.
            pub const fn is_steep(self) -> bool {
                match self { $( Self::$fold(_) => <$fold as Fold>::IS_STEEP, )+ }
            }

            /// See [`Fold::absorbs`].
            pub(crate) fn absorbs(self) -> bool {
                match self { $( Self::$fold(code) => <$fold as Fold>::absorbs(code), )+ }
            }

            /// See [`Fold::columns`].
            fn columns(self) -> &'static [&'static str] {
                match self { $( Self::$fold(code) => <$fold as Fold>::columns(code), )+ }
            }

            /// Whether the sum of weights is an accumulator of its own.
            pub fn has_total(self, non_negative: bool) -> bool {
                match self { $( Self::$fold(code) => <$fold as Fold>::has_total(code, non_negative), )+ }
            }

            /// The accumulators before the first operand.
            pub fn start<D: Domain>(self, d: &mut D, setting: Setting<'_, D::Real>) -> Vec<D::Real> {
                match self { $( Self::$fold(code) => <$fold as Fold>::start(code, d, setting), )+ }
            }

            /// One operand more; `weighs`: somebody asks for its weight.
            pub fn meet<D: Domain>(
                self,
                d: &mut D,
                so_far: &[D::Real],
                operand: D::Real,
                setting: Setting<'_, D::Real>,
                weighs: bool,
            ) -> Met<D::Real> {
                match self {
                    $( Self::$fold(code) => <$fold as Fold>::meet(code, d, so_far, operand, setting, weighs), )+
                }
            }

            /// The field and what shares are; `total` is the sum of weights, where that is an accumulator of
            /// its own.
            pub fn finish<D: Domain>(
                self,
                d: &mut D,
                so_far: &[D::Real],
                total: Option<D::Real>,
                setting: Setting<'_, D::Real>,
            ) -> Finished<D::Real> {
                match self {
                    $( Self::$fold(code) => <$fold as Fold>::finish(code, d, so_far, total, setting), )+
                }
            }
        }

        /// What of a step selects code.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum StepCode { $( #[doc = concat!("Of [`", stringify!($step), "`].")] $step(<$step as Step>::Code), )+ }

        impl StepCode {
            /// See [`Step::COLUMNS`].
            const fn columns(self) -> &'static [&'static str] { match self { $( Self::$step(_) => <$step as Step>::COLUMNS, )+ } }

            /// Whether the surface may have an edge where the two sides are equal.
            pub const fn creases(self) -> bool { match self { $( Self::$step(_) => <$step as Step>::CREASES, )+ } }

            /// See [`Step::rule`].
            fn rule(self, non_negative: bool) -> Rule {
                match self { $( Self::$step(code) => <$step as Step>::rule(code, non_negative), )+ }
            }

            /// See [`TakesApart`].
            pub fn takes_apart(self) -> Option<TakesApart> {
                match self { $( Self::$step(code) => <$step as Step>::takes_apart(code), )+ }
            }

            /// The field of two sides, `plain`, to the bit. Over ranges it is bounded by its values at the
            /// ends of the sides too, if it follows them in one way.
            pub fn bounded<D: Domain>(
                self,
                d: &mut D,
                (plain, sides): (D::Real, [D::Real; 2]),
                row: &[D::Real],
                iso2: D::Real,
            ) -> D::Real {
                match self { $( Self::$step(code) => enclosed::<$step, D>(code, d, (plain, sides), row, iso2), )+ }
            }

            /// The field of two sides and the weight of either, from a row of numbers and twice the
            /// iso-value.
            pub fn emit<D: Domain>(
                self,
                d: &mut D,
                sides: [D::Real; 2],
                row: &[D::Real],
                iso2: D::Real,
            ) -> PairResult<D::Real> {
                match self { $( Self::$step(code) => <$step as Step>::emit(code, d, sides, row, iso2), )+ }
            }
        }

        /// What of a map selects code.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum MapCode { $( #[doc = concat!("Of [`", stringify!($map), "`].")] $map, )+ }

        impl MapCode {
            /// Names of the numbers that a row keeps for it.
            pub const fn columns(self) -> &'static [&'static str] {
                match self { $( Self::$map => <$map as Unary>::COLUMNS, )+ }
            }

            /// The field of a child with the field `f`, from a row of numbers and twice the iso-value.
            pub fn emit<D: Domain>(self, d: &mut D, f: D::Real, row: &[D::Real], iso2: D::Real) -> D::Real {
                match self { $( Self::$map => <$map as Unary>::emit(d, f, row, iso2), )+ }
            }
        }

        impl Combinator {
            /// What it is to the compiler; `depends`: its numbers depend on parameters.
            pub fn form(self, depends: bool) -> OperatorForm {
                match self {
                    $( Self::$fold(it) => OperatorForm::Reduce(ReduceCode::Fold(FoldCode::$fold(it.code(depends)))), )+
                    $( Self::$choice(_) => OperatorForm::Reduce(ReduceCode::Choice(<$choice as Choice>::EXTREME)), )+
                    Self::$difference(_) => OperatorForm::Difference,
                    $( Self::$step(it) => OperatorForm::Reduce(ReduceCode::Step(StepCode::$step(it.code()))), )+
                    $( Self::$map(_) => OperatorForm::Map(MapCode::$map), )+
                }
            }

            /// Whether an operator that is an operand of an equal one may hand its own operands on to that
            /// one. `non_negative`: none of the operands handed on can be negative.
            pub fn flattens(self, non_negative: bool) -> bool {
                match self {
                    $( Self::$fold(it) => it.flattens(non_negative), )+
                    $( Self::$choice(_) => true, )+
                    Self::$difference(_) => false,
                    // Nested ones mix attributes by twos.
                    $( Self::$step(_) => false, )+
                    $( Self::$map(_) => false, )+
                }
            }
        }
    };
}

/// What any operator answers, from the list of all with their forms.
macro_rules! members {
    ($($module:ident $name:ident $form:ident),+ $(,)?) => {
        /// What a [`Combinator`] holds: each operator by itself, with its numbers.
        pub mod operators {
            $( pub use super::$module::$name; )+
        }

        pub use operators::*;
        $( pub(crate) use $module::describe as $module; )+

        /// An operator of any kind.
        #[derive(Clone, Copy, PartialEq, Debug)]
        pub enum Combinator {
            $(
                #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")]
                $name($name),
            )+
        }

        /// The kind of an operator.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum CombinatorKind {
            $(
                #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")]
                $name,
            )+
        }

        $( impl From<$name> for Combinator { fn from(operator: $name) -> Self { Self::$name(operator) } } )+

        impl CombinatorKind {
            /// Every kind, in the order of the list.
            pub const ALL: &'static [Self] = &[ $( Self::$name, )+ ];

            /// The word of the text format. Kinds of one word differ in what stands behind it.
            #[must_use]
            pub const fn name(self) -> &'static str { match self { $( Self::$name => $name::NAME, )+ } }

            /// The name of the constructor in [`builder`](crate::builder).
            #[must_use]
            pub const fn constructor(self) -> &'static str { match self { $( Self::$name => stringify!($module), )+ } }

            /// The parameters.
            #[must_use]
            pub const fn fields(self) -> &'static [Field] {
                match self { $( Self::$name => $name::FIELDS, )+ }
            }

            /// How they are written.
            #[must_use]
            pub const fn syntax(self) -> Syntax {
                match self { $( Self::$name => <$name as Operator>::SYNTAX, )+ }
            }

            /// What it is printed as.
            pub const fn head(self) -> &'static str {
                match self { $( Self::$name => <$name as Operator>::HEAD, )+ }
            }

            /// Whether it has one child; otherwise it has one or more.
            #[must_use]
            pub const fn takes_one(self) -> bool {
                match self { $( Self::$name => <$name as Plain<$form>>::TAKES_ONE, )+ }
            }

            /// Whether what its numbers may be depends on the iso-value.
            pub(crate) const fn asks_iso(self) -> bool {
                match self { $( Self::$name => <$name as Operator>::ASKS_ISO, )+ }
            }

            /// The operator of this kind with these parameters.
            #[must_use]
            pub fn from_fields(self, values: &[FieldValue]) -> Combinator {
                match self { $( Self::$name => Combinator::$name($name::from_fields(values)), )+ }
            }
        }

        impl Combinator {
            /// The kind.
            #[must_use]
            pub const fn kind(self) -> CombinatorKind {
                match self { $( Self::$name(_) => CombinatorKind::$name, )+ }
            }

            /// The parameters, in the order of [`CombinatorKind::fields`].
            #[must_use]
            pub fn to_fields(self) -> Vec<FieldValue> {
                match self { $( Self::$name(it) => it.to_fields(), )+ }
            }

            /// Whether a single child answers as if the operator were not there.
            #[must_use]
            pub const fn passes_single(self) -> bool {
                match self { $( Self::$name(_) => <$name as Plain<$form>>::PASSES_SINGLE, )+ }
            }

            /// See [`Operator::following`].
            pub(crate) fn general(self) -> Self {
                match self { $( Self::$name(it) => Self::$name(it.general()), )+ }
            }

            /// See [`Operator::fault`].
            pub(crate) fn fault(self, iso: f64) -> Option<Diagnostic> {
                match self { $( Self::$name(it) => it.fault(iso), )+ }
            }

            /// The field of the node from its children's fields, plainly.
            #[must_use]
            pub fn field(self, fields: &[f64], iso: f64) -> f64 {
                match self { $( Self::$name(it) => Plain::<$form>::field(it, fields, iso), )+ }
            }

            /// How much each child contributes, `max(0, f_i dF/df_i)` up to a common factor: what mixes
            /// attributes.
            ///
            /// By Euler's identity these add up to F for operators that are homogeneous of degree 1. What is
            /// subtracted counts by its complement, where it is there.
            #[must_use]
            pub fn weights(self, fields: &[f64], iso: f64) -> Vec<f64> {
                match self { $( Self::$name(it) => Plain::<$form>::weights(it, fields, iso), )+ }
            }

            /// The child that decides, where one does.
            #[must_use]
            pub fn winner(self, fields: &[f64], iso: f64) -> Option<usize> {
                match self { $( Self::$name(it) => Plain::<$form>::winner(it, fields, iso), )+ }
            }

            /// How far the fields are from where another child would win, or another formula hold; infinity
            /// if nothing is decided.
            #[must_use]
            pub fn kink_distance(self, fields: &[f64], iso: f64) -> f64 {
                match self { $( Self::$name(it) => Plain::<$form>::kink_distance(it, fields, iso), )+ }
            }

            /// The boxes of a node over children with these.
            pub fn extent(self, children: &[Extent], iso: f64) -> Extent {
                match self { $( Self::$name(it) => Plain::<$form>::extent(it, children, iso), )+ }
            }

            /// Whether the field can never be negative; of each child, whether its field can never be.
            /// `fixed`: the numbers depend on no parameter.
            pub fn is_non_negative(self, children: &mut dyn Iterator<Item = bool>, fixed: bool) -> bool {
                match self { $( Self::$name(it) => Plain::<$form>::is_non_negative(it, children, fixed), )+ }
            }

            /// Pushes the numbers that a row keeps for it: one for each column of its code.
            pub fn push_columns(self, depends: bool, iso: f64, row: &mut Vec<f64>) {
                match self { $( Self::$name(it) => Plain::<$form>::push_columns(it, depends, iso, row), )+ }
            }
        }
    };
}

operators! {
    fold {
        sum::Sum,
        ricci::Ricci,
        product::Product,
    }
    choice {
        union::Union,
        intersection::Intersection,
    }
    difference {
        difference::Difference,
    }
    step {
        symmetric_difference::SymmetricDifference,
        smooth_union::SmoothUnion,
        smooth_intersection::SmoothIntersection,
        smooth_difference::SmoothDifference,
        rfunction::RFunction,
        rfunction_power::RFunctionPower,
        rfunction_order::RFunctionOrder,
    }
    map {
        complement::Complement,
        clamp::Clamp,
        shell::Shell,
        offset::Offset,
    }
}

impl CombinatorKind {
    /// The kinds that a word begins.
    pub fn named(word: &str) -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(move |kind| kind.name() == word)
    }
}

impl Combinator {
    /// The word of the text format.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.kind().name()
    }

    /// The simplest operator that is the same for these numbers.
    pub fn simplest(self) -> Self {
        if let Self::Ricci(blend) = self
            && blend.is_sum()
        {
            return Sum {}.into();
        }
        self
    }

    /// A smooth set operation of this width.
    #[must_use]
    pub fn smooth(set: SetOperation, width: f64) -> Self {
        match set {
            SetOperation::Union => SmoothUnion { width }.into(),
            SetOperation::Intersection => SmoothIntersection { width }.into(),
            SetOperation::Difference => SmoothDifference { width }.into(),
        }
    }
}
