//! `.vtu`: the points of an XML file of VTK. Arrays are text, or bytes in base64 or behind all tags,
//! compressed by zlib (feature `zlib`) or not.
//!
//! ```text
//! <VTKFile type="UnstructuredGrid" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
//!   <UnstructuredGrid> <Piece NumberOfPoints="8">
//!     <PointData> <DataArray type="Float32" Name="density" format="appended" offset="0"/> </PointData>
//!     <Points> <DataArray type="Float32" NumberOfComponents="3" format="binary"> AQAA.. </DataArray> </Points>
//!   </Piece> </UnstructuredGrid>
//!   <AppendedData encoding="raw"> _.. </AppendedData>
//! </VTKFile>
//! ```

use std::collections::BTreeSet;

use super::bytes::NumberType;
use super::cloud::Cloud;
use super::csv::left_out;
use super::options::ParticleOptions;
use super::scan::{TextLines, fault_at};
use super::xml::{Tag, Tags};
use crate::import::format::SceneFormatRow;
use crate::import::imported::ReadModel;
use jbt_model::diagnostic::Diagnostic;

pub(crate) const FORMAT: SceneFormatRow =
    SceneFormatRow::of_particles(&["vtu", "vtp"], ("the points of a VTK file in XML", &[]), is_mine, read);

fn is_mine(bytes: &[u8]) -> bool {
    let beginning = &bytes[..bytes.len().min(1024)];
    beginning.windows(8).any(|window| window == b"<VTKFile")
}

/// How all arrays of a file are coded.
struct ArrayCoding<'a> {
    bytes: &'a [u8],
    big_endian: bool,
    /// The type of the numbers in front of an array.
    header: NumberType,
    compressed: bool,
    /// Where bytes behind all tags begin, and whether they are base64.
    appended: Option<(usize, bool)>,
    /// Bytes of arrays that may be made still: compressed ones grow.
    room: usize,
}

/// The most bytes that compressed arrays of one file become.
const MAX_UNPACKED: usize = 1 << 33;

/// Where the walk over tags is.
#[derive(Clone, Copy, PartialEq)]
enum VtuPlace {
    Elsewhere,
    Points,
    PointData,
}

fn read(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    let mut coding = ArrayCoding::of(bytes)?;
    let mut place = VtuPlace::Elsewhere;
    let mut positions: Vec<f64> = Vec::new();
    let mut values: Vec<(String, usize, Vec<f64>)> = Vec::new();
    let mut others = BTreeSet::new();
    for tag in (Tags { bytes, at: 0 }).take_while(|tag| tag.name != b"AppendedData") {
        match tag.name {
            b"Points" => place = if tag.closes { VtuPlace::Elsewhere } else { VtuPlace::Points },
            b"PointData" if !tag.is_empty => {
                place = if tag.closes { VtuPlace::Elsewhere } else { VtuPlace::PointData }
            }
            b"DataArray" if !tag.closes && place == VtuPlace::Points => {
                let numbers = coding.numbers(&tag)?;
                if numbers.len() % 3 != 0 {
                    let message = format!("{} numbers of points", numbers.len());
                    return Err(fault_at(tag.start, &message, "three for each"));
                }
                positions.extend(numbers);
            }
            b"DataArray" if !tag.closes && place == VtuPlace::PointData => {
                let Some(name) = tag.attribute("Name") else { continue };
                if !options.values.contains(&name) {
                    others.insert(name);
                    continue;
                }
                let width = tag.attribute("NumberOfComponents").and_then(|it| it.parse().ok()).unwrap_or(1);
                let numbers = coding.numbers(&tag)?;
                match values.iter_mut().find(|(known, ..)| *known == name) {
                    Some((.., all)) => all.extend(numbers),
                    None => values.push((name, width, numbers)),
                }
            }
            _ => {}
        }
    }
    if positions.is_empty() {
        return Err(fault_at(bytes.len(), "the file ends without points", "a tag Points with an array"));
    }
    let mut cloud = Cloud::at(positions);
    cloud.values = values.into_iter().map(|(name, width, all)| (name, width.max(1), all.into())).collect();
    cloud.warnings.extend(left_out(others.iter()));
    cloud.model(options)
}

