//! Seeds of vertices: the data of their cells side by side, so that [`LANES`] vertices are computed at a
//! time.
//!
//! ```text
//! mean  = sum of the crossings of the sheet / how many they are, in units of the cell
//! start = the mean, in the room that a vertex has in its cell
//! ```

use super::super::cell::{EDGE_CORNERS, SheetEdges};
use super::super::pull::{LANES, VertexLanes, all};
use super::margin::room;

/// The data of the cells of [`LANES`] vertices.
#[derive(Clone, Copy, Default)]
pub(super) struct Seeds {
    /// The field at the corners.
    corners: [VertexLanes; 8],
    /// The low and the high side along each axis.
    sides: [[VertexLanes; 2]; 3],
    /// The edges of their sheets.
    edges: [SheetEdges; LANES],
}

/// The groups that are sown before they grow: few enough that their seeds are still in the nearest cache.
pub(super) const BED: usize = 8;

/// Where seeds grow, some groups at a time.
pub(super) type Bed = [Seeds; BED];

/// Values derived from [`Seeds`].
#[derive(Clone, Copy, Default)]
pub(super) struct SeedGroup {
    /// The low and the high corners of the vertices' rooms.
    pub(super) low: [VertexLanes; 3],
    pub(super) high: [VertexLanes; 3],
    /// The approximate rise of the field along the axes: from the low corners of the cells to the high ones,
    /// or along the edges that the sheets cross.
    pub(super) rise: [VertexLanes; 3],
    /// The largest difference of the field among the corners of each cell.
    pub(super) spread: VertexLanes,
}

impl Seeds {
    /// Puts a vertex into a lane: the field at the corners of its cell, the sides of the cell, and the edges
    /// of its sheet.
    #[inline(always)]
    pub(super) fn put(&mut self, lane: usize, corners: &[f32; 8], sides: [[f32; 2]; 3], edges: SheetEdges) {
        for (lanes, corner) in self.corners.iter_mut().zip(corners) {
            lanes[lane] = *corner;
        }
        for ([low, high], sides) in self.sides.iter_mut().zip(sides) {
            [low[lane], high[lane]] = sides;
        }
        self.edges[lane] = edges;
    }

    /// The starts of the vertices, and their group; `rise` is computed as if each vertex had a cell of its
    /// own.
    #[inline(always)]
    fn grow(&self, iso: f32, group: &mut SeedGroup) -> [VertexLanes; 3] {
        let (means, is_tame) = self.tame_means(iso, group);
        let mut means = means;
        if !all(&is_tame) {
            for lane in (0..LANES).filter(|&lane| is_tame[lane] == 0) {
                let mean = self.wild_mean(iso, lane);
                (0..3).for_each(|axis| means[axis][lane] = mean[axis]);
            }
        }
        let mut points = [[0.0; LANES]; 3];
        for axis in 0..3 {
            let [first, last] = &self.sides[axis];
            for i in 0..LANES {
                let [low, high] = room([first[i], last[i]]);
                (group.low[axis][i], group.high[axis][i]) = (low, high);
                // This form does not overflow, however large the cell.
                let start = first[i] * (1.0 - means[axis][i]) + last[i] * means[axis][i];
                let start = if start < low { low } else { start };
                points[axis][i] = if start > high { high } else { start };
            }
        }
        points
    }

    /// The means of the crossings, in units of the cells, and whether no difference of the field overflows, 1
    /// or 0 each. Also computes what the corners give. (One loop for all of it is a loop that the compiler
    /// vectorises.)
    // Plain indices become vectors.
    #[allow(clippy::needless_range_loop)]
    #[inline(always)]
    fn tame_means(&self, iso: f32, group: &mut SeedGroup) -> ([VertexLanes; 3], [u32; LANES]) {
        /// Numbers up to this limit have differences that do not overflow.
        const LARGE: f32 = 1e38;
        let (mut means, mut is_tame) = ([[0.0; LANES]; 3], [0; LANES]);
        for i in 0..LANES {
            let mut corners = [0.0_f32; 8];
            is_tame[i] = 1;
            for n in 0..8 {
                corners[n] = self.corners[n][i];
                is_tame[i] &= u32::from(corners[n].abs() <= LARGE);
            }
            let mean = tame_mean(iso, &corners, self.edges[i]);
            let rise = rise(&corners);
            for axis in 0..3 {
                means[axis][i] = mean[axis];
                group.rise[axis][i] = rise[axis];
            }
            group.spread[i] = spread(&corners);
        }
        (means, is_tame)
    }

