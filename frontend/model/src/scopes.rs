//! Building a tree by a stack of scopes, as programs do that write a scene while they run.
//!
//! ```
//! use jbt_model::builder::point;
//! use jbt_model::combine::{Sum, Union};
//! use jbt_model::scopes::Scopes;
//!
//! let mut scene = Scopes::new(Union {});
//! scene.begin(Sum {});
//! for (y, color) in [(0.4, [1.0, 0.0, 0.0]), (-0.4, [0.0, 0.0, 1.0])] {
//!     scene.begin(Sum {}).attribute("color", &color).translate([0.0, y, 0.0]);
//!     scene.primitive(point([0.0; 3], 1.0));
//!     scene.end()?;
//! }
//! scene.end()?;
//! let peanut = scene.finish()?;
//! # Ok::<(), jbt_model::scopes::ScopeError>(())
//! ```

use crate::attribute::Precedence;
use crate::combine::Combinator;
use crate::map::MapKind;
use crate::number::{Number, Vector};
use crate::tree::Tree;
use crate::word::normalized;
use crate::written::{FieldNumber, Written, WrittenAttribute};

/// A tree under construction: a stack of open scopes.
///
/// Attributes and maps hold for what follows them, up to the end of their scope. A map that comes later acts
/// first, as if written further inside; of attributes with one name the later one counts.
#[derive(Debug)]
pub struct Scopes {
    root: BegunScope,
    open: Vec<BegunScope>,
}

/// One `begin`: its children so far, and what holds for the next one.
#[derive(Debug)]
struct BegunScope {
    combinator: Combinator,
    children: Vec<Tree>,
    around: Vec<Written>,
}

/// `begin` and `end` do not match.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum ScopeError {
    /// An `end` without a `begin`.
    #[error("there is no open scope to end")]
    NothingOpen,
    /// The scene is finished with this many scopes open.
    #[error("{0} scopes are still open")]
    StillOpen(usize),
}

impl BegunScope {
    fn new(combinator: Combinator) -> Self {
        Self { combinator, children: Vec::new(), around: Vec::new() }
    }

    fn add(&mut self, tree: Tree) {
        let wrap = |tree, around: &Written| Tree::new(around.clone(), vec![tree]);
        self.children.push(self.around.iter().rev().fold(tree, wrap));
    }

    fn close(self) -> Tree {
        Tree::combine(self.combinator, self.children)
    }
}

impl Scopes {
    /// An empty scene, whose parts will be combined so.
    #[must_use]
    pub fn new(combinator: impl Into<Combinator>) -> Self {
        Self { root: BegunScope::new(combinator.into()), open: Vec::new() }
    }

    fn scope(&mut self) -> &mut BegunScope {
        self.open.last_mut().unwrap_or(&mut self.root)
    }

    /// Opens a scope: what follows is combined so.
    pub fn begin(&mut self, combinator: impl Into<Combinator>) -> &mut Self {
        self.open.push(BegunScope::new(combinator.into()));
        self
    }

    /// Closes the innermost scope; its node becomes a child of the one around it.
    ///
    /// # Errors
    ///
    /// If no scope is open.
    pub fn end(&mut self) -> Result<&mut Self, ScopeError> {
        let closed = self.open.pop().ok_or(ScopeError::NothingOpen)?.close();
        self.scope().add(closed);
        Ok(self)
    }

    /// An attribute for what follows.
    pub fn attribute<T: Into<Number> + Clone>(&mut self, name: &str, values: &[T]) -> &mut Self {
        let value = WrittenAttribute::Numbers(values.iter().cloned().map(Into::into).collect());
        let written =
            Written::Attribute { name: normalized(name).into(), value, precedence: Precedence::Nearest };
        self.scope().around.push(written);
        self
    }

    /// A shift of what follows.
    pub fn translate(&mut self, by: impl Into<Vector>) -> &mut Self {
        let written =
            Written::Map { map: MapKind::Translate, fields: vec![FieldNumber::Vector(by.into().0)] };
        self.scope().around.push(written);
        self
    }

    /// Any map for what follows: an affine one or a warp.
    pub fn map(&mut self, map: impl Into<Written>) -> &mut Self {
        self.scope().around.push(map.into());
        self
    }

    /// Adds a primitive, or any tree.
    pub fn primitive(&mut self, tree: Tree) -> &mut Self {
        self.scope().add(tree);
        self
    }

    /// The tree.
    ///
    /// # Errors
    ///
    /// If a scope is still open.
    pub fn finish(self) -> Result<Tree, ScopeError> {
        if self.open.is_empty() { Ok(self.root.close()) } else { Err(ScopeError::StillOpen(self.open.len())) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::point;
    use crate::combine::{Sum, Union};

    #[test]
    fn scopes_nest_and_state_ends_with_them() {
        let ball = || point([0.0; 3], 1.0);
        let mut scene = Scopes::new(Union {});
        scene.begin(Sum {}).attribute("color", &[1.0, 0.0, 0.0]).translate([0.0, 1.0, 0.0]);
        scene.primitive(ball()).translate([2.0, 0.0, 0.0]).primitive(ball());
        scene.end().unwrap().primitive(ball());
        let moved = ball().translate([0.0, 1.0, 0.0]).color([1.0, 0.0, 0.0]);
        let twice = ball().translate([2.0, 0.0, 0.0]).translate([0.0, 1.0, 0.0]).color([1.0, 0.0, 0.0]);
        assert_eq!(scene.finish().unwrap(), (moved + twice) | ball());
    }

    #[test]
    fn unbalanced_scopes_are_errors() {
        let mut scene = Scopes::new(Sum {});
        assert_eq!(scene.end().map(|_| ()), Err(ScopeError::NothingOpen));
        scene.begin(Sum {}).begin(Union {});
        let error = scene.finish().unwrap_err();
        assert_eq!(
            (error, error.to_string().as_str()),
            (ScopeError::StillOpen(2), "2 scopes are still open")
        );
    }
}
