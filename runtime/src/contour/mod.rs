//! Contours and images: what a model is like in a plane.
//!
//! ```text
//!        ,-----.                 a plane through the model, a rectangle in it, a resolution;
//!      ,'  ,-.  `.    ,-.        the contour field = iso as closed loops: outer ones counter-clockwise,
//!     (   (   )   )  (   )       holes clockwise, so that the inside is on the left;
//!      `.  `-'  ,'    `-'        or an image of the field, of its sides, of an attribute
//!        `-----'
//! ```
//!
//! ```
//! use jbt::contour::{Detail, Plane, Slicer};
//! use jbt::{Compiler, Query};
//! let tree = jbt::text::parse(b"jbt 1 ring { ring_radius 1 radius 0.5 }", &Default::default()).unwrap().check().unwrap();
//! let slicer = Slicer::new(&Compiler::new(), &tree, &Plane::default(), Query::FIELD).unwrap(); // once
//! let contour = slicer.contour(&slicer.rectangle().unwrap(), &Detail::default()).run().unwrap(); // many times
//! let holes: Vec<bool> = contour.loops.iter().map(|one| one.is_hole).collect();
//! assert_eq!(holes, [false, true]);
//! assert_eq!(contour.loops[1].parent, Some(0));
//! ```
//!
//! In pseudo-code:
//!
//! ```text
//!     squares  = divide the lattice; drop squares that are inside or outside as a whole     (divide)
//!     segments = the cells that the contour crosses, by the signs of their four corners     (cells)
//!     vertex   = the root of the field on a crossed edge of the lattice                     (roots)
//!     loops    = segments from end to end; which one is in which                            (link)
//! ```
//!
//! Time and memory grow with the length of the contour. Every crossed edge of the lattice has one vertex,
//! strictly inside of the edge (unless f32 has no number there), and every vertex is used once: loops neither
//! cross nor touch themselves or each other. The result is the same to the bit for any number of threads and
//! any size of squares.
//!
//! **The border.** Beyond the rectangle everything counts as outside. So where the rectangle cuts the solid,
//! loops are closed along its border, and the area is that of the part in the rectangle. `Contour::cut_sides`
//! says where that is so.

mod cells;
mod circles;
mod divide;
mod grid;
mod image;
mod kept;
mod link;
mod plane;
mod raster;
mod roots;
mod shade;
mod slicer;

use std::sync::atomic::{AtomicU64, Ordering};

use jbt_ir::limits::MAX_CONTOUR_VERTICES;

pub use circles::circles;
pub use divide::{ContourLevel, DividedSquare, Fate};
pub use grid::{ContourLattice, Rectangle, RectangleError};
pub use image::{ImageDetail, ImageMode, MAX_SAMPLES};
pub use link::Loop;
pub use plane::{Plane, PlaneError};
pub use raster::Raster;
pub use slicer::{SliceError, Slicer};

pub(crate) use kept::KeptContour;

use cells::{CellBlock, Segments, along_border, border};
use divide::{CellSquare, Divided, DivisionPlan, SquareWork, Verdict, divide};
use grid::Grid;

use crate::boxes::{Box3, Range};
use crate::error::EvalError;
use crate::job::{Hook, Job};
use crate::mesh::Attribute;
use crate::polygonize::Fineness;
use crate::progress::{Progress, SOME};
use crate::prune::Region;
use crate::span::span;
use crate::touched::Touched;

/// The largest [`Detail::block`].
pub const MAX_BLOCK: usize = 64;

/// How finely a contour is made.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Detail {
    /// The cells of the lattice, along the longer side of the rectangle or by their edge.
    pub fineness: Fineness,
    /// Cells along the side of the squares at which division ends, a power of two up to [`MAX_BLOCK`]. It
    /// changes what is evaluated, but no bit of the contour. `None`: 8. 1 is the classic quadtree, down to
    /// single cells.
    pub block: Option<usize>,
    /// Whether to divide squares into four parts, and to keep all of them: the quadtree, for pictures. Else
    /// squares are divided into sixteen, which is faster.
    pub quadtree: bool,
}

/// The contour of a model in a rectangle of a plane: see the module.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Contour {
    /// Where the coordinates of vertices and squares count from, in coordinates of the plane: see
    /// [`Slicer::origin`].
    pub origin: [f64; 2],
    /// Where the vertices are, in coordinates of the plane from the origin, loop by loop.
    pub positions: Vec<[f32; 2]>,
    /// What the vertices have, if attributes were asked for.
    pub attributes: Vec<Attribute>,
    /// The loops, by their lowest vertices, from below.
    pub loops: Vec<Loop>,
    /// The rectangle of the lattice: that which was asked for, or a little more, to the right and above.
    pub rectangle: Rectangle,
    /// The edge of a cell.
    pub cell: f64,
    /// Cells along u and v.
    pub cells: [usize; 2],
    /// The sides of the rectangle that cut the solid: left, below, right, above.
    pub cut_sides: [bool; 4],
    /// How many squares there are of each size, and what became of them.
    pub levels: Vec<ContourLevel>,
    /// The squares, if they were to be kept: those that were divided before their parts.
    pub squares: Vec<DividedSquare>,
}

