//! Golden files of the generators: a function as text, and what each of them makes of it, on any machine.
//!
//! The input goes through the pass that expands ops, and no other one, so that a file changes with the
//! generators alone.

use jbt_ir::pass::{PIPELINE, run_pipeline};
use jbt_ir::{Level, parse, verify};
use jbt_testkit::golden::check_golden;

use crate::{Cranelift, Wide};

#[test]
fn code() {
    check_golden("code", |input| {
        let function = parse(input).unwrap_or_else(|errors| panic!("{input}\n{errors:?}"));
        let legalize = PIPELINE.iter().filter(|pass| pass.name == "legalize");
        let function = run_pipeline(function, legalize, &mut |_, _| {});
        let function = verify(function).unwrap_or_else(|errors| panic!("{input}\n{errors:?}"));
        let clif = Cranelift::STANDARD.clif(&function).expect("it is short");
        let [avx2, avx512] = [Level::Avx2, Level::Avx512]
            .map(|level| Wide::STANDARD.asm(&function, level).expect("it is short"));
        format!("; clif\n{clif}\n; avx2\n{avx2}\n; avx512\n{avx512}")
    });
}
