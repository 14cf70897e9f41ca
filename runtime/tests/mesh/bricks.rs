//! What is asked of a field that knows something about boxes: no point twice, no point out of its region, and
//! little far from the surface.

use std::collections::HashSet;
use std::convert::Infallible;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use jbt::Box3;
use jbt::boxes::Divisible;
use jbt::mesh::{Field, FieldWork, Lattice, Mesh, MeshReport, Options, Sides, check_manifold, extract};

use crate::fields::{Closed, Sample, hash, signs, sphere, torus};
use crate::topology::bits;

/// A field with its range in a box. It checks that boxes are inside of their regions and points too, and that
/// the field is not asked twice at a point of the lattice.
struct Checked<F, R> {
    field: Closed<F>,
    range: R,
    /// The bits of the lattice's coordinates.
    axes: [HashSet<u32>; 3],
    sampled: Mutex<HashSet<[u32; 3]>>,
    regions: AtomicU64,
    narrowed: AtomicU64,
}

impl<F: Fn([f32; 3]) -> Sample + Sync, R: Fn(&Box3) -> [f32; 2] + Sync> Checked<F, R> {
    fn new(field: F, range: R, lattice: &Lattice) -> Self {
        let (regions, narrowed) = (AtomicU64::new(0), AtomicU64::new(0));
        let points = lattice.points();
        let axes =
            [0, 1, 2].map(|axis| (0..points[axis]).map(|i| lattice.coordinate(axis, i).to_bits()).collect());
        Self { field: Closed(field), range, axes, sampled: Mutex::default(), regions, narrowed }
    }

    fn check_boxes(&self, region: &Box3, boxes: &[Box3]) {
        assert!((1..=8).contains(&boxes.len()));
        for inner in boxes {
            assert!((0..3).all(|axis| inner.low[axis] < inner.high[axis]), "{inner:?} has no volume");
            assert!(region.contains(inner.low) && region.contains(inner.high), "{inner:?} leaves {region:?}");
        }
    }

    fn check_points(&self, region: &Box3, x: &[f32], y: &[f32], z: &[f32]) {
        assert!(!x.is_empty());
        for ((&x, &y), &z) in x.iter().zip(y).zip(z) {
            assert!(region.contains([x, y, z]), "{:?} is not in {region:?}", [x, y, z]);
        }
    }
}

impl<F: Fn([f32; 3]) -> Sample + Sync, R: Fn(&Box3) -> [f32; 2] + Sync> Divisible for Checked<F, R> {
    type Error = Infallible;
    type Region = Box3;

    fn region(&self, bounds: Box3) -> Result<Box3, Infallible> {
        self.regions.fetch_add(1, Ordering::Relaxed);
        Ok(bounds)
    }

    fn ranges(&self, region: &Box3, boxes: &[Box3], ranges: &mut [[f32; 2]]) -> Result<(), Infallible> {
        self.check_boxes(region, boxes);
        assert_eq!(boxes.len(), ranges.len());
        for (range, inner) in ranges.iter_mut().zip(boxes) {
            *range = (self.range)(inner);
        }
        Ok(())
    }

    fn narrow(&self, region: &Box3, boxes: &[Box3], parts: &mut Vec<Box3>) -> Result<(), Infallible> {
        self.check_boxes(region, boxes);
        self.narrowed.fetch_add(boxes.len() as u64, Ordering::Relaxed);
        parts.extend_from_slice(boxes);
        Ok(())
    }
}

impl<F: Fn([f32; 3]) -> Sample + Sync, R: Fn(&Box3) -> [f32; 2] + Sync> Field for Checked<F, R> {
    fn attributes(&self) -> Vec<(String, usize)> {
        self.field.attributes()
    }

    fn work(&self, _: &Box3) -> FieldWork {
        FieldWork::default()
    }

