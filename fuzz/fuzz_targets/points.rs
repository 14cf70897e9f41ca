//! The target `points`.
#![no_main]

use std::sync::LazyLock;

use jbt_targets::FuzzTarget;
use libfuzzer_sys::fuzz_target;

thread_local! {
    static TARGET: LazyLock<FuzzTarget> = LazyLock::new(|| jbt_targets::target("points"));
}

fuzz_target!(|bytes: &[u8]| TARGET.with(|target| target.run(bytes)));
