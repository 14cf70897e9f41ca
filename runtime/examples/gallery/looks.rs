//! How scenes are looked at where the usual way is not the best one, and the pictures that show more than an
//! example.

use std::error::Error;
use std::path::Path;

use jbt::Box3;
use jbt::contour;
use jbt::import::particles::ParticleOptions;
use jbt::render::{Background, Quality, Render, RenderMode, Stance, View};

use crate::list::{Drawing, Entry, Scene};

/// From where an example is seen, and how large.
struct Look {
    from: [f64; 3],
    size: [u32; 2],
    zoom: f64,
}

/// The usual look: that of [`View::default`].
const USUAL: Look = Look { from: [1.0, -0.62, 0.5], size: [400, 300], zoom: 1.0 };

/// The looks of examples that have one of their own.
const LOOKS: [(&str, Look); 19] = [
    ("attributes", Look { from: [1.0, -0.2, 0.35], ..USUAL }),
    ("blend", Look { from: [1.0, -0.3, 1.4], size: [400, 266], ..USUAL }),
    ("castle", Look { from: [0.5, -1.0, 0.55], size: [1200, 900], ..USUAL }),
    ("circles", Look { from: [0.3, -1.0, 2.2], size: [400, 266], ..USUAL }),
    ("falloffs", Look { from: [1.0, -0.12, 1.1], size: [400, 250], ..USUAL }),
    ("gyroid", Look { size: [900, 675], ..USUAL }),
    ("hero", Look { size: [1200, 900], ..USUAL }),
    ("koi", Look { from: [1.0, -0.3, 1.5], size: [400, 266], ..USUAL }),
    ("machine", Look { from: [1.0, -0.5, 1.0], ..USUAL }),
    ("monocle", Look { from: [1.0, -0.62, 0.9], size: [400, 250], ..USUAL }),
    ("mood", Look { from: [1.0, -0.25, 0.15], size: [300, 300], ..USUAL }),
    ("peanut", Look { from: [0.35, -1.0, 0.35], size: [400, 233], ..USUAL }),
    ("ricci", Look { from: [1.0, -0.12, 0.25], size: [400, 200], ..USUAL }),
    ("seashell", Look { from: [0.6, -1.0, 0.3], ..USUAL }),
    ("skeletons", Look { from: [1.0, -0.12, 0.9], size: [480, 288], ..USUAL }),
    ("smooth", Look { from: [1.0, -0.3, 0.9], size: [400, 250], ..USUAL }),
    ("succulent", Look { from: [1.0, -0.62, 0.9], size: [900, 675], ..USUAL }),
    ("temple", Look { size: [1200, 900], ..USUAL }),
    ("textures", Look { from: [1.0, 0.35, 0.8], size: [400, 266], ..USUAL }),
];

/// The picture of an example.
pub fn example(name: &str) -> Render {
    let own = LOOKS.iter().find(|(known, _)| *known == name);
    let render = rendered(own.map_or(&USUAL, |(_, look)| look));
    match particles(name).values.first() {
        Some(shown) => Render { mode: RenderMode::Attribute(shown.clone()), ..render },
        None => render,
    }
}

/// What files of particles leave open; the array that is read is shown.
pub fn particles(name: &str) -> ParticleOptions {
    let options = ParticleOptions::default();
    match name {
        "1A8O.cif" => ParticleOptions { scale: Some(0.7), ..options },
        "crown.vtu" => ParticleOptions { radius: Some(0.24), values: vec!["speed".to_owned()], ..options },
        "free_particles_125_particles.vtk" => ParticleOptions { radius: Some(1.6), ..options },
        _ => options,
    }
}

/// The picture of a member of this family.
pub fn member(family: &str, size: [u32; 2]) -> Render {
    // The balls of the textures are open on the other side.
    let from = if family == "attributes" { [1.0, 0.3, 0.6] } else { USUAL.from };
    rendered(&Look { from, size, ..USUAL })
}

/// The picture of a step of the tutorial.
pub fn step() -> Render {
    rendered(&USUAL)
}

fn rendered(look: &Look) -> Render {
    let view = View { stance: Stance::From(look.from), zoom: look.zoom, ..View::default() };
    Render { size: look.size, view, quality: Quality::Good, antialias: 2, ..Render::default() }
}

/// The pictures besides one for each example.
pub fn extras(root: &Path) -> Result<Vec<Entry>, Box<dyn Error>> {
    let file = |name: &str| Scene::File(root.join("examples").join(format!("{name}.jbt")));
    let render = |name: &str, scene, render| Entry {
        name: name.to_owned(),
        scene,
        drawing: Drawing::Render(Box::new(render)),
    };
    let slice = |name: &str, scene, plane: &str, mode| -> Result<Entry, Box<dyn Error>> {
        let drawing = Drawing::Slice { plane: plane.parse()?, mode, pixels: 400 };
        Ok(Entry { name: name.to_owned(), scene, drawing })
    };
    let hero = rendered(&USUAL);
    let with = |mode: RenderMode, background| Render { mode, background, ..hero.clone() };
    let front = Box3::new([-1.8, 0.0, -0.6], [1.8, 1.8, 1.6]);
    let splash = Look { from: [1.0, -0.62, 0.55], size: [480, 288], ..USUAL };
    Ok(vec![
        render(
            "readme",
            Scene::Readme,
            rendered(&Look { from: [0.75, -0.45, 0.95], size: [300, 300], ..USUAL }),
        ),
        render("particles", Scene::Splash, rendered(&splash)),
        render("hero_normals", file("hero"), with(RenderMode::Normal, None)),
        render("hero_depths", file("hero"), with(RenderMode::Depth, None)),
        render(
            "hero_evaluations",
            file("hero"),
            with(RenderMode::Evaluations, Some(Background::Color([0; 3]))),
        ),
        render("hero_cut", file("hero"), Render { region: Some(front), ..hero.clone() }),
        slice("hero_slice", file("hero"), "z=0.1", contour::ImageMode::Field)?,
        slice("circles_field", file("circles"), "z=0", contour::ImageMode::Field)?,
        slice("circles_height", file("circles"), "z=0", contour::ImageMode::Height)?,
        slice("gyroid_slice", file("gyroid"), "0,0,0, 1,-1,0, 0,0,1", contour::ImageMode::Field)?,
        Entry {
            name: "circles_quadtree".to_owned(),
            scene: file("circles"),
            drawing: Drawing::Quadtree { cells: 64, pixels: 480 },
        },
    ])
}
