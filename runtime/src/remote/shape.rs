//! The shape of a model: its programs without numbers.

use jbt_ir::{Function, text, verify};
use jbt_lower::prune_info::PruneInfo;
use jbt_model::check::CheckedTree;
use jbt_model::query::Query;

use super::{header, prune_bytes};
use crate::bytes::{ByteReader, ByteWriter, FormatError, fingerprint};

/// The first bytes, and the version of what follows.
const WORD: &[u8; 8] = b"jbtshape";
const VERSION: u32 = 4;
/// Functions are longer than this in no model.
const MAX_TEXT: usize = 256 << 20;

/// The shape of a whole model: its programs for some queries, what pruning has to know but for the rows, and
/// what the model says besides its tree.
///
/// Two are equal if they are bytes for bytes: their models have the same programs.
#[derive(Clone, Debug)]
pub struct ModelShape {
    bytes: Vec<u8>,
    pub(super) tree: CheckedTree,
    /// Whether fields may change where no row reaches: the model has formulas.
    pub(super) formulas: bool,
    pub(super) ranges: Function,
    /// Of tables without rows.
    pub(super) info: PruneInfo,
    pub(super) answers: Vec<(Query, Function)>,
}

impl PartialEq for ModelShape {
    fn eq(&self, other: &Self) -> bool {
        self.bytes == other.bytes
    }
}

impl ModelShape {
    /// The shape of a model with these programs. It is read back from its bytes, so whoever reads them has
    /// the same functions, to the names of their instructions.
    pub(super) fn of(
        tree: &CheckedTree,
        formulas: bool,
        (ranges, info): (&Function, &PruneInfo),
        answers: &[(Query, &Function)],
    ) -> Result<Self, FormatError> {
        let mut writer = ByteWriter::new(WORD, VERSION);
        header::write(tree, &mut writer);
        writer.u8(u8::from(formulas));
        writer.text(&ranges.to_string());
        prune_bytes::write(info, &mut writer);
        writer.count(answers.len());
        for (query, function) in answers {
            writer.u8(query.index() as u8);
            writer.text(&function.to_string());
        }
        Self::from_bytes(&writer.into_bytes())
    }

    /// The shape as bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// A number that tells shapes apart.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        fingerprint(&self.bytes)
    }

    /// What its programs answer.
    pub fn queries(&self) -> impl Iterator<Item = Query> {
        self.answers.iter().map(|(query, _)| *query)
    }

    /// Reads a shape. Functions are verified, and everything that refers to a table, probe or value is there.
    ///
    /// # Errors
    /// Where the bytes are no shape of this version; want of memory.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FormatError> {
        let mut reader = ByteReader::new(bytes, WORD, VERSION)?;
        // A value has twenty bytes of text, and takes some hundred to read and to verify.
        reader.afford(16)?;
        let tree = header::read(&mut reader)?;
        let formulas = reader.flag()?;
        let ranges = function(&mut reader)?;
        let info = prune_bytes::read(&mut reader, &ranges)?;
        let mut answers: Vec<(Query, Function)> = Vec::new();
        for _ in 0..reader.count(9)? {
            let query = reader.one_of(&Query::EVERY)?;
            let function = function(&mut reader)?;
            let parents = |of: &Function| of.tables.values().map(|schema| schema.parent).collect::<Vec<_>>();
            if parents(&function) != parents(&ranges) {
                return Err(reader.error("programs of one model have the same tables"));
            }
            if answers.iter().any(|(known, _)| *known == query) {
                return Err(reader.error("there are two programs for one query"));
            }
            answers.push((query, function));
        }
        reader.end()?;
        Ok(Self { bytes: bytes.to_vec(), tree, formulas, ranges, info, answers })
    }
}

fn function(reader: &mut ByteReader<'_>) -> Result<Function, FormatError> {
    let text = reader.text()?;
    if text.len() > MAX_TEXT {
        return Err(reader.error(format!("a function of more than {MAX_TEXT} bytes")));
    }
    let function = text::parse(text).map_err(|errors| {
        reader.error(errors.first().map_or_else(String::new, |error| format!("a function: {error}")))
    })?;
    let verified = verify(function).map_err(|errors| {
        reader.error(errors.first().map_or_else(String::new, |error| format!("a function: {error}")))
    })?;
    let function = verified.into_function();
    if function.inputs != ["x", "y", "z"] || function.outputs.is_empty() {
        return Err(reader.error("a function of a model has the inputs x, y and z, and an output"));
    }
    Ok(function)
}
