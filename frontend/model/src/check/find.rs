//! Parts of a checked tree by their names.

use super::arena::NodeId;
use super::tree::CheckedTree;
use crate::diagnostic::Diagnostics;
use crate::path::{MetNode, NamedNodes, NodePath, WayStep, nowhere, search, too_many};

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
        searched.map_err(|_| vec![too_many(&path)])?;
        for (index, one) in found.iter_mut().enumerate() {
            one.path = exact(&ways, index);
        }
        let mut ways = ways.iter();
        found.retain(|_| ways.next().is_some_and(|way| path.ends(way)));
        if found.is_empty() {
            return Err(vec![nowhere(&path, self.names())].into());
        }
        Ok(found)
    }

    /// The names of its nodes, children before parents.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.nodes.iter().filter_map(|node| node.name())
    }
}

/// The path of one of these ways: with places where there are others.
fn exact(ways: &[Vec<WayStep<'_>>], index: usize) -> String {
    let mine = &ways[index];
    let mut path = String::new();
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
        path.push_str(step.name);
        if ambiguous {
            path.push_str(&format!(".{}", step.place));
        }
    }
    path
}
