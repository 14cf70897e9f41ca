//! ParsIP scenes: numbered nodes in the syntax of an INI file.
//!
//! ```text
//! [BLOBNODE 0]                       an operator over its children
//! IsOperator=1
//! OperatorType=RICCI BLEND
//! ChildrenCount=2
//! ChildrenIDs=(1, 2)
//! power=2.000000
//! [BLOBNODE 1]                       a leaf: a skeleton under scale, rotation (a quaternion) and translation
//! IsOperator=0
//! AffineScale=(2.000000, 1.000000, 1.000000)
//! MtrlDiffused=(0.4, 0.4, 0.4, 1.0)
//! PrimitiveType=POINT
//! ...
//! [Global]
//! RootIDs=(0)
//! ```
//!
//! Every leaf has the cubic falloff of radius 1 in its own space, before its map. Its diffuse colour becomes
//! `color`. An instance is another use of a node, whose map comes below the instance's own map.
//!
//! ParsIP's own evaluators disagree in places; the reader follows the mathematics of the format: names are
//! read in any case, operators do what their names say even if their children are given as a range,
//! quaternions are normalised, line segments end at their ends. Where its scalar evaluator does something
//! else than the operator means, a warning says so. NUL bytes and CRs are dropped anywhere.

mod node;
mod scan;
mod state;
mod value;
mod warp;

use glam::DAffine3;
use jbt_ir::limits::{MAX_NODES, MAX_SCENE_BYTES};

use self::node::Reading;
use self::scan::{Key, Section};
use self::state::{Importer, Meaning, NodeState};
use super::Imported;
use super::format::{SceneFormatRow, first_line};
use jbt_model::attribute::Precedence;
use jbt_model::combine::{Combinator, Sum};
use jbt_model::diagnostic::{Diagnostic, Diagnostics, Span};
use jbt_model::kind::NodeKind;
use jbt_model::model::Model;
use jbt_model::orientation::Orientation;
use jbt_model::report::Report;
use jbt_model::term::Term;
use jbt_model::tree::Tree;

/// ParsIP scenes are sections, the first of which begins with a bracket.
pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow {
    recognizes: |bytes| first_line(bytes).starts_with(b"["),
    ..SceneFormatRow::new(&["blob", "scene"], "a ParsIP scene", |bytes, _| parsip(bytes))
};

/// The model of a ParsIP scene (`.blob`, `.scene`).
///
/// # Errors
///
/// All errors of the file, with their places: unreadable numbers and names, nodes that are missing or contain
/// themselves, zero scales, a root that is missing or not alone, operators without a counterpart here.
pub fn parsip(bytes: &[u8]) -> Result<Imported, Diagnostics> {
    Imported::from(bytes, read(bytes))
}

fn read(bytes: &[u8]) -> Result<(Model, Vec<Diagnostic>), Vec<Diagnostic>> {
    if bytes.len() > MAX_SCENE_BYTES {
        let message = format!("the file has {} bytes; at most {MAX_SCENE_BYTES} are read", bytes.len());
        return Err(vec![Diagnostic::limit(None, message)]);
    }
    let (mut errors, mut warnings) = (Report::default(), Report::default());
    let sections = scan::sections(bytes, &mut errors, &mut warnings);
    let adopted = vec![false; sections.nodes.len()];
    let mut importer = Importer { bytes, sections, errors, warnings, edges: 0, adopted };
    let root = importer.root().map(|(root, span)| importer.build(root, span));
    match root {
        Some(root) if importer.errors.is_empty() => {
            importer.count();
            // Its locomotive stands that way.
            Ok((Model { orientation: Orientation::Y_RIGHT, ..Model::new(root) }, importer.warnings.finish()))
        }
        _ => Err([importer.errors.finish(), importer.warnings.finish()].concat()),
    }
}

