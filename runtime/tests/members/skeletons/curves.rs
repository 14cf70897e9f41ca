//! Lines and curves: polylines and tubes, cubic curves, arcs.

use crate::falloffs::soft;
use crate::row::{Row, row};

pub fn polylines() -> Vec<Row> {
    vec![
        row(
            "with a corner",
            "polyline { points ((-2 0 0) (0 0 0) (0 2 0)) radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([-1.0, 0.0, 0.0], 1.0),
                ([0.0, 2.0, 0.0], 1.0),
                ([-1.0, -1.0, 0.0], 0.5),
                ([1.0, 1.0, 0.0], 0.5),
                ([0.0, 3.0, 0.0], 0.5),
                // As near to one line as to the other, nearer to one, and nearest to the corner.
                ([-1.0, 1.0, 0.0], 0.5),
                ([-0.5, 0.25, 0.0], soft(1.0 / 64.0)),
                ([1.0, -1.0, 0.0], soft(2.0 / 4.0)),
                ([-3.0, 0.0, 1.0], soft(2.0 / 4.0)),
                ([0.0, 4.0, 0.0], 0.0),
                ([9.0, 0.0, 0.0], 0.0),
            ],
        ),
        // Sides of 3, 4 and 5: the circle inside has the radius 1.
        row(
            "that is closed",
            "polyline { points ((0 0 0) (4 0 0) (0 3 0)) closed yes radius 2 }",
            &[
                ([2.0, 1.5, 0.0], 1.0),
                ([0.0, 1.5, 0.0], 1.0),
                ([1.0, 1.0, 0.0], 0.5),
                ([2.0 + 3.0 / 5.0, 1.5 + 4.0 / 5.0, 0.0], 0.5),
                ([0.0, 0.0, -1.0], 0.5),
                ([-1.0, -1.0, 1.0], soft(3.0 / 4.0)),
            ],
        ),
        row(
            "with one radius for all points",
            "polyline { points ((-1 0 0) (-1 0 0) (1 0 0)) radii (1) radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([0.5, 0.5, 0.5], 1.0),
                ([0.0, 2.0, 0.0], 0.5),
                ([3.0, 0.0, 0.0], 0.5),
                ([-2.0, 0.0, 0.0], 1.0),
                ([0.0, 0.0, -3.0], 0.0),
            ],
        ),
        // The radius grows by 3/5 of the way, so the flank of the first line faces (-3, 4) / 5. From the
        // middle, with the radius 5/2, that reaches the flank after 5/2 and a distance of 1 after 7/2. The
        // second line is the same the other way round.
        row(
            "with a radius for each point",
            "polyline { points ((0 0 0) (5 0 0) (5 5 0)) radii (1 4 1) radius 2 }",
            &[
                ([5.0, 0.0, 0.0], 1.0),
                ([2.5 - 2.4 * 3.0 / 5.0, -2.4 * 4.0 / 5.0, 0.0], 1.0),
                ([2.5 - 3.5 * 3.0 / 5.0, -3.5 * 4.0 / 5.0, 0.0], 0.5),
                ([5.0 + 3.5 * 4.0 / 5.0, 2.5 + 3.5 * 3.0 / 5.0, 0.0], 0.5),
                ([-2.0, 0.0, 0.0], 0.5),
                ([5.0, 0.0, 5.0], 0.5),
                ([5.0, 7.0, 0.0], 0.5),
            ],
        ),
        row(
            "of which one ball holds the rest",
            "polyline { points ((0 0 0) (1 0 0)) radii (3 1) radius 2 }",
            &[([1.0, 0.0, 0.0], 1.0), ([4.0, 0.0, 0.0], 0.5), ([0.0, 0.0, -4.0], 0.5)],
        ),
    ]
}

