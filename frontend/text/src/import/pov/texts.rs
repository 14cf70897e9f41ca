//! Files that a scene includes: all that it names are read first, and stand behind its own text in one
//! range of bytes. A directive goes there, and the end of the file goes back.
//!
//! ```text
//! scene.pov ... | 0 | shapes.inc ... | 0 | more.inc ...
//! ```
//!
//! What is not found is left out, as the files that come with POV-Ray are, and so is what does not begin like
//! a scene: no message quotes it.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use jbt_ir::limits::MAX_SCENE_BYTES;
use jbt_model::diagnostic::{IncludedText, SourceText};

use super::scan::{PovScanner, PovToken};
use crate::files::Files;

/// The texts of a scene, one after the other.
pub(super) struct PovTexts {
    pub(super) bytes: Vec<u8>,
    /// Where the scene's own text ends.
    end: usize,
    /// The place of each file, by the file that names it (nothing for the scene) and its name there.
    places: HashMap<(Option<String>, String), usize>,
    files: Vec<PovFile>,
}

/// A file that is included.
struct PovFile {
    path: String,
    range: Range<usize>,
}

/// A file that is being run: where to go on, and how much was open where it began.
pub(super) struct PovReturn {
    pub(super) place: usize,
    pub(super) open: [usize; 2],
}

impl PovTexts {
    /// A scene with the files that it names, directly or not, as far as they can be had.
    pub(super) fn new(scene: &[u8], files: &Files) -> Self {
        let mut texts =
            Self { bytes: scene.to_vec(), end: scene.len(), places: HashMap::new(), files: Vec::new() };
        let mut reader = files.reader();
        // Which of the files are known, by their identity; nothing for one that is no scene.
        let mut known: HashMap<String, Option<usize>> = HashMap::new();
        let mut next = 0;
        while next <= texts.files.len() {
            let (range, from) = match next.checked_sub(1).map(|file| &texts.files[file]) {
                Some(file) => (file.range.clone(), Some(file.path.clone())),
                None => (0..texts.end, None),
            };
            for name in names(&texts.bytes, range) {
                let left = MAX_SCENE_BYTES.saturating_sub(texts.bytes.len() + 1);
                let Ok(file) = reader.read_at_most(&name, from.as_deref(), left) else { continue };
                let place = *known.entry(file.identity.clone()).or_insert_with(|| {
                    begins_like_scene(&file.bytes).then(|| {
                        texts.bytes.push(0);
                        let start = texts.bytes.len();
                        texts.bytes.extend_from_slice(&file.bytes);
                        let range = start..texts.bytes.len();
                        texts.files.push(PovFile { path: file.path.clone(), range });
                        texts.files.len() - 1
                    })
                });
                if let Some(place) = place {
                    texts.places.insert((from.clone(), name), place);
                }
            }
            next += 1;
        }
        texts
    }

    /// Where the scene's own text ends.
    pub(super) fn own(&self) -> usize {
        self.end
    }

    /// The text for messages.
    pub(super) fn source(&self) -> SourceText {
        let text = |file: &PovFile| IncludedText {
            name: file.path.as_str().into(),
            text: Arc::from(&self.bytes[file.range.clone()]),
            start: file.range.start,
        };
        let files = self.files.iter().map(text).collect();
        SourceText::new(SourceText::UNNAMED, &self.bytes[..self.end]).including(files)
    }

    /// The file that holds a place; nothing for the scene.
    fn file_at(&self, place: usize) -> Option<&PovFile> {
        self.files.iter().find(|file| file.range.contains(&place) || file.range.end == place)
    }

    /// The range of a file that the directive at a place names.
    pub(super) fn named(&self, place: usize, name: &str) -> Option<Range<usize>> {
        let from = self.file_at(place).map(|file| file.path.clone());
        let file = self.places.get(&(from, name.to_owned()))?;
        Some(self.files[*file].range.clone())
    }

    /// Where the text ends that holds a place.
    pub(super) fn end_of(&self, place: usize) -> usize {
        self.file_at(place).map_or(self.end, |file| file.range.end)
    }
}

/// Whether a text begins with a directive, or with a word and a block.
fn begins_like_scene(bytes: &[u8]) -> bool {
    let mut scanner = PovScanner::of(bytes, 0..bytes.len());
    let Ok((first, _)) = scanner.next() else { return false };
    let second = scanner.next().map(|(token, _)| token);
    match first {
        PovToken::Mark(b'#') => second == Ok(PovToken::Word),
        PovToken::Word => second == Ok(PovToken::Mark(b'{')),
        _ => false,
    }
}

/// The names behind `#include` in a text, as far as it can be read.
fn names(bytes: &[u8], range: Range<usize>) -> Vec<String> {
    const WORD: &[u8] = b"include";
    if !bytes[range.clone()].windows(WORD.len()).any(|window| window == WORD) {
        return Vec::new();
    }
    let mut scanner = PovScanner::of(bytes, range);
    let mut names = Vec::new();
    let mut before = [false; 2];
    while let Ok((token, span)) = scanner.next() {
        match token {
            PovToken::End => break,
            PovToken::Text if before[1] => names.push(scanner.word(span).to_owned()),
            _ => {}
        }
        let is_include = before[0] && token == PovToken::Word && scanner.word(span) == "include";
        before = [token == PovToken::Mark(b'#'), is_include];
    }
    names
}
