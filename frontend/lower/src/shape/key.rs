//! What tells shapes apart, and what their code consists of.

use std::sync::Arc;

use crate::computed::ComputedShape;
use crate::instance::{FieldId, InstanceId, LeafCode, SpaceId};
use crate::position::MapKind;
use jbt_model::combine::{MapCode, ReduceCode};
use jbt_model::expression::Form;
use jbt_model::warp::WarpCode;

/// The name of a shape.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(crate) struct ShapeId(pub(super) u32);

/// What tells shapes apart.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub(super) enum ShapeKey {
    Leaf(LeafCode, Box<[Option<ComputedShape>]>),
    /// A hoisted field with attributes of its own.
    LeafOf(FieldId, Box<[Option<ComputedShape>]>),
    Warp {
        map: MapKind,
        warp: WarpCode,
        child: ShapeId,
        weight: Option<ShapeId>,
        pinned: Option<SpaceId>,
    },
    Reduce {
        code: ReduceCode,
        non_negative: bool,
        groups: Vec<(ShapeId, usize)>,
    },
    Difference {
        left: ShapeId,
        right: ShapeId,
    },
    Map {
        code: MapCode,
        child: ShapeId,
    },
    /// A use of a space that several lead into.
    Inside {
        space: SpaceId,
        child: ShapeId,
    },
    Expression {
        map: Option<MapKind>,
        form: Arc<Form>,
        vanishes: bool,
        non_negative: bool,
        children: Vec<ShapeId>,
        computed: Box<[Option<ComputedShape>]>,
    },
    Select(Vec<ShapeId>),
    Hoisted(InstanceId),
}

/// How many folds there may be around a guard. Behind so many, what is left of a deep model is mostly left
/// out with what is around it.
///
/// Folds over several rows that own rows double the instances each, so there are at most 22 of these in
/// each other, by [`jbt_ir::limits::MAX_INSTANCES`]; with this many guards they stay below
/// [`jbt_ir::limits::MAX_FOLD_DEPTH`].
const MAX_DEPTH_OF_GUARDS: usize = 24;

/// What the code of a shape consists of. The pieces of a leaf are a table, but a leaf is a row all the same:
/// so any number of them is the same code.
#[derive(Clone, Copy, Debug)]
pub(super) struct Content {
    /// Whether a use of it has to be written out: it holds tables, or is a hoisted value.
    pub(super) written_out: bool,
    /// Whether tables hang under it. Hoisted values count where they are computed.
    pub(super) tables: bool,
    /// Leaves that are computed where it stands, those in tables left out.
    pub(super) leaves: usize,
    /// Whether it holds a formula of the point, of which no support is known.
    pub(super) formulas: bool,
}

impl Content {
    pub(super) const LEAF: Self = Self { written_out: false, tables: false, leaves: 1, formulas: false };
    pub(super) const HOISTED: Self = Self { written_out: true, tables: false, leaves: 0, formulas: false };
    /// Rows of a table.
    pub(super) const ROWS: Self = Self { written_out: true, tables: true, leaves: 0, formulas: false };

    /// Both, one after the other.
    pub(super) const fn and(self, other: Self) -> Self {
        Self {
            written_out: self.written_out || other.written_out,
            tables: self.tables || other.tables,
            leaves: self.leaves.saturating_add(other.leaves),
            formulas: self.formulas || other.formulas,
        }
    }

    /// Whether it is worth a guard inside of so many folds.
    pub(super) const fn wants_guard(self, depth: usize) -> bool {
        (self.tables || self.leaves > 1) && depth < MAX_DEPTH_OF_GUARDS
    }
}
