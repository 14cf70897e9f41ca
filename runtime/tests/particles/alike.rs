//! The same scene with particles and with a node for each point.

use fastrand::Rng;
use jbt::boxes::Divisible;
use jbt::mesh::Mesh;
use jbt::statistics::leaf_uses;
use jbt::{Box3, CheckedTree, Compiler, Engine, Fineness, Model, Points, Polygonize, Pruner, Query, Solid};
use jbt_lower::{LeafInstances, Lowered, lower, lower_ranges};
use jbt_model::walk::walk;
use jbt_testkit::bits::assert_same;

use crate::common::answers;
use crate::scenes::{model, scenes};

/// Each scene, and its twin.
fn twins() -> impl Iterator<Item = (&'static str, [CheckedTree; 2])> {
    scenes().into_iter().map(|(name, tree)| {
        let check = |model: Model| model.check().unwrap_or_else(|errors| panic!("{name}: {errors}"));
        (name, [check(model(tree.clone())), check(model(tree.as_points()))])
    })
}

/// Points in the box of the support, and around it.
fn points(tree: &CheckedTree, count: usize) -> Points {
    let mut rng = Rng::with_seed(7);
    let support = tree.local_support();
    let (low, high) = (support.low(), support.high());
    let at = |rng: &mut Rng, axis: usize| low[axis] + (high[axis] - low[axis]) * (1.1 * rng.f64() - 0.05);
    let mut points = Points::about(tree.origin());
    (0..count).for_each(|_| points.push(std::array::from_fn::<f32, 3, _>(|axis| at(&mut rng, axis) as f32)));
    points
}

#[test]
fn programs_and_rows_are_those_of_points() {
    for (name, [cloud, points]) in twins() {
        assert_eq!(cloud.support(), points.support(), "{name}");
        assert_eq!(cloud.origin(), points.origin(), "{name}");
        for query in Query::EVERY {
            let [a, b] = [&cloud, &points].map(|tree| lower(tree, query).unwrap());
            assert_lowered(name, &a, &b);
        }
        let [a, b] = [&cloud, &points].map(|tree| lower_ranges(tree).unwrap());
        let lowered = |it: &jbt_lower::RangeFunction| Lowered {
            function: it.function.clone(),
            tables: it.tables.clone(),
        };
        assert_lowered(name, &lowered(&a), &lowered(&b));
        assert_eq!(
            (a.info.probes, &a.info.decisions, &a.info.contests),
            (b.info.probes, &b.info.decisions, &b.info.contests),
            "{name}"
        );
        for (a, b) in a.info.tables.values().zip(b.info.tables.values()) {
            assert_eq!(
                (a.space, a.rule, a.is_hoisted, &a.supports),
                (b.space, b.rule, b.is_hoisted, &b.supports),
                "{name}"
            );
            assert_eq!(a.nodes.len(), b.nodes.len(), "{name}");
        }
    }
}

/// Equal but for the names of nodes.
#[track_caller]
fn assert_lowered(name: &str, a: &Lowered, b: &Lowered) {
    assert_eq!(a.function, b.function, "{name}");
    for (a, b) in a.tables.tables.values().zip(b.tables.tables.values()) {
        assert_eq!(
            (a.count, a.stride, &a.active, &a.starts),
            (b.count, b.stride, &b.active, &b.starts),
            "{name}"
        );
        assert_eq!(a.nodes.len(), b.nodes.len(), "{name}");
        let bits = |rows: &jbt_ir::Rows| rows.numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(a), bits(b), "{name}");
    }
}