impl Importer<'_> {
    /// The root, and the place of its name.
    fn root(&mut self) -> Option<(u32, Span)> {
        let named = self.sections.global.as_ref().and_then(|global| global.get(Key::RootIds));
        let Some(span) = named else {
            let span = self.sections.global.as_ref().map(|global| global.span);
            self.errors.add(|| {
                Diagnostic::error(span, "the file names no root").expected("expected RootIDs=(n) in [Global]")
            });
            return None;
        };
        let roots = self.list(span, Key::RootIds, MAX_NODES)?;
        let &[root] = roots.as_slice() else {
            let count = roots.len();
            self.errors.add(|| {
                Diagnostic::error(Some(span), format!("the file has {count} roots"))
                    .expected("expected one; an operator over them makes them one object")
            });
            return None;
        };
        self.find(root, span).map(|root| (root, span))
    }

    /// The index of a node in the list; a message if no node has this number.
    fn find(&mut self, id: i64, reference: Span) -> Option<u32> {
        let found = self.sections.by_id.get(&id).copied();
        if found.is_none() {
            self.errors.add(|| Diagnostic::error(Some(reference), format!("there is no node {id}")));
        }
        found
    }

    /// The children of an operator, by list or by range.
    fn children(&mut self, section: &Section, reading: &mut Reading) {
        let key = if self.flag(section, Key::UseRange) { Key::Range } else { Key::ChildrenIds };
        let Some(span) = self.need(section, key) else {
            return;
        };
        reading.reference = span;
        let room = MAX_NODES.saturating_sub(self.edges);
        let Some(mut ids) = self.list(span, key, room) else {
            return;
        };
        if key == Key::Range {
            // A range longer than the number of nodes names at least one missing node.
            let nodes = self.sections.nodes.len() as i64;
            match *ids.as_slice() {
                [first, last] if first <= last && last.saturating_sub(first) < nodes => {
                    ids = (first..=last).collect();
                }
                _ => {
                    let shown = self.shown(span);
                    return self.bad(span, key, &shown, "(first, last), of nodes of the file");
                }
            }
        }
        let id = section.id;
        if ids.is_empty() {
            self.errors.add(|| Diagnostic::error(Some(span), format!("the operator {id} has no children")));
        }
        if ids.len() > room {
            self.errors.add(|| Diagnostic::limit(Some(span), format!("more than {MAX_NODES} uses of nodes")));
            return;
        }
        self.edges += ids.len();
        if let Some(count) = self.integer(section, Key::ChildrenCount)
            && count != ids.len() as i64
        {
            let (at, length) = (section.get(Key::ChildrenCount), ids.len());
            self.warnings.add(|| {
                Diagnostic::warning(at, format!("`ChildrenCount` is {count}, and the list has {length}"))
            });
        }
        for child in ids {
            let Some(index) = self.find(child, span) else {
                continue;
            };
            if std::mem::replace(&mut self.adopted[index as usize], true) {
                self.warnings.add(|| {
                    Diagnostic::warning(Some(span), format!("node {child} is a child more than once"))
                });
            }
            reading.children.push(index);
        }
    }

    /// The tree below a node: depth first, with an explicit stack.
    fn build(&mut self, root: u32, reference: Span) -> Tree {
        enum ReadTask {
            Enter(u32, Span),
            Leave(u32, Box<Reading>),
        }
        let broken = Tree::new(Combinator::from(Sum {}), Vec::new());
        let mut states = vec![NodeState::New; self.sections.nodes.len()];
        let mut tasks = vec![ReadTask::Enter(root, reference)];
        while let Some(task) = tasks.pop() {
            match task {
                ReadTask::Enter(index, reference) => match states[index as usize] {
                    NodeState::Done(_) => {}
                    NodeState::Open => {
                        let id = self.sections.nodes[index as usize].id;
                        self.errors
                            .add(|| Diagnostic::error(Some(reference), format!("node {id} contains itself")));
                    }
                    NodeState::New => {
                        states[index as usize] = NodeState::Open;
                        let section = self.sections.nodes[index as usize].clone();
                        let reading = self.node(&section);
                        let (children, reference) = (reading.children.clone(), reading.reference);
                        tasks.push(ReadTask::Leave(index, Box::new(reading)));
                        tasks.extend(
                            children.into_iter().rev().map(|child| ReadTask::Enter(child, reference)),
                        );
                    }
                },
                ReadTask::Leave(index, reading) => {
                    let children = reading.children.iter().map(|&child| match &states[child as usize] {
                        NodeState::Done(tree) => tree.clone(),
                        // Only a cycle, which has been reported, leaves a child unfinished.
                        NodeState::New | NodeState::Open => broken.clone(),
                    });
                    let children: Vec<Tree> = children.collect();
                    let span = self.sections.nodes[index as usize].span;
                    let tree = reading
                        .meaning
                        .and_then(|meaning| assemble(span, meaning, reading.map, children))
                        .unwrap_or_else(|| broken.clone());
                    states[index as usize] = NodeState::Done(tree);
                }
            }
        }
        self.unreached(&states);
        match &states[root as usize] {
            NodeState::Done(tree) => tree.clone(),
            NodeState::New | NodeState::Open => broken,
        }
    }

    /// Nodes that nobody uses.
    fn unreached(&mut self, states: &[NodeState]) {
        let unused = states.iter().enumerate().filter(|(_, state)| matches!(state, NodeState::New));
        let unused: Vec<usize> = unused.map(|(index, _)| index).collect();
        if let Some(&first) = unused.first() {
            let section = &self.sections.nodes[first];
            let (id, span, count) = (section.id, section.span, unused.len());
            self.warnings.add(|| {
                let message = match count {
                    1 => format!("node {id} is not used"),
                    _ => format!("{count} nodes are not used, node {id} among them"),
                };
                Diagnostic::warning(Some(span), message)
            });
        }
    }

    /// Compares the counts that the file states with its contents.
    fn count(&mut self) {
        let Some(global) = self.sections.global.clone() else {
            return;
        };
        let is_operator = |section: &&Section| section.get(Key::OperatorType).is_some();
        let operators = self.sections.nodes.iter().filter(is_operator).count();
        let leaves = self.sections.nodes.len() - operators;
        for (key, found) in
            [(Key::CountPrimitives, leaves), (Key::CountOperators, operators), (Key::NumLayers, 1)]
        {
            let Some(span) = global.get(key) else {
                continue;
            };
            if self.shown(span).parse() != Ok(found) {
                let shown = jbt_model::report::clip(&self.shown(span));
                self.warnings.add(|| {
                    let message = format!("`{}` is {shown}, and the file has {found}", key.name());
                    Diagnostic::warning(Some(span), message)
                });
            }
        }
    }
}

