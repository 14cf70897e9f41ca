//! From blobs to a mesh: everything from the model on counts, code included. Ours and the limit make normals
//! and colours as well; the peers make positions alone. Nobody checks what was made; ours once more, with its
//! search for parts that are thinner than a cell.

use jbt::walk::walk;
use jbt::{Box3, CheckedTree, Compiler, Polygonize, Polygonized};
use serde_json::json;

use super::contest::{Contest, Contestant};
use super::options::Options;
use super::oracle::{Oracle, Tolerance};
use super::report::ResultRow;
use crate::limit;
use crate::model::{self, Blob, ISO};
use crate::peers::Threads;
use crate::peers::fidget::{FidgetModel, Gate, JitFunction};
use crate::peers::splashsurf::{Division, Particles};

/// Cells along an axis of the lattice over [-1, 1]^3.
const CELLS: usize = 128;
/// The depth of an octree with as many.
const DEPTH: u8 = 7;
/// How far from `iso` the field may be at a vertex, on average and at most. Its gradients are up to 50.
const VERTICES_OFF: (f64, f64) = (2e-3, 1e-1);
/// How many vertices are checked, of few blobs and of many: the oracle meets every blob for each of them.
const MOST_CHECKED: usize = 500;
const FEWEST_CHECKED: usize = 20;
/// How many blobs the oracle may meet, as long as enough vertices are checked.
const MOST_WALKED: usize = 10_000_000;
/// How much the numbers of triangles of two meshes of one surface may differ.
const TRIANGLES_OFF: f64 = 0.01;

/// What is meshed, and on which threads.
pub(super) struct MeshTask {
    blobs: Vec<Blob>,
    tree: CheckedTree,
    cells: usize,
    pool: rayon::ThreadPool,
}

impl MeshTask {
    fn new(blobs: Vec<Blob>, cells: usize, options: Options) -> Self {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build();
        let tree = model::cloud(&blobs);
        Self { blobs, tree, cells, pool: pool.expect("threads can be made") }
    }

    pub(super) fn ours(&self, thin_parts: bool) -> Polygonized {
        self.ours_in(&self.pool, thin_parts)
    }

    /// As [`ours`](Self::ours), on other threads.
    pub(super) fn ours_in(&self, pool: &rayon::ThreadPool, thin_parts: bool) -> Polygonized {
        let region = Some(Box3::new([-1.0; 3], [1.0; 3]));
        let polygonize = Polygonize {
            region,
            fineness: jbt::Fineness::Resolution(self.cells),
            verify: false,
            thin_parts,
            sharp: true,
        };
        let run = || polygonize.mesh(&Compiler::new(), &self.tree).run();
        pool.install(run).expect("blobs have a mesh")
    }

    pub(super) fn limit(&self) -> limit::mesh::Mesh {
        let cell = 2.0 / self.cells as f32;
        let lattice = limit::mesh::Lattice { origin: [-1.0; 3], cell, counts: [self.cells + 1; 3] };
        self.pool.install(|| limit::mesh::mesh(&self.blobs, &lattice, ISO))
    }

    /// Whether the field at vertices is the iso-value, as far as a step or two of Newton's can bring it
    /// there.
    pub(super) fn check(&self, positions: &[[f32; 3]]) -> Result<(), String> {
        let checked = (MOST_WALKED / self.blobs.len()).clamp(FEWEST_CHECKED, MOST_CHECKED);
        let step = positions.len().div_ceil(checked).max(1);
        let offs: Vec<f64> = (positions.iter().step_by(step))
            .map(|position| (walk(&self.tree, position.map(f64::from)).field - f64::from(ISO)).abs())
            .collect();
        let mean = offs.iter().sum::<f64>() / offs.len() as f64;
        let most = offs.iter().fold(0.0, |most: f64, &off| most.max(off));
        if mean <= VERTICES_OFF.0 && most <= VERTICES_OFF.1 {
            return Ok(());
        }
        Err(format!(
            "vertices are off the surface: the field is {mean:.1e} from the iso-value, {most:.1e} at worst"
        ))
    }

    pub(super) fn primitives(&self) -> usize {
        self.blobs.len()
    }

    /// Points of the lattice.
    pub(super) fn points(&self) -> usize {
        (self.cells + 1).pow(3)
    }

