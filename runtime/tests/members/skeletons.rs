//! Skeletons, in the falloff of soft objects: 1 on the skeleton, 1/2 at half the radius, 0 at the radius.

mod curves;
mod flat;
mod norms;
mod solids;

use jbt::{CheckedTree, Model};
use jbt_model::check::CheckedNode;
use jbt_model::kind::NodeKind;
use jbt_model::skeleton::SkeletonKind;

use crate::check::judge;
use crate::falloffs::soft;
use crate::row::{Family, Row, members, row};

members! { SkeletonKind {
    Point => points(),
    Segment => segments(),
    Disc => discs(),
    Ring => rings(),
    Cylinder => cylinders(),
    Cuboid => boxes(),
    Triangle => triangles(),
    Polyline => curves::polylines(),
    Polygon => flat::polygons(),
    Bezier => curves::beziers(),
    CatmullRom => curves::catmull_roms(),
    Sphere => solids::spheres(),
    Torus => solids::tori(),
    Cone => solids::cones(),
    RoundCone => solids::round_cones(),
    Rectangle => flat::rectangles(),
    Arc => curves::arcs(),
    Helix => curves::helices(),
    HalfSpace => solids::half_spaces(),
    Ellipsoid => norms::ellipsoids(),
    LMetric => norms::lmetrics(),
    Superquadric => norms::superquadrics(),
} }

fn found(_: &Model, tree: &CheckedTree) -> Vec<&'static str> {
    let of = |node: &CheckedNode| {
        let NodeKind::Primitive(leaf) = &node.kind else { return None };
        Some(name(&leaf.skeleton.kind()))
    };
    tree.nodes().iter().filter_map(of).collect()
}

#[test]
fn every_skeleton() {
    let members = members();
    assert_eq!(members.len(), SkeletonKind::ALL.len());
    judge(Family { name: "skeletons", members, found });
}

fn points() -> Vec<Row> {
    vec![
        row(
            "anywhere",
            "point { at (1 -2 0.5) radius 2 }",
            &[
                ([1.0, -2.0, 0.5], 1.0),
                ([2.0, -2.0, 0.5], 0.5),
                ([1.0, -2.0, -0.5], 0.5),
                ([2.0, -1.0, 1.5], soft(3.0 / 4.0)),
                ([1.0, 0.0, 0.5], 0.0),
                ([9.0, 0.0, 0.5], 0.0),
            ],
        ),
        row(
            "that pushes",
            "point { radius 1 strength -0.5 }",
            &[([0.0; 3], -0.5), ([0.0, 0.5, 0.0], -0.25), ([0.0, 0.0, -1.0], 0.0)],
        ),
        row(
            "by the radius of its surface",
            "iso 0.5 point { surface_radius 1 strength 1 }",
            &[([0.0; 3], 1.0), ([0.0, 0.0, 1.0], 0.5), ([0.0, -2.0, 0.0], 0.0)],
        ),
    ]
}

fn segments() -> Vec<Row> {
    vec![
        row(
            "along an axis",
            "segment { from (-1 0 0) to (1 0 0) radius 1 }",
            &[
                ([0.0; 3], 1.0),
                ([1.0, 0.0, 0.0], 1.0),
                ([0.5, 0.5, 0.0], 0.5),
                ([-1.5, 0.0, 0.0], 0.5),
                ([1.25, 0.0, -0.25], soft(1.0 / 8.0)),
                ([2.0, 0.0, 0.0], 0.0),
                ([4.0, 0.0, 0.0], 0.0),
            ],
        ),
        // (2, -1, 0) is across (1, 2, 2), which is 3 long.
        row(
            "in any direction",
            "segment { from (0 0 0) to (1 2 2) radius 3 }",
            &[
                ([0.0; 3], 1.0),
                ([0.5, 1.0, 1.0], 1.0),
                ([2.5, 0.0, 1.0], soft(5.0 / 9.0)),
                ([1.5, 3.0, 3.0], 0.5),
                ([-1.0, -2.0, -2.0], 0.0),
            ],
        ),
        row(
            "of no length",
            "segment { from (1 1 1) to (1 1 1) radius 2 }",
            &[([1.0; 3], 1.0), ([1.0, 2.0, 1.0], 0.5)],
        ),
    ]
}

fn discs() -> Vec<Row> {
    vec![
        row(
            "across an axis",
            "disc { center (0 0 1) normal (0 0 -7) disc_radius 2 radius 2 }",
            &[
                ([0.0, 0.0, 1.0], 1.0),
                ([0.0, 2.0, 1.0], 1.0),
                ([1.0, 0.5, 2.0], 0.5),
                ([3.0, 0.0, 1.0], 0.5),
                ([0.0, -3.0, 2.0], soft(2.0 / 4.0)),
                ([0.0, 0.0, 3.0], 0.0),
            ],
        ),
        row(
            "across any direction",
            "disc { normal (1 2 2) disc_radius 1 radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], 0.5),
                // In its plane, sqrt(5) from the middle.
                ([2.0, -1.0, 0.0], soft((5.0f64.sqrt() - 1.0).powi(2) / 4.0)),
            ],
        ),
        row("of no size", "disc { disc_radius 0 radius 1 }", &[([0.0; 3], 1.0), ([0.0, 0.5, 0.0], 0.5)]),
    ]
}

