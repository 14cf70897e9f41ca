//! Surfaces in closed form: where they are, how large they are, how they are connected; and what the report
//! says.

use std::convert::Infallible;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use jbt::boxes::Divisible;
use jbt::limits::MAX_ATTRIBUTE_WIDTH;
use jbt::mesh::{
    Field, FieldWork, Lattice, Mesh, MeshError, MeshReport, Options, Sides, check_manifold, extract,
};
use jbt::{Box3, CancelToken};
use jbt_testkit::surface::{area_vector, corners};
use jbt_testkit::vector::{dot, length, minus};

use crate::fields::{Closed, Sample, cubic, no_ranges, sphere, torus, union};
use crate::models::volume;

const PI: f64 = std::f64::consts::PI;

fn lattice(half: f64, spacing: f64) -> Lattice {
    Lattice::covering([-half; 3], [half; 3], spacing).unwrap()
}

fn mesh(field: impl Fn([f32; 3]) -> Sample + Sync, lattice: &Lattice) -> (Mesh, MeshReport) {
    extract(&Closed(field), lattice, &Options::default()).run().unwrap()
}

fn area(mesh: &Mesh) -> f64 {
    let of = |&triangle: &[u32; 3]| length(area_vector(corners(&mesh.positions, triangle))) / 2.0;
    mesh.triangles.iter().map(of).sum()
}

/// Vertices - edges + triangles, of a closed mesh.
fn euler(mesh: &Mesh) -> i64 {
    mesh.positions.len() as i64 - mesh.triangles.len() as i64 / 2
}

#[track_caller]
fn assert_manifold(mesh: &Mesh, report: &MeshReport) {
    assert!(report.closed);
    assert_eq!(report.cut_sides, Sides::default());
    assert_eq!(check_manifold(mesh.positions.len(), &mesh.triangles), Ok(()));
}

#[track_caller]
fn assert_near(value: f64, expected: f64, relative: f64) {
    assert!((value / expected - 1.0).abs() < relative, "{value} is not {expected}");
}

#[test]
fn a_sphere_is_where_and_as_large_as_it_should_be() {
    let center = [0.1, -0.2, 0.03];
    let mut last = None;
    for spacing in [0.2, 0.1, 0.05] {
        let (mesh, report) = mesh(sphere(center, 1.0), &lattice(1.5, spacing));
        assert_manifold(&mesh, &report);
        assert_eq!(euler(&mesh), 2);
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            let radius = minus(position.map(f64::from), center.map(f64::from));
            assert!((dot(radius, radius).sqrt() - 1.0).abs() < 1e-5);
            assert!(dot(radius, normal.map(f64::from)) > 1.0 - 1e-5);
        }
        assert_near(volume(&mesh), 4.0 / 3.0 * PI, 0.6 * spacing * spacing);
        assert_near(area(&mesh), 4.0 * PI, 0.6 * spacing * spacing);
        // The error of an inscribed mesh is of second order.
        let error = 4.0 / 3.0 * PI - volume(&mesh);
        if let Some(last) = last {
            assert_near(last / error, 4.0, 0.2);
        }
        last = Some(error);
    }
}

#[test]
fn a_soft_field_is_pulled_onto_its_surface() {
    let (mesh, report) = mesh(cubic(1.0), &lattice(1.0, 1.0 / 16.0));
    assert_manifold(&mesh, &report);
    let radius = (1.0 - 0.5_f64.cbrt()).sqrt();
    for position in &mesh.positions {
        let position = position.map(f64::from);
        assert!((length(position) - radius).abs() < 1e-6);
    }
    assert_near(volume(&mesh), 4.0 / 3.0 * PI * radius.powi(3), 0.02);
}

#[test]
fn more_pulls_come_nearer() {
    let worst = |pulls| {
        let options = Options { pulls, ..Options::default() };
        let (mesh, report) = extract(&Closed(cubic(1.0)), &lattice(1.0, 0.25), &options).run().unwrap();
        let vertices = mesh.positions.len() as u64;
        // One pull leaves vertices of such large cells off the surface; those are pulled on, and evaluated
        // once more.
        let more = report.gradient_evaluations - pulls as u64 * vertices;
        assert_eq!(more > 0, pulls == 1, "{pulls} pulls");
        assert_eq!(report.full_evaluations > vertices, pulls == 1, "{pulls} pulls");
        let off = |p: &[f32; 3]| (f64::from(cubic(1.0)(*p).0) - 0.5).abs();
        mesh.positions.iter().map(off).fold(0.0, f64::max)
    };
    let worst = [0, 1, 2].map(worst);
    assert!(worst[0] > 5.0 * worst[1] && worst[0] > 5.0 * worst[2], "{worst:?}");
}

