//! Parts of models for other processes: the shape of the whole model, and the rows that reach a box.
//!
//! ```text
//!  whole model ──RowSource──┬─► ModelShape   programs without numbers               once
//!                           └─► ModelRows    the rows that reach a box, ascending   for each box
//!                                   │ bytes
//!  another process                  ▼
//!  ModelShape + ModelRows ──from_rows──► ModelPart ──► MeshBlock, evaluators, samples in the box
//! ```
//!
//! A part compiles the very programs of the whole model, from their text. No tree is pruned and lowered
//! again, so in its box a part has the bits of the whole: rows that do not reach the box change none, and the
//! order of the others stays. What is shipped is plain bytes with a version; whatever an engine follows is
//! checked when it is read, as a stranger's file is.
//!
//! A model from other sources has the same shape if its programs are equal: particles that only some machine
//! has are lowered there, and [`RowSource::rows`] of them are rows of the whole, if their shapes are
//! [equal](ModelShape::eq).

mod error;
mod header;
mod part;
mod prune_bytes;
mod rows;
mod shape;

pub use crate::bytes::FormatError;
pub use error::RemoteError;
pub use part::{ModelPart, from_rows};
pub use rows::{ModelRows, RowSource};
pub use shape::ModelShape;
