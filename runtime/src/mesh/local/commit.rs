//! New bricks take the places of old ones, and what has changed is told.

use std::ops::Range;

use jbt_ir::watch::Watches;
use rustc_hash::{FxHashMap, FxHashSet};

use super::bricks::{BrickMesh, BrickPlace, KeptBrick, around, octet};
use super::join::Join;
use super::renewal::Renewal;
use crate::mesh::indexed::{Attribute, Mesh};

/// What has changed of a brick.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct BrickChange {
    pub(crate) positions: bool,
    pub(crate) normals: bool,
    pub(crate) attributes: bool,
    pub(crate) triangles: bool,
}

impl BrickChange {
    const ALL: Self = Self { positions: true, normals: true, attributes: true, triangles: true };

    fn any(self) -> bool {
        self != Self::default()
    }
}

/// What a commit has changed.
#[derive(Default)]
pub(crate) struct BrickChanges {
    /// Bricks that are no more, and where they were in the buffers of vertices and triangles.
    pub(crate) removed: Vec<(BrickPlace, [Range<usize>; 2])>,
    /// Bricks that are new.
    pub(crate) added: Vec<BrickPlace>,
    /// Bricks that were there before, and have changed.
    pub(crate) changed: Vec<(BrickPlace, BrickChange)>,
    /// Ranges of the buffer of triangles that were cleared, and may have been written since.
    pub(crate) cleared: Vec<Range<usize>>,
}

/// What is known of the bricks of a commit on its way.
#[derive(Default)]
struct Commit {
    changes: BrickChanges,
    /// Of old bricks.
    of: FxHashMap<BrickPlace, BrickChange>,
    /// Normals of old bricks as they were.
    normals: Vec<(BrickPlace, Vec<[f32; 3]>)>,
    /// Positions of old bricks with sharp vertices as they were.
    positions: Vec<(BrickPlace, Vec<[f32; 3]>)>,
    /// The bricks whose vertices have moved, or have other numbers, and those that are no more.
    moved: Vec<BrickPlace>,
}

/// A new brick, as a part of the mesh of all new bricks.
struct NewBrick {
    place: BrickPlace,
    kept: KeptBrick,
    vertices: Range<usize>,
}

impl BrickMesh {
    /// Lets new bricks take the places of old ones.
    pub(crate) fn commit(&mut self, renewal: Renewal) -> BrickChanges {
        // Nothing can fail any more: the renewal has looked for memory.
        Watches::NONE.hold(|| self.commit_held(renewal))
    }

    fn commit_held(&mut self, renewal: Renewal) -> BrickChanges {
        let mut commit = Commit::default();
        self.lattice = renewal.lattice.clone();
        self.edge = renewal.bricks.edge;
        let (new, mesh) = self.new_bricks(renewal, &mut commit);
        self.fit_attributes(&mesh);
        for brick in new {
            self.put(brick, &mesh, &mut commit);
        }
        self.unfold(&mut commit);
        let join = self.moved_bricks(&commit);
        self.join(&join, &mut commit);
        self.finish(commit)
    }

    /// Takes the renewal apart; removes the bricks that are no more.
    fn new_bricks(&mut self, renewal: Renewal, commit: &mut Commit) -> (Vec<NewBrick>, Mesh) {
        let Renewal { lattice, bricks, crossings, suspects, mesh, doubtful, sharp, touched } = renewal;
        let shift = Self::shift(&lattice, self.edge);
        let from_anchor = |place: [u32; 3]| [0, 1, 2].map(|axis| place[axis] as i32 + shift[axis]);
        let (mut new, mut doubtful) = (Vec::with_capacity(bricks.len()), &doubtful[..]);
        let mut sharp = sharp.into_iter().peekable();
        for (brick, suspects) in suspects.into_iter().enumerate() {
            let vertices = crossings.vertices[brick]..crossings.vertices[brick + 1];
            let count = doubtful.partition_point(|&vertex| (vertex as usize) < vertices.end);
            let (mine, rest) = doubtful.split_at(count);
            doubtful = rest;
            let first_normal =
                |&vertex: &u32| (vertex - vertices.start as u32, mesh.normals[vertex as usize]);
            let mut sharp_here = Vec::new();
            while let Some(mut one) = sharp.next_if(|one| (one.vertex as usize) < vertices.end) {
                one.vertex -= vertices.start as u32;
                sharp_here.push(one);
            }
            let kept = KeptBrick {
                sharp: sharp_here,
                corners: Vec::new(),
                cells: crossings.of(brick).to_vec(),
                suspects,
                quads: crossings.quads[brick + 1] - crossings.quads[brick],
                vertices: Default::default(),
                triangles: Default::default(),
                doubtful: mine.iter().map(first_normal).collect(),
            };
            if !kept.cells.is_empty() {
                new.push(NewBrick { place: from_anchor(bricks.places[brick]), kept, vertices });
            }
        }
        let stay: FxHashSet<BrickPlace> = new.iter().map(|brick| brick.place).collect();
        let gone: Vec<BrickPlace> = match touched {
            Some(touched) => {
                touched.bricks().map(from_anchor).filter(|place| !stay.contains(place)).collect()
            }
            None => self.bricks.keys().copied().filter(|place| !stay.contains(place)).collect(),
        };
        let gone = gone.into_iter().filter(|place| self.bricks.contains_key(place));
        let gone = self.in_order(gone.collect::<Vec<_>>().into_iter());
        gone.into_iter().for_each(|(_, place)| self.remove(place, commit));
        (new, mesh)
    }

