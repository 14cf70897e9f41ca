//! Damaged files: each example is changed at random many times, always in the same ways, and whatever becomes
//! of it is read or refused soon.

use std::time::Duration;

use fastrand::Rng;
use jbt_model::diagnostic::Diagnostics;
use jbt_testkit::scene::{assert_reads_back, count};
use jbt_text::Options;
use jbt_text::import::{self, Imported};

use crate::common::{Read, ends};

fn pov(bytes: &[u8]) -> Result<Imported, Diagnostics> {
    import::pov(bytes, &Options::default())
}

/// What is put into files: numbers that hurt, brackets, words of all formats.
const PIECES: [&str; 44] = [
    "0",
    "-1",
    "1e300",
    "-1e-300",
    "1e15",
    "4294967296",
    "0.1",
    "nan",
    "inf",
    "1e999",
    "{",
    "}",
    "[",
    "]",
    "(",
    ")",
    "<",
    ">",
    ",",
    "\"",
    "#",
    "/*",
    "*/",
    "#end",
    "#while (1)",
    "#declare N = N * 2;",
    "#if (0)",
    "rand(Stream)",
    "blob {",
    "scale 0",
    "rotate",
    "union {",
    "Blobby",
    "1001 0",
    "AttributeEnd",
    "Scale 0 0 0",
    "ObjectInstance 1",
    "\"type\": \"MinNode\"",
    "\"children\": []",
    "\"thickness\": 0",
    "null",
    "\u{0}",
    "\u{fffd}",
    "\\",
];

/// A change of a part of the bytes.
fn mutate(rng: &mut Rng, bytes: &mut Vec<u8>) {
    let at = rng.usize(..=bytes.len());
    let end = (at + rng.usize(1..40)).min(bytes.len());
    match rng.u8(..20) {
        0 => {
            bytes.drain(at..end);
        }
        1 => {
            let copy = bytes[at..end].to_vec();
            let to = rng.usize(..=bytes.len());
            bytes.splice(to..to, copy);
        }
        2 if at < bytes.len() => bytes[at] = rng.u8(..),
        3 if at < bytes.len() => bytes[at] ^= 1 << rng.u8(..8),
        4 => bytes.truncate(at),
        5..=9 if at < bytes.len() => bytes[at] = b"0123456789.-+eE,<>{}()"[rng.usize(..22)],
        10..=12 => {
            let piece = PIECES[rng.usize(..PIECES.len())];
            bytes.splice(at..end, piece.bytes());
        }
        _ => {
            let piece = format!(" {} ", PIECES[rng.usize(..PIECES.len())]);
            bytes.splice(at..at, piece.into_bytes());
        }
    }
}

#[test]
fn damaged_files_are_read_or_refused_soon() {
    let files: [(Read, &[u8]); 3] = [
        (pov, include_bytes!("files/flower.pov")),
        (import::rib, include_bytes!("files/tools.rib")),
        (import::threejs, include_bytes!("files/bird.json")),
    ];
    let times = count("JBT_READER_MUTATIONS", 2000);
    for (seed, (read, file)) in (0u64..).zip(files) {
        let mut rng = Rng::with_seed(seed);
        let mut good = 0;
        for _ in 0..times {
            let mut bytes = file.to_vec();
            for _ in 0..rng.usize(1..4) {
                mutate(&mut rng, &mut bytes);
            }
            let took = ends(read, &bytes);
            assert!(took < Duration::from_secs(2), "{took:?}\n{}", String::from_utf8_lossy(&bytes));
            if let Ok(Imported { model, .. }) = read(&bytes)
                && model.check().is_ok_and(|tree| tree.nodes().len() < 10_000)
            {
                assert_reads_back(&model);
                good += 1;
            }
        }
        assert!(good * 50 > times, "{good} of {times}: a file that is hardly ever read tells little");
    }
}
