//! The live mesh.

use jbt_model::check::CheckedTree;

use super::change::{BrickRanges, BrickUpdate, LiveChange};
use super::model::{LastModel, ModelState};
use crate::boxes::Box3;
use crate::compiled::Compiled;
use crate::compiler::Compiler;
use crate::debug::brief_debug;
use crate::divide::Edit;
use crate::error::CompileError;
use crate::job::{Hook, Job};
use crate::mesh::local::{BrickChanges, BrickMesh, BrickPlace};
use crate::mesh::{Lattice, Mesh, Options};
use crate::polygonize::{Kernels, Polygonize, PolygonizeError};
use crate::support::{NoBox, around};
use crate::touched::Touched;

/// A mesh that follows the edits of its model: after each of them it is the mesh of the edited model, made in
/// time that grows with what has changed.
///
/// ```
/// use jbt::build::{param, point};
/// use jbt::{Compiler, LiveMesh, Model, Polygonize};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = |x: f64| point([x, 0.0, 0.0], 1).color([1.0, 0.5, 0.0]);
/// let tree = Model::new(ball(0.0) + ball(3.0) + point([6, 0, 0], param("bulge", 0.6))).check()?;
/// let mut live = LiveMesh::new(&Compiler::new(), &tree, Polygonize::default()).run()?;
///
/// let change = live.set(&[("bulge", 0.7)]).run()?; // the two balls are left alone
/// for brick in change.added.iter().chain(change.changed.iter().map(|changed| &changed.brick)) {
///     let positions = &live.buffers().positions[brick.vertices.clone()]; // to the GPU
///     assert!(positions.iter().all(|[x, ..]| *x > 4.0));
/// }
/// let moved = Model::new(ball(0.0) + ball(3.1) + point([6, 0, 0], param("bulge", 0.7))).check()?;
/// assert!(!live.replace(&moved).run()?.is_empty());
///
/// // The mesh that a full run makes, to the bit.
/// let full = Polygonize::default().over(&Compiler::new().compile(&moved), live.lattice()).run()?;
/// assert_eq!(live.compact(), full.mesh);
/// # Ok(())
/// # }
/// ```
///
/// The lattice has the cells, and the [origin](CheckedTree::origin), that the first model gave it. With a
/// [region](Polygonize::region) it stays; without one it grows to where a model reaches beyond it
/// ([`Lattice::grown`]), and never shrinks. Parts that are [thinner than a cell](crate::mesh::ThinReport) are
/// not searched for, and [`Polygonize::verify`] is not asked: a full run says both.
///
/// # Buffers
///
/// [`buffers`](Self::buffers) are made for a GPU. Each brick of the lattice has a range of vertices and one
/// of triangles, with room to grow, and keeps them until it has outgrown them. Triangles that belong to no
/// brick are `[0, 0, 0]`, which draws nothing, so the whole buffer may be drawn at once. A [`LiveChange`]
/// says which ranges an edit has written.
///
/// # Cost
///
/// Bricks are made anew where the field or an attribute differs: where the supports of changed rows reach,
/// before or after ([`Pruner::edit`](crate::Pruner::edit)). A change of shape that is not an edit of rows, as
/// another operator, makes all bricks anew; only those with another content are told. The lists of rows are
/// read as a whole.
pub struct LiveMesh {
    settings: Polygonize,
    model: LastModel,
    compiled: Compiled,
    kernels: Kernels,
    mesh: BrickMesh,
}

brief_debug!(LiveMesh, "LiveMesh", this: bricks = this.mesh.len());

/// An edited model, before its bricks are made.
struct EditedModel {
    compiled: Compiled,
    kernels: Kernels,
    lattice: Lattice,
    options: Options,
    touched: Option<Touched<3>>,
}

