//! From a model to a mesh in one call: four programs, a lattice over the model's support, and the mesher.
//!
//! ```text
//!   Compiled ─┬─► ranges ──────────► every box of the division: which rows matter, is there surface
//!             ├─► field kernel ────► every lattice point of a brick, once
//!             ├─► gradient kernel ─► every vertex, a few times, to pull it onto the surface
//!             └─► full kernel ─────► every vertex, once: normal and attributes
//! ```

mod blocks;
mod kernels;

use jbt_model::diagnostic::Diagnostics;
use std::time::{Duration, Instant};

use jbt_ir::memory::NoMemory;
use jbt_ir::watch::{self, Stopped};
use jbt_model::check::CheckedTree;

use crate::boxes::Box3;
use crate::compiled::{Compiled, Preparation};
use crate::compiler::Compiler;
use crate::counter::Counters;
use crate::error::{Classified, CompileError, ErrorKind, EvalError};
use crate::job::{Hook, Job, JobError};
use crate::kernel::Engine;
use crate::mesh::{self, Lattice, LatticeError, Mesh, MeshError, MeshReport};
use crate::prune::PruneCounters;
use crate::support::{NoBox, around};

pub(crate) use kernels::Kernels;

/// How fine a lattice is.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Fineness {
    /// The edge of a cell, in units of the model. Greater than zero.
    Cell(f64),
    /// Cells along the longest side of the region. At least 1.
    Resolution(usize),
}

impl Default for Fineness {
    /// 128 cells along the longest side.
    fn default() -> Self {
        Self::Resolution(128)
    }
}

/// What to mesh of a model, and how finely.
///
/// ```
/// use jbt::text::{Options, parse};
/// use jbt::{Compiler, Polygonize};
/// let model = parse(b"jbt 1 point { surface_radius 1 }", &Options::default()).unwrap();
/// let tree = model.check().unwrap();
/// let made = Polygonize::default().mesh(&Compiler::new(), &tree).run().unwrap();
/// assert!(made.report.closed);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Polygonize {
    /// The box to mesh, in the world (a plain box, not a [`Region`](crate::Region)); `None` is the model's
    /// support, grown a little.
    pub region: Option<Box3<f64>>,
    /// How fine.
    pub fineness: Fineness,
    /// Whether to look at every edge to say that the mesh is closed: see [`mesh::Options::verify`].
    pub verify: bool,
    /// Whether to search for parts that are thinner than a cell: see [`mesh::ThinReport`]. It takes a few
    /// hundredths of the time as a rule, and changes nothing of the mesh.
    pub thin_parts: bool,
    /// Whether vertices go to edges and corners of the surface: where something decides, as in a union, a
    /// mirror or a formula's `max`. Normals and attributes are split there: see
    /// [`Mesh::creases`](mesh::Mesh::creases). It changes nothing of a smooth model.
    pub sharp: bool,
}

impl Default for Polygonize {
    /// The model's support at the default fineness, not verified; thin parts are searched for, edges are
    /// sharp.
    fn default() -> Self {
        Self { region: None, fineness: Fineness::default(), verify: false, thin_parts: true, sharp: true }
    }
}

/// A mesh, and what it took.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Polygonized {
    /// The mesh.
    pub mesh: Mesh,
    /// Whether it is closed, and the evaluations by kind.
    pub report: MeshReport,
    /// Where the field was asked, in coordinates about the [origin](Mesh::origin) of the mesh.
    pub lattice: Lattice,
    /// What ran the kernels.
    pub engine: Engine,
    /// What was evaluated and what was not, stage by stage.
    pub counters: MeshCounters,
    /// Distances to skeletons that were computed for the mesh, in all stages.
    pub primitive_evaluations: u64,
    /// Time to lower and compile the kernels, as far as they were not there yet.
    pub compile_time: Duration,
}

/// What the stages of a mesh evaluated, and what they did not have to.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshCounters {
    /// Dividing: boxes, and ranges of distances to skeletons over them.
    pub division: PruneCounters,
    /// The field at lattice points, and where jumps are looked for.
    pub lattice: Counters,
    /// Field and gradient, to pull vertices.
    pub pulls: Counters,
    /// Everything, at vertices.
    pub vertices: Counters,
    /// Distances that all points of the lattice would take with all rows: what an evaluator does that knows
    /// nothing.
    pub dense_evaluations: u64,
    /// Those of them that were not computed because the range of a box said that no surface is in it, though
    /// some rows reach it.
    pub avoided_by_interval: u64,
    /// Those that were not computed because a row does not reach a box, or does not decide there.
    pub avoided_by_support: u64,
    /// Distances that were computed in the search for thin parts.
    pub thin: u64,
    /// Ranges of distances that were computed there.
    pub thin_intervals: u64,
}

