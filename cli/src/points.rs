//! Points from CSV text, a batch at a time, with the place of whatever is wrong with them.
//!
//! The first line names the columns; `x`, `y` and `z` are taken wherever they stand. Fields may be quoted,
//! but a quoted field does not go over the end of its line. Blank lines mean nothing. A coordinate is a
//! number that is finite in f32: `nan`, `inf` and what overflows there are errors. It is read as an f64, so
//! that points far away keep their digits up to the origin of the model.

use std::io::{self, BufRead};

use jbt::diagnostic::{Diagnostic, Source, Span, escape};

/// The longest line that is read, in bytes: a file without line ends is not kept in memory.
const MAX_LINE: usize = 1 << 20;

/// Why there are no more points.
#[derive(Debug)]
pub enum PointTableError {
    /// The file could not be read.
    Io {
        /// Its name.
        name: String,
        /// What the system said.
        error: io::Error,
    },
    /// A line is longer than a line may be: a message.
    Limit(String),
    /// The text is wrong.
    Text {
        /// The name of the file.
        name: String,
        /// Place, message, the line, a caret.
        rendered: String,
    },
}

/// A reader of points.
pub struct PointReader<R> {
    reader: R,
    name: String,
    buffer: Vec<u8>,
    line: u64,
    bytes: u64,
    columns: [usize; 3],
    /// The last line ended with a carriage return: a line feed belongs to it.
    after_return: bool,
}

/// A field of a line: its text without quotes, and the bytes from which to which it goes with them.
struct Word {
    text: Vec<u8>,
    start: usize,
    end: usize,
}

impl<R: BufRead> PointReader<R> {
    /// Reads the header.
    pub fn new(reader: R, name: String) -> Result<Self, PointTableError> {
        let mut points = Self {
            reader,
            name,
            buffer: Vec::new(),
            line: 0,
            bytes: 0,
            columns: [0; 3],
            after_return: false,
        };
        if !points.next_line()? {
            return Err(points.error(0, 0, "there is no header; expected one with the columns x, y and z"));
        }
        if points.buffer.starts_with(b"\xef\xbb\xbf") {
            points.buffer.drain(..3);
        }
        let header = points.words()?;
        for (column, name) in points.columns.iter_mut().zip(["x", "y", "z"]) {
            let mut found =
                header.iter().enumerate().filter(|(_, word)| word.text.trim_ascii() == name.as_bytes());
            match (found.next(), found.next()) {
                (Some((index, _)), None) => *column = index,
                (Some(_), Some((_, again))) => {
                    let Word { start, end, .. } = *again;
                    return Err(points.error(start, end, &format!("there is another column `{name}`")));
                }
                (None, _) => {
                    return Err(points.error(
                        0,
                        points.buffer.len(),
                        &format!("there is no column `{name}`; the first line names the columns, x, y and z among them"),
                    ));
                }
            }
        }
        Ok(points)
    }

    /// Bytes read so far.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The next points, at most `limit`; none at the end.
    pub fn batch(&mut self, limit: usize) -> Result<Vec<[f64; 3]>, PointTableError> {
        let mut points = Vec::new();
        while points.len() < limit && self.next_line()? {
            points.push(self.point()?);
        }
        Ok(points)
    }

    /// The point of the line in the buffer.
    fn point(&self) -> Result<[f64; 3], PointTableError> {
        let words = self.words()?;
        let mut point = [0.0; 3];
        for (axis, (number, &column)) in point.iter_mut().zip(&self.columns).enumerate() {
            let axis = ["x", "y", "z"][axis];
            let Some(word) = words.get(column) else {
                let message = format!("the line ends before its column `{axis}`");
                return Err(self.error(self.buffer.len(), self.buffer.len(), &message));
            };
            let text = String::from_utf8_lossy(word.text.trim_ascii());
            *number = coordinate(&text).map_err(|wrong| {
                let shown: String = text.chars().take(40).collect();
                self.error(word.start, word.end, &format!("`{shown}` is {wrong}, for {axis}"))
            })?;
        }
        Ok(point)
    }

    /// Brings the next line that is not blank into the buffer, without its end; false at the end of the text.
    fn next_line(&mut self) -> Result<bool, PointTableError> {
        loop {
            self.buffer.clear();
            let read =
                self.read_line().map_err(|error| PointTableError::Io { name: self.name.clone(), error })?;
            if read == 0 {
                return Ok(false);
            }
            self.line += 1;
            self.bytes += read as u64;
            if self.buffer.len() > MAX_LINE {
                let place = format!("{}:{}", escape(&self.name), self.line);
                return Err(PointTableError::Limit(format!(
                    "{place}: a line is longer than {MAX_LINE} bytes"
                )));
            }
            if !self.buffer.trim_ascii().is_empty() {
                return Ok(true);
            }
        }
    }

    /// Brings what is left of the line into the buffer, without its end: a line feed, a carriage return, or
    /// both. Of a line that is too long it is one byte more than a line may have. Returns how many bytes have
    /// been read.
    fn read_line(&mut self) -> io::Result<usize> {
        let mut read = 0;
        loop {
            let bytes = match self.reader.fill_buf() {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                bytes => bytes?,
            };
            if std::mem::take(&mut self.after_return) && bytes.first() == Some(&b'\n') {
                self.reader.consume(1);
                read += 1;
                continue;
            }
            let part = &bytes[..bytes.len().min(MAX_LINE + 1 - self.buffer.len())];
            let end = part.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            self.buffer.extend_from_slice(&part[..end.unwrap_or(part.len())]);
            self.after_return = end.is_some_and(|end| part[end] == b'\r');
            let taken = end.map_or(part.len(), |end| end + 1);
            self.reader.consume(taken);
            read += taken;
            if end.is_some() || taken == 0 {
                return Ok(read);
            }
        }
    }

