//! Planes through a model, and coordinates in them.

use std::fmt;
use std::str::FromStr;

use crate::error::{Classified, ErrorKind};
use jbt_model::builder::Axis;
use thiserror::Error;

/// A plane with two perpendicular axes u and v of length 1: lengths and areas in it are those of the model.
///
/// | plane | u | v | seen from |
/// |---|---|---|---|
/// | `z=c` | x | y | above (+z) |
/// | `x=c` | y | z | the right (+x) |
/// | `y=c` | x | z | the front (-y) |
///
/// ```
/// use jbt::contour::Plane;
/// let plane: Plane = "y=0.5".parse().unwrap();
/// assert_eq!(plane.point([1.0, 2.0]), [1.0, 0.5, 2.0]);
/// let tilted: Plane = "0,0,1, 1,0,0, 0,3,4".parse().unwrap(); // origin, u, v
/// assert!((tilted.point([0.0, 5.0])[2] - 5.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plane(pub(super) PlaneKind);

#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum PlaneKind {
    /// Across a coordinate axis (0, 1 or 2), where its coordinate is this.
    Across { axis: usize, at: f64 },
    /// Through a point, along u and v.
    Spanned { origin: [f64; 3], u: [f64; 3], v: [f64; 3] },
}

/// Why there is no such plane.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlaneError {
    /// It is written in no known way.
    #[error("`{text}` is no plane: expected one as z=0.3, or nine numbers: a point, u and v")]
    Text {
        /// What was given.
        text: String,
    },
    /// A number is infinite or NaN.
    #[error("the numbers of a plane must be finite")]
    NotFinite,
    /// The two axes span no plane.
    #[error("the axes u and v of a plane must point in different directions, and not be 0")]
    Parallel,
}

impl Classified for PlaneError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Text { .. } | Self::NotFinite | Self::Parallel => ErrorKind::Argument,
        }
    }
}

impl Default for Plane {
    /// z = 0: where two-dimensional models live.
    fn default() -> Self {
        Self(PlaneKind::Across { axis: 2, at: 0.0 })
    }
}

impl Plane {
    /// The plane across a coordinate axis at a coordinate.
    ///
    /// # Errors
    /// A coordinate that is not finite in f32.
    pub fn across(axis: Axis, at: f64) -> Result<Self, PlaneError> {
        let axis = match axis {
            Axis::X => 0,
            Axis::Y => 1,
            Axis::Z => 2,
        };
        Self(PlaneKind::Across { axis, at }).checked()
    }