impl LiveMesh {
    /// The mesh of a model, to be followed.
    ///
    /// # Errors
    /// See [`PolygonizeError`].
    pub fn new<'a>(
        compiler: &'a Compiler,
        model: impl Into<ModelState<'a>>,
        settings: Polygonize,
    ) -> Job<'a, Self, PolygonizeError> {
        let model = model.into();
        Job::new(move |hook| {
            let mut last = LastModel::default();
            let compiled = compiler.clone().for_edits().compile(&last.check(model)?);
            Ok(Self { model: last, ..Self::start(&compiled, settings, hook)? })
        })
    }

    /// As [`new`](Self::new), of a compiled model.
    ///
    /// # Errors
    /// See [`PolygonizeError`].
    pub fn of(compiled: &Compiled, settings: Polygonize) -> Job<'_, Self, PolygonizeError> {
        Job::new(move |hook| Self::start(compiled, settings, hook))
    }

    fn start(compiled: &Compiled, settings: Polygonize, hook: Hook<'_>) -> Result<Self, PolygonizeError> {
        let lattice = settings.lattice(compiled.tree())?;
        let kernels = Kernels::new(compiled, settings.sharp)?;
        let mut mesh =
            BrickMesh::new(lattice.clone(), compiled.origin().point(), compiled.tree().orientation());
        let options = settings.options(compiled.tree());
        let renewal = mesh.renewal(&kernels, &lattice, (&options, None), hook)?;
        mesh.commit(renewal);
        Ok(Self { settings, model: LastModel::default(), compiled: compiled.clone(), kernels, mesh })
    }

    /// Sets parameters of the model: see [`CheckedTree::with_parameters`]. Parameters that are not named keep
    /// their values.
    ///
    /// # Errors
    /// See [`PolygonizeError`]; the mesh, and its model, stay as they were. A wrong value is a
    /// [`PolygonizeError::Compile`] with the diagnostics.
    pub fn set<'a>(&'a mut self, parameters: &'a [(&'a str, f64)]) -> Job<'a, LiveChange, PolygonizeError> {
        Job::new(move |hook| {
            let tree = self.tree().with_parameters(parameters).map_err(CompileError::from)?;
            self.follow(&tree, hook)
        })
    }

    /// Takes another model, usually an edited one. Its coordinates count from the
    /// [origin](CheckedTree::origin) of the first model.
    ///
    /// # Errors
    /// See [`PolygonizeError`]; the mesh, and its model, stay as they were. A model without a field is no
    /// error: its mesh is empty.
    pub fn replace<'a>(
        &'a mut self,
        model: impl Into<ModelState<'a>>,
    ) -> Job<'a, LiveChange, PolygonizeError> {
        let model = model.into();
        Job::new(move |hook| {
            let tree = self.model.check(model)?;
            self.follow(&tree, hook)
        })
    }

    fn follow(&mut self, tree: &CheckedTree, hook: Hook<'_>) -> Result<LiveChange, PolygonizeError> {
        let EditedModel { compiled, kernels, lattice, options, touched } = self.edited(tree)?;
        let renewal = self.mesh.renewal(&kernels, &lattice, (&options, touched), hook)?;
        let before = self.lengths();
        let attributes = self.layout();
        let changes = self.mesh.commit(renewal);
        (self.compiled, self.kernels) = (compiled, kernels);
        let (grown, relaid) = (self.lengths() != before, self.layout() != attributes);
        Ok(LiveChange { grown, relaid, ..self.told(changes) })
    }

    /// An edited model, and the bricks that it touches.
    fn edited(&self, tree: &CheckedTree) -> Result<EditedModel, PolygonizeError> {
        let compiled = self.compiled.updated(tree);
        let lattice = self.lattice_for(compiled.tree())?;
        let kernels = Kernels::new(&compiled, self.settings.sharp)?;
        let options = self.settings.options(compiled.tree());
        let same_iso = options.iso.to_bits() == self.settings.options(self.tree()).iso.to_bits();
        let touched = match kernels.edit(&self.kernels) {
            Edit::Boxes(boxes) if same_iso => {
                // A vertex on an edge may look into the cells around its brick.
                let reach = if kernels.is_sharp() { lattice.spacing() as f32 } else { 0.0 };
                let boxes: Vec<Box3> = boxes
                    .iter()
                    .map(|Box3 { low, high }| Box3::new(low.map(|c| c - reach), high.map(|c| c + reach)))
                    .collect();
                self.mesh.touched(&lattice, &boxes)
            }
            Edit::Boxes(_) | Edit::Everywhere => None,
        };
        Ok(EditedModel { compiled, kernels, lattice, options, touched })
    }

    /// The lattice, grown to where a model reaches beyond it.
    fn lattice_for(&self, tree: &CheckedTree) -> Result<Lattice, PolygonizeError> {
        let lattice = self.lattice();
        if self.settings.region.is_some() {
            return Ok(lattice.clone());
        }
        match around(tree) {
            Ok(bounds) => Ok(lattice.grown(bounds.low, bounds.high)?),
            Err(NoBox::Empty) => Ok(lattice.clone()),
            Err(NoBox::Unbounded) => Err(PolygonizeError::Unbounded),
        }
    }

    /// The lengths of the buffers.
    fn lengths(&self) -> [usize; 2] {
        [self.buffers().positions.len(), self.buffers().triangles.len()]
    }

    fn layout(&self) -> Vec<(String, usize)> {
        self.buffers().attributes.iter().map(|attribute| (attribute.name.clone(), attribute.width)).collect()
    }

    /// The ranges of what has changed.
    fn told(&self, changes: BrickChanges) -> LiveChange {
        let removed = changes.removed.into_iter();
        let removed =
            removed.map(|(place, [vertices, triangles])| BrickRanges { place, vertices, triangles });
        let changed = changes.changed.into_iter().map(|(place, change)| BrickUpdate {
            brick: self.ranges(place),
            positions: change.positions,
            normals: change.normals,
            attributes: change.attributes,
            triangles: change.triangles,
        });
        LiveChange {
            removed: removed.collect(),
            added: changes.added.into_iter().map(|place| self.ranges(place)).collect(),
            changed: changed.collect(),
            cleared: changes.cleared,
            ..LiveChange::default()
        }
    }

    fn ranges(&self, place: BrickPlace) -> BrickRanges {
        let [vertices, triangles] = self.mesh.ranges(place);
        BrickRanges { place, vertices, triangles }
    }

    /// The model as it is now.
    #[must_use]
    pub fn tree(&self) -> &CheckedTree {
        self.compiled.tree()
    }

    /// The compiled model as it is now: for pictures, slices and rays beside the mesh.
    #[must_use]
    pub fn compiled(&self) -> &Compiled {
        &self.compiled
    }

    /// The lattice as it is now, in coordinates about the model's origin. A full run over it
    /// ([`Polygonize::over`]) makes the same mesh.
    #[must_use]
    pub fn lattice(&self) -> &Lattice {
        self.mesh.lattice()
    }

    /// The vertices and triangles of all bricks, each in its ranges. What is between them is arbitrary:
    /// vertices that no triangle has, and triangles `[0, 0, 0]`.
    #[must_use]
    pub fn buffers(&self) -> &Mesh {
        self.mesh.buffers()
    }

    /// All bricks that the surface crosses, in Morton order.
    pub fn bricks(&self) -> impl Iterator<Item = BrickRanges> {
        self.mesh.places().into_iter().map(|place| self.ranges(place))
    }

    /// The mesh without gaps: that of a full run over the [lattice](Self::lattice), to the bit.
    ///
    /// Cost: a copy of the mesh.
    #[must_use]
    pub fn compact(&self) -> Mesh {
        self.mesh.compact()
    }
}