    fn field(
        &self,
        region: &Box3,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
    ) -> Result<(), Infallible> {
        self.check_points(region, x, y, z);
        let mut sampled = self.sampled.lock().unwrap();
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            let point = [x, y, z].map(|c| c.to_bits());
            if (0..3).all(|axis| self.axes[axis].contains(&point[axis])) {
                assert!(sampled.insert(point), "{:?} is sampled twice", [x, y, z]);
            }
        }
        drop(sampled);
        self.field.field(&(), x, y, z, field)
    }

    fn gradient(
        &self,
        region: &Box3,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
    ) -> Result<(), Infallible> {
        self.check_points(region, x, y, z);
        self.field.gradient(&(), x, y, z, field, gradient)
    }

    fn all(
        &self,
        region: &Box3,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
        attributes: &mut [&mut [f32]],
    ) -> Result<(), Infallible> {
        self.check_points(region, x, y, z);
        self.field.all(&(), x, y, z, field, gradient, attributes)
    }
}

/// The smallest and the largest distance of an interval from a number.
fn distances(low: f64, high: f64, from: f64) -> [f64; 2] {
    [(low - from).max(from - high).max(0.0), (from - low).abs().max((from - high).abs())]
}

/// By how much f32 may be off in the fields of these tests, which are of the size of one.
const ROUNDING: f64 = 1e-5;

fn range([near, far]: [f64; 2], radius: f32) -> [f32; 2] {
    let field = |distance: f64| 0.5 + f64::from(radius) - distance;
    [(field(far) - ROUNDING) as f32, (field(near) + ROUNDING) as f32]
}

fn sphere_range(center: [f32; 3], radius: f32) -> impl Fn(&Box3) -> [f32; 2] + Sync {
    move |inner| {
        let along =
            |axis: usize| distances(inner.low[axis].into(), inner.high[axis].into(), center[axis].into());
        let [x, y, z] = [along(0), along(1), along(2)];
        range([0, 1].map(|end| x[end].hypot(y[end]).hypot(z[end])), radius)
    }
}

fn torus_range(major: f32, minor: f32) -> impl Fn(&Box3) -> [f32; 2] + Sync {
    move |inner| {
        let along = |axis: usize| distances(inner.low[axis].into(), inner.high[axis].into(), 0.0);
        let [x, y, z] = [along(0), along(1), along(2)];
        let ring = [0, 1].map(|end| x[end].hypot(y[end]));
        let off = distances(ring[0], ring[1], major.into());
        range([0, 1].map(|end| off[end].hypot(z[end])), minor)
    }
}

fn with_brick(brick: usize) -> Options {
    Options { brick: Some(brick), ..Options::default() }
}

/// Meshes with every brick size; the meshes have the same bits as without ranges.
fn mesh<F, R>(field: impl Fn() -> F, range: impl Fn() -> R, lattice: &Lattice) -> Vec<(Mesh, MeshReport)>
where
    F: Fn([f32; 3]) -> Sample + Sync,
    R: Fn(&Box3) -> [f32; 2] + Sync,
{
    let (dense, expected) = extract(&Closed(field()), lattice, &Options::default()).run().unwrap();
    let of = |brick| {
        let checked = Checked::new(field(), range(), lattice);
        let (mesh, report) = extract(&checked, lattice, &with_brick(brick)).run().unwrap();
        assert!(bits(&mesh) == bits(&dense), "bricks of {brick}");
        assert_eq!((report.closed, report.cut_sides), (expected.closed, expected.cut_sides));
        assert_eq!(report.crossing_cells, expected.crossing_cells);
        assert_eq!(report.field_evaluations, checked.sampled.into_inner().unwrap().len() as u64);
        let kept = report.boxes - report.boxes_inside - report.boxes_outside;
        // The whole lattice, if it is kept, has been asked for its region.
        assert_eq!(checked.narrowed.into_inner(), kept.saturating_sub(1));
        assert_eq!(checked.regions.into_inner(), 1);
        (mesh, report)
    };
    [2, 4, 8, 16, 32].map(of).into()
}

#[test]
fn a_sphere_takes_bricks_at_its_surface() {
    let center = [0.1, -0.2, 0.03];
    let lattice = Lattice::covering([-1.3, -1.4, -1.2], [1.3, 1.1, 1.3], 0.023).unwrap();
    let made = mesh(|| sphere(center, 1.0), || sphere_range(center, 1.0), &lattice);
    for (mesh, report) in &made {
        assert!(report.closed && report.boxes_outside > 0);
        assert_eq!(check_manifold(mesh.positions.len(), &mesh.triangles), Ok(()));
    }
    let points = |size: usize| made[size].1.field_evaluations;
    assert!((1..5).all(|size| points(size - 1) < points(size)));
    assert!(made[2].1.boxes_inside > 0 && points(2) < lattice.point_count() / 3);
    // With the smallest bricks, hardly more than the corners of the crossed cells.
    assert!(points(0) < 4 * made[0].1.crossing_cells);
}

