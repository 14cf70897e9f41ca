//! What pruning has to know of a model's tables, but for its rows, as bytes.

use jbt_ir::{Entity as _, Function, InstKind, Rule, Store, Table, Value};
use jbt_lower::prune_info::{
    ContestDifference, ContestGroup, ContestKind, Decision, DecisionKind, DifferenceSide, PruneInfo,
    RowContest, StepFields, SupportSpace, TablePruneInfo,
};
use jbt_model::combine::Extreme;

use super::header::place;
use crate::bytes::{ByteReader, ByteWriter, FormatError};

const EXTREMES: [Extreme; 2] = [Extreme::Largest, Extreme::Smallest];
const DECISIONS: [DecisionKind; 4] = [
    DecisionKind::UnionOperand,
    DecisionKind::IntersectionOperand,
    DecisionKind::DifferenceLeft,
    DecisionKind::DifferenceRight,
];
const STEPS: [StepFields; 2] = [StepFields::Plain, StepFields::Complements];
const SIDES: [DifferenceSide; 2] = [DifferenceSide::Left, DifferenceSide::Right];

/// Writes it.
pub(super) fn write(info: &PruneInfo, writer: &mut ByteWriter) {
    writer.count(info.tables.len());
    for table in info.tables.values() {
        match table.space {
            SupportSpace::World => writer.u8(0),
            SupportSpace::Unknown => writer.u8(1),
            SupportSpace::Probed(probe) => {
                writer.u8(2);
                writer.u32(probe as u32);
            }
        }
        writer.u8(place(&Rule::ALL, table.rule));
        writer.u8(u8::from(table.is_hoisted));
    }
    writer.u32(info.probes as u32);
    writer.u32(info.iso2.to_bits());
    writer.count(info.decisions.len());
    for Decision { table, operand, node, kind } in &info.decisions {
        [table.index(), *operand, *node].into_iter().for_each(|index| writer.u32(index as u32));
        writer.u8(place(&DECISIONS, *kind));
    }
    writer.count(info.contests.len());
    info.contests.iter().for_each(|contest| write_contest(contest, writer));
}

fn write_contest(contest: &RowContest, writer: &mut ByteWriter) {
    let RowContest { extreme, kind, groups, node, difference } = contest;
    writer.u8(place(&EXTREMES, *extreme));
    match kind {
        ContestKind::All(None) => writer.u8(0),
        ContestKind::All(Some(number)) => {
            writer.u8(1);
            writer.u32(number.to_bits());
        }
        ContestKind::Steps(table, column, fields) => {
            writer.u8(2);
            writer.u32(table.index() as u32);
            writer.u32(*column as u32);
            writer.u8(place(&STEPS, *fields));
        }
    }
    writer.count(groups.len());
    groups.iter().for_each(|group| write_group(group, writer));
    write_probe(*node, writer);
    writer.u8(u8::from(difference.is_some()));
    if let Some(ContestDifference { side, other, node }) = difference {
        writer.u8(place(&SIDES, *side));
        write_group(other, writer);
        write_probe(*node, writer);
    }
}

fn write_group(ContestGroup { table, field, rows }: &ContestGroup, writer: &mut ByteWriter) {
    writer.u32(table.index() as u32);
    writer.u32(field.index() as u32);
    writer.u8(u8::from(*rows));
}

fn write_probe(probe: Option<usize>, writer: &mut ByteWriter) {
    writer.u8(u8::from(probe.is_some()));
    writer.u32(probe.unwrap_or(0) as u32);
}

/// Reads it, for the range function of the model. The tables have no rows.
pub(super) fn read(reader: &mut ByteReader<'_>, function: &Function) -> Result<PruneInfo, FormatError> {
    let probes = function.outputs.len().saturating_sub(1);
    let count = reader.count(3)?;
    if count != function.tables.len() {
        return Err(reader.error("the range function has another number of tables"));
    }
    let mut tables = Store::new();
    for _ in 0..count {
        let space = match reader.one_of(&[0, 1, 2])? {
            0 => SupportSpace::World,
            1 => SupportSpace::Unknown,
            _ => SupportSpace::Probed(reader.below(probes.saturating_sub(2))?),
        };
        let (rule, is_hoisted) = (reader.one_of(&Rule::ALL)?, reader.flag()?);
        tables.push(TablePruneInfo {
            space,
            supports: Default::default(),
            rule,
            nodes: Vec::new(),
            is_hoisted,
        });
    }
    if reader.u32()? as usize != probes {
        return Err(reader.error("the range function has another number of probes"));
    }
    let iso2 = reader.f32()?;
    let mut decisions = Vec::new();
    for _ in 0..reader.count(13)? {
        let table = Table::new(reader.below(count)?);
        let (operand, node) = (reader.below(probes)?, reader.below(probes)?);
        decisions.push(Decision { table, operand, node, kind: reader.one_of(&DECISIONS)? });
    }
    let bodies = Bodies::of(function);
    let mut contests = Vec::new();
    for _ in 0..reader.count(14)? {
        contests.push(read_contest(reader, function, &bodies)?);
    }
    Ok(PruneInfo { tables, probes, decisions, contests, iso2 })
}

