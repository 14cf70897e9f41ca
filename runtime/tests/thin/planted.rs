//! Parts that are thinner than a cell, anywhere and any way round: sheets, rods and specks, of soft
//! primitives, walls and formulas.

use fastrand::Rng;
use jbt_testkit::points::between;

/// What is thin about a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thin {
    /// Along one axis.
    Sheet,
    /// Along two.
    Rod,
    /// Along all.
    Speck,
}

impl Thin {
    pub const ALL: [Self; 3] = [Self::Sheet, Self::Rod, Self::Speck];
}

/// What makes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// A primitive with a falloff.
    Soft,
    /// A box with walls.
    Walled,
    /// A formula of the point.
    Formula,
}

impl Made {
    pub const ALL: [Self; 3] = [Self::Soft, Self::Walled, Self::Formula];
}

/// A planted part.
pub struct Planted {
    /// As text, in its place.
    pub text: String,
    pub center: [f64; 3],
    /// Everything of it is within this of its centre.
    pub reach: f64,
    /// Half of its thickness, in cells.
    pub half: f64,
}

/// A part about a place, for cells of this edge.
pub fn planted(rng: &mut Rng, (thin, made): (Thin, Made), center: [f64; 3], cell: f64) -> Planted {
    let half = between(rng, 0.02, 0.45);
    let w = half * cell;
    let mut long = || between(rng, 3.0, 8.0) * cell;
    let [a, b, c] = match thin {
        Thin::Sheet => [long(), long(), w],
        Thin::Rod => [w, w, long()],
        Thin::Speck => [w; 3],
    };
    let text = match (made, thin) {
        (Made::Soft, Thin::Sheet) => {
            format!("rectangle {{ normal z along x half_length {a} half_width {b} surface_radius {w} }}")
        }
        (Made::Soft, Thin::Rod) => format!("segment {{ from (0 0 -{c}) to (0 0 {c}) surface_radius {w} }}"),
        (Made::Soft, Thin::Speck) => format!("point {{ surface_radius {w} }}"),
        (Made::Walled, _) => format!("within (-{a} -{b} -{c}) to ({a} {b} {c}) {{ expression {{ 1 }} }}"),
        (Made::Formula, _) => {
            let within = [a, b, c].map(|half| half + w);
            let [x, y, z] = within;
            format!(
                "expression within (-{x} -{y} -{z}) to ({x} {y} {z}) \
                 {{ 0.5 + min(min({a} - abs(x), {b} - abs(y)), {c} - abs(z)) / {} }}",
                2.0 * w
            )
        }
    };
    let axis: [f64; 3] = std::array::from_fn(|_| between(rng, -1.0, 1.0));
    let [u, v, n] = axis;
    let degrees = between(rng, 0.0, 360.0);
    let [x, y, z] = center;
    let text =
        format!("translate ({x} {y} {z}) {{ rotate axis ({u} {v} {n}) degrees {degrees} {{ {text} }} }}");
    let reach = [a, b, c].iter().map(|half| half * half).sum::<f64>().sqrt() + w;
    Planted { text, center, reach, half }
}
