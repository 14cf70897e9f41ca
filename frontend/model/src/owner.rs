//! Owners: the leaf that decides the field at a point, and the way down to it.
//!
//! ```text
//! owner(node, p):   primitive      itself, where its field is not 0
//!                   union          the owner of the largest operand, of the smallest at an intersection, of the one that decides at a difference
//!                   sum, Ricci     of the operands' owners, the leaf with the largest share of the weight
//! ```
//!
//! Shares are those that mix attributes: the owner is the leaf whose value a `dominant` attribute takes. Of
//! equals the first in the file owns the point. The walk is in f64 over plain formulas, one point at a time,
//! on a list of its own: a chain of a million nodes is a tree like any other.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::DVec3;

use crate::check::{CheckedNode, CheckedTree, NodeId};
use crate::combine::{Combinator, Sum};
use crate::constant::LeafConstant;
use crate::descent::{GivenAttribute, Question, ask};
use crate::diagnostic::Span;
use crate::expression::Expression;
use crate::kind::{NodeKind, Primitive};
use crate::particles::Particles;
use crate::path::{NamedNodes as _, child_step, name_step, names_in_names, path_of};
use crate::warp::Warp;

/// A leaf that decides, as one of its instances.
#[derive(Clone, PartialEq, Debug)]
pub struct Owner {
    /// The leaf.
    pub node: NodeId,
    /// Which one of particles it is, if the node is that; else 0.
    pub particle: usize,
    /// Where it stands in its source text.
    pub span: Option<Span>,
    /// Its part of the weight of the whole field, in (0, 1]. It is 1 unless fields are blended.
    pub share: f64,
    /// The nodes above it, the root first, each with the number of the child that leads to the leaf.
    pub above: Vec<(NodeId, u32)>,
}

impl Owner {
    /// The way from the root to the leaf, a [path](crate::path) that leads to it alone: names, and behind
    /// the last one numbers of children with the words of their kinds, as in `body/arm.1/0.color/2.point`;
    /// without names from the root on, `0.union/2.point`. Particles have one path together.
    ///
    /// Cost: the nodes of the tree, each a few times.
    #[must_use]
    pub fn path(&self, tree: &CheckedTree) -> String {
        path_of(tree, tree.root(), &self.steps(self.above.len()), self.node)
    }

    /// The first nodes above it, each with the child that leads on.
    fn steps(&self, depth: usize) -> Vec<(NodeId, usize)> {
        self.above[..depth].iter().map(|&(node, child)| (node, child as usize)).collect()
    }

    /// The constants that the leaf has, by name: of several of one name above it the nearest one, unless one
    /// overrides it.
    ///
    /// ```
    /// use jbt_model::builder::point;
    /// use jbt_model::{model::Model, owner::owner};
    /// let pin = point([3, 0, 0], 1).constant("material", "brass").constant("part", 17);
    /// let tree = Model::new((point([0; 3], 1) | pin).constant("material", "steel")).check()?;
    /// let [plate, pin] = [0.1, 3.1].map(|x| owner(&tree, [x, 0.0, 0.0]).unwrap());
    /// assert_eq!(plate.constants(&tree)["material"], &"steel".into());
    /// assert_eq!((pin.constants(&tree)["material"], pin.constants(&tree)["part"]), (&"brass".into(), &17.into()));
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    #[must_use]
    pub fn constants<'a>(&self, tree: &'a CheckedTree) -> BTreeMap<&'a str, &'a LeafConstant> {
        let mut found: BTreeMap<&str, &NodeKind> = BTreeMap::new();
        for &(node, _) in &self.above {
            let kind = &tree.node(node).kind;
            let Some((name, _)) = kind.constant() else { continue };
            // The root comes first, so nearer ones replace it.
            if !found.get(name).is_some_and(|above| above.overrides()) {
                found.insert(name, kind);
            }
        }
        found.into_values().filter_map(NodeKind::constant).collect()
    }

    /// The part that the leaf belongs to, in words: the path of the nearest node above that has a name, or
    /// of the leaf itself, which leads to it alone; see [`path`](crate::path). Nothing if none has one.
    ///
    /// ```
    /// use jbt_model::owner::owner;
    /// let text = "jbt 1 body: union { arm: point { radius 1 } arm: translate (3 0 0) { point { radius 1 } } }";
    /// let tree = jbt_text::model(text)?.check()?;
    /// let found = owner(&tree, [3.0, 0.1, 0.0]).unwrap();
    /// assert_eq!(found.part(&tree).as_deref(), Some("body/arm.1"));
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    #[must_use]
    pub fn part(&self, tree: &CheckedTree) -> Option<String> {
        let way: Vec<NodeId> = self.above.iter().map(|&(node, _)| node).chain([self.node]).collect();
        let depth = way.iter().rposition(|&node| tree.node(node).name().is_some())?;
        Some(path_of(tree, tree.root(), &self.steps(depth), way[depth]))
    }
}

