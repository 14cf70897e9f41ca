//! Paths of names: what people call a part of a model.
//!
//! ```text
//! body: union { arm: sum { hand: point .. }  arm: sum { hand: point .. } }
//!
//! hand            both hands: a path begins at any name, and selects every place that it leads to
//! body/arm.1      the second arm of the body: places of the same name below one name count from 0, in order
//! arm.0/hand      the hand of the first arm
//! /body/arm       a path from the first name on: none that stands inside of something else
//! body/0/1        of the first child of the body the second one
//! 0.union/1.arm   of the root, whose number is 0, the second child: words behind numbers are for people
//! ```
//!
//! A name stands below the nearest named node above it; nodes without a name do not count. A node with
//! several uses is in several places.

use std::collections::{HashMap, HashSet};
use std::fmt;

use jbt_ir::limits::MAX_INSTANCES;

use crate::diagnostic::Diagnostic;
use crate::report::{clip, nearest};
use crate::traverse::{Nodes, Order, Traversal, Visit};
use crate::word::{is_identifier, normalized};

/// A path of names, as `body/arm.2/hand`, behind which numbers of children may stand.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NodePath {
    /// Whether nothing with a name is above its first name.
    rooted: bool,
    names: Vec<PathElement>,
    /// Which child leads on, from what the names lead to. Without names the first one is the root, whose
    /// number is 0.
    children: Vec<ChildStep>,
}

/// A number of a child, and the word behind it, which says what it is and is not looked at.
#[derive(Clone, PartialEq, Eq, Debug)]
struct ChildStep {
    number: usize,
    word: Option<String>,
}

/// A name of a path, and which of its places is meant; nothing for all.
#[derive(Clone, PartialEq, Eq, Debug)]
struct PathElement {
    name: String,
    place: Option<usize>,
}

impl NodePath {
    /// The path of a text.
    ///
    /// # Errors
    /// What is no name, or no place behind a point.
    pub fn parse(text: &str) -> Result<Self, Diagnostic> {
        let fault = || {
            Diagnostic::error(None, format!("`{}` is no path", clip(text)))
                .expected("expected names, as body/arm.2/hand, where .2 is the third arm of the body")
        };
        let (rooted, rest) = text.strip_prefix('/').map_or((false, text), |rest| (true, rest));
        let mut path = Self { rooted, names: Vec::new(), children: Vec::new() };
        path.read(rest).ok_or_else(fault)?;
        let of_root = path.children.first().is_some_and(|step| step.number == 0) && !rooted;
        if path.names.is_empty() && !of_root { Err(fault()) } else { Ok(path) }
    }

    /// The elements of a text; nothing if one is none.
    fn read(&mut self, text: &str) -> Option<()> {
        for part in text.split('/') {
            let (word, behind) = match part.split_once('.') {
                Some((word, behind)) => (word, Some(behind)),
                None => (part, None),
            };
            if word.starts_with(|c: char| c.is_ascii_digit()) {
                let word_behind = behind.map(|word| normalized(word).into_owned());
                if word_behind.as_deref().is_some_and(|word| !is_identifier(word)) {
                    return None;
                }
                self.children.push(ChildStep { number: word.parse().ok()?, word: word_behind });
                continue;
            }
            let name = normalized(word).into_owned();
            if !is_identifier(&name) || !self.children.is_empty() {
                return None;
            }
            let place = behind.map(str::parse).transpose().ok()?;
            self.names.push(PathElement { name, place });
        }
        Some(())
    }

    /// The same names, of any place.
    pub(crate) fn of_any_place(&self) -> Self {
        let element = |element: &PathElement| PathElement { name: element.name.clone(), place: None };
        Self { rooted: false, names: self.names.iter().map(element).collect(), children: Vec::new() }
    }

    /// The names alone; nothing if it has none.
    pub(crate) fn base(&self) -> Option<Self> {
        let Self { rooted, names, children: _ } = self.clone();
        (!names.is_empty()).then_some(Self { rooted, names, children: Vec::new() })
    }

