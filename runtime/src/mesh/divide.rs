//! The recursive division of the lattice into bricks: boxes without surface are dropped and never evaluated.
//!
//! ```text
//! boxes = [the whole lattice]
//! until boxes are bricks:
//!     for each box, in parallel:                      ranges of its (up to) 8 children           (split)
//!         low >= iso: all inside, dropped             high < iso: all outside, dropped
//!         the others get regions of their own
//!     boxes = all children, in Morton order           their neighbours: children of their parents' neighbours
//! ```
//!
//! Boxes are closed, with their high sides: a point that two boxes share is on the same side of the surface
//! in both, and a crossed cell is always in a brick.

use std::error::Error;
use std::sync::atomic::{AtomicUsize, Ordering};

use jbt_ir::limits::MAX_BRICKS;
use jbt_ir::watch;

use crate::parallel::*;

use super::brick::{Bricks, NONE, SELF, box_of, starts};
use super::error::{MAX_BRICK, MeshError};
use super::field::Field;
use super::fill::{FilledVector, VectorPart};
use super::options::Options;
use super::report::Sides;
use super::scope::DivisionScope;
use super::stage::MeshStage;
use crate::boxes::{ANYTHING, Box3, MAX_PARTS, Range};
use crate::progress::Progress;
use crate::span::span;

/// The result of the division.
pub(crate) struct BrickDivision<R> {
    /// The bricks that the surface may cross.
    pub(crate) bricks: Bricks,
    /// The region of each brick.
    pub(crate) regions: Vec<R>,
    /// Counts of boxes.
    pub(crate) boxes: BoxCounts,
    /// The boxes of [`CHUNK`] cells along an edge that the surface may cross, and their regions, if bricks
    /// are smaller or larger and chunks are wanted.
    pub(crate) chunks: Option<Kept<R>>,
}

/// The places of some boxes, in units of their size and in Morton order, and their regions.
pub(crate) type Kept<R> = (Vec<[u32; 3]>, Vec<R>);

/// Counts of boxes.
#[derive(Clone, Copy, Default)]
pub(crate) struct BoxCounts {
    /// Boxes whose range was computed.
    pub(crate) examined: u64,
    /// Boxes that were dropped as all inside.
    pub(crate) inside: u64,
    /// Boxes that were dropped as all outside.
    pub(crate) outside: u64,
    /// Evaluations of primitives that the points of dropped boxes would have taken.
    pub(crate) spared: u64,
    /// The sides of the lattice that the boxes inside touch.
    pub(crate) cut: Sides,
}

impl BoxCounts {
    fn add(&mut self, other: Self) {
        self.examined += other.examined;
        self.inside += other.inside;
        self.outside += other.outside;
        self.spared = self.spared.saturating_add(other.spared);
        self.cut.add(other.cut);
    }
}

/// The remaining boxes of one size, in Morton order.
struct BoxLevel<R> {
    /// Where they are, in units of their size.
    places: Vec<[u32; 3]>,
    regions: Vec<R>,
    neighbours: Vec<[u32; 27]>,
}

/// The boxes of the next size, and the chunks if that is their size.
type Descended<R> = (BoxLevel<R>, Option<Kept<R>>);

/// The edge in cells of the boxes that the search for thin parts uses, for any edge of bricks.
pub(crate) const CHUNK: usize = 8;
/// How many bricks there may be, and the edge of the largest ones, if nobody says how large they are.
#[derive(Clone, Copy)]
pub(crate) struct BrickLimits {
    pub(crate) count: usize,
    pub(crate) edge: usize,
}

impl BrickLimits {
    /// Of a mesh that is made at once: large bricks have fewer points on their sides and fewer calls.
    pub(crate) const WHOLE: Self = Self { count: MAX_BRICKS, edge: 16 };
    /// Of a mesh that is made in pieces: what is touched is made by whole bricks.
    pub(crate) const PIECES: Self = Self { count: MAX_BRICKS, edge: 8 };
}

/// For bricks of an edge: the mean ops of a point, and the number of bricks, from which on they are halved.
/// Then there are fewer ops at each point, or fewer points to keep: 8,192 bricks of 16^3 keep 170 MB.
const HALVED: [(usize, u64, usize); 2] = [(16, 256, 1 << 13), (8, 200, usize::MAX)];

/// What a box takes while it is divided, with its parts: an estimate. Rows are counted by themselves.
const BOX_BYTES: usize = 1 << 10;

/// Regions whose ops one thread adds: some ten microseconds.
const AT_ONCE: usize = 256;