pub fn beziers() -> Vec<Row> {
    vec![
        row(
            "that is straight",
            "bezier { points ((0 0 0) (1 0 0) (2 0 0) (3 0 0)) radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([1.75, 0.0, 0.0], 1.0),
                ([1.5, 0.0, -1.0], 0.5),
                ([4.0, 0.0, 0.0], 0.5),
                ([-1.0, 1.0, 0.0], soft(2.0 / 4.0)),
                ([5.0, 0.0, 0.0], 0.0),
            ],
        ),
        // y = x^2 / 3 from -3 to 3. At x = 9/8 the slope is 3/4, and what is out of it lies towards (3, -4)
        // / 5. On the axis the nearest place is the vertex as far as 3/2, its radius of curvature; from (0,
        // 5/2) there are two, where x^2 = 3.
        row(
            "along a parabola",
            "bezier { points ((-3 3 0) (-1 -1 0) (1 -1 0) (3 3 0)) radius 4 }",
            &[
                ([0.0; 3], 1.0),
                ([3.0, 3.0, 0.0], 1.0),
                ([9.0 / 8.0, 27.0 / 64.0, 0.0], 1.0),
                ([9.0 / 8.0 + 2.0 * 3.0 / 5.0, 27.0 / 64.0 - 2.0 * 4.0 / 5.0, 0.0], 0.5),
                ([0.0, 0.0, 2.0], 0.5),
                ([0.0, 1.0, 0.0], soft(1.0 / 16.0)),
                ([0.0, 2.5, 0.0], soft((3.0 + 1.5 * 1.5) / 16.0)),
                ([0.0, -2.0, 0.0], 0.5),
                // Beyond its end.
                ([3.0 + 2.0 * 3.0 / 5.0, 3.0 + 2.0 * 4.0 / 5.0, 0.0], 0.5),
                ([0.0, -4.0, 0.0], 0.0),
            ],
        ),
        // Flanks as those of a polyline with this growth: 3/5.
        row(
            "with a radius that grows",
            "bezier { points ((0 0 0) (5 0 0) (10 0 0) (15 0 0)) radii (1 4 7 10) radius 2 }",
            &[
                ([15.0, 0.0, 9.0], 1.0),
                ([2.5 - 2.4 * 3.0 / 5.0, 0.0, 2.4 * 4.0 / 5.0], 1.0),
                ([2.5 - 3.5 * 3.0 / 5.0, 3.5 * 4.0 / 5.0, 0.0], 0.5),
                ([-2.0, 0.0, 0.0], 0.5),
                ([26.0, 0.0, 0.0], 0.5),
            ],
        ),
        row(
            "of two curves with a corner between them",
            "bezier { points ((-3 0 0) (-2 0 0) (-1 0 0) (0 0 0) (0 1 0) (0 2 0) (0 3 0)) radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([-1.0, -1.0, 0.0], 0.5),
                ([1.0, 1.0, 0.0], 0.5),
                ([-1.0, 1.0, 0.0], 0.5),
                ([1.0, -1.0, 0.0], soft(2.0 / 4.0)),
                ([0.0, 4.0, 0.0], 0.5),
            ],
        ),
    ]
}

pub fn catmull_roms() -> Vec<Row> {
    let across_corner = 2f64.sqrt() - 0.25;
    vec![
        row(
            "that is straight",
            "catmull_rom { points ((0 0 0) (1 0 0) (2 0 0)) radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([1.25, 0.0, 0.0], 1.0),
                ([1.0, 0.0, 1.0], 0.5),
                ([3.0, 0.0, 0.0], 0.5),
                ([-2.0, 0.0, 0.0], 0.0),
            ],
        ),
        // With w = |x| / 5 it is y = 3 w^2 (2 - w): the coefficients of a half are 3, 2, 0, 0. At w = 1/2 the
        // slope is 3/5 (4 w - 3 w^2) = 3/4.
        row(
            "through three points",
            "catmull_rom { points ((-5 3 0) (0 0 0) (5 3 0)) radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([5.0, 3.0, 0.0], 1.0),
                ([-2.5, 9.0 / 8.0, 0.0], 1.0),
                ([2.5 + 3.0 / 5.0, 9.0 / 8.0 - 4.0 / 5.0, 0.0], 0.5),
                ([0.0, 1.0, 0.0], 0.5),
                ([0.0, -1.0, 0.0], 0.5),
                ([0.0, 0.0, -1.0], 0.5),
                // Beyond its end.
                ([5.0 + 4.0 / 5.0, 3.0 + 3.0 / 5.0, 0.0], 0.5),
            ],
        ),
        // The curve above the middle has the coefficients y = 1, 4/3, 4/3, 1: it is highest in the middle,
        // 5/4. At the corners it goes across the diagonal and lies behind it.
        row(
            "that is closed, with a radius",
            "catmull_rom { points ((1 1 0) (-1 1 0) (-1 -1 0) (1 -1 0)) radii (0.25) closed yes radius 2 }",
            &[
                ([0.0, 1.25, 0.0], 1.0),
                ([1.0, 1.0, 0.25], 1.0),
                ([0.0, 1.25 + 0.25 + 1.0, 0.0], 0.5),
                ([-1.25, 0.0, 1.25], 0.5),
                ([2.0, 2.0, 0.0], soft(across_corner * across_corner / 4.0)),
                // The four highest places are equally far from the middle.
                ([0.0; 3], 0.5),
            ],
        ),
    ]
}

