//! The part of a picture whose rays are traced together.

/// The approximate number of rays of a full tile.
const PACKET: u32 = 1024;
/// Pixels along the side of a block whose rays are neighbours in a packet.
const BLOCK: u32 = 8;

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

    /// The rows of the tile's blocks: the first pixel of each, and its length. One block follows the other.
    pub fn block_rows(&self) -> impl Iterator<Item = ([u32; 2], u32)> {
        let Self { x: left, y: top, width, height } = *self;
        (0..height).step_by(BLOCK as usize).flat_map(move |y| {
            (0..width).step_by(BLOCK as usize).flat_map(move |x| {
                let length = BLOCK.min(width - x);
                (y..(y + BLOCK).min(height)).map(move |row| ([left + x, top + row], length))
            })
        })
    }

    /// The pixels of the tile, block by block: neighbours in the list are neighbours in the picture.
    pub fn pixels(&self) -> Vec<[u32; 2]> {
        let mut pixels = Vec::with_capacity((self.width * self.height) as usize);
        self.block_rows()
            .for_each(|([x, y], length)| pixels.extend((x..x + length).map(|column| [column, y])));
        pixels
    }

    /// The smallest part of the tile that holds some pixels of it; at least one.
    pub fn around(&self, pixels: &[[u32; 2]]) -> Self {
        let end = |[x, y]: [u32; 2]| [x + 1, y + 1];
        let (low, high) = pixels.iter().fold(([u32::MAX; 2], [self.x, self.y]), |(low, high), &pixel| {
            (
                [0, 1].map(|axis| low[axis].min(pixel[axis])),
                [0, 1].map(|axis| high[axis].max(end(pixel)[axis])),
            )
        });
        Self { x: low[0], y: low[1], width: high[0] - low[0], height: high[1] - low[1] }
    }
}