    fn remove(&mut self, place: BrickPlace, commit: &mut Commit) {
        let Some(old) = self.bricks.remove(&place) else { return };
        let ranges = [old.vertices.range(), old.triangles.range()];
        self.buffers.triangles[ranges[1].clone()].fill([0; 3]);
        commit.changes.cleared.push(ranges[1].clone());
        self.vertex_slots.put_back(old.vertices);
        self.triangle_slots.put_back(old.triangles);
        commit.moved.push(place);
        commit.changes.removed.push((place, ranges));
    }

    /// Lets the buffers have the attributes of the new bricks: others, only if all bricks are new.
    fn fit_attributes(&mut self, mesh: &Mesh) {
        let alike = |a: &Attribute, b: &Attribute| a.name == b.name && a.width == b.width;
        let (old, new) = (&self.buffers.attributes, &mesh.attributes);
        if old.len() != new.len() || !old.iter().zip(new).all(|(a, b)| alike(a, b)) {
            let count = self.buffers.positions.len();
            let empty = |new: &Attribute| Attribute {
                name: new.name.clone(),
                width: new.width,
                values: vec![0.0; new.width * count],
            };
            self.buffers.attributes = new.iter().map(empty).collect();
        }
    }

    /// Puts a new brick into its slot, and compares it with the old one. Its triangles are still the old
    /// ones.
    fn put(&mut self, new: NewBrick, mesh: &Mesh, commit: &mut Commit) {
        let NewBrick { place, mut kept, vertices } = new;
        let old = self.bricks.remove(&place);
        let slot = old.as_ref().map(|old| old.vertices).unwrap_or_default();
        kept.vertices = self.vertex_slots.resize(slot, vertices.len());
        let range = kept.vertices.range();
        self.buffers.reserve(self.vertex_slots.end());
        let stays = slot.len == range.len() && slot.start == range.start;
        let mut change = BrickChange::ALL;
        if let Some(old) = &old {
            kept.triangles = old.triangles;
            kept.corners.clone_from(&old.corners);
            let before = self.buffers.normals[slot.range()].to_vec();
            if stays {
                let same = |a: &[[f32; 3]], b: &[[f32; 3]]| same_bits(a.as_flattened(), b.as_flattened());
                let buffers = &self.buffers;
                change = BrickChange {
                    positions: !same(&buffers.positions[range.clone()], &mesh.positions[vertices.clone()]),
                    attributes: !buffers.attributes.iter().zip(&mesh.attributes).all(|(old, new)| {
                        let [old, new] =
                            [(old, &range), (new, &vertices)].map(|(attribute, range)| attribute.of(range));
                        same_bits(old, new)
                    }),
                    // Found out later.
                    normals: false,
                    triangles: false,
                };
                commit.normals.push((place, before));
                if !old.sharp.is_empty() || !kept.sharp.is_empty() {
                    commit.positions.push((place, self.buffers.positions[slot.range()].to_vec()));
                }
            }
        }
        let is_shape_kept = stays
            && !change.positions
            && old.as_ref().is_some_and(|old| old.cells == kept.cells && old.sharp == kept.sharp);
        if !is_shape_kept {
            commit.moved.push(place);
        }
        self.buffers.write(range, mesh, vertices);
        match old {
            None => commit.changes.added.push(place),
            Some(_) => drop(commit.of.insert(place, change)),
        }
        self.bricks.insert(place, kept);
    }

    /// Puts sharp vertices where they belong that have moved bricks around them.
    fn unfold(&mut self, commit: &mut Commit) {
        let is_sharp = |place: &BrickPlace| self.bricks.get(place).is_some_and(|one| !one.sharp.is_empty());
        let targets: FxHashSet<BrickPlace> =
            commit.moved.iter().flat_map(|&place| around(place)).filter(is_sharp).collect();
        if targets.is_empty() && commit.positions.is_empty() {
            return;
        }
        let known = |places: FxHashSet<BrickPlace>| -> FxHashSet<BrickPlace> {
            places.into_iter().filter(|place| self.bricks.contains_key(place)).collect()
        };
        let own = known(targets.iter().flat_map(|&place| octet(place, 1)).collect());
        let all = known(targets.iter().flat_map(|&place| around(place)).collect());
        let join = Join { bricks: self.in_order(all.into_iter()), own };
        let added: FxHashSet<BrickPlace> = commit.changes.added.iter().copied().collect();
        for (place, vertex, position) in self.sharp_places(&targets, &join) {
            let old = &mut self.buffers.positions[vertex];
            if old.map(f32::to_bits) != position.map(f32::to_bits) {
                *old = position;
                commit.moved.push(place);
                if !added.contains(&place) {
                    commit.of.entry(place).or_default().positions = true;
                }
            }
        }
        for (place, before) in std::mem::take(&mut commit.positions) {
            let now = &self.buffers.positions[self.bricks[&place].vertices.range()];
            let same = same_bits(before.as_flattened(), now.as_flattened());
            commit.of.entry(place).or_default().positions = !same;
        }
    }

