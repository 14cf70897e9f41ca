//! What stands where: the tree with affine and attribute nodes dissolved into positions and bindings.
//!
//! An *occurrence* is a node at a position with attribute bindings. A node that is reached twice with the same of each is one
//! occurrence with two uses; under other coordinates it is another one.

use rustc_hash::FxHashMap as HashMap;

use glam::DAffine3;

use crate::check::{CheckedTree, NodeId};
use crate::combine::Combinator;
use crate::tree::{NodeKind, Primitive};
use crate::warp::Warp;

/// The name of an occurrence.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(super) struct OccurrenceId(pub(super) u32);

/// The name of a field of a leaf: a leaf at a position, whatever its attributes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(super) struct FieldId(pub(super) u32);

/// The name of a position: an affine map in a space.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct PositionId(u32);

/// The name of a set of attribute bindings.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct BindingsId(u32);

/// A space in which points are asked: the world, or the inside of a warp.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(super) struct SpaceId(pub(super) u32);

/// The map from an occurrence's own space to `space`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Position {
    pub(super) space: SpaceId,
    pub(super) map: DAffine3,
}

/// A leaf at a position.
#[derive(Clone, Debug)]
pub(super) struct LeafField {
    pub(super) node: NodeId,
    pub(super) position: PositionId,
    /// How many occurrences, with different attributes, have this field.
    pub(super) uses: u32,
}

/// An operator whose operands are alike: any number of them, in any order but for ties.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Reducer {
    Sum,
    Ricci(f64),
    Union,
    Intersection,
}

#[derive(Clone, Debug)]
pub(super) enum OccurrenceKind {
    Leaf { field: FieldId, bindings: BindingsId },
    Warp { position: PositionId, inside: SpaceId, child: OccurrenceId },
    Reduce { reducer: Reducer, children: Vec<OccurrenceId> },
    Difference { left: OccurrenceId, right: OccurrenceId },
}

#[derive(Clone, Debug)]
pub(super) struct Occurrence {
    pub(super) node: NodeId,
    pub(super) kind: OccurrenceKind,
    /// The space in which it is asked.
    pub(super) space: SpaceId,
    /// How many places ask for it.
    pub(super) uses: u32,
    /// Whether its field can never be negative.
    pub(super) non_negative: bool,
}

/// All occurrences of a tree, children before parents.
pub(super) struct Scene<'a> {
    pub(super) tree: &'a CheckedTree,
    pub(super) occurrences: Vec<Occurrence>,
    pub(super) fields: Vec<LeafField>,
    pub(super) root: OccurrenceId,
    positions: Vec<Position>,
    bindings: Vec<Vec<Option<NodeId>>>,
    pub(super) spaces: u32,
}

/// A node and what its ancestors say about it.
type Key = (NodeId, PositionId, BindingsId);

impl<'a> Scene<'a> {
    /// Finds every occurrence, without recursion.
    pub(super) fn new(tree: &'a CheckedTree) -> Self {
        Finder::new(tree).run()
    }

    pub(super) fn occurrence(&self, id: OccurrenceId) -> &Occurrence {
        &self.occurrences[id.0 as usize]
    }

    pub(super) fn field(&self, id: FieldId) -> &LeafField {
        &self.fields[id.0 as usize]
    }

    pub(super) fn position(&self, id: PositionId) -> &Position {
        &self.positions[id.0 as usize]
    }

    /// The node that binds each attribute group, `None` for the default.
    pub(super) fn bindings(&self, id: BindingsId) -> &[Option<NodeId>] {
        &self.bindings[id.0 as usize]
    }

    pub(super) fn primitive(&self, field: FieldId) -> &'a Primitive {
        match &self.tree.node(self.field(field).node).kind {
            NodeKind::Primitive(primitive) => primitive,
            NodeKind::Combine(_) | NodeKind::Affine(_) | NodeKind::Warp(_) | NodeKind::Attribute { .. } => {
                unreachable!("leaf fields are made of primitives")
            }
        }
    }

    pub(super) fn warp(&self, occurrence: &Occurrence) -> &'a Warp {
        match &self.tree.node(occurrence.node).kind {
            NodeKind::Warp(warp) => warp,
            NodeKind::Combine(_)
            | NodeKind::Affine(_)
            | NodeKind::Primitive(_)
            | NodeKind::Attribute { .. } => {
                unreachable!("warp occurrences are made of warps")
            }
        }
    }
}

