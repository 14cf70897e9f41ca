//! Vertices on edges and corners of the surface.
//!
//! ```text
//!         A decides                 m  the mean of the crossings cuts the edge off
//!     ----x-----.  <- v             v  the point that is nearest to the planes of the crossings:
//!               |                      q(p) = sum (n_e . (p - x_e))^2           (Kobbelt et al. 2001,
//!          m    x  B decides                                                     Ju et al. 2002)
//!               |
//! ```
//!
//! A crossing tells which operands decide there, by the *signature* of the field, and the normal. So an edge
//! is where signatures of one sheet differ, and normals of different signatures are 25 degrees apart; where
//! the field jumps, it is an edge by the normals alone. A smooth field has no signatures, and keeps its
//! vertices to the bit.
//!
//! ```text
//! probe    each crossed edge of the brick: nearly its crossing, with normal and signature        (probe)
//! chosen   cells with one sheet, whose crossings differ, or may do
//! look     their crossings, halved to the end, seen from the end where their side decides, so that
//!          edges of the solid along lattice planes have a side                                   (probe)
//! leaning  where the field jumps, normals by crossings beside them                              (leaning)
//! aim      the point or the line that is nearest to the planes                                   (quadric)
//! place    in the cell, or a little beyond: an edge may poke through a side of its cell
//!          and have no point in it                                                               (place)
//! refine   where no side jumps, aim again with planes close by: sides are curved                 (refine)
//! keep     if the field is nearer to the iso-value than at the mean; at a jump, if the surface is there
//! sides    for each signature: the mean normal, the mean attributes, and the crossings
//! ```

mod candidate;
mod crossing;
mod leaning;
mod place;
mod probe;
mod quadric;
mod refine;

use super::super::area::unit;
use super::super::cell;
use super::super::field::Field;
use super::batch::{Done, VertexBatch, VertexSource};
use super::sheet::{Sheet, Start};
use super::side::{CutVertex, SharpVertex};

use candidate::Candidate;

impl VertexBatch {
    /// Moves vertices to edges and corners.
    pub(super) fn sharpen<F: Field>(
        &mut self,
        source: &VertexSource<'_, F>,
        brick: usize,
    ) -> Result<Done, F::Error> {
        let (region, iso) = (&source.regions[brick], source.options.iso);
        self.crossed.clear(source.bricks.table_len());
        let sheets = self.lone_sheets(source, brick);
        let probes = probe::probe(source.field, region, iso, &mut self.crossed)?;
        let mut gradient_evaluations = probes.asked;
        let chosen: Vec<&Sheet> = sheets
            .iter()
            .filter(|sheet| self.jumped.contains(&sheet.start.vertex) || probes.differ(sheet))
            .collect();
        if chosen.is_empty() {
            return Ok(Done { gradient_evaluations, ..Done::default() });
        }
        let edges: Vec<u32> = chosen.iter().flat_map(|sheet| sheet.numbers()).copied().collect();
        self.crossed.finish(source.field, region, iso, &edges)?;
        let (found, asked) = probe::look(source.field, region, iso, (&chosen, &self.crossed))?;
        gradient_evaluations += asked;
        let mut candidates: Vec<Candidate<'_>> = chosen
            .iter()
            .zip(found)
            .filter_map(|(sheet, crossings)| Candidate::new(sheet, crossings?))
            .collect();
        let wide = place::place(source, brick, self, &mut candidates)?;
        let region = wide.as_ref().unwrap_or(region);
        gradient_evaluations += refine::refine(source.field, region, iso, &mut candidates)?;
        candidates = place::nearer(source.field, (region, source.bricks), iso, candidates)?;
        let sharp = self.put(source, brick, &candidates)?;
        Ok(Done { gradient_evaluations, sharp, ..Done::default() })
    }

    /// The sheets of cells that have one, and no face that was flipped.
    fn lone_sheets<F: Field>(&mut self, source: &VertexSource<'_, F>, brick: usize) -> Vec<Sheet> {
        let cells = source.crossings.of(brick);
        let mut sheets = Vec::new();
        for (index, cell) in cells.iter().enumerate() {
            let next = cells.get(index + 1).map_or(self.count, |next| next.vertex as usize);
            let vertex = cell.vertex as usize;
            if next != vertex + 1 || cell.flips != 0 || cell::sheets(cell.signs, 0).count() > 1 {
                continue;
            }
            let start = Start { vertex, bounds: self.bounds(vertex) };
            let corners = &self.corners(source.bricks, cell);
            sheets.push(Sheet::new(source.bricks, brick, (cell, 0), start, corners, &mut self.crossed));
        }
        sheets
    }

    /// Puts vertices to their places, with the normals and attributes of their sides.
    fn put<F: Field>(
        &mut self,
        source: &VertexSource<'_, F>,
        brick: usize,
        candidates: &[Candidate<'_>],
    ) -> Result<Vec<SharpVertex>, F::Error> {
        let points: Vec<[f32; 3]> =
            candidates.iter().flat_map(|one| &one.crossings).map(|crossing| crossing.seen).collect();
        let count = points.len();
        if count == 0 {
            return Ok(Vec::new());
        }
        let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<f32>>());
        let (mut values, mut gradient) = (vec![0.0; count], [0; 3].map(|_| vec![0.0; count]));
        let channels = self.attributes.len() / self.count;
        let mut attributes = vec![0.0; channels * count];
        let mut planes: Vec<&mut [f32]> = attributes.chunks_exact_mut(count).collect();
        let slopes = gradient.each_mut().map(Vec::as_mut_slice);
        source.field.all(&source.regions[brick], &x, &y, &z, &mut values, slopes, &mut planes)?;
        let (mut first, mut sharp) = (0, Vec::new());
        for one in candidates {
            let of = |channel: usize, crossing: usize| attributes[channel * count + first + crossing];
            let sides = one.sides(channels, &of);
            let vertex = one.sheet.start.vertex;
            let mut sum = [0.0; 3];
            for side in &sides {
                sum.iter_mut().zip(side.normal).for_each(|(sum, n)| *sum += f64::from(n));
            }
            let normal = unit(sum).unwrap_or(sides[0].normal);
            let widest = (1..sides.len()).fold(0, |best, side| {
                let edges = |side: usize| sides[side].edges.count_ones();
                if edges(side) > edges(best) { side } else { best }
            });
            let slope = self.gradient.each_ref().map(|plane| -f64::from(plane[vertex]));
            let cut = CutVertex {
                position: self.points.each_ref().map(|plane| plane[vertex]),
                normal: unit(slope).unwrap_or(normal),
            };
            for (axis, along) in normal.into_iter().enumerate() {
                self.points[axis][vertex] = one.position[axis];
                self.gradient[axis][vertex] = -along;
            }
            let planes = self.attributes.chunks_exact_mut(self.count);
            planes.zip(&sides[widest].attributes).for_each(|(plane, &value)| plane[vertex] = value);
            sharp.push(SharpVertex {
                vertex: vertex as u32,
                placed: one.position,
                size: one.sheet.size,
                sides,
                cut,
            });
            first += one.crossings.len();
        }
        Ok(sharp)
    }
}
