//! The live contour.

use jbt_model::check::CheckedTree;
use jbt_model::query::Query;

use super::model::{LastModel, ModelState};
use crate::compiler::Compiler;
use crate::contour::{Contour, ContourLattice, Detail, KeptContour, Plane, Rectangle, SliceError, Slicer};
use crate::debug::brief_debug;
use crate::error::CompileError;
use crate::job::{Hook, Job};

/// What a live contour looks at.
#[derive(Clone, PartialEq, Debug)]
pub struct LiveSection {
    /// The plane.
    pub plane: Plane,
    /// With attributes, the contour has them.
    pub query: Query,
    /// The rectangle of the plane. `None`: that of the model's support ([`Slicer::rectangle`]), and it grows
    /// with the model.
    pub rectangle: Option<Rectangle>,
    /// How finely. The squares of a quadtree are not kept.
    pub detail: Detail,
}

impl Default for LiveSection {
    /// The field in the plane z = 0, where the model is.
    fn default() -> Self {
        Self { plane: Plane::default(), query: Query::FIELD, rectangle: None, detail: Detail::default() }
    }
}

/// What an edit has changed of a live contour.
#[derive(Clone, PartialEq, Debug, Default)]
#[non_exhaustive]
pub struct ContourChange {
    /// The smallest squares of the division in which the contour is another one, each from its lowest corner
    /// to its highest one, in coordinates of the plane from the [origin](Contour::origin): row by row from
    /// below.
    pub squares: Vec<[[f32; 2]; 2]>,
}

impl ContourChange {
    /// Whether the contour is as it was; its lattice may have grown.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.squares.is_empty()
    }
}

/// A contour that follows the edits of its model: after each of them it is the contour of the edited model,
/// and the field is evaluated only where it has changed.
///
/// ```
/// use jbt::build::{param, point};
/// use jbt::live::LiveSection;
/// use jbt::{Compiler, LiveContour, Model};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let tree = Model::new(point([0, 0, 0], 1) + point([6, 0, 0], param("bulge", 0.6))).check()?;
/// let mut live = LiveContour::new(&Compiler::new(), &tree, &LiveSection::default()).run()?;
/// assert_eq!(live.contour().loops.len(), 2);
///
/// let change = live.set(&[("bulge", 0.7)]).run()?; // the first ball is left alone
/// assert!(!change.is_empty() && change.squares.iter().all(|square| square[0][0] > 4.0));
///
/// // The contour that a full run makes, to the bit.
/// let full = live.slicer().contour_over(live.lattice(), &LiveSection::default().detail).run()?;
/// assert_eq!(live.contour().positions, full.positions);
/// # Ok(())
/// # }
/// ```
///
/// The lattice is that of the first model. Where a later model reaches beyond it, and no
/// [rectangle](LiveSection::rectangle) was given, it grows; its points keep their coordinates. It never
/// shrinks.
///
/// # Cost
///
/// The field is evaluated where supports of changed rows reach, before or after
/// ([`Pruner::edit`](crate::Pruner::edit)); all of the contour's segments are linked anew. A change of shape
/// that is not an edit of rows, or a lattice that grows, evaluates everything.
pub struct LiveContour {
    section: LiveSection,
    model: LastModel,
    tree: CheckedTree,
    slicer: Slicer,
    kept: KeptContour,
    contour: Contour,
}

brief_debug!(LiveContour, "LiveContour", this: plane = this.section.plane, loops = this.contour.loops.len());

