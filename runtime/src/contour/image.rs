//! Images: which pixels of a rectangle are inside, the field there, or an attribute.
//!
//! ```text
//! +-----------+-----------+      squares of pixels whose range proves one side are filled, and none of their points is evaluated;
//! |           |  . .|#####|      where division does not pay any more, because few rows are left, pixels are evaluated with these rows;
//! |  outside  |. . #|#####|      the field itself is asked everywhere, but where nothing reaches it is constant
//! |           |-----+-----|
//! |           | . ##|#####|      pixels are asked in their middles, or in the middles of their equal parts
//! +-----------+-----------+
//! ```

use jbt_ir::limits::MAX_PIXELS;

use super::divide::{CellSquare, Divided, DivisionPlan, SquareWork, Verdict, divide};
use super::grid::{Grid, Rectangle};
use super::raster::{Raster, RasterTile};
use super::shade;
use super::slicer::{SliceError, Slicer};
use crate::boxes::{Box3, Range};
use crate::error::EvalError;
use crate::evaluator::Evaluator;
use crate::job::{Hook, Job};
use crate::picture::Picture;
use crate::polygonize::Fineness;
use crate::progress::{Progress, SOME};
use crate::prune::Region;
use crate::span::span;

/// The largest [`ImageDetail::samples`].
pub const MAX_SAMPLES: usize = 8;

/// Pixels along the side of the smallest squares that are evaluated point by point: such a square fills a
/// block of the engine, and is never smaller than this.
const SMALLEST: u32 = 4;

/// Pixels along the side of the smallest squares, for an engine that runs so many points together.
const fn smallest(block: usize) -> u32 {
    let mut side = SMALLEST;
    while ((side * side) as usize) < block {
        side *= 2;
    }
    side
}

/// Halvings of a side at once: 16 parts are asked about in one call.
const STEP: u32 = 2;
/// Points times ops of a square up to which its points are evaluated at once, because to divide it would take
/// longer: with 100 ops a point that is at 16 x 16 points, with 1,000 at 8 x 8.
const CHEAP: u64 = 100_000;
/// The same for each table of the program: to ask about a part takes a look at every table, whether it has
/// rows or not.
const CHEAP_FOR_A_TABLE: u64 = 12_000;

/// How finely an image is made.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ImageDetail {
    /// The pixels, along the longer side of the rectangle or by their edge.
    pub fineness: Fineness,
    /// Points along the side of a pixel, 1 to [`MAX_SAMPLES`]: the image is smooth where there are several.
    /// Images of the field take one.
    pub samples: usize,
}

impl Default for ImageDetail {
    /// 512 pixels along the longer side, one point each.
    fn default() -> Self {
        Self { fineness: Fineness::Resolution(512), samples: 1 }
    }
}

/// What an image shows.
#[derive(Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ImageMode {
    /// White inside, black outside.
    Inside,
    /// The field, from blue outside over white at the iso-value to red inside, each as far as the field goes
    /// there; the contour is dark.
    Field,
    /// The field from black (the lowest) to white (the highest); the contour is red.
    Grey,
    /// The field as a landscape, lit from above on the left; the solid is brown, the contour dark.
    Height,
    /// An attribute inside, nothing (transparent) outside. One channel is grey, two are red and green, of
    /// more the first three are red, green and blue: 0 to 1, as they are.
    Attribute(String),
}

/// A grid of points, `samples` x `samples` in each pixel.
struct Canvas<'a> {
    slicer: &'a Slicer,
    grid: Grid,
    samples: usize,
}

impl<'a> Canvas<'a> {
    fn new(slicer: &'a Slicer, rectangle: &Rectangle, detail: &ImageDetail) -> Result<Self, SliceError> {
        let samples = detail.samples;
        if !(1..=MAX_SAMPLES).contains(&samples) {
            return Err(SliceError::Samples { samples });
        }
        let grid = Grid::pixels(&slicer.local(rectangle)?, detail.fineness, samples)?;
        let grid = grid.ok_or(SliceError::TooManyPixels { limit: MAX_PIXELS })?;
        Ok(Self { slicer, grid, samples })
    }

