//! The camera: its place, and the ray of each point of the picture.
//!
//! ```text
//!        z  up                    names of directions, from where one looks:
//!        |                            front +x   back -x   left +y   right -y   top +z   bottom -z
//!        |   y
//!        |  /                     A direction frames itself: the camera stands as far away as it must
//!        | /                      for the model to fill the picture.
//!        o------- x  forward
//! ```

use jbt_model::orientation::{Handed, Orientation};
use jbt_model::origin::ModelOrigin;

use super::vector::{Vector, add, along, cross, dot, is_finite, length, scale, sub, unit};
use crate::error::{Classified, ErrorKind};

/// The views with names, and the directions that they look from. A model with z up faces
/// along x; see [`Orientation::direction`] for others.
pub const VIEWS: [(&str, Vector); 8] = [
    ("three-quarter", THREE_QUARTER),
    ("iso", [1.0, -1.0, 1.0]),
    ("front", [1.0, 0.0, 0.0]),
    ("back", [-1.0, 0.0, 0.0]),
    ("left", [0.0, 1.0, 0.0]),
    ("right", [0.0, -1.0, 0.0]),
    ("top", [0.0, 0.0, 1.0]),
    ("bottom", [0.0, 0.0, -1.0]),
];

const THREE_QUARTER: Vector = [1.0, -0.62, 0.5];

/// The place of the camera, in the world.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Stance {
    /// It looks at the model from this direction, of any length, from where the model fills the picture.
    /// It goes to the front, to the left and up: x, y and z of a model with z up, see
    /// [`Orientation::direction`].
    From([f64; 3]),
    /// It stands at a point and looks at another point.
    At {
        /// Where it stands, in units of the model.
        eye: [f64; 3],
        /// What is in the middle of the picture.
        target: [f64; 3],
    },
}

/// A view of the model.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct View {
    /// The place of the camera.
    pub stance: Stance,
    /// The direction that is up in the picture, of any length, in the axes of the model. By default what is
    /// up for the model, z as a rule; for a camera that looks along that, what is behind, y as a rule.
    pub up: Option<[f64; 3]>,
    /// The angle from the bottom to the top of the picture, in degrees: greater than 0, less than 180.
    /// Without perspective it matters only for a camera that stands at a point: at its target, it sees as
    /// much as with perspective.
    pub lens: f64,
    /// The factor of all sizes in the picture. Greater than 0.
    pub zoom: f64,
    /// Without perspective: all rays are parallel, and equal lengths look equal at any distance.
    pub orthographic: bool,
}

impl Default for View {
    /// A three-quarter view from the front, the right and above, through a lens of 28 degrees.
    fn default() -> Self {
        Self { stance: Stance::From(THREE_QUARTER), up: None, lens: 28.0, zoom: 1.0, orthographic: false }
    }
}

impl View {
    /// The view of a name in [`VIEWS`].
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let (_, from) = VIEWS.iter().find(|(known, _)| *known == name)?;
        Some(Self { stance: Stance::From(*from), ..Self::default() })
    }
}

/// Why a view gives no camera.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A number of the view is infinite or not a number.
    #[error("the camera's {what} must be a finite number, and it is {value}")]
    NotFinite {
        /// Which one.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// The direction of the camera or of up has no length.
    #[error("the camera's {what} is no direction: its length is 0")]
    Zero {
        /// Which one.
        what: &'static str,
    },
    /// The camera stands at its target.
    #[error("the camera's eye and target are both at ({}, {}, {}): it looks nowhere", eye[0], eye[1], eye[2])]
    Coincident {
        /// Where.
        eye: [f64; 3],
    },
    /// The up direction is the viewing direction.
    #[error("the camera looks along its up direction ({}, {}, {}): nothing is up in the picture", up[0], up[1], up[2])]
    Up {
        /// What was given.
        up: [f64; 3],
    },
    /// The angle of the lens is out of range.
    #[error("the camera's lens must be greater than 0 and less than 180 degrees, and it is {degrees}")]
    Lens {
        /// What was given.
        degrees: f64,
    },
    /// The zoom is 0 or negative.
    #[error("the camera's zoom must be greater than 0, and it is {zoom}")]
    Zoom {
        /// What was given.
        zoom: f64,
    },
}

impl Classified for CameraError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotFinite { .. }
            | Self::Zero { .. }
            | Self::Coincident { .. }
            | Self::Up { .. }
            | Self::Lens { .. }
            | Self::Zoom { .. } => ErrorKind::Argument,
        }
    }
}

