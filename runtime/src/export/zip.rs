//! Archives (ZIP, APPNOTE 6.3), written from front to back: entries are compressed as they come, and their
//! sizes follow them.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::DeflateEncoder;

use super::parts::WriteError;

/// Version 2.0: compressed entries.
const VERSION: u16 = 20;
/// Sizes and checksum follow the bytes of an entry; names are UTF-8.
const FLAGS: u16 = 0x0808;
/// Deflate.
const METHOD: u16 = 8;
/// 1980-01-01: two runs give the same bytes.
const DATE: u16 = 0x0021;

/// An archive under construction.
pub(super) struct Archive<'a, W: Write> {
    out: Counted<'a, W>,
    entries: Vec<ArchiveEntry>,
}

struct ArchiveEntry {
    name: &'static str,
    place: u64,
    checksum: u32,
    packed: u64,
    size: u64,
}

impl<'a, W: Write> Archive<'a, W> {
    pub(super) fn new(out: &'a mut W) -> Self {
        Self { out: Counted { out, count: 0 }, entries: Vec::new() }
    }

    /// Adds an entry, whose bytes `fill` writes.
    pub(super) fn add(
        &mut self,
        name: &'static str,
        fill: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let place = self.out.count;
        let mut head = b"PK\x03\x04".to_vec();
        push(&mut head, &[VERSION, FLAGS, METHOD, 0, DATE]);
        head.extend_from_slice(&[0; 12]);
        push(&mut head, &[name.len() as u16, 0]);
        head.extend_from_slice(name.as_bytes());
        self.out.write_all(&head)?;
        let start = self.out.count;
        let (checksum, size) = {
            let out = DeflateEncoder::new(&mut self.out, Compression::default());
            let mut summed = Summed { out, checksum: crc32fast::Hasher::new(), size: 0 };
            fill(&mut summed)?;
            let Summed { out, checksum, size } = summed;
            out.finish()?;
            (checksum.finalize(), size)
        };
        let entry = ArchiveEntry { name, place, checksum, packed: self.out.count - start, size };
        let mut tail = b"PK\x07\x08".to_vec();
        entry.push_sizes(&mut tail)?;
        self.out.write_all(&tail)?;
        self.entries.push(entry);
        Ok(())
    }

    /// Writes the list of entries.
    pub(super) fn finish(mut self) -> Result<(), WriteError> {
        let place = self.out.count;
        let mut list = Vec::new();
        for entry in &self.entries {
            list.extend_from_slice(b"PK\x01\x02");
            push(&mut list, &[VERSION, VERSION, FLAGS, METHOD, 0, DATE]);
            entry.push_sizes(&mut list)?;
            push(&mut list, &[entry.name.len() as u16, 0, 0, 0, 0, 0, 0]);
            list.extend_from_slice(&small(entry.place)?.to_le_bytes());
            list.extend_from_slice(entry.name.as_bytes());
        }
        let (count, size) = (self.entries.len() as u16, list.len() as u32);
        list.extend_from_slice(b"PK\x05\x06");
        push(&mut list, &[0, 0, count, count]);
        list.extend_from_slice(&size.to_le_bytes());
        list.extend_from_slice(&small(place)?.to_le_bytes());
        push(&mut list, &[0]);
        self.out.write_all(&list)?;
        Ok(())
    }
}

impl ArchiveEntry {
    fn push_sizes(&self, bytes: &mut Vec<u8>) -> Result<(), WriteError> {
        for word in [self.checksum, small(self.packed)?, small(self.size)?] {
            bytes.extend_from_slice(&word.to_le_bytes());
        }
        Ok(())
    }
}

fn push(bytes: &mut Vec<u8>, words: &[u16]) {
    words.iter().for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
}

/// Sizes and places have 32 bits.
fn small(size: u64) -> Result<u32, WriteError> {
    u32::try_from(size).map_err(|_| WriteError::TooLarge(size))
}

/// Counts what is written.
struct Counted<'a, W> {
    out: &'a mut W,
    count: u64,
}

impl<W: Write> Write for Counted<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.count += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Sums up what is written.
struct Summed<W> {
    out: W,
    checksum: crc32fast::Hasher,
    size: u64,
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.checksum.update(&bytes[..written]);
        self.size += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
