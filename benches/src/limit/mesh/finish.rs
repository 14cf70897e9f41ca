//! From where vertices start to where they are: Newton's steps, normals and colours, a register of vertices
//! at a time.

use std::ops::Range;

use crate::limit::dense::{Row, full_at, gradient_at};
use crate::limit::vector::{Job, Vector};

use super::scene::BRICK;

/// The most vertices in a brick, four for each cell, and room to fill a register up.
const CAPACITY: usize = 4 * BRICK * BRICK * BRICK + 16;

/// Where the vertices of a brick start, and the cells that they stay in: planes of x, y and z.
pub(super) struct Starts {
    len: usize,
    position: Planes,
    low: Planes,
    high: Planes,
}

type Planes = Box<[[f32; CAPACITY]; 3]>;

impl Starts {
    pub(super) fn new() -> Self {
        let planes = || Box::new([[0.0; CAPACITY]; 3]);
        Self { len: 0, position: planes(), low: planes(), high: planes() }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    #[inline(always)]
    pub(super) fn push(&mut self, position: [f32; 3], low: [f32; 3], high: [f32; 3]) {
        let n = self.len;
        assert!(n < CAPACITY, "a cell has at most four vertices");
        for axis in 0..3 {
            self.position[axis][n] = position[axis];
            self.low[axis][n] = low[axis];
            self.high[axis][n] = high[axis];
        }
        self.len += 1;
    }
}

/// Finished vertices.
#[derive(Default)]
pub(super) struct Vertices {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) colors: Vec<[f32; 3]>,
}

impl Vertices {
    pub(super) fn with_capacity(count: usize) -> Self {
        let list = || Vec::with_capacity(count);
        Self { positions: list(), normals: list(), colors: list() }
    }

    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }

    /// Puts other vertices in the place of some.
    pub(super) fn replace(&mut self, range: Range<usize>, by: Self) {
        self.positions.splice(range.clone(), by.positions);
        self.normals.splice(range.clone(), by.normals);
        self.colors.splice(range, by.colors);
    }
}

/// Newton's steps. Each about squares the distance that is left, in units of the radius of curvature.
const STEPS: usize = 2;

/// Finishes the vertices of a brick.
pub(super) struct Finish<'a> {
    /// The blobs that reach it.
    pub(super) rows: &'a [Row],
    pub(super) iso: f32,
    pub(super) starts: &'a mut Starts,
    /// Where the vertices are appended.
    pub(super) vertices: &'a mut Vertices,
}

impl Job for Finish<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self { rows, iso, starts, vertices } = self;
        let count = starts.len();
        let iso = V::splat(iso);
        // The last register is filled up with what other bricks have left.
        for start in (0..count).step_by(V::LANES) {
            let mut point = load(&starts.position, start);
            let (low, high): ([V; 3], [V; 3]) = (load(&starts.low, start), load(&starts.high, start));
            for _ in 0..STEPS {
                let [field, gx, gy, gz] = gradient_at(rows.iter(), point);
                let gradient = [gx, gy, gz];
                let step = iso.sub(field).div(squared_length(gradient));
                for axis in 0..3 {
                    point[axis] = step.mul_add(gradient[axis], point[axis]).max(low[axis]).min(high[axis]);
                }
            }
            let [_, gx, gy, gz, r, g, b] = full_at(rows.iter(), point);
            // Away from the inside.
            let scale = V::splat(-1.0).div(squared_length([gx, gy, gz]).sqrt());
            let [x, y, z] = point;
            let answers = [x, y, z, gx.mul(scale), gy.mul(scale), gz.mul(scale), r, g, b];
            let mut planes = [[0.0; 16]; 9];
            for n in 0..9 {
                answers[n].store(&mut planes[n]);
            }
            let lanes = V::LANES.min(count - start);
            let vector = |n: usize, lane: usize| [planes[n][lane], planes[n + 1][lane], planes[n + 2][lane]];
            vertices.positions.extend((0..lanes).map(|lane| vector(0, lane)));
            vertices.normals.extend((0..lanes).map(|lane| vector(3, lane)));
            vertices.colors.extend((0..lanes).map(|lane| vector(6, lane)));
        }
    }
}

/// A register of each plane.
#[inline(always)]
fn load<V: Vector>([x, y, z]: &[[f32; CAPACITY]; 3], start: usize) -> [V; 3] {
    [V::load(&x[start..]), V::load(&y[start..]), V::load(&z[start..])]
}

/// The squared length of vectors, and a little more than zero where it is zero.
#[inline(always)]
fn squared_length<V: Vector>([x, y, z]: [V; 3]) -> V {
    z.mul_add(z, y.mul_add(y, x.mul(x))).max(V::splat(f32::MIN_POSITIVE))
}
