//! The part of a picture whose rays are traced together.

/// The approximate number of rays of a full tile.
const PACKET: u32 = 1024;

/// A part of a picture: its first column and row, and its size.
#[derive(Clone, Copy)]
pub struct TileArea {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

impl TileArea {
    /// The tiles of a picture, row by row. They do not depend on threads.
    pub fn all([width, height]: [u32; 2], antialias: u32) -> Vec<Self> {
        Self::of_rows(width, [0, height], antialias)
    }

    /// Pixels along a side of a full tile.
    pub fn side(antialias: u32) -> u32 {
        ((f64::from(PACKET).sqrt() / f64::from(antialias)) as u32).max(2)
    }

    /// The tiles of some rows of a picture, from the first one up to the end.
    pub fn of_rows(width: u32, [first, end]: [u32; 2], antialias: u32) -> Vec<Self> {
        let side = Self::side(antialias);
        let mut places = Vec::new();
        for y in (first..end).step_by(side as usize) {
            for x in (0..width).step_by(side as usize) {
                places.push(Self { x, y, width: side.min(width - x), height: side.min(end - y) });
            }
        }
        places
    }

    /// A pixel of the picture, by its index in the tile.
    pub fn pixel(&self, index: usize) -> [u32; 2] {
        [self.x + index as u32 % self.width, self.y + index as u32 / self.width]
    }
}