#[test]
fn two_spheres_apart_and_joined() {
    let lattice = Lattice::covering([-2.5, -1.5, -1.5], [2.5, 1.5, 1.5], 0.1).unwrap();
    let apart = union(sphere([-1.2, 0.0, 0.0], 0.9), sphere([1.2, 0.0, 0.0], 0.9));
    let (apart, report) = mesh(apart, &lattice);
    assert_manifold(&apart, &report);
    assert_eq!(euler(&apart), 4);
    assert_near(volume(&apart), 2.0 * 4.0 / 3.0 * PI * 0.9_f64.powi(3), 0.01);

    let (joined, report) = mesh(union(sphere([-0.5, 0.0, 0.0], 0.9), sphere([0.5, 0.0, 0.0], 0.9)), &lattice);
    assert_manifold(&joined, &report);
    assert_eq!(euler(&joined), 2);
    // Two balls without their common lens: of each, all but the cap beyond the plane between them.
    let (r, h) = (0.9_f64, 0.9_f64 - 0.5);
    let expected = 2.0 * (4.0 / 3.0 * PI * r.powi(3) - PI * h * h * (3.0 * r - h) / 3.0);
    assert_near(volume(&joined), expected, 0.01);
}

#[test]
fn a_torus_has_a_hole() {
    let (mesh, report) = mesh(torus(1.0, 0.4), &lattice(1.6, 0.08));
    assert_manifold(&mesh, &report);
    assert_eq!(euler(&mesh), 0);
    assert_near(volume(&mesh), 2.0 * PI * PI * 0.4 * 0.4, 0.02);
    assert_near(area(&mesh), 4.0 * PI * PI * 0.4, 0.02);
    for position in &mesh.positions {
        let [x, y, z] = position.map(f64::from);
        assert!(((x.hypot(y) - 1.0).hypot(z) - 0.4).abs() < 1e-5);
    }
}

#[test]
fn attributes_are_those_of_the_vertex() {
    let (mesh, _) = mesh(sphere([0.0; 3], 1.0), &lattice(1.5, 0.1));
    let [color, height] = &mesh.attributes[..] else { panic!("two attributes") };
    assert_eq!((color.name.as_str(), color.width), ("color", 3));
    assert_eq!((height.name.as_str(), height.width), ("height", 1));
    assert_eq!(color.values, mesh.positions.concat());
    assert_eq!(height.values, mesh.positions.iter().map(|p| p[2]).collect::<Vec<_>>());
}

#[test]
fn every_lattice_point_is_asked_once_and_by_its_global_coordinate() {
    let lattice = Lattice::new([-1.0, 0.1, 7.0], 0.3, [37, 18, 5]).unwrap();
    for brick in [2, 4, 8, 16, 32] {
        let seen = Mutex::new(Vec::new());
        let record = |p: [f32; 3]| {
            seen.lock().unwrap().push([p[2], p[1], p[0]].map(f32::to_bits));
            (0.0, [0.0; 3])
        };
        let (mesh, report) =
            extract(&Closed(record), &lattice, &Options { brick: Some(brick), ..Options::default() })
                .run()
                .unwrap();
        assert_eq!(mesh.positions.len(), 0);
        assert_eq!(report.field_evaluations, 38 * 19 * 6);
        let mut expected = Vec::new();
        for z in 0..6 {
            for y in 0..19 {
                for x in 0..38 {
                    let coordinate = |origin: f64, index: i32| (origin + 0.3 * f64::from(index)) as f32;
                    expected.push(
                        [coordinate(7.0, z), coordinate(0.1, y), coordinate(-1.0, x)].map(f32::to_bits),
                    );
                }
            }
        }
        let mut seen = seen.into_inner().unwrap();
        seen.sort_unstable();
        expected.sort_unstable();
        assert!(seen == expected, "brick {brick}");
    }
}

