//! Pictures as Portable Network Graphics: eight bits a channel, in the colours of screens (sRGB), as small as
//! the format's own filters and compression make them.

use std::io::{self, Write};

use jbt_ir::memory::room;

use crate::picture::Picture;
use crate::span::span;

/// How much trouble a file of a picture takes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum PngEffort {
    /// As little as can be: the file is about a third larger.
    Quick,
    /// As small as the compression of the format gets it.
    #[default]
    Small,
}

/// Writes a picture, as small as can be: see [`write_png_with`].
///
/// # Errors
/// Those of the writer.
pub fn write_png(picture: &Picture, out: &mut dyn Write) -> io::Result<()> {
    write_png_with(picture, PngEffort::Small, out)
}

/// Writes a picture. What is opaque everywhere has no opacity in the file. The same picture gives the same
/// bytes.
///
/// # Errors
/// Those of the writer.
pub fn write_png_with(picture: &Picture, effort: PngEffort, out: &mut dyn Write) -> io::Result<()> {
    span!("bytes");
    let opaque = picture.pixels().iter().all(|pixel| pixel[3] == u8::MAX);
    let mut encoder = png::Encoder::new(out, picture.width(), picture.height());
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(match effort {
        PngEffort::Quick => png::Compression::Fast,
        PngEffort::Small => png::Compression::High,
    });
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header().map_err(plain)?;
    if opaque {
        let pixels = picture.pixels();
        let bytes = room::<u8>(3 * pixels.len());
        let mut bytes = bytes.map_err(|error| io::Error::new(io::ErrorKind::OutOfMemory, error))?;
        bytes.extend(pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]));
        writer.write_image_data(&bytes).map_err(plain)?;
    } else {
        writer.write_image_data(picture.pixels().as_flattened()).map_err(plain)?;
    }
    writer.finish().map_err(plain)
}

/// The writer's own error, if it is one.
fn plain(error: png::EncodingError) -> io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        other @ (png::EncodingError::Format(_)
        | png::EncodingError::Parameter(_)
        | png::EncodingError::LimitsExceeded) => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes a picture and reads it back.
    fn round(picture: &Picture) -> (png::ColorType, Vec<u8>) {
        let mut file = Vec::new();
        write_png(picture, &mut file).unwrap();
        assert!(file.starts_with(b"\x89PNG\r\n\x1a\n"));
        let mut reader = png::Decoder::new(io::Cursor::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width, info.height), (picture.width(), picture.height()));
        (info.color_type, bytes)
    }

    #[test]
    fn pictures_come_back() {
        let opaque = Picture::new(2, 1, vec![[1, 2, 3, 255], [4, 5, 6, 255]]).unwrap();
        assert_eq!(round(&opaque), (png::ColorType::Rgb, vec![1, 2, 3, 4, 5, 6]));
        let clear = Picture::new(1, 2, vec![[1, 2, 3, 0], [4, 5, 6, 255]]).unwrap();
        assert_eq!(round(&clear), (png::ColorType::Rgba, vec![1, 2, 3, 0, 4, 5, 6, 255]));
    }

    #[test]
    fn sides_fit_the_pixels() {
        for (width, height, count) in [(0, 1, 0), (1, 0, 0), (2, 2, 3), (u32::MAX, u32::MAX, 1)] {
            assert_eq!(Picture::new(width, height, vec![[0; 4]; count]), None);
        }
    }
}
