//! Who imports whom within a crate, read from its sources: which file takes which name from which other file.
//!
//! ```text
//! files of a crate -> tokens -> `use` items and paths -> Import { from, to, name, line }
//! ```
//!
//! A name is followed through re-exports to the file that defines it. A re-export itself is no import, unless
//! the file also uses the name. Code under `#[cfg(test)]` and files `tests.rs` and `testing.rs` do not count.
//! A line `module::Name` in the list of a macro imports `Name`, and hands it on.

use std::collections::{BTreeMap, BTreeSet};

/// A file of a crate takes a name from another file of that crate.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Import {
    /// The file that imports, below `src`.
    pub from: String,
    /// The file that defines what is imported.
    pub to: String,
    /// The path as it is written.
    pub name: String,
    /// The line of the first file, from 1.
    pub line: usize,
}

/// All imports between files of one crate. `files`: path below `src`, with `/` between folders, and text.
pub fn imports(files: &[(String, String)]) -> Vec<Import> {
    let is_test = |path: &str| path.ends_with("tests.rs") || path.ends_with("testing.rs");
    let files = files.iter().filter(|(path, _)| !is_test(path));
    let read = files.map(|(path, text)| (module_of(path), read(path, text)));
    let modules: BTreeMap<Vec<String>, File> = read.collect();
    let mut all = BTreeSet::new();
    for (module, file) in &modules {
        for path in &file.paths {
            if let Path { exported: Some(name), .. } = path
                && !file.words.contains(name)
            {
                continue;
            }
            if let Some(to) = target(&modules, module, path)
                && to != file.path
            {
                let name = path.segments.join("::");
                all.insert(Import { from: file.path.clone(), to: to.to_owned(), name, line: path.line });
            }
        }
    }
    all.into_iter().collect()
}

/// The module of a file below `src`.
fn module_of(path: &str) -> Vec<String> {
    let stem = path.strip_suffix(".rs").expect("a Rust file");
    let mut module: Vec<String> = stem.split('/').map(str::to_owned).collect();
    if matches!(module.last().map(String::as_str), Some("mod" | "lib" | "main")) {
        module.pop();
    }
    module
}

struct File {
    path: String,
    paths: Vec<Path>,
    /// Words of the code outside of `use` items.
    words: BTreeSet<String>,
}

/// A path of a `use` item or of an expression.
#[derive(Debug)]
struct Path {
    segments: Vec<String>,
    line: usize,
    /// The name that the file gives it, if others can see it there.
    known_as: Option<String>,
    /// The same, if the item is there for others: a public `use`.
    exported: Option<String>,
}

/// The file that defines what a path of a module means; `None` for what is not of this crate.
fn target<'a>(modules: &'a BTreeMap<Vec<String>, File>, module: &[String], path: &Path) -> Option<&'a str> {
    let (mut place, mut rest) = start(modules, module, &path.segments)?;
    // Re-exports of re-exports end somewhere; a wrong reading has to end as well.
    for _ in 0..16 {
        while let Some(next) = rest.first() {
            let child: Vec<String> = place.iter().chain([next]).cloned().collect();
            if !modules.contains_key(&child) {
                break;
            }
            place = child;
            rest.remove(0);
        }
        let file = &modules[&place];
        let Some(name) = rest.first() else { return Some(&file.path) };
        let Some(again) = file.paths.iter().find(|path| path.known_as.as_ref() == Some(name)) else {
            return Some(&file.path);
        };
        let (next, mut front) = start(modules, &place, &again.segments)?;
        front.extend(rest.drain(1..));
        (place, rest) = (next, front);
    }
    Some(&modules[&place].path)
}

/// Where a path begins, and what is left of it.
fn start(
    modules: &BTreeMap<Vec<String>, File>,
    module: &[String],
    segments: &[String],
) -> Option<(Vec<String>, Vec<String>)> {
    let (mut place, mut rest) = (module.to_vec(), segments);
    match rest.first()?.as_str() {
        "crate" => (place, rest) = (Vec::new(), &rest[1..]),
        "self" | "super" => {
            while rest.first().is_some_and(|word| word == "self") {
                rest = &rest[1..];
            }
            while rest.first().is_some_and(|word| word == "super") {
                place.pop()?;
                rest = &rest[1..];
            }
        }
        child => {
            let path: Vec<String> =
                module.iter().map(String::as_str).chain([child]).map(str::to_owned).collect();
            if !modules.contains_key(&path) {
                return None;
            }
        }
    }
    modules.contains_key(&place).then(|| (place, rest.to_vec()))
}