#[test]
fn the_region_cuts() {
    let lattice = Lattice::covering([-1.5, -1.5, -1.5], [0.2, 1.5, 1.5], 0.1).unwrap();
    let (mesh, report) = mesh(sphere([0.0; 3], 1.0), &lattice);
    assert!(!report.closed);
    assert_eq!(report.cut_sides.to_string(), "+x");
    // Every vertex belongs to a triangle, and every edge that is open lies in the last layer of cells.
    let used: std::collections::BTreeSet<u32> = mesh.triangles.iter().flatten().copied().collect();
    assert!(used.into_iter().eq(0..mesh.positions.len() as u32));
    assert!(mesh.positions.iter().all(|p| p[0] <= 0.2));
    assert_near(mesh.positions.iter().map(|p| f64::from(p[0])).fold(0.0, f64::max), 0.15, 0.4);

    let inside = Lattice::covering([-0.3; 3], [0.3; 3], 0.1).unwrap();
    let (mesh, report) = self::mesh(sphere([0.0; 3], 1.0), &inside);
    assert!(mesh.triangles.is_empty() && mesh.positions.is_empty());
    assert_eq!(report.cut_sides.to_string(), "-x +x -y +y -z +z");
}

#[test]
fn a_corner_that_pokes_in_leaves_no_loose_vertices() {
    // Inside only at the last corner of the lattice: crossed edges, but all of them on its sides.
    let corner = |p: [f32; 3]| (if p.iter().all(|&c| c > 0.95) { 1.0 } else { 0.0 }, [0.0; 3]);
    let (mesh, report) = mesh(corner, &Lattice::covering([0.0; 3], [1.0; 3], 0.25).unwrap());
    assert_eq!(mesh, Mesh { attributes: mesh.attributes.clone(), ..Mesh::default() });
    assert_eq!(report.cut_sides.to_string(), "+x +y +z");
    assert_eq!(report.crossing_cells, 1);
    assert_eq!(report.full_evaluations, 0);
}

#[test]
fn an_empty_field_gives_an_empty_closed_mesh() {
    let (mesh, report) = mesh(|_| (0.0, [0.0; 3]), &lattice(1.0, 0.1));
    assert!(mesh.triangles.is_empty() && mesh.positions.is_empty());
    assert!(report.closed);
    assert_eq!(report.cut_sides.to_string(), "none");
    assert_eq!(mesh.attributes.len(), 2);
}

#[test]
fn nan_and_infinity_are_taken_as_they_come() {
    // A ball of radius 1 where the half z > 0 answers NaN: what remains is the lower half, closed by a flat
    // lid.
    let half = |p: [f32; 3]| {
        let ball = sphere([0.0; 3], 1.0)(p);
        if p[2] > 0.01 { (f32::NAN, [f32::NAN; 3]) } else { ball }
    };
    let (mesh, report) = mesh(half, &lattice(1.5, 0.1));
    assert_manifold(&mesh, &report);
    assert_eq!(euler(&mesh), 2);
    assert_near(volume(&mesh), 2.0 / 3.0 * PI, 0.15);
    assert!(mesh.positions.iter().flatten().all(|c| c.is_finite()));
    assert_unit_normals(&mesh);

    let all_nan = self::mesh(|_| (f32::NAN, [0.0; 3]), &lattice(1.0, 0.1));
    assert!(all_nan.0.positions.is_empty() && all_nan.1.closed);

    let wild = |p: [f32; 3]| {
        let inside = p.iter().map(|c| c * c).sum::<f32>() < 1.0;
        (if inside { f32::INFINITY } else { f32::NEG_INFINITY }, [f32::INFINITY, 0.0, f32::NAN])
    };
    let (mesh, report) = self::mesh(wild, &lattice(1.5, 0.1));
    assert_manifold(&mesh, &report);
    assert_unit_normals(&mesh);
    // Without a gradient the normals come from the triangles, and so point outwards.
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        assert!(dot(position.map(f64::from), normal.map(f64::from)) > 0.5);
    }
}

#[track_caller]
fn assert_unit_normals(mesh: &Mesh) {
    for normal in &mesh.normals {
        assert!((dot(normal.map(f64::from), normal.map(f64::from)) - 1.0).abs() < 1e-5, "{normal:?}");
    }
}