/// The ways down to the leaves of a tree, in words: to a leaf with several uses, the first one in the order
/// of the file. Selectors lead to their chosen children, and warps not to their weights.
///
/// ```
/// use jbt_model::{check::NodeId, owner::LeafWays};
/// let text = "jbt 1 let a = point { radius 1 }
///     union { left: translate (1 0 0) { use a } translate (2 0 0) { use a } }";
/// let tree = jbt_text::model(text)?.check()?;
/// assert_eq!(LeafWays::new(&tree).path(NodeId(0), 100).as_deref(), Some("left/a"));
/// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
/// ```
#[derive(Clone, Debug)]
pub struct LeafWays<'a> {
    tree: &'a CheckedTree,
    /// Of each node that a way leads to: the node above it, and which of its children it is.
    above: Vec<Option<(NodeId, u32)>>,
    /// Of each of them that has a name: the name above, and how many of its own came before below that.
    places: Vec<Option<(u32, u64)>>,
    /// How often each name stands below a name; first those below none.
    counts: Vec<HashMap<&'a str, u64>>,
    inner: HashSet<&'a str>,
}

/// A place that a walk comes to.
struct WayVisit {
    node: NodeId,
    above: Option<(NodeId, u32)>,
    /// The name above.
    name: u32,
    /// Whether what it says is heard.
    answers: bool,
}

impl<'a> LeafWays<'a> {
    /// Those of a tree. Cost: each node once, and once more for each path to it if it, or what is below it,
    /// has a name and no name is between.
    #[must_use]
    pub fn new(tree: &'a CheckedTree) -> Self {
        let count = tree.nodes().len();
        let mut ways = Self {
            tree,
            above: vec![None; count],
            places: vec![None; count],
            counts: vec![HashMap::new()],
            inner: names_in_names(tree, tree.root()),
        };
        let mut has_names = vec![false; count];
        for (index, node) in tree.nodes().iter().enumerate() {
            let below = node.children.iter().any(|child| has_names[child.0 as usize]);
            has_names[index] = below || node.name().is_some();
        }
        let mut seen = vec![false; count];
        let mut stack = vec![WayVisit { node: tree.root(), above: None, name: 0, answers: true }];
        while let Some(WayVisit { node: id, above, name: mut level, answers }) = stack.pop() {
            let index = id.0 as usize;
            let node = tree.node(id);
            let is_first = answers && !seen[index];
            seen[index] |= answers;
            if let Some(name) = node.name() {
                let before = ways.counts[level as usize].entry(name).or_default();
                if is_first {
                    ways.places[index] = Some((level, *before));
                }
                *before += 1;
                level = ways.counts.len() as u32;
                ways.counts.extend(is_first.then(HashMap::new));
            }
            // What has been met before is gone through for the names alone that count here.
            if !is_first && (node.name().is_some() || !has_names[index]) {
                continue;
            }
            if is_first {
                ways.above[index] = above;
            }
            let answering = match &node.kind {
                NodeKind::Warp(_) => 0..1,
                kind => kind.places_asked(node.children.len()),
            };
            stack.extend(node.children.iter().enumerate().rev().map(|(place, &child)| WayVisit {
                node: child,
                above: Some((id, place as u32)),
                name: level,
                answers: is_first && answering.contains(&place),
            }));
        }
        ways
    }

    /// The leaves that a way leads to and that have a field, ascending.
    pub(crate) fn leaves(&self) -> Vec<NodeId> {
        let all = (0..self.tree.nodes().len() as u32).map(NodeId);
        all.filter(|&id| self.reaches(id) && is_leaf(self.tree.node(id))).collect()
    }

    fn reaches(&self, id: NodeId) -> bool {
        id == self.tree.root() || self.above[id.0 as usize].is_some()
    }

    /// The node above one that the model has, and which of its children that is.
    fn above_plain(&self, id: NodeId) -> Option<(NodeId, u32)> {
        let (mut node, mut child) = self.above[id.0 as usize]?;
        while self.tree.is_given(node) {
            (node, child) = self.above[node.0 as usize]?;
        }
        Some((node, child))
    }

    /// Whether the name of a step stands below other names as well.
    fn begins_inside(&self, step: &str) -> bool {
        self.inner.contains(step.split('.').next().unwrap_or(step))
    }