impl<'a> ArrayCoding<'a> {
    fn of(bytes: &'a [u8]) -> Result<Self, Vec<Diagnostic>> {
        let mut tags = Tags { bytes, at: 0 };
        let Some(file) = tags.find(|tag| tag.name == b"VTKFile") else {
            return Err(fault_at(0, "this is no VTK file", "a tag VTKFile"));
        };
        let wrong = |message: &str, expected: &str| Err(fault_at(file.start, message, expected));
        let is_points = |of: String| matches!(of.as_str(), "UnstructuredGrid" | "PolyData");
        if !file.attribute("type").is_some_and(is_points) {
            return wrong("a file without points", "type UnstructuredGrid or PolyData");
        }
        let compressed = match file.attribute("compressor").as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") if cfg!(feature = "zlib") => true,
            Some(other) => {
                let other = jbt_model::report::clip(other);
                return wrong(&format!("arrays compressed by {other}"), "vtkZLibDataCompressor, or none");
            }
        };
        let header = match file.attribute("header_type").as_deref() {
            None | Some("UInt32") => NumberType::U32,
            Some("UInt64") => NumberType::U64,
            Some(_) => return wrong("a type of headers that is not known", "UInt32 or UInt64"),
        };
        let big_endian = file.attribute("byte_order").is_some_and(|order| order == "BigEndian");
        let appended = tags.find(|tag| tag.name == b"AppendedData").and_then(|tag| {
            let mark = bytes[tag.end..].iter().position(|&byte| byte == b'_')?;
            Some((tag.end + mark + 1, tag.attribute("encoding").is_some_and(|it| it == "base64")))
        });
        Ok(Self { bytes, big_endian, header, compressed, appended, room: MAX_UNPACKED })
    }

    /// The numbers of an array.
    fn numbers(&mut self, tag: &Tag<'_>) -> Result<Vec<f64>, Vec<Diagnostic>> {
        let wrong = |message: &str, expected: &str| Err(fault_at(tag.start, message, expected));
        let of = tag.attribute("type").and_then(|name| number_type(&name));
        let Some(of) = of else { return wrong("an array of a type that is not known", "a type as Float32") };
        let rest = &self.bytes[tag.end..];
        let inner = &rest[..rest.iter().position(|&byte| byte == b'<').unwrap_or(rest.len())];
        let data = match tag.attribute("format").as_deref() {
            None | Some("ascii") => {
                let mut numbers = Vec::new();
                for line in TextLines::from(&self.bytes[..tag.end + inner.len()], tag.end) {
                    for word in line.words() {
                        numbers.push(word.expect_number("a number")?);
                    }
                }
                return Ok(numbers);
            }
            Some("binary") => self.unpacked(tag, inner.trim_ascii(), true)?,
            Some("appended") => {
                let offset: Option<usize> = tag.attribute("offset").and_then(|it| it.parse().ok());
                let (Some((start, base64)), Some(offset)) = (self.appended, offset) else {
                    return wrong("the array is not there", "an offset, and AppendedData");
                };
                let rest = start.checked_add(offset).and_then(|at| self.bytes.get(at..));
                let Some(rest) = rest else {
                    return wrong("the array begins behind the file", "another offset");
                };
                self.unpacked(tag, rest, base64)?
            }
            Some(_) => return wrong("a format that is not known", "ascii, binary or appended"),
        };
        if data.len() % of.size() != 0 {
            return wrong("an array ends within a number", "whole numbers");
        }
        Ok(data.chunks_exact(of.size()).map(|it| of.read(it, self.big_endian)).collect())
    }

    /// The bytes of an array, behind the numbers that tell how many there are.
    fn unpacked(&mut self, tag: &Tag<'_>, data: &[u8], base64: bool) -> Result<Vec<u8>, Vec<Diagnostic>> {
        let cut_off = || fault_at(tag.start, "the array is cut off", "as many bytes as it says");
        let size = self.header.size();
        let take = |from: usize, count: usize| -> Result<(Vec<u8>, usize), Vec<Diagnostic>> {
            if !base64 {
                let end = from.checked_add(count).ok_or_else(cut_off)?;
                return Ok((data.get(from..end).ok_or_else(cut_off)?.to_vec(), end));
            }
            let length = count.div_ceil(3).checked_mul(4).ok_or_else(cut_off)?;
            let end = from.checked_add(length).ok_or_else(cut_off)?;
            let mut bytes = decode(data.get(from..end).ok_or_else(cut_off)?).ok_or_else(cut_off)?;
            bytes.truncate(count);
            Ok((bytes, end))
        };
        let word =
            |bytes: &[u8], place: usize| self.header.read(&bytes[place * size..][..size], self.big_endian);
        if !self.compressed {
            let (head, _) = take(0, size)?;
            let count = word(&head, 0) as usize;
            // In base64 the head and the bytes are one text.
            let (mut all, _) = take(0, count.checked_add(size).ok_or_else(cut_off)?)?;
            return Ok(all.split_off(size));
        }
        let (head, _) = take(0, 3 * size)?;
        let [blocks, block, last] = [0, 1, 2].map(|place| word(&head, place) as usize);
        let words = blocks.checked_add(3).and_then(|words| words.checked_mul(size)).ok_or_else(cut_off)?;
        let (head, mut at) = take(0, words)?;
        let sizes: Vec<usize> = (0..blocks).map(|place| word(&head, 3 + place) as usize).collect();
        let packed =
            sizes.iter().try_fold(0_usize, |all, size| all.checked_add(*size)).ok_or_else(cut_off)?;
        let (packed, _) = take(at, packed)?;
        let mut unpacked = Vec::new();
        at = 0;
        for (place, size) in sizes.iter().enumerate() {
            let most = if place + 1 == blocks && last > 0 { last } else { block };
            self.room = self.room.checked_sub(most).ok_or_else(|| {
                vec![Diagnostic::limit(None, format!("arrays of more than {} GiB", MAX_UNPACKED >> 30))]
            })?;
            let part = &packed[at..at + size];
            let made = inflate(part, most).ok_or_else(|| {
                fault_at(tag.start, "the array does not unpack", "blocks of zlib of the size that it says")
            })?;
            unpacked.extend(made);
            at += size;
        }
        Ok(unpacked)
    }
}

