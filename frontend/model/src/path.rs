//! Paths of names: what people call a part of a model.
//!
//! ```text
//! body: union { arm: sum { hand: point .. }  arm: sum { hand: point .. } }
//!
//! hand            both hands: a path begins at any name, and selects every place that it leads to
//! body/arm.1      the second arm of the body: places of the same name below one name count from 0, in order
//! arm.0/hand      the hand of the first arm
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

/// A path of names, as `body/arm.2/hand`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NodePath(Vec<PathElement>);

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
        let element = |part: &str| {
            let (name, place) = match part.split_once('.') {
                Some((name, place)) => (name, Some(place.parse().ok()?)),
                None => (part, None),
            };
            is_identifier(&normalized(name))
                .then(|| PathElement { name: normalized(name).into_owned(), place })
        };
        let elements: Option<Vec<PathElement>> = text.split('/').map(element).collect();
        elements.map(Self).ok_or_else(|| {
            Diagnostic::error(None, format!("`{}` is no path", clip(text)))
                .expected("expected names, as body/arm.2/hand, where .2 is the third arm of the body")
        })
    }

    /// The same names, of any place.
    pub(crate) fn of_any_place(&self) -> Self {
        let element = |element: &PathElement| PathElement { name: element.name.clone(), place: None };
        Self(self.0.iter().map(element).collect())
    }

    /// Whether a way of names from the root ends with this path.
    pub(crate) fn ends(&self, way: &[WayStep<'_>]) -> bool {
        let fits = |(element, step): (&PathElement, &WayStep<'_>)| {
            element.name == step.name && element.place.is_none_or(|place| place == step.place)
        };
        way.len() >= self.0.len() && self.0.iter().rev().zip(way.iter().rev()).all(fits)
    }

    fn has(&self, name: &str) -> bool {
        self.0.iter().any(|element| element.name == name)
    }
}

impl fmt::Display for NodePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, PathElement { name, place }) in self.0.iter().enumerate() {
            f.write_str(if index == 0 { "" } else { "/" })?;
            f.write_str(name)?;
            place.map_or(Ok(()), |place| write!(f, ".{place}"))?;
        }
        Ok(())
    }
}

/// Nodes that have names.
pub(crate) trait NamedNodes<'a>: Nodes {
    fn name(self, node: Self::Node) -> Option<&'a str>;
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
    let mut next = Some(root);
    let mut met = 0;
    loop {
        if let Some(node) = next.take() {
            met += 1;
            if met > MAX_INSTANCES {
                return Err(TooManyPlaces);
            }
            if !relevant.contains(&nodes.identity(node)) {
                meet(MetNode::Other, &above, &way);
            } else {
                let name = nodes.name(node);
                if let Some(name) = name {
                    let count = counts.last_mut().expect("one for each name above").entry(name).or_default();
                    way.push(WayStep { name, place: *count });
                    *count += 1;
                    counts.push(HashMap::new());
                }
                let found = name.is_some() && path.ends(&way);
                if found {
                    meet(MetNode::Found(node), &above, &way);
                }
                if found && !inside {
                    way.pop();
                    counts.pop();
                } else {
                    frames.push(SearchFrame { node, next: 0, is_named: name.is_some() });
                    above.push((node, 0));
                }
            }
        }
        let Some(frame) = frames.last_mut() else { return Ok(()) };
        match nodes.children(frame.node).nth(frame.next) {
            Some(child) => {
                above.last_mut().expect("one for each frame").1 = frame.next;
                frame.next += 1;
                next = Some(child);
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
    let last = path.0.last().map_or("", |element| &element.name);
    let error =
        Diagnostic::error(None, format!("nothing in the model is called `{}`", clip(&path.to_string())));
    let shown = || known[..known.len().min(SHOWN)].join(", ");
    error.expected(match (known.len(), nearest(last, known.iter().copied())) {
        (0, _) => "no node has a name: hub: point { .. }, or let hub = ..".to_owned(),
        (_, Some(near)) if near != last => format!("perhaps `{near}`"),
        _ => format!("there are {}", shown()),
    })
}

/// The message about a path that leads to more places than there may be.
pub(crate) fn too_many(path: &NodePath) -> Diagnostic {
    let path = clip(&path.to_string());
    Diagnostic::limit(None, format!("`{path}` is looked for in more than {MAX_INSTANCES} places"))
}
