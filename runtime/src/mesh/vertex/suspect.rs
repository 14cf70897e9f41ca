//! A second look at vertices that Newton's steps may have left off the surface.
//!
//! ```text
//! suspects = vertices off the surface by their own gradient (strays),
//!            and those whose gradient does not explain how much the field differs within their cell
//! crossed  = the edges that their sheets cross, halved until it is known which sheets jump  (bracket, sheet)
//! at a jump: the vertex is put where crossings say, and has a normal that they say          (wall, normal)
//! strays without: a crease keeps them off; they are brought onto the surface                (settle)
//! ```
//!
//! The normals of all suspects are doubtful, and so are normals far from the rise of the field in the cell:
//! they are compared with the triangles later. For a smooth surface the tests cost a few multiplications per
//! vertex.

use super::super::field::Field;
use super::super::pull::{LANES, VertexLanes, VertexPlanes, squares};
use super::again::{Again, SecondLooks, VertexTests};
use super::batch::{Done, VertexBatch, VertexSource, lane, lanes};
use super::seed::SeedGroup;
use super::settle::{Stray, VertexPlace, is_far, settle};
use super::sheet::{Sheet, Start};
use super::wall::{Wall, follow};

/// The limit of the field's spread within a cell, as a multiple of the spread that its gradient predicts. For
/// a linear field the multiple is 1.
const EXCESS: f32 = 1.5;

/// The cosine of the angle, about 30 degrees, from which on a gradient is far from the rise of the field in
/// its cell.
const ASTRAY: f32 = 0.85;

/// The tests of vertices.
#[inline(always)]
fn judge(iso: f32, group: &SeedGroup, values: &VertexLanes, gradient: &[VertexLanes; 3]) -> VertexTests {
    let SeedGroup { low: [low, ..], high: [high, ..], rise, spread } = group;
    let (square, rises) = (squares(gradient), squares(rise));
    let far = is_far(iso, [low, high], values, &square);
    let ([x, y, z], [u, v, w]) = (gradient, rise);
    let (mut odd, mut turned) = ([0; LANES], [0; LANES]);
    for i in 0..LANES {
        let slope = x[i].abs() + y[i].abs() + z[i].abs();
        let is_explained = spread[i] < EXCESS * (high[i] - low[i]) * slope;
        let is_number = square[i] < f32::INFINITY;
        odd[i] = u32::from(!is_explained) | u32::from(!is_number);
        let along = x[i] * u[i] + y[i] * v[i] + z[i] * w[i];
        turned[i] = u32::from(along < ASTRAY * (square[i] * rises[i]).sqrt());
    }
    VertexTests { far, odd, turned }
}

/// The groups with a vertex that fails a test.
#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn judge_all(
    iso: f32,
    groups: &[SeedGroup],
    values: &[f32],
    gradient: &VertexPlanes,
    verdicts: &mut Vec<(usize, VertexTests)>,
) {
    for (chunk, group) in groups.iter().enumerate() {
        let verdict = judge(iso, group, &lane(values, chunk), &lanes(gradient, chunk));
        let VertexTests { far, odd, turned } = &verdict;
        let any = far.iter().chain(odd).chain(turned).fold(0, |any, condition| any | condition);
        if any != 0 {
            verdicts.push((chunk, verdict));
        }
    }
}

