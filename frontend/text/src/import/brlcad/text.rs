//! Text files of version 5 (`.asc`): commands of Tcl, of which these make objects.
//!
//! ```text
//! put {rim.s} tor V {0 0 9} H {0 0 1} r_a 11 r_h 3
//! put {cup.r} comb region yes tree {- {l rim.s} {l hole.s {1 0 0 5  0 1 0 0  0 0 1 0  0 0 0 1}}}
//! attr set {cup.r} {rgb} {255/0/0}
//! color 1000 1999 255 0 0                   the colour of regions of these numbers
//! ```

use std::collections::HashMap;

use jbt_model::diagnostic::{Diagnostic, Span};

use super::database::{Database, Object, ObjectContent, PaletteRange, Properties};
use super::solid::{DatabaseSolid, SolidRow, SolidShape, block_points, of_word};
use super::tcl::{Unclosed, Words, numbers, shown, unclosed};
use super::text_tree::combination;

/// Keys and values behind the kind of an object.
type Pairs<'a> = Vec<(&'a [u8], Span)>;

/// Reads all objects.
pub(super) fn read(database: &mut Database, bytes: &[u8]) {
    let mut reader = TextReader { bytes, left_out: HashMap::new() };
    let mut words = Words::commands(bytes);
    while words.next_command() && !database.errors.is_full() {
        match reader.command(database, &mut words) {
            Ok(()) => {}
            Err(error) => database.errors.add(|| error),
        }
        words.skip_command();
        // What has no end is at the end of the text.
        if matches!(words.next(), Err(Unclosed(_))) {
            return;
        }
    }
    reader.left_out.into_values().for_each(|(span, word, count): (Span, String, usize)| {
        database
            .warnings
            .add(|| Diagnostic::warning(Some(span), format!("{count} commands `{word}` are left out")));
    });
}

struct TextReader<'a> {
    bytes: &'a [u8],
    /// Commands that are not known: the first of each, and their number.
    left_out: HashMap<&'a [u8], (Span, String, usize)>,
}

