//! Parts of a checked tree by their names.

use std::collections::HashSet;

use super::arena::{CheckedNode, NodeId};
use super::tree::CheckedTree;
use crate::diagnostic::Diagnostics;
use crate::kind::NodeKind;
use crate::path::{
    MetNode, NamedNodes, NodePath, WayStep, child_step, name_step, names_in_names, nowhere, search, too_many,
};

/// A place in a tree that a path of names leads to.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FoundNode {
    /// The node.
    pub node: NodeId,
    /// The nodes above it, the root first, each with the number of the child that leads on.
    pub above: Vec<(NodeId, u32)>,
    /// Its path from the first name on, which leads to it alone.
    pub path: String,
}

impl<'a> NamedNodes<'a> for &'a CheckedTree {
    fn name(self, node: NodeId) -> Option<&'a str> {
        self.node(node).name()
    }

    fn word(self, node: NodeId) -> &'a str {
        word(self.node(node))
    }

    fn is_given(self, node: NodeId) -> bool {
        CheckedTree::is_given(self, node)
    }
}

/// The word for a node: its name, or that of its kind.
fn word(node: &CheckedNode) -> &str {
    if let Some(name) = node.name() {
        return name;
    }
    match &node.kind {
        NodeKind::Primitive(leaf) => leaf.skeleton.kind().name(),
        NodeKind::Particles(_) => "particles",
        NodeKind::Combine(combinator) => combinator.name(),
        NodeKind::Affine(_) => "affine",
        NodeKind::Warp(warp) => warp.name(),
        NodeKind::Attribute { name, .. } | NodeKind::Constant { name, .. } => name,
        NodeKind::Select(_) => "select",
        NodeKind::Expression(_) => "expression",
    }
}

impl CheckedTree {
    /// The places that a path of names leads to, in order: see [`path`](crate::path).
    ///
    /// ```
    /// use jbt_text::model;
    /// let text = "jbt 1 let hand = point { radius 1 }
    ///     body: union { arm: translate (1 0 0) { use hand } arm: translate (-1 0 0) { use hand } }";
    /// let tree = model(text)?.check()?;
    /// let paths: Vec<String> = tree.find("hand")?.into_iter().map(|found| found.path).collect();
    /// assert_eq!(paths, ["body/arm.0/hand", "body/arm.1/hand"]);
    /// assert_eq!(tree.find("arm.1/hand")?[0].path, "body/arm.1/hand");
    /// assert!(tree.find("leg").is_err());
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    ///
    /// Cost: the places of all names of the path.
    ///
    /// # Errors
    /// What is no path, one that leads nowhere, and one that is looked for in more places than a model may
    /// have.
    pub fn find(&self, path: &str) -> Result<Vec<FoundNode>, Diagnostics> {
        let path = NodePath::parse(path).map_err(|error| vec![error])?;
        let Some(base) = path.base() else {
            // Above the root is nothing, whose first child the root is.
            let root = FoundNode { node: self.root(), above: Vec::new(), path: String::new() };
            let start = path.numbers().next().is_some().then(|| self.given_below(root));
            return self.below(&path, start.into_iter().collect(), 1);
        };
        let found = self.named(&base)?;
        self.below(&path, found, 0)
    }

    /// The places that the numbers of a path lead to, from those that its names lead to, and behind so many
    /// of the numbers.
    fn below(
        &self,
        path: &NodePath,
        from: Vec<FoundNode>,
        led: usize,
    ) -> Result<Vec<FoundNode>, Diagnostics> {
        let lead = |start: FoundNode| {
            let mut numbers = path.numbers().skip(led);
            numbers.try_fold(start, |found, number| self.child_of(found, number))
        };
        let found: Vec<FoundNode> = from.into_iter().filter_map(lead).collect();
        if found.is_empty() { Err(vec![nowhere(path, self.names())].into()) } else { Ok(found) }
    }

    /// A child of a place, if there is one of this number.
    fn child_of(&self, found: FoundNode, number: usize) -> Option<FoundNode> {
        let FoundNode { node, mut above, path } = found;
        let child = *self.node(node).children.get(number)?;
        above.push((node, number as u32));
        let found = FoundNode { node: child, above, path };
        let FoundNode { node, above, path } = self.given_below(found);
        let path = format!("{path}/{}", child_step(number, word(self.node(node))));
        Some(FoundNode { node, above, path })
    }

    /// What stands below nodes that are there for groups that nobody declared.
    fn given_below(&self, mut found: FoundNode) -> FoundNode {
        while self.is_given(found.node) {
            found.above.push((found.node, 0));
            found.node = self.node(found.node).children[0];
        }
        if found.path.is_empty() {
            found.path = child_step(0, word(self.node(found.node)));
        }
        found
    }

    /// The places that the names of a path lead to.
    fn named(&self, path: &NodePath) -> Result<Vec<FoundNode>, Diagnostics> {
        let mut found = Vec::new();
        let mut ways: Vec<Vec<WayStep<'_>>> = Vec::new();
        // All places of these names, so that it is known where a name alone will do.
        let searched = search(self, self.root(), &path.of_any_place(), true, |met, above, way| {
            if let MetNode::Found(node) = met {
                let above = above.iter().map(|&(node, child)| (node, child as u32)).collect();
                found.push(FoundNode { node, above, path: String::new() });
                ways.push(way.to_vec());
            }
        });
        searched.map_err(|_| vec![too_many(path)])?;
        let inner = names_in_names(self, self.root());
        for (index, one) in found.iter_mut().enumerate() {
            one.path = exact(&ways, index, &inner);
        }
        let mut ways = ways.iter();
        found.retain(|_| ways.next().is_some_and(|way| path.ends(way)));
        if found.is_empty() {
            return Err(vec![nowhere(path, self.names())].into());
        }
        Ok(found)
    }

    /// The names of its nodes, children before parents.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.nodes.iter().filter_map(|node| node.name())
    }
}

/// The path of one of these ways: with places where there are others, and from the root if its first name
/// stands below names as well.
fn exact(ways: &[Vec<WayStep<'_>>], index: usize, inner: &HashSet<&str>) -> String {
    let mine = &ways[index];
    let mut path = String::new();
    if mine.first().is_some_and(|step| inner.contains(step.name)) {
        path.push('/');
    }
    for (depth, step) in mine.iter().enumerate() {
        let is_other = |way: &&[WayStep<'_>]| {
            way.len() > depth
                && way[..depth] == mine[..depth]
                && way[depth].name == step.name
                && way[depth].place != step.place
        };
        // Ways are in order, so others of the same names stand beside this one.
        let near = |range: &[Vec<WayStep<'_>>], last: bool| {
            let same = |way: &&Vec<WayStep<'_>>| way.len() > depth && way[..depth] == mine[..depth];
            let mut others: Box<dyn Iterator<Item = &Vec<WayStep<'_>>>> =
                if last { Box::new(range.iter().rev()) } else { Box::new(range.iter()) };
            others.by_ref().take_while(same).any(|way| is_other(&way.as_slice()))
        };
        let ambiguous = step.place > 0 || near(&ways[..index], true) || near(&ways[index + 1..], false);
        path.push_str(if depth == 0 { "" } else { "/" });
        path.push_str(&name_step(step.name, ambiguous.then_some(step.place as u64)));
    }
    path
}
