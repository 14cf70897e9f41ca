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
/// Segments that are led through the hierarchy together.
const BUNDLE: usize = 64;
/// Clusters beside such a bundle, beyond which each segment walks alone.
const MANY: usize = 192;
/// The least mean of unit directions of a bundle.
const STRAIGHT: f32 = 0.9;
/// A bound of the rounding of a plane, as a part of all lengths in it.
const ROUNDING: f32 = 1e-5;
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

#[inline(always)]
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
    #[inline(always)]
    fn normal(&self, lane: usize) -> [f32; 3] {
        let [a, b] = self.edges.each_ref().map(|edge| edge.map(|axis| axis[lane]));
        cross(a, b)
    }
}

impl BoxNode {
    const EMPTY: Self = Self { low: [[FAR_AWAY; WIDE]; 3], high: [[FAR_AWAY; WIDE]; 3] };

    /// The node of up to eight boxes, and the box around them.
    fn new(boxes: &[Corners]) -> (Self, Corners) {
        let mut node = Self::EMPTY;
        for (lane, [low, high]) in boxes.iter().enumerate() {
            for axis in 0..3 {
                node.low[axis][lane] = low[axis];
                node.high[axis][lane] = high[axis];
            }
        }
        (node, boxes.iter().fold(NOWHERE, joined))
    }

