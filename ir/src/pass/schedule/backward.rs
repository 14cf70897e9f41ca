//! Writes an order from the last instruction to the first: among the instructions whose readers are all
//! placed, it takes the one that leaves the fewest values alive before it.
//!
//! Where several results share their work, as a field and its gradient do, a depth-first order from one
//! result computes and keeps everything that the other results share with it. Backwards, instructions that
//! read the same values attract each other.
//!
//! ```text
//! growth(node) = the operands that nothing placed so far reads - the values of the node that something placed so far reads
//! ```
//!
//! An operand that reads nothing in the block and has no other reader left does not count: it will come
//! directly before its reader. [`Tie`] says which of several nodes with equal growth comes first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::graph::Graph;
use crate::watch::look;

/// Which of several nodes with equal growth comes first.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Tie {
    /// The one that was offered last: the order follows one thread while it can.
    Recent,
    /// The one with the longest chain of operands: parallel chains advance together.
    Deep,
}

/// A candidate: growth, depth (only for [`Tie::Deep`]), when it was offered, node.
type Heap = BinaryHeap<(Reverse<isize>, usize, usize, usize)>;

struct Backward<'a> {
    graph: &'a Graph,
    /// For each node, how many of its readers have no place yet.
    waiting: Vec<usize>,
    /// For each node, whether something placed reads it, or it is a result of the block.
    alive: Vec<bool>,
    placed: Vec<bool>,
    /// For each node, the tie-break before the time of the offer.
    depth: Vec<usize>,
    heap: Heap,
    /// How often something was offered.
    time: usize,
}

/// The order, as nodes.
pub(super) fn backward(graph: &Graph, tie: Tie) -> Vec<usize> {
    let nodes = graph.weight.len();
    let mut this = Backward {
        graph,
        waiting: (0..nodes).map(|node| graph.readers(node).len()).collect(),
        alive: vec![false; nodes],
        placed: vec![false; nodes],
        depth: if tie == Tie::Deep { depths(graph) } else { vec![0; nodes] },
        heap: Heap::new(),
        time: 0,
    };
    for &node in &graph.results {
        this.alive[node] = true;
    }
    for node in 0..graph.insts.len() {
        look();
        this.offer(node);
    }
    let mut order = Vec::with_capacity(graph.insts.len());
    while let Some((_, _, _, node)) = this.heap.pop() {
        look();
        if !this.placed[node] {
            order.push(node);
            this.place(node);
        }
    }
    order.reverse();
    order
}

/// For each node, the length of its longest chain of operands.
fn depths(graph: &Graph) -> Vec<usize> {
    let mut depths = vec![0; graph.weight.len()];
    for node in 0..graph.insts.len() {
        look();
        depths[node] = graph.operands(node).iter().map(|&operand| depths[operand] + 1).max().unwrap_or(0);
    }
    depths
}

impl Backward<'_> {
    /// Puts a node on the heap if it can be placed. An older entry of the node stays and is skipped later:
    /// growth only falls.
    fn offer(&mut self, node: usize) {
        if node < self.graph.insts.len() && self.waiting[node] == 0 && !self.placed[node] {
            self.time += 1;
            self.heap.push((Reverse(self.growth(node)), self.depth[node], self.time, node));
        }
    }

    fn growth(&self, node: usize) -> isize {
        let graph = self.graph;
        let mut growth = 0;
        for &operand in graph.operands(node) {
            let follows = graph.is_free(operand) && self.waiting[operand] == 1;
            if !self.alive[operand] && !follows {
                growth += graph.weight[operand].cast_signed();
            }
        }
        if self.alive[node] { growth - graph.weight[node].cast_signed() } else { growth }
    }

    /// Places a node before all placed nodes, and offers the nodes that this makes possible or cheaper.
    fn place(&mut self, node: usize) {
        let graph = self.graph;
        self.placed[node] = true;
        for &operand in graph.operands(node) {
            self.waiting[operand] -= 1;
            let born = !std::mem::replace(&mut self.alive[operand], true);
            if born || (self.waiting[operand] == 1 && graph.is_free(operand)) {
                for &reader in graph.readers(operand) {
                    self.offer(reader);
                }
            }
            self.offer(operand);
        }
    }
}
