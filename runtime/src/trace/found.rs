//! The results of a packet so far.

use jbt_ir::watch;

use super::hits::Hits;
use super::polish::RayBracket;
use super::ray::RayLine;
use super::target::Target;
use crate::buffer::Samples;
use crate::error::EvalError;
use crate::points::Points;
use crate::prune::Region;

/// A hit without its samples.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Record {
    pub(super) ray: u32,
    pub(super) t: f64,
    pub(super) entering: bool,
}

/// Hits in the order of discovery: the hits of one ray ascend with t.
pub(super) struct FoundHits {
    pub(super) records: Vec<Record>,
    /// The positions of the hits, by coordinates.
    pub(super) positions: [Vec<f32>; 3],
    /// The samples of the hits, plane by plane.
    pub(super) answers: Vec<Vec<f32>>,
    /// For each ray, whether it is blocked.
    pub(super) blocked: Vec<bool>,
    /// For each ray, the number of distances that were evaluated.
    pub(super) evaluations: Vec<f32>,
}

impl FoundHits {
    /// Empty results for this number of rays and planes.
    pub(super) fn new(rays: usize, planes: usize) -> Self {
        Self {
            records: Vec::new(),
            positions: Default::default(),
            answers: vec![Vec::new(); planes],
            blocked: vec![false; rays],
            evaluations: vec![0.0; rays],
        }
    }

    pub(super) fn rays(&self) -> usize {
        self.blocked.len()
    }

    /// Counts distances for a ray.
    pub(super) fn count(&mut self, ray: u32, evaluations: f32) {
        self.evaluations[ray as usize] += evaluations;
    }

    /// Records that a ray is blocked.
    pub(super) fn block(&mut self, ray: u32) {
        self.blocked[ray as usize] = true;
    }

    /// Adds hits, and evaluates everything there: all are in the region.
    pub(super) fn add(
        &mut self,
        tracer: &Target,
        region: &Region,
        lines: &[RayLine],
        brackets: &[RayBracket],
    ) -> Result<(), EvalError> {
        let planes = self.positions.iter().chain(&self.answers);
        let grown: usize = planes.map(|plane| watch::growth(plane, brackets.len())).sum();
        watch::take(watch::growth(&self.records, brackets.len()) + grown);
        let start = self.records.len();
        let each = tracer.full().evaluations_in(region) as f32;
        for bracket in brackets {
            let (line, t) = (&lines[bracket.line()], bracket.best());
            self.records.push(Record { ray: line.ray, t, entering: bracket.entering() });
            for (plane, x) in self.positions.iter_mut().zip(line.position(t)) {
                plane.push(x);
            }
            self.evaluations[line.ray as usize] += each;
        }
        let count = self.records.len();
        for plane in &mut self.answers {
            plane.resize(count, 0.0);
        }
        let points = self.positions.each_ref().map(|plane| &plane[start..]);
        let mut answers: Vec<&mut [f32]> = self.answers.iter_mut().map(|plane| &mut plane[start..]).collect();
        tracer.full().eval_region(region, points, &mut answers)
    }

    /// The hits, ordered by ray.
    pub(super) fn into_hits(self, tracer: &Target) -> Hits {
        let each = 2 * size_of::<Record>() + size_of::<f32>() * (3 + self.answers.len());
        watch::take(self.rays() * size_of::<u32>() + self.records.len() * each);
        // The number of hits is below 2^32: the limit of work ensures it.
        let mut starts = vec![0_u32; self.rays() + 1];
        for record in &self.records {
            starts[record.ray as usize + 1] += 1;
        }
        for ray in 0..self.rays() {
            starts[ray + 1] += starts[ray];
        }
        let mut order: Vec<usize> = (0..self.records.len()).collect();
        order.sort_by_key(|&index| self.records[index].ray);
        let ordered = |plane: &Vec<f32>| order.iter().map(|&index| plane[index]).collect::<Vec<f32>>();
        let [x, y, z] = self.positions.each_ref().map(ordered);
        Hits {
            starts,
            t: order.iter().map(|&index| self.records[index].t).collect(),
            entering: order.iter().map(|&index| self.records[index].entering).collect(),
            positions: Points::from_planes_about(tracer.origin, [x, y, z]),
            samples: Samples::from_planes(
                (*tracer.layout).clone(),
                self.answers.iter().map(ordered).collect(),
            ),
            evaluations: self.evaluations,
        }
    }
}