impl<R: Sync> BoxLevel<R> {
    /// Whether bricks of this edge are to be halved: they are many, or a point is costly, on average.
    fn wants_halves<F: Field<Region = R>>(&self, field: &F, edge: usize) -> bool {
        let Some((_, most_ops, many)) = HALVED.iter().find(|(of, ..)| *of == edge) else { return false };
        let of_some =
            |some: &[R]| some.iter().fold(0, |sum: u64, region| sum.saturating_add(field.work(region).ops));
        let ops: Vec<u64> = scatter(|_| self.regions.par_chunks(AT_ONCE).map(of_some).collect());
        let (ops, bricks) = (ops.into_iter().fold(0, u64::saturating_add), self.regions.len());
        bricks >= *many || ops >= most_ops.saturating_mul(bricks as u64) && ops > 0
    }
}

/// The children of some boxes.
struct BoxChildren<R> {
    /// For each box, its remaining children, a bit each.
    masks: Vec<u8>,
    /// The regions of these children.
    regions: Vec<R>,
    boxes: BoxCounts,
}

/// The constant inputs of the division.
struct BrickDivider<'a, 'hook, F: Field> {
    field: &'a F,
    axes: &'a [Vec<f32>; 3],
    /// The boxes that are looked at.
    scope: DivisionScope<'a>,
    iso: f32,
    limit: usize,
    progress: &'a Progress<'hook>,
}

