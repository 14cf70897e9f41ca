//! Files of scenes, of the format that `JBT_FORMAT` names.
#![no_main]

use std::sync::LazyLock;

use jbt_targets::FuzzTarget;
use libfuzzer_sys::fuzz_target;

thread_local! {
    static TARGET: LazyLock<FuzzTarget> = LazyLock::new(|| {
        let format = std::env::var("JBT_FORMAT").unwrap_or_else(|_| "jbt".to_owned());
        jbt_targets::target(&format!("read-{format}"))
    });
}

fuzz_target!(|bytes: &[u8]| TARGET.with(|target| target.run(bytes)));