impl LiveContour {
    /// The contour of a model, to be followed.
    ///
    /// # Errors
    /// See [`SliceError`].
    pub fn new<'a>(
        compiler: &'a Compiler,
        model: impl Into<ModelState<'a>>,
        section: &LiveSection,
    ) -> Job<'a, Self, SliceError> {
        let (model, section) = (model.into(), section.clone());
        Job::new(move |hook| {
            let mut last = LastModel::default();
            let tree = last.check(model)?;
            let compiled = compiler.clone().for_edits().compile(&tree);
            let slicer = Slicer::of(&compiled, &section.plane, section.query)?;
            let rectangle = section.rectangle.map_or_else(|| slicer.rectangle(), Ok)?;
            let lattice = slicer.lattice(&rectangle, section.detail.fineness)?;
            let mut kept = KeptContour::new(&lattice, &section.detail)?;
            let (contour, _) = kept.commit(kept.renewal(&slicer, (&section.detail, None), hook)?, &slicer);
            Ok(Self { section, model: last, tree, slicer, kept, contour })
        })
    }

    /// Sets parameters of the model: see [`CheckedTree::with_parameters`]. Parameters that are not named keep
    /// their values.
    ///
    /// # Errors
    /// See [`SliceError`]; the contour, and its model, stay as they were. A wrong value is a
    /// [`SliceError::Compile`] with the diagnostics.
    pub fn set<'a>(&'a mut self, parameters: &'a [(&'a str, f64)]) -> Job<'a, ContourChange, SliceError> {
        Job::new(move |hook| {
            let tree = self.tree.with_parameters(parameters).map_err(CompileError::from)?;
            self.follow(tree, hook)
        })
    }

    /// Takes another model, usually an edited one. Its coordinates count from the
    /// [origin](CheckedTree::origin) of the first model.
    ///
    /// # Errors
    /// See [`SliceError`]; the contour, and its model, stay as they were. A model without a field is no
    /// error: its contour is empty.
    pub fn replace<'a>(&'a mut self, model: impl Into<ModelState<'a>>) -> Job<'a, ContourChange, SliceError> {
        let model = model.into();
        Job::new(move |hook| {
            let tree = self.model.check(model)?;
            self.follow(tree, hook)
        })
    }

    fn follow(&mut self, tree: CheckedTree, hook: Hook<'_>) -> Result<ContourChange, SliceError> {
        let tree = tree.with_origin(self.tree.origin());
        let slicer = self.slicer.updated(&tree)?;
        let lattice = self.lattice_for(&slicer)?;
        let has_grown = lattice != *self.lattice();
        let detail = &self.section.detail;
        let mut grown = has_grown.then(|| self.kept.grown(&lattice));
        let edit = if has_grown { None } else { slicer.edit(&self.slicer) };
        let kept = grown.as_ref().unwrap_or(&self.kept);
        let renewal = kept.renewal(&slicer, (detail, edit), hook)?;
        let kept = grown.as_mut().unwrap_or(&mut self.kept);
        let (contour, squares) = kept.commit(renewal, &slicer);
        if let Some(grown) = grown {
            self.kept = grown;
        }
        (self.tree, self.slicer, self.contour) = (tree, slicer, contour);
        Ok(ContourChange { squares })
    }

    /// The lattice, grown to where a model reaches beyond it.
    fn lattice_for(&self, slicer: &Slicer) -> Result<ContourLattice, SliceError> {
        if self.section.rectangle.is_some() {
            return Ok(self.lattice().clone());
        }
        match slicer.rectangle() {
            Ok(rectangle) => slicer.grown(self.lattice(), &rectangle),
            Err(SliceError::Empty) => Ok(self.lattice().clone()),
            Err(error) => Err(error),
        }
    }

    /// The contour as it is now: that of a full run over the [lattice](Self::lattice)
    /// ([`Slicer::contour_over`]), to the bit. It has no [levels](Contour::levels) and no
    /// [squares](Contour::squares).
    #[must_use]
    pub fn contour(&self) -> &Contour {
        &self.contour
    }

    /// The lattice as it is now.
    #[must_use]
    pub fn lattice(&self) -> &ContourLattice {
        self.kept.lattice()
    }

    /// The model as it is now.
    #[must_use]
    pub fn tree(&self) -> &CheckedTree {
        &self.tree
    }

    /// The slicer of the model as it is now: for images of the same plane.
    #[must_use]
    pub fn slicer(&self) -> &Slicer {
        &self.slicer
    }
}
