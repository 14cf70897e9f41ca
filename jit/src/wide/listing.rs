//! Wide code as text, with the decoder iced-x86.

use std::fmt::Write as _;

use iced_x86::{Decoder, DecoderOptions, Formatter as _, IntelFormatter};

use crate::blob::{CodeBlob, Emitted};

/// Bytes of constants in a line.
const LINE: usize = 16;

/// The functions, each with a line about its blocks of points.
pub(crate) fn listing(Emitted { blocks, rest }: &Emitted) -> String {
    let functions = std::iter::once(blocks).chain(rest);
    functions.map(|blob| format!("{} points at once:\n{}", blob.lanes, function(blob))).collect()
}

/// Instructions with their addresses, then the constants.
fn function(blob: &CodeBlob) -> String {
    let mut formatter = IntelFormatter::new();
    formatter.options_mut().set_rip_relative_addresses(true);
    let (code, rest) = blob.bytes.split_at(blob.code_bytes);
    let (mut text, mut line) = (String::new(), String::new());
    for inst in Decoder::with_ip(64, code, 0, DecoderOptions::NONE) {
        line.clear();
        formatter.format(&inst, &mut line);
        writeln!(text, "{:6x}  {line}", inst.ip()).expect("a string takes anything");
    }
    let first = blob.bytes.len() - blob.constants;
    for (index, bytes) in rest[first - blob.code_bytes..].chunks(LINE).enumerate() {
        let words =
            bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
        let words: Vec<String> = words.map(|word| format!("{:e}", f32::from_bits(word))).collect();
        writeln!(text, "{:6x}  {}", first + index * LINE, words.join(", ")).expect("a string takes anything");
    }
    text
}
