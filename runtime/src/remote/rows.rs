//! Rows of a model that reach a box.

use jbt_ir::{Entity as _, Selection, Table, Tables, watch};
use jbt_lower::prune_info::{Rule, Support};
use jbt_lower::{Lowered, Lowering};
use jbt_model::kind::NodeKind;
use jbt_model::query::Query;

use super::error::RemoteError;
use super::shape::ModelShape;
use crate::boxes::{Box3, Divisible as _};
use crate::bytes::{ByteReader, ByteWriter, FormatError};
use crate::compiled::Compiled;
use crate::error::{CompileError, compiled_within_memory, within_memory};
use crate::parallel::PoolWorkers;
use crate::prune::Pruner;

/// The first bytes, and the version of what follows.
const WORD: &[u8; 8] = b"jbt rows";
const VERSION: u32 = 1;
/// Numbers of a support.
const SUPPORT: usize = 7;

/// The rows of one table.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct PartTable {
    /// Where the rows of each row of the parent begin, and the end.
    pub(super) starts: Vec<u32>,
    /// Their numbers in the whole model.
    pub(super) whole: Vec<u32>,
    /// Supports, one after the other; none where rows are not left out by them.
    pub(super) supports: Vec<f32>,
    /// The numbers of the rows in the range program, and in the programs for queries. A program that has
    /// those of an earlier one has its place instead.
    pub(super) numbers: Vec<PartNumbers>,
}

/// The numbers of rows in a program.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum PartNumbers {
    Own(Vec<f32>),
    /// Those of an earlier program.
    As(usize),
}

/// The rows of a model that reach a box, ascending, with their numbers in the whole model.
#[derive(Clone, PartialEq, Debug)]
pub struct ModelRows {
    /// The shape that they belong to.
    pub(super) shape: u64,
    /// Paths from the root to leaves in the whole model, for counters.
    pub(super) uses: u64,
    pub(super) bounds: Box3,
    pub(super) tables: Vec<PartTable>,
}

/// A whole model, of which parts are taken.
pub struct RowSource {
    pruner: Pruner,
    shape: ModelShape,
    answers: Vec<Lowered>,
}

impl std::fmt::Debug for RowSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RowSource")
            .field("queries", &self.shape.queries().collect::<Vec<_>>())
            .finish_non_exhaustive()
    }
}

impl RowSource {
    /// A model of which parts are to answer these queries. Meshes need field, gradient and
    /// [surface](Query::SURFACE).
    ///
    /// # Errors
    /// The model could not be lowered, or its range program not be compiled; want of memory.
    pub fn new(compiled: &Compiled, queries: &[Query]) -> Result<Self, RemoteError> {
        compiled_within_memory(|| Self::of(compiled, queries))
    }

    fn of(compiled: &Compiled, queries: &[Query]) -> Result<Self, RemoteError> {
        let pruner = compiled.pruner()?;
        let tree = compiled.tree();
        let lowering = Lowering::with(tree, &PoolWorkers);
        let lower = |&query: &Query| {
            lowering.answers(query).map_err(|list| CompileError::from(tree.diagnostics(list)))
        };
        let answers = queries.iter().map(lower).collect::<Result<Vec<Lowered>, CompileError>>()?;
        let functions: Vec<_> =
            queries.iter().zip(&answers).map(|(&query, lowered)| (query, &lowered.function)).collect();
        let formulas = tree.nodes().iter().any(|node| matches!(node.kind, NodeKind::Expression(_)));
        let program = pruner.program();
        let ranges = (program.lowered(), program.info());
        let shape = ModelShape::of(tree, formulas, ranges, &functions)?;
        Ok(Self { pruner, shape, answers })
    }

    /// The shape of the whole.
    #[must_use]
    pub fn shape(&self) -> &ModelShape {
        &self.shape
    }

    /// The rows that matter in a closed box, in coordinates about the model's origin.
    ///
    /// # Errors
    /// Want of memory; the engine refuses the box, which is a defect.
    pub fn rows(&self, bounds: Box3) -> Result<ModelRows, RemoteError> {
        within_memory(|| self.rows_in(bounds))
    }

    fn rows_in(&self, bounds: Box3) -> Result<ModelRows, RemoteError> {
        let region = self.pruner.region(bounds)?;
        let selection = region.selection();
        let program = self.pruner.program();
        let all: Vec<&Tables> =
            std::iter::once(program.tables()).chain(self.answers.iter().map(|one| &one.tables)).collect();
        let tables = (0..selection.tables()).map(Table::new).map(|table| {
            let info = &program.info().tables[table];
            part_table(table, selection, &all, (info.rule != Rule::Never).then_some(&info.supports))
        });
        Ok(ModelRows {
            shape: self.shape.fingerprint(),
            uses: self.pruner.compiled().tree().leaf_uses(),
            bounds,
            tables: tables.collect(),
        })
    }
}

