//! Numbers for pixels, which tiles of squares fill.

use super::divide::CellSquare;

/// Numbers for the pixels of a rectangle: row by row, from above.
#[derive(Clone, PartialEq, Debug)]
pub struct Raster<T> {
    /// Pixels along u.
    pub width: usize,
    /// Pixels along v.
    pub height: usize,
    /// One for each pixel.
    pub values: Vec<T>,
}

impl<T: Copy> Raster<T> {
    pub(super) fn new(width: usize, height: usize, value: T) -> Self {
        Self { width, height, values: vec![value; width * height] }
    }

    /// Writes the pixels of a tile, whose rows go upwards.
    pub(super) fn put(&mut self, tile: &RasterTile<T>) {
        let [first, end] =
            [tile.square.first, tile.square.end].map(|pixel| pixel.map(|index| index as usize));
        let width = end[0] - first[0];
        for row in first[1]..end[1] {
            let start = (self.height - 1 - row) * self.width + first[0];
            let pixels = &mut self.values[start..start + width];
            match &tile.values[..] {
                [one] => pixels.fill(*one),
                values => pixels.copy_from_slice(&values[(row - first[1]) * width..][..width]),
            }
        }
    }
}

/// A square of pixels: one number for each, or one for all.
pub(super) struct RasterTile<T> {
    pub(super) square: CellSquare,
    pub(super) values: Vec<T>,
}
