//! Large parts that cannot be had: errors of the library, and the process lives on and does smaller work.
#![cfg(target_os = "linux")]

use std::process::Command;

use jbt::mesh::Lattice;
use jbt::sample::Sampler;
use jbt::{CheckedTree, Classified as _, Compiler, Engine, ErrorKind, Fineness, Polygonize, Query, Render};
use jbt_testkit::scene::tree;

/// Addresses that a process may have, in KiB: enough for all but what is asked for.
const ADDRESSES: usize = 400_000;

/// Names a work to the process that has few addresses.
const WORK: &str = "JBT_LARGE_WORK";

/// What is larger than there is memory, and how it is told.
const WORKS: [(&str, &str); 3] = [
    ("mesh", "bytes of the mesh"),
    ("samples", "there is no memory for 540022788 numbers"),
    ("picture", "there is no memory for 67108864 pixels"),
];

#[test]
fn large_parts_that_cannot_be_had_are_errors() {
    let own = std::env::current_exe().expect("a test is a program");
    for (work, told) in WORKS {
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(format!("ulimit -v {ADDRESSES} && exec \"$0\" \"$@\"")).arg(&own);
        shell.args(["work_of_few_addresses", "--exact", "--ignored", "--nocapture", "--test-threads", "1"]);
        let done = shell.env(WORK, work).env("RAYON_NUM_THREADS", "1").output().expect("a shell");
        let said = String::from_utf8_lossy(&done.stdout) + String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{work}: {said}");
        assert!(said.contains(told), "{work}: {said}");
    }
}

#[test]
#[ignore = "it is for a process of few addresses, that another test makes"]
#[allow(clippy::print_stdout, reason = "the other test reads it")]
fn work_of_few_addresses() {
    let work = std::env::var(WORK).expect("another test names the work");
    let tree = tree("jbt 1 color (1 0 0) { point { surface_radius 1 } }");
    let do_it = |small: bool| match &*work {
        "mesh" => mesh(&tree, if small { 32 } else { 3_200 }),
        "samples" => samples(&tree, if small { 8 } else { 512 }),
        _ => picture(&tree, if small { 16 } else { 8_192 }),
    };
    let (kind, told) = do_it(false).expect_err("there is not so much memory");
    assert_eq!(kind, ErrorKind::Limit, "{told}");
    println!("{told}");
    do_it(true).expect("the process can do what is small");
}

type Done = Result<(), (ErrorKind, String)>;

fn mesh(tree: &CheckedTree, cells: usize) -> Done {
    let fineness = Fineness::Resolution(cells);
    let polygonize = Polygonize { fineness, verify: false, thin_parts: false, ..Polygonize::default() };
    let made = polygonize.mesh(&Compiler::for_engine(Engine::Lanes), tree).run();
    made.map(drop).map_err(|error| (error.kind(), error.to_string()))
}

fn samples(tree: &CheckedTree, points: usize) -> Done {
    let sampler =
        Sampler::new(&Compiler::for_engine(Engine::Lanes), tree, Query::GRADIENT).expect("it compiles");
    let lattice = Lattice::new([-1.0; 3], 2.0 / points as f64, [points; 3]).expect("a lattice");
    sampler.dense(&lattice).run().map(drop).map_err(|error| (error.kind(), error.to_string()))
}

fn picture(tree: &CheckedTree, side: u32) -> Done {
    let render = Render { size: [side; 2], ..Render::default() };
    let made = render.picture(&Compiler::for_engine(Engine::Lanes), tree).run();
    made.map(drop).map_err(|error| (error.kind(), error.to_string()))
}