fn read_contest(
    reader: &mut ByteReader<'_>,
    function: &Function,
    bodies: &Bodies,
) -> Result<RowContest, FormatError> {
    let tables = function.tables.len();
    let extreme = reader.one_of(&EXTREMES)?;
    let kind = match reader.one_of(&[0, 1, 2])? {
        0 => ContestKind::All(None),
        1 => ContestKind::All(Some(reader.f32()?)),
        _ => {
            let table = Table::new(reader.below(tables)?);
            let column = reader.below(function.tables[table].columns.len())?;
            ContestKind::Steps(table, column, reader.one_of(&STEPS)?)
        }
    };
    let mut groups = Vec::new();
    for _ in 0..reader.count(9)? {
        groups.push(read_group(reader, function, bodies)?);
    }
    let node = read_probe(reader, function)?;
    let owner = owner(function, kind, &groups);
    if owner.is_none() {
        return Err(reader.error("the operands of a contest hang under different tables"));
    }
    let mut difference = None;
    if reader.flag()? {
        let side = reader.one_of(&SIDES)?;
        let other = read_group(reader, function, bodies)?;
        if !is_at_or_above(function, owner, other.table) {
            return Err(reader.error(format!("{} is not above the operands of a contest", other.table)));
        }
        difference = Some(ContestDifference { side, other, node: read_probe(reader, function)? });
    }
    Ok(RowContest { extreme, kind, groups, node, difference })
}

fn read_group(
    reader: &mut ByteReader<'_>,
    function: &Function,
    bodies: &Bodies,
) -> Result<ContestGroup, FormatError> {
    let table = Table::new(reader.below(function.tables.len())?);
    let (field, rows) = (Value::new(reader.below(function.values.len())?), reader.flag()?);
    if !bodies.see(table, field) {
        return Err(reader.error(format!("the rows of {table} do not see {field}")));
    }
    Ok(ContestGroup { table, field, rows })
}

fn read_probe(reader: &mut ByteReader<'_>, function: &Function) -> Result<Option<usize>, FormatError> {
    let (is_there, probe) = (reader.flag()?, reader.u32()? as usize);
    if is_there && probe + 1 >= function.outputs.len() {
        return Err(reader.error("a contest has a probe that is not there"));
    }
    Ok(is_there.then_some(probe))
}

/// The table whose rows the operands of a contest hang under: all of them are rows of these rows, or are
/// these rows themselves.
fn owner(function: &Function, kind: ContestKind, groups: &[ContestGroup]) -> Option<Table> {
    let above = |group: &ContestGroup| {
        if group.rows { function.tables[group.table].parent } else { Some(group.table) }
    };
    let owner = groups.first().and_then(above)?;
    let is_owner = match kind {
        ContestKind::All(_) => true,
        ContestKind::Steps(table, ..) => owner == table,
    };
    (is_owner && groups.iter().all(|group| above(group) == Some(owner))).then_some(owner)
}

/// Whether a table is this one or above it.
fn is_at_or_above(function: &Function, mut below: Option<Table>, table: Table) -> bool {
    while let Some(at) = below.filter(|&at| at != table) {
        below = function.tables[at].parent;
    }
    below.is_some()
}

/// Which values the rows of a table see.
struct Bodies {
    /// For each value, the table in whose rows it is computed; `None` in the function's body.
    of_value: Vec<Option<Table>>,
    /// For each table, that in whose rows its fold stands.
    around: Vec<Option<Table>>,
}

impl Bodies {
    fn of(function: &Function) -> Self {
        let mut of_value = vec![None; function.values.len()];
        let mut around = vec![None; function.tables.len()];
        for data in function.insts.values() {
            let InstKind::Fold(fold) = &data.kind else { continue };
            let body = &function.blocks[fold.body];
            let results = body.insts.iter().flat_map(|&inst| &function.insts[inst].results);
            body.params.iter().chain(results).for_each(|value| of_value[value.index()] = Some(fold.table));
            for &inst in &body.insts {
                if let InstKind::Fold(inner) = &function.insts[inst].kind {
                    around[inner.table.index()] = Some(fold.table);
                }
            }
        }
        Self { of_value, around }
    }

    /// Whether a value is computed in the rows of a table, or around them.
    fn see(&self, table: Table, value: Value) -> bool {
        let mut at = Some(table);
        while at != self.of_value[value.index()] {
            let Some(table) = at else { return false };
            at = self.around[table.index()];
        }
        true
    }
}
