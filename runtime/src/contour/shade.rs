//! Numbers become colours of pixels.

use super::raster::Raster;
use crate::picture::Picture;

/// The colours of [`diverging`]: as far outside and inside as the field goes, and at the iso-value.
const OUTSIDE: [f32; 3] = [33.0, 102.0, 172.0];
const MIDDLE: [f32; 3] = [247.0, 247.0, 247.0];
const INSIDE: [f32; 3] = [178.0, 24.0, 43.0];
/// The contour in images of the field.
const DARK: [f32; 3] = [20.0, 20.0, 20.0];
const RED: [f32; 3] = [220.0, 20.0, 20.0];
/// The landscape of [`relief`]: where the solid is, and where it is not.
const LAND: [f32; 3] = [222.0, 184.0, 135.0];
const WATER: [f32; 3] = [176.0, 196.0, 214.0];

fn picture<T>(raster: &Raster<T>, pixel: impl Fn(usize, &T) -> [u8; 4]) -> Picture {
    let pixels = raster.values.iter().enumerate().map(|(index, value)| pixel(index, value)).collect();
    let [width, height] =
        [raster.width, raster.height].map(|side| u32::try_from(side).expect("sides are limited"));
    Picture::new(width, height, pixels).expect("a raster has a point for each pixel")
}

/// White where it is inside, black where it is not.
pub(super) fn mask(raster: &Raster<u8>) -> Picture {
    picture(raster, |_, &part| [part, part, part, u8::MAX])
}

/// Colours as they are, with what is not inside transparent.
pub(super) fn paint(raster: &Raster<[f32; 4]>) -> Picture {
    picture(raster, |_, color| color.map(|channel| byte(255.0 * channel)))
}

/// A number from 0 to 255 as the nearest byte; what is no number is 0.
fn byte(value: f32) -> u8 {
    // The cast saturates.
    (value + 0.5) as u8
}

fn opaque([r, g, b]: [f32; 3]) -> [u8; 4] {
    [byte(r), byte(g), byte(b), u8::MAX]
}

fn mix(a: [f32; 3], b: [f32; 3], part: f32) -> [f32; 3] {
    let part = if part.is_nan() { 0.0 } else { part.clamp(0.0, 1.0) };
    [0, 1, 2].map(|channel| a[channel] + part * (b[channel] - a[channel]))
}

/// The lowest and the highest finite field.
fn extent(field: &Raster<f32>) -> [f32; 2] {
    let finite = field.values.iter().copied().filter(|value| value.is_finite());
    finite.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// Whether the contour passes at a pixel: it is inside, and one of the four beside it is not.
fn on_contour(field: &Raster<f32>, index: usize, iso: f32) -> bool {
    let (column, row) = (index % field.width, index / field.width);
    let outside = |index: usize| !inside(field.values[index], iso);
    inside(field.values[index], iso)
        && ((column > 0 && outside(index - 1))
            || (column + 1 < field.width && outside(index + 1))
            || (row > 0 && outside(index - field.width))
            || (row + 1 < field.height && outside(index + field.width)))
}

fn inside(value: f32, iso: f32) -> bool {
    value >= iso
}

/// From blue over white at the iso-value to red; the contour is dark.
pub(super) fn diverging(field: &Raster<f32>, iso: f32) -> Picture {
    let [low, high] = extent(field);
    picture(field, |index, &value| {
        opaque(if on_contour(field, index, iso) {
            DARK
        } else if inside(value, iso) {
            mix(MIDDLE, INSIDE, (value - iso) / (high - iso))
        } else if value.is_nan() {
            OUTSIDE
        } else {
            mix(MIDDLE, OUTSIDE, (iso - value) / (iso - low))
        })
    })
}

/// From black to white; the contour is red.
pub(super) fn grey(field: &Raster<f32>, iso: f32) -> Picture {
    let [low, high] = extent(field);
    picture(field, |index, &value| {
        opaque(if on_contour(field, index, iso) {
            RED
        } else {
            mix([0.0; 3], [255.0; 3], (value - low) / (high - low))
        })
    })
}

/// The direction to the light, of length 1: to the left, upwards, towards the eye.
const LIGHT: [f32; 3] = [-0.48, 0.64, 0.6];

/// A landscape whose height is the field, of a steepness that shows most slopes.
pub(super) fn relief(field: &Raster<f32>, iso: f32) -> Picture {
    let slopes: Vec<[f32; 2]> = (0..field.values.len()).map(|index| slope(field, index)).collect();
    let squares = slopes.iter().map(|[a, b]| f64::from(a * a + b * b)).filter(|square| *square > 0.0);
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0_f64));
    // The root of their mean square is shown as a slope of 0.6, or 31 degrees.
    let scale = if count > 0.0 && sum.is_finite() { 0.6 * (count / sum).sqrt() as f32 } else { 0.0 };
    picture(field, |index, &value| {
        let [a, b] = slopes[index].map(|slope| scale * slope);
        let length = (a * a + b * b + 1.0).sqrt();
        let light = (LIGHT[2] - a * LIGHT[0] - b * LIGHT[1]) / length;
        let ground = if inside(value, iso) { LAND } else { WATER };
        let shaded = mix([0.0; 3], ground, 0.3 + 0.9 * light.max(0.0));
        opaque(if on_contour(field, index, iso) { mix(shaded, DARK, 0.7) } else { shaded })
    })
}

