//! The peers compute what they are compared in.

use super::fidget::{Expression, FidgetModel, Gate, JitFunction, Order, VmFunction};
use super::splashsurf::{Division, Particles};
use super::{MeshSize, Threads};
use crate::check::{Disagreement, agree};
use crate::model::{Blob, blobs, cube, tree};
use crate::naive::Walker;

use fidget::eval::MathFunction;
use fidget::render::RenderHints;
use jbt::Points;

/// Field and gradient by the walker, which is held to the oracle by its own tests.
fn expected(blobs: &[Blob], points: &Points) -> [Vec<f32>; 4] {
    let walker = Walker::new(&tree(blobs));
    let mut planes = vec![vec![0.0; points.len()]; 4 + walker.channels()];
    let mut outs: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    walker.full(points.planes(), &mut outs);
    planes.truncate(4);
    planes.try_into().expect("four planes")
}

fn fidget_agrees<F: MathFunction + RenderHints>(engine: &str) {
    let (blobs, points) = (blobs(60, 1), cube(3000, 2));
    let expected = expected(&blobs, &points);
    let mut field = vec![f32::NAN; points.len()];
    for gate in Gate::ALL {
        for order in [Order::Chain, Order::Balanced] {
            let model = FidgetModel::<F>::of(&Expression::ordered(&blobs, gate, order));
            model.field().eval(points.planes(), &mut field);
            assert_eq!(agree(&field, &expected[0], 1e-5), Ok(()), "{engine}, {gate:?}, {order:?}");
            let mut planes: [Vec<f32>; 4] = std::array::from_fn(|_| vec![f32::NAN; points.len()]);
            model.gradient().eval(points.planes(), planes.each_mut().map(Vec::as_mut_slice));
            for (plane, expected) in planes.iter().zip(&expected) {
                assert_eq!(agree(plane, expected, 1e-4), Ok(()), "{engine}, {gate:?}, {order:?}");
            }
        }
    }
}

#[test]
fn fidget_has_our_field_and_gradient() {
    fidget_agrees::<JitFunction>("jit");
    fidget_agrees::<VmFunction>("vm");
}

#[test]
fn fidget_meshes_alike_on_any_threads_and_gate() {
    let blobs = blobs(30, 1);
    let meshes: Vec<MeshSize> = Gate::ALL
        .iter()
        .flat_map(|&gate| {
            let model = FidgetModel::<JitFunction>::new(&blobs, gate);
            [model.mesh(5, Threads::One), model.mesh(5, Threads::All)]
        })
        .collect();
    for mesh in &meshes {
        // Open where the surface leaves the cube, so not quite two triangles for each vertex.
        assert!(
            mesh.vertices > 1000 && (1.8..=2.0).contains(&(mesh.triangles as f64 / mesh.vertices as f64)),
            "{mesh:?}"
        );
        assert!(mesh.triangles.abs_diff(meshes[0].triangles) < 20, "{meshes:?}");
    }
}

#[test]
fn a_wrong_answer_is_named() {
    assert_eq!(agree(&[1.0, 2.0], &[1.0, 2.0], 0.0), Ok(()));
    let wrong = Disagreement { index: 1, value: 2.5, expected: 2.0 };
    assert_eq!(agree(&[1.0, 2.5], &[1.0, 2.0], 0.1), Err(wrong));
    assert_eq!(wrong.to_string(), "answer 1 is 2.5, expected 2");
    assert!(agree(&[f32::NAN], &[1.0], 0.1).is_err() && agree(&[1.0], &[], 0.1).is_err());
}

#[test]
fn splashsurf_meshes_alike_on_any_threads_and_division() {
    let blobs = blobs(200, 1);
    let mesh = |division, threads| {
        Particles::new(&blobs, 1.0 / 32.0, division, threads).and_then(|particles| particles.mesh()).unwrap()
    };
    let first = mesh(Division::None, Threads::One);
    // Closed: two triangles for each vertex, but for twice the number of pieces and holes.
    assert!(first.vertices > 1000 && first.triangles.abs_diff(2 * first.vertices) < 1000, "{first:?}");
    for division in [Division::None, Division::Subdomains] {
        for threads in [Threads::One, Threads::All] {
            let other = mesh(division, threads);
            assert!(first.triangles.abs_diff(other.triangles) < first.triangles / 50, "{first:?}, {other:?}");
        }
    }
}
