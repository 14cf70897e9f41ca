//! A hierarchy of boxes around the triangles of a mesh, and rays that meet them.
//!
//! ```text
//! triangles of a mesh, in Morton order   ▵▵▵▵▵▵▵▵ ▵▵▵▵▵▵▵▵ ▵▵▵▵▵▵▵▵ ..      eight of them are a cluster,
//! boxes of clusters                      [  ][  ][  ][  ][  ][  ][  ][  ]   eight boxes are a node,
//! boxes of nodes                         [          ][          ] ..        and so on up to one node
//! ```
//!
//! The mesher writes triangles in the order of their cells, which is Morton order. So neighbours in the list
//! are neighbours in space, and nothing is sorted: to build the hierarchy is to compute boxes. A ray is tested
//! against eight boxes, or eight triangles, at once.
//!
//! Clusters, boxes and the order of a walk depend on the mesh alone, and no product is fused with a sum. So
//! answers have the same bits for every instruction set and any number of threads.

use crate::parallel::*;

/// Boxes of a node, and triangles of a cluster.
const WIDE: usize = 8;
/// A number for each of them.
type EightLanes = [f32; WIDE];

/// By how much a triangle reaches beyond its edges, as a part of it: no ray slips through between two.
const SEAM: f32 = 1e-5;
/// The part by which the far side of a box is moved away, beyond the rounding of three operations.
const SLACK: f32 = 1.0 + 1e-6;
/// The least magnitude of a direction's coordinate that is divided by.
const FLAT: f32 = 1e-30;
/// Every coordinate of a box that is missing. With infinity, its near and its far side would change places.
const FAR_AWAY: f32 = f32::MAX;
/// Nodes that wait at most: seven brothers on each of eleven levels, and the last eight.
const WAITING: usize = 96;

/// A part of a ray that begins at its origin, relative to the model's origin.
#[derive(Clone, Copy)]
pub struct Segment {
    pub origin: [f32; 3],
    /// A unit vector.
    pub direction: [f32; 3],
    /// The length of the part.
    pub reach: f32,
}

/// Where a ray meets a mesh first.
#[derive(Clone, Copy)]
pub struct MeshMeeting {
    /// The distance from the segment's origin.
    pub distance: f32,
    /// The normal of the triangle, of any length, outwards.
    pub normal: [f32; 3],
}

/// Eight triangles: of each a corner, and the edges from there to the other two. What is missing is 0.
#[derive(Clone)]
struct TriangleCluster {
    corner: [EightLanes; 3],
    edges: [[EightLanes; 3]; 2],
}

/// Eight boxes. What is missing is a point beyond any ray.
#[derive(Clone)]
struct BoxNode {
    low: [EightLanes; 3],
    high: [EightLanes; 3],
}

/// The triangles of a mesh in boxes.
pub struct Hierarchy {
    clusters: Vec<TriangleCluster>,
    /// Nodes of clusters, nodes of these nodes, and so on. The last level has one node.
    levels: Vec<Vec<BoxNode>>,
}

/// A box: its smallest and its largest corner.
type Corners = [[f32; 3]; 2];

const NOWHERE: Corners = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

