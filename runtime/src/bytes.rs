//! Plain bytes for other processes: numbers in little-endian order, lists with their length in front.
//!
//! What is read may be anybody's. A length is compared with the bytes that are left before memory is taken,
//! and a reader says at which byte it stopped.

use jbt_ir::memory::{NoMemory, probe, room};

use crate::error::{Classified, ErrorKind};

/// Why bytes are not what they should be.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[non_exhaustive]
#[error("byte {at}: {problem}")]
pub struct FormatError {
    /// Where.
    pub at: usize,
    /// What is wrong.
    pub problem: String,
    /// `Argument`: the bytes are wrong. `Limit`: there is no memory for what they hold.
    pub kind: ErrorKind,
}

impl Classified for FormatError {
    fn kind(&self) -> ErrorKind {
        self.kind
    }
}

/// Writes bytes.
pub(crate) struct ByteWriter(Vec<u8>);

impl ByteWriter {
    /// Begins with a word of eight bytes and a version.
    pub(crate) fn new(word: &[u8; 8], version: u32) -> Self {
        let mut writer = Self(word.to_vec());
        writer.u32(version);
        writer
    }

    pub(crate) fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    pub(crate) fn u8(&mut self, number: u8) {
        self.0.push(number);
    }

    pub(crate) fn u32(&mut self, number: u32) {
        self.0.extend_from_slice(&number.to_le_bytes());
    }

    pub(crate) fn u64(&mut self, number: u64) {
        self.0.extend_from_slice(&number.to_le_bytes());
    }

    pub(crate) fn f64(&mut self, number: f64) {
        self.u64(number.to_bits());
    }

    /// A number of things.
    pub(crate) fn count(&mut self, count: usize) {
        self.u64(count as u64);
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.count(text.len());
        self.0.extend_from_slice(text.as_bytes());
    }

    pub(crate) fn u32s(&mut self, numbers: &[u32]) {
        self.count(numbers.len());
        self.0.reserve(4 * numbers.len());
        numbers.iter().for_each(|&number| self.u32(number));
    }

    pub(crate) fn f32s(&mut self, numbers: &[f32]) {
        self.count(numbers.len());
        self.0.reserve(4 * numbers.len());
        numbers.iter().for_each(|&number| self.u32(number.to_bits()));
    }
}

/// Reads bytes.
pub(crate) struct ByteReader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> ByteReader<'a> {
    /// Behind the word and the version, which have to be these.
    pub(crate) fn new(bytes: &'a [u8], word: &[u8; 8], version: u32) -> Result<Self, FormatError> {
        let mut reader = Self { bytes, at: 0 };
        let name = String::from_utf8_lossy(word).trim_end().to_owned();
        if reader.take(8).ok() != Some(&word[..]) {
            reader.at = 0;
            return Err(reader.error(format!("these are no bytes of {name:?}")));
        }
        let found = reader.u32()?;
        if found != version {
            return Err(
                reader.error(format!("{name:?} of version {found}, and this program reads {version}"))
            );
        }
        Ok(reader)
    }

    /// An error here.
    pub(crate) fn error(&self, problem: impl Into<String>) -> FormatError {
        FormatError { at: self.at, problem: problem.into(), kind: ErrorKind::Argument }
    }

    /// What is read takes so many times the memory of the bytes: an error if it is not there.
    pub(crate) fn afford(&self, times: usize) -> Result<(), FormatError> {
        probe(self.bytes.len().saturating_mul(times)).map_err(|error| self.no_memory(error))
    }

    fn no_memory(&self, error: NoMemory) -> FormatError {
        FormatError { kind: ErrorKind::Limit, ..self.error(error.to_string()) }
    }

    /// Nothing may be left.
    pub(crate) fn end(self) -> Result<(), FormatError> {
        if self.at == self.bytes.len() { Ok(()) } else { Err(self.error("nothing was expected here")) }
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], FormatError> {
        match self.bytes[self.at..].get(..count) {
            Some(taken) => {
                self.at += count;
                Ok(taken)
            }
            None => Err(self.error("the bytes end too soon")),
        }
    }

    pub(crate) fn u8(&mut self) -> Result<u8, FormatError> {
        Ok(self.take(1)?[0])
    }

    pub(crate) fn u32(&mut self) -> Result<u32, FormatError> {
        let bytes = self.take(4)?;
        Ok(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte)))
    }

    pub(crate) fn u64(&mut self) -> Result<u64, FormatError> {
        let bytes = self.take(8)?;
        Ok(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }

    pub(crate) fn f32(&mut self) -> Result<f32, FormatError> {
        self.u32().map(f32::from_bits)
    }

    pub(crate) fn f64(&mut self) -> Result<f64, FormatError> {
        self.u64().map(f64::from_bits)
    }

    pub(crate) fn flag(&mut self) -> Result<bool, FormatError> {
        self.one_of(&[false, true])
    }

    /// One of a list, by its index in a byte.
    pub(crate) fn one_of<T: Copy>(&mut self, all: &[T]) -> Result<T, FormatError> {
        let index = self.u8()?;
        all.get(usize::from(index)).copied().ok_or_else(|| {
            self.error(format!("a number below {} was expected, and it is {index}", all.len()))
        })
    }

    /// A number below a bound.
    pub(crate) fn below(&mut self, bound: usize) -> Result<usize, FormatError> {
        let number = self.u32()? as usize;
        if number < bound {
            Ok(number)
        } else {
            Err(self.error(format!("a number below {bound} was expected, and it is {number}")))
        }
    }

    /// A number of things that take at least so many bytes each.
    pub(crate) fn count(&mut self, bytes: usize) -> Result<usize, FormatError> {
        let count = self.u64()?;
        let left = (self.bytes.len() - self.at) / bytes.max(1);
        usize::try_from(count).ok().filter(|&count| count <= left).ok_or_else(|| {
            self.error(format!("{count} things are said to follow, and there are bytes for {left}"))
        })
    }

    pub(crate) fn text(&mut self) -> Result<&'a str, FormatError> {
        let count = self.count(1)?;
        let bytes = self.take(count)?;
        std::str::from_utf8(bytes).map_err(|_| self.error("the text is no UTF-8"))
    }

    /// A number of things that take at least so many bytes each, and room for them.
    pub(crate) fn list<T>(&mut self, bytes: usize) -> Result<(usize, Vec<T>), FormatError> {
        let count = self.count(bytes)?;
        Ok((count, room(count).map_err(|error| self.no_memory(error))?))
    }

    fn words<T>(&mut self, of: impl Fn(u32) -> T) -> Result<Vec<T>, FormatError> {
        let (count, mut words) = self.list(4)?;
        let bytes = self.take(4 * count)?;
        words.extend(bytes.as_chunks().0.iter().map(|&word| of(u32::from_le_bytes(word))));
        Ok(words)
    }

    pub(crate) fn u32s(&mut self) -> Result<Vec<u32>, FormatError> {
        self.words(|word| word)
    }

    pub(crate) fn f32s(&mut self) -> Result<Vec<f32>, FormatError> {
        self.words(f32::from_bits)
    }
}

