//! The narrow band of a level set: distances of lattice points close to the surface, and of all others the
//! side on which they are.
//!
//! ```text
//!    outside  + + + | 2.4 1.3 0.4 | -0.6 -1.5 -2.5 | - - -  inside        in cells; beyond the band the side alone
//! ```
//!
//! The distance is that of the tangent: `(iso - field) / |gradient|`. Where the field jumps, or is level, it
//! tells nothing; then neighbours on two sides are half a cell off the surface.

use jbt_ir::watch;

use super::block::Block;
use super::leaf::{LEAF, VdbLeaf, VdbLeaves, VdbPlace, leaf_at, offset};

/// How far the band reaches to each side, in cells: as far as programs for level sets expect.
const HALF_WIDTH: f64 = 3.0;
/// Points along a side of a leaf.
const SIDE: u32 = 1 << LEAF;

/// How far the band reaches to each side, for cells of this size.
pub(super) fn width(spacing: f64) -> f32 {
    (HALF_WIDTH * spacing) as f32
}

/// The leaves of a level set: points of the band are active, with their distances. The planes are those of
/// the field and of its gradient.
pub(super) fn band(blocks: &[Block], [field, x, y, z]: [usize; 4], iso: f32, spacing: f64) -> VdbLeaves {
    let width = width(spacing);
    let mut band = VdbLeaves::new();
    for block in blocks {
        let is_first_inside = block.get(field, [0; 3]) >= iso;
        if block.is_constant() && !is_first_inside {
            continue;
        }
        for at in block.places() {
            let value = block.get(field, at);
            let is_inside = value >= iso;
            let slope = [x, y, z].map(|plane| f64::from(block.get(plane, at)));
            let steepness = slope.iter().map(|c| c * c).sum::<f64>().sqrt();
            let distance = ((f64::from(iso) - f64::from(value)) / steepness) as f32;
            let is_near = distance.abs() < width;
            if !is_inside && !is_near {
                continue;
            }
            let index = block.index(at);
            let leaf = leaf_at(&mut band, VdbPlace::around(index));
            let offset = offset(index, LEAF);
            if is_inside {
                leaf.inside.add(offset);
            }
            if is_near {
                leaf.put(offset, &[distance]);
            }
        }
    }
    let half = (0.5 * spacing) as f32;
    for (index, distance) in apart(&band, blocks, half) {
        let (leaf, offset) = (leaf_at(&mut band, VdbPlace::around(index)), offset(index, LEAF));
        if !leaf.active.has(offset) {
            leaf.put(offset, &[distance]);
        }
    }
    band
}

