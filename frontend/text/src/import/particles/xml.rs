//! As much of XML as files of VTK need: tags with attributes, and where the text between them stands.

/// A tag.
pub(super) struct Tag<'a> {
    /// Without the slash of one that closes.
    pub(super) name: &'a [u8],
    pub(super) closes: bool,
    /// Whether it has no content: `<a/>`.
    pub(super) is_empty: bool,
    attributes: &'a [u8],
    /// Where it begins, and the byte behind it.
    pub(super) start: usize,
    pub(super) end: usize,
}

impl Tag<'_> {
    /// The value of an attribute, as it is written.
    pub(super) fn attribute(&self, name: &str) -> Option<String> {
        let text = String::from_utf8_lossy(self.attributes);
        let mut rest: &str = &text;
        loop {
            let (key, behind) = rest.split_once('=')?;
            let behind = behind.trim_start();
            let quote = behind.chars().next().filter(|c| matches!(c, '"' | '\''))?;
            let (value, next) = behind[1..].split_once(quote)?;
            if key.trim() == name {
                return Some(value.to_owned());
            }
            rest = next;
        }
    }
}

/// The tags of a text from a byte on; comments and declarations are skipped.
pub(super) struct Tags<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
}

impl<'a> Iterator for Tags<'a> {
    type Item = Tag<'a>;

    fn next(&mut self) -> Option<Tag<'a>> {
        let find = |from: usize, what: &[u8]| {
            let rest = self.bytes.get(from..)?;
            rest.windows(what.len()).position(|window| window == what).map(|at| from + at)
        };
        loop {
            let start = find(self.at, b"<")?;
            if self.bytes[start..].starts_with(b"<!--") {
                self.at = find(start, b"-->")? + 3;
                continue;
            }
            let end = find(start, b">")? + 1;
            self.at = end;
            let inner = &self.bytes[start + 1..end - 1];
            if inner.starts_with(b"?") || inner.starts_with(b"!") {
                continue;
            }
            let (closes, inner) = inner.strip_prefix(b"/").map_or((false, inner), |rest| (true, rest));
            let (is_empty, inner) = inner.strip_suffix(b"/").map_or((false, inner), |rest| (true, rest));
            let length = inner.iter().position(u8::is_ascii_whitespace).unwrap_or(inner.len());
            let (name, attributes) = inner.split_at(length);
            return Some(Tag { name, closes, is_empty, attributes, start, end });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_have_attributes_and_places() {
        let text = b"<?xml?><!-- <x> --><a b='1' c = \"2\">text</a><d/>";
        let tags: Vec<Tag<'_>> = Tags { bytes: text, at: 0 }.collect();
        let shown: Vec<(&[u8], bool, bool)> =
            tags.iter().map(|tag| (tag.name, tag.closes, tag.is_empty)).collect();
        assert_eq!(shown, [(&b"a"[..], false, false), (b"a", true, false), (b"d", false, true)]);
        assert_eq!((tags[0].attribute("c").as_deref(), tags[0].attribute("d")), (Some("2"), None));
        assert_eq!(&text[tags[0].end..tags[1].start], b"text");
    }
}
