//! An order that goes depth-first from the block's results, into the operand with the largest need first
//! (Sethi and Ullman, 1970): while an operand is computed, as few values as possible wait, and it leaves one
//! value.
//!
//! ```text
//! need(node) = the largest, over its operands in descending order of need, of need(operand) + how many come before it
//! ```
//!
//! For trees that is optimal.

use std::cmp::Reverse;

use super::graph::Graph;
use crate::watch::look;

struct DepthFirst<'a> {
    graph: &'a Graph,
    /// For each instruction, how many values are alive while it is computed, as if nothing were shared.
    need: Vec<usize>,
    placed: Vec<bool>,
    order: Vec<usize>,
}

/// The order, as nodes.
pub(super) fn depth_first(graph: &Graph) -> Vec<usize> {
    let nodes = graph.insts.len();
    let mut this = DepthFirst {
        graph,
        need: vec![0; nodes],
        placed: vec![false; nodes],
        order: Vec::with_capacity(nodes),
    };
    for node in 0..nodes {
        look();
        let operands = this.by_need(graph.operands(node));
        let most = operands.iter().enumerate().map(|(before, &operand)| this.need[operand] + before).max();
        // A fold keeps what it reads while its body runs.
        let kept = if graph.inside[node] > 0 { graph.inside[node] + operands.len() } else { 0 };
        this.need[node] = most.unwrap_or(0).max(kept).max(graph.weight[node]);
    }
    for root in this.by_need(&graph.results) {
        this.place(root);
    }
    // Instructions that no result needs come last, in their old order.
    for node in 0..nodes {
        if !this.placed[node] {
            this.order.push(node);
        }
    }
    this.order
}

impl DepthFirst<'_> {
    /// The instructions among these nodes, the largest need first, equal ones as they come.
    fn by_need(&self, nodes: &[usize]) -> Vec<usize> {
        let mut nodes: Vec<usize> = nodes.iter().copied().filter(|&node| node < self.need.len()).collect();
        nodes.sort_by_key(|&node| Reverse(self.need[node]));
        nodes
    }

    /// Places an instruction after its operands. The stack is explicit: a chain may be as long as a block.
    fn place(&mut self, root: usize) {
        let mut stack = vec![(root, self.by_need(self.graph.operands(root)).into_iter())];
        while let Some((node, operands)) = stack.last_mut() {
            look();
            let node = *node;
            if self.placed[node] {
                stack.pop();
            } else if let Some(operand) = operands.next() {
                if !self.placed[operand] {
                    stack.push((operand, self.by_need(self.graph.operands(operand)).into_iter()));
                }
            } else {
                self.placed[node] = true;
                self.order.push(node);
                stack.pop();
            }
        }
    }
}
