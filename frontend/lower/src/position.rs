//! Where an instance stands: the space in which its points are asked, and the affine map from its own space
//! to that space. Rows hold the inverse, which takes an asked point to the instance.
//!
//! Affine runs collapse into one matrix. What a row has to do to the point depends on the matrix:
//!
//! | map | numbers | work |
//! |---|---|---|
//! | identity | 0 | none |
//! | translation | 3 | 3 subtractions |
//! | scaling | 4 | 3 fused steps |
//! | full | 12 | 9 fused steps |

//!
//! A map that depends on parameters has the kind that serves all their values, and is told from others by how
//! it was made: two that are equal for the present values are not one position, because they will not be
//! equal for the next ones.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3};
use jbt_ir::Domain;

use super::names::SpaceId;
use jbt_model::affine::Similarity;
use jbt_model::check::NodeId;
use jbt_model::origin::ModelOrigin;
use jbt_model::skeleton::{Skeleton, Symmetry};
use jbt_model::written::{Freedom, MapKey, Written};

/// The map from an instance's own space to `space`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Position {
    pub(super) space: SpaceId,
    pub(super) map: DAffine3,
    pub(super) trail: Trail,
}

/// What is known of a map whatever the parameters.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Trail {
    /// How the map was made, up to the last factor that depends on parameters; 0 if none does.
    pub(super) name: u32,
    /// The product of the factors after it.
    pub(super) since: DAffine3,
    /// How much the factors that depend on parameters can change the linear part.
    freedom: Freedom,
    /// Whether another factor is no similarity.
    skewed: bool,
}

impl Trail {
    /// That of the identity.
    pub(super) const START: Self =
        Self { name: 0, since: DAffine3::IDENTITY, freedom: Freedom::Fixed, skewed: false };

    /// With one more factor that does not change.
    pub(super) fn fixed(self, inner: &DAffine3, can_turn: bool) -> Self {
        // Asked only where the answer can matter.
        let skewed = self.skewed || (can_turn && Similarity::from_affine(inner).is_none());
        Self { since: self.since * *inner, skewed, ..self }
    }

    /// With one more factor that can change, which gives the way here this name.
    pub(super) fn free(self, name: u32, freedom: Freedom) -> Self {
        Self { name, since: DAffine3::IDENTITY, freedom: self.freedom.max(freedom), ..self }
    }

    fn freedom(&self) -> Freedom {
        // A rotation between two maps that are no similarities can make one of them, for some values.
        if self.freedom == Freedom::Turn && self.skewed { Freedom::Full } else { self.freedom }
    }
}

/// How a position was made: equal for two that are one whatever the parameters.
pub(super) type PositionKey = (SpaceId, u32, [u64; 12]);

/// The key of a position: its space, and the name and the last factors of its trail.
pub(super) fn position_key(space: SpaceId, trail: u32, since: &DAffine3) -> PositionKey {
    // Adding 0 makes -0 and +0 one name.
    (space, trail, since.to_cols_array().map(|number| (number + 0.0).to_bits()))
}

/// The names of trails: those that end with the same map after the same way have the same name.
#[derive(Default)]
pub(super) struct Trails {
    /// A map that is written twice is one.
    maps: HashMap<MapKey, u32>,
    map_of_node: HashMap<NodeId, u32>,
    names: HashMap<(PositionKey, u32), u32>,
}

impl Trails {
    /// The name of the trail that a map which depends on parameters ends.
    pub(super) fn name(&mut self, before: PositionKey, node: NodeId, written: &Written) -> u32 {
        let maps = &mut self.maps;
        let map = *self.map_of_node.entry(node).or_insert_with(|| {
            let next = maps.len() as u32;
            *maps.entry(written.map_key()).or_insert(next)
        });
        let next = self.names.len() as u32 + 1;
        *self.names.entry((before, map)).or_insert(next)
    }
}

impl Position {
    /// Where a space begins.
    pub(super) const fn start(space: SpaceId) -> Self {
        Self { space, map: DAffine3::IDENTITY, trail: Trail::START }
    }

    /// The world, of which points are given in local coordinates.
    pub(super) fn world(origin: ModelOrigin) -> Self {
        if origin.is_world() {
            return Self::start(SpaceId(0));
        }
        let map = DAffine3::from_translation(-DVec3::from(origin.point()));
        Self { space: SpaceId(0), map, trail: Trail { since: map, ..Trail::START } }
    }

    /// What its inverse is as code.
    pub(super) fn kind(&self) -> MapKind {
        let least = match self.trail.freedom() {
            Freedom::Fixed if self.trail.name == 0 => MapKind::Identity,
            Freedom::Fixed => MapKind::Translation,
            Freedom::Scale => MapKind::Scaling,
            Freedom::Turn | Freedom::Full => MapKind::Full,
        };
        MapKind::of(&self.map).max(least)
    }