pub fn helices() -> Vec<Row> {
    vec![
        // From (2, 0, -4) to (2, 0, 4).
        row(
            "of two turns",
            "helix { helix_radius 2 pitch 4 turns 2 radius 4 }",
            &[
                ([2.0, 0.0, -4.0], 1.0),
                ([0.0, 2.0, -3.0], 1.0),
                ([-2.0, 0.0, 2.0], 1.0),
                ([0.0, -4.0, -1.0], 0.5),
                // On the axis, and beyond the ends.
                ([0.0; 3], 0.5),
                ([0.0, 0.0, -5.0], soft(5.0 / 16.0)),
                ([2.0, 0.0, 6.0], 0.5),
                ([2.0, 0.0, -8.0], 0.0),
            ],
        ),
        // From (0, 2, 1) by way of (-2, 0, 0) to (0, -2, -1).
        row(
            "of half a turn, left-handed",
            "helix { start y helix_radius 2 pitch -4 turns 0.5 radius 4 }",
            &[
                ([0.0, 2.0, 1.0], 1.0),
                ([-2.0, 0.0, 0.0], 1.0),
                ([0.0, -2.0, -1.0], 1.0),
                ([-4.0, 0.0, 0.0], 0.5),
            ],
        ),
        row(
            "of no length, about any direction",
            "helix { center (0 0 1) normal (0 0 -3) start (1 0 7) helix_radius 2 pitch 1 turns 0 radius 4 }",
            &[([2.0, 0.0, 1.0], 1.0), ([2.0, 2.0, 1.0], 0.5), ([-2.0, 0.0, 1.0], 0.0)],
        ),
    ]
}

pub fn arcs() -> Vec<Row> {
    vec![
        row(
            "of a quarter",
            "arc { degrees 90 arc_radius 2 radius 4 }",
            &[
                ([2.0, 0.0, 0.0], 1.0),
                ([0.0, 2.0, 0.0], 1.0),
                ([2.0 * 3.0 / 5.0, 2.0 * 4.0 / 5.0, 2.0], 0.5),
                ([4.0 * 3.0 / 5.0, 4.0 * 4.0 / 5.0, 0.0], 0.5),
                // Beyond its ends.
                ([2.0, -2.0, 0.0], 0.5),
                ([-2.0, 2.0, 0.0], 0.5),
                // On the axis all of it is equally far, and behind that both ends are.
                ([0.0; 3], 0.5),
                ([0.0, 0.0, 1.0], soft(5.0 / 16.0)),
                ([-1.0, -1.0, 0.0], soft(10.0 / 16.0)),
                ([-3.0, -3.0, 0.0], 0.0),
            ],
        ),
        // From y over z and -y to -z.
        row(
            "of three quarters",
            "arc { normal x start y degrees 270 arc_radius 2 radius 4 }",
            &[
                ([0.0, 2.0, 0.0], 1.0),
                ([0.0, 0.0, 2.0], 1.0),
                ([0.0, -2.0, 0.0], 1.0),
                ([0.0, 0.0, -2.0], 1.0),
                ([0.0, -4.0, 0.0], 0.5),
                ([2.0, 0.0, 2.0], 0.5),
                ([0.0; 3], 0.5),
                // In the quarter that is left out.
                ([0.0, 2.0, -2.0], 0.5),
                ([0.0, 3.0, -1.0], soft(2.0 / 16.0)),
                ([0.0, 1.0, -3.0], soft(2.0 / 16.0)),
            ],
        ),
        row(
            "of a half, about any direction",
            "arc { center (0 0 1) normal (0 0 -3) start (1 0 7) degrees 180 arc_radius 2 radius 4 }",
            &[
                ([2.0, 0.0, 1.0], 1.0),
                ([0.0, -2.0, 1.0], 1.0),
                ([-2.0, 0.0, 1.0], 1.0),
                ([0.0, 2.0, 1.0], soft(8.0 / 16.0)),
                ([1.0, 1.0, 1.0], soft(2.0 / 16.0)),
            ],
        ),
        row(
            "of a whole circle",
            "arc { degrees 360 arc_radius 2 radius 4 }",
            &[([2.0, 0.0, 0.0], 1.0), ([0.0, -2.0, 0.0], 1.0), ([-4.0, 0.0, 0.0], 0.5), ([0.0; 3], 0.5)],
        ),
        row(
            "of no length",
            "arc { degrees 0 arc_radius 2 radius 4 }",
            &[([2.0, 0.0, 0.0], 1.0), ([2.0, 2.0, 0.0], 0.5), ([0.0; 3], 0.5), ([-2.0, 0.0, 0.0], 0.0)],
        ),
    ]
}