    /// The mean of one vertex, for any numbers.
    #[cold]
    fn wild_mean(&self, iso: f32, lane: usize) -> [f32; 3] {
        let edges = self.edges[lane];
        std::array::from_fn(|axis| {
            let chosen = (4 * axis..4 * axis + 4).filter(|&edge| edges.chosen(edge) != 0);
            let ends = chosen.map(|edge| EDGE_CORNERS[edge].map(|corner| self.corners[corner][lane]));
            let sum: f32 = ends.map(|[low, high]| crossing(iso, low, high)).sum();
            (edges.high(axis) + sum) * (1.0 / edges.count())
        })
    }
}

/// The mean of the crossings of a sheet, in units of the cell: each coordinate is from 0 to 1, or a little
/// more by rounding. All edges are computed, which is faster than a branch.
// Plain indices become vectors.
#[allow(clippy::needless_range_loop)]
#[inline(always)]
fn tame_mean(iso: f32, corners: &[f32; 8], edges: SheetEdges) -> [f32; 3] {
    let mut mean = [0.0; 3];
    for axis in 0..3 {
        let mut t = [0.0; 4];
        for n in 0..4 {
            let edge = 4 * axis + n;
            let (low, high) = (corners[EDGE_CORNERS[edge][0]], corners[EDGE_CORNERS[edge][1]]);
            // On a crossed edge this is from 0 to 1; on other edges it is arbitrary and masked out.
            let crossing = (iso - low) / (high - low);
            t[n] = f32::from_bits(crossing.to_bits() & edges.chosen(edge));
        }
        mean[axis] = (edges.high(axis) + ((t[0] + t[1]) + (t[2] + t[3]))) * (1.0 / edges.count());
    }
    mean
}

/// Computes the starts and the groups of vertices.
#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
pub(super) fn grow(iso: f32, seeds: &[Seeds], groups: &mut [SeedGroup], points: [&mut [f32]; 3]) {
    let [x, y, z] = points.map(|plane| plane.as_chunks_mut::<LANES>().0);
    for ((seeds, group), ((x, y), z)) in seeds.iter().zip(groups).zip(x.iter_mut().zip(y).zip(z)) {
        [*x, *y, *z] = seeds.grow(iso, group);
    }
}

/// The crossing along a crossed edge, from 0 to 1, for a linear field; the middle if that is NaN.
fn crossing(iso: f32, low: f32, high: f32) -> f32 {
    let rise = high - low;
    let t = (iso - low) / rise;
    if (0.0..=1.0).contains(&t) && rise.is_finite() { t } else { 0.5 }
}

/// The largest difference of the field among the corners of a cell; infinite if a corner is NaN.
#[inline(always)]
fn spread([a, b, c, d, e, f, g, h]: &[f32; 8]) -> f32 {
    let least = |a: f32, b: f32| if a < b { a } else { b };
    let most = |a: f32, b: f32| if a > b { a } else { b };
    let high = most(most(most(*a, *e), most(*b, *f)), most(most(*c, *g), most(*d, *h)));
    let low = least(least(least(*a, *e), least(*b, *f)), least(least(*c, *g), least(*d, *h)));
    // Infinities of both signs give a NaN sum.
    let sum = ((a + e) + (b + f)) + ((c + g) + (d + h));
    if sum.is_nan() { f32::INFINITY } else { high - low }
}