fn part_table(
    table: Table,
    selection: &Selection,
    all: &[&Tables],
    supports: Option<&std::sync::Arc<Vec<Support>>>,
) -> PartTable {
    let active = selection.active(table);
    let width: usize = all.iter().map(|tables| tables.tables[table].stride).sum();
    let each = size_of::<u32>() + (width + SUPPORT) * size_of::<f32>();
    watch::take(active.len() * each + size_of_val(selection.starts(table)));
    let gather = |tables: &Tables| -> Vec<f32> {
        let rows = &tables.tables[table];
        active.iter().flat_map(|&row| rows.row(row as usize)).copied().collect()
    };
    let mut numbers: Vec<PartNumbers> = Vec::with_capacity(all.len());
    for tables in all {
        let mine = gather(tables);
        let is_mine =
            |known: &PartNumbers| matches!(known, PartNumbers::Own(known) if same_bits(known, &mine));
        numbers.push(match numbers.iter().position(is_mine) {
            Some(earlier) => PartNumbers::As(earlier),
            None => PartNumbers::Own(mine),
        });
    }
    let support = |&row: &u32| {
        let of = supports.map(|supports| supports[row as usize]);
        of.into_iter().flat_map(|Support { low: [a, b, c], high: [d, e, f], radius_squared }| {
            [a, b, c, d, e, f, radius_squared]
        })
    };
    PartTable {
        starts: selection.starts(table).to_vec(),
        whole: active.to_vec(),
        supports: active.iter().flat_map(support).collect(),
        numbers,
    }
}

fn same_bits(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

impl PartTable {
    /// How many rows there are.
    pub(super) fn len(&self) -> usize {
        self.whole.len()
    }

    /// The supports of all rows.
    pub(super) fn supports(&self) -> Vec<Support> {
        if self.supports.is_empty() {
            return vec![Support::EVERYWHERE; self.len()];
        }
        let one = |&[a, b, c, d, e, f, radius_squared]: &[f32; SUPPORT]| Support {
            low: [a, b, c],
            high: [d, e, f],
            radius_squared,
        };
        self.supports.as_chunks().0.iter().map(one).collect()
    }

    /// The numbers in a program.
    pub(super) fn numbers(&self, program: usize) -> &[f32] {
        match &self.numbers[program] {
            PartNumbers::Own(numbers) => numbers,
            PartNumbers::As(earlier) => match &self.numbers[*earlier] {
                PartNumbers::Own(numbers) => numbers,
                PartNumbers::As(_) => &[],
            },
        }
    }
}

impl ModelRows {
    /// The box in which the rows are all that matters.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        self.bounds
    }

    /// How many there are, over all tables.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tables.iter().map(PartTable::len).sum()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many tables there are.
    #[must_use]
    pub fn tables(&self) -> usize {
        self.tables.len()
    }

    /// The numbers of the rows of a table in the whole model, ascending under each row of the parent. Panics
    /// if there is no such table.
    #[must_use]
    pub fn whole(&self, table: usize) -> &[u32] {
        &self.tables[table].whole
    }

    /// The rows as bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = ByteWriter::new(WORD, VERSION);
        writer.u64(self.shape);
        writer.u64(self.uses);
        let Box3 { low, high } = self.bounds;
        low.into_iter().chain(high).for_each(|side| writer.u32(side.to_bits()));
        writer.count(self.tables.len());
        for PartTable { starts, whole, supports, numbers } in &self.tables {
            writer.u32s(starts);
            writer.u32s(whole);
            writer.f32s(supports);
            writer.count(numbers.len());
            for numbers in numbers {
                match numbers {
                    PartNumbers::Own(numbers) => {
                        writer.u8(0);
                        writer.f32s(numbers);
                    }
                    PartNumbers::As(earlier) => {
                        writer.u8(1);
                        writer.u32(*earlier as u32);
                    }
                }
            }
        }
        writer.into_bytes()
    }

    /// Reads rows. Whether they fit a shape, [`from_rows`](super::from_rows) checks.
    ///
    /// # Errors
    /// Where the bytes are no rows of this version; want of memory.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FormatError> {
        let mut reader = ByteReader::new(bytes, WORD, VERSION)?;
        let (shape, uses) = (reader.u64()?, reader.u64()?);
        let mut sides = [0.0; 6];
        for side in &mut sides {
            *side = reader.f32()?;
        }
        let [a, b, c, d, e, f] = sides;
        let (count, mut tables) = reader.list(32)?;
        for _ in 0..count {
            let (starts, whole, supports) = (reader.u32s()?, reader.u32s()?, reader.f32s()?);
            if !supports.is_empty() && whole.len().checked_mul(SUPPORT) != Some(supports.len()) {
                return Err(reader.error("each row needs a support"));
            }
            let (count, mut numbers) = reader.list(5)?;
            for _ in 0..count {
                let own = !reader.flag()?;
                if own {
                    numbers.push(PartNumbers::Own(reader.f32s()?));
                    continue;
                }
                let earlier = reader.below(numbers.len())?;
                if !matches!(numbers[earlier], PartNumbers::Own(_)) {
                    return Err(reader.error("numbers are those of a program that has none of its own"));
                }
                numbers.push(PartNumbers::As(earlier));
            }
            tables.push(PartTable { starts, whole, supports, numbers });
        }
        reader.end()?;
        Ok(Self { shape, uses, bounds: Box3::new([a, b, c], [d, e, f]), tables })
    }
}