/// The part of the picture that a framed model fills, along the axis that it fills more.
const FILLED: f64 = 0.86;
/// The sine of the angle below which two directions count as one.
const PARALLEL: f64 = 1e-9;

/// The rays of a picture.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Camera {
    /// Its place, in the world.
    pub eye: [f64; 3],
    /// To the right in the picture; a unit vector, like the others.
    pub right: [f64; 3],
    /// Upwards in the picture.
    pub up: [f64; 3],
    /// From the model to the eye.
    pub back: [f64; 3],
    /// Half the width and half the height of the view: at the distance 1, or, without perspective, at any
    /// distance.
    pub half: [f64; 2],
    /// Whether there is no perspective.
    pub orthographic: bool,
}

impl View {
    /// Checks all numbers.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn check(&self) -> Result<(), CameraError> {
        self.basis(Orientation::default())?;
        for (what, value) in [("lens", self.lens), ("zoom", self.zoom)] {
            finite(what, &[value])?;
        }
        if self.lens <= 0.0 || self.lens >= 180.0 {
            return Err(CameraError::Lens { degrees: self.lens });
        }
        if self.zoom <= 0.0 {
            return Err(CameraError::Zoom { zoom: self.zoom });
        }
        Ok(())
    }

    /// The same view in coordinates relative to an origin.
    pub(super) fn about(&self, origin: ModelOrigin) -> Self {
        let stance = match self.stance {
            Stance::From(_) => self.stance,
            Stance::At { eye, target } => Stance::At { eye: origin.local(eye), target: origin.local(target) },
        };
        Self { stance, ..*self }
    }

    /// The direction that is up in space: the picture's up, if it was given, or the model's.
    pub(super) fn upwards(&self, model: Orientation) -> Vector {
        self.up.and_then(unit).unwrap_or_else(|| model.direction([0.0, 0.0, 1.0]))
    }

    /// Right, up and back, in the axes of a model that stands so. In left-handed axes right is on the other
    /// side of up and back.
    fn basis(&self, model: Orientation) -> Result<[Vector; 3], CameraError> {
        let hand = if model.handed == Handed::Left { -1.0 } else { 1.0 };
        let right_of = |up: Vector, back: Vector| right_of(up, back).map(|right| scale(right, hand));
        let back = match self.stance {
            Stance::From(direction) => {
                finite("direction", &direction)?;
                let direction = unit(direction).ok_or(CameraError::Zero { what: "direction" })?;
                model.direction(direction)
            }
            Stance::At { eye, target } => {
                finite("eye", &eye)?;
                finite("target", &target)?;
                // Halves, because the difference of the largest numbers would overflow.
                unit(sub(scale(eye, 0.5), scale(target, 0.5))).ok_or(CameraError::Coincident { eye })?
            }
        };
        let right = match self.up {
            Some(up) => {
                finite("up", &up)?;
                let upwards = unit(up).ok_or(CameraError::Zero { what: "up" })?;
                right_of(upwards, back).ok_or(CameraError::Up { up })?
            }
            None => right_of(model.direction([0.0, 0.0, 1.0]), back)
                .or_else(|| right_of(model.direction([0.0, 1.0, 0.0]), back))
                .expect("no direction is that of two axes"),
        };
        Ok([right, scale(cross(back, right), hand), back])
    }

    /// The camera for a picture whose width is `aspect` times its height, of a model that stands so. If it
    /// stands at no point, it frames these points, of which there is at least one.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub(super) fn camera(
        &self,
        aspect: f64,
        points: &[Vector],
        model: Orientation,
    ) -> Result<Camera, CameraError> {
        self.check()?;
        let [right, up, back] = self.basis(model)?;
        let tangent = (0.5 * self.lens.to_radians()).tan();
        let lens = [tangent * aspect, tangent];
        let seen = Seen::new(points, [right, up, back]);
        let (eye, half) = match (self.stance, self.orthographic) {
            (Stance::At { eye, .. }, false) => (eye, lens),
            (Stance::At { eye, target }, true) => {
                let distance = length(sub(eye, target));
                // There is no near plane: the camera moves back until everything is in front of it.
                let nearest = seen.high[2] + seen.radius - dot(eye, back);
                (along(eye, nearest.max(0.0), back), lens.map(|half| half * distance))
            }
            (Stance::From(_), false) => (seen.perspective(lens.map(|half| half * FILLED)), lens),
            (Stance::From(_), true) => seen.parallel(aspect),
        };
        let half = half.map(|half| half / self.zoom);
        Ok(Camera { eye, right, up, back, half, orthographic: self.orthographic })
    }
}