    /// The numbers of the children that lead on from what the names lead to, or from above the root.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = usize> {
        self.children.iter().map(|step| step.number)
    }

    /// How many numbers lead to a child, of a node to which so many do.
    fn lead(&self, above: &[usize], child: usize) -> Vec<usize> {
        let leads = |&&led: &&usize| self.children.get(led).is_some_and(|step| step.number == child);
        above.iter().filter(leads).map(|led| led + 1).collect()
    }

    /// Whether a way of names from the root ends with the names of this path.
    pub(crate) fn ends(&self, way: &[WayStep<'_>]) -> bool {
        let fits = |(element, step): (&PathElement, &WayStep<'_>)| {
            element.name == step.name && element.place.is_none_or(|place| place == step.place)
        };
        let length = self.names.len();
        let is_long = if self.rooted { way.len() == length } else { way.len() >= length };
        length > 0 && is_long && self.names.iter().rev().zip(way.iter().rev()).all(fits)
    }

    fn has(&self, name: &str) -> bool {
        self.names.iter().any(|element| element.name == name)
    }
}

impl fmt::Display for NodePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.rooted { "/" } else { "" })?;
        for (index, PathElement { name, place }) in self.names.iter().enumerate() {
            f.write_str(if index == 0 { "" } else { "/" })?;
            f.write_str(name)?;
            place.map_or(Ok(()), |place| write!(f, ".{place}"))?;
        }
        for (index, ChildStep { number, word }) in self.children.iter().enumerate() {
            f.write_str(if index == 0 && self.names.is_empty() { "" } else { "/" })?;
            write!(f, "{number}")?;
            word.as_ref().map_or(Ok(()), |word| write!(f, ".{word}"))?;
        }
        Ok(())
    }
}

/// Nodes that have names.
pub(crate) trait NamedNodes<'a>: Nodes {
    fn name(self, node: Self::Node) -> Option<&'a str>;

    /// Its name, or the word of its kind.
    fn word(self, node: Self::Node) -> &'a str;

    /// Whether it is there for a group that nobody declared: paths do not tell of it.
    fn is_given(self, node: Self::Node) -> bool;
}

/// A name on the way from the root, and how many of it came before below the same name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct WayStep<'a> {
    pub(crate) name: &'a str,
    pub(crate) place: usize,
}

/// What a search meets.
pub(crate) enum MetNode<N> {
    /// Nothing of the path is in this subtree.
    Other,
    /// A place that the path leads to.
    Found(N),
    /// All of a node's children have been met.
    Left(N),
}

/// A node whose children are being met.
struct SearchFrame<N> {
    node: N,
    next: usize,
    is_named: bool,
    /// How many numbers of the path lead to it, behind its names: for each node above that these lead to.
    led: Vec<usize>,
}

/// A search is over when it has met more places than a model may have.
#[derive(Debug)]
pub(crate) struct TooManyPlaces;

