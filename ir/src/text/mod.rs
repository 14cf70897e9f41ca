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
//! * A value is written with its type where the type differs from the one of its definition: the result type
//!   of the op's row, bits for `bits`, real for everything else. So an accumulator that is a mask
//!   has its type, and a broken function can be written down, to test the verifier.
//! * An input or column is written with its index where an earlier one has its name.
//! * A block name without a colon only mentions the block. Only a broken function has such mentions.
//! * Numbers are the shortest decimals that read back as the same f32; `nan` is the encoding 0x7fc00000, any
//!   other NaN is written `nan:0x7fc00001`.
//!
//! Printing and parsing keep the numbers of values, blocks and tables. Parsing numbers instructions anew, in
//! the order of the text.

mod lex;
mod line;
mod parse;
mod print;

pub use line::ParseError;
pub use parse::parse;
pub use print::annotated;
