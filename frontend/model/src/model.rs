//! A model: a tree, and what its field means.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::attribute::AttributeGroup;
use crate::diagnostic::SourceText;
use crate::number::Number;
use crate::orientation::Orientation;
use crate::parameter::{Parameter, collect};
use crate::tree::{DEFAULT_ISO, Tree};

mod select;

/// A tree with the iso-value of its surface and its attribute groups. Inside means `field >= iso`.
#[derive(Clone, Debug)]
pub struct Model {
    /// The field value of the surface.
    pub iso: Number,
    /// The attribute groups; `color` is always the first.
    pub attributes: Vec<AttributeGroup>,
    /// The tree.
    pub root: Tree,
    /// The named parameters, in the order of their declarations. Those that the tree mentions and that are
    /// not here have the defaults of their first uses.
    pub parameters: Vec<Parameter>,
    /// The text that places of nodes are in, for messages; `None` if the model came from none.
    pub source: Option<SourceText>,
    /// Where its local coordinates begin, as the statement `origin` sets it; `None` leaves it to the
    /// [check](crate::check), which finds one for a model that is far away. See [`origin`](crate::origin).
    pub origin: Option<[f64; 3]>,
    /// Comments in front of the statements of its text, which a printed text has again.
    pub comments: Comments,
    /// How it stands: which axis points up, and the hand of its axes. Pictures and files ask for it.
    pub orientation: Orientation,
}

/// Comments by the words of the statement behind them: `jbt`, `iso`, `origin`, `orientation`, `param NAME`,
/// `attribute NAME`, `style NAME`, `part NAME`, `let NAME`, and `root` for the node of the model; `head` is
/// one behind `jbt 1`, and `end` one behind all. A comment is lines that begin with `#`, and empty ones.
pub type Comments = BTreeMap<String, Arc<str>>;

impl Model {
    /// The iso-value when nothing else is said.
    pub const DEFAULT_ISO: f64 = DEFAULT_ISO;

    /// A model with iso-value 1/2, the colour group alone, and the parameters that the tree mentions.
    #[must_use]
    pub fn new(root: Tree) -> Self {
        let iso = Number::from(Self::DEFAULT_ISO);
        let (parameters, _) = collect(&[], &iso, &root);
        let attributes = vec![AttributeGroup::color()];
        let orientation = Orientation::default();
        let comments = Comments::new();
        Self { iso, attributes, root, parameters, origin: None, orientation, source: None, comments }
    }

    /// The same with its local coordinates beginning at a point of the world: see [`origin`](crate::origin).
    #[must_use]
    pub fn with_origin(self, point: [f64; 3]) -> Self {
        Self { origin: Some(point), ..self }
    }

    /// The same model, of which equal subtrees are one: see [`Tree::share`].
    #[must_use]
    pub fn share(self) -> Self {
        Self { root: self.root.share(), ..self }
    }

    /// The parameters of the model: those that are declared, then those that its tree mentions besides.
    #[must_use]
    pub fn all_parameters(&self) -> Vec<Parameter> {
        collect(&self.parameters, &self.iso, &self.root).0
    }
}

impl PartialEq for Model {
    /// The same field, attributes and parameters; names, comments and places do not matter.
    fn eq(&self, other: &Self) -> bool {
        let Self { iso, attributes, root, parameters, origin, orientation, source: _, comments: _ } = self;
        *iso == other.iso
            && *attributes == other.attributes
            && *root == other.root
            && *parameters == other.parameters
            && *origin == other.origin
            && *orientation == other.orientation
    }
}