impl<'a> TextReader<'a> {
    fn slice(&self, span: Span) -> &'a [u8] {
        &self.bytes[span.start as usize..span.end as usize]
    }

    fn shown(&self, span: Span) -> String {
        shown(self.bytes, span)
    }

    /// The next word, which has to be there.
    fn word(&self, words: &mut Words<'a>, what: &str) -> Result<Span, Diagnostic> {
        let at = words.at();
        let word = words.next().map_err(|word| unclosed(&word))?;
        word.ok_or_else(|| Diagnostic::error(Some(Span::new(at, at)), format!("{what} is missing")))
    }

    fn pairs(&self, words: &mut Words<'a>) -> Result<Pairs<'a>, Diagnostic> {
        let mut pairs = Vec::new();
        while let Some(key) = words.next().map_err(|word| unclosed(&word))? {
            let value = self.word(words, &format!("the value of `{}`", self.shown(key)))?;
            pairs.push((self.slice(key), value));
        }
        Ok(pairs)
    }

    fn command(&mut self, database: &mut Database, words: &mut Words<'a>) -> Result<(), Diagnostic> {
        let start = words.at();
        let command = self.word(words, "a command")?;
        match self.slice(command) {
            b"title" | b"units" => {}
            b"put" => {
                let name = self.word(words, "the name of an object")?;
                let kind = self.word(words, "the kind of an object")?;
                let pairs = self.pairs(words)?;
                let span = Span::new(start, words.at());
                self.put(database, name, kind, &pairs, span)?;
            }
            b"attr" => self.attributes(database, words)?,
            b"color" => {
                let numbers = self.pairs_as_numbers(words)?;
                database.palette.extend(PaletteRange::of(&numbers));
            }
            other => {
                let shown = self.shown(command);
                self.left_out.entry(other).or_insert((command, shown, 0)).2 += 1;
            }
        }
        Ok(())
    }

    fn pairs_as_numbers(&self, words: &mut Words<'a>) -> Result<Vec<i64>, Diagnostic> {
        let mut numbers = Vec::new();
        while let Some(word) = words.next().map_err(|word| unclosed(&word))? {
            let number = std::str::from_utf8(self.slice(word)).ok().and_then(|word| word.parse().ok());
            let message =
                || Diagnostic::error(Some(word), format!("`{}` is no whole number", self.shown(word)));
            numbers.push(number.ok_or_else(message)?);
        }
        Ok(numbers)
    }

    /// `attr set NAME key value ..`: of an object that stands above.
    fn attributes(&self, database: &mut Database, words: &mut Words<'a>) -> Result<(), Diagnostic> {
        let set = self.word(words, "the word `set`")?;
        if self.slice(set) != b"set" {
            return Err(Diagnostic::error(
                Some(set),
                format!("`{}` is no way to set attributes", self.shown(set)),
            ));
        }
        let name = self.word(words, "the name of an object")?;
        let pairs = self.pairs(words)?;
        if self.slice(name) == b"_GLOBAL" {
            let tables = pairs.iter().filter(|(key, _)| *key == b"regionid_colortable");
            for &(_, value) in tables {
                let mut entries = Words::list(self.bytes, value);
                while let Some(entry) = entries.next().map_err(|word| unclosed(&word))? {
                    let numbers = self.pairs_as_numbers(&mut Words::list(self.bytes, entry))?;
                    database.palette.extend(PaletteRange::of(&numbers));
                }
            }
            return Ok(());
        }
        let Some(object) = database.find(self.slice(name)) else {
            let shown = self.shown(name);
            database
                .warnings
                .add(|| Diagnostic::warning(Some(name), format!("no object above is called `{shown}`")));
            return Ok(());
        };
        let mut properties = database.objects[object as usize].properties.clone();
        // The usual name of a colour wins if both are there.
        let has_color = pairs.iter().any(|(key, _)| *key == b"color");
        for (key, value) in pairs {
            if !(has_color && key == b"rgb") {
                database.set(&mut properties, key, self.slice(value), value);
            }
        }
        database.objects[object as usize].properties = properties;
        Ok(())
    }

    fn put(
        &self,
        database: &mut Database,
        name: Span,
        kind: Span,
        pairs: &[(&'a [u8], Span)],
        span: Span,
    ) -> Result<(), Diagnostic> {
        let mut properties = Properties::default();
        let content = match self.slice(kind) {
            b"comb" => {
                for &(key, value) in pairs {
                    database.set(&mut properties, key, self.slice(value), value);
                }
                let tree = pairs.iter().find(|(key, _)| *key == b"tree");
                let combination =
                    tree.map(|&(_, tree)| combination(self.bytes, tree)).transpose()?.unwrap_or_default();
                if !database.count_members(combination.members.len(), span) {
                    return Ok(());
                }
                ObjectContent::Combination(combination)
            }
            word => match of_word(word) {
                Some(row) => ObjectContent::Solid(self.solid(row, kind, pairs)?),
                None => ObjectContent::Foreign(self.shown(kind)),
            },
        };
        database.add(Object { name, span, content, properties });
        Ok(())
    }

    /// The finite numbers of a word, as many as wanted.
    fn numbers(&self, span: Span, wanted: usize, key: &str) -> Result<Vec<f64>, Diagnostic> {
        let numbers = numbers(self.bytes, span)?;
        let found = numbers.len();
        if wanted != found {
            let error = Diagnostic::error(Some(span), format!("`{key}` has {found} numbers"));
            return Err(error.expected(format!("expected {wanted}")));
        }
        Ok(numbers)
    }

    fn solid(
        &self,
        row: &'static SolidRow,
        kind: Span,
        pairs: &[(&'a [u8], Span)],
    ) -> Result<DatabaseSolid, Diagnostic> {
        let values: HashMap<&[u8], Span> = pairs.iter().copied().collect();
        let value = |key: &str, count: usize| -> Result<Vec<f64>, Diagnostic> {
            let Some(&found) = values.get(key.as_bytes()) else {
                let message = format!("the {} has no `{key}`", row.words[0]);
                return Err(Diagnostic::error(Some(kind), message));
            };
            self.numbers(found, count, key)
        };
        let mut numbers = Vec::new();
        match row.shape {
            SolidShape::Fixed(fields) if row.words[0] == "arb8" => {
                let count = fields.iter().filter(|(key, _)| values.contains_key(key.as_bytes())).count();
                let places = block_points(count).unwrap_or([0, 1, 2, 3, 4, 5, 6, 7]);
                for place in places {
                    numbers.extend(value(fields[place].0, 3)?);
                }
            }
            SolidShape::Fixed(fields) => {
                for &(key, count) in fields {
                    numbers.extend(value(key, count)?);
                }
            }
            SolidShape::List(fields) => {
                // Keys are numbered; there may be another key with the number of entries.
                let mut entry = 0;
                while values.contains_key(format!("{}{entry}", fields[0].0).as_bytes()) {
                    for &(key, count) in fields {
                        numbers.extend(value(&format!("{key}{entry}"), count)?);
                    }
                    entry += 1;
                }
            }
            SolidShape::Metaball => {
                numbers.extend(value("method", 1)?);
                numbers.extend(value("thresh", 1)?);
                if let Some(&list) = values.get(&b"PL"[..]) {
                    let mut points = Words::list(self.bytes, list);
                    while let Some(point) = points.next().map_err(|word| unclosed(&word))? {
                        numbers.extend(self.numbers(point, 5, "PL")?);
                    }
                }
            }
        }
        Ok(DatabaseSolid { kind: row.kind, numbers })
    }
}