    /// The fields of the line in the buffer.
    fn words(&self) -> Result<Vec<Word>, PointTableError> {
        let line = &self.buffer;
        let mut words = Vec::new();
        let mut at = 0;
        loop {
            let start = at;
            let mut text = Vec::new();
            if line.get(at) == Some(&b'"') {
                at += 1;
                loop {
                    match (line.get(at), line.get(at + 1)) {
                        (Some(b'"'), Some(b'"')) => {
                            text.push(b'"');
                            at += 2;
                        }
                        (Some(b'"'), _) => break,
                        (Some(&byte), _) => {
                            text.push(byte);
                            at += 1;
                        }
                        (None, _) => {
                            return Err(self.error(start, at, "the quote is not closed on this line"));
                        }
                    }
                }
                at += 1;
            }
            let end = line[at.min(line.len())..]
                .iter()
                .position(|&byte| byte == b',')
                .map_or(line.len(), |n| at + n);
            text.extend_from_slice(&line[at.min(end)..end]);
            words.push(Word { text, start, end });
            if end == line.len() {
                return Ok(words);
            }
            at = end + 1;
        }
    }

    /// A located error in the line of the buffer, between these bytes of it.
    fn error(&self, start: usize, end: usize, message: &str) -> PointTableError {
        let span = Span::new(start, end);
        let source = Source { name: &self.name, text: &self.buffer };
        let rendered = source.render_from(self.line.max(1), &Diagnostic::error(Some(span), message));
        PointTableError::Text { name: self.name.clone(), rendered }
    }
}

/// The coordinate that a text names, or what is wrong with it.
fn coordinate(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (number as f32).is_finite() {
        Ok(number)
    } else if number.is_nan() {
        Err("not a number".to_owned())
    } else if text.contains(|c: char| c.is_ascii_digit()) {
        Err(format!("too large: a coordinate is at most {:e}", f32::MAX))
    } else {
        Err("not finite".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<[f64; 3]>, String> {
        let all = || {
            let mut reader = PointReader::new(text.as_bytes(), "p.csv".to_owned())?;
            let mut all = Vec::new();
            loop {
                let batch = reader.batch(2)?;
                if batch.is_empty() {
                    return Ok(all);
                }
                all.extend(batch);
            }
        };
        all().map_err(|error: PointTableError| match error {
            PointTableError::Text { rendered, .. } => rendered,
            PointTableError::Io { .. } | PointTableError::Limit(_) => panic!("{error:?}"),
        })
    }

    #[test]
    fn columns_are_found_by_name_and_order_is_kept() {
        let text = "\u{feff}z,\"a,b\", y ,x\r\n3,\"q\"\"\",2,1\r\n\n-0,,1e-45,+.5\n1e-400,2,3,3.4028235e38";
        let points = read(text).unwrap();
        assert_eq!(points, [[1.0, 2.0, 3.0], [0.5, 1e-45, 0.0], [3.4028235e38, 3.0, 0.0]]);
        assert!(points[1][2].is_sign_negative());
        assert_eq!(read("x,y,z\n"), Ok(vec![]));
    }

    #[test]
    fn errors_have_a_place() {
        let error = |text: &str| read(text).unwrap_err();
        assert!(error("").starts_with("p.csv:1:1: error: there is no header"));
        let shown = |place: &str, wrong: &str, line: &str, caret: &str| {
            let number = place.split(':').next().unwrap();
            format!("p.csv:{place}: error: {wrong}\n  {number} | {line}\n    | {caret}")
        };
        for (text, expected) in [
            (
                "x,z\n",
                shown(
                    "1:1",
                    "there is no column `y`; the first line names the columns, x, y and z among them",
                    "x,z",
                    "^^^",
                ),
            ),
            ("x,y,z,y\n", shown("1:7", "there is another column `y`", "x,y,z,y", "      ^")),
            (
                "x,y,z\n\n1,2,\u{1b}[2J",
                shown("3:5", "`\\u{1b}[2J` is not a number, for z", "1,2,\\u{1b}[2J", "    ^^^^^^^^^"),
            ),
            ("é,x,y,z\né,1,é,3", shown("2:5", "`é` is not a number, for y", "é,1,é,3", "    ^")),
            ("x,y,z\n1,2", shown("2:4", "the line ends before its column `z`", "1,2", "   ^")),
            ("x,y,z\n1,\"2,3", shown("2:3", "the quote is not closed on this line", "1,\"2,3", "  ^^^^")),
        ] {
            assert_eq!(error(text), expected);
        }
    }

    #[test]
    fn coordinates_are_finite() {
        for (word, wrong) in [
            ("nan", "`nan` is not a number, for y"),
            ("-NaN", "`-NaN` is not a number, for y"),
            ("1e400", "`1e400` is too large: a coordinate is at most 3.4028235e38, for y"),
            ("-3.5e38", "`-3.5e38` is too large: a coordinate is at most 3.4028235e38, for y"),
            ("inf", "`inf` is not finite, for y"),
            ("-infinity", "`-infinity` is not finite, for y"),
        ] {
            let error = read(&format!("x,y,z\n0,0,0\n1,{word},3\n")).unwrap_err();
            let caret = "^".repeat(word.len());
            assert_eq!(error, format!("p.csv:3:3: error: {wrong}\n  3 | 1,{word},3\n    |   {caret}"));
        }
    }

    #[test]
    fn a_line_without_end_is_not_kept() {
        let reader = io::BufReader::new(io::repeat(b','));
        assert!(matches!(PointReader::new(reader, "p".to_owned()), Err(PointTableError::Limit(_))));
    }
}
