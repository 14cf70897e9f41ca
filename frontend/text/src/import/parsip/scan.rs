//! Bytes to sections: nodes and the places of their values.
//!
//! No text is copied. An entry is the range of bytes after its `=`; NUL and CR are dropped when the entry is
//! read, so that every place is a place in the file.

use std::borrow::Cow;
use std::collections::HashMap;

use jbt_ir::limits::MAX_NODES;

use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::{Report, clip};

macro_rules! keys {
    ($($key:ident = $name:literal),+ $(,)?) => {
        /// A key with a meaning here; other keys are ignored.
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        pub(super) enum Key { $($key,)+ }

        impl Key {
            const ALL: &'static [Self] = &[$(Self::$key,)+];

            /// As it is written.
            pub(super) const fn name(self) -> &'static str { match self { $(Self::$key => $name,)+ } }
        }
    };
}

keys! {
    RootIds = "RootIDs",
    NumLayers = "NumLayers",
    CountPrimitives = "CountPrimitives",
    CountOperators = "CountOperators",
    IsOperator = "IsOperator",
    Scale = "AffineScale",
    Rotate = "AffineRotate",
    Translate = "AffineTranslate",
    OperatorType = "OperatorType",
    ChildrenCount = "ChildrenCount",
    ChildrenIds = "ChildrenIDs",
    UseRange = "ChildrenIDsUseRange",
    Range = "ChildrenIDsRange",
    PrimitiveType = "PrimitiveType",
    SkeletonType = "SkeletonType",
    Diffused = "MtrlDiffused",
    Position = "position",
    Start = "start",
    End = "end",
    Direction = "direction",
    Radius = "radius",
    Height = "height",
    Side = "side",
    Corner0 = "corner0",
    Corner1 = "corner1",
    Corner2 = "corner2",
    Original = "OriginalNodeIndex",
    Power = "power",
    Factor = "factor",
    Axis = "axis",
    BaseAxis = "base axis",
    TaperAxis = "taper axis",
    ShearAxis = "shear axis",
    Rate = "rate",
    Center = "center",
    LeftBound = "left bound",
    RightBound = "right bound",
    FieldScale = "scale",
}

/// The place of a value.
#[derive(Clone, Copy, Debug)]
struct KeyEntry {
    key: Key,
    span: Span,
}

/// A section.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// The number of the node; of the global section, 0.
    pub(super) id: i64,
    /// Its heading.
    pub(super) span: Span,
    entries: Vec<KeyEntry>,
}

impl Section {
    /// The place of the value of a key.
    pub(super) fn get(&self, key: Key) -> Option<Span> {
        self.entries.iter().find(|entry| entry.key == key).map(|entry| entry.span)
    }
}

/// The sections of a file.
pub(super) struct Sections {
    pub(super) global: Option<Section>,
    pub(super) nodes: Vec<Section>,
    /// The index in `nodes` of each number.
    pub(super) by_id: HashMap<i64, u32>,
}

/// The section that lines belong to.
enum Current {
    Nowhere,
    Global,
    Node,
}

/// The text of a range of the file: without NUL and CR, and without blanks around it.
pub(super) fn text(bytes: &[u8], span: Span) -> Cow<'_, str> {
    let range = &bytes[span.start as usize..span.end as usize];
    if !range.iter().any(|b| matches!(b, 0 | b'\r')) {
        return trimmed(String::from_utf8_lossy(range));
    }
    let kept: Vec<u8> = range.iter().copied().filter(|b| !matches!(b, 0 | b'\r')).collect();
    trimmed(Cow::Owned(String::from_utf8_lossy(&kept).into_owned()))
}

