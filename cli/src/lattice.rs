//! The lattice of the command line: what its options mean, and whose fault it is when there is none.

use jbt::mesh::Lattice;
use jbt::{Box3, Fineness, ModelOrigin, Polygonize};

use crate::arguments::LatticeArguments;
use crate::failure::Failure;

/// What the options say.
pub fn settings(arguments: &LatticeArguments) -> Result<Polygonize, Failure> {
    let fineness = match (arguments.cell, arguments.resolution) {
        (Some(cell), _) if !cell.is_finite() || cell <= 0.0 => {
            return Err(Failure::Usage(format!(
                "the edge of a cell must be a finite number greater than zero, and it is {cell}"
            )));
        }
        (Some(cell), _) => Fineness::Cell(cell),
        (None, Some(0)) => return Err(Failure::Usage("a lattice needs at least one cell".to_owned())),
        (None, Some(cells)) => Fineness::Resolution(cells),
        (None, None) => Fineness::default(),
    };
    Ok(Polygonize { region: arguments.region, fineness, verify: false, thin_parts: true, sharp: true })
}

/// The box of a lattice about the origin of a model, in the world.
pub fn bounds(lattice: &Lattice, origin: ModelOrigin) -> Box3<f64> {
    let (low, cells) = (lattice.origin(), lattice.cells());
    let high = std::array::from_fn(|axis| low[axis] + lattice.spacing() * cells[axis] as f64);
    Box3::new(low, high).map(|corner| origin.world(corner))
}

/// A region of the world as a box about the origin of a model.
pub fn local(region: Box3<f64>, origin: ModelOrigin) -> Box3 {
    region.map(|corner| origin.rounded(corner))
}

/// Where a model has its origin, as a line of a summary; nothing for most models.
pub fn origin_line(origin: ModelOrigin) -> String {
    let [x, y, z] = origin.point();
    if origin.is_world() { String::new() } else { format!("\n  origin       ({x} {y} {z})") }
}

/// A lattice in words: `40 x 40 x 20 cells of 0.100000, from (0.0000 0.0000 0.0000) to (4.0000 4.0000
/// 2.0000)`.
pub fn describe(lattice: &Lattice, origin: ModelOrigin) -> String {
    let Box3 { low: [x0, y0, z0], high: [x1, y1, z1] } = bounds(lattice, origin);
    let ([nx, ny, nz], spacing) = (lattice.cells(), lattice.spacing());
    format!(
        "{nx} x {ny} x {nz} cells of {spacing:.6}, from ({x0:.4} {y0:.4} {z0:.4}) to ({x1:.4} {y1:.4} {z1:.4})"
    )
}