impl Camera {
    /// The ray of a point of the picture: its origin and its unit direction. x goes from 0 at the left side
    /// to 1 at the right side, y from 0 at the top to 1 at the bottom.
    #[must_use]
    pub fn ray(&self, x: f64, y: f64) -> ([f64; 3], [f64; 3]) {
        let aside = add(
            scale(self.right, (2.0 * x - 1.0) * self.half[0]),
            scale(self.up, (1.0 - 2.0 * y) * self.half[1]),
        );
        if self.orthographic {
            return (add(self.eye, aside), scale(self.back, -1.0));
        }
        let direction = sub(aside, self.back);
        (self.eye, scale(direction, 1.0 / length(direction)))
    }

    /// The distance of a point in front of the eye, along the middle of the picture.
    #[must_use]
    pub fn depth(&self, point: [f64; 3]) -> f64 {
        dot(sub(self.eye, point), self.back)
    }
}

/// Points in the axes of a camera.
struct Seen {
    points: Vec<Vector>,
    axes: [Vector; 3],
    low: Vector,
    high: Vector,
    /// Half the diagonal of the box around them.
    radius: f64,
}

impl Seen {
    fn new(points: &[Vector], axes: [Vector; 3]) -> Self {
        let points: Vec<Vector> = points.iter().map(|&point| axes.map(|axis| dot(point, axis))).collect();
        let (mut low, mut high) = (points[0], points[0]);
        for point in &points {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let radius = (0.5 * length(sub(high, low))).max(f64::MIN_POSITIVE);
        Self { points, axes, low, high, radius }
    }

    /// The point with these coordinates along the axes.
    fn place(&self, at: Vector) -> Vector {
        let [right, up, back] = self.axes;
        add(scale(right, at[0]), add(scale(up, at[1]), scale(back, at[2])))
    }

    /// The nearest place of an eye that sees all points within these tangents of the middle.
    ///
    /// For the eye (cx, cy, d) this is `|x - cx| <= (d - z) t`, so `x + z t <= cx + d t` and
    /// `x - z t >= cx - d t`.
    fn perspective(&self, tangents: [f64; 2]) -> Vector {
        let mut eye = [0.0, 0.0, self.high[2] + 1e-3 * self.radius];
        for axis in 0..2 {
            let t = tangents[axis];
            let far = |sign: f64| {
                self.points.iter().map(|p| sign * p[axis] + p[2] * t).fold(f64::NEG_INFINITY, f64::max)
            };
            let (above, below) = (far(1.0), far(-1.0));
            eye[axis] = 0.5 * (above - below);
            eye[2] = eye[2].max(0.5 * (above + below) / t);
        }
        self.place(eye)
    }

    /// An eye without perspective, and half the sides of its view.
    fn parallel(&self, aspect: f64) -> (Vector, [f64; 2]) {
        let middle = |axis: usize| 0.5 * (self.low[axis] + self.high[axis]);
        let reach = |axis: usize| 0.5 * (self.high[axis] - self.low[axis]) / FILLED;
        let half = reach(1).max(reach(0) / aspect).max(1e-3 * self.radius);
        let eye = self.place([middle(0), middle(1), self.high[2] + self.radius]);
        (eye, [half * aspect, half])
    }
}

/// The unit vector to the right; `None` if up and back are parallel.
fn right_of(up: Vector, back: Vector) -> Option<Vector> {
    let right = cross(up, back);
    (length(right) > PARALLEL).then(|| unit(right)).flatten()
}

fn finite(what: &'static str, numbers: &[f64]) -> Result<(), CameraError> {
    match numbers.iter().find(|number| !number.is_finite()) {
        Some(&value) => Err(CameraError::NotFinite { what, value }),
        None => Ok(()),
    }
}

/// Whether a camera's numbers are usable: numbers far beyond those of any model overflow.
pub(super) fn is_usable(camera: &Camera) -> bool {
    is_finite(camera.eye) && camera.half.iter().all(|half| half.is_finite() && *half > 0.0)
}

#[cfg(test)]
mod tests {
    use jbt_model::orientation::ModelUp;

    use super::*;

    fn cube() -> Vec<Vector> {
        (0..8).map(|corner| [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 })).collect()
    }

