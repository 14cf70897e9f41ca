//! Textures in Rust: what [`Tree::textured`](crate::tree::Tree::textured) takes.

use super::{Number, Vector, real, vector};
use crate::field::FieldValue;
use crate::recipe::FieldNumber;
use crate::texture::TextureKind;

/// A texture whose numbers may follow parameters.
#[derive(Clone, PartialEq, Debug)]
pub struct Pattern {
    pub(super) texture: TextureKind,
    pub(super) fields: Vec<FieldNumber>,
}

impl Pattern {
    fn new(texture: TextureKind, fields: Vec<FieldNumber>) -> Self {
        Self { texture, fields }
    }

    /// The same with another value for a named parameter of the texture; nothing happens if it has none of this name.
    fn with(mut self, name: &str, value: FieldNumber) -> Self {
        let place = self.texture.fields().iter().position(|field| field.name == name);
        if let Some(place) = place {
            self.fields[place] = value;
        }
        self
    }

    /// With other random numbers: noise, rings and marble have a seed, the nearest whole number. Others stay as they are.
    #[must_use]
    pub fn seed(self, seed: impl Into<Number>) -> Self {
        self.with("seed", real(seed))
    }

    /// With so many octaves, 1 to 8: noise has them. Others stay as they are.
    #[must_use]
    pub fn octaves(self, octaves: impl Into<Number>) -> Self {
        self.with("octaves", real(octaves))
    }

    /// Shaken by noise of this size, by so many widths: rings and marble are. Others stay as they are.
    #[must_use]
    pub fn turbulence(self, turbulence: impl Into<Number>, size: impl Into<Number>) -> Self {
        let shaken = self.texture.fields().iter().any(|field| field.name == "turbulence");
        if shaken { self.with("turbulence", real(turbulence)).with("size", real(size)) } else { self }
    }
}

/// The parameters of a kind that are not given here: their defaults.
fn rest(texture: TextureKind, given: Vec<FieldNumber>) -> Pattern {
    let skipped = texture.fields().iter().skip(given.len());
    let defaults = skipped.map(|field| field.default.clone().unwrap_or(FieldValue::Real(0.0)).into());
    let fields = given.into_iter().chain(defaults).collect();
    Pattern::new(texture, fields)
}

/// Cubes of two kinds in turn, with this side.
#[must_use]
pub fn checker(size: impl Into<Number>) -> Pattern {
    rest(TextureKind::Checker(0), vec![real(size)])
}

/// Layers of two kinds in turn along a direction, this wide.
#[must_use]
pub fn stripes(along: impl Into<Vector>, width: impl Into<Number>) -> Pattern {
    rest(TextureKind::Stripes(0), vec![vector(along), real(width)])
}

/// A ramp from one place, where it is 0, to another.
#[must_use]
pub fn gradient(from: impl Into<Vector>, to: impl Into<Vector>) -> Pattern {
    rest(TextureKind::Gradient(0), vec![vector(from), vector(to)])
}

/// Smooth noise, of one octave with this size: see [`Pattern::octaves`].
#[must_use]
pub fn noise(size: impl Into<Number>) -> Pattern {
    rest(TextureKind::Noise(0), vec![real(size)])
}

/// Rings around an axis through the origin, one for each width, a little shaken: see [`Pattern::turbulence`].
#[must_use]
pub fn rings(along: impl Into<Vector>, width: impl Into<Number>) -> Pattern {
    rest(TextureKind::Rings(0), vec![vector(along), real(width)])
}

/// Veins along a direction, one for each width, shaken: see [`Pattern::turbulence`].
#[must_use]
pub fn marble(along: impl Into<Vector>, width: impl Into<Number>) -> Pattern {
    rest(TextureKind::Marble(0), vec![vector(along), real(width)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Texture;

    fn made(pattern: &Pattern) -> Texture {
        let values: Vec<_> = pattern.fields.iter().map(FieldNumber::value).collect();
        pattern.texture.from_fields(&values)
    }

    #[test]
    fn every_pattern_is_its_texture() {
        let x = [1.0, 0.0, 0.0];
        let all =
            [checker(1.0), stripes(x, 1.0), gradient([0.0; 3], x), noise(1.0), rings(x, 1.0), marble(x, 1.0)];
        for (pattern, kind) in all.iter().zip(TextureKind::ALL) {
            assert_eq!(pattern.texture, *kind);
            assert_eq!(made(pattern).to_fields().len(), kind.fields().len());
        }
        let Texture::Noise(noise) = made(&noise(2.0).octaves(3.0).seed(5.0)) else { panic!("it is noise") };
        assert_eq!((noise.size, noise.octaves, noise.seed), (2.0, 3.0, 5.0));
        let Texture::Marble(marble) = made(&marble(x, 2.0).turbulence(0.5, 4.0)) else {
            panic!("it is marble")
        };
        assert_eq!((marble.veins.width, marble.veins.turbulence, marble.veins.size), (2.0, 0.5, 4.0));
        assert_eq!(made(&checker(1.0).turbulence(0.5, 4.0).octaves(2.0)), made(&checker(1.0)));
    }
}