/// Meets the places of a tree that a path leads to, in order. Where `inside`, also those in others. `meet`
/// also gets the nodes above, each with the child that leads on, and the names on the way.
pub(crate) fn search<'a, N: NamedNodes<'a>>(
    nodes: N,
    root: N::Node,
    path: &NodePath,
    inside: bool,
    mut meet: impl FnMut(MetNode<N::Node>, &[(N::Node, usize)], &[WayStep<'a>]),
) -> Result<(), TooManyPlaces> {
    let relevant = relevant(nodes, root, path);
    let mut frames: Vec<SearchFrame<N::Node>> = Vec::new();
    let mut above: Vec<(N::Node, usize)> = Vec::new();
    let mut way: Vec<WayStep<'a>> = Vec::new();
    let mut counts: Vec<HashMap<&'a str, usize>> = vec![HashMap::new()];
    // The root is the child of nothing.
    let above_root = if path.names.is_empty() { vec![0] } else { Vec::new() };
    let mut next = Some((root, path.lead(&above_root, 0)));
    let mut met = 0;
    loop {
        if let Some((node, mut led)) = next.take() {
            met += 1;
            if met > MAX_INSTANCES {
                return Err(TooManyPlaces);
            }
            if led.is_empty() && !relevant.contains(&nodes.identity(node)) {
                meet(MetNode::Other, &above, &way);
            } else {
                let name = nodes.name(node);
                if let Some(name) = name {
                    let count = counts.last_mut().expect("one for each name above").entry(name).or_default();
                    way.push(WayStep { name, place: *count });
                    *count += 1;
                    counts.push(HashMap::new());
                }
                if name.is_some() && path.ends(&way) {
                    led.push(0);
                }
                let found = led.contains(&path.children.len());
                if found {
                    meet(MetNode::Found(node), &above, &way);
                }
                if found && !inside {
                    if name.is_some() {
                        way.pop();
                        counts.pop();
                    }
                } else {
                    frames.push(SearchFrame { node, next: 0, is_named: name.is_some(), led });
                    above.push((node, 0));
                }
            }
        }
        let Some(frame) = frames.last_mut() else { return Ok(()) };
        match nodes.children(frame.node).nth(frame.next) {
            Some(child) => {
                above.last_mut().expect("one for each frame").1 = frame.next;
                next = Some((child, path.lead(&frame.led, frame.next)));
                frame.next += 1;
            }
            None => {
                let SearchFrame { node, is_named, .. } = frames.pop().expect("there is a last one");
                above.pop();
                meet(MetNode::Left(node), &above, &way);
                if is_named {
                    way.pop();
                    counts.pop();
                }
            }
        }
    }
}

/// The nodes that have, or are above, a name of the path.
fn relevant<'a, N: NamedNodes<'a>>(nodes: N, root: N::Node, path: &NodePath) -> HashSet<usize> {
    let mut all = HashSet::new();
    for node in Traversal::new(nodes, root, Order::Behind, Visit::Nodes) {
        let is_named = nodes.name(node).is_some_and(|name| path.has(name));
        if is_named || nodes.children(node).any(|child| all.contains(&nodes.identity(child))) {
            all.insert(nodes.identity(node));
        }
    }
    all
}

/// The message about a path that leads nowhere.
pub(crate) fn nowhere<'a>(path: &NodePath, names: impl Iterator<Item = &'a str>) -> Diagnostic {
    const SHOWN: usize = 20;
    let mut known: Vec<&str> = names.collect::<HashSet<_>>().into_iter().collect();
    known.sort_unstable();
    if !path.children.is_empty() {
        let error = Diagnostic::error(None, format!("nothing is at `{}`", clip(&path.to_string())));
        return error.expected("a number is that of a child, from 0 on, and that of the root is 0");
    }
    let last = path.names.last().map_or("", |element| &element.name);
    let error =
        Diagnostic::error(None, format!("nothing in the model is called `{}`", clip(&path.to_string())));
    let shown = || known[..known.len().min(SHOWN)].join(", ");
    error.expected(match (known.len(), nearest(last, known.iter().copied())) {
        (0, _) => "no node has a name: hub: point { .. }, or let hub = ..".to_owned(),
        (_, Some(near)) if near != last => format!("perhaps `{near}`"),
        _ => format!("there are {}", shown()),
    })
}

/// The path of a place, which leads to it alone: names as far as there are some, each with its place where
/// the name above has several of it, then numbers of children with their words.
///
/// Cost: the nodes of the tree, each a few times.
pub(crate) fn path_of<'a, N: NamedNodes<'a>>(
    nodes: N,
    root: N::Node,
    above: &[(N::Node, usize)],
    last: N::Node,
) -> String {
    let way: Vec<N::Node> = above.iter().map(|&(node, _)| node).chain([last]).collect();
    let mut path = PathText::default();
    let mut behind = 0;
    for (depth, &node) in way.iter().enumerate() {
        let Some(name) = nodes.name(node) else { continue };
        if depth == 0 {
            path.name(name, None);
        } else {
            let mut layer = NameLayer { nodes, name, counts: HashMap::new() };
            let first = if behind == 0 { 0 } else { behind - 1 };
            let before = (first..depth).map(|at| layer.before(way[at], above[at].1));
            let before = before.fold(0, u64::saturating_add);
            let all = layer.before(way[first], usize::MAX);
            path.name(name, (all > 1).then_some(before));
        }
        behind = depth + 1;
    }
    if behind > 0 && names_in_names(nodes, root).contains(path.first.as_str()) {
        path.text.insert(0, '/');
    }
    let mut number = 0;
    for (depth, &node) in way.iter().enumerate() {
        if !nodes.is_given(node) {
            if depth >= behind {
                path.child(number, nodes.word(node));
            }
            number = above.get(depth).map_or(0, |&(_, child)| child);
        }
    }
    path.text
}

/// A path as it is written.
#[derive(Default)]
struct PathText {
    text: String,
    /// Its first name.
    first: String,
}

impl PathText {
    fn name(&mut self, name: &str, place: Option<u64>) {
        if self.text.is_empty() {
            self.first = name.to_owned();
        }
        self.text.push_str(if self.text.is_empty() { "" } else { "/" });
        self.text.push_str(&name_step(name, place));
    }

    fn child(&mut self, number: usize, word: &str) {
        self.text.push_str(if self.text.is_empty() { "" } else { "/" });
        self.text.push_str(&child_step(number, word));
    }
}

/// A name of a path, with its place where that is said.
pub(crate) fn name_step(name: &str, place: Option<u64>) -> String {
    place.map_or_else(|| name.to_owned(), |place| format!("{name}.{place}"))
}

/// A number of a path, with the word of what it leads to.
pub(crate) fn child_step(number: usize, word: &str) -> String {
    format!("{number}.{word}")
}

/// How often a name stands below nodes, with no other name between.
struct NameLayer<'a, N> {
    nodes: N,
    name: &'a str,
    counts: HashMap<usize, u64>,
}

