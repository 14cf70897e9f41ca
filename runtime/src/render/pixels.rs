//! Vectors that have a value for each pixel.

use super::error::RenderError;
use crate::mesh::room;

/// This value for each of some pixels.
pub fn of_pixels<T: Clone>(pixels: usize, value: T) -> Result<Vec<T>, RenderError> {
    let mut values = room(pixels)?;
    values.resize(pixels, value);
    Ok(values)
}
