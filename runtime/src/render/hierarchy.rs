//! A hierarchy of boxes around the triangles of a mesh, and rays that meet them.
//!
//! ```text
//! triangles of a mesh, in Morton order   ▵▵▵▵▵▵▵▵ ▵▵▵▵▵▵▵▵ ▵▵▵▵▵▵▵▵ ..      eight of them are a cluster,
//! boxes of clusters                      [  ][  ][  ][  ][  ][  ][  ][  ]   eight boxes are a node,
//! boxes of nodes                         [          ][          ] ..        and so on up to one node
//! ```
//!
//! The mesher writes triangles in the order of their cells, which is Morton order. So neighbours in the list
//! are neighbours in space, and nothing is sorted: to build the hierarchy is to compute boxes. A ray is
//! tested against eight boxes, or eight triangles, at once.
//!
//! Clusters and boxes depend on the mesh alone, and no product is fused with a sum. So answers have the same
//! bits for every instruction set and any number of threads.

use super::beam::SegmentBeam;
use super::boxes::{BoxNode, Corners, EightLanes, NOWHERE, RayPart, WIDE, finite_lanes, inverse, joined};
use crate::parallel::*;

/// By how much a triangle reaches beyond its edges, as a part of it: no ray slips through between two.
const SEAM: f32 = 1e-5;
/// Segments that are led through the hierarchy together.
const BUNDLE: usize = 64;
/// Clusters beside such a bundle, beyond which each segment walks alone.
const MANY: usize = 192;
/// Nodes that wait at most: seven brothers on each of eleven levels, and the last eight.
const WAITING: usize = 96;

/// Eight triangles: of each a corner, and the edges from there to the other two. What is missing is 0.
#[derive(Clone)]
struct TriangleCluster {
    corner: [EightLanes; 3],
    edges: [[EightLanes; 3]; 2],
}

/// The triangles of a mesh in boxes.
pub struct Hierarchy {
    clusters: Vec<TriangleCluster>,
    /// Nodes of clusters, nodes of these nodes, and so on. The last level has one node.
    levels: Vec<Vec<BoxNode>>,
}

impl TriangleCluster {
    /// The cluster of up to eight triangles, and its box.
    fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> (Self, Corners) {
        let mut cluster = Self { corner: [[0.0; WIDE]; 3], edges: [[[0.0; WIDE]; 3]; 2] };
        let mut bounds = NOWHERE;
        for (lane, triangle) in triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            for axis in 0..3 {
                cluster.corner[axis][lane] = a[axis];
                cluster.edges[0][axis][lane] = b[axis] - a[axis];
                cluster.edges[1][axis][lane] = c[axis] - a[axis];
            }
            bounds = [a, b, c].iter().fold(bounds, |bounds, &point| joined(bounds, &[point, point]));
        }
        (cluster, bounds)
    }

    /// For each triangle the distance at which a ray meets it, or infinity, and whether from behind: 1 or 0.
    ///
    /// After Möller and Trumbore, Fast, minimum storage ray/triangle intersection (1997).
    #[inline(always)]
    fn meet(&self, ray: &RayPart, reach: f32) -> (EightLanes, [u32; WIDE]) {
        let (mut distances, mut behind) = ([f32::INFINITY; WIDE], [0; WIDE]);
        let [dx, dy, dz] = ray.direction;
        let [[ax, ay, az], [bx, by, bz]] = &self.edges;
        for i in 0..WIDE {
            let [px, py, pz] = [dy * bz[i] - dz * by[i], dz * bx[i] - dx * bz[i], dx * by[i] - dy * bx[i]];
            let volume = ax[i] * px + ay[i] * py + az[i] * pz;
            let inverse = 1.0 / volume;
            let [sx, sy, sz] = [
                ray.origin[0] - self.corner[0][i],
                ray.origin[1] - self.corner[1][i],
                ray.origin[2] - self.corner[2][i],
            ];
            let u = (sx * px + sy * py + sz * pz) * inverse;
            let [qx, qy, qz] = [sy * az[i] - sz * ay[i], sz * ax[i] - sx * az[i], sx * ay[i] - sy * ax[i]];
            let v = (dx * qx + dy * qy + dz * qz) * inverse;
            let t = (bx[i] * qx + by[i] * qy + bz[i] * qz) * inverse;
            // A flat triangle has no finite u, and a comparison with NaN is false.
            let met = (u >= -SEAM) & (v >= -SEAM) & (u + v <= 1.0 + SEAM) & (t >= 0.0) & (t <= reach);
            distances[i] = if met { t } else { f32::INFINITY };
            behind[i] = u32::from(volume < 0.0);
        }
        (distances, behind)
    }

    /// Whether a segment meets a triangle: see [`Hierarchy::any_of`].
    #[inline(always)]
    fn blocks(&self, segment: &RayPart, depth: f32) -> bool {
        let (distances, behind) = self.meet(segment, segment.reach);
        let mut counts = 0;
        for i in 0..WIDE {
            let is_met = u32::from(distances[i] < f32::INFINITY);
            counts |= is_met & (u32::from(distances[i] > depth) | (1 - behind[i]));
        }
        counts != 0
    }
}

