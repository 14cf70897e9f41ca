//! Rays to where they hit the surface.

use jbt::trace::{Ray, TraceError, Tracer};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use crate::error::{Refusal, refused};
use crate::mesh::matrix;
use crate::model::{PyModel, query_of};
use crate::work::CallEffort;

/// Rays that one thread follows at once.
const PACKET: usize = 1024;

/// Where rays hit: the index of the ray, t, the position in the world, whether it enters, and all answers.
#[derive(Default)]
struct HitTable {
    ray: Vec<u64>,
    t: Vec<f64>,
    position: Vec<[f64; 3]>,
    entering: Vec<bool>,
    answers: Vec<f32>,
}

/// Follows a packet of rays, whose first one has a number.
fn follow(
    tracer: &Tracer,
    first: usize,
    rays: &[Ray],
    tolerance: f64,
    all: bool,
) -> Result<HitTable, TraceError> {
    let hits = if all { tracer.all_of(rays, tolerance)? } else { tracer.first_of(rays, tolerance)? };
    let mut table = HitTable::default();
    for ray in 0..rays.len() {
        for hit in hits.of(ray) {
            table.ray.push((first + ray) as u64);
            table.t.push(hits.t[hit]);
            table.position.push(hits.positions.world(hit));
            table.entering.push(hits.entering[hit]);
            table.answers.extend(hits.samples.planes().iter().map(|plane| plane[hit]));
        }
    }
    Ok(table)
}

#[pymethods]
impl PyModel {
    /// The hits of rays, by ray and then by t: a dictionary of arrays.
    #[allow(clippy::too_many_arguments)]
    fn trace<'py>(
        &self,
        py: Python<'py>,
        origins: PyReadonlyArray2<'py, f64>,
        directions: PyReadonlyArray2<'py, f64>,
        span: [f64; 2],
        tolerance: f64,
        all: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (origins, directions) = (origins.as_array(), directions.as_array());
        if origins.shape() != directions.shape() || origins.ncols() != 3 {
            return Err(refused(format!(
                "directions: expected the shape of origins, {:?}, got {:?}",
                origins.shape(),
                directions.shape()
            )));
        }
        let rays: Vec<Ray> = origins
            .outer_iter()
            .zip(directions.outer_iter())
            .map(|(o, d)| Ray { origin: [o[0], o[1], o[2]], direction: [d[0], d[1], d[2]], span })
            .collect();
        let compiled = self.compiled(py, None)?;
        let effort = CallEffort { py, threads, progress: None };
        let (tables, layout) = effort.run(move |watch| -> Result<_, Refusal> {
            let tracer = Tracer::of(&compiled, query_of(true, true))?;
            let packets: Vec<&[Ray]> = rays.chunks(PACKET).collect();
            let each = |(index, packet): (usize, &&[Ray])| {
                if watch.is_stopped() {
                    return Ok(HitTable::default());
                }
                follow(&tracer, index * PACKET, packet, tolerance, all)
            };
            let tables = packets.par_iter().enumerate().map(each).collect::<Result<Vec<_>, _>>()?;
            Ok((tables, tracer.layout().clone()))
        })?;
        let mut whole = HitTable::default();
        for table in tables {
            whole.ray.extend(table.ray);
            whole.t.extend(table.t);
            whole.position.extend(table.position);
            whole.entering.extend(table.entering);
            whole.answers.extend(table.answers);
        }
        let dict = PyDict::new(py);
        dict.set_item("ray", numpy::PyArray1::from_vec(py, whole.ray))?;
        dict.set_item("t", numpy::PyArray1::from_vec(py, whole.t))?;
        dict.set_item("position", matrix(py, 3, whole.position.into_flattened())?)?;
        dict.set_item("entering", numpy::PyArray1::from_vec(py, whole.entering))?;
        dict.set_item("answers", matrix(py, layout.names().len(), whole.answers)?)?;
        let groups: Vec<(String, usize, usize)> =
            layout.attributes().map(|(name, first, width)| (name.to_owned(), first, width)).collect();
        dict.set_item("groups", groups)?;
        Ok(dict)
    }
}