/// The rise of the field along the axes, from the low corners of a cell to the high ones.
#[inline(always)]
fn rise([a, b, c, d, e, f, g, h]: &[f32; 8]) -> [f32; 3] {
    [
        ((b - a) + (d - c)) + ((f - e) + (h - g)),
        ((c - a) + (d - b)) + ((g - e) + (h - f)),
        ((e - a) + (f - b)) + ((g - c) + (h - d)),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::super::cell::default_edges;
    use super::*;

    /// The mean of the crossings of the only sheet of a case, in the last lane of the unit cell.
    fn mean(iso: f32, corners: &[f32; 8], signs: u8) -> [f32; 3] {
        let mut seeds = Seeds::default();
        seeds.put(LANES - 1, corners, [[0.0, 1.0]; 3], default_edges(signs)[0]);
        let (mut groups, mut planes) = ([SeedGroup::default()], [[0.0; LANES]; 3]);
        grow(iso, &[seeds], &mut groups, planes.each_mut().map(|plane| &mut plane[..]));
        planes.map(|lanes| lanes[LANES - 1])
    }

    #[test]
    fn a_crossing_is_on_its_edge() {
        assert_eq!(crossing(0.5, 0.0, 1.0), 0.5);
        assert_eq!(crossing(0.5, 1.0, 0.0), 0.5);
        assert_eq!(crossing(0.25, 0.0, 1.0), 0.25);
        assert_eq!(crossing(0.5, 0.5, 0.0), 0.0);
        assert_eq!(crossing(0.5, f32::NAN, 0.9), 0.5);
        assert_eq!(crossing(0.5, f32::NEG_INFINITY, 0.9), 0.5);
        assert_eq!(crossing(0.5, 0.0, f32::INFINITY), 0.5);
        assert_eq!(crossing(0.5, f32::MIN, f32::MAX), 0.5);
    }

    #[test]
    fn the_mean_of_crossings_is_where_they_are() {
        // Corner 0 alone is inside: a quarter along each of its edges.
        let mut corners = [0.0; 8];
        corners[0] = 1.0;
        let [x, y, z] = mean(0.75, &corners, 1);
        assert!([x, y, z].iter().all(|c| (c - 0.25 / 3.0).abs() < 1e-6));
        // The same at the opposite corner.
        corners.rotate_left(1);
        let [x, y, z] = mean(0.75, &corners, 128);
        assert!([x, y, z].iter().all(|c| (c - (1.0 - 0.25 / 3.0)).abs() < 1e-6));
        // A corner without a number: the middle.
        corners = [1.0, 0.0, 0.0, f32::NAN, f32::NEG_INFINITY, 0.0, 0.0, 0.0];
        let [x, y, z] = mean(0.75, &corners, 1);
        assert_eq!([x * 3.0, y * 3.0, z * 3.0], [0.25, 0.25, 0.5]);
    }

    #[test]
    fn vertices_start_in_the_room_of_their_cells() {
        let mut seeds = Seeds::default();
        let mut corners = [0.0; 8];
        corners[0] = 1.0;
        seeds.put(0, &corners, [[4.0, 6.0]; 3], default_edges(1)[0]);
        // So near to the corner that there is no room.
        corners[0] = 0.5;
        seeds.put(1, &corners, [[4.0, 6.0]; 3], default_edges(1)[0]);
        let (mut groups, mut planes) = ([SeedGroup::default()], [[0.0; LANES]; 3]);
        grow(0.5, &[seeds], &mut groups, planes.each_mut().map(|plane| &mut plane[..]));
        let [low, high] = room([4.0, 6.0]);
        for (axis, plane) in planes.iter().enumerate() {
            let group = &groups[0];
            assert!((plane[0] - (4.0 + 1.0 / 3.0)).abs() < 1e-5 && plane[1] == low);
            assert_eq!((group.low[axis][1], group.high[axis][1]), (low, high));
            assert_eq!((group.rise[axis][0], group.rise[axis][1]), (-1.0, -0.5));
            assert_eq!((group.spread[0], group.spread[1]), (1.0, 0.5));
        }
    }
}
