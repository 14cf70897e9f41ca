//! Colours: encoding for screens, and colour maps.

pub(super) use crate::srgb::{ScreenBytes, byte, decode, unit};

/// Red, green and blue.
pub type Rgb = [f32; 3];

/// Maps light of any strength to light that a screen has: unchanged up to 0.6, then compressed, up to 1.
/// Continuous with its derivative.
pub fn shoulder(light: f32) -> f32 {
    const KNEE: f32 = 0.6;
    const ROOM: f32 = 1.0 - KNEE;
    if light <= KNEE {
        return light.max(0.0);
    }
    let over = (light - KNEE) / ROOM;
    KNEE + ROOM * over / (1.0 + over)
}

/// The colour of a number from 0 to 1 on the map *viridis* (Smith and van der Walt, 2015), as screen values:
/// dark blue, green, yellow. Equal steps look equally large.
///
/// A polynomial fitted by Zucker (2019), with an error below 0.02.
pub fn viridis(t: f32) -> Rgb {
    polynomial(&VIRIDIS, t)
}

/// The colour of a number from 0 to 1 on the map *inferno* (Smith and van der Walt, 2015): black, red,
/// yellow. From the same source as [`viridis`].
pub fn inferno(t: f32) -> Rgb {
    polynomial(&INFERNO, t)
}

fn polynomial(coefficients: &[Rgb; 7], t: f32) -> Rgb {
    let t = unit(t);
    let value = |channel: usize| coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c[channel]);
    [0, 1, 2].map(|channel| unit(value(channel)))
}

/// Coefficients of 1, t, t^2 and so on.
const VIRIDIS: [Rgb; 7] = [
    [0.277_727, 0.005_407_3, 0.334_1],
    [0.105_093, 1.404_613_5, 1.384_590_2],
    [-0.330_861_8, 0.214_847_6, 0.095_095_2],
    [-4.634_230_5, -5.799_101, -19.332_441],
    [6.228_27, 14.179_933, 56.690_55],
    [4.776_385, -13.745_145, -65.353_03],
    [-5.435_456, 4.645_852_6, 26.312_435],
];

/// Coefficients of 1, t, t^2 and so on.
const INFERNO: [Rgb; 7] = [
    [0.000_218_9, 0.001_651, -0.019_480_9],
    [0.106_513_4, 0.563_956_4, 3.932_712_4],
    [11.602_493, -3.972_854, -15.942_394],
    [-41.703_996, 17.436_4, 44.354_145],
    [77.162_93, -33.402_36, -81.807_31],
    [-71.319_43, 32.626_064, 73.209_52],
    [25.131_126, -12.242_669, -23.070_325],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shoulder_keeps_order_and_stays_below_one() {
        assert_eq!(shoulder(0.4), 0.4);
        let mut last = -1.0;
        for step in 0..400 {
            let shown = shoulder(step as f32 / 100.0);
            assert!(shown > last && shown < 1.0);
            last = shown;
        }
    }

    /// Compared with entries 0, 128 and 255 of the published tables.
    #[test]
    fn the_maps_are_those_that_were_published() {
        let near = |found: Rgb, expected: Rgb| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.02), "{found:?} {expected:?}");
        };
        near(viridis(0.0), [0.267, 0.005, 0.329]);
        near(viridis(0.502), [0.128, 0.567, 0.551]);
        near(viridis(1.0), [0.993, 0.906, 0.144]);
        near(inferno(0.0), [0.001, 0.0, 0.014]);
        near(inferno(0.502), [0.736, 0.216, 0.330]);
        near(inferno(1.0), [0.988, 0.998, 0.645]);
        assert_eq!(viridis(f32::NAN), viridis(0.0));
    }
}