/// The clusters beside a bundle of segments.
#[derive(Default)]
struct NearClusters {
    /// Each with a bound of its distance from where the bundle begins; the nearest first.
    clusters: Vec<(f32, u32)>,
    /// Their boxes, in this order.
    boxes: Vec<BoxNode>,
}

impl NearClusters {
    /// Whether a segment meets one of them.
    #[inline(always)]
    fn blocks(&self, hierarchy: &Hierarchy, segment: &RayPart, depth: f32) -> bool {
        let inverse = inverse(segment.direction);
        for (node, clusters) in self.boxes.iter().zip(self.clusters.chunks(WIDE)) {
            if clusters[0].0 > segment.reach {
                return false;
            }
            let mut mask = finite_lanes(&node.enter(segment.origin, inverse, segment.reach));
            while mask != 0 {
                let lane = (mask.trailing_zeros() & 7) as usize;
                mask &= mask - 1;
                if hierarchy.clusters[clusters[lane].1 as usize].blocks(segment, depth) {
                    return true;
                }
            }
        }
        false
    }
}

impl Hierarchy {
    /// The hierarchy of a mesh's triangles; `None` without triangles.
    pub fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Option<Self> {
        let cluster = |some: &[[u32; 3]]| TriangleCluster::new(positions, some);
        let made: Vec<(TriangleCluster, Corners)> =
            scatter(|_| triangles.par_chunks(WIDE).with_min_len(1024).map(cluster).collect());
        let (clusters, mut boxes): (Vec<_>, Vec<_>) = made.into_iter().unzip();
        let mut levels = Vec::new();
        while !boxes.is_empty() {
            let (nodes, around): (Vec<_>, Vec<_>) = boxes.chunks(WIDE).map(BoxNode::new).unzip();
            levels.push(nodes);
            if around.len() == 1 {
                break;
            }
            boxes = around;
        }
        (!clusters.is_empty()).then_some(Self { clusters, levels })
    }

    /// Which segments meet the mesh. Triangles that a segment meets from behind count only at distances
    /// beyond `depth`: a segment that begins a little below the surface leaves it again.
    pub fn any_of(&self, segments: &[RayPart], depth: f32) -> Vec<bool> {
        let mut met = vec![false; segments.len()];
        any_all(self, segments, depth, &mut met);
        met
    }

    /// Collects the clusters whose boxes reach into a beam. Whether there are few enough.
    #[inline(always)]
    fn near_beam(&self, beam: &SegmentBeam, near: &mut NearClusters) -> bool {
        near.clusters.clear();
        near.boxes.clear();
        let mut waiting = [(self.levels.len() as u32 - 1, 0_u32); WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (level, number) = waiting[count];
            let distances = beam.enter(&self.levels[level as usize][number as usize]);
            let mut mask = finite_lanes(&distances);
            while mask != 0 {
                let lane = mask.trailing_zeros() & 7;
                mask &= mask - 1;
                let number = number * WIDE as u32 + lane;
                if level > 0 {
                    waiting[count] = (level - 1, number);
                    count += 1;
                } else {
                    near.clusters.push((distances[lane as usize], number));
                }
            }
            if near.clusters.len() > MANY {
                return false;
            }
        }
        near.clusters.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for some in near.clusters.chunks(WIDE) {
            let mut node = BoxNode::EMPTY;
            for (to, &(_, cluster)) in some.iter().enumerate() {
                let (from, lane) = (&self.levels[0][cluster as usize / WIDE], cluster as usize % WIDE);
                for axis in 0..3 {
                    node.low[axis][to] = from.low[axis][lane];
                    node.high[axis][to] = from.high[axis][lane];
                }
            }
            near.boxes.push(node);
        }
        true
    }

