//! What is asked for at a point: answers by their words, and groups of attributes by their names.

use std::fmt;

use clap::builder::{PossibleValue, TypedValueParser};
use jbt::tree::{DEFAULT_WEIGHT, DEFINED, OWNER, WEIGHT, WEIGHTS, WeightOf, normalized};
use jbt::{AnswerKind, CheckedTree, Diagnostics, Query};

use crate::failure::Failure;

/// The way down to the leaf that decides, in words: a column of text.
const OWNER_PATH: &str = "owner.path";

/// Answers, and the groups of attributes among them if not all are wanted.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct WantedAnswers {
    /// The answers.
    pub query: Query,
    /// The groups; nothing for all of them.
    groups: Option<Vec<String>>,
    /// Whether the way down to the owner is wanted too.
    owner_path: bool,
}

impl WantedAnswers {
    /// Words with commas between: those of queries, and names of groups.
    fn parse(text: &str) -> Self {
        let mut wanted = Self::from(Query::FIELD);
        let (mut all, mut groups) = (false, Vec::new());
        for word in normalized(text).split(',').map(str::trim) {
            match word.parse::<Query>() {
                Ok(query) => {
                    wanted.query = query.answers().fold(wanted.query, Query::and);
                    all |= query.contains(AnswerKind::Attributes);
                }
                Err(_) if word == OWNER_PATH => wanted.owner_path = true,
                Err(_) => groups.push(word.to_owned()),
            }
        }
        if wanted.owner_path && !groups.iter().any(|name| name == OWNER) {
            groups.push(OWNER.to_owned());
        }
        if !groups.is_empty() && !all {
            wanted.query = wanted.query.and(AnswerKind::Attributes);
            wanted.groups = Some(groups);
        }
        wanted
    }

    /// The tree that answers for the groups that are wanted.
    ///
    /// # Errors
    /// A word that is neither that of an answer nor the name of a group.
    pub fn of(&self, tree: CheckedTree) -> Result<CheckedTree, Diagnostics> {
        let Some(groups) = &self.groups else {
            return if self.owner_path { tree.with_owners() } else { Ok(tree) };
        };
        let declared: Vec<String> = tree.attributes().iter().map(|group| group.name.to_string()).collect();
        let is_own = |name: &str| declared.iter().any(|own| own == name);
        let asks = |name: &str| groups.iter().any(|asked| asked == name);
        // A group of the model's own numbers no leaves: of it there is no path. Others come behind, because
        // numbers are those of this tree.
        let mut tree =
            if self.owner_path || asks(OWNER) && !is_own(OWNER) { tree.with_owners()? } else { tree };
        let mut chosen: Vec<&str> = Vec::new();
        for name in groups.iter().map(String::as_str) {
            if chosen.contains(&name) {
                continue;
            }
            chosen.push(name);
            if is_own(name) || name == OWNER {
                continue;
            }
            if name == WEIGHTS {
                tree = tree.with_weights(WeightOf::Leaves)?;
                // The rest of the weight goes with them.
                if !asks(DEFAULT_WEIGHT) {
                    tree = tree.with_weights(WeightOf::Default)?;
                    chosen.push(DEFAULT_WEIGHT);
                }
            } else if name == DEFAULT_WEIGHT {
                tree = tree.with_weights(WeightOf::Default)?;
            } else if let Some(path) = name.strip_suffix(WEIGHT) {
                tree = tree.with_weights(WeightOf::Named(path))?;
            } else if let Some(group) = name.strip_suffix(DEFINED) {
                tree = tree.with_coverage(group)?;
            }
        }
        tree.of_attributes(&chosen)
    }

    /// Refuses what is text.
    ///
    /// # Errors
    /// The path of the owner is among what is wanted.
    pub fn check_numbers(&self) -> Result<(), Failure> {
        if self.owner_path {
            return Err(Failure::Usage(format!("`{OWNER_PATH}` is text, which only `jbt eval` answers")));
        }
        Ok(())
    }

    /// The column of text that follows the numbers, if there is one.
    pub fn text_column(&self) -> Option<&'static str> {
        self.owner_path.then_some(OWNER_PATH)
    }
}

impl From<Query> for WantedAnswers {
    fn from(query: Query) -> Self {
        Self { query, groups: None, owner_path: false }
    }
}

impl fmt::Display for WantedAnswers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.query.fmt(f)
    }
}

/// Reads what is wanted; help and completions list the answers.
#[derive(Clone, Copy)]
pub struct WantedParser;

impl TypedValueParser for WantedParser {
    type Value = WantedAnswers;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<WantedAnswers, clap::Error> {
        let text = clap::builder::StringValueParser::new().parse_ref(command, argument, value)?;
        Ok(WantedAnswers::parse(&text))
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let value = |query: Query| PossibleValue::new(query.name()).help(query.title());
        Some(Box::new(Query::EVERY.into_iter().map(value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_names() {
        let wanted = |text: &str| {
            let WantedAnswers { query, groups, .. } = WantedAnswers::parse(text);
            (query, groups.map(|groups| groups.join(" ")))
        };
        assert_eq!(wanted("field"), (Query::FIELD, None));
        assert_eq!(wanted("gradient"), (Query::GRADIENT, None));
        assert_eq!(wanted("all"), (Query::ALL, None));
        assert_eq!(wanted("field,color"), (Query::ATTRIBUTES, Some("color".to_owned())));
        assert_eq!(wanted("rough, gradient,wet"), (Query::ALL, Some("rough wet".to_owned())));
        assert_eq!(wanted("attributes,color"), (Query::ATTRIBUTES, None));
        assert_eq!(wanted("field,owner.path"), (Query::ATTRIBUTES, Some("owner".to_owned())));
        assert!(WantedAnswers::parse("all,owner.path").owner_path);
    }
}
