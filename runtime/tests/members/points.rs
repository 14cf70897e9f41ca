//! Points and boxes that rows are tried at.

use fastrand::Rng;
use jbt::{Box3, Points};

use jbt_testkit::points::SPICE;

/// A point of a box.
fn inside(rng: &mut Rng, bounds: &Box3) -> [f32; 3] {
    std::array::from_fn(|axis| {
        let (low, high) = (bounds.low[axis], bounds.high[axis]);
        (low + (high - low) * rng.f32()).clamp(low, high)
    })
}

/// Points of a box, anywhere.
pub fn anywhere(rng: &mut Rng, bounds: &Box3, count: usize) -> Points {
    (0..count).map(|_| inside(rng, bounds)).collect()
}

/// Points of a box, its corners, edges and sides among them.
pub fn with_sides(rng: &mut Rng, bounds: &Box3, count: usize) -> Points {
    let mut point = || {
        let mut point = inside(rng, bounds);
        for (axis, x) in point.iter_mut().enumerate() {
            match rng.u8(0..8) {
                0 => *x = bounds.low[axis],
                1 => *x = bounds.high[axis],
                2.. => {}
            }
        }
        point
    };
    (0..count).map(|_| point()).collect()
}

/// Points of a box, every fourth with zeros of both signs, huge numbers, infinities or NaN among its
/// coordinates.
pub fn spiced(rng: &mut Rng, bounds: &Box3, count: usize) -> Points {
    let mut point = || {
        let mut point = inside(rng, bounds);
        if rng.u8(0..4) == 0 {
            for _ in 0..rng.usize(1..4) {
                point[rng.usize(0..3)] = SPICE[rng.usize(0..SPICE.len())];
            }
        }
        point
    };
    (0..count).map(|_| point()).collect()
}

/// The points of a box with round coordinates: multiples of a power of two, about 16 along its longest side.
/// That is where skeletons begin, end and have their centres.
pub fn round(bounds: &Box3) -> Points {
    let step = (bounds.longest_side() / 16.0).log2().ceil().exp2();
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let (first, last) =
            ((bounds.low[axis] / step).ceil() as i32, (bounds.high[axis] / step).floor() as i32);
        (first..=last).map(move |index| index as f32 * step)
    });
    x.flat_map(|x| {
        let z = z.clone();
        y.clone().flat_map(move |y| z.clone().map(move |z| [x, y, z]))
    })
    .collect()
}

/// A closed box in another: large or small, flat now and then.
pub fn part(rng: &mut Rng, whole: &Box3) -> Box3 {
    let size = [1.0, 0.5, 0.1, 1e-3][rng.usize(0..4)];
    let mut part = *whole;
    for axis in 0..3 {
        let (low, high) = (whole.low[axis], whole.high[axis]);
        let length = if rng.u8(0..20) == 0 { 0.0 } else { (high - low) * size * rng.f32() };
        let at = (low + (high - low - length) * rng.f32()).clamp(low, high);
        part.low[axis] = at;
        part.high[axis] = (at + length).clamp(at, high);
    }
    part
}