fn trimmed(text: Cow<'_, str>) -> Cow<'_, str> {
    match text {
        Cow::Borrowed(text) => Cow::Borrowed(text.trim()),
        Cow::Owned(text) => Cow::Owned(text.trim().to_owned()),
    }
}

/// A range without the blanks, NULs and CRs at its ends.
fn shrunk(bytes: &[u8], mut start: usize, mut end: usize) -> Span {
    let empty = |b: u8| b == 0 || b.is_ascii_whitespace();
    while start < end && empty(bytes[start]) {
        start += 1;
    }
    while start < end && empty(bytes[end - 1]) {
        end -= 1;
    }
    Span::new(start, end)
}

/// The sections of a file, with messages about lines that belong to none.
pub(super) fn sections(bytes: &[u8], errors: &mut Report, warnings: &mut Report) -> Sections {
    let mut all = Sections { global: None, nodes: Vec::new(), by_id: HashMap::new() };
    let mut current = Current::Nowhere;
    let mut start = 0;
    while start < bytes.len() {
        let end = bytes[start..].iter().position(|&b| b == b'\n').map_or(bytes.len(), |n| start + n);
        let line = shrunk(bytes, start, end);
        start = end + 1;
        match bytes[line.start as usize..line.end as usize].first() {
            None | Some(b'#') => {}
            Some(b'[') => {
                current = heading(bytes, line, &mut all, errors, warnings);
                if all.nodes.len() > MAX_NODES {
                    errors.add_last(Diagnostic::limit(Some(line), format!("more than {MAX_NODES} nodes")));
                    return all;
                }
            }
            Some(_) => {
                let section = match current {
                    Current::Nowhere => None,
                    Current::Global => all.global.as_mut(),
                    Current::Node => all.nodes.last_mut(),
                };
                entry(bytes, line, section, warnings);
            }
        }
    }
    all
}

/// The section that a line `[..]` opens. A repeated section is ignored: the first one counts.
fn heading(
    bytes: &[u8],
    line: Span,
    all: &mut Sections,
    errors: &mut Report,
    warnings: &mut Report,
) -> Current {
    let shown = text(bytes, line);
    let name = shown.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).map(str::trim);
    let Some(name) = name else {
        errors.add(|| Diagnostic::error(Some(line), "a heading without its `]`"));
        return Current::Nowhere;
    };
    let section = |id| Section { id, span: line, entries: Vec::new() };
    if name.eq_ignore_ascii_case("Global") {
        if all.global.is_some() {
            warnings.add(|| Diagnostic::warning(Some(line), "a second [Global]; the first one counts"));
            return Current::Nowhere;
        }
        all.global = Some(section(0));
        return Current::Global;
    }
    const NODE: &str = "BLOBNODE";
    let is_node = name.get(..NODE.len()).is_some_and(|word| word.eq_ignore_ascii_case(NODE));
    if !is_node {
        warnings.add(|| Diagnostic::warning(Some(line), format!("the section {} is unknown", clip(&shown))));
        return Current::Nowhere;
    }
    let Ok(id) = name[NODE.len()..].trim().parse::<i64>() else {
        errors.add(|| {
            Diagnostic::error(Some(line), "a node without a number").expected("expected [BLOBNODE n]")
        });
        return Current::Nowhere;
    };
    if all.by_id.contains_key(&id) {
        warnings.add(|| Diagnostic::warning(Some(line), format!("a second node {id}; the first one counts")));
        return Current::Nowhere;
    }
    all.by_id.insert(id, all.nodes.len() as u32);
    all.nodes.push(section(id));
    Current::Node
}

/// Adds a line `key=value` to its section.
fn entry(bytes: &[u8], line: Span, section: Option<&mut Section>, warnings: &mut Report) {
    let (start, end) = (line.start as usize, line.end as usize);
    let Some(equals) = bytes[start..end].iter().position(|&b| b == b'=') else {
        warnings.add(|| Diagnostic::warning(Some(line), "a line that is neither a heading nor key=value"));
        return;
    };
    let Some(section) = section else {
        return;
    };
    let name = text(bytes, Span::new(start, start + equals));
    let Some(key) = Key::ALL.iter().copied().find(|key| key.name().eq_ignore_ascii_case(&name)) else {
        return;
    };
    if section.get(key).is_some() {
        warnings.add(|| {
            Diagnostic::warning(Some(line), format!("a second `{}`; the first one counts", key.name()))
        });
        return;
    }
    section.entries.push(KeyEntry { key, span: shrunk(bytes, start + equals + 1, end) });
}
