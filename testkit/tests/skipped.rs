//! Says what tests were skipped, and why, when all of them have run.

#![allow(clippy::print_stdout, reason = "this line is what the program is for")]

use jbt_ir::Level;
use jbt_testkit::skip;

fn main() {
    // Tests of engines run every level that the CPU has, and no other one.
    for level in Level::ALL.into_iter().filter(|level| !level.is_available()) {
        skip::note("this CPU has no such level", &format!("level {level}"));
    }
    println!("{}", skip::last_line());
}
