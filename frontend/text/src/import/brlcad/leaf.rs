//! Solids as leaves of a tree, each exactly the set of points that its numbers mean.
//!
//! ```text
//! field = max(0, 1/2 - d / 2s)       d <= 0 inside; s is about half the thickness of the solid
//! ```
//!
//! So the field of a solid is 1/2 on its surface, about 1 in its middle, and 0 at the distance s from it.
//! Where a skeleton with the falloff `linear` is the solid, it is that skeleton; else the solid is a formula
//! in a frame of its own, in which its parameters are 1, under the affine map of the frame. Solids of one
//! kind have one formula, so they are rows of one table.

mod block;
mod cone;
mod make;
mod metaball;
mod parts;
mod pipe;
mod quadric;
mod round;

use glam::DVec3;

use self::make::LARGEST;
pub(super) use self::make::{Flaw, LeafStyle, SolidLeaf};
use super::solid::{DatabaseSolid, SolidKind};

/// The leaf of a solid; `reach` is about the size of the model, which gives half spaces a thickness.
pub(super) fn leaf(solid: &DatabaseSolid, reach: f64, style: LeafStyle) -> Result<SolidLeaf, Flaw> {
    let n = &solid.numbers[..];
    if let Some(large) = n.iter().find(|number| number.abs() > LARGEST) {
        return Err(format!("one of its numbers is {large}"));
    }
    let v = |at: usize| DVec3::new(n[3 * at], n[3 * at + 1], n[3 * at + 2]);
    match solid.kind {
        SolidKind::Ellipsoid => round::ellipsoid(v(0), [v(1), v(2), v(3)], style),
        SolidKind::Superellipsoid => round::superellipsoid(v(0), [v(1), v(2), v(3)], [n[12], n[13]]),
        SolidKind::Torus => round::torus(v(0), v(1), [n[6], n[7]], style),
        SolidKind::EllipticalTorus => round::elliptical_torus(v(0), v(1), v(2), [n[9], n[10]], style),
        SolidKind::Particle => round::particle(v(0), v(1), n[6], n[7]),
        SolidKind::Cone => cone::cone(v(0), v(1), [[v(2), v(3)], [v(4), v(5)]], style),
        SolidKind::Block => block::block(&[0, 1, 2, 3, 4, 5, 6, 7].map(v), style),
        SolidKind::Half => block::half(v(0), n[3], reach),
        SolidKind::Planes => block::planes(n.as_chunks().0, reach),
        SolidKind::ParabolicCylinder => quadric::parabolic_cylinder(v(0), v(1), v(2), n[9]),
        SolidKind::HyperbolicCylinder => quadric::hyperbolic_cylinder(v(0), v(1), v(2), n[9], n[10]),
        SolidKind::Paraboloid => quadric::paraboloid(v(0), v(1), v(2), [n[9], n[10]]),
        SolidKind::Hyperboloid => quadric::hyperboloid(v(0), v(1), v(2), [n[9], n[10], n[11]], style),
        SolidKind::Waist => quadric::waist(v(0), v(1), v(2), n[9], n[10]),
        SolidKind::Pipe => pipe::pipe(n.as_chunks().0, style),
        SolidKind::Metaball => metaball::metaball(n[0], n[1], n[2..].as_chunks().0),
    }
}
