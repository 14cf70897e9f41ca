//! Typed `u32` names for the parts of a function, which print the way the text form writes them.
//!
//! ```text
//! v3      a value            inst7   an instruction
//! block1  a list of insts    t0      a table of rows
//! ```

use std::fmt;
use std::marker::PhantomData;
use std::num::NonZeroU32;
use std::ops::{Index, IndexMut};

use smallvec::SmallVec;

use crate::watch;

/// A typed index: the key of a [`Store`].
pub trait Entity: Copy + Eq {
    /// The entity with this index.
    fn new(index: usize) -> Self;
    /// The position of this entity in its store.
    fn index(self) -> usize;
}

/// One and an index: a name that may be missing takes four bytes, as one that is there.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub(crate) struct OneAndIndex(NonZeroU32);

impl OneAndIndex {
    /// For this index.
    pub(crate) fn of(index: usize) -> Self {
        let number = u32::try_from(index).ok().and_then(|index| NonZeroU32::MIN.checked_add(index));
        Self(number.expect("limits::MAX_VALUES keeps every index far below 2^32"))
    }

    /// The index.
    pub(crate) const fn index(self) -> usize {
        (self.0.get() - 1) as usize
    }
}

macro_rules! entity {
    ($(#[$doc:meta])* $name:ident, $prefix:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(OneAndIndex);

        impl Entity for $name {
            fn new(index: usize) -> Self {
                Self(OneAndIndex::of(index))
            }
            fn index(self) -> usize {
                self.0.index()
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($prefix, "{}"), self.index())
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(self, f)
            }
        }
    };
}

entity!(
    /// An SSA value: computed once, by one instruction or bound by one block.
    Value, "v"
);
entity!(
    /// An instruction.
    Inst, "inst"
);
entity!(
    /// A list of instructions with parameters and results: the body of the function or of a fold.
    Block, "block"
);
entity!(
    /// A table of rows: the numbers of all children that have one shape.
    Table, "t"
);

/// A short list of values: operands, results, accumulators. Up to four of them take no allocation.
pub type Values = SmallVec<[Value; 4]>;

/// What an instruction defines: one value, but for folds.
pub type Results = SmallVec<[Value; 2]>;

/// A growing array indexed by an entity.
#[derive(Clone, PartialEq, Eq)]
pub struct Store<K, V> {
    items: Vec<V>,
    key: PhantomData<K>,
}

impl<K: Entity, V> Store<K, V> {
    /// An empty store.
    #[must_use]
    pub const fn new() -> Self {
        Self { items: Vec::new(), key: PhantomData }
    }

    /// Adds an item and names it.
    pub fn push(&mut self, item: V) -> K {
        self.items.push(item);
        K::new(self.items.len() - 1)
    }

    /// Makes room for so many more items.
    pub fn reserve(&mut self, more: usize) {
        self.items.reserve(more);
    }

    /// The bytes that so many more items ask for: see [`watch::growth`].
    pub(crate) const fn growth(&self, more: usize) -> usize {
        watch::growth(&self.items, more)
    }

    /// The name that the next `push` will give.
    #[must_use]
    pub fn next_key(&self) -> K {
        K::new(self.items.len())
    }

    /// Number of items.
    #[must_use]
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether there is nothing here.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// The item, if the entity belongs to this store.
    #[must_use]
    pub fn get(&self, key: K) -> Option<&V> {
        self.items.get(key.index())
    }

    /// All names, in order.
    pub fn keys(&self) -> impl DoubleEndedIterator<Item = K> + use<K, V> {
        (0..self.items.len()).map(K::new)
    }

    /// Names and items, in order.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (K, &V)> {
        self.items.iter().enumerate().map(|(index, item)| (K::new(index), item))
    }

    /// Items, in order.
    pub fn values(&self) -> impl DoubleEndedIterator<Item = &V> {
        self.items.iter()
    }

    /// Items, in order, to be changed.
    pub fn values_mut(&mut self) -> impl DoubleEndedIterator<Item = &mut V> {
        self.items.iter_mut()
    }
}

impl<K: Entity, V> Default for Store<K, V> {
    fn default() -> Self {
        Self::new()
    }
}

impl<K: Entity, V> Index<K> for Store<K, V> {
    type Output = V;
    fn index(&self, key: K) -> &V {
        &self.items[key.index()]
    }
}

impl<K: Entity, V> IndexMut<K> for Store<K, V> {
    fn index_mut(&mut self, key: K) -> &mut V {
        &mut self.items[key.index()]
    }
}

impl<K: Entity, V: fmt::Debug> fmt::Debug for Store<K, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.items.iter()).finish()
    }
}