impl Contour {
    /// The area of the slice, in square units of the model.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.loops.iter().map(|one| one.area).sum()
    }

    /// The length of all loops, in units of the model; with the parts along the border, where it cuts the
    /// solid.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.loops.iter().map(|one| one.length).sum()
    }

    /// Loops that are holes.
    #[must_use]
    pub fn holes(&self) -> usize {
        self.loops.iter().filter(|one| one.is_hole).count()
    }

    /// The mean of an attribute over the vertices of a loop, channel by channel.
    #[must_use]
    pub fn mean(&self, attribute: &Attribute, one: &Loop) -> Vec<f32> {
        let width = attribute.width;
        let mut sums = vec![0.0_f64; width];
        for values in attribute.values[one.start * width..one.end * width].chunks_exact(width) {
            sums.iter_mut().zip(values).for_each(|(sum, &value)| *sum += f64::from(value));
        }
        sums.into_iter().map(|sum| (sum / (one.end - one.start) as f64) as f32).collect()
    }
}

impl Detail {
    /// Cells along the side of the smallest squares.
    fn leaf(&self) -> Result<u32, SliceError> {
        let block = self.block.unwrap_or(8);
        let fits = block.is_power_of_two() && block <= MAX_BLOCK;
        if fits { Ok(block as u32) } else { Err(SliceError::Block { block }) }
    }
}

/// What a contour is made of, square by square.
struct Contouring<'a> {
    slicer: &'a Slicer,
    grid: &'a Grid,
    /// Cells along the side of the smallest squares.
    leaf: u32,
    /// Whether all segments are to be told by the smallest squares, so that each of these may be replaced,
    /// and which ones are wanted. Otherwise the border of a larger square comes in one piece.
    by_leaves: Option<Option<&'a Touched<2>>>,
    vertices: AtomicU64,
}

/// The segments in a square, and the lowest cell of the square.
type ContourPiece = ([u32; 2], Segments);

impl Contouring<'_> {
    fn counted(&self, segments: Segments) -> Result<Segments, SliceError> {
        let count = segments.list.len() as u64;
        if self.vertices.fetch_add(count, Ordering::Relaxed) + count > MAX_CONTOUR_VERTICES {
            return Err(SliceError::TooManyVertices { limit: MAX_CONTOUR_VERTICES });
        }
        Ok(segments)
    }

    /// Divides the lattice.
    fn run(&self, detail: &Detail, progress: &Progress<'_>) -> Result<Divided<ContourPiece>, SliceError> {
        let plan = DivisionPlan {
            cells: self.grid.points().map(|points| points as u32 - 1),
            leaf: self.leaf,
            step: if detail.quadtree { 1 } else { 2 },
            keep: detail.quadtree,
            touched: self.by_leaves.flatten(),
        };
        divide(&self.slicer.pruner, self, plan, progress)
    }
}

impl SquareWork for Contouring<'_> {
    type Piece = ContourPiece;

    fn bounds(&self, square: &CellSquare) -> Box3 {
        self.slicer.bounds(self.grid.bounds(square.first, square.end))
    }

    fn verdict(&self, range: Range) -> Verdict {
        Verdict::of(range, self.slicer.iso)
    }

    fn dropped(
        &self,
        square: &CellSquare,
        inside: bool,
        around: &Region,
        pieces: &mut Vec<ContourPiece>,
    ) -> Result<(), EvalError> {
        if !inside {
            return Ok(());
        }
        let parts = match self.by_leaves {
            None => vec![*square],
            Some(touched) => along_border(square, self.leaf, (self.grid, touched)),
        };
        for part in parts {
            pieces.extend(
                border(self.slicer, self.grid, &part, around)?.map(|segments| (part.first, segments)),
            );
        }
        Ok(())
    }

    fn is_told(&self, _: &CellSquare, _: &Region) -> bool {
        false
    }

    fn leaf(&self, square: &CellSquare, region: &Region) -> Result<(Option<ContourPiece>, bool), SliceError> {
        span!("square");
        let segments = CellBlock::new(self.slicer, self.grid, square, region)?.segments(region)?;
        if segments.list.is_empty() {
            return Ok((None, false));
        }
        Ok((Some((square.first, self.counted(segments)?)), true))
    }
}

