//! Named parameters of the members of the open sets: one description serves the text parser, the printer, the
//! check and the documentation. See [`member`](crate::member).

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
    /// A whole number in a range, ends included, that depends on no parameter: it selects code.
    Whole {
        /// The smallest one.
        least: u32,
        /// The largest one.
        most: u32,
    },
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
    /// The rows of a 3x4 matrix: 12 finite numbers.
    Rows,
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

/// The value of a parameter, in numbers of some kind.
#[derive(Clone, PartialEq, Debug)]
pub enum FieldOf<T> {
    /// One number.
    Real(T),
    /// Three numbers.
    Vector([T; 3]),
    /// Any number of numbers.
    Reals(Vec<T>),
    /// Any number of vectors.
    Vectors(Vec<[T; 3]>),
}

/// The value of a parameter.
pub type FieldValue = FieldOf<f64>;

impl<T> FieldOf<T> {
    /// All its numbers.
    pub fn numbers(&self) -> &[T] {
        match self {
            Self::Real(number) => std::slice::from_ref(number),
            Self::Vector(numbers) => numbers,
            Self::Reals(numbers) => numbers,
            Self::Vectors(vectors) => vectors.as_flattened(),
        }
    }

    /// The same with other numbers.
    pub(crate) fn map<U>(&self, mut to: impl FnMut(&T) -> U) -> FieldOf<U> {
        match self {
            Self::Real(number) => FieldOf::Real(to(number)),
            Self::Vector(vector) => FieldOf::Vector(vector.each_ref().map(to)),
            Self::Reals(numbers) => FieldOf::Reals(numbers.iter().map(to).collect()),
            Self::Vectors(vectors) => {
                FieldOf::Vectors(vectors.iter().map(|vector| vector.each_ref().map(&mut to)).collect())
            }
        }
    }
}

/// A number as it is written.
pub trait NumberText {
    /// Its present value.
    fn present(&self) -> f64;

    /// Whether it depends on no parameter.
    fn is_fixed(&self) -> bool;

    /// Its text: reads back as the same number.
    fn text(&self) -> String;
}

impl NumberText for f64 {
    fn present(&self) -> f64 {
        *self
    }

    fn is_fixed(&self) -> bool {
        true
    }

    fn text(&self) -> String {
        plain(*self)
    }
}

/// The shortest text of a finite number that reads back as the same bits.
pub(crate) fn plain(value: f64) -> String {
    let mut text = format!("{value:?}");
    if text.ends_with(".0") {
        text.truncate(text.len() - 2);
    }
    text
}

/// Numbers in parentheses.
pub(crate) fn tuple<T: NumberText>(numbers: &[T]) -> String {
    let numbers: Vec<String> = numbers.iter().map(NumberText::text).collect();
    format!("({})", numbers.join(" "))
}

impl Field {
    /// Adds the parameter as it is written, a blank in front: nothing, if it has its default. `word`: what it
    /// is called there.
    pub fn write<T: NumberText>(&self, out: &mut String, word: &str, value: &FieldOf<T>) {
        if self.default.as_ref().is_some_and(|default| same(default, value)) {
            return;
        }
        let shown = match (self.kind, value) {
            (FieldKind::Axis, FieldOf::Vector(axis)) => {
                let index = axis.iter().position(|x| x.present() != 0.0).unwrap_or(2);
                ["x", "y", "z"][index].to_owned()
            }
            (FieldKind::Choice(words), FieldOf::Real(value)) => {
                (*words.get(value.present() as usize).unwrap_or(&words[0])).to_owned()
            }
            (FieldKind::Flag, FieldOf::Real(value)) => {
                (if value.present() == 0.0 { "no" } else { "yes" }).to_owned()
            }
            (_, FieldOf::Real(value)) => value.text(),
            (_, FieldOf::Vector(values)) => tuple(values),
            (_, FieldOf::Reals(values)) => tuple(values),
            (_, FieldOf::Vectors(values)) => {
                let vectors: Vec<String> = values.iter().map(|vector| tuple(vector)).collect();
                format!("({})", vectors.join(" "))
            }
        };
        out.push(' ');
        out.push_str(word);
        out.push(' ');
        out.push_str(&shown);
    }
}

/// Whether the numbers are these, to the bit, and depend on no parameter.
fn same<T: NumberText>(default: &FieldValue, value: &FieldOf<T>) -> bool {
    let shape = std::mem::discriminant(&default.map(|_| ())) == std::mem::discriminant(&value.map(|_| ()));
    let bits = |number: f64| number.to_bits();
    let present = value.numbers().iter().map(|number| bits(number.present()));
    let fixed = value.numbers().iter().all(NumberText::is_fixed);
    shape && fixed && default.numbers().iter().copied().map(bits).eq(present)
}

/// Readers of values of which the kind of the field says what they are.
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
