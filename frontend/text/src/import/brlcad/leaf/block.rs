//! Solids between planes: blocks of eight points, half spaces, and any number of planes.

use glam::DVec3;
use jbt_ir::limits::MAX_PLANES;
use jbt_model::bounds::Bounds;
use jbt_model::skeleton::HalfSpace;
use jbt_model::tree::Tree;

use super::make::{Flaw, LeafStyle, SolidLeaf, direction, formula, frame, grown};
use super::parts::{HalfField, SolidParts};

/// The faces of a block, by its points.
const FACES: [[usize; 4]; 6] =
    [[0, 1, 2, 3], [7, 6, 5, 4], [0, 3, 7, 4], [1, 5, 6, 2], [0, 4, 5, 1], [3, 2, 6, 7]];
/// What is less of a size than this is nothing.
const NEAR: f64 = 1e-9;

/// The plane of a face: `normal . p <= offset` behind it, the normal of length 1.
#[derive(Clone, Copy)]
struct FacePlane {
    normal: DVec3,
    offset: f64,
}

impl FacePlane {
    fn height(self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }
}

/// The convex solid of eight points, of which several may be one.
pub(super) fn block(points: &[DVec3; 8], style: LeafStyle) -> Result<SolidLeaf, Flaw> {
    let bounds = Bounds::around(points.iter().copied());
    if let Some(leaf) = slanted_box(points, bounds, style) {
        return Ok(leaf);
    }
    let size = bounds.longest_side();
    let mut distinct: Vec<DVec3> = Vec::new();
    for point in points {
        if !distinct.iter().any(|other| other.distance(*point) <= NEAR * size) {
            distinct.push(*point);
        }
    }
    let middle = distinct.iter().sum::<DVec3>() / distinct.len() as f64;
    let mut planes: Vec<FacePlane> = Vec::new();
    for face in FACES {
        planes.extend(plane(&face.map(|corner| points[corner]), middle, size));
    }
    // Of six planes at most, some may be one.
    let mut faces: Vec<FacePlane> = Vec::new();
    for plane in planes {
        let is_same = |other: &FacePlane| {
            other.normal.distance(plane.normal) <= NEAR && (other.offset - plane.offset).abs() <= NEAR * size
        };
        if !faces.iter().any(is_same) {
            faces.push(plane);
        }
    }
    if faces.len() < 4 {
        return Err(format!("it has {} faces", faces.len()));
    }
    let depth = |plane: &FacePlane| -plane.height(middle);
    let thickness = faces.iter().map(depth).fold(f64::INFINITY, f64::min);
    if thickness <= NEAR * size {
        return Err("it has no thickness".to_owned());
    }
    let scale = 0.5 / thickness;
    let field = |plane: &FacePlane| HalfField {
        slope: (plane.normal * scale).to_array(),
        offset: 0.5 + depth(plane) * scale,
    };
    let inside =
        SolidParts { planes: faces.iter().map(field).collect(), ..SolidParts::default() }.field(style);
    // Twice as large about the middle it would hold all of the field; sharp corners are cut off before.
    let (low, high) = (bounds.min - middle, bounds.max - middle);
    let margin = DVec3::splat(2.0 * thickness);
    let within = Bounds::new((2.0 * low).max(low - margin), (2.0 * high).min(high + margin));
    let tree = formula(inside, within, &glam::DAffine3::from_translation(middle));
    Ok(SolidLeaf { tree, bounds, nodes: 2, has_radius: false })
}

/// The plane of a face, outwards from the middle; none of a face without an area.
fn plane(corners: &[DVec3; 4], middle: DVec3, size: f64) -> Option<FacePlane> {
    // Newell's sum: twice the area, whatever the corners.
    let mut normal = DVec3::ZERO;
    for at in 0..4 {
        normal += (corners[at] - middle).cross(corners[(at + 1) % 4] - middle);
    }
    if normal.length() <= NEAR * size * size {
        return None;
    }
    let normal = normal.normalize();
    let offset = normal.dot(corners.iter().sum::<DVec3>() / 4.0);
    let outwards = if normal.dot(middle) > offset { -1.0 } else { 1.0 };
    Some(FacePlane { normal: normal * outwards, offset: offset * outwards })
}

/// Eight points that are the corners of a box, right or slanted: one formula in the frame of its edges.
fn slanted_box(points: &[DVec3; 8], bounds: Bounds, style: LeafStyle) -> Option<SolidLeaf> {
    let edges = [points[1] - points[0], points[3] - points[0], points[4] - points[0]];
    let [a, b, c] = edges;
    let near = NEAR * bounds.longest_side();
    // The points are numbered round the base, then round the top.
    let expected = [DVec3::ZERO, a, a + b, b, c, a + c, a + b + c, b + c];
    let is_box = points.iter().zip(expected).all(|(p, offset)| p.distance(points[0] + offset) <= near);
    if !is_box {
        return None;
    }
    let middle = points[0] + 0.5 * (a + b + c);
    let frame = frame(middle, edges.map(|edge| 0.5 * edge)).ok()?;
    let volume = a.cross(b).dot(c).abs();
    let half = [b.cross(c), c.cross(a), a.cross(b)].map(|side| 0.5 * volume / side.length());
    let thickness = half.iter().copied().fold(f64::INFINITY, f64::min);
    let sharp = half.map(|half| 0.5 * half / thickness);
    let slabs = sharp.into_iter().enumerate().collect();
    let inside = SolidParts { slabs, ..SolidParts::default() }.field(style);
    let reach = DVec3::from_array(sharp.map(|sharp| 1.0 + 0.5 / sharp));
    let tree = formula(inside, Bounds::new(-reach, reach), &frame);
    Some(SolidLeaf { tree, bounds, nodes: 2, has_radius: false })
}

