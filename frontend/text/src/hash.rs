//! The hash of a model by what it means: equal over runs, machines and versions of this project.
//!
//! ```text
//! hash(node)  = FNV("words and numbers of the node as printed", hash(child 0), hash(child 1), ..)
//! hash(part)  = FNV("part \"NAME\"", hash(child 0), hash(child 1), ..)
//! hash(model) = FNV("jbt hash 2", statements as printed, hash(root))
//! ```
//!
//! Names of nodes, comments, places in a text and what is shared do not count. Names of parts do, and so does
//! the order of children and of statements, and parameters with their names and defaults. The hash is FNV-1a
//! of 128 bits (Fowler, Noll and Vo; RFC 9923). It tells models apart and is no protection against those who
//! look for two with one hash. In version 1 a part was hashed as a union, and `empty` as `expression { 0 }`.

use std::collections::HashMap;
use std::fmt;

use jbt_model::model::Model;
use jbt_model::traverse::Visit;
use jbt_model::tree::Tree;

use crate::item::{ItemPlace, NodeItem, node_words, statements};

/// The hash of a model, or of a part of one: see [`hash`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct ModelHash(u128);

/// What the hash depends on besides the model. It changes when equal models would have other hashes.
pub const HASH_VERSION: u32 = 2;

impl ModelHash {
    const PRIME: u128 = (1 << 88) + 0x13b;

    /// That of nothing.
    const fn start() -> Self {
        Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(Self::PRIME);
        }
        // Ends what was added: texts that follow each other do not become one.
        self.0 = (self.0 ^ 0xff).wrapping_mul(Self::PRIME);
    }

    /// Its bits.
    #[must_use]
    pub const fn bits(self) -> u128 {
        self.0
    }
}

impl fmt::Display for ModelHash {
    /// The version and 32 hexadecimal digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{HASH_VERSION}-{:032x}", self.0)
    }
}

/// The hash of a model. Equal models have equal hashes, whatever their nodes are called and whichever of
/// them are shared; parts have equal names. It is FNV-1a of 128 bits over what nodes say when they are
/// printed; comments and places in a text do not count, parameters do.
///
/// ```
/// use jbt_text::{hash, model};
/// let [a, b, c] = ["point { radius 1 }", "# a ball\nball: point { radius 1.0 }", "point { radius 2 }"]
///     .map(|text| hash(&model(&format!("jbt 1 {text}")).unwrap()));
/// assert!(a == b && a != c);
/// assert_eq!(a.to_string(), "2-9083e2fe7d33c7f28fa414c386911c40");
/// ```
///
/// Cost: linear in the number of nodes, shared ones counted once.
#[must_use]
pub fn hash(model: &Model) -> ModelHash {
    let mut all = ModelHash::start();
    all.add(format!("jbt hash {HASH_VERSION}").as_bytes());
    statements(model).iter().for_each(|statement| all.add(statement.as_bytes()));
    all.add(&NodeHashes::new(&model.root).root.0.to_le_bytes());
    all
}

/// The hashes of all nodes below a root.
pub(crate) struct NodeHashes {
    root: ModelHash,
    /// Those of nodes that are neither root nor part, by their identities.
    nodes: HashMap<usize, ModelHash>,
    /// Those of parts.
    parts: HashMap<usize, ModelHash>,
}

impl NodeHashes {
    /// Hashes each node once.
    pub(crate) fn new(root: &Tree) -> Self {
        let mut nodes: HashMap<usize, ModelHash> = HashMap::new();
        for tree in root.postfix(Visit::Nodes) {
            let children = tree.node().children().iter().map(|child| nodes[&child.identity()]);
            let hash = of_node(&node_words(tree), children);
            nodes.insert(tree.identity(), hash);
        }
        let mut hashes = Self { root: nodes[&root.identity()], nodes, parts: HashMap::new() };
        let root = NodeItem::root(root);
        for part in root.children().filter(|child| child.place == ItemPlace::Part) {
            let hash = of_node(&part.words(), part.children().map(|child| hashes.of(child)));
            hashes.parts.insert(part.tree.identity(), hash);
        }
        hashes.root = of_node(&root.words(), root.children().map(|child| hashes.of(child)));
        hashes
    }

    /// That of a node.
    pub(crate) fn of(&self, item: NodeItem<'_>) -> ModelHash {
        match item.place {
            ItemPlace::Root => self.root,
            ItemPlace::Part => self.parts[&item.tree.identity()],
            ItemPlace::Below => self.nodes[&item.tree.identity()],
        }
    }
}

/// The hash of a node with these words, over children with these hashes.
fn of_node(words: &str, children: impl Iterator<Item = ModelHash>) -> ModelHash {
    let mut hash = ModelHash::start();
    hash.add(words.as_bytes());
    children.for_each(|child| hash.add(&child.0.to_le_bytes()));
    hash
}
