//! The splash as a model: particles that are spread evenly in the liquid, each with its share of the field.
//!
//! The particles are the points of a sequence of low discrepancy that fall into the liquid, so they are
//! spread evenly without being on a lattice. Each gives its share of the field: deep inside the shares add up
//! to 1, and so the surface, at 1/2, is where the liquid ends.

#[path = "crown.rs"]
mod crown;

use jbt::build::{gradient, point};
use jbt::{Model, Tree};

use crown::{HIGH, LOW, inside};

/// How many particles there are.
pub const COUNT: usize = 100_000;

/// The radius of a particle's field, in mean distances of particles.
const REACH: f64 = 2.6;

/// The integral of the falloff `soft` over the ball of its radius, for the radius 1: `4 pi` times that of
/// `r^2 u^2 (5 + 4 u) / 9`, `u = 1 - r^2`, which is `8/105` for `u^2` and `16/315` for `u^3`.
const SOFT_VOLUME: f64 = 4.0 * std::f64::consts::PI * (5.0 * 8.0 / 105.0 + 4.0 * 16.0 / 315.0) / 9.0;

/// The point with this number of the sequence R_3 in the unit cube (Roberts 2018): multiples of powers of
/// 1/g, where g^4 = g + 1.
fn sequence(number: usize) -> [f64; 3] {
    const G: f64 = 1.220_744_084_605_76;
    [1, 2, 3].map(|power| (0.5 + number as f64 / G.powi(power)).fract())
}

/// The first points of the sequence that are in the liquid, and the mean distance of one to the next: the
/// third root of the volume that each has.
fn particles() -> (Vec<[f64; 3]>, f64) {
    let size: [f64; 3] = std::array::from_fn(|axis| HIGH[axis] - LOW[axis]);
    let (mut found, mut number) = (Vec::with_capacity(COUNT), 0);
    while found.len() < COUNT {
        number += 1;
        let place = sequence(number);
        let place = std::array::from_fn(|axis| LOW[axis] + size[axis] * place[axis]);
        if inside(place) {
            found.push(place);
        }
    }
    (found, (size.iter().product::<f64>() / number as f64).cbrt())
}

/// Four digits are enough, and make a short text.
fn rounded(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}

/// The sum of all particles, in shades of milk.
pub fn model() -> Model {
    let (places, distance) = particles();
    let radius = rounded(REACH * distance);
    let strength = rounded((distance / radius).powi(3) / SOFT_VOLUME);
    let leaf = |place: [f64; 3]| point(place.map(rounded), radius).strength(strength);
    let splash = Tree::sum(places.into_iter().map(leaf));
    let shades = gradient([0.0, 0.0, -0.1], [0.0, 0.0, 0.5]);
    Model::new(splash.textured("color", shades, &[0.55, 0.70, 0.78], &[0.92, 0.90, 0.86]))
}
