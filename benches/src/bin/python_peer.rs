//! What `python/benches` compares with: the same work, asked from Rust. Prints seconds.
//!
//! ```text
//! python_peer points SCENE COUNT               everything at the points of `evaluation.py`, in planes, on all threads
//! python_peer particles FILE RADIUS CELLS      from places (f64, three for each) to a mesh, as `million.py`
//! ```

use std::error::Error;
use std::time::Instant;

use jbt::build::particles as particles_of;
use jbt::{Compiler, Evaluator, Fineness, Model, Points, Polygonize, Query, Scene};

/// How far the points of `evaluation.py` go on along each axis, as parts of the whole.
const STEPS: [f64; 3] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let seconds = match words.as_slice() {
        ["points", scene, count] => points(scene, count.parse()?)?,
        ["particles", file, radius, cells] => particles(file, radius.parse()?, cells.parse()?)?,
        _ => return Err("see the head of the source for the arguments".into()),
    };
    #[allow(clippy::print_stdout)]
    {
        println!("{seconds}");
    }
    Ok(())
}

/// Seconds for the answers of a scene at so many points, the second time.
fn points(scene: &str, count: usize) -> Result<f64, Box<dyn Error>> {
    let evaluator = Evaluator::compile(&Scene::load(scene)?.check()?, Query::ALL)?;
    let plane = |step: f64| -> Vec<f32> {
        (0..count).map(|index| ((index as f64 * step).fract() * 3.0 - 1.5) as f32).collect()
    };
    let [x, y, z] = STEPS.map(plane);
    let points = Points::from_planes(x, y, z)?;
    let mut samples = evaluator.samples();
    evaluator.par_eval(&points, &mut samples)?;
    let start = Instant::now();
    evaluator.par_eval(&points, &mut samples)?;
    Ok(start.elapsed().as_secs_f64())
}

/// Seconds from the places of particles to a mesh.
fn particles(file: &str, radius: f64, cells: usize) -> Result<f64, Box<dyn Error>> {
    let bytes = std::fs::read(file)?;
    let numbers: Vec<f64> = bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let start = Instant::now();
    let tree = Model::new(particles_of(numbers, radius)).check()?;
    let settings = Polygonize { fineness: Fineness::Resolution(cells), ..Polygonize::default() };
    let made = settings.mesh(&Compiler::new(), &tree).run()?;
    let seconds = start.elapsed().as_secs_f64();
    assert!(made.report.closed, "the mesh of particles is closed");
    Ok(seconds)
}
