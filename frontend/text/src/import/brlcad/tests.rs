//! What databases hold, counted along every path, against what other programs have counted.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3};
use jbt_model::affine::map_bounds;
use jbt_model::bounds::Bounds;
use jbt_testkit::samples;
use serde_json::Value;

use super::build::affine;
use super::database;
use super::database::{Database, ObjectContent};
use super::leaf::{self, LeafStyle};
use super::solid::{DatabaseSolid, SolidKind};

/// Uses of solids below an object.
#[derive(Default)]
struct Outline {
    leaves: u64,
    regions: u64,
    kinds: BTreeMap<&'static str, u64>,
    bounds: Option<Bounds>,
}

/// The box of a solid. That of an elliptical torus is a cube in the table, which ours is in.
fn expected_bounds(solid: &DatabaseSolid) -> Bounds {
    let own = leaf::leaf(solid, 1.0, LeafStyle::Plain).unwrap().bounds;
    if solid.kind != SolidKind::EllipticalTorus {
        return own;
    }
    let at = |place: usize| DVec3::from_slice(&solid.numbers[place..place + 3]);
    let reach = solid.numbers[9] + at(6).length().max(solid.numbers[10]);
    let cube = Bounds::new(at(0) - reach, at(0) + reach);
    assert_eq!(cube.hull(own), cube);
    cube
}

/// Counts along every path. The samples are small, so each path is walked.
fn outline(database: &Database, object: &str) -> Outline {
    let mut found = Outline::default();
    let mut stack = vec![(database.find(object.as_bytes()).unwrap(), DAffine3::IDENTITY, false)];
    while let Some((object, map, in_region)) = stack.pop() {
        let object = &database.objects[object as usize];
        match &object.content {
            ObjectContent::Solid(solid) => {
                found.leaves += 1;
                *found.kinds.entry(solid.kind.word()).or_default() += 1;
                let own = expected_bounds(solid);
                if !own.is_empty() {
                    let all = found.bounds.unwrap_or(Bounds::EMPTY);
                    found.bounds = Some(all.hull(map_bounds(&map, own)));
                }
            }
            ObjectContent::Combination(made) => {
                let is_region = object.properties.is_region && !in_region;
                found.regions += u64::from(is_region);
                for member in &made.members {
                    let child = database.find(database.at(member.name)).unwrap();
                    let own = member.matrix.map(|at| affine(&made.matrices[at as usize]).unwrap());
                    stack.push((child, map * own.unwrap_or(DAffine3::IDENTITY), in_region || is_region));
                }
            }
            ObjectContent::Foreign(kind) => panic!("{kind}"),
            ObjectContent::Text => panic!("text"),
        }
    }
    found
}

#[test]
fn samples_hold_what_others_count_in_them() {
    if samples::folder("brlcad").is_none() {
        return;
    }
    let sample = |name: &str| samples::file(&format!("brlcad/{name}")).unwrap();
    let expected: Value = serde_json::from_slice(&sample("expected.json")).unwrap();
    let mut compared = 0;
    for entry in expected.as_array().unwrap() {
        let file = entry["file"].as_str().unwrap();
        let bytes = sample(file);
        if entry["error"] == "version 4 binary" {
            let errors = database(&bytes).err().unwrap();
            assert_eq!(errors[0].message, "this is a binary database of version 4");
            continue;
        }
        let database = database(&bytes).unwrap_or_else(|errors| panic!("{file}: {errors:?}"));
        let object = entry["object"].as_str().unwrap();
        let found = outline(&database, object);
        let place = format!("{file} {object}");
        assert_eq!(entry["problems"], Value::Array(Vec::new()), "{place}");
        assert_eq!(entry["leaves"], found.leaves, "{place}");
        assert_eq!(entry["regions"], found.regions, "{place}");
        let kinds: BTreeMap<&str, u64> = entry["primitives"]
            .as_object()
            .unwrap()
            .iter()
            .map(|(kind, count)| (kind.as_str(), count.as_u64().unwrap()))
            .collect();
        assert_eq!(kinds, found.kinds, "{place}");
        let bounds = found.bounds.unwrap();
        for (side, corner) in [bounds.low(), bounds.high()].iter().enumerate() {
            for (axis, found) in corner.iter().enumerate() {
                let expected = entry["box_of_leaves"][side][axis].as_f64().unwrap();
                assert!((found - expected).abs() < 1e-4, "{place}: side {side} {axis}: {found}, {expected}");
            }
        }
        compared += 1;
    }
    assert_eq!(compared, 18);
}
