//! `.npy`: an array of numpy, version 1 to 3.
//!
//! ```text
//! 93 "NUMPY" major minor length { 'descr': '<f4', 'fortran_order': False, 'shape': (n, 3), } numbers
//! ```
//!
//! It has a row for each point: three numbers, or four with a radius; or a column for each.

use super::bytes::NumberType;
use super::cloud::Cloud;
use super::csv::PointTable;
use super::options::{ParticleOptions, ParticleUse};
use super::scan::fault_at;
use crate::import::format::SceneFormatRow;
use crate::import::imported::ReadModel;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::particles::NumberArray;

pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow::of_particles(
    &["npy"],
    ("an array of numpy", &[ParticleUse::Columns]),
    |bytes| bytes.starts_with(MAGIC),
    read,
);

const MAGIC: &[u8] = b"\x93NUMPY";

/// What the head of a file says.
struct NumpyHead {
    of: NumberType,
    big_endian: bool,
    fortran: bool,
    shape: [usize; 2],
    /// Where the numbers begin.
    data: usize,
}

fn read(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    let head = head(bytes)?;
    let size = head.of.size();
    let [rows, columns] = head.shape;
    let wanted = rows.checked_mul(columns).and_then(|count| count.checked_mul(size));
    let data = &bytes[head.data..];
    if wanted != Some(data.len()) {
        let message = format!("{} bytes of numbers of an array ({rows}, {columns})", data.len());
        return Err(fault_at(head.data, &message, "as many as its shape says"));
    }
    let width = |count: usize| {
        if options.columns.is_empty() { matches!(count, 3 | 4) } else { count == options.columns.len() }
    };
    let is_rows = width(columns);
    if !is_rows && !width(rows) {
        let message = format!("an array of shape ({rows}, {columns})");
        return Err(fault_at(
            head.data,
            &message,
            "(n, 3), or (n, 4) with radii; --columns tells other columns",
        ));
    }
    let (count, width) = if is_rows { (rows, columns) } else { (columns, rows) };
    // Whether the numbers of a point follow each other.
    let together = is_rows != head.fortran;
    if together && width == 3 && options.columns.is_empty() {
        return Cloud::at(head.of.array(data, head.big_endian)).model(options);
    }
    let numbers: NumberArray = head.of.array(data, head.big_endian);
    let names = ["x", "y", "z", "radius"];
    let made = match options.columns.is_empty() {
        true => PointTable::named(names[..width].iter().copied(), options),
        false => PointTable::told(options),
    };
    let mut table = made.map_err(|expected| fault_at(head.data, "the columns tell no places", expected))?;
    let mut row = vec![0.0; width];
    for point in 0..count {
        for (column, number) in row.iter_mut().enumerate() {
            *number = numbers.at(if together { point * width + column } else { column * count + point });
        }
        table.push(&row);
    }
    table.cloud().model(options)
}

fn head(bytes: &[u8]) -> Result<NumpyHead, Vec<Diagnostic>> {
    let version = bytes.get(6).copied();
    let (from, length): (usize, usize) =
        match (bytes.starts_with(MAGIC), version, bytes.get(8..10), bytes.get(8..12)) {
            (true, Some(1), Some(two), _) => (10, usize::from(u16::from_le_bytes([two[0], two[1]]))),
            (true, Some(2 | 3), _, Some(four)) => {
                (12, u32::from_le_bytes([four[0], four[1], four[2], four[3]]) as usize)
            }
            _ => return Err(fault_at(0, "this begins no array of numpy", "a file of version 1 to 3")),
        };
    let Some(dict) = from.checked_add(length).and_then(|to| bytes.get(from..to)) else {
        return Err(fault_at(from, "the head is cut off", "a dictionary"));
    };
    let dict = String::from_utf8_lossy(dict);
    let wrong = |message: &str, expected: &str| Err(fault_at(from, message, expected));
    let value = |key: &str| {
        let (_, rest) = dict.split_once(&format!("'{key}'"))?;
        Some(rest.trim_start().strip_prefix(':')?.trim_start())
    };
    let quoted = |text: &str| {
        let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
        Some(text[1..].split_once(quote)?.0.to_owned())
    };
    let Some(descr) = value("descr").and_then(quoted) else {
        return wrong("the array has no simple type", "numbers, as '<f4'");
    };
    let Some((of, big_endian)) = number_type(&descr) else {
        return wrong(&format!("an array of type {}", jbt_model::report::clip(&descr)), "numbers, as '<f4'");
    };
    let fortran = match value("fortran_order") {
        Some(text) if text.starts_with("True") => true,
        Some(text) if text.starts_with("False") => false,
        _ => return wrong("the head tells no order", "'fortran_order': True or False"),
    };
    let shape = value("shape").and_then(|text| text.strip_prefix('(')?.split_once(')'));
    let shape =
        shape.map(|(list, _)| list.split(',').map(str::trim).filter(|it| !it.is_empty()).map(str::parse));
    let shape: Option<Vec<usize>> = shape.and_then(|sizes| sizes.collect::<Result<_, _>>().ok());
    let Some(&[rows, columns]) = shape.as_deref() else {
        return wrong("the array has not two axes", "'shape': (n, 3)");
    };
    Ok(NumpyHead { of, big_endian, fortran, shape: [rows, columns], data: from + length })
}

/// The type of a `descr`, and whether the first byte is the largest.
fn number_type(descr: &str) -> Option<(NumberType, bool)> {
    let (order, rest) = match descr.as_bytes().first()? {
        b'<' | b'|' | b'=' => (false, &descr[1..]),
        b'>' => (true, &descr[1..]),
        _ => (false, descr),
    };
    let of = match rest {
        "f4" => NumberType::F32,
        "f8" => NumberType::F64,
        "i1" => NumberType::I8,
        "u1" => NumberType::U8,
        "i2" => NumberType::I16,
        "u2" => NumberType::U16,
        "i4" => NumberType::I32,
        "u4" => NumberType::U32,
        "i8" => NumberType::I64,
        "u8" => NumberType::U64,
        _ => return None,
    };
    Some((of, order))
}