/// The slope to the right and upwards, in units of the field for each pixel; 0 where it is no number.
fn slope(field: &Raster<f32>, index: usize) -> [f32; 2] {
    let (width, column, row) = (field.width, index % field.width, index / field.width);
    let at = |column: usize, row: usize| field.values[row * width + column];
    let (left, right) = (column.saturating_sub(1), (column + 1).min(width - 1));
    let (above, below) = (row.saturating_sub(1), (row + 1).min(field.height - 1));
    let difference = |high: f32, low: f32, steps: usize| (high - low) / steps.max(1) as f32;
    [
        difference(at(right, row), at(left, row), right - left),
        difference(at(column, above), at(column, below), below - above),
    ]
    .map(|slope| if slope.is_finite() { slope } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raster(width: usize, values: &[f32]) -> Raster<f32> {
        Raster { width, height: values.len() / width, values: values.to_vec() }
    }

    #[test]
    fn colours_of_a_row() {
        let field = raster(5, &[0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(diverging(&field, 0.5).pixels()[0], opaque(OUTSIDE));
        assert_eq!(diverging(&field, 0.5).pixels()[2], opaque(DARK), "the first one inside");
        assert_eq!(diverging(&field, 0.5).pixels()[4], opaque(INSIDE));
        assert_eq!(grey(&field, 0.5).pixels()[0], [0, 0, 0, 255]);
        assert_eq!(grey(&field, 0.5).pixels()[2], opaque(RED));
        assert_eq!(grey(&field, 0.5).pixels()[3], [191, 191, 191, 255]);
        assert_eq!(slope(&field, 2), [0.25, 0.0]);
    }

    #[test]
    fn constant_fields_and_what_is_no_number_have_colours() {
        for value in [0.0, 1.0, f32::NAN, f32::INFINITY] {
            let field = raster(2, &[value; 4]);
            for shade in [diverging, grey, relief] {
                assert!(shade(&field, 0.5).pixels().iter().all(|pixel| pixel[3] == 255));
            }
        }
    }

    #[test]
    fn a_slope_towards_the_light_is_bright() {
        // It rises to the right: it looks to the left, where the light is.
        let up = raster(3, &[0.0, 0.1, 0.2, 0.0, 0.1, 0.2, 0.0, 0.1, 0.2]);
        let down = raster(3, &[0.2, 0.1, 0.0, 0.2, 0.1, 0.0, 0.2, 0.1, 0.0]);
        let middle = |field: &Raster<f32>| relief(field, 0.5).pixels()[4][0];
        assert!(middle(&up) > middle(&down) + 50);
    }
}