impl MeshCounters {
    /// Distances that the points of the lattice and the vertices took.
    fn primitive_evaluations(&self) -> u64 {
        [self.lattice, self.pulls, self.vertices].iter().map(|stage| stage.primitive_evaluations).sum()
    }

    fn add(&mut self, other: &Self) {
        self.division.boxes += other.division.boxes;
        self.division.interval_evaluations += other.division.interval_evaluations;
        self.lattice.add(&other.lattice);
        self.pulls.add(&other.pulls);
        self.vertices.add(&other.vertices);
        let sums = [
            (&mut self.dense_evaluations, other.dense_evaluations),
            (&mut self.avoided_by_interval, other.avoided_by_interval),
            (&mut self.avoided_by_support, other.avoided_by_support),
            (&mut self.thin, other.thin),
            (&mut self.thin_intervals, other.thin_intervals),
        ];
        for (sum, more) in sums {
            *sum += more;
        }
    }

    fn new(kernels: &Kernels, report: &MeshReport, lattice: &Lattice) -> Self {
        let [field, pulls, vertices] = kernels.counters();
        let points = lattice.points().iter().fold(1_u64, |all, &points| all.saturating_mul(points as u64));
        let dense = points.saturating_mul(kernels.evaluations_per_point());
        let avoided = dense.saturating_sub(field.primitive_evaluations);
        // A point on the far side of a box that was dropped may have been sampled for its neighbour: so not
        // more than what is left.
        let by_interval = report.evaluations_spared.min(avoided);
        Self {
            division: kernels.pruned(),
            lattice: field,
            pulls,
            vertices,
            dense_evaluations: dense,
            avoided_by_interval: by_interval,
            avoided_by_support: avoided - by_interval,
            thin: 0,
            thin_intervals: 0,
        }
    }
}

impl Polygonized {
    /// The mesh as the first part of one.
    fn into_part(mut self, name: &str) -> Result<Self, Stopped> {
        let made = std::mem::take(&mut self.mesh);
        self.mesh = Mesh { origin: made.origin, orientation: made.orientation, ..Mesh::default() };
        self.mesh.add_part(name, made, &self.lattice, &watch::go_on)?;
        Ok(self)
    }

    /// Adds another part.
    fn add_part(&mut self, name: &str, other: Self) -> Result<(), Stopped> {
        self.mesh.add_part(name, other.mesh, &self.lattice, &watch::go_on)?;
        self.report.add(other.report);
        self.counters.add(&other.counters);
        self.primitive_evaluations += other.primitive_evaluations;
        self.compile_time += other.compile_time;
        Ok(())
    }
}

/// Why there is no mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PolygonizeError {
    /// The model's field is zero everywhere.
    #[error("the model is empty: its field is zero everywhere")]
    Empty,
    /// The model's field may differ from zero arbitrarily far away, and no region was given.
    #[error("the model is unbounded: its mesh needs a region")]
    Unbounded,
    /// Blocks of a model of several parts: its mesh is not that of one field.
    #[error("the model has parts: blocks are of one solid, so each part is to be meshed by itself")]
    Parts,
    /// The lattice is impossible or beyond a limit.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The model could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// The mesher stopped.
    #[error(transparent)]
    Mesh(#[from] MeshError<EvalError>),
}

impl JobError for PolygonizeError {
    fn told(self) -> Self {
        if self.kind() == ErrorKind::Cancelled { MeshError::Cancelled.into() } else { self }
    }
}

impl From<NoMemory> for PolygonizeError {
    fn from(error: NoMemory) -> Self {
        Self::Mesh(error.into())
    }
}

impl From<Stopped> for PolygonizeError {
    fn from(_: Stopped) -> Self {
        MeshError::Cancelled.into()
    }
}

impl Classified for PolygonizeError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Empty | Self::Parts => ErrorKind::Model,
            Self::Unbounded => ErrorKind::Unbounded,
            Self::Lattice(error) => error.kind(),
            Self::Compile(error) => error.kind(),
            Self::Mesh(error) => error.kind(),
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        if let Self::Compile(error) = self { error.diagnostics() } else { None }
    }
}

impl Polygonize {
    /// The region to mesh, in the world.
    ///
    /// # Errors
    /// No region was given, and the model's support is empty or unbounded.
    pub fn region(&self, tree: &CheckedTree) -> Result<Box3<f64>, PolygonizeError> {
        let local = self.local_region(tree)?;
        Ok(self.region.unwrap_or_else(|| local.map(|corner| tree.origin().world(corner))))
    }