/// The tree of a node. `None` if a child is missing, which has a message.
fn assemble(span: Span, meaning: Meaning, map: Option<DAffine3>, children: Vec<Tree>) -> Option<Tree> {
    let tree = match meaning {
        Meaning::Combine(combinator) => Tree::at(span, combinator, children),
        Meaning::Warp(warp) => Tree::at(span, warp, vec![children.into_iter().next()?]),
        Meaning::Taper(taper) => taper.tree(&children.into_iter().next()?, span),
        Meaning::Map(map) => Tree::at(span, map, vec![children.into_iter().next()?]),
        Meaning::SmoothDifference => {
            let (first, others) = children.split_first()?;
            let left = |field: Term, other: &Tree| field * (1.0 - other.field());
            let tree = Tree::expression(others.iter().fold(first.field(), left));
            Tree::at(span, tree.node().written().clone(), tree.node().children().to_vec())
        }
        Meaning::Same => children.into_iter().next()?,
        Meaning::Leaf { leaf, color } => {
            let tree = Tree::at(span, leaf, Vec::new());
            match color {
                None => tree,
                Some(color) => {
                    let kind = NodeKind::Attribute {
                        name: "color".into(),
                        value: color.to_vec().into(),
                        precedence: Precedence::Nearest,
                    };
                    Tree::at(span, kind, vec![tree])
                }
            }
        }
    };
    Some(match map {
        None => tree,
        Some(map) => Tree::at(span, map, vec![tree]),
    })
}
