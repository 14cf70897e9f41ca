//! `.vtk`: the points of a legacy file, as simulators of fluids write them. Numbers of a binary file have
//! their largest byte first, and begin right behind the end of their line.
//!
//! ```text
//! # vtk DataFile Version 2.0          2.0 to 5.1
//! a title
//! ASCII                               or BINARY
//! DATASET UNSTRUCTURED_GRID           or POLYDATA
//! POINTS 8 float                      and the numbers
//! POINT_DATA 8                        arrays, which may become attributes
//! ```
//!
//! Cells are skipped. What stands behind the points is looked at for attributes alone.

use std::collections::BTreeSet;

use super::bytes::NumberType;
use super::cloud::Cloud;
use super::csv::left_out;
use super::options::ParticleOptions;
use super::scan::{TextLine, TextLines, TextWord, fault, fault_at};
use crate::import::format::SceneFormatRow;
use crate::import::imported::ReadModel;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::particles::NumberArray;

pub(crate) const FORMAT: SceneFormatRow =
    SceneFormatRow::of_particles(&["vtk"], ("the points of a VTK file", &[]), is_mine, read);

const MAGIC: &[u8] = b"# vtk DataFile Version";

fn is_mine(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// A file under way.
struct LegacyFile<'a> {
    bytes: &'a [u8],
    at: usize,
    binary: bool,
    /// Arrays of points that nobody asks for.
    others: BTreeSet<String>,
}

fn read(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    let mut lines = TextLines::from(bytes, 0);
    let first = lines.next().filter(|line| is_mine(line.text));
    if first.is_none() {
        return Err(fault_at(0, "this begins no VTK file", "`# vtk DataFile Version`"));
    }
    lines.next();
    let coding = lines.find(|line| !line.is_blank());
    let binary = match coding.map(|line| line.columns(0, usize::MAX).text) {
        Some(b"ASCII") => false,
        Some(b"BINARY") => true,
        _ => {
            let span = coding
                .map_or_else(|| jbt_model::diagnostic::Span::new(bytes.len(), bytes.len()), TextLine::span);
            return Err(fault(span, "the coding is not known", "ASCII or BINARY"));
        }
    };
    let mut file = LegacyFile { bytes, at: lines.at(), binary, others: BTreeSet::new() };
    let (count, positions) = file.points()?;
    let mut cloud = Cloud::at(positions);
    let behind = file.values(count, options, &mut cloud);
    if !options.values.is_empty() {
        behind?;
    }
    cloud.warnings.extend(left_out(file.others.iter()));
    cloud.model(options)
}