    /// The region in local coordinates.
    fn local_region(&self, tree: &CheckedTree) -> Result<Box3<f64>, PolygonizeError> {
        match self.region {
            Some(region) => Ok(region.map(|corner| tree.origin().local(corner))),
            None => around(tree).map_err(|reason| match reason {
                NoBox::Empty => PolygonizeError::Empty,
                NoBox::Unbounded => PolygonizeError::Unbounded,
            }),
        }
    }

    /// The lattice over the region, in coordinates about the model's [origin](CheckedTree::origin).
    ///
    /// # Errors
    /// Those of [`boxes`](Self::region), and a lattice that cannot be or is beyond a limit.
    pub fn lattice(&self, tree: &CheckedTree) -> Result<Lattice, PolygonizeError> {
        let Box3 { low, high } = self.local_region(tree)?;
        Ok(match self.fineness {
            Fineness::Cell(cell) => Lattice::covering(low, high, cell)?,
            Fineness::Resolution(cells) => Lattice::with_resolution(low, high, cells)?,
        })
    }

    /// The mesh of a model of which nothing else is asked: see [`with`](Self::with).
    ///
    /// # Errors
    /// See [`PolygonizeError`].
    pub fn mesh<'a>(
        &self,
        compiler: &'a Compiler,
        tree: &'a CheckedTree,
    ) -> Job<'a, Polygonized, PolygonizeError> {
        let settings = *self;
        Job::new(move |hook| settings.mesh_parts(&compiler.compile(tree), hook))
    }

    /// The mesh of a compiled model. Parts are meshed by themselves, over one lattice, and are
    /// [parts](Mesh::parts) of the mesh.
    ///
    /// # Errors
    /// See [`PolygonizeError`].
    pub fn with<'a>(&self, compiled: &'a Compiled) -> Job<'a, Polygonized, PolygonizeError> {
        let settings = *self;
        Job::new(move |hook| settings.mesh_parts(compiled, hook))
    }

    /// The mesh of a compiled model over a lattice, in coordinates about the model's
    /// [origin](Compiled::origin). Region and fineness are not asked.
    ///
    /// # Errors
    /// See [`PolygonizeError`].
    pub fn over<'a>(
        &self,
        compiled: &'a Compiled,
        lattice: &'a Lattice,
    ) -> Job<'a, Polygonized, PolygonizeError> {
        let settings = *self;
        Job::new(move |hook| settings.mesh_over(compiled, lattice.clone(), hook))
    }

    /// How the mesher is asked.
    pub(crate) fn options(&self, tree: &CheckedTree) -> mesh::Options {
        mesh::Options {
            iso: tree.iso() as f32,
            verify: self.verify,
            thin_parts: self.thin_parts,
            sharp: self.sharp,
            ..mesh::Options::default()
        }
    }

    /// The mesh of all parts over one lattice; that of the whole, if there are none.
    fn mesh_parts(&self, compiled: &Compiled, hook: Hook<'_>) -> Result<Polygonized, PolygonizeError> {
        let tree = compiled.tree();
        let lattice = self.lattice(tree)?;
        let parts = tree.parts();
        let mut all: Option<Polygonized> = None;
        for (index, part) in parts.iter().enumerate() {
            let mut share = |at: f32| hook((index as f32 + at) / parts.len() as f32);
            let part_tree = compiled.compiler().compile(&tree.part(index));
            let made = self.mesh_over(&part_tree, lattice.clone(), &mut share)?;
            match &mut all {
                Some(all) => all.add_part(part.name, made)?,
                None => all = Some(made.into_part(part.name)?),
            }
        }
        match all {
            Some(all) => Ok(all),
            None => self.mesh_over(compiled, lattice, hook),
        }
    }

    fn mesh_over(
        &self,
        compiled: &Compiled,
        lattice: Lattice,
        hook: Hook<'_>,
    ) -> Result<Polygonized, PolygonizeError> {
        let tree = compiled.tree();
        if !hook(0.0) {
            return Err(MeshError::Cancelled.into());
        }
        let start = Instant::now();
        let preparation = Preparation::new(compiled);
        let kernels = Kernels::of_cells(&preparation)?;
        let mut compile_time = start.elapsed();
        let prepare = || {
            let start = Instant::now();
            kernels.prepare_vertices(&preparation, self.sharp)?;
            compile_time += start.elapsed();
            Ok::<_, PolygonizeError>(())
        };
        let options = self.options(tree);
        let mut counters = MeshCounters::default();
        let meshed = |report: &MeshReport| counters = MeshCounters::new(&kernels, report, &lattice);
        let (mut mesh, mut report) =
            mesh::extract_hooked(&kernels, &lattice, &options, hook, (prepare, meshed))?;
        counters.thin = kernels.counters().into_iter().map(|done| done.primitive_evaluations).sum::<u64>()
            - counters.primitive_evaluations();
        counters.thin_intervals =
            kernels.pruned().interval_evaluations - counters.division.interval_evaluations;
        mesh.origin = tree.origin().point();
        mesh.orientation = tree.orientation();
        for near in report.thin.iter_mut().flat_map(|thin| &mut thin.near) {
            *near = tree.origin().world(*near);
        }
        Ok(Polygonized {
            mesh,
            counters,
            report,
            lattice,
            engine: kernels.engine(),
            primitive_evaluations: counters.primitive_evaluations(),
            compile_time,
        })
    }
}