/// Divides a lattice with these coordinates into bricks. No more boxes of one size are kept than the limits
/// say.
/// What is out of the scope is not looked at.
pub(crate) fn divide<F: Field>(
    field: &F,
    axes: [Vec<f32>; 3],
    (options, scope): (&Options, DivisionScope<'_>),
    limits: BrickLimits,
    progress: &Progress<'_>,
) -> Result<BrickDivision<F::Region>, MeshError<F::Error>> {
    span!("divide");
    let mut edge = options.brick.unwrap_or(limits.edge);
    let limit = limits.count;
    let divider = BrickDivider { field, axes: &axes, scope, iso: options.iso, limit, progress };
    let most = axes.iter().map(|axis| axis.len() - 1).fold(1, usize::max);
    // The search for thin parts wants the same boxes around each box, whatever the edge of bricks is: the
    // first has room for the largest brick.
    let least = if options.thin_parts { MAX_BRICK } else { edge };
    let halvings = most.next_power_of_two().max(least).ilog2() - edge.ilog2();
    MeshStage::Divide.begin(progress)?;
    let mut boxes = BoxCounts::default();
    let mut level = divider.root(edge << halvings, &mut boxes)?;
    let mut chunks = None;
    for halving in (0..halvings).rev() {
        let above = (edge << halving) * 2;
        (level, chunks) = divider.descend_and_keep(level, above, (options.thin_parts, chunks), &mut boxes)?;
        progress.add(1.0 / f64::from(halvings))?;
    }
    while options.brick.is_none() && level.wants_halves(field, edge) {
        (level, chunks) = divider.descend_and_keep(level, edge, (options.thin_parts, chunks), &mut boxes)?;
        edge /= 2;
    }
    if options.thin_parts && edge > CHUNK {
        // The counts of boxes are those of the bricks.
        let (mut size, mut counted) = (edge / 2, BoxCounts::default());
        let mut inner = divider.descend(&level, size, &mut counted)?;
        while size > CHUNK {
            size /= 2;
            inner = divider.descend(&inner, size, &mut counted)?;
        }
        chunks = Some((inner.places, inner.regions));
    }
    let BoxLevel { places, regions, neighbours } = level;
    Ok(BrickDivision { bricks: Bricks::new(edge, axes, places, neighbours), regions, boxes, chunks })
}

impl<F: Field> BrickDivider<'_, '_, F> {
    /// The whole lattice as one box of this size; no box if it has no surface.
    fn root(&self, size: usize, boxes: &mut BoxCounts) -> Result<BoxLevel<F::Region>, MeshError<F::Error>> {
        let bounds = box_of(self.axes, [0; 3], [size; 3]);
        let region = self.field.region(bounds).map_err(MeshError::Field)?;
        let mut range = [ANYTHING];
        if !self.is_passed(&[0; 3], size) {
            self.field.ranges(&region, &[bounds], &mut range).map_err(MeshError::Field)?;
        }
        let level = BoxLevel { places: Vec::new(), regions: Vec::new(), neighbours: Vec::new() };
        if !self.may_cross(&region, range[0], ([0; 3], size), boxes) {
            return Ok(level);
        }
        self.check(1)?;
        let mut neighbours = [NONE; 27];
        neighbours[SELF] = 0;
        Ok(BoxLevel { places: vec![[0; 3]], regions: vec![region], neighbours: vec![neighbours] })
    }

    /// The children of all boxes, with the new size. The boxes themselves are kept if they are wanted as
    /// chunks.
    fn descend_and_keep(
        &self,
        level: BoxLevel<F::Region>,
        size: usize,
        (wanted, chunks): (bool, Option<Kept<F::Region>>),
        boxes: &mut BoxCounts,
    ) -> Result<Descended<F::Region>, MeshError<F::Error>> {
        let children = self.descend(&level, size / 2, boxes)?;
        let chunks = if wanted && size == CHUNK { Some((level.places, level.regions)) } else { chunks };
        Ok((children, chunks))
    }

    /// The children, of this size, of all boxes.
    fn descend(
        &self,
        level: &BoxLevel<F::Region>,
        size: usize,
        boxes: &mut BoxCounts,
    ) -> Result<BoxLevel<F::Region>, MeshError<F::Error>> {
        // Near the top there are few boxes, and each is costly.
        let group = if level.places.len() < 256 { 1 } else { 16 };
        let found = AtomicUsize::new(0);
        let of_group = |(places, regions): (&[[u32; 3]], &[F::Region])| {
            self.progress.ask()?;
            watch::take(BOX_BYTES * places.len());
            let children = self.children(places, regions, size)?;
            let before = found.fetch_add(children.regions.len(), Ordering::Relaxed);
            self.check(before + children.regions.len())?;
            Ok::<_, MeshError<F::Error>>(children)
        };
        let groups: Vec<BoxChildren<F::Region>> = scatter(|watches| {
            let groups = level.places.par_chunks(group).zip(level.regions.par_chunks(group));
            in_pieces(groups).map(|group| watches.hold(|| of_group(group))).collect::<Result<_, _>>()
        })?;
        let mut masks = Vec::with_capacity(level.places.len());
        let found = found.into_inner();
        watch::take(found * size_of::<(F::Region, [u32; 3])>());
        let mut regions = Vec::with_capacity(found);
        for mut children in groups {
            self.progress.breathe()?;
            masks.append(&mut children.masks);
            regions.append(&mut children.regions);
            boxes.add(children.boxes);
        }
        let (places, neighbours) = link((&level.places, &level.neighbours), &masks, self.progress)?;
        Ok(BoxLevel { places, regions, neighbours })
    }

    fn check(&self, bricks: usize) -> Result<(), MeshError<F::Error>> {
        let limit = self.limit;
        if bricks > limit { Err(MeshError::TooManyBricks { limit }) } else { Ok(()) }
    }

    /// The children of some boxes.
    fn children(
        &self,
        places: &[[u32; 3]],
        regions: &[F::Region],
        size: usize,
    ) -> Result<BoxChildren<F::Region>, MeshError<F::Error>> {
        span!("boxes");
        let mut children = BoxChildren {
            masks: Vec::with_capacity(places.len()),
            regions: Vec::with_capacity(4 * places.len()),
            boxes: BoxCounts::default(),
        };
        for (place, region) in places.iter().zip(regions) {
            self.divide_box(*place, region, size, &mut children)?;
        }
        Ok(children)
    }

    fn divide_box(
        &self,
        place: [u32; 3],
        region: &F::Region,
        size: usize,
        children: &mut BoxChildren<F::Region>,
    ) -> Result<(), MeshError<F::Error>> {
        let first =
            |child: usize| [0, 1, 2].map(|axis| (2 * place[axis] as usize + (child >> axis & 1)) * size);
        let in_lattice = |child: usize| (0..3).all(|axis| first(child)[axis] + 1 < self.axes[axis].len());
        let is_looked_at = |child: usize| self.scope.has(first(child), size);
        let bounds = |child: usize| box_of(self.axes, first(child), first(child).map(|index| index + size));
        let mut boxes = [Box3::default(); MAX_PARTS];
        let (mut which, mut firsts) = ([0; MAX_PARTS], [[0; 3]; MAX_PARTS]);
        let mut count = 0;
        for child in (0..8).filter(|&child| in_lattice(child) && is_looked_at(child)) {
            (boxes[count], which[count], firsts[count]) = (bounds(child), child, first(child));
            count += 1;
        }
        if count == 0 {
            children.masks.push(0);
            return Ok(());
        }
        let BoxChildren { masks, regions, boxes: counts } = children;
        let (before, mut mask, mut kept) = (regions.len(), 0_u8, 0);
        let (boxes, firsts) = (&boxes[..count], &firsts[..count]);
        let mut wants = |n: usize, range: Range| {
            let range = if self.is_passed(&firsts[n], size) { ANYTHING } else { range };
            let may_cross = self.may_cross(region, range, (firsts[n], size), counts);
            mask |= u8::from(may_cross) << which[n];
            kept += usize::from(may_cross);
            may_cross
        };
        if firsts.iter().all(|first| self.is_passed(first, size)) {
            (0..count).for_each(|n| _ = wants(n, ANYTHING));
            self.field.narrow(region, boxes, regions).map_err(MeshError::Field)?;
        } else {
            self.field.split(region, boxes, &mut wants, regions).map_err(MeshError::Field)?;
        }
        masks.push(mask);
        assert_eq!(regions.len(), before + kept, "a field gives each box a region");
        Ok(())
    }

    /// Whether the scope only passes through a box of this size that begins at this cell: such a box may be
    /// anything.
    fn is_passed(&self, first: &[usize; 3], size: usize) -> bool {
        self.scope.passes(*first, size, self.axes.each_ref().map(|axis| axis.len() - 1))
    }

    /// Whether the surface may cross a box, by the range of the field there. A NaN bound excludes nothing.
    fn may_cross(
        &self,
        around: &F::Region,
        [low, high]: [f32; 2],
        (first, size): ([usize; 3], usize),
        boxes: &mut BoxCounts,
    ) -> bool {
        boxes.examined += 1;
        let (inside, outside) = (low >= self.iso, high < self.iso);
        if !inside && !outside {
            return true;
        }
        let points = |axis: usize| (first[axis] + size).min(self.axes[axis].len()) - first[axis];
        let points = (0..3).fold(1_u64, |product, axis| product.saturating_mul(points(axis) as u64));
        let evaluations = self.field.work(around).evaluations.saturating_mul(points);
        boxes.spared = boxes.spared.saturating_add(evaluations);
        boxes.inside += u64::from(inside);
        boxes.outside += u64::from(!inside);
        if inside {
            for (axis, first) in first.into_iter().enumerate() {
                boxes.cut.low[axis] |= first == 0;
                boxes.cut.high[axis] |= first + size + 1 >= self.axes[axis].len();
            }
        }
        false
    }
}

/// Parents that are linked at a time.
const LINKED: usize = 1 << 8;

/// Places of boxes, and their neighbours.
type LinkedBoxes = (Vec<[u32; 3]>, Vec<[u32; 27]>);

/// The places of the remaining children, and their neighbours, from those of the boxes.
fn link<E: Error + Send + 'static>(
    (places, neighbours): (&[[u32; 3]], &[[u32; 27]]),
    masks: &[u8],
    progress: &Progress<'_>,
) -> Result<LinkedBoxes, MeshError<E>> {
    let firsts = starts(masks.iter().map(|mask| mask.count_ones() as usize));
    let of_child = |parent: usize, child: usize| {
        let place = [0, 1, 2].map(|axis| 2 * places[parent][axis] + (child >> axis & 1) as u32);
        let around = KIN[child].map(|(direction, kin)| {
            let parent = neighbours[parent][usize::from(direction)];
            if parent == NONE || masks[parent as usize] >> kin & 1 == 0 {
                return NONE;
            }
            let mask = masks[parent as usize];
            firsts[parent as usize] as u32 + (mask & ((1 << kin) - 1)).count_ones()
        });
        (place, around)
    };
    let count = firsts[masks.len()];
    let (mut all_places, mut all_neighbours) = (FilledVector::new(count)?, FilledVector::new(count)?);
    let places = all_places.parts(&firsts, LINKED, 1).into_iter();
    let parts: Vec<LinkedPart<'_>> = places.zip(all_neighbours.parts(&firsts, LINKED, 1)).collect();
    let of_part = |(index, (places, neighbours)): (usize, LinkedPart<'_>)| {
        progress.breathe()?;
        let mut children = places.open().iter_mut().zip(neighbours.open());
        let first = index * LINKED;
        for (parent, mask) in (first..).zip(&masks[first..]).take(LINKED) {
            let kept = (0..8).filter(|&child| mask >> child & 1 == 1);
            for (child, (place, around)) in kept.zip(&mut children) {
                (*place, *around) = of_child(parent, child);
            }
        }
        Ok::<_, MeshError<E>>(())
    };
    scatter(|_| parts.into_par_iter().enumerate().try_for_each(of_part))?;
    Ok((all_places.finish(), all_neighbours.finish()))
}