    /// The way from the root to a node, as [`Owner::path`] has it; `None` if no way leads there. Of one that
    /// takes more than so many bytes, the end, behind `…/`, which is no path any more.
    #[must_use]
    pub fn path(&self, leaf: NodeId, longest: usize) -> Option<String> {
        if leaf.0 as usize >= self.tree.nodes().len() || !self.reaches(leaf) {
            return None;
        }
        let mut steps: Vec<String> = Vec::new();
        let (mut length, mut next, mut is_named) = (0, Some(leaf), false);
        while let Some(at) = next {
            let above = self.above_plain(at);
            next = above.map(|(node, _)| node);
            let name = self.tree.node(at).name().zip(self.places[at.0 as usize]);
            let step = match name {
                Some((name, (level, place))) => {
                    is_named = true;
                    let all = self.counts[level as usize].get(name);
                    name_step(name, all.is_some_and(|&all| all > 1).then_some(place))
                }
                // Above a name nothing else counts.
                None if is_named => continue,
                None => child_step(above.map_or(0, |(_, child)| child as usize), self.tree.word(at)),
            };
            length += step.len() + 1;
            if length > longest + 1 && !steps.is_empty() {
                steps.push("…".to_owned());
                break;
            }
            steps.push(step);
        }
        if is_named && next.is_none() {
            let first = steps.last_mut().filter(|step| self.begins_inside(step));
            first.into_iter().for_each(|step| step.insert(0, '/'));
        }
        steps.reverse();
        Some(steps.join("/"))
    }
}

