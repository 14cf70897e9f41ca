//! Trees and what their nodes hold, for programs that read models.
//!
//! A [`Tree`] is what was written: numbers are [formulas](crate::Number) of parameters.
//!
//! ```
//! use jbt::build::{param, point, segment};
//! use jbt::tree::{NodeKind, Visit, Written};
//! use jbt::Model;
//!
//! let ball = point([0, 0, 0], param("size", 1.0)).color([1, 0, 0]);
//! let tree = (ball | segment([0, 0, 0], [3, 0, 0], 0.5)).translate([0, 0, 2]);
//! let mut seen = Vec::new();
//! for tree in tree.prefix(Visit::Nodes) {
//!     let node = tree.node();
//!     seen.push(match node.written() {
//!         Written::Primitive { skeleton, fields, .. } => {
//!             assert_eq!(fields.len(), skeleton.fields().len());
//!             skeleton.name().to_owned()
//!         }
//!         Written::Combine { combinator, .. } => format!("{} of {}", combinator.name(), node.children().len()),
//!         Written::Map { map, .. } => map.name().to_owned(),
//!         Written::Attribute { name, .. } => format!("with {name}"),
//!         other => format!("{other:?}"),
//!     });
//! }
//! assert_eq!(seen, ["translate", "union of 2", "with color", "point", "segment"]);
//!
//! // What it means, for the present values of parameters: children before parents.
//! let checked = Model::new(tree).check().unwrap();
//! let root = &checked.node(checked.root()).kind;
//! assert_eq!(root.rows().map(|rows| rows[2][3]), Some(2.0));
//! let NodeKind::Primitive(leaf) = &checked.nodes()[0].kind else { panic!("the ball is the first leaf") };
//! assert_eq!(leaf.radius, 1.0);
//! ```
//!
//! Values of nodes are best read by [`Skeleton::to_fields`] and its kind, and by [`NodeKind::rows`]: the
//! structures in their variants are those of the compiler, in vectors of its own glam.

pub use jbt_model::attribute::{AttributeValue, Precedence, Textured, UvMap};
pub use jbt_model::bounds::Bounds;
pub use jbt_model::check::{CheckedNode, DEFINED, FoundNode, OWNER};
pub use jbt_model::combine::{Combinator, CombinatorKind, SetOperation, Syntax, operators};
pub use jbt_model::constant::{ConstantValues, LARGEST_CONSTANT, LeafConstant};
pub use jbt_model::expression::Expression;
pub use jbt_model::falloff::{Falloff, FalloffKind};
pub use jbt_model::field::{Field, FieldKind, FieldValue};
pub use jbt_model::kind::{NodeKind, Primitive};
pub use jbt_model::map::MapKind;
pub use jbt_model::member::{Lengths, Matrix, Member, Positions};
pub use jbt_model::owner::LeafWays;
pub use jbt_model::particles::{NumberArray, ParticleValues, Particles, PerParticle};
pub use jbt_model::skeleton::{Skeleton, SkeletonKind};
pub use jbt_model::texture::{Texture, TextureKind};
pub use jbt_model::tour::{Tour, TourEvent, TourStep};
pub use jbt_model::traverse::Visit;
pub use jbt_model::tree::{Node, StyleUse, Tree};
pub use jbt_model::warp::{Warp, WarpKind};
pub use jbt_model::weights::{DEFAULT_WEIGHT, WEIGHT, WEIGHTS, WeightOf};
pub use jbt_model::word::normalized;
pub use jbt_model::written::{
    FieldNumber, ParticleRadius, Radius, Written, WrittenAttribute, WrittenFalloff, WrittenParticles,
    WrittenTextured, WrittenUv,
};
