//! What the stages of a mesh evaluated, and what they were spared, as `jbt mesh` and `jbt count` tell it.

use jbt::{Counters, MeshCounters};
use serde_json::{Value, json};

use crate::output::grouped;

/// For machines.
pub fn json(counters: &MeshCounters) -> Value {
    let stage = |of: &Counters| json!({ "points": of.points, "evaluations": of.primitive_evaluations });
    json!({
        "division": {
            "boxes": counters.division.boxes,
            "interval_evaluations": counters.division.interval_evaluations,
        },
        "lattice": stage(&counters.lattice),
        "pulls": stage(&counters.pulls),
        "vertices": stage(&counters.vertices),
    })
}

/// For people: a line for each stage.
pub fn text(counters: &MeshCounters) -> String {
    let stage = |name: &str, points: u64, what: &str, evaluations: u64| {
        format!("  {name:<12} {} {what}, {} evaluations\n", grouped(points), grouped(evaluations))
    };
    let of = |name: &str, counters: &Counters| {
        stage(name, counters.points, "points", counters.primitive_evaluations)
    };
    let division = &counters.division;
    let mut out = stage("division", division.boxes, "boxes", division.interval_evaluations);
    out += &of("lattice", &counters.lattice);
    out += &of("pulls", &counters.pulls);
    out += &of("vertices", &counters.vertices);
    out + &format!(
        "  {:<12} {} out of reach, {} where no surface is, of {} on the whole lattice",
        "avoided",
        grouped(counters.avoided_by_support),
        grouped(counters.avoided_by_interval),
        grouped(counters.dense_evaluations),
    )
}
