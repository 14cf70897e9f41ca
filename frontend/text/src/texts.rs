//! The texts that a scene is read from: its own, and those of the files that it includes. Together they are
//! one range of bytes, in which each has its own places.

use std::cell::OnceCell;
use std::sync::Arc;

use super::files::NamedFile;
use jbt_ir::limits::MAX_NAMED_FILES;
use jbt_model::diagnostic::IncludedText;

/// A file that has been included.
pub(super) struct TextFile {
    pub(super) file: Arc<NamedFile>,
    pub(super) text: String,
    /// The place of its first byte.
    pub(super) base: usize,
}

/// Texts that are added while others are read. None is taken away, so words of all of them live as long.
pub(super) struct Texts {
    files: OnceCell<Vec<OnceCell<TextFile>>>,
    /// The place behind the scene's own text.
    end: usize,
}

impl Texts {
    /// Those of a scene whose own text has so many bytes.
    pub(super) fn new(length: usize) -> Self {
        Self { files: OnceCell::new(), end: length + 1 }
    }

    /// One more; nothing if there are as many as there may be.
    pub(super) fn add(&self, file: Arc<NamedFile>, text: String) -> Option<&TextFile> {
        let slots = self.files.get_or_init(|| (0..MAX_NAMED_FILES).map(|_| OnceCell::new()).collect());
        let place = slots.iter().position(|slot| slot.get().is_none())?;
        let before = place.checked_sub(1).and_then(|before| slots[before].get());
        let base = before.map_or(self.end, |before| before.base + before.text.len() + 1);
        Some(slots[place].get_or_init(|| TextFile { file, text, base }))
    }

    fn all(&self) -> impl Iterator<Item = &TextFile> {
        self.files.get().into_iter().flatten().map_while(OnceCell::get)
    }

    /// The text of a place behind the scene's own, and the place of its first byte.
    pub(super) fn text_at(&self, byte: usize) -> Option<&TextFile> {
        self.all().take_while(|file| file.base <= byte).last()
    }

    /// All that have been included, for messages.
    pub(super) fn included(&self) -> Vec<IncludedText> {
        let text = |file: &TextFile| IncludedText {
            name: file.file.path.as_str().into(),
            text: file.text.as_bytes().into(),
            start: file.base,
        };
        self.all().map(text).collect()
    }
}