impl VertexBatch {
    /// Moves suspects to their places, and evaluates everything there again.
    pub(super) fn look_again<F: Field>(
        &mut self,
        source: &VertexSource<'_, F>,
        brick: usize,
    ) -> Result<Done, F::Error> {
        let VertexSource { field, options, regions, .. } = source;
        let (region, iso) = (&regions[brick], options.iso);
        self.find_suspects(iso);
        if self.suspects.found.is_empty() {
            return Ok(Done::default());
        }
        self.crossed.clear(source.bricks.table_len());
        let mut suspects = std::mem::take(&mut self.suspects);
        let SecondLooks { found, sheets, again, .. } = &mut suspects;
        sheets.clear();
        sheets.extend(found.iter().map(|&(vertex, _)| self.sheet(source, brick, vertex)));
        let edges = |sheet: usize| (sheets[sheet].numbers(), !found[sheet].1);
        let mut jump_evaluations = self.crossed.bracket(*field, region, iso, (sheets.len(), edges))?;
        let (mut walls, mut strays) = (Vec::new(), Vec::new());
        for (number, (sheet, &(_, is_far))) in sheets.iter().zip(&*found).enumerate() {
            if self.crossed.is_left(number) {
                walls.push(Wall::new(sheet, &self.crossed));
            } else if is_far {
                strays.push(self.stray(iso, sheet));
            }
        }
        jump_evaluations += follow(*field, region, iso, &mut walls)?;
        let points = &mut self.crossed.points;
        let [gradient_evaluations, halvings] = settle(*field, region, iso, &mut strays, points)?;
        jump_evaluations += halvings;
        self.jumped.extend(walls.iter().map(|wall| wall.vertex));
        again.clear();
        again.extend(walls.iter().map(|wall| {
            let &Wall { vertex, position, inside, normal, .. } = wall;
            Again { vertex, position, asked: inside, normal }
        }));
        again.extend(strays.iter().map(|stray| {
            let (vertex, position) = (stray.index, stray.best());
            Again { vertex, position, asked: position, normal: None }
        }));
        self.evaluate_again(source, brick, &mut suspects)?;
        let full_evaluations = suspects.again.len() as u64;
        self.suspects = suspects;
        Ok(Done {
            gradient_evaluations,
            full_evaluations,
            jump_evaluations,
            jump_vertices: walls.len() as u64,
            ..Done::default()
        })
    }

    /// Finds the suspects, and records vertices with doubtful normals.
    fn find_suspects(&mut self, iso: f32) {
        let SecondLooks { verdicts, found, .. } = &mut self.suspects;
        verdicts.clear();
        found.clear();
        judge_all(iso, &self.groups, &self.values, &self.gradient, verdicts);
        for (chunk, VertexTests { far, odd, turned }) in &*verdicts {
            let start = chunk * LANES;
            for lane in 0..LANES.min(self.count - start) {
                if far[lane] | odd[lane] == 1 {
                    found.push((start + lane, far[lane] == 1));
                }
                if far[lane] | odd[lane] | turned[lane] == 1 {
                    self.doubtful.push(start + lane);
                }
            }
        }
    }

    fn sheet<F: Field>(&mut self, source: &VertexSource<'_, F>, brick: usize, vertex: usize) -> Sheet {
        let cells = source.crossings.of(brick);
        // A cell without a vertex has the number of the next vertex.
        let index = cells.partition_point(|cell| cell.vertex as usize <= vertex) - 1;
        let (cell, corners) = (&cells[index], &self.corners(source.bricks, &cells[index]));
        let sheet = vertex as u32 - cell.vertex;
        let start = Start { vertex, bounds: self.bounds(vertex) };
        Sheet::new(source.bricks, brick, (cell, sheet), start, corners, &mut self.crossed)
    }

    fn stray(&self, iso: f32, sheet: &Sheet) -> Stray {
        let Start { vertex, bounds, .. } = sheet.start;
        let at = |planes: &VertexPlanes| planes.each_ref().map(|plane| plane[vertex]);
        let place = VertexPlace { bounds, corners: sheet.corners };
        Stray::new(iso, vertex, place, at(&self.points), self.values[vertex], at(&self.gradient))
    }

    fn evaluate_again<F: Field>(
        &mut self,
        source: &VertexSource<'_, F>,
        brick: usize,
        SecondLooks { again, points, attributes, .. }: &mut SecondLooks,
    ) -> Result<(), F::Error> {
        let count = again.len();
        if count == 0 {
            return Ok(());
        }
        attributes.resize(self.attributes.len() / self.count * count, 0.0);
        let asked = again.iter().map(|one| one.asked);
        let (values, gradient) = points.ask_all(source.field, &source.regions[brick], asked, attributes)?;
        for (n, one) in again.iter().enumerate() {
            let vertex = one.vertex;
            for (axis, slope) in gradient.iter().enumerate() {
                self.points[axis][vertex] = one.position[axis];
                // A wall gets the gradient of a field that falls along the wall's normal.
                self.gradient[axis][vertex] = one.normal.map_or(slope[n], |normal| -normal[axis]);
            }
            self.values[vertex] = values[n];
            let planes = self.attributes.chunks_exact_mut(self.count).zip(attributes.chunks_exact(count));
            planes.for_each(|(plane, answers)| plane[vertex] = answers[n]);
        }
        Ok(())
    }
}
