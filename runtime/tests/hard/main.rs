//! Random scenes with walls, far from the origin, and with thin parts: their meshes are closed, their normals
//! point outwards, and their volume is that of dense sampling, unless a warning names a part that is thinner
//! than a cell.
//!
//! `JBT_HARD_SCENES` sets how many there are, 60 in short and 200 at length; the seeds begin at [`FIRST`].

#[path = "../common/mod.rs"]
mod common;
#[path = "../thin/planted.rs"]
mod planted;
mod scenes;

use common::answers;
use jbt::mesh::{Mesh, check_manifold};
use jbt::{Box3, CheckedTree, Compiler, Engine, Evaluator, Fineness, Points, Polygonize, Query};
use jbt_testkit::scene::{count, tree};
use jbt_testkit::skip::short_or_long;
use jbt_testkit::surface::{area_vector, corners, volume};
use jbt_testkit::vector::{dot, minus};
use rayon::prelude::*;
use scenes::{HALF, RESOLUTION, Scene, scene};

/// The first seed.
const FIRST: u64 = 7_000;

/// How far the volume of a mesh is from that of dense sampling, at most.
const VOLUME: f64 = 0.005;

/// Cells along each side of the dense sampling, with one point anywhere in each.
const DENSE: usize = 160;

/// A vertex whose triangles nearly cancel out, with a sum of vectors below this part of the sum of areas, is
/// a needle: it has no outside.
const NEEDLE: f64 = 0.2;

/// What became of a scene.
#[derive(Default)]
struct Found {
    /// What is wrong with it.
    faults: Vec<String>,
    has_walls: bool,
    is_far: bool,
    needles: usize,
    vertices: usize,
    /// Whether a planted part was named, if there is one.
    named: Option<bool>,
}

#[test]
fn hard_scenes_have_good_meshes() {
    let count = count("JBT_HARD_SCENES", short_or_long([60, 200]));
    let found: Vec<Found> = (0..count).into_par_iter().map(|index| judge(FIRST + index)).collect();
    let faults: Vec<&String> = found.iter().flat_map(|found| &found.faults).collect();
    assert!(faults.is_empty(), "{} faults, first {:#?}", faults.len(), &faults[..faults.len().min(8)]);
    let needles: usize = found.iter().map(|found| found.needles).sum();
    let vertices: usize = found.iter().map(|found| found.vertices).sum();
    assert!(1000 * needles < vertices, "{needles} needles among {vertices} vertices");
    let parts = found.iter().filter(|found| found.named.is_some()).count();
    let named = found.iter().filter(|found| found.named == Some(true)).count();
    assert!(20 * (parts - named) <= parts, "{named} of {parts} thin parts are named");
    // The generator makes some of each.
    if count >= 50 {
        assert!(found.iter().any(|found| found.has_walls) && found.iter().any(|found| found.is_far));
        assert!(parts > 0);
    }
}