#[test]
fn answers_are_those_of_points_by_every_engine_pruned_or_not() {
    for (name, [cloud, written_out]) in twins() {
        let points = points(&cloud, 200);
        for engine in Engine::ALL {
            let Ok(expected) = Compiler::for_engine(engine).evaluator(&written_out, Query::ALL) else {
                continue;
            };
            let evaluator = Compiler::for_engine(engine).evaluator(&cloud, Query::ALL).unwrap();
            let expected = answers(&expected, &points);
            let found = answers(&evaluator, &points);
            let what = format!("{name}, {engine:?}");
            assert_same(expected.planes(), found.planes(), &what);
            let pruner = Pruner::new(&Compiler::for_engine(engine), &cloud).unwrap();
            for index in 0..points.len() {
                let at = points.get(index);
                let region = pruner.region(Box3::new(at, at)).unwrap();
                let mut found = vec![[0.0]; expected.planes().len()];
                let mut planes: Vec<&mut [f32]> = found.iter_mut().map(|plane| &mut plane[..]).collect();
                let [x, y, z] = at.each_ref().map(std::slice::from_ref);
                evaluator.eval_region(&region, [x, y, z], &mut planes).unwrap();
                let all: Vec<[f32; 1]> = expected.planes().iter().map(|plane| [plane[index]]).collect();
                assert_same(&all, &found, &what);
            }
        }
    }
}

#[test]
fn the_oracle_says_of_particles_what_it_says_of_points() {
    for (name, [cloud, written_out]) in twins() {
        let origin = cloud.origin();
        let (solid, twin) = (
            Solid::new(&Compiler::new(), &cloud).unwrap(),
            Solid::new(&Compiler::new(), &written_out).unwrap(),
        );
        for point in &points(&cloud, 100) {
            let at = std::array::from_fn(|axis| f64::from(point[axis]) + origin.point()[axis]);
            assert_eq!(walk(&cloud, at), walk(&written_out, at), "{name} {at:?}");
            let owners = [solid.owner(at), twin.owner(at)];
            let [owner, expected] = owners.each_ref().map(|owner| owner.as_ref().map(|owner| owner.share));
            assert_eq!(owner, expected, "{name} {at:?}");
            if let [Some(owner), Some(expected)] = &owners {
                let [path, known] = [owner.path(&cloud), expected.path(&written_out)];
                if let Some(above) = path.strip_suffix("particles") {
                    let of_point = format!("{above}sum/{}.", owner.particle);
                    assert!(known.starts_with(&of_point), "{name}: {path}, {known}");
                }
            }
        }
    }
}

#[test]
fn meshes_have_the_bytes_of_those_of_points() {
    for (name, [cloud, written_out]) in twins() {
        let settings = Polygonize { fineness: Fineness::Resolution(24), ..Polygonize::default() };
        let mesh = |tree: &CheckedTree| settings.mesh(&Compiler::new(), tree).run().map(|made| made.mesh);
        match (mesh(&cloud), mesh(&written_out)) {
            (Ok(a), Ok(b)) => {
                assert!(!a.triangles.is_empty(), "{name}");
                assert_eq!(bytes(&a), bytes(&b), "{name}");
            }
            (Err(a), Err(b)) => panic!("{name}: {a} {b}"),
            (a, b) => panic!("{name}: {a:?} {b:?}"),
        }
    }
}

fn bytes(mesh: &Mesh) -> Vec<u8> {
    let places = [&mesh.positions, &mesh.normals].map(|all| all.as_flattened());
    let values = mesh.attributes.iter().map(|attribute| &attribute.values[..]);
    let numbers = places.into_iter().chain(values).flatten().flat_map(|number| number.to_ne_bytes());
    numbers.chain(mesh.triangles.as_flattened().iter().flat_map(|vertex| vertex.to_ne_bytes())).collect()
}

#[test]
fn every_particle_counts_as_a_primitive() {
    for (name, [cloud, written_out]) in twins() {
        assert_eq!(leaf_uses(&cloud), leaf_uses(&written_out), "{name}");
        let [a, b] = [&cloud, &written_out].map(LeafInstances::new);
        assert_eq!(a.len(), b.len(), "{name}");
        let evaluations =
            |tree: &CheckedTree| Compiler::new().evaluator(tree, Query::FIELD).unwrap().evaluations_by_node();
        assert_eq!(evaluations(&cloud).total, evaluations(&written_out).total, "{name}");
        let at = points(&cloud, 1).get(0).map(f64::from);
        // Those without a strength of their own come first, or last.
        let fields = |leaves: &LeafInstances<'_>| {
            let mut fields: Vec<f64> =
                (0..leaves.len()).map(|index| walk(&leaves.alone(index), at).field).collect();
            fields.sort_by(f64::total_cmp);
            fields
        };
        assert_eq!(fields(&a), fields(&b), "{name}");
    }
}
