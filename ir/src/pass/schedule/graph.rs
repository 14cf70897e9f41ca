//! The reads in one block, as a graph.

use crate::entity::{Block, Entity, Inst, Value};
use crate::function::{Function, InstKind};
use crate::pass::liveness::Uses;
use crate::watch::look;

/// Lists of nodes, by node, in one allocation.
struct Lists {
    starts: Vec<usize>,
    items: Vec<usize>,
}

impl Lists {
    fn get(&self, node: usize) -> &[usize] {
        &self.items[self.starts[node]..self.starts[node + 1]]
    }
}

/// The dependences in a block. A node is the position of an instruction in the block; after the instructions
/// come the block's parameters. Values of enclosing blocks are no nodes: they are alive all the time.
pub(super) struct Graph {
    /// The instructions, by node.
    pub insts: Vec<Inst>,
    /// The nodes that the block yields, once each.
    pub results: Vec<usize>,
    /// How many values each node defines.
    pub weight: Vec<usize>,
    /// How many values are alive inside each node while it runs: for a fold, the peak of its body.
    pub inside: Vec<usize>,
    operands: Lists,
    readers: Lists,
}

impl Graph {
    /// The graph of a block. `node` is room for the node of each value, `peaks` are the peaks of the blocks
    /// inside.
    pub fn new(function: &Function, uses: &Uses, block: Block, peaks: &[usize], node: &mut [usize]) -> Self {
        let data = &function.blocks[block];
        let insts = data.insts.clone();
        let mut weight: Vec<usize> = insts.iter().map(|&inst| function.insts[inst].results.len()).collect();
        for (position, &inst) in insts.iter().enumerate() {
            look();
            for value in &function.insts[inst].results {
                node[value.index()] = position;
            }
        }
        for (position, param) in data.params.iter().enumerate() {
            node[param.index()] = insts.len() + position;
            weight.push(1);
        }

        // For each node, the last list that has it, so that a list has it once.
        let mut listed = vec![usize::MAX; weight.len()];
        let mut list = |index: usize, values: &[Value], items: &mut Vec<usize>| {
            for &value in values {
                if uses.home[value.index()] == Some(block) {
                    let node = node[value.index()];
                    if std::mem::replace(&mut listed[node], index) != index {
                        items.push(node);
                    }
                }
            }
        };
        let mut operands = Lists { starts: vec![0], items: Vec::new() };
        for (position, &inst) in insts.iter().enumerate() {
            look();
            let (initial, captured) = uses.of(function, inst);
            list(position, initial, &mut operands.items);
            list(position, captured, &mut operands.items);
            operands.starts.push(operands.items.len());
        }
        operands.starts.resize(weight.len() + 1, operands.items.len());
        let mut results = Vec::new();
        list(weight.len(), &data.results, &mut results);

        let inside = insts.iter().map(|&inst| inside(function, peaks, inst)).collect();
        let readers = reversed(&operands);
        Self { insts, results, weight, inside, operands, readers }
    }

    /// The nodes that this one reads, once each.
    pub fn operands(&self, node: usize) -> &[usize] {
        self.operands.get(node)
    }

    /// The nodes that read this one, once each.
    pub fn readers(&self, node: usize) -> &[usize] {
        self.readers.get(node)
    }

    /// Whether the node is an instruction that reads nothing of the block: it can stand directly before its
    /// reader.
    pub fn is_free(&self, node: usize) -> bool {
        node < self.insts.len() && self.operands(node).is_empty()
    }
}

fn inside(function: &Function, peaks: &[usize], inst: Inst) -> usize {
    match &function.insts[inst].kind {
        InstKind::Fold(fold) => peaks[fold.body.index()],
        InstKind::Input(_)
        | InstKind::Constant(_)
        | InstKind::BitsConstant(_)
        | InstKind::Column { .. }
        | InstKind::Op { .. } => 0,
    }
}

/// For each node, the nodes whose lists have it.
fn reversed(lists: &Lists) -> Lists {
    let nodes = lists.starts.len() - 1;
    let mut starts = vec![0; nodes + 1];
    for &item in &lists.items {
        starts[item + 1] += 1;
    }
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let mut next = starts.clone();
    let mut items = vec![0; lists.items.len()];
    for node in 0..nodes {
        look();
        for &item in lists.get(node) {
            items[next[item]] = node;
            next[item] += 1;
        }
    }
    Lists { starts, items }
}