/// Neighbours on two sides, each so far from the surface.
fn apart(band: &VdbLeaves, blocks: &[Block], half: f32) -> Vec<([u32; 3], f32)> {
    let ends = [0, 1, 2].map(|axis| {
        blocks.iter().map(|block| block.first()[axis] + block.points()[axis]).max().unwrap_or(0) as u32
    });
    let is_full = |leaf: Option<&VdbLeaf>| leaf.is_some_and(|leaf| leaf.inside.is_full());
    let mut found = Vec::new();
    for (place, leaf) in band {
        let corner = place.corner();
        let beside = |axis: usize, up: bool| {
            let mut beside = corner;
            beside[axis] = if up { corner[axis] + SIDE } else { corner[axis].wrapping_sub(SIDE) };
            band.get(&VdbPlace::around(beside))
        };
        let around = [0, 1, 2].map(|axis| [false, true].map(|up| beside(axis, up)));
        if is_full(Some(leaf)) && around.iter().flatten().all(|leaf| is_full(*leaf)) {
            continue;
        }
        for n in (0..SIDE.pow(3)).filter(|&n| leaf.inside.has(n as usize)) {
            let inner = [n >> (2 * LEAF), n >> LEAF & (SIDE - 1), n & (SIDE - 1)];
            let here = [0, 1, 2].map(|axis| corner[axis] + inner[axis]);
            for (axis, up) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, false), (axis, true)]) {
                let mut index = here;
                index[axis] = if up { index[axis] + 1 } else { index[axis].wrapping_sub(1) };
                // Nobody knows what is beyond the lattice.
                if index[axis] >= ends[axis] {
                    continue;
                }
                let is_same = VdbPlace::around(index) == *place;
                let other = if is_same { Some(leaf) } else { around[axis][usize::from(up)] };
                if !other.is_some_and(|other| other.inside.has(offset(index, LEAF))) {
                    watch::take_for(&found, 2);
                    found.push((here, -half));
                    found.push((index, half));
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The leaves of a lattice of 40^3 points with spacing 0.5, sampled in blocks of 16^3.
    fn band_of(field: impl Fn([f64; 3]) -> [f32; 4]) -> VdbLeaves {
        let starts = [0, 16, 32];
        let block = |x: u32, y: u32, z: u32| {
            let indices = [x, y, z].map(|first| [first, 40.min(first + 16)]);
            let [[x0, x1], [y0, y1], [z0, z1]] = indices;
            let points = (z0..z1).flat_map(|z| (y0..y1).flat_map(move |y| (x0..x1).map(move |x| [x, y, z])));
            let answers: Vec<[f32; 4]> =
                points.map(|at| field(at.map(|index| 0.5 * f64::from(index)))).collect();
            let plane = |plane: usize| answers.iter().map(|answer| answer[plane]).collect();
            Block::new(indices, (0..4).map(plane).collect())
        };
        let places = starts.iter().flat_map(|&z| starts.iter().flat_map(move |&y| starts.map(|x| (x, y, z))));
        let blocks: Vec<Block> = places.map(|(x, y, z)| block(x, y, z)).collect();
        band(&blocks, [0, 1, 2, 3], 0.5, 0.5)
    }

    fn from_centre(at: [f64; 3]) -> ([f64; 3], f64) {
        let way = at.map(|coordinate| coordinate - 9.9);
        (way, way.iter().map(|c| c * c).sum::<f64>().sqrt())
    }

    #[test]
    fn a_ball_has_its_distances() {
        // 0.5 - 2 (r - 7): twice as steep as a distance.
        let found = band_of(|at| {
            let (way, r) = from_centre(at);
            let [x, y, z] = way.map(|c| (-2.0 * c / r.max(1e-9)) as f32);
            [(0.5 - 2.0 * (r - 7.0)) as f32, x, y, z]
        });
        let mut seen = [0; 3];
        for n in 0..40_u32.pow(3) {
            let index = [n % 40, n / 40 % 40, n / 1600];
            let distance = from_centre(index.map(|index| 0.5 * f64::from(index))).1 - 7.0;
            let (leaf, offset) = (found.get(&VdbPlace::around(index)), offset(index, LEAF));
            assert_eq!(leaf.is_some_and(|leaf| leaf.inside.has(offset)), distance <= 0.0, "{index:?}");
            let is_active = leaf.is_some_and(|leaf| leaf.active.has(offset));
            assert_eq!(is_active, distance.abs() < 1.5, "{index:?}: {distance}");
            if is_active {
                let found = leaf.expect("it is active").values[offset];
                assert!((f64::from(found) - distance).abs() < 1e-5, "{index:?}: {found}, {distance}");
            }
            seen[if is_active { 2 } else { usize::from(distance < 0.0) }] += 1;
        }
        assert!(seen.iter().all(|&count| count > 500), "{seen:?}");
        assert!(found.values().any(VdbLeaf::is_tile));
    }

    #[test]
    fn a_jump_has_half_a_cell_to_both_sides() {
        let found = band_of(|at| [f32::from(u8::from(from_centre(at).1 < 7.0)), 0.0, 0.0, 0.0]);
        let active: u32 = found.values().flat_map(|leaf| leaf.active.0).map(u64::count_ones).sum();
        assert!(active > 1000, "{active}");
        for leaf in found.values() {
            for n in (0..512).filter(|&n| leaf.active.has(n)) {
                assert_eq!(leaf.values[n], if leaf.inside.has(n) { -0.25 } else { 0.25 });
            }
        }
    }
}
