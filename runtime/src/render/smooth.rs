//! Smoothing of light: what neighbouring pixels have gathered, where they see the same surface.
//!
//! Three passes with holes that grow (Dammertz et al., Edge-avoiding à-trous wavelet transform for fast
//! global illumination filtering, 2010). A neighbour counts as much as it lies in the plane of the pixel and
//! looks the same way; in the later passes, the share of the key light counts too, so that rims of shadows
//! stay.

use super::gather::Light;
use super::seen::{SeenKind, SeenPoint};
use crate::parallel::*;
use crate::span::span;

/// The distances of neighbours in pixels, and the difference of key light that halves a neighbour's weight.
const PASSES: [(usize, f32); 3] = [(1, 4.0), (2, 0.8), (4, 0.45)];
/// Rows beside a pixel that have a part in its light.
pub const SMOOTH_ROWS: u32 = 7;

/// Sums of light, weighted.
#[derive(Default)]
struct LightSum {
    key: [f32; 2],
    sky: [f32; 5],
}

impl LightSum {
    fn add(&mut self, light: &Light, weight: f32, key_weight: f32) {
        self.key[0] += light.key * key_weight;
        self.key[1] += key_weight;
        for (sum, part) in
            self.sky.iter_mut().zip([light.sky[0], light.sky[1], light.sky[2], light.open, 1.0])
        {
            *sum += part * weight;
        }
    }

    fn mean(&self) -> Light {
        let [red, green, blue, open, weight] = self.sky;
        let sky = [red, green, blue].map(|sum| sum / weight);
        Light { key: self.key[0] / self.key[1], facing: 0.0, sky, open: open / weight }
    }
}

/// The smoothed light of rows of pixels of this width. `facing` is left 0.
pub fn smooth(seen: &[SeenPoint], mut lights: Vec<Light>, width: usize) -> Vec<Light> {
    span!("smooth");
    for (step, halving) in PASSES {
        let smooth = |row| smooth_row(seen, &lights, width, row, (step, halving));
        let rows: Vec<Vec<Light>> =
            scatter(|_| (0..seen.len() / width).into_par_iter().map(smooth).collect());
        lights = rows.concat();
    }
    lights
}

fn smooth_row(
    seen: &[SeenPoint],
    lights: &[Light],
    width: usize,
    row: usize,
    (step, halving): (usize, f32),
) -> Vec<Light> {
    let rows = seen.len() / width;
    (0..width)
        .map(|column| {
            let here = row * width + column;
            let (pixel, light) = (&seen[here], &lights[here]);
            if matches!(pixel.kind, SeenKind::Nothing) {
                return *light;
            }
            let mut sum = LightSum::default();
            sum.add(light, 1.0, 1.0);
            for (down, across, kernel) in NEIGHBOURS {
                let (y, x) = (row as isize + down * step as isize, column as isize + across * step as isize);
                if y < 0 || x < 0 || y >= rows as isize || x >= width as isize {
                    continue;
                }
                let there = y as usize * width + x as usize;
                let weight = kernel * pixel.likeness(&seen[there], step as f32);
                if weight > 0.0 {
                    let difference = (lights[there].key - light.key) / halving;
                    sum.add(&lights[there], weight, weight / (1.0 + difference * difference));
                }
            }
            sum.mean()
        })
        .collect()
}

/// Rows down and columns across to the neighbours, and their weight beside that of the pixel.
const NEIGHBOURS: [(isize, isize, f32); 8] = [
    (-1, -1, 0.25),
    (-1, 0, 0.5),
    (-1, 1, 0.25),
    (0, -1, 0.5),
    (0, 1, 0.5),
    (1, -1, 0.25),
    (1, 0, 0.5),
    (1, 1, 0.25),
];
