//! Few colours for many: the median cut (Heckbert 1982), and rounds of Lloyd's iteration. Sums are whole
//! numbers, so the same colours come out in any order of the vertices.

use jbt_ir::watch::{self, Stopped};

/// Rounds that move colours of the palette to the means of what is nearest to them.
const ROUNDS: usize = 8;

/// Colours between two looks whether the palette is still wanted.
const AT_A_TIME: usize = 1 << 10;

/// At most `most` colours, ascending, that stand for these, one of which at least is there.
pub(super) fn reduced(colors: &[[u8; 3]], most: usize) -> Result<Vec<[u8; 3]>, Stopped> {
    let mut counted = counted(colors);
    if counted.len() <= most {
        return Ok(counted.into_iter().map(|(color, _)| color).collect());
    }
    let mut boxes = vec![&mut counted[..]];
    while boxes.len() < most {
        watch::go_on()?;
        // The box whose longest side, times what is in it, is the longest.
        let weight = |colors: &[([u8; 3], u64)]| {
            let (_, length) = longest(colors);
            u64::from(length) * colors.iter().map(|(_, count)| count).sum::<u64>()
        };
        let Some(widest) = (0..boxes.len()).max_by_key(|&n| (weight(boxes[n]), boxes.len() - n)) else {
            break;
        };
        if weight(boxes[widest]) == 0 {
            break;
        }
        let colors = boxes.swap_remove(widest);
        let (axis, _) = longest(colors);
        colors.sort_unstable_by_key(|(color, _)| (color[axis], *color));
        let half = colors.iter().map(|(_, count)| count).sum::<u64>() / 2;
        let mut before = 0;
        let middle = colors.iter().position(|(_, count)| {
            before += count;
            before > half
        });
        let (low, high) = colors.split_at_mut(middle.unwrap_or(1).clamp(1, colors.len() - 1));
        boxes.extend([low, high]);
    }
    let mut palette: Vec<[u8; 3]> = boxes.iter().map(|colors| mean(colors.iter())).collect();
    let counted = self::counted(colors);
    for _ in 0..ROUNDS {
        let mut groups = vec![Vec::new(); palette.len()];
        for some in counted.chunks(AT_A_TIME) {
            watch::go_on()?;
            some.iter().for_each(|one| groups[nearest(&palette, one.0)].push(one));
        }
        for (color, group) in palette.iter_mut().zip(&groups).filter(|(_, group)| !group.is_empty()) {
            *color = mean(group.iter().copied());
        }
    }
    palette.sort_unstable();
    palette.dedup();
    Ok(palette)
}

/// The place of the nearest colour of a palette; the first of equally near ones.
pub(super) fn nearest(palette: &[[u8; 3]], color: [u8; 3]) -> usize {
    let distance =
        |other: &[u8; 3]| (0..3).map(|n| i32::from(other[n]).abs_diff(color[n].into()).pow(2)).sum::<u32>();
    (1..palette.len())
        .fold(0, |best, n| if distance(&palette[n]) < distance(&palette[best]) { n } else { best })
}

/// Each colour once, ascending, and how often it is there.
fn counted(colors: &[[u8; 3]]) -> Vec<([u8; 3], u64)> {
    let mut sorted = colors.to_vec();
    sorted.sort_unstable();
    let equal = sorted.chunk_by(|a, b| a == b);
    equal.map(|equal| (equal[0], equal.len() as u64)).collect()
}

/// The channel in which colours are farthest apart, and by how much.
fn longest(colors: &[([u8; 3], u64)]) -> (usize, u8) {
    let length = |axis: usize| {
        let of = || colors.iter().map(|(color, _)| color[axis]);
        of().max().unwrap_or(0) - of().min().unwrap_or(0)
    };
    let axis = (1..3).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best });
    (axis, length(axis))
}

fn mean<'a>(colors: impl Iterator<Item = &'a ([u8; 3], u64)>) -> [u8; 3] {
    let (mut sum, mut all) = ([0_u64; 3], 0);
    for (color, count) in colors {
        sum.iter_mut().zip(color).for_each(|(sum, &channel)| *sum += u64::from(channel) * count);
        all += count;
    }
    sum.map(|sum| ((2 * sum + all) / (2 * all.max(1))) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_stay_and_many_become_few() {
        let three = [[1, 2, 3], [200, 0, 0], [1, 2, 3], [0, 9, 0]];
        assert_eq!(reduced(&three, 4), Ok(vec![[0, 9, 0], [1, 2, 3], [200, 0, 0]]));
        // Two clouds of colours.
        let cloud = |middle: u8| (0..50_u8).map(move |n| [middle + n % 5, middle + n % 7, middle + n % 3]);
        let both: Vec<[u8; 3]> = cloud(20).chain(cloud(200)).collect();
        let two = reduced(&both, 2).expect("nobody stops it");
        assert_eq!(two.len(), 2);
        assert!(two[0].iter().all(|&c| c < 30) && two[1].iter().all(|&c| c > 195), "{two:?}");
        assert!(both.iter().all(|&color| nearest(&two, color) == usize::from(color[0] > 100)));
        let grey: Vec<[u8; 3]> = (0..=255).map(|n| [n; 3]).collect();
        let eight = reduced(&grey, 8).expect("nobody stops it");
        assert_eq!(eight.len(), 8);
        assert!(grey.iter().all(|&color| eight[nearest(&eight, color)][0].abs_diff(color[0]) <= 20));
        let mut backwards = grey.clone();
        backwards.reverse();
        assert_eq!(reduced(&backwards, 8), Ok(eight));
    }
}