    /// For each box that reaches into a beam a bound of its distance from where the beam begins; infinity for
    /// the others.
    #[inline(always)]
    fn within(&self, beam: &Beam) -> EightLanes {
        let mut outside = [0_u32; WIDE];
        for ([x, y, z], most) in &beam.planes {
            let side =
                |axis: usize, normal: f32| if normal > 0.0 { &self.low[axis] } else { &self.high[axis] };
            let corner = [side(0, *x), side(1, *y), side(2, *z)];
            for i in 0..WIDE {
                outside[i] |= u32::from(corner[0][i] * x + corner[1][i] * y + corner[2][i] * z > *most);
            }
        }
        let mut square = [0.0_f32; WIDE];
        for axis in 0..3 {
            for i in 0..WIDE {
                let below = self.low[axis][i] - beam.origins[1][axis];
                let above = beam.origins[0][axis] - self.high[axis][i];
                let gap = if below > above { below } else { above };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                square[i] += gap * gap;
            }
        }
        let mut distances = [f32::INFINITY; WIDE];
        for i in 0..WIDE {
            distances[i] = if outside[i] == 0 { square[i].sqrt() / SLACK } else { f32::INFINITY };
        }
        distances
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

/// The clusters beside a bundle of segments.
#[derive(Default)]
struct NearClusters {
    /// Each with a bound of its distance from where the bundle begins; the nearest first.
    clusters: Vec<(f32, u32)>,
    /// Their boxes, in this order.
    boxes: Vec<BoxNode>,
}

impl NearClusters {
    /// Shows `visit` the clusters whose boxes a segment enters: see [`Hierarchy::walk`].
    #[inline(always)]
    fn walk(
        &self,
        hierarchy: &Hierarchy,
        segment: &Segment,
        mut visit: impl FnMut(&TriangleCluster, f32) -> f32,
    ) {
        let (inverse, mut reach) = (inverse(segment.direction), segment.reach);
        for (node, clusters) in self.boxes.iter().zip(self.clusters.chunks(WIDE)) {
            if clusters[0].0 > reach {
                return;
            }
            let entered = node.enter(segment.origin, inverse, reach);
            let mut mask = finite_lanes(&entered);
            while mask != 0 {
                let lane = (mask.trailing_zeros() & 7) as usize;
                mask &= mask - 1;
                if entered[lane] <= reach {
                    reach = visit(&hierarchy.clusters[clusters[lane].1 as usize], reach);
                }
            }
        }
    }
}

/// The inverse of a direction's coordinates, all finite.
#[inline(always)]
fn inverse(direction: [f32; 3]) -> [f32; 3] {
    direction.map(|x| 1.0 / if x.abs() < FLAT { FLAT.copysign(x) } else { x })
}

/// The space that some segments go through: what is on the inner side of four planes, and where they begin.
struct Beam {
    /// Normals, outwards, and the largest product of a point of the beam with each.
    planes: [([f32; 3], f32); 4],
    origins: Corners,
}

impl Beam {
    /// The beam of segments that go about the same way; `None` if they do not.
    ///
    /// Along the mean direction, `across(t) = across(0) + t * slope` for each segment, so the largest of all
    /// at both ends bounds them between.
    #[inline(always)]
    fn new(segments: &[Segment]) -> Option<Self> {
        let mut mean = [0.0_f32; 3];
        for segment in segments {
            mean = [0, 1, 2].map(|axis| mean[axis] + segment.direction[axis]);
        }
        let length = dot(mean, mean).sqrt();
        if length < STRAIGHT * segments.len() as f32 {
            return None;
        }
        let ahead = mean.map(|x| x / length);
        let least =
            (0..3).fold(0, |best, axis| if ahead[axis].abs() < ahead[best].abs() { axis } else { best });
        let mut along = [0.0; 3];
        along[least] = 1.0;
        let right = cross(ahead, along);
        let right = right.map(|x| x / dot(right, right).sqrt());
        let aside = [right, cross(ahead, right)];
        let mut origins = NOWHERE;
        let mut depths = [f32::INFINITY, f32::NEG_INFINITY];
        for segment in segments {
            let depth = dot(segment.origin, ahead);
            origins = joined(origins, &[segment.origin, segment.origin]);
            depths = [depths[0].min(depth), depths[1].max(depth + segment.reach)];
        }
        let mut ends = [[f32::NEG_INFINITY; 4]; 2];
        for segment in segments {
            let (from, speed) = (dot(segment.origin, ahead), 1.0 / dot(segment.direction, ahead));
            for (ends, depth) in ends.iter_mut().zip(depths) {
                let t = (depth - from) * speed;
                for (axis, aside) in aside.iter().enumerate() {
                    let across = dot(segment.origin, *aside) + t * dot(segment.direction, *aside);
                    ends[2 * axis] = ends[2 * axis].max(across);
                    ends[2 * axis + 1] = ends[2 * axis + 1].max(-across);
                }
            }
        }
        let size = (0..3).fold(depths[1] - depths[0], |size: f32, axis| {
            size.max(origins[0][axis].abs()).max(origins[1][axis].abs())
        });
        let planes = std::array::from_fn(|plane| {
            let slope = (ends[1][plane] - ends[0][plane]) / (depths[1] - depths[0]).max(f32::MIN_POSITIVE);
            let sign = if plane % 2 == 0 { 1.0 } else { -1.0 };
            let normal = [0, 1, 2].map(|axis| sign * aside[plane / 2][axis] - slope * ahead[axis]);
            (normal, ends[0][plane] - slope * depths[0] + ROUNDING * (1.0 + slope.abs()) * size)
        });
        Some(Self { planes, origins })
    }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A node that waits: where the ray enters it, its level and its number.
#[derive(Clone, Copy)]
struct WaitingNode {
    near: f32,
    level: u32,
    number: u32,
}

/// The lanes whose bits are set in a mask, the farthest one first, and their number.
#[inline(always)]
fn sorted(mut mask: u32, entered: &EightLanes) -> ([u8; WIDE], usize) {
    let (mut order, mut count) = ([0_u8; WIDE], 0);
    while mask != 0 {
        let lane = (mask.trailing_zeros() & 7) as u8;
        mask &= mask - 1;
        let mut at = count;
        while at > 0 && entered[usize::from(order[at - 1] & 7)] < entered[usize::from(lane)] {
            order[at & 7] = order[at - 1];
            at -= 1;
        }
        order[at & 7] = lane;
        count += 1;
    }
    (order, count)
}

/// A bit for each lane that is finite.
#[inline(always)]
fn finite_lanes(lanes: &EightLanes) -> u32 {
    let mut bits = [0; WIDE];
    for i in 0..WIDE {
        bits[i] = u32::from(lanes[i] < f32::INFINITY) << i;
    }
    bits.iter().fold(0, |mask, bit| mask | bit)
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

    /// Where each segment meets the mesh first, from either side. It is fast where neighbours in the list are
    /// neighbours in space.
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

    /// Collects the clusters whose boxes reach into a beam. Whether there are few enough.
    #[inline(always)]
    fn near_beam(&self, beam: &Beam, near: &mut NearClusters) -> bool {
        near.clusters.clear();
        near.boxes.clear();
        let mut waiting = [(self.levels.len() as u32 - 1, 0_u32); WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (level, number) = waiting[count];
            let distances = self.levels[level as usize][number as usize].within(beam);
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

    /// Shows `visit` the clusters that a ray may meet, the nearest first, roughly. It returns the distance up
    /// to which the walk goes on, or less than 0 to end it.
    #[inline(always)]
    fn walk(&self, ray: &Segment, mut visit: impl FnMut(&TriangleCluster, f32) -> f32) {
        let (inverse, mut reach) = (inverse(ray.direction), ray.reach);
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
            let (order, found) = sorted(finite_lanes(&entered), &entered);
            let first = number * WIDE as u32;
            if level > 0 {
                for &lane in &order[..found] {
                    let near = entered[usize::from(lane & 7)];
                    waiting[count] = WaitingNode { near, level: level - 1, number: first + u32::from(lane) };
                    count += 1;
                }
                continue;
            }
            for &lane in order[..found].iter().rev() {
                if entered[usize::from(lane & 7)] <= reach {
                    reach = visit(&self.clusters[(first + u32::from(lane)) as usize], reach);
                }
            }
            if reach < 0.0 {
                return;
            }
        }
    }
}

/// Looks for a nearer meeting in a cluster. Returns the distance up to which to look on.
#[inline(always)]
fn first_in(cluster: &TriangleCluster, segment: &Segment, reach: f32, met: &mut Option<MeshMeeting>) -> f32 {
    let (distances, _) = cluster.meet(segment, reach);
    let mut mask = finite_lanes(&distances);
    let mut best = reach;
    while mask != 0 {
        let lane = (mask.trailing_zeros() & 7) as usize;
        mask &= mask - 1;
        let distance = distances[lane];
        if distance < best || (distance == best && met.is_none()) {
            best = distance;
            *met = Some(MeshMeeting { distance, normal: cluster.normal(lane) });
        }
    }
    best
}

/// Notes whether a segment meets a cluster: see [`Hierarchy::any_of`]. Returns the distance up to which to look
/// on: less than 0 if it does.
#[inline(always)]
fn any_in(cluster: &TriangleCluster, segment: &Segment, (depth, reach): (f32, f32), met: &mut bool) -> f32 {
    let (distances, behind) = cluster.meet(segment, segment.reach);
    let mut counts = 0;
    for i in 0..WIDE {
        let is_met = u32::from(distances[i] < f32::INFINITY);
        counts |= is_met & (u32::from(distances[i] > depth) | (1 - behind[i]));
    }
    *met = counts != 0;
    if *met { -1.0 } else { reach }
}

// What is called from the loops below is always inlined: it takes their instruction set.

#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn first_all(hierarchy: &Hierarchy, segments: &[Segment], met: &mut [Option<MeshMeeting>]) {
    let mut near = NearClusters::default();
    for (segments, met) in segments.chunks(BUNDLE).zip(met.chunks_mut(BUNDLE)) {
        let is_narrow = Beam::new(segments).is_some_and(|beam| hierarchy.near_beam(&beam, &mut near));
        for (segment, met) in segments.iter().zip(met) {
            if is_narrow {
                near.walk(hierarchy, segment, |cluster, reach| first_in(cluster, segment, reach, met));
            } else {
                hierarchy.walk(segment, |cluster, reach| first_in(cluster, segment, reach, met));
            }
        }
    }
}

#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn any_all(hierarchy: &Hierarchy, segments: &[Segment], depth: f32, met: &mut [bool]) {
    let mut near = NearClusters::default();
    for (segments, met) in segments.chunks(BUNDLE).zip(met.chunks_mut(BUNDLE)) {
        let is_narrow = Beam::new(segments).is_some_and(|beam| hierarchy.near_beam(&beam, &mut near));
        for (segment, met) in segments.iter().zip(met) {
            if is_narrow {
                near.walk(hierarchy, segment, |cluster, reach| any_in(cluster, segment, (depth, reach), met));
            } else {
                hierarchy.walk(segment, |cluster, reach| any_in(cluster, segment, (depth, reach), met));
            }
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
