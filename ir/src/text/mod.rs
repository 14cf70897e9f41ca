//! The text form of a function: what `println!("{function}")` shows and [`parse`] reads.
//!
//! The head of [`crate::function`] has an example. One line is one instruction, and indentation is for people
//! only:
//!
//! ```text
//! file     = "function" string names "->" names "{"  table*  block  "}"
//! names    = "(" [name ("," name)*] ")"                          a name is x, color.r or "any string"
//! table    = "table" tN string names ["in" tN] ["slots" "(" numbers ")"]
//! block    = blockN ["(" defined ")"] ":"  inst*  "yield" [vN ("," vN)*]
//! inst     = [defined "="] kind [origin]
//! defined  = vN [":" type] ("," vN [":" type])*
//! kind     = "input" (name | index)  |  "const" number  |  "bits" 0xHEX  |  "column" tN "." (name | index)
//!          | op vN ("," vN)*
//!          | "fold" tN kind rule "(" values ")" block            its origin stands at the end of the line of the colon
//! origin   = "@" [slot "."] part                                 left out where it is `@shared`
//! comment  = ";" up to the end of the line
//! ```
//!
//! * A value is written with its type only where that is not the one that its definition gives: the result of
//!   the op's row, bits for `bits`, real for everything else. A broken function can so be written down, and
//!   the verifier tested.
//! * An input or column is written with its index where its name is taken by an earlier one.
//! * A block that is named without a colon is a mention of it only. Only a broken function has these.
//! * Numbers are the shortest decimals that read back as the same f32; `nan` is the encoding 0x7fc00000, any
//!   other NaN is written `nan:0x7fc00001`.
//!
//! The numbers of values, blocks and tables are kept by printing and parsing; instructions are numbered anew,
//! in the order of the text.

mod lex;
mod line;
mod parse;
mod print;

pub use line::ParseError;
pub use parse::parse;
pub use print::annotated;
