//! Checks for the tests of all textures: both forms are compared, at ordinary places and at hostile ones.

use std::fmt::Debug;

use glam::DVec3;
use jbt_ir::domain::scalar::Scalar;

use super::TextureMember;

/// The compiler's form in f32: numbers are derived in f64 and rounded once.
pub fn emitted<T: TextureMember>(texture: &T, p: [f32; 3]) -> f32 {
    emitted_variant(texture, texture.variant(false), p)
}

fn emitted_variant<T: TextureMember>(texture: &T, variant: u8, p: [f32; 3]) -> f32 {
    let mut row = Vec::new();
    texture.push_columns(variant, &mut row);
    assert_eq!(row.len(), T::columns(variant).len(), "one number for each column");
    let row: Vec<f32> = row.into_iter().map(|x| x as f32).collect();
    T::emit(&mut Scalar, variant, p, &row)
}

/// Both forms agree away from jumps, for every variant, and stay within 0 and 1 everywhere. Returns the
/// least, the mean and the largest number.
pub fn judge<T: TextureMember + PartialEq + Debug>(
    mut make: impl FnMut(&mut fastrand::Rng) -> T,
) -> [f64; 3] {
    let mut rng = fastrand::Rng::with_seed(3);
    let (mut least, mut most, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0);
    for _ in 0..40 {
        let texture = make(&mut rng);
        assert_eq!(T::from_fields(&texture.to_fields()), texture);
        assert_eq!(texture.to_fields().len(), T::FIELDS.len());
        for _ in 0..200 {
            let p: [f32; 3] = std::array::from_fn(|_| 8.0 * rng.f32() - 4.0);
            let at = DVec3::from_array(p.map(f64::from));
            let value = texture.value(at);
            assert!((0.0..=1.0).contains(&value), "{texture:?} at {at}: {value}");
            if texture.kink_distance(at) > 1e-4 {
                for variant in [texture.variant(false), texture.variant(true)] {
                    let got = f64::from(emitted_variant(&texture, variant, p));
                    assert!((got - value).abs() < 1e-4, "{texture:?} at {at}: {got} in f32, not {value}");
                }
            }
            (least, most, sum, count) = (least.min(value), most.max(value), sum + value, count + 1);
        }
        for hostile in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e30, 1e-45, -0.0] {
            let got = emitted(&texture, [hostile, 0.3, hostile]);
            assert!((0.0..=1.0).contains(&got), "{texture:?} at {hostile}: {got}");
        }
    }
    [least, sum / f64::from(count), most]
}