    /// The bricks whose triangles may have changed: those with other vertices, and those above them.
    fn moved_bricks(&self, commit: &Commit) -> Join {
        let own: FxHashSet<BrickPlace> = commit.moved.iter().flat_map(|&place| octet(place, 1)).collect();
        let own: FxHashSet<BrickPlace> =
            own.into_iter().filter(|place| self.bricks.contains_key(place)).collect();
        let around: FxHashSet<BrickPlace> = own.iter().flat_map(|&place| octet(place, -1)).collect();
        let around = around.into_iter().filter(|place| self.bricks.contains_key(place));
        Join { bricks: self.in_order(around.collect::<Vec<_>>().into_iter()), own }
    }

    /// Makes triangles anew, and the normals that they decide.
    fn join(&mut self, join: &Join, commit: &mut Commit) {
        let added: FxHashSet<BrickPlace> = commit.changes.added.iter().copied().collect();
        for (place, triangles, corners) in self.triangles(join) {
            let Some(brick) = self.bricks.get_mut(&place) else { continue };
            let old = brick.triangles;
            brick.corners = corners;
            if self.buffers.triangles[old.range()] == triangles[..] {
                continue;
            }
            let slot = self.triangle_slots.resize(old, triangles.len());
            brick.triangles = slot;
            self.buffers.triangles[old.range()].fill([0; 3]);
            commit.changes.cleared.push(old.range());
            let end = self.triangle_slots.end().max(self.buffers.triangles.len());
            self.buffers.triangles.resize(end, [0; 3]);
            self.buffers.triangles[slot.range()].copy_from_slice(&triangles);
            if !added.contains(&place) {
                commit.of.entry(place).or_default().triangles = true;
            }
        }
        let mut judged: FxHashSet<BrickPlace> = join.bricks.iter().map(|&(_, place)| place).collect();
        judged.extend(commit.changes.added.iter().chain(commit.of.keys()));
        for place in judged {
            if self.judge_normals(place) && !added.contains(&place) {
                // Of bricks that were put anew, all normals are compared below.
                commit.of.entry(place).or_default().normals = true;
            }
        }
        for (place, before) in std::mem::take(&mut commit.normals) {
            let now = &self.buffers.normals[self.bricks[&place].vertices.range()];
            let same = same_bits(before.as_flattened(), now.as_flattened());
            commit.of.entry(place).or_default().normals = !same;
        }
    }

    fn finish(&self, commit: Commit) -> BrickChanges {
        let Commit { mut changes, of, .. } = commit;
        let changed = self.in_order(of.iter().filter(|(_, change)| change.any()).map(|(&place, _)| place));
        changes.changed = changed.into_iter().map(|(_, place)| (place, of[&place])).collect();
        changes.cleared.retain(|range| !range.is_empty());
        changes
    }

    /// Where a brick is in the buffers of vertices and of triangles.
    pub(crate) fn ranges(&self, place: BrickPlace) -> [Range<usize>; 2] {
        let brick = &self.bricks[&place];
        [brick.vertices.range(), brick.triangles.range()]
    }
}

impl Attribute {
    /// The values of some vertices.
    fn of(&self, vertices: &Range<usize>) -> &[f32] {
        &self.values[vertices.start * self.width..vertices.end * self.width]
    }
}

impl Mesh {
    /// Lets it have at least so many vertices.
    fn reserve(&mut self, count: usize) {
        let count = count.max(self.positions.len());
        self.positions.resize(count, [0.0; 3]);
        self.normals.resize(count, [0.0; 3]);
        self.attributes
            .iter_mut()
            .for_each(|attribute| attribute.values.resize(attribute.width * count, 0.0));
    }

    /// Copies vertices of another mesh with the same attributes.
    fn write(&mut self, range: Range<usize>, from: &Self, vertices: Range<usize>) {
        self.positions[range.clone()].copy_from_slice(&from.positions[vertices.clone()]);
        self.normals[range.clone()].copy_from_slice(&from.normals[vertices.clone()]);
        for (to, from) in self.attributes.iter_mut().zip(&from.attributes) {
            to.values[range.start * to.width..range.end * to.width].copy_from_slice(from.of(&vertices));
        }
    }
}

/// Whether numbers are equal to the bit.
fn same_bits(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}