    /// The map from the frame in which a skeleton that stands here has its uv, and what its inverse is as
    /// code. `depends`: numbers of the skeleton depend on parameters.
    pub(super) fn of_uv(&self, skeleton: &Skeleton, depends: bool) -> (DAffine3, MapKind) {
        let map = self.map * skeleton.uv_frame();
        let least = if depends || self.trail.name != 0 { MapKind::Full } else { MapKind::Translation };
        (map, MapKind::of(&map).max(least))
    }

    /// The map from the pose of a skeleton that stands here, the size of the skeleton there, and what the
    /// inverse of the map is as code: at least a translation, so that a primitive that passes the origin
    /// keeps its code. `turns`: the skeleton itself can turn.
    pub(super) fn of_skeleton(&self, skeleton: &Skeleton, turns: bool) -> (DAffine3, f64, MapKind) {
        let (pose, symmetry) = (skeleton.pose(), skeleton.kind().symmetry());
        let freedom = self.trail.freedom();
        let similarity = if freedom == Freedom::Full { None } else { Similarity::from_affine(&self.map) };
        let Some(similarity) = similarity else {
            let map = self.map * pose;
            let least = if freedom == Freedom::Full { MapKind::Full } else { MapKind::Translation };
            return (map, 1.0, MapKind::of(&map).max(least));
        };
        let translation = self.map.transform_point3(pose.translation);
        // Most leaves: nothing is left to look at.
        if symmetry == Symmetry::Ball {
            let map = DAffine3::from_translation(translation);
            return (map, similarity.scale(), MapKind::Translation);
        }
        let turn = symmetry.simplest(*similarity.turn() * pose.matrix3);
        let map = DAffine3::from_mat3_translation(turn, translation);
        let least = match freedom {
            Freedom::Turn | Freedom::Full => MapKind::Full,
            Freedom::Scale | Freedom::Fixed if turns => MapKind::Full,
            // A scale that changes its sign mirrors.
            Freedom::Scale if symmetry != Symmetry::Axis => MapKind::Scaling,
            Freedom::Scale | Freedom::Fixed => MapKind::Translation,
        };
        (map, similarity.scale(), MapKind::of(&map).max(least))
    }
}

/// How much of an affine map there is: what selects code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(super) enum MapKind {
    Identity,
    Translation,
    Scaling,
    Full,
}

impl MapKind {
    /// The kind of the inverse of `map`, which is of the same kind.
    fn of(map: &DAffine3) -> Self {
        let matrix = map.matrix3.to_cols_array();
        let scale = matrix[0];
        let uniform = [scale, 0.0, 0.0, 0.0, scale, 0.0, 0.0, 0.0, scale];
        if matrix != uniform {
            Self::Full
        } else if scale != 1.0 {
            Self::Scaling
        } else if map.translation != DVec3::ZERO {
            Self::Translation
        } else {
            Self::Identity
        }
    }

    /// Names of the columns that [`push_columns`](Self::push_columns) fills.
    pub(super) const fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Identity => &[],
            Self::Translation => &["tx", "ty", "tz"],
            Self::Scaling => &["scale", "tx", "ty", "tz"],
            Self::Full => &["xx", "xy", "xz", "xt", "yx", "yy", "yz", "yt", "zx", "zy", "zz", "zt"],
        }
    }

    /// The numbers of the inverse of `map`.
    pub(super) fn push_columns(self, map: &DAffine3, row: &mut Vec<f64>) {
        match self {
            Self::Identity => {}
            Self::Translation => row.extend(map.translation.to_array()),
            Self::Scaling => {
                let inverse = self.inverse(map);
                row.push(inverse.matrix3.x_axis.x);
                row.extend(inverse.translation.to_array());
            }
            Self::Full => {
                let inverse = self.inverse(map);
                for axis in 0..3 {
                    row.extend(inverse.matrix3.row(axis).to_array());
                    row.push(inverse.translation[axis]);
                }
            }
        }
    }

    /// The inverse of `map`: its numbers are those of a row, before they are rounded.
    pub(super) fn inverse(self, map: &DAffine3) -> DAffine3 {
        match self {
            Self::Identity => DAffine3::IDENTITY,
            Self::Translation => DAffine3::from_translation(-map.translation),
            Self::Scaling => {
                let scale = 1.0 / map.matrix3.x_axis.x;
                DAffine3 {
                    matrix3: DMat3::from_diagonal(DVec3::splat(scale)),
                    translation: map.translation * -scale,
                }
            }
            Self::Full => map.inverse(),
        }
    }

    /// The point in the inner space.
    pub(super) fn emit<D: Domain>(self, d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        match self {
            Self::Identity => p,
            Self::Translation => std::array::from_fn(|axis| d.sub(p[axis], row[axis])),
            Self::Scaling => std::array::from_fn(|axis| d.fma(p[axis], row[0], row[1 + axis])),
            Self::Full => std::array::from_fn(|axis| {
                let row = &row[4 * axis..][..4];
                let x = d.fma(p[0], row[0], row[3]);
                let xy = d.fma(p[1], row[1], x);
                d.fma(p[2], row[2], xy)
            }),
        }
    }
}
