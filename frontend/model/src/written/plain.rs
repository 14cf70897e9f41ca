//! How nodes with plain values are written.

use glam::{DAffine3, DVec3};

use super::{Radius, Written, WrittenParticles, as_written};
use crate::combine::Combinator;
use crate::kind::{NodeKind, Primitive};
use crate::map::{Affine, MapKind, Scale, ScaleAxes, Translate};
use crate::member::Member;
use crate::warp::Warp;

impl From<NodeKind> for Written {
    fn from(kind: NodeKind) -> Self {
        match kind {
            NodeKind::Primitive(leaf) => leaf.into(),
            NodeKind::Particles(particles) => WrittenParticles::from(particles).into(),
            NodeKind::Combine(combinator) => combinator.into(),
            NodeKind::Expression(expression) => Self::Expression((&expression).into()),
            NodeKind::Select(which) => Self::Select(which.into()),
            NodeKind::Affine(map) => map.into(),
            NodeKind::Warp(warp) => warp.into(),
            NodeKind::Attribute { name, value, precedence } => {
                Self::Attribute { name, value: (&value).into(), precedence }
            }
            NodeKind::Constant { name, value, precedence } => Self::Constant { name, value, precedence },
        }
    }
}

impl From<Primitive> for Written {
    fn from(leaf: Primitive) -> Self {
        Self::Primitive {
            skeleton: leaf.skeleton.kind(),
            fields: as_written(leaf.skeleton.to_fields()),
            falloff: leaf.falloff.into(),
            radius: Radius::Support(leaf.radius.into()),
            strength: leaf.strength.into(),
        }
    }
}

impl From<Combinator> for Written {
    fn from(combinator: Combinator) -> Self {
        Self::Combine { combinator: combinator.kind(), fields: as_written(combinator.to_fields()) }
    }
}

impl From<Warp> for Written {
    fn from(warp: Warp) -> Self {
        if let Warp::Formula(formulas) = &warp {
            return Self::FormulaWarp(formulas.into());
        }
        let kind = warp.kind().expect("all warps but formulas are members");
        Self::Warp { warp: kind, fields: as_written(warp.to_fields()) }
    }
}

impl From<DAffine3> for Written {
    /// The simplest map that has the same bits.
    fn from(map: DAffine3) -> Self {
        let bits = |map: &DAffine3| map.to_cols_array().map(f64::to_bits);
        let diagonal = DVec3::new(map.matrix3.x_axis.x, map.matrix3.y_axis.y, map.matrix3.z_axis.z);
        let (map, fields) = if bits(&map) == bits(&DAffine3::from_translation(map.translation)) {
            (MapKind::Translate, Translate { by: map.translation }.to_fields())
        } else if bits(&map) != bits(&DAffine3::from_scale(diagonal)) {
            let [x, y, z, shift] = map.to_cols_array_2d();
            let rows = [0, 1, 2].map(|row| [x[row], y[row], z[row], shift[row]]);
            (MapKind::Affine, Affine { rows }.to_fields())
        } else if diagonal.to_array().iter().all(|factor| factor.to_bits() == diagonal.x.to_bits()) {
            (MapKind::Scale, Scale { by: diagonal.x }.to_fields())
        } else {
            (MapKind::ScaleAxes, ScaleAxes { by: diagonal }.to_fields())
        };
        Self::Map { map, fields: as_written(fields) }
    }
}