    /// Whether a segment meets the mesh.
    #[inline(always)]
    fn blocks(&self, segment: &RayPart, depth: f32) -> bool {
        let inverse = inverse(segment.direction);
        let mut waiting = [(self.levels.len() as u32 - 1, 0_u32); WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (level, number) = waiting[count];
            let node = &self.levels[level as usize][number as usize];
            let mut mask = finite_lanes(&node.enter(segment.origin, inverse, segment.reach));
            while mask != 0 {
                let number = number * WIDE as u32 + (mask.trailing_zeros() & 7);
                mask &= mask - 1;
                if level > 0 {
                    waiting[count] = (level - 1, number);
                    count += 1;
                } else if self.clusters[number as usize].blocks(segment, depth) {
                    return true;
                }
            }
        }
        false
    }
}

// What is called from the loops below is always inlined: it takes their instruction set.

#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn any_all(hierarchy: &Hierarchy, segments: &[RayPart], depth: f32, met: &mut [bool]) {
    let mut near = NearClusters::default();
    for (segments, met) in segments.chunks(BUNDLE).zip(met.chunks_mut(BUNDLE)) {
        let is_narrow = SegmentBeam::new(segments).is_some_and(|beam| hierarchy.near_beam(&beam, &mut near));
        for (segment, met) in segments.iter().zip(met) {
            *met = if is_narrow {
                near.blocks(hierarchy, segment, depth)
            } else {
                hierarchy.blocks(segment, depth)
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles at places that a simple generator gives, and rays among them: the same answers as from
    /// trying every triangle.
    #[test]
    fn a_walk_finds_what_trying_all_triangles_finds() {
        let mut random = fastrand::Rng::with_seed(7);
        for count in [1, 8, 9, 64, 65, 700] {
            let mut number = || random.f32() * 2.0 - 1.0;
            let mut positions = Vec::new();
            for _ in 0..count {
                let middle = [number(), number(), number()];
                for _ in 0..3 {
                    positions.push(middle.map(|x| x + 0.2 * number()));
                }
            }
            let triangles: Vec<[u32; 3]> = (0..count).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
            let hierarchy = Hierarchy::new(&positions, &triangles).unwrap();
            let mut hits = 0;
            let segments: Vec<RayPart> = (0..400)
                .map(|index| {
                    let (to, from) = ([number(), number(), number()], [number(), number(), number()]);
                    let way = [0, 1, 2].map(|axis| to[axis] - from[axis]);
                    let length = way.iter().map(|x| x * x).sum::<f32>().sqrt();
                    let mut direction = way.map(|x| x / length);
                    if index % 7 == 0 {
                        direction = [0.0, 0.0, -1.0];
                    }
                    RayPart { origin: from, direction, reach: 3.0 * (number() + 1.0) }
                })
                .collect();
            let depth = 0.3;
            let blocked = hierarchy.any_of(&segments, depth);
            for (segment, blocked) in segments.iter().zip(blocked) {
                let mut all = Vec::new();
                for cluster in &hierarchy.clusters {
                    let (distances, behind) = cluster.meet(segment, segment.reach);
                    all.extend(distances.into_iter().zip(behind).filter(|(t, _)| t.is_finite()));
                }
                assert_eq!(blocked, all.iter().any(|&(t, behind)| t > depth || behind == 0));
                hits += u32::from(blocked);
            }
            assert!(count < 64 || hits > 20, "{count}: {hits}");
        }
    }

    #[test]
    fn no_triangles_no_hierarchy() {
        assert!(Hierarchy::new(&[], &[]).is_none());
    }
}