/// The bytes that zlib has compressed, if they are at most so many.
fn inflate(packed: &[u8], most: usize) -> Option<Vec<u8>> {
    #[cfg(feature = "zlib")]
    return miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(packed, most).ok();
    #[cfg(not(feature = "zlib"))]
    unreachable!("{} bytes of at most {most} are not asked for", packed.len())
}

/// The bytes of a text in base64, whole groups of four letters.
fn decode(text: &[u8]) -> Option<Vec<u8>> {
    let value = |letter: u8| {
        Some(u32::from(match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' => 0,
            _ => return None,
        }))
    };
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    for group in text.chunks(4) {
        let bits = group.iter().try_fold(0, |bits, &letter| Some(bits << 6 | value(letter)?))?;
        let bits = bits << (6 * (4 - group.len()));
        bytes.extend(&bits.to_be_bytes()[1..]);
    }
    Some(bytes)
}

fn number_type(name: &str) -> Option<NumberType> {
    Some(match name {
        "Float32" => NumberType::F32,
        "Float64" => NumberType::F64,
        "Int8" => NumberType::I8,
        "UInt8" => NumberType::U8,
        "Int16" => NumberType::I16,
        "UInt16" => NumberType::U16,
        "Int32" => NumberType::I32,
        "UInt32" => NumberType::U32,
        "Int64" => NumberType::I64,
        "UInt64" => NumberType::U64,
        _ => return None,
    })
}
