//! Developing: from the sums of each pixel to colours.

use jbt_ir::watch;

use super::color::{Rgb, ScreenBytes, byte, decode, inferno, viridis};
use super::settings::{Background, FilmMeaning};
use crate::parallel::*;
use crate::picture::Picture;
use crate::span::span;

/// The mean over the rays of a pixel: three numbers, multiplied by the share of the rays that have values,
/// and this share.
pub type Gathered = [f32; 4];

/// Develops a film into a picture. Also returns the range of its numbers, if colours stand for numbers.
pub fn develop(
    film: &[Gathered],
    [width, height]: [u32; 2],
    meaning: FilmMeaning,
    background: Background,
) -> (Picture, Option<[f32; 2]>) {
    span!("develop");
    let range = match meaning {
        FilmMeaning::Light | FilmMeaning::Screen => None,
        FilmMeaning::Number | FilmMeaning::Distance => range(film, |_| true),
        FilmMeaning::Cost => range(film, |cost| cost > 0.0),
    };
    let curve = (meaning == FilmMeaning::Light).then(ScreenBytes::new);
    watch::take(size_of::<[u8; 4]>() * film.len());
    let mut rows: Vec<[u8; 4]> = vec![[0; 4]; film.len()];
    let develop_row = |(row, (pixels, bytes)): (usize, (&[Gathered], &mut [[u8; 4]]))| {
        let behind = Behind::new(background.at((row as f32 + 0.5) / height as f32), curve.as_ref());
        for (&[red, green, blue, share], bytes) in pixels.iter().zip(bytes) {
            if share == 0.0 {
                *bytes = behind.bytes;
                continue;
            }
            let front = match (meaning, range) {
                (FilmMeaning::Light | FilmMeaning::Screen, _) => [red, green, blue],
                (FilmMeaning::Number | FilmMeaning::Distance | FilmMeaning::Cost, None) => [0.0; 3],
                (FilmMeaning::Number, Some(range)) => viridis(part(red / share, range)).map(|x| x * share),
                (FilmMeaning::Distance, Some(range)) => [(1.0 - 0.85 * part(red / share, range)) * share; 3],
                (FilmMeaning::Cost, Some(range)) => {
                    inferno(part((red / share).ln(), range.map(f32::ln))).map(|x| x * share)
                }
            };
            *bytes = behind.under(front, share);
        }
    };
    let width = width as usize;
    scatter(|_| film.par_chunks(width).zip(rows.par_chunks_mut(width)).enumerate().for_each(develop_row));
    (Picture::new(width as u32, height, rows).expect("a film has a pixel at least"), range)
}

/// The range of the numbers of a film that count.
fn range(film: &[Gathered], counts: impl Fn(f32) -> bool) -> Option<[f32; 2]> {
    let numbers = film.iter().filter(|pixel| pixel[3] > 0.0).map(|pixel| pixel[0] / pixel[3]);
    let ends = numbers.filter(|&number| counts(number)).map(|number| [number, number]);
    ends.reduce(|[low, high], [number, _]| [low.min(number), high.max(number)])
}

/// The place of a number in a range, from 0 to 1.
fn part(number: f32, [low, high]: [f32; 2]) -> f32 {
    if high > low { (number - low) / (high - low) } else { 0.0 }
}

/// What is behind the pixels of a row. Light is mixed linearly.
struct Behind<'a> {
    /// `None` where pixels stay transparent.
    color: Option<Rgb>,
    /// Of a pixel with nothing in front.
    bytes: [u8; 4],
    curve: Option<&'a ScreenBytes>,
}

impl<'a> Behind<'a> {
    /// The background of a row as screen values; with a curve, pixels are light.
    fn new(screen: Option<Rgb>, curve: Option<&'a ScreenBytes>) -> Self {
        let color = screen.map(|screen| if curve.is_some() { screen.map(decode) } else { screen });
        let mut behind = Self { color, bytes: [0; 4], curve };
        if color.is_some() {
            behind.bytes = behind.under([0.0; 3], 0.0);
        }
        behind
    }

    /// A pixel, as bytes. The front is premultiplied by its opacity, which is more than 0 where nothing is
    /// behind.
    fn under(&self, front: Rgb, opacity: f32) -> [u8; 4] {
        let show = |x: f32| self.curve.map_or_else(|| byte(x), |curve| curve.of(x));
        let (mixed, alpha) = match self.color {
            Some(color) => ([0, 1, 2].map(|channel| front[channel] + (1.0 - opacity) * color[channel]), 1.0),
            None => (front.map(|x| x / opacity), opacity),
        };
        let [red, green, blue] = mixed.map(show);
        [red, green, blue, byte(alpha)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(gathered: Gathered, meaning: FilmMeaning, background: Background) -> [u8; 4] {
        develop(&[gathered], [1, 1], meaning, background).0.pixel(0, 0)
    }

    #[test]
    fn light_is_mixed_as_light() {
        let white = Background::Color([255; 3]);
        assert_eq!(pixel([0.0, 0.0, 0.0, 0.5], FilmMeaning::Light, white), [188, 188, 188, 255]);
        assert_eq!(pixel([0.0, 0.0, 0.0, 0.5], FilmMeaning::Screen, white), [128, 128, 128, 255]);
        assert_eq!(
            pixel([0.5, 0.0, 0.0, 0.5], FilmMeaning::Light, Background::Transparent),
            [255, 0, 0, 128]
        );
        assert_eq!(pixel([0.0; 4], FilmMeaning::Light, Background::Transparent), [0; 4]);
        assert_eq!(pixel([0.0; 4], FilmMeaning::Light, Background::Color([1, 2, 3])), [1, 2, 3, 255]);
    }

    #[test]
    fn numbers_have_a_range() {
        let film = [[1.0, 0.0, 0.0, 1.0], [1.5, 0.0, 0.0, 0.5], [0.0; 4]];
        let (picture, range) = develop(&film, [3, 1], FilmMeaning::Distance, Background::Transparent);
        assert_eq!(range, Some([1.0, 3.0]));
        assert_eq!(picture.pixel(0, 0), [255; 4]);
        assert_eq!(picture.pixel(1, 0), [38, 38, 38, 128]);
        assert_eq!(picture.pixel(2, 0), [0; 4]);
        assert_eq!(develop(&[[0.0; 4]], [1, 1], FilmMeaning::Number, Background::Transparent).1, None);
        // A single number gives no division by zero.
        assert_eq!(pixel([2.0, 0.0, 0.0, 1.0], FilmMeaning::Number, Background::Studio)[3], 255);
        assert_eq!(pixel([0.0, 0.0, 0.0, 1.0], FilmMeaning::Cost, Background::Studio)[3], 255);
    }
}
