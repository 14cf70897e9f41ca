//! Boxes and lattices of the command line.

use clap::Args;
use jbt::Box3;

/// The lattice of points that a mesh asks the field at.
#[derive(Args, Debug)]
pub struct LatticeArguments {
    /// Edge of a cell of the lattice, in units of the scene
    #[arg(long, value_name = "H", conflicts_with = "resolution", allow_negative_numbers = true)]
    pub cell: Option<f64>,
    /// Cells along the longest side of the region [default: 128]
    #[arg(long, value_name = "N", value_parser = cells, allow_negative_numbers = true)]
    pub resolution: Option<usize>,
    /// The box that the lattice fills: its smallest and its largest corner [default: the support of the
    /// model]
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", value_parser = region, allow_hyphen_values = true)]
    pub region: Option<Box3<f64>>,
}

impl LatticeArguments {
    /// Whether any of it was asked for.
    pub fn given(&self) -> bool {
        self.cell.is_some() || self.resolution.is_some() || self.region.is_some()
    }
}

/// A number of cells. How many there may be, others say.
pub(super) fn cells(text: &str) -> Result<usize, String> {
    text.trim().parse().map_err(|_| "expected a whole number of cells, as 128".to_owned())
}

/// The corners of a region whose numbers have these names: finite, and the first below the last along each
/// axis.
pub(super) fn corners<const N: usize>(text: &str, names: [[&str; N]; 2]) -> Result<[[f64; N]; 2], String> {
    let words: Vec<&str> = text.split(',').map(str::trim).collect();
    let all = names.concat();
    if words.len() != all.len() {
        let count = if N == 3 { "six" } else { "four" };
        return Err(format!("expected {count} numbers, as {}", all.join(",")));
    }
    let mut numbers = [[0.0_f64; N]; 2];
    for ((number, word), name) in numbers.as_flattened_mut().iter_mut().zip(words).zip(all) {
        *number = word.parse().map_err(|_| format!("{name} is `{word}`, and that is no number"))?;
        if !number.is_finite() {
            return Err(format!("{name} is `{word}`, and a region has finite corners"));
        }
    }
    for axis in 0..N {
        let ([low, high], [from, to]) =
            (names.map(|corner| corner[axis]), numbers.map(|corner| corner[axis]));
        if from >= to {
            return Err(format!(
                "{high} must be greater than {low}, and the region goes from {from} to {to}"
            ));
        }
        if !(to - from).is_finite() {
            return Err(format!("{low} and {high} are too far apart"));
        }
    }
    Ok(numbers)
}

pub(super) fn region(text: &str) -> Result<Box3<f64>, String> {
    let [low, high] = corners(text, [["X0", "Y0", "Z0"], ["X1", "Y1", "Z1"]])?;
    Ok(Box3::new(low, high))
}
