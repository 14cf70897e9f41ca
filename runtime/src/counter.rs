//! Counters: how much work was done.
//!
//! Points, calls and lanes are counted. Distances are not: they are points times the distances of a point,
//! which the code's origins tell ([`jbt_ir::domain::counting`]), less what regions left out.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use jbt_model::query::Query;

/// Walks of the tree that separate evaluations take: 1 for the field; 4 more for the gradient by forward
/// differences, at the point and a step along each axis; 1 more for the attributes.
#[must_use]
pub fn walks(query: Query) -> u64 {
    query.answers().map(|answer| answer.row().walks.0).sum()
}

/// What an evaluator has done so far. A snapshot: see [`crate::Evaluator::counters`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Counters {
    /// Calls of the kernel. A slice of points makes one for each 512 points; [`Points`](crate::Points) make
    /// one for each call of `eval`, or for each 4,096 points of `par_eval`.
    pub calls: u64,
    /// Points that were asked for.
    pub points: u64,
    /// Points that were computed: the last block of a call is filled up, and points where the gradient was
    /// not finite are computed twice.
    pub lanes: u64,
    /// Distances to skeletons that were computed, once for each point asked for. After an
    /// [update](crate::Evaluator::update), earlier points count at the price of the new model.
    pub primitive_evaluations: u64,
    /// Distances that would have been computed on top of these if nothing had been left out at the points
    /// asked for: rows that do not reach a region, operands that do not decide there.
    pub evaluations_pruned: u64,
    /// Distances that [separate walks](crate::statistics::walks) of the tree would have computed on top of
    /// these: for the field, for the normal by differences and for the attributes, a shared subtree again at
    /// each use.
    pub evaluations_avoided: u64,
}

impl Counters {
    /// Counts the work of another evaluator as well.
    pub(crate) fn add(&mut self, other: &Self) {
        let sums = [
            (&mut self.calls, other.calls),
            (&mut self.points, other.points),
            (&mut self.lanes, other.lanes),
            (&mut self.primitive_evaluations, other.primitive_evaluations),
            (&mut self.evaluations_pruned, other.evaluations_pruned),
            (&mut self.evaluations_avoided, other.evaluations_avoided),
        ];
        for (sum, more) in sums {
            *sum += more;
        }
    }
}

/// Shards of counters: threads beyond so many share some.
const SHARDS: usize = 16;

/// The counters of an evaluator, shared by threads. Each thread counts in a shard of its own, so that no two
/// processors write to one line of memory at each call.
#[derive(Debug, Default)]
pub(crate) struct SharedCounters {
    shards: [CounterShard; SHARDS],
}

/// Counters of some threads. Processors fetch lines of 64 bytes, often in pairs.
#[derive(Debug, Default)]
#[repr(align(128))]
struct CounterShard {
    calls: AtomicU64,
    points: AtomicU64,
    lanes: AtomicU64,
    pruned: AtomicU64,
}

thread_local! {
    /// The shard of this thread: threads take them in turn.
    static SHARD: usize = {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        NEXT.fetch_add(1, Ordering::Relaxed) % SHARDS
    };
}

impl SharedCounters {
    /// Counts a call that left `pruned` distances out at each point.
    pub(crate) fn add(&self, points: usize, lanes: usize, pruned: u64) {
        let shard = &self.shards[SHARD.with(|&shard| shard)];
        shard.pruned.fetch_add(pruned.saturating_mul(points as u64), Ordering::Relaxed);
        shard.calls.fetch_add(1, Ordering::Relaxed);
        shard.points.fetch_add(points as u64, Ordering::Relaxed);
        shard.lanes.fetch_add(lanes as u64, Ordering::Relaxed);
    }

    /// The counters, for a program that computes `evaluations` distances a point where separate walks compute
    /// `separate`.
    pub(crate) fn snapshot(&self, evaluations: u64, separate: u64) -> Counters {
        let sum = |of: fn(&CounterShard) -> &AtomicU64| {
            self.shards.iter().map(|shard| of(shard).load(Ordering::Relaxed)).fold(0, u64::wrapping_add)
        };
        let points = sum(|shard| &shard.points);
        let pruned = sum(|shard| &shard.pruned);
        let primitive_evaluations = points.saturating_mul(evaluations).saturating_sub(pruned);
        Counters {
            calls: sum(|shard| &shard.calls),
            points,
            lanes: sum(|shard| &shard.lanes),
            primitive_evaluations,
            evaluations_pruned: pruned,
            evaluations_avoided: points.saturating_mul(separate).saturating_sub(primitive_evaluations),
        }
    }
}
