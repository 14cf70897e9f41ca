//! Pictures: rows of pixels.

/// Pixels of red, green, blue and opacity in eight bits each, as screens take them (sRGB; opacity is not
/// multiplied in): row by row from the top, from the left.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// A picture of these pixels. `None` if there are none, or not as many as the sides say.
    #[must_use]
    pub fn new(width: u32, height: u32, pixels: Vec<[u8; 4]>) -> Option<Self> {
        let fits = u64::from(width) * u64::from(height) == pixels.len() as u64;
        (fits && !pixels.is_empty()).then_some(Self { width, height, pixels })
    }

    /// Pixels of a row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// Red, green, blue and opacity of a pixel, the first one at the left and the top. Panics if there is no
    /// such pixel.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width && y < self.height, "a pixel of the picture");
        self.pixels[y as usize * self.width as usize + x as usize]
    }
}
