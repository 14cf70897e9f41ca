//! Which answers there are, and which of them are wanted at a point: decided once, before anything is
//! compiled.
//!
//! What an answer is to everybody is a row of one table, at the end of this file. From it derive the sets
//! that may be asked for, their words on the command line, the pass that goes in front of the others, the
//! planes of samples and the names of columns, and what separate walks would take. What the row cannot say is
//! how the answer is computed: that is its pass, or a part of the lowering that asks [`Query::contains`].

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use jbt_ir::pass::{GRADIENT, GRADIENT_OUTPUTS, Pass};

/// What there is to know about an answer.
#[derive(Clone, Copy, Debug)]
pub struct AnswerRow {
    /// The word of the command line, and a noun for help texts.
    pub word: &'static str,
    /// The planes of samples that hold it, and the columns of tables.
    pub planes: Planes,
    /// The pass that adds it to a lowered program; `None` if lowering does.
    pub pass: Option<&'static Pass>,
    /// How often a program without a compiler, which asks one question after the other, walks the whole tree
    /// for it; and the words for that. For comparison alone: see `jbt::statistics`.
    pub walks: (u64, &'static str),
    /// Of the points at which these walks evaluate, those that no other answer's walks need; and what they
    /// are.
    pub places: (u64, &'static str),
}

/// Which planes an answer has.
#[derive(Clone, Copy, Debug)]
pub enum Planes {
    /// Those with these names.
    Named(&'static [&'static str]),
    /// One for each channel of each attribute group of the model.
    Channels,
}

/// A set of answers. The field is always among them.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Query(
    /// A bit for each answer.
    u8,
);

/// The sets that there are.
const QUERIES: usize = 1 << (AnswerKind::ALL.len() - 1);

impl Query {
    /// The field alone.
    pub const FIELD: Self = Self(0).and(AnswerKind::Field);
    /// Field and gradient.
    pub const GRADIENT: Self = Self::FIELD.and(AnswerKind::Gradient);
    /// Field and attributes.
    pub const ATTRIBUTES: Self = Self::FIELD.and(AnswerKind::Attributes);
    /// Field, gradient and attributes: what a surface is shown by. Today this is [`ALL`](Self::ALL), and so
    /// one program; an answer that is added later will be in `ALL` alone.
    pub const SURFACE: Self = Self::GRADIENT.and(AnswerKind::Attributes);
    /// Every answer.
    pub const ALL: Self = Self::EVERY[QUERIES - 1];

    /// Every set of answers.
    pub const EVERY: [Self; QUERIES] = {
        let mut every = [Self::FIELD; QUERIES];
        let mut index = 0;
        while index < QUERIES {
            every[index] = Self(Self::FIELD.0 | (index as u8) << 1);
            index += 1;
        }
        every
    };

    /// This set with one more answer.
    #[must_use]
    pub const fn and(self, answer: AnswerKind) -> Self {
        Self(self.0 | 1 << answer as u8)
    }

    /// Whether an answer is in the set.
    #[must_use]
    pub const fn contains(self, answer: AnswerKind) -> bool {
        self.0 >> answer as u8 & 1 == 1
    }

    /// Whether programs for it are differentiated: then ties have to be decided.
    #[must_use]
    pub const fn is_differentiated(self) -> bool {
        self.contains(AnswerKind::Gradient)
    }

    /// Its answers, in the order of their planes.
    pub fn answers(self) -> impl Iterator<Item = AnswerKind> {
        AnswerKind::ALL.into_iter().filter(move |&answer| self.contains(answer))
    }

    /// Its place in [`EVERY`](Self::EVERY).
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize >> 1
    }

    /// The passes that add its answers to a lowered program, before all others.
    pub fn passes(self) -> impl Iterator<Item = &'static Pass> {
        self.answers().filter_map(|answer| answer.row().pass)
    }

    /// The word of the command line and of reports: `all`, or what there is beside the field.
    #[must_use]
    pub fn name(self) -> Cow<'static, str> {
        let beside: Vec<&str> = self.answers().skip(1).map(|answer| answer.row().word).collect();
        match beside.as_slice() {
            _ if self == Self::ALL => "all".into(),
            [] => AnswerKind::Field.row().word.into(),
            [one] => (*one).into(),
            many => many.join("+").into(),
        }
    }

    /// Its answers in words: `Field, gradient and attributes`.
    #[must_use]
    pub fn title(self) -> String {
        let words: Vec<&str> = self.answers().skip(1).map(|answer| answer.row().word).collect();
        match words.split_last() {
            None => "The field".to_owned(),
            Some((last, [])) => format!("Field and {last}"),
            Some((last, words)) => format!("Field, {} and {last}", words.join(", ")),
        }
    }
}