    /// Enters splashsurf, which computes another surface of the same particles, with the same reach and
    /// cells.
    pub(super) fn enter_splashsurf<'a>(&'a self, contest: &mut Contest<'a>, options: Options) {
        let cell = 2.0 / self.cells as f32;
        for (division, form) in divisions(self.blobs.len()) {
            let peer = Particles::new(&self.blobs, cell, division, peer_threads(options));
            let mesh = move || peer.as_ref().map_err(Clone::clone).and_then(Particles::mesh);
            contest.enter_checked(Contestant::Splashsurf, form, mesh, |made| match made {
                Ok(made) if made.triangles > 0 => Ok(()),
                Ok(_) => Err("no triangles".to_owned()),
                Err(error) => Err(error.to_string()),
            });
        }
    }

    /// Enters ours and the limit, which make one mesh. Returns the number of triangles and the engine.
    fn enter<'a>(&'a self, contest: &mut Contest<'a>) -> (usize, &'static str) {
        let (mut triangles, mut engine) = (0, "");
        let see = |ours: &Polygonized| {
            (triangles, engine) = (ours.mesh.triangles.len(), ours.engine.name());
            self.check(&ours.mesh.positions)
        };
        contest.enter_checked(Contestant::Ours, "", || self.ours(false), see);
        contest.enter_checked(
            Contestant::Searched,
            "",
            || self.ours(true),
            |searched| self.check(&searched.mesh.positions),
        );
        let see = |limit: &limit::mesh::Mesh| {
            let others = limit.triangles.len();
            if (others as f64 - triangles as f64).abs() > TRIANGLES_OFF * triangles as f64 {
                return Err(format!("{others} triangles, ours are {triangles}"));
            }
            self.check(&limit.positions)
        };
        contest.enter_checked(Contestant::Limit, "", || self.limit(), see);
        (triangles, engine)
    }

    fn row(
        &self,
        case: &'static str,
        contest: Contest<'_>,
        (triangles, engine): (usize, &str),
        options: Options,
    ) -> ResultRow {
        ResultRow {
            case,
            of: "",
            primitives: self.primitives(),
            points: self.points(),
            unit: "run",
            units: 1.0,
            standings: contest.run(options.effort()),
            extra: vec![
                ("engine", json!(engine)),
                ("limit_level", json!(limit::level())),
                ("threads", json!(options.threads)),
                ("triangles", json!(triangles)),
            ],
        }
    }
}

pub(super) fn peer_threads(options: Options) -> Threads {
    if options.threads == 1 { Threads::One } else { Threads::All }
}

/// Blobs in a cube, on the lattice of their case.
pub(super) fn task_of_blobs(count: usize, options: Options) -> MeshTask {
    MeshTask::new(model::blobs(count, 1), CELLS, options)
}

/// A ball of particles of one size, each of which about 30 others reach: their fields end about six cells
/// from them.
pub(super) fn task_of_particles(count: usize, options: Options) -> MeshTask {
    let cells = if count > 100_000 { 319 } else { 83 };
    MeshTask::new(model::particles(count, 1), cells, options)
}

/// Blobs in a cube.
pub(super) fn blobs(count: usize, case: &'static str, options: Options) -> Vec<ResultRow> {
    let task = task_of_blobs(count, options);
    let mut contest = Contest::new();
    let made = task.enter(&mut contest);
    if !(options.quick && count > 1_000) {
        let points = model::cube(2_000, 2);
        let oracle = Oracle::new(&task.tree, &points);
        for gate in gates(count, options) {
            let mut field = vec![f32::NAN; points.len()];
            FidgetModel::<JitFunction>::new(&task.blobs, *gate).field().eval(points.planes(), &mut field);
            let checked = oracle.check(&[&field], Tolerance::EXACT);
            contest.enter(Contestant::FidgetJit, gate.name(), checked, || {
                FidgetModel::<JitFunction>::new(&task.blobs, *gate).mesh(DEPTH, peer_threads(options))
            });
        }
    }
    vec![task.row(case, contest, made, options)]
}

/// The gates worth trying: `if` has always been the fastest, and without one nothing falls away, which takes
/// minutes for thousands of blobs.
fn gates(count: usize, options: Options) -> &'static [Gate] {
    match count {
        _ if options.quick => &[Gate::If],
        0..=100 => &Gate::ALL,
        _ => &[Gate::If, Gate::And],
    }
}

/// A ball of particles to a mesh, with splashsurf beside.
pub(super) fn particles(options: Options) -> Vec<ResultRow> {
    let counts: &[usize] = if options.quick { &[10_000] } else { &[10_000, 583_000] };
    let row = |&count: &usize| {
        let task = task_of_particles(count, options);
        let mut contest = Contest::new();
        let made = task.enter(&mut contest);
        task.enter_splashsurf(&mut contest, options);
        task.row("particles", contest, made, options)
    };
    counts.iter().map(row).collect()
}

/// The ways of splashsurf that are worth trying: one grid for everything takes minutes for many particles.
fn divisions(count: usize) -> Vec<(Division, &'static str)> {
    let subdomains = (Division::Subdomains, "subdomains");
    if count > 100_000 { vec![subdomains] } else { vec![(Division::None, "one grid"), subdomains] }
}

/// Blobs of constant overlap in number, on one lattice: what a blob more costs.
pub(super) fn scaling(options: Options) -> Vec<ResultRow> {
    let counts: &[usize] =
        if options.quick { &[1_000, 10_000] } else { &[1_000, 10_000, 100_000, 1_000_000] };
    let row = |&count: &usize| {
        let task = MeshTask::new(model::blobs(count, 1), 2 * CELLS, options);
        let mut contest = Contest::new();
        let made = task.enter(&mut contest);
        task.row("mesh-scaling", contest, made, options)
    };
    counts.iter().map(row).collect()
}
