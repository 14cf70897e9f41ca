//! What there is to draw.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use jbt::contour::{ImageMode, Plane};
use jbt::render::Render;
use jbt_testkit::samples;

use crate::looks;

/// The size of a member's picture, in pixels.
const MEMBER: [u32; 2] = [200, 150];

/// Pixels along the longer side of a member's slice.
const SLICE: usize = 160;

/// Samples of other programs that have a picture. They are no part of the project: a machine without them
/// keeps the pictures.
const SAMPLES: [&str; 5] = [
    "brlcad/moss.asc",
    "particles/1A8O.pdb",
    "particles/1A8O.cif",
    "particles/free_particles_125_particles.vtk",
    "parsip/train_corrected.scene",
];

/// A picture of the documentation.
pub struct Entry {
    /// The file in `docs/pictures/`, without its extension.
    pub name: String,
    pub scene: Scene,
    pub drawing: Drawing,
}

/// Where a scene comes from.
pub enum Scene {
    /// A file.
    File(PathBuf),
    /// The first scene of the README.
    Readme,
    /// The particles of `examples/particles.rs`.
    Splash,
}

/// What is drawn of a scene.
pub enum Drawing {
    Render(Box<Render>),
    /// An image of a slice, so many pixels along its longer side.
    Slice {
        plane: Plane,
        mode: ImageMode,
        pixels: usize,
    },
    /// A contour and its quadtree, so many cells along their longer side.
    Quadtree {
        cells: usize,
        pixels: u32,
    },
}

impl Entry {
    /// The file in `docs/pictures/`.
    pub fn file(&self) -> String {
        let extension = match self.drawing {
            Drawing::Render(_) | Drawing::Slice { .. } => "png",
            Drawing::Quadtree { .. } => "svg",
        };
        format!("{}.{extension}", self.name)
    }
}

/// All pictures: the examples, those of other programs, what the table has besides, the steps of the
/// tutorial, the members.
pub fn entries(root: &Path) -> Result<Vec<Entry>, Box<dyn Error>> {
    let mut entries = Vec::new();
    for scene in scenes(&root.join("examples"))? {
        let name = stem(&scene);
        let drawing = Drawing::Render(Box::new(looks::example(&name)));
        entries.push(Entry { name, scene: Scene::File(scene), drawing });
    }
    let mut foreign = paths(&root.join("examples/foreign"))?;
    foreign.sort();
    foreign.extend(SAMPLES.map(|name| samples::root().join(name)).into_iter().filter(|path| path.exists()));
    entries.extend(foreign.into_iter().map(|scene| {
        let name = scene.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let drawing = Drawing::Render(Box::new(looks::example(&name)));
        Entry { name: format!("foreign/{name}"), scene: Scene::File(scene), drawing }
    }));
    entries.extend(looks::extras(root)?);
    for scene in scenes(&root.join("docs/tutorial"))? {
        let drawing = Drawing::Render(Box::new(looks::step()));
        entries.push(Entry {
            name: format!("tutorial/{}", stem(&scene)),
            scene: Scene::File(scene),
            drawing,
        });
    }
    let mut families: Vec<PathBuf> = paths(&root.join("docs/members"))?;
    families.sort();
    for family in families {
        for scene in scenes(&family)? {
            let name = format!("members/{}/{}", stem(&family), stem(&scene));
            let drawing = member(&scene)?;
            entries.push(Entry { name, scene: Scene::File(scene), drawing });
        }
    }
    Ok(entries)
}

/// How a member is shown: its first line says it, `# render` or `# slice z=0`.
fn member(scene: &Path) -> Result<Drawing, Box<dyn Error>> {
    let text = fs::read_to_string(scene)?;
    let first = text.lines().next().unwrap_or_default();
    if first == "# render" {
        return Ok(Drawing::Render(Box::new(looks::member(
            &stem(scene.parent().expect("a folder")),
            MEMBER,
        ))));
    }
    let plane = first.strip_prefix("# slice ").ok_or("the first line says how to look at it")?;
    Ok(Drawing::Slice { plane: plane.parse()?, mode: ImageMode::Field, pixels: SLICE })
}

/// The scenes of a folder, by name.
fn scenes(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut found = paths(folder)?;
    found.retain(|path| path.extension().is_some_and(|extension| extension == "jbt"));
    found.sort();
    Ok(found)
}

fn paths(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let entries = fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    entries.collect()
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
