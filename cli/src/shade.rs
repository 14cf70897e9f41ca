//! Colours by an attribute: its values through a palette of colours, from the least to the largest.

use jbt::mesh::{Attribute, Mesh};
use jbt::tree::normalized;

use crate::failure::Failure;

/// Viridis (Smith and van der Walt 2015): nine colours of it in sRGB, as bytes. As light it grows evenly.
const VIRIDIS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];
/// Blue, white, red: for values around a middle.
const COOLWARM: [[u8; 3]; 3] = [[0x3b, 0x4c, 0xc0], [0xdd, 0xdd, 0xdd], [0xb4, 0x04, 0x26]];
/// Black to white.
const GREY: [[u8; 3]; 2] = [[0, 0, 0], [0xff, 0xff, 0xff]];

/// A palette of colours.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Ramp {
    /// Violet, green, yellow
    Viridis,
    /// Blue, white, red
    Coolwarm,
    /// Black to white
    Grey,
}

impl Ramp {
    /// The colour at a place from 0 to 1, as linear light.
    fn at(self, place: f32) -> [f32; 3] {
        let colors: &[[u8; 3]] = match self {
            Self::Viridis => &VIRIDIS,
            Self::Coolwarm => &COOLWARM,
            Self::Grey => &GREY,
        };
        // A NaN is at the low end.
        let inside = if place > 0.0 { place.min(1.0) } else { 0.0 };
        let place = inside * (colors.len() - 1) as f32;
        let first = (place as usize).min(colors.len() - 2);
        let part = place - first as f32;
        [0, 1, 2].map(|channel| {
            let [from, to] = [0, 1].map(|n| f32::from(colors[first + n][channel]) / 255.0);
            linear(from + part * (to - from))
        })
    }
}

/// Light, from a number of sRGB (IEC 61966-2-1).
fn linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Gives a mesh the colours of an attribute: of its value, or of its length if it has several reals. Returns
/// the least and the largest value, which have the first and the last colour if no range is given.
pub fn shade(mesh: &mut Mesh, name: &str, ramp: Ramp, range: Option<[f64; 2]>) -> Result<[f64; 2], Failure> {
    let name = &*normalized(name);
    let place = mesh.attributes.iter().position(|attribute| attribute.name == name);
    let Some(place) = place else {
        let known: Vec<&str> = mesh.attributes.iter().map(|attribute| attribute.name.as_str()).collect();
        return Err(Failure::Usage(format!(
            "the scene has no attribute {name:?} that --color-by could be about; it has {}",
            known.join(", ")
        )));
    };
    let width = mesh.attributes[place].width;
    let length = |values: &[f32]| match values {
        [value] => f64::from(*value),
        values => values.iter().map(|value| f64::from(*value).powi(2)).sum::<f64>().sqrt(),
    };
    let lengths = |values: &[f32]| values.chunks_exact(width).map(length).collect::<Vec<f64>>();
    let all = lengths(&mesh.attributes[place].values);
    let finite = || all.iter().copied().filter(|value| value.is_finite());
    let [low, high] =
        range.unwrap_or([finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)]);
    let color = |value: f64| ramp.at(if high > low { ((value - low) / (high - low)) as f32 } else { 0.5 });
    let colors = |values: Vec<f64>| values.into_iter().flat_map(color).collect::<Vec<f32>>();
    let sides = mesh.creases.attributes.get(place).map(|values| colors(lengths(values)));
    let values = colors(all);
    let found = mesh.attributes.iter().position(|attribute| attribute.name == "color");
    let target = found.unwrap_or_else(|| {
        mesh.attributes.push(Attribute { name: "color".to_owned(), width: 3, values: Vec::new() });
        if sides.is_some() {
            mesh.creases.attributes.push(Vec::new());
        }
        mesh.attributes.len() - 1
    });
    mesh.attributes[target] = Attribute { name: "color".to_owned(), width: 3, values };
    if let Some(sides) = sides {
        mesh.creases.attributes[target] = sides;
    }
    Ok([low, high])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_become_colours() {
        let heat = Attribute { name: "heat".to_owned(), width: 1, values: vec![2.0, 4.0, 3.0, f32::NAN] };
        let mut mesh = Mesh { positions: vec![[0.0; 3]; 4], attributes: vec![heat], ..Mesh::default() };
        assert_eq!(shade(&mut mesh, "heat", Ramp::Grey, None).unwrap(), [2.0, 4.0]);
        let colors = mesh.colors().unwrap();
        assert_eq!((colors[0], colors[1], colors[3]), ([0.0; 3], [1.0; 3], [0.0; 3]));
        assert!((colors[2][0] - 0.2140).abs() < 1e-3, "half of sRGB");
        shade(&mut mesh, "heat", Ramp::Coolwarm, Some([0.0, 6.0])).unwrap();
        assert_eq!(mesh.attributes.len(), 2);
        let [r, g, b] = mesh.colors().unwrap()[2];
        assert!(r == g && g == b, "the middle is grey");
        assert!(shade(&mut mesh, "cold", Ramp::Grey, None).is_err());
    }
}