/// What the children of some boxes fill.
type LinkedPart<'a> = (VectorPart<'a, [u32; 3]>, VectorPart<'a, [u32; 27]>);

/// For each child and each direction: the direction of the neighbour's parent, and which child of that parent
/// the neighbour is.
static KIN: [[(u8, u8); 27]; 8] = {
    let mut kin = [[(0, 0); 27]; 8];
    let mut child = 0;
    while child < 8 {
        let mut direction = 0;
        while direction < 27 {
            let (mut parent, mut place) = (0, 0);
            let (mut axis, mut unit, mut rest) = (0, 1, direction);
            while axis < 3 {
                // From one before the first child to one after the second, counted from 1: parents are 0, 1,
                // 1, 2.
                let step = (child >> axis & 1) + rest % 3;
                parent += unit * usize::div_ceil(step, 2);
                place |= ((step + 1) % 2) << axis;
                (axis, unit, rest) = (axis + 1, 3 * unit, rest / 3);
            }
            kin[child][direction] = (parent as u8, place as u8);
            direction += 1;
        }
        child += 1;
    }
    kin
};

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;
    use crate::mesh::testing::PlainField;
    use crate::progress::EACH;

    /// The ball of radius 2 about the origin, by its square, with exact ranges of boxes.
    const BALL: PlainField = PlainField { value: |p| -p.map(|c| c * c).iter().sum::<f32>(), range: range_of };

    fn range_of(Box3 { low, high }: &Box3) -> [f32; 2] {
        let square = |of: fn(f32, f32) -> f32| (0..3).map(|a| of(low[a], high[a]).powi(2)).sum::<f32>();
        let most = -square(|low, high| low.max(-high).max(0.0));
        [-square(|low, high| low.abs().max(high.abs())), most]
    }

    /// Divides a lattice with so many cells along each axis, from -3 on, into bricks of 2^3 cells of 1/8.
    fn divided(cells: [usize; 3], limit: usize) -> Result<BrickDivision<()>, MeshError<Infallible>> {
        let axes = cells.map(|cells| (0..=cells).map(|index| -3.0 + 0.125 * index as f32).collect());
        let options = Options { iso: -4.0, brick: Some(2), ..Options::default() };
        let limits = BrickLimits { count: limit, ..BrickLimits::PIECES };
        divide(
            &BALL,
            axes,
            (&options, DivisionScope::Everything),
            limits,
            &Progress::new(&mut |_| true, EACH),
        )
    }

    #[test]
    fn the_limit_of_bricks_holds_at_its_value_and_one_past_it() {
        let count = divided([48; 3], usize::MAX).map(|division| division.bricks.len()).unwrap();
        assert!(count > 1000);
        assert!(divided([48; 3], count).is_ok());
        let limit = count - 1;
        assert_eq!(divided([48; 3], limit).err(), Some(MeshError::TooManyBricks { limit }));
        assert_eq!(divided([48; 3], 0).err(), Some(MeshError::TooManyBricks { limit: 0 }));
    }

    #[test]
    fn bricks_are_those_that_the_surface_may_be_in_and_know_each_other() {
        let BrickDivision { bricks, regions, boxes, chunks: _ } = divided([48, 31, 40], usize::MAX).unwrap();
        assert_eq!(bricks.len(), regions.len());
        assert!(boxes.examined > boxes.inside + boxes.outside && boxes.inside > 0 && boxes.outside > 0);
        // The lattice ends at y = 0.875 and z = 2.
        assert_eq!(boxes.cut, Sides { low: [false; 3], high: [false, true, false] });
        let mut expected = Vec::new();
        for (x, y, z) in (0..24).flat_map(|x| (0..16).flat_map(move |y| (0..20).map(move |z| (x, y, z)))) {
            let first = [x, y, z].map(|index| 2 * index);
            let [low, high] = range_of(&box_of(&bricks.axes, first, first.map(|index| index + 2)));
            if low < -4.0 && high >= -4.0 {
                expected.push([x, y, z].map(|index| index as u32));
            }
        }
        let morton = |place: &[u32; 3]| {
            (0..10).fold(0, |bits, bit| {
                (0..3).fold(bits, |bits, axis| bits | (place[axis] >> bit & 1) << (3 * bit + axis as u32))
            })
        };
        expected.sort_by_key(morton);
        assert_eq!(bricks.places, expected);
        let find = |place: [i64; 3]| {
            expected.iter().position(|other| other.map(i64::from) == place).map_or(NONE, |index| index as u32)
        };
        for (place, neighbours) in bricks.places.iter().zip(&bricks.neighbours).step_by(7) {
            for (direction, &neighbour) in neighbours.iter().enumerate() {
                let step = [direction % 3, direction / 3 % 3, direction / 9].map(|step| step as i64 - 1);
                assert_eq!(neighbour, find([0, 1, 2].map(|axis| i64::from(place[axis]) + step[axis])));
            }
        }
    }
}