/// A word or a mark, and its line.
type Token = (String, usize);

fn read(path: &str, text: &str) -> File {
    let tokens = without_tests(tokens(text));
    let mut file = File { path: path.to_owned(), paths: Vec::new(), words: BTreeSet::new() };
    let mut at = 0;
    // How deep in braces the code is, and the macro calls and modules around it.
    let (mut depth, mut calls, mut inner): (usize, Vec<usize>, Vec<usize>) = (0, Vec::new(), Vec::new());
    while at < tokens.len() {
        let word = tokens[at].0.as_str();
        match word {
            // `impl Trait + use<>` is no item.
            "use" if tokens.get(at + 1).is_some_and(|next| next.0 != "<") => {
                let public = is_public(&tokens[..at]);
                let before = file.paths.len();
                at = read_use(&tokens, at + 1, &mut Vec::new(), public, &mut file.paths);
                file.paths[before..].iter_mut().for_each(|path| leave(&mut path.segments, inner.len()));
                continue;
            }
            // Who may see an item is no import of theirs.
            "pub" if tokens.get(at + 1).is_some_and(|next| next.0 == "(") => {
                at += tokens[at..].iter().position(|token| token.0 == ")").unwrap_or(0);
            }
            "{" => {
                if at > 1 && tokens[at - 1].0 == "!" && is_word(&tokens[at - 2].0) {
                    calls.push(depth);
                }
                if at > 1 && tokens[at - 2].0 == "mod" {
                    inner.push(depth);
                }
                depth += 1;
            }
            "}" => {
                depth = depth.saturating_sub(1);
                calls.pop_if(|call| *call == depth);
                inner.pop_if(|module| *module == depth);
            }
            _ if is_word(word) && (at == 0 || tokens[at - 1].0 != "::") => {
                let (mut segments, end) = read_path(&tokens, at);
                leave(&mut segments, inner.len());
                file.words.insert(word.to_owned());
                if segments.len() > 1 {
                    file.words.extend(segments[1..].iter().cloned());
                    let known_as = (!calls.is_empty()).then(|| segments[segments.len() - 1].clone());
                    file.paths.push(Path { segments, line: tokens[at].1, known_as, exported: None });
                }
                at = end;
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    file
}

/// A path as it would be written outside of so many modules that stand in its own file.
fn leave(segments: &mut [String], modules: usize) {
    for segment in segments.iter_mut().take(modules).take_while(|segment| *segment == "super") {
        "self".clone_into(segment);
    }
}

/// Whether the tokens before an item end with `pub` or `pub(..)`.
fn is_public(before: &[Token]) -> bool {
    let last = |back: usize| before.len().checked_sub(back).map_or("", |at| before[at].0.as_str());
    last(1) == "pub" || last(1) == ")" && (1..8).any(|back| last(back) == "pub")
}

/// A path that begins at a token, and the token behind it.
fn read_path(tokens: &[Token], mut at: usize) -> (Vec<String>, usize) {
    let mut segments = vec![tokens[at].0.clone()];
    at += 1;
    while at + 1 < tokens.len() && tokens[at].0 == "::" && is_word(&tokens[at + 1].0) {
        segments.push(tokens[at + 1].0.clone());
        at += 2;
    }
    (segments, at)
}

/// One tree of a `use` item, behind the segments before it; the token behind it.
fn read_use(
    tokens: &[Token],
    mut at: usize,
    before: &mut Vec<String>,
    public: bool,
    paths: &mut Vec<Path>,
) -> usize {
    let (depth, line) = (before.len(), tokens[at].1);
    loop {
        match tokens[at].0.as_str() {
            "{" => {
                at += 1;
                while tokens[at].0 != "}" {
                    at = read_use(tokens, at, before, public, paths);
                    at += usize::from(tokens[at].0 == ",");
                }
                before.truncate(depth);
                return at + 1;
            }
            "::" => at += 1,
            "*" => {
                paths.push(Path { segments: before.clone(), line, known_as: None, exported: None });
                before.truncate(depth);
                return at + 1;
            }
            "," | ";" | "}" | "as" => break,
            word => {
                before.push(word.to_owned());
                at += 1;
            }
        }
    }
    let mut name = before.last().cloned();
    if tokens[at].0 == "as" {
        name = Some(tokens[at + 1].0.clone());
        at += 2;
    }
    if before.last().is_some_and(|last| last == "self") {
        before.pop();
        name = before.last().cloned();
    }
    let exported = if public { name.clone() } else { None };
    paths.push(Path { segments: before.clone(), line, known_as: name, exported });
    before.truncate(depth);
    at
}

/// The tokens without items under an attribute `cfg(test)` or `cfg(all(test, ..))`.
fn without_tests(tokens: Vec<Token>) -> Vec<Token> {
    let mut kept = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at].0 != "#" || tokens.get(at + 1).is_none_or(|token| token.0 != "[") {
            kept.push(tokens[at].clone());
            at += 1;
            continue;
        }
        let end = closing(&tokens, at + 1);
        let attribute: Vec<&str> = tokens[at..end].iter().map(|token| token.0.as_str()).collect();
        let is_test =
            attribute.contains(&"cfg") && attribute.contains(&"test") && !attribute.contains(&"not");
        at = end;
        if is_test {
            while at < tokens.len() && tokens[at].0 != ";" && tokens[at].0 != "{" {
                at = if tokens[at].0 == "[" || tokens[at].0 == "(" { closing(&tokens, at) } else { at + 1 };
            }
            at = if at < tokens.len() && tokens[at].0 == "{" { closing(&tokens, at) } else { at + 1 };
        }
    }
    kept
}

/// The token behind what closes a bracket.
fn closing(tokens: &[Token], mut at: usize) -> usize {
    let mut depth = 0;
    while at < tokens.len() {
        match tokens[at].0.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        at += 1;
        if depth == 0 {
            break;
        }
    }
    at
}

fn is_word(token: &str) -> bool {
    token.starts_with(|first: char| first.is_alphabetic() || first == '_')
}

/// Words, `::`, and single marks: neither comments, nor strings, nor numbers.
fn tokens(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let (mut all, mut at, mut line) = (Vec::new(), 0, 1);
    while at < bytes.len() {
        let rest = &text[at..];
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(length) = string(rest) {
            length
        } else if rest.starts_with("r#") {
            2
        } else if rest.starts_with("::") {
            all.push(("::".to_owned(), line));
            2
        } else {
            let first = rest.chars().next().expect("there is more");
            let word: usize =
                rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').map(char::len_utf8).sum();
            if !first.is_whitespace() && !first.is_ascii_digit() {
                all.push((rest[..word.max(first.len_utf8())].to_owned(), line));
            }
            word.max(first.len_utf8())
        };
        line += rest[..length].matches('\n').count();
        at += length;
    }
    all
}

/// The length of the string, character or lifetime that a text begins with.
fn string(text: &str) -> Option<usize> {
    let prefix = ["br", "b", "r"].into_iter().find(|prefix| {
        let behind = text.strip_prefix(prefix).map(|rest| rest.trim_start_matches('#'));
        behind.is_some_and(|rest| rest.starts_with('"'))
    });
    let raw = prefix.is_some_and(|prefix| prefix.contains('r'));
    let rest = &text[prefix.map_or(0, str::len)..];
    if raw {
        let hashes = rest.len() - rest.trim_start_matches('#').len();
        let end = format!("\"{}", "#".repeat(hashes));
        let body = &rest[hashes + 1..];
        let length = body.find(&end).map_or(body.len(), |at| at + end.len());
        return Some(text.len() - body.len() + length);
    }
    let quote = rest.chars().next().filter(|first| *first == '"' || *first == '\'')?;
    let mut escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        // A lifetime has no second quote: `'a` ends with its word.
        if quote == '\''
            && at == 2
            && rest.as_bytes()[1] != b'\\'
            && c != '\''
            && rest.as_bytes()[1].is_ascii()
        {
            return Some(1);
        }
        if !escaped && c == quote {
            return Some(text.len() - rest.len() + at + 1);
        }
        escaped = !escaped && c == '\\';
    }
    Some(text.len())
}
