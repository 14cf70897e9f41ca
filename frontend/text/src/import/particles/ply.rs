//! `.ply`: the element `vertex` of a polygon file, as text or in binary.
//!
//! ```text
//! ply
//! format ascii 1.0
//! element vertex 2
//! property float x           y, z; radius, strength; red, green, blue; other ones may become attributes
//! end_header
//! ```

use super::bytes::NumberType;
use super::csv::{PointTable, left_out, listed};
use super::options::{ParticleOptions, ParticleUse};
use super::scan::{TextLines, TextWord, fault, fault_at};
use crate::import::format::SceneFormatRow;
use crate::import::imported::ReadModel;
use jbt_model::diagnostic::Diagnostic;

pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow::of_particles(
    &["ply"],
    ("the vertices of a polygon file", &[ParticleUse::Columns]),
    is_mine,
    read,
);

fn is_mine(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

/// A property of an element.
struct PlyProperty {
    name: String,
    of: NumberType,
    /// The type of the count, if it is a list.
    list: Option<NumberType>,
}

struct PlyElement {
    name: String,
    count: usize,
    properties: Vec<PlyProperty>,
}

#[derive(Clone, Copy)]
enum PlyCoding {
    Text,
    Binary { big_endian: bool },
}

fn read(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    let (coding, elements, data) = header(bytes)?;
    let Some(index) = elements.iter().position(|element| element.name == "vertex") else {
        return Err(fault_at(0, "the file has no vertices", "an element vertex"));
    };
    let vertex = &elements[index];
    let names = || vertex.properties.iter().map(|property| &property.name);
    let made = PointTable::named(names().map(String::as_str), options);
    let mut table = made.map_err(|expected| fault_at(0, "the vertices have no places", expected))?;
    if table.len() != vertex.properties.len() {
        let message = format!(
            "vertices of {} properties, and {} names of columns",
            vertex.properties.len(),
            table.len()
        );
        return Err(fault_at(0, &message, "as many"));
    }
    let red = vertex.properties.iter().find(|property| property.name == "red");
    table.colors_are_bytes = red.is_some_and(|property| property.of == NumberType::U8);
    if let Some((place, _)) = (vertex.properties.iter().enumerate())
        .find(|(place, property)| property.list.is_some() && !table.ignores(*place))
    {
        return Err(fault_at(0, &format!("the property {place} of vertices is a list"), "a number"));
    }
    let skipped = names().enumerate().filter(|(place, _)| table.ignores(*place)).map(|it| it.1);
    let warning = if options.columns.is_empty() { left_out(skipped) } else { None };
    match coding {
        PlyCoding::Text => read_text(bytes, data, &elements[..=index], &mut table)?,
        PlyCoding::Binary { big_endian } => {
            read_binary(bytes, (data, big_endian), &elements[..=index], &mut table)?;
        }
    }
    let others = elements.iter().filter(|element| element.name != "vertex" && element.count > 0);
    let others = listed(others.map(|element| &element.name));
    let mut cloud = table.cloud();
    cloud.warnings.extend(warning);
    cloud.warnings.extend(
        others.map(|told| Diagnostic::warning(None, format!("{told} left out: vertices alone are read"))),
    );
    cloud.model(options)
}

fn header(bytes: &[u8]) -> Result<(PlyCoding, Vec<PlyElement>, usize), Vec<Diagnostic>> {
    if !is_mine(bytes) {
        return Err(fault_at(0, "this begins no polygon file", "`ply` and the end of a line"));
    }
    let mut lines = TextLines::from(bytes, 0);
    lines.next();
    let (mut coding, mut elements) = (None, Vec::<PlyElement>::new());
    while let Some(line) = lines.next() {
        let words: Vec<TextWord<'_>> = line.words().take(6).collect();
        let text: Vec<&[u8]> = words.iter().map(|word| word.text).collect();
        let wrong = |expected: &str| fault(line.span(), "a line of the head is not understood", expected);
        match text.as_slice() {
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", of, ..] => {
                coding = Some(match *of {
                    b"ascii" => PlyCoding::Text,
                    b"binary_little_endian" => PlyCoding::Binary { big_endian: false },
                    b"binary_big_endian" => PlyCoding::Binary { big_endian: true },
                    _ => return Err(wrong("ascii, binary_little_endian or binary_big_endian")),
                });
            }
            [b"element", name, _] => {
                let count = words[2].whole().ok_or_else(|| wrong("the number of elements"))?;
                let name = String::from_utf8_lossy(name).into_owned();
                elements.push(PlyElement { name, count, properties: Vec::new() });
            }
            [b"property", b"list", count, of, name] => {
                let types = number_type(count).zip(number_type(of));
                let (count, of) = types.ok_or_else(|| wrong("types of numbers"))?;
                let element = elements.last_mut().ok_or_else(|| wrong("an element first"))?;
                let name = String::from_utf8_lossy(name).into_owned();
                element.properties.push(PlyProperty { name, of, list: Some(count) });
            }
            [b"property", of, name] => {
                let of = number_type(of).ok_or_else(|| wrong("a type of numbers"))?;
                let element = elements.last_mut().ok_or_else(|| wrong("an element first"))?;
                element.properties.push(PlyProperty {
                    name: String::from_utf8_lossy(name).into_owned(),
                    of,
                    list: None,
                });
            }
            [b"end_header"] => {
                let coding = coding.ok_or_else(|| wrong("a format before"))?;
                return Ok((coding, elements, lines.at()));
            }
            _ => return Err(wrong("format, comment, element, property or end_header")),
        }
    }
    Err(fault_at(bytes.len(), "the head has no end", "end_header"))
}

