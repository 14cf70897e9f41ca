//! Trees and what their nodes hold, for programs that read models.
//!
//! ```
//! use jbt::build::{point, segment};
//! use jbt::tree::{NodeKind, Visit};
//!
//! let ball = point([0, 0, 0], 1).color([1, 0, 0]);
//! let tree = (ball | segment([0, 0, 0], [3, 0, 0], 0.5)).translate([0, 0, 2]);
//! let mut seen = Vec::new();
//! for tree in tree.prefix(Visit::Nodes) {
//!     let node = tree.node();
//!     seen.push(match node.kind() {
//!         NodeKind::Primitive(leaf) => {
//!             let skeleton = leaf.skeleton.kind();
//!             let values = leaf.skeleton.to_fields();
//!             assert_eq!(values.len(), skeleton.fields().len());
//!             format!("{} of radius {}", skeleton.name(), leaf.radius)
//!         }
//!         NodeKind::Combine(combinator) => format!("{} of {}", combinator.name(), node.children().len()),
//!         NodeKind::Expression(_) => "a formula".to_owned(),
//!         NodeKind::Select(which) => format!("child {which}"),
//!         kind @ NodeKind::Affine(_) => format!("moved by {}", kind.rows().map_or(0.0, |rows| rows[2][3])),
//!         NodeKind::Warp(warp) => format!("{warp:?}"),
//!         NodeKind::Attribute { name, .. } => format!("with {name}"),
//!     });
//! }
//! assert_eq!(
//!     seen,
//!     ["moved by 2", "union of 2", "with color", "point of radius 1", "segment of radius 0.5"]
//! );
//! ```
//!
//! Numbers of nodes are best read by [`Skeleton::to_fields`] and its kind, and by [`NodeKind::rows`]: the
//! structures in their variants are those of
//! the compiler, in vectors of its own glam.

pub use jbt_frontend::attribute::{AttributeValue, Textured, UvMap};
pub use jbt_frontend::check::CheckedNode;
pub use jbt_frontend::combine::{Combinator, Family, SetOperation};
pub use jbt_frontend::expression::Expression;
pub use jbt_frontend::falloff::{Falloff, FalloffKind};
pub use jbt_frontend::field::{Field, FieldKind, FieldValue};
pub use jbt_frontend::member::{Lengths, Matrix, Member, Positions};
pub use jbt_frontend::skeleton::{Skeleton, SkeletonKind};
pub use jbt_frontend::texture::{Texture, TextureKind};
pub use jbt_frontend::traverse::Visit;
pub use jbt_frontend::tree::{Node, NodeKind, Primitive, Tree};
pub use jbt_frontend::warp::{Warp, WarpKind};
