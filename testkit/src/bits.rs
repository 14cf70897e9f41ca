//! Bits of answers.

/// The bits of each plane. Planes with the same bits have no other zeros and no other NaNs.
pub fn bits<P: AsRef<[f32]>>(planes: impl IntoIterator<Item = P>) -> Vec<Vec<u32>> {
    planes.into_iter().map(|plane| plane.as_ref().iter().map(|x| x.to_bits()).collect()).collect()
}

/// Whether two numbers have the same bits; any NaN equals any NaN.
#[must_use]
pub fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Panics unless all planes have the [same](same()) numbers.
#[track_caller]
pub fn assert_same<P: AsRef<[f32]>>(expected: &[P], given: &[P], what: &str) {
    assert_eq!(expected.len(), given.len(), "{what}");
    for (plane, (expected, given)) in expected.iter().zip(given).enumerate() {
        let (expected, given) = (expected.as_ref(), given.as_ref());
        assert_eq!(expected.len(), given.len(), "{what}");
        for (point, (&expected, &given)) in expected.iter().zip(given).enumerate() {
            let same = same(expected, given);
            assert!(same, "{what}: plane {plane} of point {point} is {given:e}, and not {expected:e}");
        }
    }
}
