//! Crossings with their normals and signatures.

use super::super::super::field::Field;
use super::super::bracket::{BracketPoints, CrossedEdge, CrossedEdges};
use super::super::sheet::Sheet;
use super::crossing::{Crossing, SHARP, dot};
use super::leaning;

/// The distance from the crossing, in parts of the edge, from which on an estimate of it tells nothing.
const OFF: f64 = 1.0 / 16384.0;
/// What comes on top, in parts of the iso-value: some steps of f32.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
/// Newton's steps for estimates that are off.
const STEPS: usize = 2;

/// What decides at all crossed edges of a brick, nearly.
pub(super) struct SheetProbes {
    found: Vec<DecidedPoint>,
    /// For each edge, whether its estimate is off the surface, or on the way to it another operand decided.
    is_off: Vec<bool>,
    /// Points at which field and gradient were evaluated.
    pub(super) asked: u64,
}

impl SheetProbes {
    /// Whether crossings of a sheet differ by what decides, and by their normals; or may do, because the
    /// estimate of one is off the surface. So it is where the field has a kink along the edge.
    pub(super) fn differ(&self, sheet: &Sheet) -> bool {
        let edges = sheet.numbers();
        let of = |edge: u32| &self.found[edge as usize];
        if edges.iter().any(|&edge| self.is_off[edge as usize]) {
            return true;
        }
        let signature = |edge: u32| of(edge).signature;
        if edges.iter().all(|&edge| signature(edge) == signature(edges[0])) {
            return false;
        }
        edges.iter().enumerate().any(|(n, &a)| {
            edges[..n].iter().any(|&b| {
                let normals = of(a).normal().zip(of(b).normal());
                signature(a) != signature(b) && normals.is_none_or(|(a, b)| dot(a, b) < SHARP)
            })
        })
    }
}

/// For each sheet its crossings, if all of them have normals; and how many points were asked for gradients.
type SheetCrossings = (Vec<Option<Vec<Crossing>>>, u64);

/// The field at a point.
pub(super) struct DecidedPoint {
    value: f32,
    slope: [f64; 3],
    pub(super) signature: u32,
}

impl DecidedPoint {
    /// The unit normal away from the inside, if there is one.
    pub(super) fn normal(&self) -> Option<[f64; 3]> {
        let length = dot(self.slope, self.slope).sqrt();
        (length > 0.0 && length.is_finite()).then(|| self.slope.map(|c| -c / length))
    }

    /// How far the point is from the surface along the normal, by its gradient. Inside it is positive.
    pub(super) fn height(&self, iso: f32) -> f64 {
        (f64::from(self.value) - f64::from(iso)) / dot(self.slope, self.slope).sqrt()
    }
}

/// Field, gradient and signature at some points.
pub(super) fn decided<F: Field>(
    field: &F,
    region: &F::Region,
    points: &[[f32; 3]],
) -> Result<Vec<DecidedPoint>, F::Error> {
    let count = points.len();
    if count == 0 {
        return Ok(Vec::new());
    }
    let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<f32>>());
    let (mut values, mut signatures) = (vec![0.0; count], vec![0.0_f32; count]);
    let mut gradient = [0; 3].map(|_| vec![0.0; count]);
    let slopes = gradient.each_mut().map(Vec::as_mut_slice);
    field.decided(region, [&x, &y, &z], &mut values, slopes, &mut signatures)?;
    let at = |n: usize| DecidedPoint {
        value: values[n],
        slope: gradient.each_ref().map(|plane| f64::from(plane[n])),
        signature: signatures[n].to_bits(),
    };
    Ok((0..count).map(at).collect())
}

/// Looks at all crossed edges, nearly at their crossings.
pub(super) fn probe<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    crossed: &mut CrossedEdges,
) -> Result<SheetProbes, F::Error> {
    let mut points = crossed.estimated(field, region, iso)?;
    let mut found = decided(field, region, &points)?;
    let mut asked = points.len() as u64;
    let is_off = |number: usize, at: &DecidedPoint| {
        let rise = crossed.get(number as u32).rise_along(at.slope).abs();
        let is_near =
            (f64::from(at.value) - f64::from(iso)).abs() <= OFF * rise + ROUNDING * f64::from(iso.abs());
        !is_near
    };
    let mut has_kink = vec![false; points.len()];
    for _ in 0..STEPS {
        let off: Vec<usize> = (0..points.len()).filter(|&number| is_off(number, &found[number])).collect();
        for &number in &off {
            let DecidedPoint { value, slope, .. } = &found[number];
            let rise = f64::from(iso) - f64::from(*value);
            points[number] = crossed.get(number as u32).step(points[number], rise, *slope);
        }
        let again: Vec<[f32; 3]> = off.iter().map(|&number| points[number]).collect();
        asked += again.len() as u64;
        for (number, at) in off.into_iter().zip(decided(field, region, &again)?) {
            has_kink[number] |= at.signature != found[number].signature;
            found[number] = at;
        }
    }
    let both = found.iter().zip(has_kink).enumerate();
    let is_off = both.map(|(number, (at, has_kink))| has_kink || is_off(number, at)).collect();
    Ok(SheetProbes { found, is_off, asked })
}