#[test]
fn bad_options_are_errors() {
    let with =
        |options: Options| extract(&Closed(cubic(1.0)), &lattice(1.0, 0.5), &options).run().map(|_| ());
    let default = Options::default();
    for brick in [0, 1, 3, 12, 33, 64] {
        assert_eq!(with(Options { brick: Some(brick), ..default.clone() }), Err(MeshError::Brick { brick }));
    }
    assert_eq!(with(Options { pulls: 65, ..default.clone() }), Err(MeshError::Pulls { pulls: 65 }));
    assert_eq!(with(Options { pulls: 64, brick: Some(32), ..default.clone() }), Ok(()));
    let infinite = f32::INFINITY;
    assert_eq!(with(Options { iso: infinite, ..default }), Err(MeshError::Iso { iso: infinite }));
}

#[test]
fn progress_ascends_and_cancels() {
    let run = |stop: f32| {
        let mut seen = Vec::new();
        let lattice = lattice(1.0, 0.02);
        let token = CancelToken::new();
        let (field, watch) = (Closed(cubic(1.0)), |fraction| {
            seen.push(fraction);
            if fraction >= stop {
                token.cancel();
            }
        });
        let result = extract(&field, &lattice, &Options::default()).on_progress(watch).cancel(&token).run();
        assert!(seen.is_sorted());
        (result.map(|_| ()), seen)
    };
    let (result, seen) = run(2.0);
    assert_eq!(result, Ok(()));
    assert_eq!((seen[0], seen[seen.len() - 1]), (0.0, 1.0));
    assert!(seen.len() > 20);
    for stop in [0.0, 0.3, 0.9, 1.0] {
        let (result, seen) = run(stop);
        assert_eq!(result, Err(MeshError::Cancelled));
        assert!(seen[seen.len() - 1] >= stop);
        assert_eq!(seen.iter().filter(|&&fraction| fraction >= stop).count(), 1);
    }
}

#[test]
fn whoever_cancels_has_no_mesh_and_no_panic() {
    let field = Closed(cubic(1.0));
    let run = |wait: Option<Duration>| {
        let token = CancelToken::new();
        let begin = Instant::now();
        let result = std::thread::scope(|scope| {
            scope.spawn(|| {
                wait.map(|wait| {
                    std::thread::sleep(wait);
                    token.cancel();
                })
            });
            extract(&field, &lattice(1.0, 0.008), &Options::default()).cancel(&token).run()
        });
        (result.map(|_| ()), begin.elapsed())
    };
    let (result, whole) = run(None);
    assert_eq!(result, Ok(()));
    let mut cancelled = 0;
    for part in 0..60 {
        match run(Some(whole * part / 60)).0 {
            Ok(()) => {}
            Err(error) => {
                assert_eq!(error, MeshError::Cancelled);
                cancelled += 1;
            }
        }
    }
    assert!(cancelled > 0);
}

/// Fails from the given call on.
struct Failing(AtomicU64);

#[derive(Debug, PartialEq, thiserror::Error)]
#[error("no more")]
struct NoMore;

impl Failing {
    fn call(&self) -> Result<(), NoMore> {
        let left = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
        left.map(|_| ()).map_err(|_| NoMore)
    }
}

impl Divisible for Failing {
    type Error = NoMore;
    type Region = ();

    fn region(&self, _: Box3) -> Result<(), NoMore> {
        self.call()
    }

    fn ranges(&self, (): &(), _: &[Box3], ranges: &mut [[f32; 2]]) -> Result<(), NoMore> {
        no_ranges(ranges);
        self.call()
    }

    fn narrow(&self, (): &(), boxes: &[Box3], parts: &mut Vec<()>) -> Result<(), NoMore> {
        parts.extend(boxes.iter().map(|_| ()));
        self.call()
    }
}

impl Field for Failing {
    fn attributes(&self) -> Vec<(String, usize)> {
        Vec::new()
    }

    fn work(&self, (): &()) -> FieldWork {
        FieldWork::default()
    }