    fn pixels(&self) -> [usize; 2] {
        self.grid.points().map(|points| points / self.samples)
    }

    fn plan(&self) -> DivisionPlan<'static> {
        let leaf = smallest(self.slicer.field.block());
        let cells = self.pixels().map(|pixels| pixels as u32);
        DivisionPlan { cells, leaf, step: STEP, keep: false, touched: None }
    }

    /// The points of a square: the first one, and those behind the last one.
    fn points(&self, square: &CellSquare) -> [[u32; 2]; 2] {
        [square.first, square.end].map(|pixel| pixel.map(|index| index * self.samples as u32))
    }

    fn bounds(&self, square: &CellSquare) -> Box3 {
        let [first, end] = self.points(square);
        self.slicer.bounds(self.grid.bounds(first, end.map(|end| end - 1)))
    }

    fn block(&self, square: &CellSquare) -> [Vec<f32>; 2] {
        let [first, end] = self.points(square);
        self.grid.block(first, end)
    }

    /// Whether the points of a square are evaluated sooner than it is divided.
    fn is_cheap(&self, square: &CellSquare, region: &Region) -> bool {
        let points = (self.samples * self.samples) as u64 * u64::from(square.size) * u64::from(square.size);
        let tables = self.slicer.field.program().function().tables.len() as u64;
        points.saturating_mul(self.slicer.field.ops_in(region)) <= CHEAP + CHEAP_FOR_A_TABLE * tables
    }

    /// The pixel (in its square) of each of the points of a square, in their order.
    fn pixel_of_points(&self, square: &CellSquare) -> impl Iterator<Item = usize> {
        let [width, height] = [0, 1].map(|axis| (square.end[axis] - square.first[axis]) as usize);
        let samples = self.samples;
        (0..height * samples).flat_map(move |row| {
            (0..width * samples).map(move |column| row / samples * width + column / samples)
        })
    }

    fn raster<T: Copy>(&self, divided: &Divided<RasterTile<T>>, value: T) -> Raster<T> {
        span!("raster");
        let [width, height] = self.pixels();
        let mut raster = Raster::new(width, height, value);
        divided.pieces.iter().for_each(|tile| raster.put(tile));
        raster
    }
}

fn tile<T>(square: &CellSquare, values: Vec<T>) -> RasterTile<T> {
    RasterTile { square: *square, values }
}

/// Which part of each pixel is inside, of 255.
struct PixelCoverage<'a>(Canvas<'a>);

impl SquareWork for PixelCoverage<'_> {
    type Piece = RasterTile<u8>;

    fn bounds(&self, square: &CellSquare) -> Box3 {
        self.0.bounds(square)
    }

    fn verdict(&self, range: Range) -> Verdict {
        Verdict::of(range, self.0.slicer.iso)
    }

    fn dropped(
        &self,
        square: &CellSquare,
        inside: bool,
        _: &Region,
        tiles: &mut Vec<RasterTile<u8>>,
    ) -> Result<(), EvalError> {
        if inside {
            tiles.push(tile(square, vec![u8::MAX]));
        }
        Ok(())
    }

    fn is_told(&self, square: &CellSquare, region: &Region) -> bool {
        self.0.is_cheap(square, region)
    }

    fn leaf(
        &self,
        square: &CellSquare,
        region: &Region,
    ) -> Result<(Option<RasterTile<u8>>, bool), SliceError> {
        let [u, v] = self.0.block(square);
        let mut values = Vec::new();
        self.0.slicer.values(region, [&u, &v], &mut values)?;
        let iso = self.0.slicer.iso;
        if self.0.samples == 1 {
            let side = |&value: &f32| if value >= iso { u8::MAX } else { 0 };
            return Ok((Some(tile(square, values.iter().map(side).collect())), false));
        }
        let points = self.0.samples * self.0.samples;
        let mut counts = vec![0_usize; values.len() / points];
        for (pixel, value) in self.0.pixel_of_points(square).zip(&values) {
            counts[pixel] += usize::from(*value >= iso);
        }
        let share = |count: &usize| ((count * 255 + points / 2) / points) as u8;
        Ok((Some(tile(square, counts.iter().map(share).collect())), false))
    }
}

