//! Orders the instructions of each block so that few values are alive at once. Instructions are pure, so uses
//! are the only constraint.
//!
//! No order is best for every graph, and counting is cheap: heuristics propose orders, and the block takes
//! the one with the smallest peak of values, or stays as it is if none is better.
//!
//! * [`depth_first`] is optimal for trees: sums of many terms become chains.
//! * [`backward`] is good where results share their work, as a field and its gradient do.

mod backward;
mod depth_first;
mod graph;

use backward::{Tie, backward};
use depth_first::depth_first;
use graph::Graph;

use crate::entity::{Block, Entity, Inst};
use crate::function::Function;
use crate::pass::liveness::{Liveness, Uses};
use crate::translate::renumber;
use crate::watch::look_now;

/// The function with its blocks in a better order.
#[must_use]
pub fn schedule(mut function: Function) -> Function {
    for (block, order) in orders(&function) {
        function.blocks[block].insts = order;
    }
    look_now();
    renumber(&function)
}

/// The blocks for which there is a better order, and that order.
fn orders(function: &Function) -> Vec<(Block, Vec<Inst>)> {
    let uses = Uses::new(function);
    let mut liveness = Liveness::new(function);
    let mut node = vec![0; function.values.len()];
    let mut orders = Vec::new();
    for &block in &uses.inner_first {
        let graph = Graph::new(function, &uses, block, &liveness.peaks, &mut node);
        let mut better = None;
        let mut best = liveness.peak(&uses, block, &graph.insts);
        let proposals: [fn(&Graph) -> Vec<usize>; 3] =
            [depth_first, |graph| backward(graph, Tie::Recent), |graph| backward(graph, Tie::Deep)];
        for propose in proposals {
            look_now();
            let order: Vec<Inst> = propose(&graph).into_iter().map(|node| graph.insts[node]).collect();
            let peak = liveness.peak(&uses, block, &order);
            if peak < best {
                best = peak;
                better = Some(order);
            }
        }
        liveness.peaks[block.index()] = best;
        orders.extend(better.map(|order| (block, order)));
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::FunctionBuilder;
    use crate::entity::Value;
    use crate::op::Domain;
    use crate::pass::max_live;

    #[test]
    fn a_sum_that_computes_all_terms_first_becomes_a_chain() {
        let mut b = FunctionBuilder::new("f", &["x"]);
        let x = b.input(0);
        let terms: Vec<Value> = (0..100u8)
            .map(|i| {
                let number = b.constant(f32::from(i));
                let term = b.mul(x, number);
                b.sqrt(term)
            })
            .collect();
        let sum = terms.into_iter().reduce(|sum, term| b.add(sum, term)).expect("100 terms");
        let function = b.finish(&[("out".into(), sum)]);
        assert!(max_live(&function) > 100);
        let live = max_live(&schedule(function));
        assert!(live <= 4, "{live}");
    }

    #[test]
    fn a_balanced_tree_needs_its_depth() {
        let mut b = FunctionBuilder::new("f", &["x"]);
        let mut layer: Vec<Value> = (0..64u8).map(|i| b.constant(f32::from(i))).collect();
        while layer.len() > 1 {
            layer = layer.chunks(2).map(|pair| b.add(pair[0], pair[1])).collect();
        }
        let function = b.finish(&[("out".into(), layer[0])]);
        // Sethi and Ullman: 64 leaves need 7 registers.
        assert_eq!(max_live(&schedule(function)), 7);
    }

    #[test]
    fn results_that_share_their_work_advance_together() {
        // 50 terms, each used by three sums: term by term 3 sums and a term are alive.
        let mut b = FunctionBuilder::new("f", &["x"]);
        let x = b.input(0);
        let terms: Vec<Value> = (0..50u8)
            .map(|i| {
                let number = b.constant(f32::from(i));
                let term = b.sub(x, number);
                b.mul(term, term)
            })
            .collect();
        let outputs: Vec<(String, Value)> = (0..3u8)
            .map(|i| {
                let factor = b.constant(f32::from(i) + 0.5);
                let zero = b.constant(0.0);
                let sum = terms.iter().fold(zero, |sum, &term| b.fma(term, factor, sum));
                (format!("sum{i}"), sum)
            })
            .collect();
        let function = b.finish(&outputs);
        assert!(max_live(&function) > 50);
        // x, three factors, three sums, a term, a number.
        let live = max_live(&schedule(function));
        assert!(live <= 9, "{live}");
    }

    #[test]
    fn a_better_order_is_kept() {
        let mut b = FunctionBuilder::new("f", &["x"]);
        let x = b.input(0);
        let square = b.mul(x, x);
        let sum = b.add(square, x);
        let function = b.finish(&[("out".into(), sum)]);
        assert_eq!(schedule(function.clone()), function);
    }
}
