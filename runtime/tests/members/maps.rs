//! Affine maps whose numbers depend on parameters: their code serves all values of them. (`nodes` has plain
//! ones.)

use jbt::{CheckedTree, Model, Tree};
use jbt_model::map::MapKind;
use jbt_model::traverse::Visit;
use jbt_model::written::Written;

use crate::check::judge;
use crate::falloffs::soft;
use crate::row::{Family, members, row};

members! { MapKind {
    Translate => vec![row("of a ball", "param t = 1 translate (t 2 -t) { point { radius 2 } }", &[
        ([1.0, 2.0, -1.0], 1.0),
        ([2.0, 2.0, -1.0], 0.5),
    ])],
    Rotate => vec![
        row("of a rod", "param t = 90 rotate axis z degrees t { segment { from (0 0 0) to (2 0 0) radius 1 } }", &[
            ([0.0, 2.0, 0.0], 1.0),
            ([0.5, 1.0, 0.0], 0.5),
            ([2.0, 0.0, 0.0], 0.0),
        ]),
    ],
    RotateRadians => vec![
        row("about an axis that turns", "param t = 1 rotate axis (t t 1) radians 2 * pi / 3 * t { box { half (1 0 0) radius 1 } }", &[
            ([0.0, 1.0, 0.0], 1.0),
            ([0.0, -1.5, 0.0], 0.5),
            ([0.0, 0.0, 0.5], 0.5),
        ]),
    ],
    Scale => vec![row("of a ring", "param t = 2 scale t { ring { ring_radius 1 radius 1 } }", &[
        ([0.0, 2.0, 0.0], 1.0),
        ([0.0, 2.0, 1.0], 0.5),
        ([0.0; 3], 0.0),
    ])],
    ScaleAxes => vec![row("of a ball", "param t = 0.5 scale (2 1 -t) { point { at (0 0 -1) radius 1 } }", &[
        ([0.0, 0.0, 0.5], 1.0),
        ([1.0, 0.0, 0.5], 0.5),
        ([0.0, 0.5, 0.5], 0.5),
        ([0.0, 0.0, 0.25], 0.5),
        ([1.0, 0.5, 0.5], soft(0.5)),
    ])],
    // In the plane across (1, -1, 0), x and y change places.
    Reflect => vec![
        row("of a rod", "param t = 1 reflect axis (t -t 0) { segment { from (1 0 0) to (2 0 0) radius 1 } }", &[
            ([0.0, 1.5, 0.0], 1.0),
            ([0.5, 1.0, 0.0], 0.5),
            ([0.0, 2.0, 0.5], 0.5),
            ([2.0, 0.0, 0.0], 0.0),
        ]),
        row("in a plane across an axis", "param t = 3 reflect axis (0 0 t) { point { at (0 0 1) radius 1 } }", &[
            ([0.0, 0.0, -1.0], 1.0),
            ([0.0, 0.0, -1.5], 0.5),
            ([0.0, 0.0, 0.5], 0.0),
        ]),
    ],
    Stretch => vec![
        row("along an axis", "param t = 2 stretch axis y by t { point { radius 1 } }", &[
            ([0.0, 1.0, 0.0], 0.5),
            ([0.5, 0.0, 0.0], 0.5),
            ([0.5, 1.0, 0.0], soft(0.5)),
            ([0.0, 2.0, 0.0], 0.0),
        ]),
        // Half as much of (1, 1, 0), and all of (1, -1, 0).
        row("along any direction", "param t = 2 stretch axis (t t 0) by t { point { radius 1 } }", &[
            ([0.5, 0.5, 0.0], soft(0.125)),
            ([0.5, -0.5, 0.0], soft(0.5)),
            ([1.0, 0.0, 0.0], soft(0.75 * 0.75 + 0.25 * 0.25)),
            ([0.0, 0.0, 0.5], 0.5),
        ]),
        row("that mirrors", "param t = -0.5 stretch axis x by t { point { at (2 0 0) radius 1 } }", &[
            ([-1.0, 0.0, 0.0], 1.0),
            ([-1.25, 0.0, 0.0], 0.5),
            ([2.0, 0.0, 0.0], 0.0),
        ]),
    ],
    Shear => vec![
        row("of a rod", "param t = 0.5 shear axis z by (t 0 0) { segment { from (0 0 -1) to (0 0 1) radius 1 } }", &[
            ([0.5, 0.0, 1.0], 1.0),
            ([-0.5, 0.0, -1.0], 1.0),
            ([1.0, 0.0, 1.0], 0.5),
            ([0.0, 0.5, 0.0], 0.5),
            ([-0.5, 0.0, 1.0], 0.0),
        ]),
        // The height along (0, 3, 4) is (3 y + 4 z) / 5, whatever its length is: 1 at (0, 3, 4) / 5.
        row("along any direction", "param t = 2 shear axis (0 3 4) by (t 0 0) { point { radius 1 } }", &[
            ([0.0; 3], 1.0),
            ([1.0, 0.3, 0.4], soft(0.25)),
            ([0.5, 0.4, -0.3], soft(0.5)),
            ([2.0, 0.6, 0.8], 0.0),
        ]),
    ],
    Affine => vec![row("that shears", "param t = 1 affine (1 t 0 0  0 1 0 0  0 0 1 t) { point { radius 1 } }", &[
        ([0.0, 0.0, 1.0], 1.0),
        ([1.0, 0.5, 1.0], soft(0.5)),
        ([0.5, 0.5, 1.0], 0.5),
    ])],
} }

fn found(model: &Model, _: &CheckedTree) -> Vec<&'static str> {
    let of = |tree: &Tree| {
        let Written::Map { map, .. } = tree.node().written() else { return None };
        Some(name(map))
    };
    model.root.prefix(Visit::Nodes).filter_map(of).collect()
}

#[test]
fn every_map() {
    judge(Family { name: "maps", members: members(), found });
}
