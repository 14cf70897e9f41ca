//! Pictures of models.

use jbt::export::write_png;
use jbt::render::{Background, Quality, Render, RenderMode, Renderer, Stance, View};
use jbt::{Box3, Picture};
use numpy::ndarray::Array3;
use numpy::{IntoPyArray as _, PyArray3, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::{Refusal, refused};
use crate::mesh::region;
use crate::model::PyModel;
use crate::work::CallEffort;

/// The camera and what it shows, as Python says it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct PictureWish {
    size: [u32; 2],
    view: Option<String>,
    direction: Option<[f64; 3]>,
    eye: Option<[f64; 3]>,
    target: Option<[f64; 3]>,
    up: Option<[f64; 3]>,
    lens: f64,
    zoom: f64,
    orthographic: bool,
    mode: String,
    quality: String,
    antialias: u32,
    background: Option<Shade>,
    ground: bool,
    bounds: Option<[[f64; 3]; 2]>,
}

/// A background: a word, or a colour as screens have it.
#[derive(FromPyObject)]
enum Shade {
    #[pyo3(transparent)]
    Word(String),
    #[pyo3(transparent)]
    Color([u8; 3]),
}

impl PictureWish {
    fn view(&self) -> PyResult<View> {
        let named = match &self.view {
            None => View::default(),
            Some(name) => View::named(name).ok_or_else(|| {
                let known: Vec<&str> = jbt::render::VIEWS.iter().map(|(name, _)| *name).collect();
                refused(format!("view: expected one of {}, got {name:?}", known.join(", ")))
            })?,
        };
        let stance = match (self.eye, self.target, self.direction) {
            (Some(eye), target, _) => Stance::At { eye, target: target.unwrap_or_default() },
            (None, None, Some(from)) => Stance::From(from),
            (None, None, None) => named.stance,
            (None, Some(_), _) => return Err(refused("target: it needs an eye to look from")),
        };
        let Self { up, lens, zoom, orthographic, .. } = *self;
        Ok(View { stance, up, lens, zoom, orthographic })
    }

    fn mode(&self) -> RenderMode {
        match self.mode.as_str() {
            "shaded" => RenderMode::Shaded,
            "normal" => RenderMode::Normal,
            "depth" => RenderMode::Depth,
            "evaluations" => RenderMode::Evaluations,
            name => RenderMode::Attribute(name.to_owned()),
        }
    }

    fn quality(&self) -> PyResult<Quality> {
        match self.quality.as_str() {
            "draft" => Ok(Quality::Draft),
            "good" => Ok(Quality::Good),
            "best" => Ok(Quality::Best),
            other => Err(refused(format!("quality: expected one of draft, good, best, got {other:?}"))),
        }
    }

    fn background(&self) -> PyResult<Option<Background>> {
        match &self.background {
            None => Ok(None),
            Some(Shade::Color(color)) => Ok(Some(Background::Color(*color))),
            Some(Shade::Word(word)) => match word.as_str() {
                "studio" => Ok(Some(Background::Studio)),
                "transparent" => Ok(Some(Background::Transparent)),
                other => Err(refused(format!(
                    "background: expected studio, transparent or 3 numbers from 0 to 255, got {other:?}"
                ))),
            },
        }
    }
}

#[pymethods]
impl PyModel {
    /// A picture: an array of rows, columns and red, green, blue, opacity, as screens take them.
    fn render<'py>(
        &self,
        py: Python<'py>,
        wish: PictureWish,
        threads: Option<usize>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let compiled = self.compiled(py, None)?;
        let local = |bounds: Box3<f64>| bounds.map(|corner| compiled.origin().rounded(corner));
        let render = Render {
            size: wish.size,
            view: wish.view()?,
            mode: wish.mode(),
            quality: wish.quality()?,
            antialias: wish.antialias,
            background: wish.background()?,
            ground: wish.ground,
            region: region(wish.bounds)?.map(local),
        };
        let effort = CallEffort { py, threads, progress };
        let made = effort.run(move |watch| -> Result<_, Refusal> {
            let renderer = Renderer::of(&compiled)?;
            Ok(watch.run(render.with(&renderer))?)
        })?;
        let (width, height) = (made.picture.width() as usize, made.picture.height() as usize);
        let bytes = made.picture.pixels().as_flattened().to_vec();
        let array = Array3::from_shape_vec((height, width, 4), bytes)
            .map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))?;
        Ok(array.into_pyarray(py))
    }
}

/// A picture as the bytes of a PNG.
#[pyfunction]
pub(crate) fn encode_png<'py>(
    py: Python<'py>,
    pixels: PyReadonlyArray3<'py, u8>,
) -> PyResult<Bound<'py, PyBytes>> {
    let view = pixels.as_array();
    let [height, width, channels] = [view.shape()[0], view.shape()[1], view.shape()[2]];
    if channels != 4 {
        return Err(refused(format!(
            "pixels: expected the shape (height, width, 4), got {:?}",
            view.shape()
        )));
    }
    let flat: Vec<u8> = view.iter().copied().collect();
    let colors: Vec<[u8; 4]> = flat.as_chunks::<4>().0.to_vec();
    let picture = Picture::new(width as u32, height as u32, colors);
    let picture = picture.ok_or_else(|| refused("pixels: expected at least one"))?;
    let mut bytes = Vec::new();
    write_png(&picture, &mut bytes)?;
    Ok(PyBytes::new(py, &bytes))
}
