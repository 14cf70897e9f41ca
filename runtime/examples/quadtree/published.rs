//! The published algorithm: squares are split where something says that the contour may be in them, from the
//! cheapest test to the dearest.
//!
//! ```text
//! for each quarter of a square:  keep it, if  some circle's centre is in the square (not: in the quarter)
//!                                        or   an edge of the quarter is near a circle, and the square is large
//!                                        or   its corners are both inside and outside
//!                                             (the only test of the smallest squares)
//! then remove what leads to no smallest square
//! ```
//!
//! After Malcolm Kesson, "QuadTree: Blobby Geometry" (fundza.com, 2012), whose published counts come out
//! exactly, and so do its faults: the centre is looked for in the parent, nearness is half a radius, and
//! removal ends at the first part that leads somewhere. It decides by samples, and so it can miss a part of
//! the contour that is smaller than a square. What differs is the cache: it is a plain array over the
//! lattice, not a dictionary of coordinates.

use super::circles::{Circle, ISO};
use super::lattice::{Block, Lattice, Place, SPACING, coordinate, crossing_cells, is_crossed, points};

/// Blocks that are not larger are not split, and have only their corners tested.
const SMALLEST: f64 = 0.02;

/// Parts of squares of a smaller depth are kept where an edge is near a circle.
const EDGE_DEPTH: u32 = 4;

/// The soft object's falloff (Wyvill, McPheeters and Wyvill 1986), with the five digits of the publication.
fn falloff(distance_squared: f64, radius_squared: f64) -> f64 {
    if distance_squared >= radius_squared {
        return 0.0;
    }
    let s = distance_squared / radius_squared;
    1.0 + s * (-2.44444 + s * (1.88889 - s * 0.44444))
}

fn field(circles: &[Circle], point: Place) -> f64 {
    let [x, y] = point.map(coordinate);
    let part = |circle: &Circle| {
        let [dx, dy] = [circle.center[0] - x, circle.center[1] - y];
        falloff(dx * dx + dy * dy, circle.radius * circle.radius)
    };
    circles.iter().map(part).sum()
}

/// The field at lattice points, each evaluated once.
struct Cache<'a> {
    circles: &'a [Circle],
    values: Lattice<Option<f64>>,
    lookups: u64,
    evaluated: u64,
}

impl Cache<'_> {
    fn is_inside(&mut self, point: Place) -> bool {
        self.lookups += 1;
        let value = match *self.values.at(point) {
            Some(value) => value,
            None => {
                self.evaluated += 1;
                *self.values.at(point).insert(field(self.circles, point))
            }
        };
        value >= ISO
    }
}

/// A square that was kept.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// The square.
    pub square: Block,
    /// How often the whole was split to get here.
    pub depth: u32,
}

impl Node {
    /// Whether it is not split.
    pub fn is_leaf(&self) -> bool {
        f64::from(self.square.sides[0]) * SPACING <= SMALLEST
    }
}

/// A node, and the index of the one that it is a part of.
struct Created {
    node: Node,
    parent: usize,
}

/// What the algorithm finds, and what that took.
pub struct Published {
    /// The nodes after the removal, parents first.
    pub nodes: Vec<Node>,
    /// Nodes that were made, without the root.
    pub created: usize,
    /// How often the field at a point was asked for.
    pub lookups: u64,
    /// How often it was evaluated.
    pub evaluated: u64,
    /// How often a circle was.
    pub circle_evaluations: u64,
    /// Crossing cells of the lattice that are no leaves, in order; all points were evaluated to find them.
    pub missed: Vec<Place>,
}

impl Published {
    /// The smallest squares.
    pub fn leaves(&self) -> impl Iterator<Item = &Node> {
        self.nodes.iter().filter(|node| node.is_leaf())
    }

    /// How often the field at a point was known already.
    pub fn reused(&self) -> u64 {
        self.lookups - self.evaluated
    }

