//! PNG: pictures.

use std::io::{self, Write};

/// A picture: red, green, blue and alpha of 8 bits, row by row from above.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The pixels; `width * height` of them.
    pub pixels: Vec<[u8; 4]>,
}

/// Writes a picture. What is opaque everywhere has no alpha in the file.
///
/// # Errors
/// Those of the writer, and a picture without pixels, with another number of them than its sides say, or with sides that are more than 2^31 - 1.
pub fn write_png(picture: &Picture, out: &mut dyn Write) -> io::Result<()> {
    let wrong =
        || io::Error::new(io::ErrorKind::InvalidInput, "the sides of the picture do not fit its pixels");
    let side = |length: usize| u32::try_from(length).ok().filter(|&side| side > 0).ok_or_else(wrong);
    let (width, height) = (side(picture.width)?, side(picture.height)?);
    if picture.width.checked_mul(picture.height) != Some(picture.pixels.len()) {
        return Err(wrong());
    }
    let opaque = picture.pixels.iter().all(|pixel| pixel[3] == u8::MAX);
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    let bytes: Vec<u8> = if opaque {
        picture.pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
    } else {
        picture.pixels.as_flattened().to_vec()
    };
    let failed = |error: png::EncodingError| match error {
        png::EncodingError::IoError(error) => error,
        other => io::Error::new(io::ErrorKind::InvalidInput, other.to_string()),
    };
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(&bytes).map_err(failed)?;
    writer.finish().map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes a picture and reads it back.
    fn round(picture: &Picture) -> (png::ColorType, Vec<u8>) {
        let mut file = Vec::new();
        write_png(picture, &mut file).unwrap();
        assert!(file.starts_with(b"\x89PNG\r\n\x1a\n"));
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width as usize, info.height as usize), (picture.width, picture.height));
        (info.color_type, bytes)
    }

    #[test]
    fn pictures_come_back() {
        let opaque = Picture { width: 2, height: 1, pixels: vec![[1, 2, 3, 255], [4, 5, 6, 255]] };
        assert_eq!(round(&opaque), (png::ColorType::Rgb, vec![1, 2, 3, 4, 5, 6]));
        let clear = Picture { width: 1, height: 2, pixels: vec![[1, 2, 3, 0], [4, 5, 6, 255]] };
        assert_eq!(round(&clear), (png::ColorType::Rgba, vec![1, 2, 3, 0, 4, 5, 6, 255]));
    }

    #[test]
    fn pictures_without_pixels_or_with_wrong_sides_are_errors() {
        for (width, height, count) in [(0, 1, 0), (1, 0, 0), (2, 2, 3), (usize::MAX, 2, 4)] {
            let picture = Picture { width, height, pixels: vec![[0; 4]; count] };
            let error = write_png(&picture, &mut Vec::new()).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidInput);
        }
    }
}
