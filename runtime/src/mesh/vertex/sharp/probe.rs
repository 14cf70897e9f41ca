//! Crossings with their normals and signatures.

use super::super::super::field::Field;
use super::super::bracket::{BracketPoints, CrossedEdges};
use super::super::sheet::Sheet;
use super::crossing::{Crossing, SHARP, dot};

/// The way from a crossing towards the mean of its sheet's, at which it is looked at.
const INWARD: f64 = 1.0 / 256.0;

/// What decides at all crossed edges of a brick, nearly.
pub(super) struct Probes {
    normals: Vec<Option<[f64; 3]>>,
    signatures: Vec<u32>,
    /// Points at which field and gradient were evaluated.
    pub(super) asked: u64,
}

impl Probes {
    /// Whether crossings differ by what decides, and by their normals.
    pub(super) fn differ(&self, edges: &[u32]) -> bool {
        let signature = |edge: u32| self.signatures[edge as usize];
        if edges.iter().all(|&edge| signature(edge) == signature(edges[0])) {
            return false;
        }
        edges.iter().enumerate().any(|(n, &a)| {
            edges[..n].iter().any(|&b| {
                let normals = self.normals[a as usize].zip(self.normals[b as usize]);
                signature(a) != signature(b) && normals.is_none_or(|(a, b)| dot(a, b) < SHARP)
            })
        })
    }
}

/// For each point its unit normal, if there is one, and its signature.
type DecidedPoints = (Vec<Option<[f64; 3]>>, Vec<u32>);

/// For each sheet its crossings, if all of them have normals; and how many points were asked for gradients.
type SheetCrossings = (Vec<Option<Vec<Crossing>>>, u64);

/// Field, gradient and signature at some points: the unit normals, if there are any, and the signatures.
fn decided<F: Field>(field: &F, region: &F::Region, points: &[[f32; 3]]) -> Result<DecidedPoints, F::Error> {
    let count = points.len();
    if count == 0 {
        return Ok((Vec::new(), Vec::new()));
    }
    let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<f32>>());
    let (mut values, mut signatures) = (vec![0.0; count], vec![0.0; count]);
    let mut gradient = [0; 3].map(|_| vec![0.0; count]);
    let slopes = gradient.each_mut().map(Vec::as_mut_slice);
    field.decided(region, [&x, &y, &z], &mut values, slopes, &mut signatures)?;
    let normal = |n: usize| {
        let slope = gradient.each_ref().map(|plane| -f64::from(plane[n]));
        let length = dot(slope, slope).sqrt();
        (length > 0.0 && length.is_finite()).then(|| slope.map(|c| c / length))
    };
    Ok(((0..count).map(normal).collect(), signatures.into_iter().map(f32::to_bits).collect()))
}

/// Looks at all crossed edges, nearly at their crossings.
pub(super) fn probe<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    crossed: &mut CrossedEdges,
) -> Result<Probes, F::Error> {
    let points = crossed.estimated(field, region, iso)?;
    let (normals, signatures) = decided(field, region, &points)?;
    Ok(Probes { normals, signatures, asked: points.len() as u64 })
}

/// Looks at the crossings of some sheets, from a little inside of their cells. `None` for a sheet with a
/// crossing that has no normal. Also returns the number of points at which the gradient was evaluated.
pub(super) fn look<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    (sheets, crossed): (&[&Sheet], &CrossedEdges),
) -> Result<SheetCrossings, F::Error> {
    let mut crossings = Vec::new();
    let mut walls = Vec::new();
    for sheet in sheets {
        let mut mean = [0.0; 3];
        for edge in sheet.crossed(crossed) {
            mean.iter_mut().zip(edge.crossing()).for_each(|(sum, c)| *sum += f64::from(c));
        }
        let mean = mean.map(|sum| sum / sheet.numbers().len() as f64);
        for edge in sheet.crossed(crossed) {
            let place = edge.crossing();
            let towards = |axis: usize| {
                let from = f64::from(place[axis]);
                (from + INWARD * (mean[axis] - from)) as f32
            };
            let seen = if edge.is_jump() { edge.inside() } else { [0, 1, 2].map(towards) };
            if edge.is_jump() {
                walls.push((crossings.len(), edge.leaning(mean, sheet.size, sheet.cell)));
            }
            crossings.push(Crossing { place, seen, normal: [0.0; 3], signature: None });
        }
    }
    let seen: Vec<[f32; 3]> = crossings.iter().map(|crossing| crossing.seen).collect();
    let (mut normals, signatures) = decided(field, region, &seen)?;
    let mut points = BracketPoints::default();
    for (n, leaning) in &mut walls {
        normals[*n] = leaning.normal(field, region, iso, &mut points)?;
    }
    for (crossing, signature) in crossings.iter_mut().zip(signatures) {
        crossing.signature = Some(signature);
    }
    walls.iter().for_each(|(n, _)| crossings[*n].signature = None);
    let (asked, mut rest) = (crossings.len() as u64, &crossings[..]);
    let mut rest_of_normals = &normals[..];
    let found = sheets.iter().map(|sheet| {
        let count = sheet.numbers().len();
        let (mine, after) = rest.split_at(count);
        let (normals, normals_after) = rest_of_normals.split_at(count);
        (rest, rest_of_normals) = (after, normals_after);
        let both = mine.iter().zip(normals);
        both.map(|(crossing, normal)| normal.map(|normal| Crossing { normal, ..*crossing })).collect()
    });
    Ok((found.collect(), asked))
}