    /// The greatest depth of a node.
    pub fn depth(&self) -> u32 {
        self.nodes.iter().map(|node| node.depth).max().unwrap_or(0)
    }
}

/// Runs the algorithm.
pub fn run(circles: &[Circle]) -> Published {
    let mut cache = Cache { circles, values: Lattice::filled(None), lookups: 0, evaluated: 0 };
    let created = divide(circles, &mut cache);
    let nodes = prune(&created);
    let mut leaves: Vec<Place> =
        nodes.iter().filter(|node| node.is_leaf()).map(|node| node.square.low).collect();
    leaves.sort_unstable();
    let mut inside = Lattice::filled(false);
    points().for_each(|point| *inside.at(point) = field(circles, point) >= ISO);
    let mut missed = crossing_cells(|point| *inside.at(point));
    missed.retain(|cell| leaves.binary_search(cell).is_err());
    Published {
        nodes,
        created: created.len() - 1,
        lookups: cache.lookups,
        evaluated: cache.evaluated,
        circle_evaluations: cache.evaluated * circles.len() as u64,
        missed,
    }
}

/// The root, and all nodes that are made under it, level by level, the parts of each one after the other.
fn divide(circles: &[Circle], cache: &mut Cache<'_>) -> Vec<Created> {
    let root = Node { square: Block::WHOLE, depth: 0 };
    let mut created = vec![Created { node: root, parent: 0 }];
    let mut parent = 0;
    while parent < created.len() {
        let node = created[parent].node;
        if !node.is_leaf() {
            for square in node.square.quarters() {
                let part = Node { square, depth: node.depth + 1 };
                if is_wanted(circles, cache, &node, &part) {
                    created.push(Created { node: part, parent });
                }
            }
        }
        parent += 1;
    }
    created
}

fn is_wanted(circles: &[Circle], cache: &mut Cache<'_>, node: &Node, part: &Node) -> bool {
    if !part.is_leaf() {
        if circles.iter().any(|circle| contains(&node.square, circle.center)) {
            return true;
        }
        if node.depth < EDGE_DEPTH
            && circles
                .iter()
                .any(|circle| distance_to_edges(&part.square, circle.center) <= circle.radius / 2.0)
        {
            return true;
        }
    }
    is_crossed(&part.square, |corner| cache.is_inside(corner))
}

fn contains(square: &Block, point: [f64; 2]) -> bool {
    (0..2).all(|axis| {
        let [low, high] = square.extent(axis);
        (low..=high).contains(&point[axis])
    })
}

/// The distance of a point to the nearest of a square's four edges.
fn distance_to_edges(square: &Block, point: [f64; 2]) -> f64 {
    let mut nearest = f64::INFINITY;
    for (across, along) in [(0, 1), (1, 0)] {
        let [low, high] = square.extent(along);
        let beyond = point[along] - point[along].clamp(low, high);
        for side in square.extent(across) {
            nearest = nearest.min(beyond.hypot(point[across] - side));
        }
    }
    nearest
}

/// The nodes without those that have no leaf, and come before any part of the same square that has one.
fn prune(created: &[Created]) -> Vec<Node> {
    // Parents come before their parts.
    let mut leaves: Vec<u32> = created.iter().map(|Created { node, .. }| u32::from(node.is_leaf())).collect();
    for (index, Created { parent, .. }) in created.iter().enumerate().skip(1).rev() {
        leaves[*parent] += leaves[index];
    }
    let mut kept = vec![true; created.len()];
    let mut leaves_so_far = vec![0; created.len()];
    for (index, Created { parent, .. }) in created.iter().enumerate().skip(1) {
        leaves_so_far[*parent] += leaves[index];
        kept[index] = kept[*parent] && leaves_so_far[*parent] > 0;
    }
    created.iter().zip(kept).filter_map(|(Created { node, .. }, kept)| kept.then_some(*node)).collect()
}
