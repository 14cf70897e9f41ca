//! Models as Rust: what is printed of every example and of a text with all members is compiled here, and
//! builds the same model.
//!
//! `BLESS=1 cargo test --release -p jbt --test rust` writes `tests/golden/rust/` again; the next run compiles
//! it.

use std::collections::BTreeMap;

use jbt::text::{hash, print, print_rust};
use jbt::tree::Visit;
use jbt::{Model, Tree};
use jbt_testkit::golden;
use jbt_testkit::scene;

/// What the examples have not: falloffs with numbers that follow parameters, particles, parts, constants and
/// names that Rust has for itself.
const MEMBERS: &str = r#"jbt 1
iso 0.25
origin (1 2 3)
orientation up y handed left
param box = 0.5 in 0 .. 2 step 0.5 "A box"
param Größe = 2 * box
param on = 1
attribute rough 1 default 0.5 dominant
attribute uv 2
attribute five 5
attribute grain direction default (0 0 1) dominant
style wax = { rough 0.25 constant material "wax" }
let fn = point { at (0 0 box) surface_radius box falloff blinn { hardness 1 + box edge exact } strength -(-Größe) }
part "hub" {
    fn: union { use fn translate (1 0 0) { use fn } }
    constant material "steel \ 5" { rough box / 2 { override constant part -17 { polyline { points ((0 0 0) (1 0 box)) radii (0.1 0.2) closed yes radius 1 } } } }
    style wax { point { at (2 0 0) radius 1 } }
    override style wax { point { at (4 0 0) radius 1 } }
    rfunction intersection order 2 { select on { empty use fn } point { radius 1 } }
    blend ricci 2 + box { use fn blend ricci -3 { use fn } }
    smooth_difference width box { use fn particles { at ((0 0 0) (1 0 0)) radius (1 2) strength 0.5 falloff wyvill color ((1 0 0) (0 1 0)) with rough 0.5 } }
}
part "rim" {
    shell thickness 0.1 { clamp low 0 high box { offset by -0.1 { complement { affine (1 0 0 box 0 1 0 0 0 0 1 0) { point { radius 1 } } } } } }
    override uv scale (2 box) rotate 90 { five (1 2 3 4 5) { color noise { a (1 0 0) b (0 box 1) size 0.5 seed 7 octaves 2 } { point { radius 1 } } } }
    color expression { r = length(x, y), (r, 1 - r, mod(z, box)) } { twist axis y rate box weighted { ring { ring_radius 1 radius 1 } use fn } }
    grain (1 0 box) { use fn }
    warp (x - 0.5 * sin(y * 2), y ^ 2, tan(z)) { point { radius 1 } }
    expression within (-1 -1 -1) to (1 1 box) { d = -field(fn) ^ 0.5, max(d * d, blinn { hardness 2 edge smooth }(atan2(x, box))) - pow(ceil(box), -2) }
}
"#;

macro_rules! models {
    ($($name:ident)+) => {
        $( #[allow(clippy::all, clippy::pedantic)] mod $name {
            include!(concat!("golden/rust/", stringify!($name), ".txt"));
        } )+

        /// The models that the printed functions build, by the names of their files.
        fn built() -> BTreeMap<&'static str, Model> {
            [$( (stringify!($name), $name::model()) ),+].into()
        }
    };
}

models! {
    attributes blend bonsai castle circles falloffs formulas goblet gyroid hero holes koi machine members monocle
    mood peanut potion ricci seashell skeletons smooth succulent temple textures twist uv warps whirl
}

/// Every example and the text of members, by the names of files.
fn scenes() -> Vec<(String, Model)> {
    let examples = scene::examples().into_iter();
    let read =
        |(file, text): (String, String)| (file.trim_end_matches(".jbt").to_owned(), scene::model(&text));
    examples.map(read).chain([("members".to_owned(), scene::model(MEMBERS))]).collect()
}

/// The names of the nodes along every path.
fn names(tree: &Tree) -> Vec<Option<&str>> {
    tree.prefix(Visit::Nodes).map(|tree| tree.node().name()).collect()
}

#[test]
fn what_is_printed_is_what_is_compiled_here() {
    let mut failures = String::new();
    for (name, model) in scenes() {
        let path = golden::folder("rust").join(format!("{name}.txt"));
        let expected = std::fs::read_to_string(&path).unwrap_or_default();
        let found = print_rust(&model);
        if found != expected {
            golden::differ(&path, &expected, &found, &mut failures);
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

#[test]
fn what_is_compiled_builds_the_same_model() {
    let built = built();
    let scenes = scenes();
    assert_eq!(built.len(), scenes.len(), "a scene without its line in `models!`");
    for (name, read) in scenes {
        let built = &built[&*name];
        assert_eq!(hash(built), hash(&read), "{name}:\n{}\n{}", print(built), print(&read));
        assert_eq!(names(&built.root), names(&read.root), "{name}");
        assert_eq!(built.root.count(), read.root.count(), "{name}: what is shared stays shared");
        built.check().unwrap_or_else(|errors| panic!("{name}: {errors}"));
    }
}