/// All points with `N . p <= d`.
pub(super) fn half(normal: DVec3, d: f64, reach: f64) -> Result<SolidLeaf, Flaw> {
    let (unit, length) = direction("N", normal)?;
    let tree = behind(FacePlane { normal: unit, offset: d / length }, reach);
    Ok(SolidLeaf { tree, bounds: Bounds::EMPTY, nodes: 1, has_radius: false })
}

/// What is behind a plane, with a field of this thickness.
fn behind(plane: FacePlane, thickness: f64) -> Tree {
    let at = plane.normal * (plane.offset - thickness);
    grown(HalfSpace { at, normal: plane.normal }, thickness)
}

/// All points with `N . p <= d` for each of several planes.
pub(super) fn planes(all: &[[f64; 4]], reach: f64) -> Result<SolidLeaf, Flaw> {
    if all.is_empty() || all.len() > MAX_PLANES {
        return Err(format!("it has {} planes, and 1 to {MAX_PLANES} are read", all.len()));
    }
    let mut planes = Vec::with_capacity(all.len());
    for &[a, b, c, d] in all {
        let (normal, length) = direction("N", DVec3::new(a, b, c))?;
        planes.push(FacePlane { normal, offset: d / length });
    }
    let far = planes.iter().map(|plane| plane.offset.abs()).fold(reach, f64::max) * 1e3;
    let corners = corners(&planes, far);
    if corners.is_empty() {
        return Err("its planes have nothing in common".to_owned());
    }
    let bounds = Bounds::around(corners);
    let nodes = planes.len() + 2;
    if bounds.min.min_element() <= -far || bounds.max.max_element() >= far {
        let tree = Tree::intersection(planes.iter().map(|&plane| behind(plane, reach)));
        return Ok(SolidLeaf { tree, bounds: Bounds::EMPTY, nodes, has_radius: false });
    }
    let middle = 0.5 * (bounds.min + bounds.max);
    let depth = planes.iter().map(|plane| -plane.height(middle)).fold(f64::INFINITY, f64::min);
    let thickness = depth.max(1e-3 * bounds.longest_side());
    let tree = Tree::intersection(planes.iter().map(|&plane| behind(plane, thickness)));
    let tree = tree.within(
        bounds.min.to_array().map(|low| low - thickness),
        bounds.max.to_array().map(|high| high + thickness),
    );
    Ok(SolidLeaf { tree, bounds, nodes, has_radius: false })
}

/// The corners of a convex solid between planes and within a cube of this half side: the faces of the cube
/// are cut by each plane, and every cut adds a face.
fn corners(planes: &[FacePlane], far: f64) -> Vec<DVec3> {
    let cube = |corner: usize| {
        let sign = |axis: usize| if corner >> axis & 1 == 0 { -far } else { far };
        DVec3::new(sign(0), sign(1), sign(2))
    };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut faces: Vec<Vec<DVec3>> = sides.map(|side| side.map(cube).to_vec()).to_vec();
    for &plane in planes {
        let mut cut: Vec<DVec3> = Vec::new();
        for face in &mut faces {
            *face = clipped(face, plane, &mut cut);
        }
        faces.retain(|face| face.len() > 2);
        around(&mut cut, plane.normal);
        if cut.len() > 2 {
            faces.push(cut);
        }
    }
    faces.into_iter().flatten().collect()
}

/// The part of a face behind a plane. Points on the plane are added to the cut.
fn clipped(face: &[DVec3], plane: FacePlane, cut: &mut Vec<DVec3>) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(face.len() + 1);
    for (at, &p) in face.iter().enumerate() {
        let q = face[(at + 1) % face.len()];
        let (height, next) = (plane.height(p), plane.height(q));
        if height <= 0.0 {
            kept.push(p);
        }
        if (height <= 0.0) != (next <= 0.0) {
            let crossing = p + (q - p) * (height / (height - next));
            kept.push(crossing);
            cut.push(crossing);
        }
    }
    kept
}

/// Puts the corners of a convex face into their order about its middle. Each stands there twice, once for
/// each face that was cut.
fn around(corners: &mut Vec<DVec3>, normal: DVec3) {
    if corners.is_empty() {
        return;
    }
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let (first, second) = normal.any_orthonormal_pair();
    let angle = |p: &DVec3| (*p - middle).dot(second).atan2((*p - middle).dot(first));
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    corners.dedup_by(|a, b| a.distance(*b) <= 1e-12 * (a.length() + b.length()));
}