impl Default for Query {
    /// The field alone.
    fn default() -> Self {
        Self::FIELD
    }
}

impl fmt::Debug for Query {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Query({})", self.name())
    }
}

impl fmt::Display for Query {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.name())
    }
}

/// A word that is no query's.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{0:?} is none of: {names}", names = Query::EVERY.map(Query::name).join(", "))]
pub struct UnknownQuery(pub String);

impl FromStr for Query {
    type Err = UnknownQuery;

    /// The query of a [`name`](Self::name).
    fn from_str(word: &str) -> Result<Self, UnknownQuery> {
        let found = Self::EVERY.into_iter().find(|query| query.name() == word);
        found.ok_or_else(|| UnknownQuery(word.to_owned()))
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Query {
    /// A map: for each answer beside the field, whether it is wanted.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let beside = AnswerKind::ALL.into_iter().skip(1);
        serializer.collect_map(beside.map(|answer| (answer.row().word, self.contains(answer))))
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Query {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let wanted = std::collections::BTreeMap::<String, bool>::deserialize(deserializer)?;
        let is_wanted = |answer: &AnswerKind| wanted.get(answer.row().word) == Some(&true);
        Ok(AnswerKind::ALL.into_iter().filter(is_wanted).fold(Self::FIELD, Self::and))
    }
}

/// Makes the enumeration of answers, in the order of their planes, of their rows. Programs have their outputs
/// in this order too, by lowering and by the gradient pass: `AnswerProgram::new` of `jbt` asserts it.
macro_rules! answers {
    ($($(#[doc = $doc:literal])+ $answer:ident => $row:expr;)+) => {
        /// Something that may be asked for at a point.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum AnswerKind {
            $($(#[doc = $doc])+ $answer,)+
        }

        impl AnswerKind {
            /// All answers, in the order of their planes. The first one is the field.
            pub const ALL: [Self; [$(stringify!($answer)),+].len()] = [$(Self::$answer),+];

            /// What there is to know about it.
            #[must_use]
            pub const fn row(self) -> AnswerRow {
                match self {
                    $(Self::$answer => $row,)+
                }
            }
        }
    };
}

answers! {
    /// The field.
    Field => AnswerRow {
        word: "field",
        planes: Planes::Named(&["field"]),
        pass: None,
        walks: (1, "field"),
        places: (1, "the point"),
    };
    /// The gradient of the field. Alone, it is found by forward differences: four walks, at the point and a
    /// step along each axis.
    Gradient => AnswerRow {
        word: "gradient",
        planes: Planes::Named(&GRADIENT_OUTPUTS),
        pass: Some(&GRADIENT),
        walks: (4, "gradient, by differences"),
        places: (3, "the steps of the differences"),
    };
    /// Every attribute group of the model.
    Attributes => AnswerRow {
        word: "attributes",
        planes: Planes::Channels,
        pass: None,
        walks: (1, "attributes"),
        places: (0, ""),
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_have_places_and_words() {
        let every = [Query::FIELD, Query::GRADIENT, Query::ATTRIBUTES, Query::SURFACE];
        assert_eq!(Query::EVERY, every);
        for (index, query) in every.into_iter().enumerate() {
            assert_eq!(query.index(), index);
            assert_eq!(query.name().parse(), Ok(query));
        }
        assert_eq!(every.map(Query::name), ["field", "gradient", "attributes", "all"]);
        let titles =
            ["The field", "Field and gradient", "Field and attributes", "Field, gradient and attributes"];
        assert_eq!(every.map(Query::title), titles);
        let error = "colour".parse::<Query>().unwrap_err().to_string();
        assert_eq!(error, "\"colour\" is none of: field, gradient, attributes, all");
    }

    #[test]
    fn answers_are_in_sets() {
        assert!(
            Query::GRADIENT.contains(AnswerKind::Field) && Query::GRADIENT.contains(AnswerKind::Gradient)
        );
        assert!(!Query::GRADIENT.contains(AnswerKind::Attributes));
        assert_eq!(Query::ALL.answers().collect::<Vec<_>>(), AnswerKind::ALL);
        assert_eq!(Query::ATTRIBUTES.passes().count(), 0);
        assert_eq!(Query::ALL.passes().map(|pass| pass.name).collect::<Vec<_>>(), ["gradient"]);
    }
}