/// Looks at the crossings of some sheets. `None` for a sheet with a crossing that has no normal. Also returns
/// the number of points at which the gradient was evaluated.
///
/// Two operands may decide at the ends of what is left of an edge, if it is crossed next to an edge of the
/// surface, or on it. There the field bends: see [`deciding_end`].
pub(super) fn look<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    (sheets, crossed): (&[&Sheet], &CrossedEdges),
) -> Result<SheetCrossings, F::Error> {
    let edges = || sheets.iter().flat_map(|sheet| sheet.crossed(crossed));
    let ends: Vec<[f32; 3]> = edges().flat_map(|edge| [edge.outside(), edge.inside()]).collect();
    let ends_found = decided(field, region, &ends)?;
    let mut both = ends.as_chunks::<2>().0.iter().zip(ends_found.as_chunks::<2>().0);
    let jumps = sheets.iter().flat_map(|sheet| sheet.crossed(crossed).map(move |edge| (*sheet, edge)));
    let jumps: Vec<(&Sheet, &CrossedEdge)> = jumps.filter(|(_, edge)| edge.is_jump()).collect();
    let walls = leaning::normals(field, region, iso, &jumps, &mut BracketPoints::default())?;
    let (mut walls, mut found) = (walls.into_iter(), Vec::new());
    for sheet in sheets {
        let (mut crossings, mut unseen) = (Vec::new(), Vec::new());
        for (edge, (ends, at)) in sheet.crossed(crossed).zip(both.by_ref()) {
            let place = edge.crossing();
            let end = if edge.is_jump() { 1 } else { deciding_end(ends, at) };
            let (signature, normal) = if edge.is_jump() {
                (None, walls.next().flatten())
            } else {
                (Some(at[end].signature), at[end].normal())
            };
            if normal.is_none() {
                unseen.push(crossings.len());
            }
            let normal = normal.unwrap_or_default();
            crossings.push(Crossing { place, seen: ends[end], normal, signature });
        }
        found.push(with_walls(crossings, &unseen, sheet.size));
    }
    Ok((found, ends.len() as u64))
}

/// The end at which the operand decides that has the crossing: 0 for the outer one, 1 for the inner one. If
/// the field bends down on the way in, the smaller operand decides, and it has the crossing whose value at
/// the outer end is outside; if up, the larger one, whose value at the inner end is inside.
fn deciding_end([outside, inside]: &[[f32; 3]; 2], at: &[DecidedPoint; 2]) -> usize {
    if at[0].signature == at[1].signature {
        return 1;
    }
    let way: [f64; 3] = std::array::from_fn(|axis| f64::from(inside[axis]) - f64::from(outside[axis]));
    let [outer, inner] = at.each_ref().map(|at| dot(at.slope, way));
    usize::from(outer < inner)
}

/// Crossings of a sheet of a cell of this size, where those without a normal get that of the wall that they
/// are on. `None` if one of them is on no other's wall.
fn with_walls(mut crossings: Vec<Crossing>, unseen: &[usize], size: f32) -> Option<Vec<Crossing>> {
    /// The distance from a wall, in cells, up to which a crossing is on it.
    const NEAR: f64 = 1.0 / 256.0;
    for &n in unseen {
        let Crossing { place, signature, .. } = crossings[n];
        let others = crossings.iter().enumerate().filter(|(other, _)| !unseen.contains(other));
        let walls = others.map(|(_, crossing)| crossing).filter(|crossing| crossing.signature.is_none());
        let distance = |wall: &&Crossing| {
            let way = std::array::from_fn(|axis| f64::from(place[axis]) - f64::from(wall.place[axis]));
            dot(wall.normal, way).abs()
        };
        let nearest = walls.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        if signature.is_some() || distance(&nearest) > NEAR * f64::from(size) {
            return None;
        }
        crossings[n].normal = nearest.normal;
    }
    Some(crossings)
}
