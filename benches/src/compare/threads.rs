//! The same mesh on several threads and on one: what the threads are worth. Two at the least. And as many
//! meshes at once, on one thread each: threads that share caches, memory and a clock may have less than twice
//! the work of one, whatever they do.

use std::hint::black_box;
use std::io::sink;

use jbt::export::{self, Format};
use jbt::{CheckedTree, Compiler, Fineness, Polygonize};
use serde_json::json;

use super::contest::{Contest, Contestant};
use super::mesh::{MeshTask, task_of_blobs, task_of_particles};
use super::options::Options;
use super::picture::{octopus, pool};
use super::report::{ResultRow, rounded};
use super::unions;

/// Cells along the longest side of the octopus: as many as make a fine mesh, and as many as make 5.4 million
/// triangles.
const HERO: [usize; 2] = [400, 1_306];
/// The same with `--quick`.
const HERO_IN_SHORT: [usize; 2] = [100, 200];

/// Pools of one thread each, as many as there are threads.
struct ThreadsApart(Vec<rayon::ThreadPool>);

impl ThreadsApart {
    fn new(options: Options) -> Self {
        Self((0..options.threads).map(|_| pool(Options { threads: 1, ..options })).collect())
    }

    /// The same work by each of them at once.
    fn run<T>(&self, work: impl Fn(&rayon::ThreadPool) -> T + Sync) {
        std::thread::scope(|scope| {
            for pool in &self.0 {
                scope.spawn(|| drop(black_box(work(pool))));
            }
        });
    }
}

/// A mesh of everybody.
pub(super) fn threads(options: Options) -> Vec<ResultRow> {
    let options = Options { threads: options.threads.max(2), ..options };
    let one = Options { threads: 1, ..options };
    let [fine, finest] = if options.quick { HERO_IN_SHORT } else { HERO };
    let particles = if options.quick { 10_000 } else { 583_000 };
    let hero = octopus();
    vec![
        of_blobs("mesh-512", [options, one].map(|options| task_of_blobs(512, options)), options),
        of_blobs("particles", [options, one].map(|options| task_of_particles(particles, options)), options),
        of_spheres(options),
        of_hero("hero", &hero, fine, false, options),
        of_hero("hero to GLB", &hero, finest, true, options),
    ]
}

/// Blobs, with the limit beside on as many threads as ours.
fn of_blobs(of: &'static str, [many, one]: [MeshTask; 2], options: Options) -> ResultRow {
    let apart = ThreadsApart::new(options);
    let mut contest = Contest::new();
    let mut triangles = 0;
    let see = |made: &jbt::Polygonized| {
        triangles = made.mesh.triangles.len();
        many.check(&made.mesh.positions)
    };
    contest.enter_checked(Contestant::Ours, "", || many.ours(false), see);
    contest.enter_checked(Contestant::OneThread, "", || one.ours(false), |_| Ok(()));
    contest.enter(Contestant::Apart, "", Ok(()), || apart.run(|pool| one.ours_in(pool, false)));
    contest.enter_checked(Contestant::Limit, "", || many.limit(), |limit| many.check(&limit.positions));
    if of == "particles" {
        many.enter_splashsurf(&mut contest, options);
    }
    row(of, many.primitives(), many.points(), contest, triangles, options)
}

/// The union of 1,024 spheres.
fn of_spheres(options: Options) -> ResultRow {
    let tree = unions::primitives();
    let [many, one] = [options, Options { threads: 1, ..options }].map(pool);
    let apart = ThreadsApart::new(options);
    let mut triangles = 0;
    let mut contest = Contest::new();
    let see = |made: &jbt::Polygonized| {
        triangles = made.mesh.triangles.len();
        unions::check(&tree, made)
    };
    contest.enter_checked(Contestant::Ours, "", || unions::ours(&tree, &many), see);
    contest.enter(Contestant::OneThread, "", Ok(()), || unions::ours(&tree, &one));
    contest.enter(Contestant::Apart, "", Ok(()), || apart.run(|pool| unions::ours(&tree, pool)));
    row("spheres", unions::SPHERES, unions::POINTS, contest, triangles, options)
}

/// The octopus in so many cells along its longest side, as the command line meshes it; with a file that
/// nobody keeps, if one is wanted.
fn of_hero(
    of: &'static str,
    tree: &CheckedTree,
    cells: usize,
    is_written: bool,
    options: Options,
) -> ResultRow {
    let settings = Polygonize { fineness: Fineness::Resolution(cells), ..Polygonize::default() };
    let mesh = || {
        let made = settings.mesh(&Compiler::new(), tree).run().expect("the scene has a mesh");
        if is_written {
            export::write(&made.mesh, Format::Glb, &mut sink()).expect("the mesh is well formed");
        }
        made.mesh.triangles.len()
    };
    let [many, one] = [options, Options { threads: 1, ..options }].map(pool);
    let apart = ThreadsApart::new(options);
    let (mut contest, mut triangles) = (Contest::new(), 0);
    let see = |&made: &usize| {
        triangles = made;
        Ok(())
    };
    contest.enter_checked(Contestant::Ours, "", || many.install(mesh), see);
    contest.enter(Contestant::OneThread, "", Ok(()), || black_box(one.install(mesh)));
    contest.enter(Contestant::Apart, "", Ok(()), || apart.run(|pool| pool.install(mesh)));
    let evaluations = Compiler::new().compile(tree).evaluator(jbt::Query::FIELD);
    let primitives = evaluations.expect("the scene compiles").evaluations_per_point() as usize;
    row(of, primitives, 0, contest, triangles, options)
}

fn row(
    of: &'static str,
    primitives: usize,
    points: usize,
    contest: Contest<'_>,
    triangles: usize,
    options: Options,
) -> ResultRow {
    let standings = contest.run(options.effort());
    let mut extra = vec![("threads", json!(options.threads)), ("triangles", json!(triangles))];
    let of_one = standings.of(Contestant::OneThread).zip(standings.of(Contestant::Apart));
    if let Some((one, apart)) = of_one {
        extra.push(("ratio_machine", json!(rounded(options.threads as f64 * one.ratio(apart)))));
    }
    ResultRow { case: "threads", of, primitives, points, unit: "run", units: 1.0, standings, extra }
}