impl<'a, N: NamedNodes<'a>> NameLayer<'a, N> {
    /// In the first children of a node.
    fn before(&mut self, node: N::Node, child: usize) -> u64 {
        let children: Vec<N::Node> = self.nodes.children(node).take(child).collect();
        children.into_iter().fold(0, |all: u64, child| all.saturating_add(self.count(child)))
    }

    /// In a node and below it.
    fn count(&mut self, node: N::Node) -> u64 {
        let mut stack = vec![(node, false)];
        while let Some((node, is_done)) = stack.pop() {
            let identity = self.nodes.identity(node);
            if self.counts.contains_key(&identity) {
                continue;
            }
            if let Some(name) = self.nodes.name(node) {
                self.counts.insert(identity, u64::from(name == self.name));
            } else if is_done {
                let below = self.nodes.children(node).map(|child| self.counts[&self.nodes.identity(child)]);
                let all = below.fold(0, u64::saturating_add);
                self.counts.insert(identity, all);
            } else {
                stack.push((node, true));
                stack.extend(self.nodes.children(node).map(|child| (child, false)));
            }
        }
        self.counts[&self.nodes.identity(node)]
    }
}

/// The names that stand below other names: a path that begins with one of them may lead to several places.
pub(crate) fn names_in_names<'a, N: NamedNodes<'a>>(nodes: N, root: N::Node) -> HashSet<&'a str> {
    let mut found = HashSet::new();
    // Each node once at the top, and once below a name.
    let mut seen: HashSet<(usize, bool)> = HashSet::new();
    let mut stack = vec![(root, false)];
    while let Some((node, is_below)) = stack.pop() {
        let identity = nodes.identity(node);
        if seen.contains(&(identity, true)) || !seen.insert((identity, is_below)) {
            continue;
        }
        let name = nodes.name(node);
        if is_below {
            found.extend(name);
        }
        stack.extend(nodes.children(node).map(|child| (child, is_below || name.is_some())));
    }
    found
}

/// The message about a path that leads to more places than there may be.
pub(crate) fn too_many(path: &NodePath) -> Diagnostic {
    let path = clip(&path.to_string());
    Diagnostic::limit(None, format!("`{path}` is looked for in more than {MAX_INSTANCES} places"))
}