fn rings() -> Vec<Row> {
    vec![
        // On the axis all of it is equally far: radius^2 + height^2.
        row(
            "about an axis",
            "ring { normal x ring_radius 3 radius 4 }",
            &[
                ([0.0, 3.0, 0.0], 1.0),
                ([0.0, 1.0, 0.0], 0.5),
                ([0.0, 0.0, -5.0], 0.5),
                ([2.0, 0.0, 3.0], 0.5),
                ([0.0; 3], soft(9.0 / 16.0)),
                ([1.0, 0.0, 0.0], soft(10.0 / 16.0)),
                ([4.0, 3.0, 0.0], 0.0),
            ],
        ),
        row(
            "about any direction",
            "ring { center (0 0 1) normal (1 2 2) ring_radius 1 radius 2 }",
            &[
                ([0.0, 0.0, 1.0], soft(1.0 / 4.0)),
                ([2.0, -1.0, 1.0], soft((5.0f64.sqrt() - 1.0).powi(2) / 4.0)),
            ],
        ),
        row("of no size", "ring { ring_radius 0 radius 1 }", &[([0.0; 3], 1.0), ([0.5, 0.0, 0.0], 0.5)]),
    ]
}

fn cylinders() -> Vec<Row> {
    vec![
        row(
            "along an axis",
            "cylinder { from (0 0 0) to (0 4 0) cylinder_radius 1 radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([0.5, 2.0, 0.5], 1.0),
                ([1.0, 4.0, 0.0], 1.0),
                ([2.0, 2.0, 0.0], 0.5),
                ([0.5, 5.0, 0.0], 0.5),
                ([0.0, -1.0, 0.5], 0.5),
                ([0.0, -1.0, -2.0], soft(2.0 / 4.0)),
                ([0.0, 6.0, 0.0], 0.0),
            ],
        ),
        row(
            "in any direction",
            "cylinder { from (0 0 0) to (1 2 2) cylinder_radius 1 radius 2 }",
            &[
                ([0.5, 1.0, 1.0], 1.0),
                ([2.5, 0.0, 1.0], soft((5.0f64.sqrt() - 1.0).powi(2) / 4.0)),
                ([4.0 / 3.0, 8.0 / 3.0, 8.0 / 3.0], 0.5),
            ],
        ),
        row(
            "of no length",
            "cylinder { from (0 0 1) to (0 0 1) cylinder_radius 1 radius 2 }",
            &[([0.5, 0.0, 1.0], 1.0), ([0.0, 0.0, 2.0], 0.5), ([0.0, 2.0, 1.0], 0.5)],
        ),
    ]
}

fn boxes() -> Vec<Row> {
    vec![
        row(
            "with sides",
            "box { center (1 0 0) half (1 0.5 0.25) radius 2 }",
            &[
                ([1.0, 0.0, 0.0], 1.0),
                ([2.0, 0.5, 0.25], 1.0),
                ([3.0, 0.25, 0.0], 0.5),
                ([0.0, -1.5, 0.125], 0.5),
                ([1.5, 0.0, -1.25], 0.5),
                ([3.0, 1.5, 0.0], soft(2.0 / 4.0)),
                ([-1.0, -1.5, 1.25], soft(3.0 / 4.0)),
                ([4.0, 0.0, 0.0], 0.0),
            ],
        ),
        row(
            "that is flat",
            "box { half (1 1 0) radius 1 }",
            &[([0.0; 3], 1.0), ([0.5, 0.5, 0.5], 0.5), ([1.5, 1.0, 0.0], 0.5)],
        ),
        row("of no size", "box { half (0 0 0) radius 1 }", &[([0.0; 3], 1.0), ([0.0, 0.0, 0.5], 0.5)]),
    ]
}

fn triangles() -> Vec<Row> {
    vec![
        row(
            "in a plane",
            "triangle { a (0 0 0) b (4 0 0) c (0 4 0) radius 2 }",
            &[
                ([1.0, 1.0, 0.0], 1.0),
                ([0.0, 4.0, 0.0], 1.0),
                ([2.0, 2.0, 0.0], 1.0),
                ([1.0, 1.0, -1.0], 0.5),
                ([2.0, -1.0, 0.0], 0.5),
                ([-0.6, -0.8, 0.0], 0.5),
                ([5.0, 0.0, 0.0], 0.5),
                ([3.0, 3.0, 0.0], soft(2.0 / 4.0)),
                ([3.0, 3.0, 1.0], soft(3.0 / 4.0)),
                ([-2.0, 1.0, 0.0], 0.0),
            ],
        ),
        // Its normal is (1, 1, 1).
        row(
            "anywhere",
            "triangle { a (1 0 0) b (0 1 0) c (0 0 1) radius 2 }",
            &[([1.0 / 3.0; 3], 1.0), ([2.0 / 3.0; 3], soft(1.0 / 12.0)), ([2.0, 0.0, 0.0], soft(1.0 / 4.0))],
        ),
        row(
            "with corners on a line",
            "triangle { a (-1 0 0) b (1 0 0) c (0 0 0) radius 1 }",
            &[([0.5, 0.5, 0.0], 0.5), ([-1.5, 0.0, 0.0], 0.5)],
        ),
    ]
}