#[cfg(test)]
mod tests {
    use jbt_testkit::scene::tree;

    use super::*;

    #[test]
    fn the_default_region_is_the_support_and_a_little_more() {
        let tree = tree("jbt 1 translate (1 2 3) { point { radius 2 } }");
        let Box3 { low, high } = Polygonize::default().region(&tree).unwrap();
        for axis in 0..3 {
            let centre = [1.0, 2.0, 3.0][axis];
            assert!(low[axis] < centre - 2.0 && low[axis] > centre - 2.1, "{low:?}");
            assert!(high[axis] > centre + 2.0 && high[axis] < centre + 2.1, "{high:?}");
        }
        assert_eq!(Polygonize::default().lattice(&tree).unwrap().cells(), [128; 3]);
    }

    #[test]
    fn an_empty_model_says_so_unless_a_region_is_given() {
        let tree = tree("jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }");
        assert!(matches!(Polygonize::default().region(&tree), Err(PolygonizeError::Empty)));
        let here = Polygonize {
            region: Some(Box3::new([0.0; 3], [1.0; 3])),
            fineness: Fineness::Resolution(4),
            verify: true,
            ..Polygonize::default()
        };
        let made = here.mesh(&Compiler::for_engine(Engine::Scalar), &tree).run().unwrap();
        assert!(made.mesh.triangles.is_empty() && made.report.closed);
        // A range tells that there is nothing: no point is asked.
        assert_eq!(made.primitive_evaluations, 0);
    }

    /// Vertices on edges are the same for bricks of any size, though they look into the cells around theirs.
    #[test]
    fn edges_have_the_same_bits_for_bricks_of_any_size() {
        let tree = tree(
            "jbt 1 rotate axis (1 2 3) degrees 31 { difference {
                union {
                    expression within (-2 -2 -2) to (2 2 2) { 0.5 + 0.8 - max(abs(x), abs(y), abs(z)) }
                    color (1 0 0) { within (-0.4 -0.4 0) to (0.4 0.4 1.3) { point { radius 9 } } }
                }
                translate (0.9 0.2 0) { point { radius 1 } }
            } }",
        );
        let settings = Polygonize { fineness: Fineness::Cell(0.07), sharp: true, ..Polygonize::default() };
        let kernels = Kernels::new(&Compiler::for_engine(Engine::Lanes).compile(&tree), true).unwrap();
        let lattice = settings.lattice(&tree).unwrap();
        let made = |brick: usize| {
            let options = mesh::Options { brick: Some(brick), ..settings.options(&tree) };
            mesh::extract(&kernels, &lattice, &options).run().unwrap()
        };
        let (first, report) = made(2);
        assert!(report.sharp_vertices > 500 && report.closed);
        assert!(!first.creases.corners.is_empty());
        for brick in [4, 8, 16, 32] {
            let (mesh, again) = made(brick);
            assert!(mesh == first, "{brick}");
            assert_eq!(again.sharp_vertices, report.sharp_vertices);
        }
    }

    /// A sphere of radius 1: every vertex lies on it, and the volume is near 4 pi / 3.
    #[test]
    fn a_point_becomes_a_sphere() {
        let tree = tree("jbt 1 point { surface_radius 1 }");
        let settings = Polygonize { fineness: Fineness::Cell(0.1), ..Polygonize::default() };
        let made = settings.mesh(&Compiler::for_engine(Engine::Lanes), &tree).run().unwrap();
        assert!(made.report.closed);
        let length = |p: &[f32; 3]| p.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt();
        assert!(made.mesh.positions.iter().all(|p| (length(p) - 1.0).abs() < 1e-5));
        let corner = |v: u32| made.mesh.positions[v as usize].map(f64::from);
        let volume: f64 = made
            .mesh
            .triangles
            .iter()
            .map(|t| {
                let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = t.map(corner);
                (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0
            })
            .sum();
        assert!((volume / (4.0 / 3.0 * std::f64::consts::PI) - 1.0).abs() < 0.01, "{volume}");
    }
}