impl<'a> LegacyFile<'a> {
    /// The next line that is not blank.
    fn line(&mut self) -> Option<TextLine<'a>> {
        let mut lines = TextLines::from(self.bytes, self.at);
        let line = lines.find(|line| !line.is_blank());
        self.at = lines.at();
        line
    }

    /// The points, and how many there are.
    fn points(&mut self) -> Result<(usize, NumberArray), Vec<Diagnostic>> {
        while let Some(line) = self.line() {
            let words: Vec<TextWord<'_>> = line.words().take(4).collect();
            let Some(keyword) = words.first() else { continue };
            match keyword.text {
                b"DATASET" => {
                    let of = words.get(1).map_or(&b""[..], |word| word.text);
                    if !matches!(of, b"UNSTRUCTURED_GRID" | b"POLYDATA" | b"STRUCTURED_GRID") {
                        return Err(fault(
                            line.span(),
                            "a data set without points",
                            "UNSTRUCTURED_GRID or POLYDATA",
                        ));
                    }
                }
                b"POINTS" => {
                    let wrong =
                        || fault(line.span(), "the line of points is not understood", "POINTS n float");
                    let count = words.get(1).and_then(|word| word.whole()).ok_or_else(wrong)?;
                    let of = words.get(2).and_then(|word| number_type(word.text)).ok_or_else(wrong)?;
                    return Ok((count, self.numbers(of, count.checked_mul(3).ok_or_else(wrong)?)?));
                }
                _ => {}
            }
        }
        Err(fault_at(self.bytes.len(), "the file has no points", "a line POINTS n float"))
    }

    /// So many numbers, which come next.
    fn numbers(&mut self, of: NumberType, count: usize) -> Result<NumberArray, Vec<Diagnostic>> {
        let cut_off = |found: usize| {
            let message = format!("the file ends after {found} of {count} numbers");
            fault_at(self.bytes.len(), &message, "all of them")
        };
        if self.binary {
            let end = count.checked_mul(of.size()).and_then(|length| self.at.checked_add(length));
            let data = end.and_then(|end| self.bytes.get(self.at..end));
            let data = data.ok_or_else(|| cut_off((self.bytes.len() - self.at) / of.size()))?;
            self.at += data.len();
            return Ok(of.array(data, true));
        }
        // No number takes less than a byte and a blank.
        let mut numbers = Vec::with_capacity(count.min(self.bytes.len() / 2 + 1));
        let mut lines = TextLines::from(self.bytes, self.at);
        while numbers.len() < count {
            let Some(line) = lines.next() else { return Err(cut_off(numbers.len())) };
            for word in line.words() {
                if numbers.len() == count {
                    return Err(fault(word.span(), "a number too many", &format!("{count} numbers")));
                }
                numbers.push(word.expect_number("a number")?);
            }
        }
        self.at = lines.at();
        Ok(numbers.into())
    }

    /// The arrays of points that are asked for.
    fn values(
        &mut self,
        points: usize,
        options: &ParticleOptions,
        cloud: &mut Cloud,
    ) -> Result<(), Vec<Diagnostic>> {
        // Arrays of cells come before or behind those of points.
        let mut of_points = false;
        while let Some(line) = self.line() {
            let words: Vec<TextWord<'_>> = line.words().take(4).collect();
            let whole = |place: usize| words.get(place).and_then(|word| word.whole());
            let name = || words.get(1).map_or_else(String::new, |word| word.shown());
            match words.first().map_or(&b""[..], |word| word.text) {
                b"POINT_DATA" => of_points = true,
                b"CELL_DATA" => of_points = false,
                b"SCALARS" => {
                    let Some(of) = words.get(2).and_then(|word| number_type(word.text)) else { continue };
                    let (name, width) = (name(), whole(3).unwrap_or(1));
                    let behind = self.at;
                    if !self.line().is_some_and(|line| line.text.starts_with(b"LOOKUP_TABLE")) {
                        self.at = behind;
                    }
                    self.value(of_points.then_some(points), (name, width, of), options, cloud)?;
                }
                b"VECTORS" | b"NORMALS" => {
                    let Some(of) = words.get(2).and_then(|word| number_type(word.text)) else { continue };
                    self.value(of_points.then_some(points), (name(), 3, of), options, cloud)?;
                }
                b"FIELD" => {
                    for _ in 0..whole(2).unwrap_or(0) {
                        let Some(line) = self.line() else { break };
                        let words: Vec<TextWord<'_>> = line.words().take(4).collect();
                        let whole = |place: usize| words.get(place).and_then(|word| word.whole());
                        let of = words.get(3).and_then(|word| number_type(word.text));
                        let (Some(width), Some(tuples), Some(of)) = (whole(1), whole(2), of) else {
                            return Err(fault(line.span(), "an array is not understood", "NAME n m float"));
                        };
                        let is_of_points = of_points && tuples == points;
                        if !is_of_points {
                            self.numbers(of, width.saturating_mul(tuples))?;
                            continue;
                        }
                        self.value(Some(points), (words[0].shown(), width, of), options, cloud)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// An array of points, which comes next: it is kept if it is asked for.
    fn value(
        &mut self,
        points: Option<usize>,
        (name, width, of): (String, usize, NumberType),
        options: &ParticleOptions,
        cloud: &mut Cloud,
    ) -> Result<(), Vec<Diagnostic>> {
        // Those of cells are as long as nobody knows here; the next keyword is looked for.
        let Some(points) = points else { return Ok(()) };
        let numbers = self.numbers(of, width.saturating_mul(points))?;
        if !options.values.contains(&name) {
            self.others.insert(name);
        } else if width > 0 {
            cloud.values.push((name, width, numbers));
        }
        Ok(())
    }
}

fn number_type(word: &[u8]) -> Option<NumberType> {
    Some(match word {
        b"float" => NumberType::F32,
        b"double" => NumberType::F64,
        b"char" => NumberType::I8,
        b"unsigned_char" => NumberType::U8,
        b"short" => NumberType::I16,
        b"unsigned_short" => NumberType::U16,
        b"int" => NumberType::I32,
        b"unsigned_int" => NumberType::U32,
        b"long" | b"vtktypeint64" => NumberType::I64,
        b"unsigned_long" => NumberType::U64,
        _ => return None,
    })
}