    fn field(&self, (): &(), x: &[f32], y: &[f32], z: &[f32], field: &mut [f32]) -> Result<(), NoMore> {
        let Ok(()) = Closed(cubic(1.0)).field(&(), x, y, z, field);
        self.call()
    }

    fn gradient(
        &self,
        (): &(),
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
    ) -> Result<(), NoMore> {
        let Ok(()) = Closed(cubic(1.0)).gradient(&(), x, y, z, field, gradient);
        self.call()
    }

    fn all(
        &self,
        (): &(),
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
        _: &mut [&mut [f32]],
    ) -> Result<(), NoMore> {
        self.gradient(&(), x, y, z, field, gradient)
    }
}

#[test]
fn an_error_of_the_field_is_handed_on() {
    let (lattice, options) = (lattice(1.0, 0.125), Options { brick: Some(8), ..Options::default() });
    let field = Failing(AtomicU64::new(u64::MAX));
    assert!(extract(&field, &lattice, &options).run().is_ok());
    // Two levels of boxes: the region, its range, those of its children, their regions. Then eight bricks:
    // the lattice, two pulls and the rest of each, all of them in one portion or in several.
    let needed = u64::MAX - field.0.into_inner();
    assert!(needed >= 4 + 8 * (1 + 2 + 1), "{needed}");
    for calls in 0..needed {
        let field = Failing(AtomicU64::new(calls));
        let result = extract(&field, &lattice, &options).run();
        assert_eq!(result.map(|_| ()), Err(MeshError::Field(NoMore)), "after {calls}");
    }
    assert!(extract(&Failing(AtomicU64::new(needed)), &lattice, &options).run().is_ok());
}

/// The sphere with one attribute, of any width.
struct Wide(usize);

impl Divisible for Wide {
    type Error = Infallible;
    type Region = ();

    fn region(&self, _: Box3) -> Result<(), Infallible> {
        Ok(())
    }

    fn ranges(&self, (): &(), _: &[Box3], ranges: &mut [[f32; 2]]) -> Result<(), Infallible> {
        no_ranges(ranges);
        Ok(())
    }

    fn narrow(&self, (): &(), boxes: &[Box3], parts: &mut Vec<()>) -> Result<(), Infallible> {
        parts.extend(boxes.iter().map(|_| ()));
        Ok(())
    }
}

impl Field for Wide {
    fn attributes(&self) -> Vec<(String, usize)> {
        vec![("wide".to_owned(), self.0)]
    }

    fn work(&self, (): &()) -> FieldWork {
        FieldWork::default()
    }

    fn field(&self, (): &(), x: &[f32], y: &[f32], z: &[f32], field: &mut [f32]) -> Result<(), Infallible> {
        Closed(cubic(1.0)).field(&(), x, y, z, field)
    }

    fn gradient(
        &self,
        (): &(),
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
    ) -> Result<(), Infallible> {
        Closed(cubic(1.0)).gradient(&(), x, y, z, field, gradient)
    }

    fn all(
        &self,
        (): &(),
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
        attributes: &mut [&mut [f32]],
    ) -> Result<(), Infallible> {
        for (number, plane) in (1_u8..).zip(attributes) {
            plane.fill(f32::from(number));
        }
        self.gradient(&(), x, y, z, field, gradient)
    }
}

#[test]
fn attributes_have_a_width() {
    for width in [1, 4, MAX_ATTRIBUTE_WIDTH] {
        let (mesh, _) = extract(&Wide(width), &lattice(1.0, 0.1), &Options::default()).run().unwrap();
        let values = &mesh.attributes[0].values;
        assert_eq!(values.len(), width * mesh.positions.len());
        let channels: Vec<f32> = (1_u8..).take(width).map(f32::from).collect();
        assert!(values.chunks_exact(width).all(|chunk| chunk == channels));
    }
    for width in [0, MAX_ATTRIBUTE_WIDTH + 1, usize::MAX] {
        let error = extract(&Wide(width), &lattice(1.0, 0.1), &Options::default()).run().unwrap_err();
        assert_eq!(error, MeshError::Width { name: "wide".to_owned(), width });
    }
}

#[test]
fn errors_print() {
    let error: MeshError<Infallible> = MeshError::Brick { brick: 0 };
    assert_eq!(error.to_string(), "the edge of a brick is a power of two from 2 to 32, and 0 was asked for");
}