/// A node on its way to becoming an occurrence.
struct Frame {
    key: Key,
    /// Children that are done.
    children: Vec<OccurrenceId>,
    /// The inside of a warp.
    inside: Option<(SpaceId, PositionId)>,
}

struct Finder<'a> {
    scene: Scene<'a>,
    /// Numbers of the file are keys here: a hash that nobody can prepare for.
    position_names: std::collections::HashMap<(SpaceId, [u64; 12]), PositionId>,
    bindings_names: HashMap<Vec<Option<NodeId>>, BindingsId>,
    field_names: HashMap<(NodeId, PositionId), FieldId>,
    known: HashMap<Key, OccurrenceId>,
    stack: Vec<Frame>,
}

impl<'a> Finder<'a> {
    fn new(tree: &'a CheckedTree) -> Self {
        let scene = Scene {
            tree,
            occurrences: Vec::new(),
            fields: Vec::new(),
            root: OccurrenceId(0),
            positions: Vec::new(),
            bindings: Vec::new(),
            spaces: 1,
        };
        Self {
            scene,
            position_names: std::collections::HashMap::new(),
            bindings_names: HashMap::default(),
            field_names: HashMap::default(),
            known: HashMap::default(),
            stack: Vec::new(),
        }
    }

    fn run(mut self) -> Scene<'a> {
        let world = self.name_position(Position { space: SpaceId(0), map: DAffine3::IDENTITY });
        let unbound = self.name_bindings(vec![None; self.scene.tree.attributes().len()]);
        let root = self.resolve((self.scene.tree.root(), world, unbound));
        let mut done = self.enter(root);
        while let Some(frame) = self.stack.last_mut() {
            if let Some(id) = done.take() {
                frame.children.push(id);
            }
            let (node, position, bindings) = frame.key;
            match self.scene.tree.node(node).children.get(frame.children.len()) {
                Some(&child) => {
                    let position = frame.inside.map_or(position, |(_, inside)| inside);
                    let key = self.resolve((child, position, bindings));
                    done = self.enter(key);
                }
                None => {
                    let frame = self.stack.pop().expect("the loop looked at it");
                    let id = self.close(&frame);
                    self.known.insert(frame.key, id);
                    done = Some(id);
                }
            }
        }
        self.scene.root = done.expect("the last frame was the root");
        self.scene.occurrences[self.scene.root.0 as usize].uses += 1;
        self.scene
    }

    /// Walks through affine, attribute and pass-through nodes to the node that does something.
    fn resolve(&mut self, (mut node, position, bindings): Key) -> Key {
        let Position { space, mut map } = *self.scene.position(position);
        let mut bound: Option<Vec<Option<NodeId>>> = None;
        let mut moved = false;
        loop {
            let data = self.scene.tree.node(node);
            match &data.kind {
                NodeKind::Affine(inner) => {
                    map *= *inner;
                    moved = true;
                }
                NodeKind::Attribute { name, .. } => {
                    let groups = self.scene.tree.attributes();
                    let group = groups.iter().position(|group| group.name == *name);
                    let bound = bound.get_or_insert_with(|| self.scene.bindings(bindings).to_vec());
                    bound[group.expect("the check knows every group")] = Some(node);
                }
                NodeKind::Combine(Combinator::Union | Combinator::Intersection | Combinator::Difference)
                    if data.children.len() == 1 => {}
                NodeKind::Combine(_) | NodeKind::Primitive(_) | NodeKind::Warp(_) => {
                    let position = if moved { self.name_position(Position { space, map }) } else { position };
                    let bindings = bound.map_or(bindings, |bound| self.name_bindings(bound));
                    return (node, position, bindings);
                }
            }
            node = data.children[0];
        }
    }

    /// The occurrence, if it is known; otherwise it goes on the stack.
    fn enter(&mut self, key: Key) -> Option<OccurrenceId> {
        if let Some(&known) = self.known.get(&key) {
            return Some(known);
        }
        let inside = matches!(self.scene.tree.node(key.0).kind, NodeKind::Warp(_)).then(|| {
            let space = SpaceId(self.scene.spaces);
            self.scene.spaces += 1;
            (space, self.name_position(Position { space, map: DAffine3::IDENTITY }))
        });
        self.stack.push(Frame { key, children: Vec::new(), inside });
        None
    }

    /// Makes an occurrence of a node whose children are done.
    fn close(&mut self, frame: &Frame) -> OccurrenceId {
        let (node, position, bindings) = frame.key;
        let kind = match &self.scene.tree.node(node).kind {
            NodeKind::Primitive(_) => {
                let next = FieldId(self.scene.fields.len() as u32);
                let field = *self.field_names.entry((node, position)).or_insert(next);
                if field == next {
                    self.scene.fields.push(LeafField { node, position, uses: 0 });
                }
                self.scene.fields[field.0 as usize].uses += 1;
                OccurrenceKind::Leaf { field, bindings }
            }
            NodeKind::Warp(_) => {
                let (inside, _) = frame.inside.expect("a warp's frame has its inside");
                OccurrenceKind::Warp { position, inside, child: frame.children[0] }
            }
            NodeKind::Combine(combinator) => {
                let reduce = |reducer| OccurrenceKind::Reduce { reducer, children: frame.children.clone() };
                match combinator {
                    Combinator::Sum => reduce(Reducer::Sum),
                    Combinator::Ricci(n) if *n == 1.0 => reduce(Reducer::Sum),
                    Combinator::Ricci(n) => reduce(Reducer::Ricci(*n)),
                    Combinator::Union => reduce(Reducer::Union),
                    Combinator::Intersection => reduce(Reducer::Intersection),
                    Combinator::Difference => self.difference(node, position, &frame.children),
                }
            }
            NodeKind::Affine(_) | NodeKind::Attribute { .. } => unreachable!("resolve walks through these"),
        };
        self.push(node, position, kind)
    }

    /// The first child without the union of the others.
    fn difference(
        &mut self,
        node: NodeId,
        position: PositionId,
        children: &[OccurrenceId],
    ) -> OccurrenceKind {
        let right = match children[1..] {
            [only] => only,
            _ => {
                let children = children[1..].to_vec();
                self.push(node, position, OccurrenceKind::Reduce { reducer: Reducer::Union, children })
            }
        };
        OccurrenceKind::Difference { left: children[0], right }
    }

    fn push(&mut self, node: NodeId, position: PositionId, kind: OccurrenceKind) -> OccurrenceId {
        let space = self.scene.position(position).space;
        let non_negative = self.non_negative(&kind);
        for child in children(&kind) {
            self.scene.occurrences[child.0 as usize].uses += 1;
        }
        self.scene.occurrences.push(Occurrence { node, kind, space, uses: 0, non_negative });
        OccurrenceId(self.scene.occurrences.len() as u32 - 1)
    }

    fn non_negative(&self, kind: &OccurrenceKind) -> bool {
        let of = |id: &OccurrenceId| self.scene.occurrence(*id).non_negative;
        match kind {
            OccurrenceKind::Leaf { field, .. } => self.scene.primitive(*field).strength >= 0.0,
            OccurrenceKind::Warp { child, .. } => of(child),
            OccurrenceKind::Difference { left, .. } => of(left),
            OccurrenceKind::Reduce { reducer, children } => match reducer {
                Reducer::Sum | Reducer::Intersection => children.iter().all(of),
                Reducer::Ricci(_) => true,
                Reducer::Union => children.iter().any(of),
            },
        }
    }

    fn name_position(&mut self, position: Position) -> PositionId {
        // Adding 0 makes -0 and +0 one name.
        let bits = position.map.to_cols_array().map(|number| (number + 0.0).to_bits());
        let next = PositionId(self.scene.positions.len() as u32);
        let id = *self.position_names.entry((position.space, bits)).or_insert(next);
        if id == next {
            self.scene.positions.push(position);
        }
        id
    }

    fn name_bindings(&mut self, bindings: Vec<Option<NodeId>>) -> BindingsId {
        let next = BindingsId(self.scene.bindings.len() as u32);
        let id = *self.bindings_names.entry(bindings.clone()).or_insert(next);
        if id == next {
            self.scene.bindings.push(bindings);
        }
        id
    }
}

/// The occurrences that one asks for.
pub(super) fn children(kind: &OccurrenceKind) -> Vec<OccurrenceId> {
    match kind {
        OccurrenceKind::Leaf { .. } => Vec::new(),
        OccurrenceKind::Warp { child, .. } => vec![*child],
        OccurrenceKind::Reduce { children, .. } => children.clone(),
        OccurrenceKind::Difference { left, right } => vec![*left, *right],
    }
}
