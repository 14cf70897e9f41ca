//! What is known of a range before there are any numbers: from the op that made it, and from the facts of its
//! operands.
//!
//! Facts make programs small: an end of a product of ranges that are not negative takes one op instead of
//! four products and their minimum. Facts are derived here alone, and from ops alone, so that an emitted
//! program and the scalar meaning choose the same forms and give the same bounds. The facts of accumulators
//! are found by [`crate::facts`].

use crate::facts::Fact;
use crate::function::InstKind;
use crate::op::Op;

/// The signs of both bounds.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) enum Sign {
    /// Nothing is known.
    #[default]
    Unknown,
    /// Each bound is at least 0, or NaN; where the low one is NaN, the high one is NaN or inf.
    NonNegative,
    /// Each bound is at most 0, or NaN; where the high one is NaN, the low one is NaN or -inf.
    NonPositive,
}

impl Sign {
    pub(super) const fn opposite(self) -> Self {
        match self {
            Self::Unknown => Self::Unknown,
            Self::NonNegative => Self::NonPositive,
            Self::NonPositive => Self::NonNegative,
        }
    }

    /// The sign of a sum, or of a choice between two.
    const fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::NonNegative, Self::NonNegative) => Self::NonNegative,
            (Self::NonPositive, Self::NonPositive) => Self::NonPositive,
            (Self::Unknown | Self::NonNegative | Self::NonPositive, _) => Self::Unknown,
        }
    }

    const fn times(self, other: Self) -> Self {
        match self {
            Self::Unknown => Self::Unknown,
            Self::NonNegative => other,
            Self::NonPositive => other.opposite(),
        }
    }
}

/// What is known of a value of any type.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct Facts {
    /// The range is one known value, bit for bit: both bounds of a real are that value, a mask is decided,
    /// bits are known.
    pub(super) point: bool,
    /// The number, where the program has it; never NaN.
    pub(super) constant: Option<f32>,
    /// Of a real.
    pub(super) sign: Sign,
    /// Of a real: where the low bound is NaN, the high one is NaN or inf; where the high one is, the low one
    /// is NaN or -inf.
    pub(super) paired: bool,
}

impl Facts {
    /// A known value with no other facts.
    pub(super) const POINT: Self = Self { point: true, constant: None, sign: Sign::Unknown, paired: true };

    /// A constant.
    pub(super) const fn constant(number: f32) -> Self {
        if number.is_nan() {
            return Self::POINT;
        }
        let sign = if number >= 0.0 { Sign::NonNegative } else { Sign::NonPositive };
        Self { constant: Some(number), sign, ..Self::POINT }
    }

    /// Whether it is a constant other than a zero.
    fn is_nonzero(self) -> bool {
        self.constant.is_some_and(|number| number != 0.0)
    }
}

impl Fact for Facts {
    fn leaf(kind: &InstKind) -> Self {
        match kind {
            InstKind::Input(_) => Self { paired: true, ..Self::default() },
            InstKind::Constant(number) => Self::constant(*number),
            InstKind::BitsConstant(_) | InstKind::Column { .. } => Self::POINT,
            InstKind::Op { .. } | InstKind::Fold(_) => unreachable!("these are no leaves"),
        }
    }

    fn join(self, other: Self) -> Self {
        Self {
            point: self.point && other.point,
            constant: None,
            sign: self.sign.and(other.sign),
            paired: self.paired && other.paired,
        }
    }

    fn of(op: Op, args: &[Self], same: bool) -> Self {
        let point = args.iter().all(|arg| arg.point);
        let paired = match op {
            Op::Add | Op::Sub => args[0].paired && args[1].paired,
            Op::Neg => args[0].paired,
            Op::StopGradient => return args[0],
            Op::LowEnd => return Self { sign: args[0].sign, ..Self::POINT },
            Op::FromBits => true,
            Op::Mul | Op::Div | Op::Fma | Op::Abs | Op::Sqrt | Op::Min | Op::Max | Op::Select => false,
            Op::Sin | Op::Cos | Op::Exp | Op::Ln | Op::Pow => false,
            Op::SlopeX | Op::SlopeY | Op::SlopeZ => false,
            Op::Lt | Op::Le | Op::Eq | Op::Both | Op::Either | Op::Not => false,
            Op::ToBits | Op::BitAnd | Op::BitOr | Op::BitXor => false,
            Op::IntAdd | Op::IntSub | Op::Shl | Op::Shr => false,
        };
        Self { point, constant: None, sign: sign(op, args, same), paired: point || paired }
    }

    fn carried(self) -> Self {
        Self { constant: None, ..self }
    }
}

/// The sign of the result of an op.
fn sign(op: Op, args: &[Facts], same: bool) -> Sign {
    let of = |place: usize| args[place].sign;
    match op {
        Op::Add => of(0).and(of(1)),
        Op::Sub => of(0).and(of(1).opposite()),
        Op::Mul => product(args, same),
        Op::Fma => product(args, same).and(of(2)),
        // A divisor that is a point may be -0, and then the quotient has the other sign.
        Op::Div if args[1].point && !args[1].is_nonzero() => Sign::Unknown,
        Op::Div => of(0).times(of(1)),
        Op::Neg => of(0).opposite(),
        Op::Abs | Op::Sqrt | Op::Exp | Op::Pow => Sign::NonNegative,
        Op::Min => extreme(args, Sign::NonPositive),
        Op::Max => extreme(args, Sign::NonNegative),
        Op::Select => of(1).and(of(2)),
        Op::StopGradient | Op::LowEnd => of(0),
        Op::Sin | Op::Cos | Op::Ln | Op::FromBits => Sign::Unknown,
        Op::SlopeX | Op::SlopeY | Op::SlopeZ => Sign::NonNegative,
        Op::Lt | Op::Le | Op::Eq | Op::Both | Op::Either | Op::Not => Sign::Unknown,
        Op::ToBits | Op::BitAnd | Op::BitOr | Op::BitXor => Sign::Unknown,
        Op::IntAdd | Op::IntSub | Op::Shl | Op::Shr => Sign::Unknown,
    }
}

fn product(args: &[Facts], same: bool) -> Sign {
    if same { Sign::NonNegative } else { args[0].sign.times(args[1].sign) }
}

/// The sign of `max`, where `beyond` is [`Sign::NonNegative`], or of `min`, where `beyond` is
/// [`Sign::NonPositive`].
///
/// The second operand alone decides it, because it is the result where an operand is NaN. A point may be NaN
/// itself.
fn extreme(args: &[Facts], beyond: Sign) -> Sign {
    if args[1].sign != beyond {
        return args[0].sign.and(args[1].sign);
    }
    let sure = args[0].point || !args[1].point || args[1].constant.is_some();
    if sure { beyond } else { Sign::Unknown }
}