fn joined([low, high]: Corners, [other_low, other_high]: &Corners) -> Corners {
    [
        [0, 1, 2].map(|axis| low[axis].min(other_low[axis])),
        [0, 1, 2].map(|axis| high[axis].max(other_high[axis])),
    ]
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
    fn meet(&self, ray: &Segment, reach: f32) -> (EightLanes, [u32; WIDE]) {
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

    /// The normal of a triangle, of any length.
    fn normal(&self, lane: usize) -> [f32; 3] {
        let [a, b] = self.edges.each_ref().map(|edge| edge.map(|axis| axis[lane]));
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }
}

impl BoxNode {
    /// The node of up to eight boxes, and the box around them.
    fn new(boxes: &[Corners]) -> (Self, Corners) {
        let mut node = Self { low: [[FAR_AWAY; WIDE]; 3], high: [[FAR_AWAY; WIDE]; 3] };
        for (lane, [low, high]) in boxes.iter().enumerate() {
            for axis in 0..3 {
                node.low[axis][lane] = low[axis];
                node.high[axis][lane] = high[axis];
            }
        }
        (node, boxes.iter().fold(NOWHERE, joined))
    }

    /// The distance at which a ray enters each box, or infinity (Kay and Kajiya 1986: slabs).
    #[inline(always)]
    fn enter(&self, origin: [f32; 3], inverse: [f32; 3], reach: f32) -> EightLanes {
        let (mut near, mut far) = ([0.0_f32; WIDE], [reach; WIDE]);
        for axis in 0..3 {
            for i in 0..WIDE {
                let low = (self.low[axis][i] - origin[axis]) * inverse[axis];
                let high = (self.high[axis][i] - origin[axis]) * inverse[axis];
                let (first, last) = if low < high { (low, high) } else { (high, low) };
                near[i] = if first > near[i] { first } else { near[i] };
                far[i] = if last < far[i] { last } else { far[i] };
            }
        }
        let mut entered = [f32::INFINITY; WIDE];
        for i in 0..WIDE {
            entered[i] = if near[i] <= far[i] * SLACK { near[i] } else { f32::INFINITY };
        }
        entered
    }
}

/// A node that waits: where the ray enters it, its level and its number.
#[derive(Clone, Copy)]
struct WaitingNode {
    near: f32,
    level: u32,
    number: u32,
}

/// The boxes that a ray enters, the farthest one first.
#[inline(always)]
fn sorted(entered: &EightLanes) -> ([usize; WIDE], usize) {
    let (mut order, mut count) = ([0; WIDE], 0);
    for lane in (0..WIDE).filter(|&lane| entered[lane] < f32::INFINITY) {
        let mut at = count;
        while at > 0 && entered[order[at - 1]] < entered[lane] {
            order[at] = order[at - 1];
            at -= 1;
        }
        order[at] = lane;
        count += 1;
    }
    (order, count)
}

impl Hierarchy {
    /// The hierarchy of a mesh's triangles; `None` without triangles.
    pub fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Option<Self> {
        let made: Vec<(TriangleCluster, Corners)> = triangles
            .par_chunks(WIDE)
            .with_min_len(1024)
            .map(|some| TriangleCluster::new(positions, some))
            .collect();
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

    /// Where each segment meets the mesh first, from either side.
    pub fn first_of(&self, segments: &[Segment]) -> Vec<Option<MeshMeeting>> {
        let mut met = vec![None; segments.len()];
        first_all(self, segments, &mut met);
        met
    }

    /// Which segments meet the mesh. Triangles that a segment meets from behind count only at distances
    /// beyond `depth`: a segment that begins a little below the surface leaves it again.
    pub fn any_of(&self, segments: &[Segment], depth: f32) -> Vec<bool> {
        let mut met = vec![false; segments.len()];
        any_all(self, segments, depth, &mut met);
        met
    }

    /// Shows `visit` the clusters that a ray may meet, the nearest first, roughly. It returns the distance up
    /// to which the walk goes on, or less than 0 to end it.
    #[inline(always)]
    fn walk(&self, ray: &Segment, mut visit: impl FnMut(&TriangleCluster, f32) -> f32) {
        let inverse = ray.direction.map(|x| 1.0 / if x.abs() < FLAT { FLAT.copysign(x) } else { x });
        let mut reach = ray.reach;
        let mut waiting =
            [WaitingNode { near: 0.0, level: self.levels.len() as u32 - 1, number: 0 }; WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let WaitingNode { near, level, number } = waiting[count];
            if near > reach {
                continue;
            }
            let entered = self.levels[level as usize][number as usize].enter(ray.origin, inverse, reach);
            let (order, found) = sorted(&entered);
            for &lane in order[..found].iter().filter(|_| level > 0) {
                let number = number * WIDE as u32 + lane as u32;
                waiting[count] = WaitingNode { near: entered[lane], level: level - 1, number };
                count += 1;
            }
            for &lane in order[..found].iter().rev().filter(|_| level == 0) {
                if entered[lane] <= reach {
                    reach = visit(&self.clusters[number as usize * WIDE + lane], reach);
                }
            }
            if reach < 0.0 {
                return;
            }
        }
    }
}

#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn first_all(hierarchy: &Hierarchy, segments: &[Segment], met: &mut [Option<MeshMeeting>]) {
    for (segment, met) in segments.iter().zip(met) {
        hierarchy.walk(segment, |cluster, reach| {
            let (distances, _) = cluster.meet(segment, reach);
            let mut best = reach;
            for (lane, &distance) in distances.iter().enumerate() {
                if distance < best || (distance == best && met.is_none()) {
                    best = distance;
                    *met = Some(MeshMeeting { distance, normal: cluster.normal(lane) });
                }
            }
            best
        });
    }
}

#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn any_all(hierarchy: &Hierarchy, segments: &[Segment], depth: f32, met: &mut [bool]) {
    for (segment, met) in segments.iter().zip(met) {
        hierarchy.walk(segment, |cluster, reach| {
            let (distances, behind) = cluster.meet(segment, reach);
            let mut counts = 0;
            for i in 0..WIDE {
                counts |= u32::from(distances[i] < f32::INFINITY)
                    & (u32::from(distances[i] > depth) | (1 - behind[i]));
            }
            *met = counts != 0;
            if *met { -1.0 } else { reach }
        });
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
            let segments: Vec<Segment> = (0..400)
                .map(|index| {
                    let (to, from) = ([number(), number(), number()], [number(), number(), number()]);
                    let way = [0, 1, 2].map(|axis| to[axis] - from[axis]);
                    let length = way.iter().map(|x| x * x).sum::<f32>().sqrt();
                    let mut direction = way.map(|x| x / length);
                    if index % 7 == 0 {
                        direction = [0.0, 0.0, -1.0];
                    }
                    Segment { origin: from, direction, reach: 3.0 * (number() + 1.0) }
                })
                .collect();
            let firsts = hierarchy.first_of(&segments);
            let depth = 0.3;
            let blocked = hierarchy.any_of(&segments, depth);
            for ((segment, first), blocked) in segments.iter().zip(firsts).zip(blocked) {
                let mut all = Vec::new();
                for cluster in &hierarchy.clusters {
                    let (distances, behind) = cluster.meet(segment, segment.reach);
                    all.extend(distances.into_iter().zip(behind).filter(|(t, _)| t.is_finite()));
                }
                let nearest = all.iter().map(|(t, _)| *t).fold(f32::INFINITY, f32::min);
                assert_eq!(first.map_or(f32::INFINITY, |met| met.distance), nearest);
                assert_eq!(blocked, all.iter().any(|&(t, behind)| t > depth || behind == 0));
                hits += u32::from(first.is_some());
            }
            assert!(count < 64 || hits > 20, "{count}: {hits}");
        }
    }

    #[test]
    fn no_triangles_no_hierarchy() {
        assert!(Hierarchy::new(&[], &[]).is_none());
    }
}