/// Whether a node has no children and a field that is not 0 everywhere.
fn is_leaf(node: &CheckedNode) -> bool {
    match &node.kind {
        NodeKind::Primitive(_) | NodeKind::Particles(_) => true,
        NodeKind::Expression(expression) => node.children.is_empty() && !expression.vanishes(),
        NodeKind::Combine(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Attribute { .. }
        | NodeKind::Constant { .. }
        | NodeKind::Select(_) => false,
    }
}

/// A node at the end of a path from the root.
struct PathStep {
    node: NodeId,
    /// The step above, and which of its children this is; the root is its own.
    above: u32,
    child: u32,
}

/// What is known at a node.
#[derive(Clone, Copy)]
struct OwnerAnswer {
    field: f64,
    /// The leaf that decides, and its share of the weight here. Nobody decides where nothing has weight.
    leaf: Option<(OwnerLeaf, f64)>,
}

/// A leaf by its step, and which one of particles it is.
#[derive(Clone, Copy)]
struct OwnerLeaf {
    step: u32,
    particle: u32,
}

/// The leaf that decides at `p`: `None` where the field is 0, or where it is negative because nothing with a
/// positive field is left.
///
/// Cost: all paths of the tree.
#[must_use]
pub fn owner(tree: &CheckedTree, p: [f64; 3]) -> Option<Owner> {
    let mut found = Owners { iso: tree.iso(), steps: Vec::new() };
    let root = ask(tree, &mut found, OwnerWay::default(), p.into());
    let (leaf, share) = root.leaf.filter(|_| root.field != 0.0)?;
    Some(describe(tree, &found.steps, leaf, share))
}

impl CheckedTree {
    /// The part that decides the field at a point of the world, in f64 by a plain walk: that of the
    /// [`owner`](fn@owner). Where parts overlap it is the one with the larger field.
    ///
    /// ```
    /// let text = r#"jbt 1 part "hub" { point { radius 1 } } part "rim" { point { at (3 0 0) radius 1 } }"#;
    /// let tree = jbt_text::model(text)?.check()?;
    /// assert_eq!([0.2, 3.1, 9.0].map(|x| tree.part_at([x, 0.0, 0.0])), [Some(0), Some(1), None]);
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    #[must_use]
    pub fn part_at(&self, point: [f64; 3]) -> Option<usize> {
        if self.parts().is_empty() {
            return None;
        }
        Some(owner(self, point)?.above.first()?.1 as usize)
    }
}

/// The question for the leaf that decides.
struct Owners {
    iso: f64,
    steps: Vec<PathStep>,
}

/// On the way to a node: the step above, and which of its children this is. At the node: its own step.
#[derive(Clone, Copy, Default)]
struct OwnerWay {
    step: u32,
    child: u32,
}

impl Question for Owners {
    type Way = OwnerWay;
    type Answer = OwnerAnswer;
    type Mark = ();

    fn enter(&mut self, node: NodeId, way: OwnerWay) -> OwnerWay {
        // At most limits::MAX_INSTANCES.
        let step = self.steps.len() as u32;
        self.steps.push(PathStep { node, above: way.step, child: way.child });
        OwnerWay { step, child: 0 }
    }

    fn below(&self, way: &OwnerWay, child: usize) -> OwnerWay {
        OwnerWay { child: child as u32, ..*way }
    }

    fn given(&self, way: OwnerWay, _node: GivenAttribute<'_>, _p: DVec3) -> OwnerWay {
        way
    }

    fn turned(&self, _tree: &CheckedTree, way: OwnerWay, _node: NodeId, _p: DVec3) -> OwnerWay {
        way
    }

    fn primitive(&self, leaf: &Primitive, p: DVec3, way: &OwnerWay) -> OwnerAnswer {
        let s = leaf.skeleton.distance_squared(p) / (leaf.radius * leaf.radius);
        OwnerAnswer::of_leaf(leaf.strength * leaf.falloff.value(s), way.step)
    }

    fn particles(&self, particles: &Particles, p: DVec3, way: &OwnerWay) -> OwnerAnswer {
        let answer = |particle: usize| {
            let (at, radius) = (particles.at(particle), particles.radius(particle));
            let s = (p - at).length_squared() / (radius * radius);
            let field = particles.strength(particle) * particles.falloff().value(s);
            // There are at most limits::MAX_PARTICLES.
            OwnerAnswer::of(field, OwnerLeaf { step: way.step, particle: particle as u32 })
        };
        // Others have neither field nor weight.
        let mut heard: Vec<OwnerAnswer> = (0..particles.len()).map(answer).collect();
        heard.retain(|answer| answer.field != 0.0);
        if heard.len() < particles.len() {
            // One of several is weighed, as any number of them.
            heard.push(OwnerAnswer { field: 0.0, leaf: None });
        }
        combine(Sum {}.into(), self.iso, &heard)
    }

    fn combine(&self, combinator: Combinator, children: &[OwnerAnswer]) -> OwnerAnswer {
        combine(combinator, self.iso, children)
    }

    fn express(
        &self,
        formula: &Expression,
        p: DVec3,
        way: &OwnerWay,
        children: &[OwnerAnswer],
    ) -> OwnerAnswer {
        if children.is_empty() {
            OwnerAnswer::of_leaf(formula.field(p, &[]), way.step)
        } else {
            express(formula, p, children)
        }
    }

    fn field(answer: &OwnerAnswer) -> f64 {
        answer.field
    }

    fn mark(&self, _warp: &Warp, _p: DVec3, _weight: Option<&OwnerAnswer>) {}

    fn marked(&self, _answer: &mut OwnerAnswer, (): ()) {}
}

impl OwnerAnswer {
    fn of_leaf(field: f64, step: u32) -> Self {
        Self::of(field, OwnerLeaf { step, particle: 0 })
    }

    fn of(field: f64, leaf: OwnerLeaf) -> Self {
        Self { field, leaf: (field != 0.0).then_some((leaf, 1.0)) }
    }
}

fn combine(combinator: Combinator, iso: f64, children: &[OwnerAnswer]) -> OwnerAnswer {
    if children.len() == 1 && combinator.passes_single() {
        // There is nothing to decide.
        return children[0];
    }
    let fields: Vec<f64> = children.iter().map(|child| child.field).collect();
    let weights = combinator.weights(&fields, iso);
    OwnerAnswer { field: combinator.field(&fields, iso), leaf: heaviest(children, &weights) }
}

/// A formula of one child is that child's; of several, of the leaf with the largest share.
fn express(expression: &Expression, p: DVec3, children: &[OwnerAnswer]) -> OwnerAnswer {
    let fields: Vec<f64> = children.iter().map(|child| child.field).collect();
    let field = expression.field(p, &fields);
    if let [child] = children {
        return OwnerAnswer { field, leaf: child.leaf };
    }
    OwnerAnswer { field, leaf: heaviest(children, &expression.weights(p, &fields)) }
}

/// The leaf with the largest share of the weight.
fn heaviest(children: &[OwnerAnswer], weights: &[f64]) -> Option<(OwnerLeaf, f64)> {
    let total: f64 = weights.iter().sum();
    let mut best = None;
    let mut most = 0.0;
    for (child, weight) in children.iter().zip(weights) {
        let Some((leaf, share)) = child.leaf else { continue };
        let share = weight / total * share;
        // Strictly: of equals the first in the file stays. A total of zero gives no number, which is not
        // more.
        if share > most {
            (best, most) = (Some((leaf, share)), share);
        }
    }
    best
}

/// The way up from a leaf.
fn describe(tree: &CheckedTree, steps: &[PathStep], leaf: OwnerLeaf, share: f64) -> Owner {
    let node = steps[leaf.step as usize].node;
    let mut above = Vec::new();
    let mut at = leaf.step;
    // The first step is the root's.
    while at != 0 {
        let step = &steps[at as usize];
        above.push((steps[step.above as usize].node, step.child));
        at = step.above;
    }
    above.reverse();
    Owner { node, particle: leaf.particle as usize, span: tree.node(node).span, share, above }
}