fn judge(seed: u64) -> Found {
    let scene = scene(seed);
    let tree = tree(&scene.text);
    let low = scene.center.map(|x| x - HALF);
    let high = scene.center.map(|x| x + HALF);
    let settings = Polygonize {
        region: Some(Box3::new(low, high)),
        fineness: Fineness::Resolution(RESOLUTION),
        verify: true,
        ..Polygonize::default()
    };
    let made = settings.mesh(&Compiler::for_engine(Engine::Lanes), &tree).run().expect("it has a mesh");
    let mut found = Found {
        has_walls: scene.has_walls,
        is_far: scene.center != [0.0; 3],
        vertices: made.mesh.positions.len(),
        ..Found::default()
    };
    found.named = scene.part.as_ref().map(|part| {
        let thin = made.report.thin.as_ref().expect("thin parts are searched for");
        let middle: [f64; 3] = std::array::from_fn(|axis| scene.center[axis] + part.center[axis]);
        let reach = part.reach + 4.0 * made.lattice.spacing();
        thin.near.iter().any(|&near| dot(minus(near, middle), minus(near, middle)) <= reach * reach)
    });
    let is_named = found.named == Some(true);
    let mut fault = |what: String| found.faults.push(format!("seed {seed}: {what}\n{}", scene.text));
    if !made.report.closed || check_manifold(made.mesh.positions.len(), &made.mesh.triangles).is_err() {
        fault("the mesh is not closed".to_owned());
    }
    // A part that is named is in shreds, and so are its normals.
    let in_shreds = |vertex: usize| {
        let part = scene.part.as_ref().filter(|_| is_named);
        part.is_some_and(|part| {
            let apart = minus(minus(made.mesh.world(vertex), scene.center), part.center);
            dot(apart, apart).sqrt() <= part.reach + 2.0 * made.lattice.spacing()
        })
    };
    let (inward, needles) = normals(&made.mesh, in_shreds);
    if inward > 0 {
        fault(format!("{inward} normals point inward"));
    }
    let (meshed, sampled) =
        (volume(&made.mesh.positions, &made.mesh.triangles), dense_volume(&tree, &scene, seed));
    if (meshed / sampled - 1.0).abs() > VOLUME && !is_named {
        let half = scene.part.as_ref().map(|part| part.half);
        fault(format!(
            "the volume of the mesh is {meshed}, and {sampled} by dense sampling; thin part of {half:?}"
        ));
    }
    found.needles = needles;
    found
}

/// How many normals are more than 90 degrees off the sum of the normals of their triangles, and how many
/// vertices are needles.
fn normals(mesh: &Mesh, is_left_out: impl Fn(usize) -> bool) -> (usize, usize) {
    let mut sums = vec![([0.0_f64; 3], 0.0_f64); mesh.positions.len()];
    for &triangle in &mesh.triangles {
        let normal = area_vector(corners(&mesh.positions, triangle));
        let area = dot(normal, normal).sqrt();
        for vertex in triangle {
            let (sum, areas) = &mut sums[vertex as usize];
            (0..3).for_each(|axis| sum[axis] += normal[axis]);
            *areas += area;
        }
    }
    // At an edge of the surface triangles may be folded, and outweigh the others.
    let mut is_at_edge = vec![false; mesh.positions.len()];
    let is_on_edge = |vertex: &u32| mesh.creases.vertices.binary_search(vertex).is_ok();
    for triangle in mesh.triangles.iter().filter(|triangle| triangle.iter().any(is_on_edge)) {
        triangle.iter().for_each(|&vertex| is_at_edge[vertex as usize] = true);
    }
    let (mut inward, mut needles) = (0, 0);
    let sums = sums.into_iter().zip(&mesh.normals).enumerate().filter(|&(vertex, _)| !is_left_out(vertex));
    for (vertex, ((sum, areas), normal)) in sums {
        let is_inward = dot(sum, normal.map(f64::from)) <= 0.0;
        if dot(sum, sum).sqrt() < NEEDLE * areas || is_inward && is_at_edge[vertex] {
            needles += 1;
        } else if is_inward {
            inward += 1;
        }
    }
    (inward, needles)
}

/// One point anywhere in each cell of the region; the part of them that is inside.
fn dense_volume(tree: &CheckedTree, scene: &Scene, seed: u64) -> f64 {
    let evaluator = Compiler::for_engine(Engine::Lanes).evaluator(tree, Query::FIELD).expect("it compiles");
    let mut rng = fastrand::Rng::with_seed(seed);
    let step = 2.0 * HALF / DENSE as f64;
    let mut inside = 0_usize;
    for z in 0..DENSE {
        let mut points = evaluator.points();
        for index in 0..DENSE * DENSE {
            let cell = [index % DENSE, index / DENSE, z];
            points.push_world(
                [0, 1, 2].map(|axis| scene.center[axis] - HALF + (cell[axis] as f64 + rng.f64()) * step),
            );
        }
        inside += inside_of(&evaluator, &points, tree.iso() as f32);
    }
    inside as f64 * step.powi(3)
}

fn inside_of(evaluator: &Evaluator, points: &Points, iso: f32) -> usize {
    let samples = answers(evaluator, points);
    samples.field().iter().filter(|&&field| field >= iso).count()
}
