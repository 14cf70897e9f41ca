//! What the rays of a picture see.

use super::cast::CastHit;
use super::color::Rgb;
use super::develop::Gathered;
use super::frame::Frame;
use super::gather::{Light, Spot, spot};
use super::material::SurfaceMaterial;
use super::settings::RenderMode;
use super::shade::{fade, shadow, surface};
use super::vector::{Vector, dot};

/// What a ray sees.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum SeenKind {
    Nothing,
    Surface,
    Ground,
}

/// What a pixel, or a ray of it, sees. Numbers relative to the model's origin, in f32: they decide about
/// likeness and light, not about places.
#[derive(Clone, Copy)]
pub struct SeenPoint {
    pub kind: SeenKind,
    pub position: [f32; 3],
    pub normal: [f32; 3],
    /// The side of a pixel there.
    footprint: f32,
    paint: Rgb,
    material: SurfaceMaterial,
}

fn single(vector: Vector) -> [f32; 3] {
    vector.map(|x| x as f32)
}

fn product(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl SeenPoint {
    pub const NOTHING: Self = Self {
        kind: SeenKind::Nothing,
        position: [0.0; 3],
        normal: [0.0; 3],
        footprint: 0.0,
        paint: [0.0; 3],
        material: SurfaceMaterial { rough: 0.0, metal: 0.0, glow: 0.0 },
    };

    pub fn surface(frame: &Frame<'_>, met: &CastHit) -> Self {
        Self {
            kind: SeenKind::Surface,
            position: single(met.position),
            normal: single(met.normal),
            footprint: frame.footprint(met.position) as f32,
            paint: met.paint,
            material: met.material,
        }
    }

    /// What a ray sees that meets no surface.
    pub fn behind(frame: &Frame<'_>, place: [f64; 2]) -> Self {
        let ground = frame.on_ground(place[0], place[1]).filter(|&position| fade(frame, position) > 0.0);
        ground.map_or(Self::NOTHING, |position| Self {
            kind: SeenKind::Ground,
            position: single(position),
            normal: single(frame.up),
            footprint: frame.footprint(position) as f32,
            ..Self::NOTHING
        })
    }

    /// How much light here may be taken for light there, from 0 to 1; `apart` is the distance in pixels.
    pub fn likeness(&self, other: &Self, apart: f32) -> f32 {
        if self.kind != other.kind || self.kind == SeenKind::Nothing {
            return 0.0;
        }
        let way = [0, 1, 2].map(|axis| other.position[axis] - self.position[axis]);
        let off = product(way, self.normal).abs() / (1.5 * apart * self.footprint);
        let alike = product(self.normal, other.normal).max(0.0);
        let alike = alike * alike;
        (1.0 - off).max(0.0) * alike * alike
    }

    /// Whether the surface breaks off between this pixel and the next one.
    pub fn breaks(&self, other: &Self) -> bool {
        match (self.kind, other.kind) {
            (SeenKind::Surface, SeenKind::Surface) => self.likeness(other, 2.0) <= 0.0,
            (SeenKind::Surface, SeenKind::Nothing | SeenKind::Ground)
            | (SeenKind::Nothing | SeenKind::Ground, SeenKind::Surface) => true,
            (SeenKind::Nothing | SeenKind::Ground, SeenKind::Nothing | SeenKind::Ground) => false,
        }
    }

    /// Whether a pixel needs more rays because of a neighbour.
    pub fn differs(&self, other: &Self) -> bool {
        if self.kind != other.kind {
            return true;
        }
        match self.kind {
            SeenKind::Nothing | SeenKind::Ground => false,
            SeenKind::Surface => {
                let paint = |channel: usize| (self.paint[channel] - other.paint[channel]).abs() > 0.06;
                self.likeness(other, 1.0) < 0.5 || (0..3).any(paint)
            }
        }
    }

    fn vectors(&self) -> [Vector; 2] {
        [self.position, self.normal].map(|vector| vector.map(f64::from))
    }

    pub fn spot(&self, frame: &Frame<'_>, pixel: [u32; 2]) -> Spot {
        let [position, normal] = self.vectors();
        spot(frame, position, normal, pixel, 0)
    }

    fn hit(&self) -> CastHit {
        let [position, normal] = self.vectors();
        CastHit { cast: 0, position, normal, paint: self.paint, material: self.material }
    }

    /// The cosine between its normal and the key light, or 0.
    pub fn facing(&self, frame: &Frame<'_>) -> f32 {
        dot(self.normal.map(f64::from), frame.lights.key).max(0.0) as f32
    }

    /// The value of a ray that sees this in this light, which is asked where it matters.
    pub fn value(&self, frame: &Frame<'_>, light: impl FnOnce() -> Light) -> Gathered {
        let open = |[a, b, c]: Rgb| [a, b, c, 1.0];
        match self.kind {
            SeenKind::Nothing => [0.0; 4],
            SeenKind::Ground => shadow(frame, &self.spot(frame, [0, 0]), &light()),
            SeenKind::Surface => match &frame.render.mode {
                RenderMode::Shaded => {
                    let hit = self.hit();
                    open(surface(frame, &hit, light(), frame.looking(hit.position)))
                }
                RenderMode::Normal => open(self.normal.map(|x| 0.5 + 0.5 * x)),
                RenderMode::Depth => {
                    open([frame.camera.depth(self.position.map(f64::from)) as f32, 0.0, 0.0])
                }
                RenderMode::Attribute(_) | RenderMode::Evaluations => open(self.paint),
            },
        }
    }
}
