//! Developing: from the sums of each pixel to colours.

use super::color::{Rgb, byte, decode, encode, inferno, viridis};
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
    let row_of = |row: usize| -> Vec<[u8; 4]> {
        let pixels = &film[row * width as usize..][..width as usize];
        let behind = background.at((row as f32 + 0.5) / height as f32);
        let develop = |&[red, green, blue, share]: &Gathered| {
            let front = match (meaning, range) {
                _ if share == 0.0 => [0.0; 3],
                (FilmMeaning::Light | FilmMeaning::Screen, _) => [red, green, blue],
                (FilmMeaning::Number | FilmMeaning::Distance | FilmMeaning::Cost, None) => [0.0; 3],
                (FilmMeaning::Number, Some(range)) => viridis(part(red / share, range)).map(|x| x * share),
                (FilmMeaning::Distance, Some(range)) => [(1.0 - 0.85 * part(red / share, range)) * share; 3],
                (FilmMeaning::Cost, Some(range)) => {
                    inferno(part((red / share).ln(), range.map(f32::ln))).map(|x| x * share)
                }
            };
            over(front, share, behind, meaning == FilmMeaning::Light)
        };
        pixels.iter().map(develop).collect()
    };
    let rows: Vec<Vec<[u8; 4]>> = (0..height as usize).into_par_iter().map(row_of).collect();
    (Picture::new(width, height, rows.concat()).expect("a film has a pixel at least"), range)
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

/// A pixel in front of a background, as bytes. The front is premultiplied by its opacity; light is mixed
/// linearly.
fn over(front: Rgb, opacity: f32, behind: Option<Rgb>, is_light: bool) -> [u8; 4] {
    let show = |x: f32| byte(if is_light { encode(x) } else { x });
    match behind {
        Some(behind) => {
            let mix = |channel: usize| {
                let back = behind[channel];
                front[channel] + (1.0 - opacity) * if is_light { decode(back) } else { back }
            };
            let [red, green, blue] = [0, 1, 2].map(|channel| show(mix(channel)));
            [red, green, blue, 255]
        }
        None if opacity > 0.0 => {
            let [red, green, blue] = front.map(|x| show(x / opacity));
            [red, green, blue, byte(opacity)]
        }
        None => [0; 4],
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