    /// The place of a point in the picture: 0 .. 1 across and down.
    fn seen(camera: &Camera, point: Vector) -> [f64; 2] {
        let offset = sub(point, camera.eye);
        let distance = if camera.orthographic { 1.0 } else { camera.depth(point) };
        let at = |axis: Vector, half: f64| dot(offset, axis) / (distance * half);
        [0.5 + 0.5 * at(camera.right, camera.half[0]), 0.5 - 0.5 * at(camera.up, camera.half[1])]
    }

    #[test]
    fn every_view_shows_all_of_it_and_fills_the_picture() {
        for (name, _) in VIEWS {
            for aspect in [0.5, 1.0, 2.0] {
                for orthographic in [false, true] {
                    let view = View { orthographic, ..View::named(name).unwrap() };
                    let camera = view.camera(aspect, &cube(), Orientation::default()).unwrap();
                    let places: Vec<_> = cube().iter().map(|&corner| seen(&camera, corner)).collect();
                    let most = |axis: usize| {
                        places.iter().map(|place| (place[axis] - 0.5).abs()).fold(0.0, f64::max)
                    };
                    let filled = 2.0 * most(0).max(most(1));
                    assert!((filled - FILLED).abs() < 1e-9, "{name} {aspect} {orthographic}: {filled}");
                }
            }
        }
    }

    /// The front is seen with up above and left at the right, however the model stands.
    #[test]
    fn every_model_is_seen_upright() {
        for up in ModelUp::ALL {
            for handed in Handed::ALL {
                let model = Orientation { up, handed };
                let camera = View::named("front").unwrap().camera(1.5, &cube(), model).unwrap();
                assert_eq!(camera.back, model.direction([1.0, 0.0, 0.0]), "{model:?}");
                assert_eq!(camera.up, model.direction([0.0, 0.0, 1.0]), "{model:?}");
                assert_eq!(camera.right, model.direction([0.0, 1.0, 0.0]), "{model:?}");
                assert_eq!(View::default().upwards(model), camera.up);
            }
        }
        // POV-Ray's usual camera: on -z, x to the right, y up.
        let stance = Stance::At { eye: [0.0, 0.0, -5.0], target: [0.0; 3] };
        let camera = View { stance, ..View::default() }.camera(1.0, &cube(), Orientation::Y_LEFT).unwrap();
        assert_eq!((camera.right, camera.up), ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    }

    #[test]
    fn a_ray_goes_through_the_point_that_is_seen_there() {
        let camera =
            View { zoom: 0.7, ..View::default() }.camera(1.5, &cube(), Orientation::default()).unwrap();
        let point = [0.3, -0.8, 0.9];
        let [x, y] = seen(&camera, point);
        let (origin, direction) = camera.ray(x, y);
        let there = along(origin, length(sub(point, origin)), direction);
        assert!(length(sub(there, point)) < 1e-9, "{there:?}");
    }

    #[test]
    fn names_are_directions() {
        let front = View::named("front").unwrap().camera(1.0, &cube(), Orientation::default()).unwrap();
        assert_eq!((front.back, front.up, front.right), ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]));
        let top = View::named("top").unwrap().camera(1.0, &cube(), Orientation::default()).unwrap();
        assert_eq!((top.back, top.up, top.right), ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]));
        assert_eq!(View::named("elsewhere"), None);
    }

    #[test]
    fn what_is_no_view_says_why() {
        let eye = [1.0, 2.0, 3.0];
        let good = View::default();
        let nan = f64::NAN;
        for (view, words) in [
            (View { stance: Stance::From([0.0; 3]), ..good }, "the camera's direction is no direction"),
            (View { stance: Stance::From([0.0, nan, 1.0]), ..good }, "direction must be a finite number"),
            (
                View { stance: Stance::At { eye, target: eye }, ..good },
                "eye and target are both at (1, 2, 3)",
            ),
            (
                View { stance: Stance::At { eye: [nan; 3], target: eye }, ..good },
                "eye must be a finite number",
            ),
            (View { up: Some([2.0, -1.24, 1.0]), ..good }, "looks along its up direction"),
            (View { up: Some([0.0; 3]), ..good }, "the camera's up is no direction"),
            (View { lens: 180.0, ..good }, "less than 180 degrees, and it is 180"),
            (View { lens: nan, ..good }, "lens must be a finite number"),
            (View { zoom: 0.0, ..good }, "zoom must be greater than 0"),
        ] {
            let error = view.check().expect_err(words).to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