fn number_type(word: &[u8]) -> Option<NumberType> {
    Some(match word {
        b"float" | b"float32" => NumberType::F32,
        b"double" | b"float64" => NumberType::F64,
        b"char" | b"int8" => NumberType::I8,
        b"uchar" | b"uint8" => NumberType::U8,
        b"short" | b"int16" => NumberType::I16,
        b"ushort" | b"uint16" => NumberType::U16,
        b"int" | b"int32" => NumberType::I32,
        b"uint" | b"uint32" => NumberType::U32,
        _ => return None,
    })
}

/// The elements up to the last of these, which goes into the table: a line each.
fn read_text(
    bytes: &[u8],
    data: usize,
    elements: &[PlyElement],
    table: &mut PointTable,
) -> Result<(), Vec<Diagnostic>> {
    let mut lines = TextLines::from(bytes, data).filter(|line| !line.is_blank());
    let Some((vertex, before)) = elements.split_last() else { return Ok(()) };
    for element in before {
        lines.by_ref().take(element.count).for_each(drop);
    }
    let mut row = vec![0.0; vertex.properties.len()];
    for found in 0..vertex.count {
        let Some(line) = lines.next() else { return Err(cut_off(bytes.len(), found, vertex.count)) };
        let mut words = line.words();
        for (column, number) in row.iter_mut().enumerate() {
            let missing = || fault(line.span(), "a vertex ends too early", "a number for each property");
            let word = words.next().ok_or_else(missing)?;
            if vertex.properties[column].list.is_some() {
                let count = word.whole().ok_or_else(missing)?;
                words.by_ref().take(count).for_each(drop);
            } else if !table.ignores(column) {
                *number = word.expect_number("a number of a vertex")?;
            }
        }
        table.push(&row);
    }
    Ok(())
}

fn cut_off(byte: usize, found: usize, count: usize) -> Vec<Diagnostic> {
    fault_at(byte, &format!("the file ends after {found} elements"), &format!("{count}, as its head says"))
}

fn read_binary(
    bytes: &[u8],
    (data, big_endian): (usize, bool),
    elements: &[PlyElement],
    table: &mut PointTable,
) -> Result<(), Vec<Diagnostic>> {
    let mut at = data;
    for (place, element) in elements.iter().enumerate() {
        let is_vertex = place + 1 == elements.len();
        let mut row = vec![0.0; element.properties.len()];
        // An element without properties takes no bytes, however many there are.
        let count = if element.properties.is_empty() { 0 } else { element.count };
        for found in 0..count {
            for (property, number) in element.properties.iter().zip(&mut row) {
                let mut take = |of: NumberType, count: usize| {
                    let end = count.checked_mul(of.size()).and_then(|length| at.checked_add(length));
                    let taken = end.and_then(|end| bytes.get(at..end));
                    let taken = taken.ok_or_else(|| cut_off(bytes.len(), found, element.count))?;
                    at += taken.len();
                    Ok::<&[u8], Vec<Diagnostic>>(taken)
                };
                match property.list {
                    Some(of) => {
                        let count = of.read(take(of, 1)?, big_endian);
                        take(property.of, count.max(0.0) as usize)?;
                    }
                    None => *number = property.of.read(take(property.of, 1)?, big_endian),
                }
            }
            if is_vertex {
                table.push(&row);
            }
        }
    }
    Ok(())
}
