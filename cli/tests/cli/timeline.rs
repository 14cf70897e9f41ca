//! `--trace`: a timeline of the work, in the format of Chrome's trace viewer.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use crate::folder::{Folder, SCENE};

/// Long work, and stages that its timeline must show.
const WORKS: [(&[&str], &[&str]); 3] = [
    (
        &["mesh", "scene.jbt", "-o", "a.glb", "--resolution", "40"],
        &[
            "read",
            "lower",
            "code",
            "divide",
            "sample",
            "cross",
            "vertices",
            "triangles",
            "normals",
            "thin parts",
            "bytes",
        ],
    ),
    (
        &["render", "scene.jbt", "-o", "a.png", "--size", "64", "--quality", "good"],
        &["read", "code", "frame", "guide", "light", "look", "develop", "smooth", "bytes"],
    ),
    (
        &["contour", "scene.jbt", "-o", "a.svg", "--resolution", "64"],
        &["read", "code", "square", "loops", "bytes"],
    ),
];

/// Stages: which there are, and the sum of the times in microseconds of those that lie in no other one.
/// Panics unless every span ends, in the order of a stack, on the thread on which it began.
fn stages(json: &[u8]) -> (BTreeSet<String>, f64) {
    let events: Vec<Value> = serde_json::from_slice(json).expect("the timeline is JSON");
    let mut open: BTreeMap<u64, Vec<(String, f64)>> = BTreeMap::new();
    let mut names = BTreeSet::new();
    let mut outer = 0.0;
    for event in &events {
        let stack = open.entry(event["tid"].as_u64().expect("a thread")).or_default();
        let name = event["name"].as_str().expect("a name").to_owned();
        match event["ph"].as_str().expect("a phase") {
            "B" => stack.push((name, event["ts"].as_f64().expect("a time"))),
            "E" => {
                let (begun, start) = stack.pop().expect("a span that ends has begun");
                assert_eq!(begun, name);
                let took = event["ts"].as_f64().expect("a time") - start;
                assert!(took >= 0.0, "{name} takes {took} microseconds");
                outer += if stack.is_empty() { took } else { 0.0 };
                names.insert(name);
            }
            phase => assert_eq!(phase, "M", "an event of another kind: {event}"),
        }
    }
    assert!(open.values().all(Vec::is_empty), "spans without an end: {open:?}");
    (names, outer)
}

#[test]
fn a_timeline_names_the_stages_of_the_work_and_changes_nothing() {
    let folder = Folder::new().with("scene.jbt", SCENE);
    for (work, expected) in WORKS {
        folder.jbt(work).code(0);
        let plain = folder.read(work[3]);
        let started = std::time::Instant::now();
        folder.jbt(&[work, &["--force", "--threads", "2", "--trace", "t.json"]].concat()).code(0);
        let most = started.elapsed().as_micros() as f64 * 3.0;
        assert_eq!(folder.read(work[3]), plain, "{work:?}");
        let (names, outer) = stages(&folder.read("t.json"));
        for stage in expected {
            assert!(names.contains(*stage), "{work:?} without {stage}: {names:?}");
        }
        // Three threads at most have a span: two of the pool, and the one that waits for them.
        assert!(outer > 0.0 && outer < most, "{work:?}: {outer} of {most}");
    }
}

#[test]
fn a_timeline_shows_what_was_done_before_an_error() {
    let folder = Folder::new().with("scene.jbt", "jbt 1\npoint { radius -1 }\n");
    folder.jbt(&["mesh", "scene.jbt", "-o", "a.glb", "--trace", "t.json"]).code(1);
    let (names, _) = stages(&folder.read("t.json"));
    assert!(names.contains("read") || names.contains("check"), "{names:?}");
}

#[test]
fn a_timeline_goes_to_a_file_that_can_be_written() {
    let folder = Folder::new().with("scene.jbt", SCENE);
    let check = |path: &str| folder.jbt(&["check", "scene.jbt", "--trace", path]);
    check("-").code(2).says("a timeline goes to a file");
    check("nowhere/t.json").code(4).says("nowhere");
    check("t.json").code(0);
    // As of every run, the newest one is there.
    check("t.json").code(0);
}