#[test]
fn a_torus_keeps_its_hole() {
    let lattice = Lattice::covering([-1.6, -1.6, -0.6], [1.6, 1.6, 0.6], 0.03).unwrap();
    for (mesh, report) in mesh(|| torus(1.0, 0.4), || torus_range(1.0, 0.4), &lattice) {
        assert!(report.closed);
        assert_eq!(mesh.positions.len() * 2, mesh.triangles.len());
    }
}

#[test]
fn boxes_inside_cut_the_sides_that_they_touch() {
    // All of the lattice is inside, so nothing is sampled.
    let inside = Lattice::covering([-0.3; 3], [0.3; 3], 0.1).unwrap();
    for (_, report) in mesh(|| sphere([0.0; 3], 1.0), || sphere_range([0.0; 3], 1.0), &inside) {
        assert_eq!((report.bricks, report.field_evaluations), (0, 0));
        assert_eq!((report.boxes, report.boxes_inside), (1, 1));
        assert_eq!(report.cut_sides, Sides { low: [true; 3], high: [true; 3] });
    }
    // The sphere leaves the lattice on one side, where bricks are inside.
    let cut = Lattice::covering([-1.5, -1.5, -1.5], [0.2, 1.5, 1.5], 0.021).unwrap();
    for (mesh, report) in mesh(|| sphere([0.0; 3], 1.0), || sphere_range([0.0; 3], 1.0), &cut) {
        assert_eq!(report.cut_sides.to_string(), "+x");
        assert!(!report.closed && !mesh.triangles.is_empty());
    }
}

/// Boxes are dropped only where all of their points are on one side; the others are as scattered as can be.
#[test]
fn scattered_bricks_share_their_points() {
    let filled = |p: [i64; 3]| {
        let cell = p.map(|c| c.div_euclid(6));
        p.iter().all(|&c| c > 0 && c < 45) && hash(3, cell).is_multiple_of(3) && hash(4, p) & 3 != 0
    };
    let range = move |inner: &Box3| {
        let [low, high] = [inner.low, inner.high].map(|corner| corner.map(|c| c as i64));
        let mut points = (low[2]..=high[2])
            .flat_map(|z| (low[1]..=high[1]).flat_map(move |y| (low[0]..=high[0]).map(move |x| [x, y, z])));
        let any = points.clone().any(filled);
        let all = points.all(filled);
        [if all { 1.0 } else { 0.0 }, if any { 1.0 } else { 0.0 }]
    };
    let lattice = Lattice::new([0.0; 3], 1.0, [45, 47, 45]).unwrap();
    for (mesh, report) in mesh(|| signs(filled), || range, &lattice) {
        assert!(report.closed && report.flipped_faces > 0);
        assert_eq!(check_manifold(mesh.positions.len(), &mesh.triangles), Ok(()));
    }
}

#[test]
fn a_large_lattice_costs_what_its_surface_costs() {
    let center = [0.31, -0.42, 0.17];
    let lattice = Lattice::with_resolution([-1.0; 3], [1.0; 3], 4096).unwrap();
    assert_eq!(lattice.points(), [4097; 3]);
    let checked = Checked::new(sphere(center, 0.02), sphere_range(center, 0.02), &lattice);
    let (mesh, report) = extract(&checked, &lattice, &Options::default()).run().unwrap();
    assert!(report.closed);
    assert_eq!(mesh.positions.len() as u64, report.crossing_cells);
    // The radius is 41 cells: a crossed cell for each of 3/2 the area, and in the bricks of 16^3 cells less
    // than 20 points for each.
    assert!((25_000..40_000).contains(&report.crossing_cells), "{}", report.crossing_cells);
    assert!(report.field_evaluations < 20 * report.crossing_cells, "{}", report.field_evaluations);
    assert!(report.boxes < 5_000, "{}", report.boxes);
}
