//! Memory is given back. Alone in its program, because it counts the mappings of the whole process.

// Linux says what is mapped; machine code is made for this processor.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

mod common;

use std::sync::Arc;

use common::{compile, finish, rows, run, table, tables};
use jbt_ir::{Domain, FoldKind, FunctionBuilder, Rule};

/// Mappings of this process, and its pages of address space.
fn mappings() -> (usize, usize) {
    let maps = std::fs::read_to_string("/proc/self/maps").expect("Linux lists the mappings");
    let pages = std::fs::read_to_string("/proc/self/statm").expect("Linux counts the pages");
    let pages = pages.split(' ').next().and_then(|pages| pages.parse().ok()).expect("a number");
    (maps.lines().count(), pages)
}

#[test]
fn compiling_and_dropping_does_not_grow_the_process() {
    let mut b = FunctionBuilder::new("sum", &["x"]);
    let t = table(&mut b, None, 1);
    let (x, zero) = (b.input(0), b.constant(0.0));
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[zero]);
    let c = b.column(t, 0);
    let next = b.fma(c, x, acc[0]);
    let out = b.end_fold(&[next]);
    let function = finish(b, &out);
    let tables = Arc::new(tables([rows(1, 2, &[0, 1], &[0, 2], |row, _| row as f32 + 1.0)]));
    let once = || {
        let program = compile(&function);
        let second = Arc::clone(&program);
        drop(program);
        assert_eq!(run(&second, &tables, &[vec![2.0; 32]], 1), [vec![6.0; 32]]);
    };
    (0..20).for_each(|_| once()); // The allocator takes what it needs.
    let (maps, pages) = mappings();
    let alive: Vec<_> = (0..50).map(|_| compile(&function)).collect();
    assert!(mappings().0 >= maps + 50 || mappings().1 >= pages + 50, "a kernel has pages of its own");
    drop(alive);
    (0..200).for_each(|_| once());
    let (maps_after, pages_after) = mappings();
    assert!(maps_after <= maps + 20, "{maps} mappings became {maps_after}");
    assert!(pages_after <= pages + 150, "{pages} pages became {pages_after}");
}