/// The field in the middle of each pixel.
struct PixelFields<'a>(Canvas<'a>);

impl SquareWork for PixelFields<'_> {
    type Piece = RasterTile<f32>;

    fn bounds(&self, square: &CellSquare) -> Box3 {
        self.0.bounds(square)
    }

    /// All values are wanted, but where there is only one. A zero may have either sign, but has the same all
    /// over the square: rows that do not reach it add nothing, and nothing adds -0.
    fn verdict(&self, [low, high]: Range) -> Verdict {
        if low == high { Verdict::Outside } else { Verdict::Open }
    }

    fn dropped(
        &self,
        square: &CellSquare,
        _: bool,
        around: &Region,
        tiles: &mut Vec<RasterTile<f32>>,
    ) -> Result<(), EvalError> {
        let [u, v] = self.0.block(&CellSquare { end: square.first.map(|pixel| pixel + 1), ..*square });
        let mut values = Vec::new();
        self.0.slicer.values(around, [&u, &v], &mut values)?;
        tiles.push(tile(square, values));
        Ok(())
    }

    fn is_told(&self, square: &CellSquare, region: &Region) -> bool {
        self.0.is_cheap(square, region)
    }

    fn leaf(
        &self,
        square: &CellSquare,
        region: &Region,
    ) -> Result<(Option<RasterTile<f32>>, bool), SliceError> {
        let [u, v] = self.0.block(square);
        let mut values = Vec::new();
        self.0.slicer.values(region, [&u, &v], &mut values)?;
        Ok((Some(tile(square, values)), false))
    }
}

/// An attribute where a pixel is inside: its channels (red, green and blue), and the part that is inside.
struct Painted<'a> {
    canvas: Canvas<'a>,
    evaluator: &'a Evaluator,
    /// The planes of the three channels among the answers; none is 0.
    planes: [Option<usize>; 3],
}

impl SquareWork for Painted<'_> {
    type Piece = RasterTile<[f32; 4]>;

    fn bounds(&self, square: &CellSquare) -> Box3 {
        self.canvas.bounds(square)
    }

    fn verdict(&self, range: Range) -> Verdict {
        match Verdict::of(range, self.canvas.slicer.iso) {
            Verdict::Outside => Verdict::Outside,
            Verdict::Inside | Verdict::Open => Verdict::Open,
        }
    }

    fn dropped(
        &self,
        _: &CellSquare,
        _: bool,
        _: &Region,
        _: &mut Vec<RasterTile<[f32; 4]>>,
    ) -> Result<(), EvalError> {
        Ok(())
    }

    fn is_told(&self, square: &CellSquare, region: &Region) -> bool {
        self.canvas.is_cheap(square, region)
    }

    fn leaf(
        &self,
        square: &CellSquare,
        region: &Region,
    ) -> Result<(Option<RasterTile<[f32; 4]>>, bool), SliceError> {
        let [u, v] = self.canvas.block(square);
        let mut planes = vec![vec![0.0; u.len()]; self.evaluator.layout().names().len()];
        let mut answers: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
        self.canvas.slicer.eval(self.evaluator, region, [&u, &v], &mut answers)?;
        let points = self.canvas.samples * self.canvas.samples;
        let mut pixels = vec![[0.0_f32; 4]; u.len() / points];
        for (point, pixel) in self.canvas.pixel_of_points(square).enumerate() {
            if planes[0][point] >= self.canvas.slicer.iso {
                let [r, g, b] = self.planes.map(|plane| plane.map_or(0.0, |plane| planes[plane][point]));
                pixels[pixel].iter_mut().zip([r, g, b, 1.0]).for_each(|(sum, value)| *sum += value);
            }
        }
        for [r, g, b, count] in &mut pixels {
            if *count > 0.0 {
                (*r, *g, *b) = (*r / *count, *g / *count, *b / *count);
            }
            *count /= points as f32;
        }
        Ok((Some(tile(square, pixels)), false))
    }
}