/// A number that tells bytes apart: FNV-1a (Fowler, Noll, Vo 1991), of 64 bits. It guards against mistakes,
/// not against malice.
pub(crate) fn fingerprint(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back() {
        let mut writer = ByteWriter::new(b"jbt test", 3);
        writer.text("käse");
        writer.u32s(&[1, u32::MAX]);
        writer.f32s(&[-0.0, f32::NAN]);
        writer.f64(0.1);
        let bytes = writer.into_bytes();
        let mut reader = ByteReader::new(&bytes, b"jbt test", 3).unwrap();
        assert_eq!(reader.text(), Ok("käse"));
        assert_eq!(reader.u32s(), Ok(vec![1, u32::MAX]));
        assert_eq!(
            reader.f32s().unwrap().iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
            [1 << 31, 0x7fc0_0000]
        );
        assert_eq!(reader.f64(), Ok(0.1));
        reader.end().unwrap();
    }

    #[test]
    fn what_is_broken_says_where() {
        let mut writer = ByteWriter::new(b"jbt test", 3);
        writer.count(usize::MAX);
        let bytes = writer.into_bytes();
        let mut reader = ByteReader::new(&bytes, b"jbt test", 3).unwrap();
        assert_eq!(reader.u32s().unwrap_err().at, 20);
        assert!(ByteReader::new(&bytes, b"jbt test", 4).err().unwrap().problem.contains("version 3"));
        assert!(ByteReader::new(b"PK", b"jbt test", 4).is_err());
        let mut short = ByteReader::new(&bytes[..14], b"jbt test", 3).unwrap();
        assert_eq!(
            short.u32().unwrap_err(),
            FormatError { at: 12, problem: "the bytes end too soon".into(), kind: ErrorKind::Argument }
        );
    }

    #[test]
    fn what_needs_more_memory_than_there_is_is_a_limit() {
        let bytes = ByteWriter::new(b"jbt test", 3).into_bytes();
        let reader = ByteReader::new(&bytes, b"jbt test", 3).unwrap();
        assert_eq!(reader.afford(2), Ok(()));
        assert_eq!(reader.afford(usize::MAX).unwrap_err().kind(), ErrorKind::Limit);
        assert_eq!(reader.error("").kind(), ErrorKind::Argument);
    }

    /// The published test vectors.
    #[test]
    fn fingerprints_are_fnv() {
        assert_eq!(fingerprint(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fingerprint(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