    /// The plane through a point, with u along a direction and v in the plane of both, perpendicular to u.
    /// Lengths of directions do not matter.
    ///
    /// # Errors
    /// Numbers that are not finite in f32, directions that are 0 or parallel.
    pub fn spanned(origin: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Result<Self, PlaneError> {
        // The largest component is made 1 first, so that squares neither vanish nor overflow.
        let u = unit(u)?;
        let v = unit(v)?;
        let along = dot(u, v);
        let across: [f64; 3] = std::array::from_fn(|axis| v[axis] - along * u[axis]);
        if dot(across, across) < 1e-20 {
            return Err(PlaneError::Parallel);
        }
        Self(PlaneKind::Spanned { origin, u, v: unit(across)? }).checked()
    }

    fn checked(self) -> Result<Self, PlaneError> {
        let fits = |value: f64| (value as f32).is_finite();
        let fine = match self.0 {
            PlaneKind::Across { at, .. } => fits(at),
            PlaneKind::Spanned { origin, .. } => origin.into_iter().all(fits),
        };
        if fine { Ok(self) } else { Err(PlaneError::NotFinite) }
    }

    /// The point of space with these coordinates in the plane.
    #[must_use]
    pub fn point(&self, [a, b]: [f64; 2]) -> [f64; 3] {
        match self.0 {
            PlaneKind::Across { axis, at } => {
                let [first, second] = others(axis);
                let mut point = [at; 3];
                (point[first], point[second]) = (a, b);
                point
            }
            PlaneKind::Spanned { origin, u, v } => {
                std::array::from_fn(|axis| origin[axis] + a * u[axis] + b * v[axis])
            }
        }
    }

    /// The coordinates of a point of space in the plane, and its distance from it (negative behind).
    #[must_use]
    pub fn coordinates(&self, point: [f64; 3]) -> [f64; 3] {
        let rows = self.rows();
        rows.map(|[x, y, z, shift]| x * point[0] + y * point[1] + z * point[2] + shift)
    }

    /// The map from space to coordinates in the plane and the distance from it, by rows.
    pub(super) fn rows(&self) -> [[f64; 4]; 3] {
        let (origin, u, v) = match self.0 {
            PlaneKind::Across { axis, at } => {
                let [first, second] = others(axis);
                let unit = |axis: usize| std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
                (unit(axis).map(|one: f64| one * at), unit(first), unit(second))
            }
            PlaneKind::Spanned { origin, u, v } => (origin, u, v),
        };
        let normal =
            std::array::from_fn(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
        [u, v, normal].map(|row| [row[0], row[1], row[2], -dot(row, origin)])
    }
}

/// The axes along u and v of a plane across an axis.
pub(super) fn others(axis: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][axis]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

/// A direction at length 1.
fn unit(direction: [f64; 3]) -> Result<[f64; 3], PlaneError> {
    let largest = direction.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
    if direction.iter().any(|c| !c.is_finite()) {
        return Err(PlaneError::NotFinite);
    }
    if largest == 0.0 {
        return Err(PlaneError::Parallel);
    }
    let scaled = direction.map(|c| c / largest);
    let length = dot(scaled, scaled).sqrt();
    Ok(scaled.map(|c| c / length))
}

impl FromStr for Plane {
    type Err = PlaneError;

    /// `x=1`, `y=-2.5`, `z=0`, or nine numbers with commas between them: a point, u and v.
    fn from_str(text: &str) -> Result<Self, PlaneError> {
        let wrong = || PlaneError::Text { text: text.to_owned() };
        let number = |word: &str| word.trim().parse::<f64>().map_err(|_| wrong());
        if let Some((name, at)) = text.split_once('=') {
            let axis = match name.trim() {
                "x" => Axis::X,
                "y" => Axis::Y,
                "z" => Axis::Z,
                _ => return Err(wrong()),
            };
            return Self::across(axis, number(at)?);
        }
        let numbers: Vec<f64> = text.split(',').map(number).collect::<Result<_, _>>()?;
        let [ox, oy, oz, ux, uy, uz, vx, vy, vz] = <[f64; 9]>::try_from(numbers).map_err(|_| wrong())?;
        Self::spanned([ox, oy, oz], [ux, uy, uz], [vx, vy, vz])
    }
}

impl fmt::Display for Plane {
    /// As [`from_str`](Self::from_str) reads it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            PlaneKind::Across { axis, at } => write!(f, "{}={at}", ["x", "y", "z"][axis]),
            PlaneKind::Spanned { origin, u, v } => {
                let words: Vec<String> =
                    [origin, u, v].iter().flatten().map(|number| (number + 0.0).to_string()).collect();
                f.write_str(&words.join(","))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_read_and_printed() {
        for text in ["z=0", "x=-1.5", "y=0.25", "0,0,1,1,0,0,0,1,0"] {
            let plane: Plane = text.parse().unwrap();
            assert_eq!(plane.to_string(), text);
            assert_eq!(plane.to_string().parse(), Ok(plane));
        }
        let parse = |text: &str| text.parse::<Plane>();
        for bad in ["", "z", "z=", "w=1", "z=1=2", "1,2,3", "0,0,0,1,0,0,0,1,0,0", "z=one"] {
            assert!(matches!(parse(bad), Err(PlaneError::Text { .. })), "{bad}");
        }
        for bad in ["z=nan", "z=inf", "z=1e39", "nan,0,0,1,0,0,0,1,0", "0,0,0,1,inf,0,0,1,0"] {
            assert_eq!(parse(bad), Err(PlaneError::NotFinite), "{bad}");
        }
        for bad in ["0,0,0,1,0,0,-2,0,0", "0,0,0,0,0,0,0,1,0", "0,0,0,1,1,1,0,0,0"] {
            assert_eq!(parse(bad), Err(PlaneError::Parallel), "{bad}");
        }
        assert_eq!(Plane::default(), "z=0".parse().unwrap());
    }

    #[test]
    fn points_and_coordinates_are_inverse() {
        for text in ["x=2", "y=-1", "z=0.5", "1,2,3,1,1,0,0,1,5e-30", "0,0,0,1e-200,0,0,1e200,1e200,0"] {
            let plane: Plane = text.parse().unwrap();
            let [a, b, away] = plane.coordinates(plane.point([0.7, -0.3]));
            assert!((a - 0.7).abs() < 1e-12 && (b + 0.3).abs() < 1e-12 && away.abs() < 1e-12, "{text}");
        }
    }
}