impl Slicer {
    /// The contour in a rectangle of the plane.
    ///
    /// # Errors
    /// See [`SliceError`].
    ///
    /// # Panics
    /// If the field has two values at one point, or leaves a range of its own: a defect of jbt.
    pub fn contour(&self, rectangle: &Rectangle, detail: &Detail) -> Job<'_, Contour, SliceError> {
        let (rectangle, detail) = (*rectangle, *detail);
        Job::new(move |hook| self.contour_hooked(&self.lattice(&rectangle, detail.fineness)?, &detail, hook))
    }

    /// The contour over a lattice, as that of a [live contour](crate::LiveContour). Of the detail, the
    /// fineness is not asked.
    ///
    /// # Errors
    /// See [`SliceError`].
    ///
    /// # Panics
    /// As [`contour`](Self::contour).
    pub fn contour_over<'a>(
        &'a self,
        lattice: &'a ContourLattice,
        detail: &Detail,
    ) -> Job<'a, Contour, SliceError> {
        let detail = *detail;
        Job::new(move |hook| self.contour_hooked(lattice, &detail, hook))
    }

    /// The lattice of a contour in a rectangle of the plane.
    ///
    /// # Errors
    /// A lattice that cannot be, or is beyond a limit.
    pub fn lattice(&self, rectangle: &Rectangle, fineness: Fineness) -> Result<ContourLattice, SliceError> {
        Ok(ContourLattice::covering(&self.local(rectangle)?, fineness)?)
    }

    /// The lattice with the same cells that covers a rectangle of the plane as well.
    pub(crate) fn grown(
        &self,
        lattice: &ContourLattice,
        rectangle: &Rectangle,
    ) -> Result<ContourLattice, SliceError> {
        Ok(lattice.grown(&self.local(rectangle)?)?)
    }

    fn contour_hooked(
        &self,
        lattice: &ContourLattice,
        detail: &Detail,
        hook: Hook<'_>,
    ) -> Result<Contour, SliceError> {
        let grid = Grid::corners(lattice);
        let vertices = AtomicU64::new(0);
        let work = Contouring { slicer: self, grid: &grid, leaf: detail.leaf()?, by_leaves: None, vertices };
        let divided = work.run(detail, &Progress::new(hook, SOME))?;
        let squares = divided.squares.iter().map(|(square, depth, fate)| {
            let [low, high] = grid.bounds(square.first, square.end);
            DividedSquare { low, high, depth: *depth, fate: *fate }
        });
        let squares = squares.collect();
        let pieces = divided.pieces.iter().map(|(_, segments)| segments);
        let outline = self.outline(&grid)?;
        Ok(Contour { levels: divided.levels, squares, ..self.linked(&grid, outline, pieces) })
    }

    /// The rectangle of a lattice.
    fn outline(&self, grid: &Grid) -> Result<Rectangle, RectangleError> {
        let corner = |end: fn(&Vec<f32>) -> Option<&f32>| {
            grid.axes.each_ref().map(|axis| f64::from(*end(axis).expect("it has a cell")))
        };
        Rectangle::new(corner(|axis| axis.first()), corner(|axis| axis.last()))?.moved(self.origin())
    }

    /// How many planes of attributes there are.
    fn planes(&self) -> usize {
        self.attributes().map(|(_, width)| width).sum()
    }

    /// The contour of all segments over a lattice.
    fn linked<'a>(
        &self,
        grid: &Grid,
        outline: Rectangle,
        pieces: impl Iterator<Item = &'a Segments> + Clone,
    ) -> Contour {
        let cells = grid.points().map(|points| points - 1);
        let cut_sides = cut_sides(pieces.clone(), cells);
        let linked = link::link(pieces, self.planes());
        Contour {
            attributes: self.interleaved(&linked.attributes, linked.positions.len()),
            positions: linked.positions,
            loops: linked.loops,
            origin: self.origin(),
            rectangle: outline,
            cell: grid.spacing,
            cells,
            cut_sides,
            levels: Vec::new(),
            squares: Vec::new(),
        }
    }

    /// Attributes from their planes.
    fn interleaved(&self, planes: &[Vec<f32>], vertices: usize) -> Vec<Attribute> {
        let mut planes = planes.iter();
        let attribute = |(name, width): (&str, usize)| {
            let mine: Vec<&Vec<f32>> = planes.by_ref().take(width).collect();
            let values = (0..vertices).flat_map(|vertex| mine.iter().map(move |plane| plane[vertex]));
            Attribute { name: name.to_owned(), width, values: values.collect() }
        };
        self.attributes().map(attribute).collect()
    }
}

/// The sides of the lattice with a point inside: left, below, right, above.
fn cut_sides<'a>(pieces: impl Iterator<Item = &'a Segments>, cells: [usize; 2]) -> [bool; 4] {
    let mut sides = [false; 4];
    for segment in pieces.flat_map(|piece| &piece.list).filter(|segment| segment.border) {
        let axis = segment.from.axis();
        let place = if axis == 0 { segment.from.column() } else { segment.from.row() };
        sides[if place == 0 { axis } else { 2 + axis }] |= place == 0 || place as usize == cells[axis] + 1;
    }
    sides
}
