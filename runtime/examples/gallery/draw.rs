//! Makes the file of a picture.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use jbt::contour::{Detail, ImageDetail, ImageMode, Plane, Slicer, circles};
use jbt::export::svg::{Paint, Style, write_svg};
use jbt::export::write_png;
use jbt::{CheckedTree, Compiler, Fineness, Picture, Query, SceneFolder, text};

use crate::list::{Drawing, Entry, Scene};
use crate::looks;
use crate::splash;

/// See [`coarse`].
const STEP: u8 = 2;

/// The bytes of a picture's file.
pub fn draw(root: &Path, entry: &Entry) -> Result<Vec<u8>, Box<dyn Error>> {
    let tree = tree(root, &entry.scene)?;
    let compiler = Compiler::new();
    let mut bytes = Vec::new();
    match &entry.drawing {
        Drawing::Render(render) => {
            let made = render.picture(&compiler, &tree).run()?;
            write_png(&coarse(&made.picture), &mut bytes)?;
        }
        Drawing::Slice { plane, mode, pixels } => {
            let query =
                if matches!(mode, ImageMode::Attribute(_)) { Query::ATTRIBUTES } else { Query::FIELD };
            let slicer = Slicer::new(&compiler, &tree, plane, query)?;
            let detail = ImageDetail { fineness: Fineness::Resolution(*pixels), samples: 1 };
            let picture = slicer.picture(&slicer.rectangle()?, mode, &detail).run()?;
            write_png(&coarse(&picture), &mut bytes)?;
        }
        Drawing::Quadtree { cells, pixels } => {
            let plane = Plane::default();
            let slicer = Slicer::new(&compiler, &tree, &plane, Query::FIELD)?;
            let detail = Detail { fineness: Fineness::Resolution(*cells), block: Some(1), quadtree: true };
            let contour = slicer.contour(&slicer.rectangle()?, &detail).run()?;
            let style = Style {
                stroke_width: 1.0 / 600.0,
                fill: Paint::None,
                quadtree: true,
                circles: circles(&tree, &plane),
                pixels: *pixels,
                ..Style::default()
            };
            write_svg(&contour, &style, &mut bytes)?;
        }
    }
    Ok(bytes)
}

/// The same picture with channels in steps of [`STEP`]: the last bits of soft shadows and slow
/// gradients take half of a file, and nobody sees them.
fn coarse(picture: &Picture) -> Picture {
    let step = |channel: u8| channel.saturating_add(STEP / 2) / STEP * STEP;
    let white = |channel: u8| if channel > u8::MAX - STEP { u8::MAX } else { step(channel) };
    let pixels = picture.pixels().iter().map(|pixel| pixel.map(white)).collect();
    Picture::new(picture.width(), picture.height(), pixels).expect("as many pixels as before")
}

/// Reads and checks a scene, of whatever format.
fn tree(root: &Path, scene: &Scene) -> Result<CheckedTree, Box<dyn Error>> {
    let (path, text) = match scene {
        Scene::Splash => return Ok(splash::model().check()?),
        Scene::File(path) => (path.clone(), fs::read(path)?),
        Scene::Readme => {
            let path = root.join("README.md");
            let page = fs::read_to_string(&path)?;
            (path.with_extension("jbt"), first_scene(&page).into_bytes())
        }
    };
    let name = path.display().to_string();
    let files = text::files::Files::new(Arc::new(SceneFolder::of(&name)));
    let particles = looks::particles(&path.file_name().unwrap_or_default().to_string_lossy());
    let options = text::Options { files, particles, ..text::Options::default() };
    Ok(jbt::Scene::from_reader(&name, text.as_slice(), &options)?.check()?)
}

/// The first scene of a page: a fenced block that begins with the format.
fn first_scene(page: &str) -> String {
    let lines = page.lines().skip_while(|line| *line != "jbt 1");
    lines.take_while(|line| *line != "```").flat_map(|line| [line, "\n"]).collect()
}