impl Slicer {
    /// Which pixels of a rectangle are inside: 255 for those that are, 0 for those that are not, and with
    /// several samples the part of 255.
    ///
    /// The same for any number of threads, and at each point what the field there says.
    ///
    /// # Errors
    /// See [`SliceError`].
    pub fn inside(&self, rectangle: &Rectangle, detail: &ImageDetail) -> Job<'_, Raster<u8>, SliceError> {
        let (rectangle, detail) = (*rectangle, *detail);
        Job::new(move |hook| self.inside_hooked(&rectangle, &detail, hook))
    }

    fn inside_hooked(
        &self,
        rectangle: &Rectangle,
        detail: &ImageDetail,
        hook: Hook<'_>,
    ) -> Result<Raster<u8>, SliceError> {
        let work = PixelCoverage(Canvas::new(self, rectangle, detail)?);
        let divided = divide(&self.pruner, &work, work.0.plan(), &Progress::new(hook, SOME))?;
        Ok(work.0.raster(&divided, 0))
    }

    /// The field in the middle of each pixel of a rectangle.
    ///
    /// # Errors
    /// See [`SliceError`].
    pub fn field_values(
        &self,
        rectangle: &Rectangle,
        fineness: Fineness,
    ) -> Job<'_, Raster<f32>, SliceError> {
        let rectangle = *rectangle;
        Job::new(move |hook| self.values_hooked(&rectangle, fineness, hook))
    }

    fn values_hooked(
        &self,
        rectangle: &Rectangle,
        fineness: Fineness,
        hook: Hook<'_>,
    ) -> Result<Raster<f32>, SliceError> {
        let work = PixelFields(Canvas::new(self, rectangle, &ImageDetail { fineness, samples: 1 })?);
        let divided = divide(&self.pruner, &work, work.0.plan(), &Progress::new(hook, SOME))?;
        Ok(work.0.raster(&divided, 0.0))
    }

    /// An attribute inside: red, green, blue, and which part of the pixel is inside.
    fn painted(
        &self,
        rectangle: &Rectangle,
        name: &str,
        detail: &ImageDetail,
        hook: Hook<'_>,
    ) -> Result<Raster<[f32; 4]>, SliceError> {
        let (evaluator, first, width) = self.attribute(name)?;
        let planes = match width {
            1 => [Some(first); 3],
            2 => [Some(first), Some(first + 1), None],
            _ => [0, 1, 2].map(|channel| Some(first + channel)),
        };
        let work = Painted { canvas: Canvas::new(self, rectangle, detail)?, evaluator, planes };
        let divided = divide(&self.pruner, &work, work.canvas.plan(), &Progress::new(hook, SOME))?;
        Ok(work.canvas.raster(&divided, [0.0; 4]))
    }

    /// An image of a rectangle.
    ///
    /// # Errors
    /// See [`SliceError`].
    pub fn picture(
        &self,
        rectangle: &Rectangle,
        mode: &ImageMode,
        detail: &ImageDetail,
    ) -> Job<'_, Picture, SliceError> {
        let (rectangle, mode, detail) = (*rectangle, mode.clone(), *detail);
        Job::new(move |hook| self.picture_hooked(&rectangle, &mode, &detail, hook))
    }

    fn picture_hooked(
        &self,
        rectangle: &Rectangle,
        mode: &ImageMode,
        detail: &ImageDetail,
        hook: Hook<'_>,
    ) -> Result<Picture, SliceError> {
        let shade = match mode {
            ImageMode::Inside => return Ok(shade::mask(&self.inside_hooked(rectangle, detail, hook)?)),
            ImageMode::Attribute(name) => {
                return Ok(shade::paint(&self.painted(rectangle, name, detail, hook)?));
            }
            ImageMode::Field => shade::diverging,
            ImageMode::Grey => shade::grey,
            ImageMode::Height => shade::relief,
        };
        Ok(shade(&self.values_hooked(rectangle, detail.fineness, hook)?, self.iso))
    }
}
