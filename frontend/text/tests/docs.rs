//! The pages of `docs/` are true: they name every member with all its parameters, their values and defaults;
//! and every scene in them, in the README and in `docs/members/`, where each member has one that shows it, is
//! a good model. Every member and every example has its picture.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use jbt_model::check::CheckedTree;
use jbt_model::combine::CombinatorKind;
use jbt_model::diagnostic::{Diagnostics, Source};
use jbt_model::falloff::FalloffKind;
use jbt_model::field::{Field, FieldKind, FieldValue};
use jbt_model::map::MapKind;
use jbt_model::skeleton::SkeletonKind;
use jbt_model::texture::TextureKind;
use jbt_model::warp::WarpKind;
use jbt_text::import::SceneFormat;
use jbt_text::import::particles::ParticleOptions;
use jbt_text::{COMMON_FIELDS, Options, functions, parse};

/// What stands before a scene that does not begin with its format: the group and the subtrees that examples
/// use.
const HEAD: &str = "jbt 1
    attribute uv 2
    let a = point { at (-0.3 0 0) radius 1 }
    let b = point { at (0.3 0 0) radius 1 }
    let d = sphere { sphere_radius 0.3 radius 0.5 }
";

/// What the pages tell about that is in no list, by page.
const UNLISTED: [(&str, &str); 9] = [
    ("attributes", "blend"),
    ("attributes", "dominant"),
    ("attributes", "expression"),
    ("attributes", "uv"),
    ("expressions", "expression"),
    ("expressions", "falloff"),
    ("expressions", "field"),
    ("expressions", "within"),
    ("warps", "warp"),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn page(name: &str) -> String {
    std::fs::read_to_string(root().join("docs").join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The lines between the heading of a member and the next heading.
fn section<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let heading = format!("### `{name}`");
    let mut lines = page.lines().skip_while(|line| *line != heading);
    assert!(lines.next().is_some(), "a heading {heading}");
    lines.take_while(|line| !line.starts_with('#')).collect()
}

fn numbers(values: &[f64]) -> String {
    let shown: Vec<String> = values.iter().map(f64::to_string).collect();
    format!("({})", shown.join(" "))
}

/// What a parameter may be, as the tables say it.
fn values(kind: FieldKind) -> String {
    match kind {
        FieldKind::Real => "any".to_owned(),
        FieldKind::Positive => "> 0".to_owned(),
        FieldKind::NonNegative => ">= 0".to_owned(),
        FieldKind::Within { least, most } => format!("{} .. {most}", fraction(least)),
        FieldKind::Choice(words) => words.join(", "),
        FieldKind::Count => format!("whole, 0 .. {}", jbt_ir::limits::MAX_COPIES),
        FieldKind::Whole { least, most } => format!("whole, {least} .. {most}"),
        FieldKind::Degrees => "0 .. 360".to_owned(),
        FieldKind::Position => "3 numbers".to_owned(),
        FieldKind::Extents => "3 numbers >= 0".to_owned(),
        FieldKind::Stretches => "3 numbers > 0".to_owned(),
        FieldKind::Direction => "direction".to_owned(),
        FieldKind::Axis => "x, y, z".to_owned(),
        FieldKind::Positions => "points".to_owned(),
        FieldKind::Lengths => "numbers >= 0".to_owned(),
        FieldKind::Flag => "yes, no".to_owned(),
        FieldKind::Rows => "12 numbers".to_owned(),
    }
}

/// A number, as a fraction if that is shorter.
fn fraction(number: f64) -> String {
    let (plain, inverse) = (number.to_string(), format!("1/{}", number.recip()));
    if inverse.len() < plain.len() { inverse } else { plain }
}

/// The default of a parameter, as the tables say it.
fn default(field: &Field) -> String {
    match (&field.default, field.kind) {
        (None, _) => "required".to_owned(),
        (Some(FieldValue::Real(place)), FieldKind::Choice(words)) => words[*place as usize].to_owned(),
        (Some(FieldValue::Real(flag)), FieldKind::Flag) => if *flag == 0.0 { "no" } else { "yes" }.to_owned(),
        (Some(FieldValue::Vector(axis)), FieldKind::Axis) => {
            let place = axis.iter().position(|x| *x == 1.0).expect("an axis");
            ["x", "y", "z"][place].to_owned()
        }
        (Some(FieldValue::Real(number)), _) => number.to_string(),
        (Some(FieldValue::Vector(vector)), _) => numbers(vector),
        (Some(FieldValue::Reals(list)), _) => numbers(list),
        (Some(FieldValue::Vectors(list)), _) => numbers(list.as_flattened()),
    }
}

/// A member has a section, whose table has a row for each of its parameters and no others, and a scene.
fn has_member(family: &str, name: &str, fields: &[Field], word: impl Fn(&Field) -> String) {
    has_scene(family, name);
    let page = page(&format!("{family}.md"));
    let lines = section(&page, name);
    for field in fields {
        let row = format!("| `{}` | {} | {} |", word(field), values(field.kind), default(field));
        assert!(lines.iter().any(|line| line.starts_with(&row)), "`{name}`: a row {row}");
    }
    let rows = lines.iter().filter(|line| line.starts_with("| `")).count();
    assert_eq!(rows, fields.len(), "`{name}`: as many rows as parameters");
    assert!(lines.contains(&"```jbt"), "`{name}`: an example");
}

fn own_word(field: &Field) -> String {
    field.name.to_owned()
}

#[test]
fn all_textures() {
    for kind in TextureKind::ALL {
        has_member("attributes", kind.name(), kind.fields(), own_word);
    }
}

#[test]
fn all_skeletons() {
    for kind in SkeletonKind::ALL {
        has_member("skeletons", kind.name(), kind.fields(), |field| match field.name {
            name if COMMON_FIELDS.contains(&name) => format!("{}_{name}", kind.name()),
            name => name.to_owned(),
        });
    }
    let page = page("skeletons.md");
    for name in COMMON_FIELDS {
        assert!(page.contains(&format!("| `{name}` |")), "{name}");
    }
}

#[test]
fn all_falloffs() {
    let page = page("falloffs.md");
    for kind in FalloffKind::ALL {
        has_member("falloffs", kind.name(), kind.fields(), own_word);
        let aliases: Vec<String> = kind.aliases().iter().map(|alias| format!("`{alias}`")).collect();
        let row = format!("| `{}` | {} |", kind.name(), aliases.join(", "));
        assert!(page.lines().any(|line| line.starts_with(&row)), "a row {row}");
    }
}

#[test]
fn all_warps_and_maps() {
    for kind in WarpKind::ALL {
        has_member("warps", kind.name(), kind.fields(), own_word);
    }
    let page = page("warps.md");
    for kind in MapKind::ALL {
        let name = kind.name();
        has_scene("warps", name);
        let text = section(&page, name).join("\n");
        assert!(text.contains("```jbt"), "`{name}`: an example");
        for field in kind.fields().iter().filter(|_| kind.is_named()) {
            assert!(text.contains(&format!("`{}`", field.name)), "`{name}`: {}", field.name);
        }
    }
}

#[test]
fn all_operators() {
    let page = page("operators.md");
    for kind in CombinatorKind::ALL {
        has_scene("operators", kind.name());
        let text = section(&page, kind.name()).join("\n");
        assert!(text.contains("```jbt"), "`{}`: an example", kind.name());
        for field in kind.fields() {
            let words = if let FieldKind::Choice(words) = field.kind { words } else { &[field.name][..] };
            for word in words {
                assert!(text.contains(word), "`{}`: {word}", kind.name());
            }
        }
    }
    has_scene("operators", "select");
    assert!(section(&page, "select").contains(&"```jbt"));
}

#[test]
fn all_functions() {
    let page = page("expressions.md");
    let table: String = page.lines().filter(|line| line.starts_with("| `")).collect();
    for name in functions() {
        assert!(table.contains(&format!("`{name}(")), "{name}");
        has_scene("expressions", name);
    }
}

#[test]
fn what_has_no_list_has_a_scene() {
    for (family, name) in UNLISTED {
        has_scene(family, name);
    }
}

/// A scene of `docs/members/` begins with a comment that says how to look at it, `# render` or `# slice z=0`,
/// is a good model with an end, and uses its member.
fn has_scene(family: &str, name: &str) {
    let path = root().join("docs/members").join(family).join(format!("{name}.jbt"));
    let shown = path.display().to_string();
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{shown}: {error}"));

    let first = text.lines().next().expect("a line");
    let plane = first.strip_prefix("# slice ").and_then(|plane| plane.split_once('='));
    let slice = plane.is_some_and(|(axis, at)| ["x", "y", "z"].contains(&axis) && at.parse::<f64>().is_ok());
    assert!(slice || first == "# render", "{shown} says how to look at it");

    let code: String = text.lines().flat_map(|line| line.split('#').next()).collect::<Vec<_>>().join("\n");
    let mut words = code.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    assert!(words.any(|word| word == name), "{shown} shows `{name}`");
    let support = model(&shown, &text).support();
    assert!(support.low().iter().chain(&support.high()).all(|side| side.abs() < 4.0), "{shown} has an end");

    let picture = format!("pictures/members/{family}/{name}.png");
    has_picture(&picture);
    assert!(page(&format!("{family}.md")).contains(&format!("({picture})")), "{family}.md shows {picture}");
}

/// There is such a file in `docs/`, and it is a picture.
fn has_picture(name: &str) {
    let bytes =
        std::fs::read(root().join("docs").join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let start: &[u8] = if name.ends_with(".svg") { b"<svg" } else { b"\x89PNG\r\n\x1a\n" };
    assert!(bytes.starts_with(start), "{name} is a picture");
}

/// Every example has a picture in the gallery that leads to it, and a caption that begins with its name and
/// its text.
#[test]
fn all_examples_are_in_the_gallery() {
    let gallery = page("gallery.md");
    for path in entries("examples", "jbt") {
        let name = path.file_stem().and_then(|stem| stem.to_str()).expect("a name");
        let shown = format!("<a href=\"../examples/{name}.jbt\"><img src=\"pictures/{name}.png\"");
        assert!(gallery.contains(&shown), "gallery.md shows `{name}`");
        let link = format!("[`{name}`](../examples/{name}.jbt). ");
        let caption = gallery.split_once(&link).map(|(_, rest)| rest.split('|').next().unwrap_or_default());
        assert!(caption.is_some_and(|caption| caption.len() > 20), "gallery.md says what `{name}` shows");
    }
}

/// Every file of another format is read without a complaint about its shape, and has a picture in the gallery
/// and on the page of its format.
#[test]
fn files_of_other_programs_have_pictures() {
    let (gallery, mut formats) = (page("gallery.md"), BTreeSet::new());
    let pages: String = ["readers.md", "brlcad.md", "particles.md"].map(page).concat();
    for entry in std::fs::read_dir(root().join("examples/foreign")).expect("a folder of the project") {
        let path = entry.expect("it can be read").path();
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
        let bytes = std::fs::read(&path).expect("it can be read");
        let format = SceneFormat::of(name, &bytes).expect("a scene");
        let mut options = Options::default();
        if format == SceneFormat::Vtu {
            // Its points have no radii.
            let values = vec!["speed".to_owned()];
            options.particles = ParticleOptions { radius: Some(0.24), values, ..ParticleOptions::default() };
        }
        let read = format.read(name, &bytes, &options).unwrap_or_else(|errors| panic!("{errors}"));
        read.model.check().unwrap_or_else(|errors| panic!("{errors}"));
        for warning in &*read.warnings {
            let is_of_a_picture =
                ["camera", "light_source"].iter().any(|word| warning.message.contains(word));
            assert!(is_of_a_picture, "{name}: {}", warning.message);
        }
        formats.insert(format.text());
        let picture = format!("pictures/foreign/{name}.png");
        has_picture(&picture);
        assert!(gallery.contains(&format!("<a href=\"../examples/foreign/{name}\"><img src=\"{picture}\"")));
        assert!(pages.contains(&format!("({picture})")), "a page of its format shows {name}");
    }
    assert!(formats.len() >= 9, "{formats:?}");
}

/// The pictures of all pages and of the README are there, and none is there that no page shows.
#[test]
fn pictures_and_pages_belong_together() {
    let mut pages: Vec<PathBuf> = entries("docs", "md");
    pages.push(root().join("README.md"));
    let texts: Vec<String> =
        pages.iter().map(|path| std::fs::read_to_string(path).expect("it can be read")).collect();
    let all = texts.join("\n");
    for (at, _) in all.match_indices("pictures/") {
        let name = all[at..].split(['"', ')', '`', ' ', '\n']).next().unwrap_or_default();
        if name != "pictures/" {
            has_picture(name);
        }
    }
    let folders = ["docs/pictures", "docs/pictures/foreign"];
    let pictures = folders
        .iter()
        .flat_map(|folder| ["png", "svg"].into_iter().flat_map(|extension| entries(folder, extension)));
    for path in pictures {
        let path = path.strip_prefix(root().join("docs")).expect("a path below the pages");
        let name = path.display().to_string();
        assert!(all.contains(&name), "a page shows {name}");
    }
}

/// Every step of the tutorial is in its page as it is in its file, in order, and has a picture.
#[test]
fn the_tutorial_has_its_steps() {
    let page = page("tutorial.md");
    let mut steps = entries("docs/tutorial", "jbt");
    steps.sort();
    assert!(steps.len() >= 5);
    let mut rest = page.as_str();
    for path in steps {
        let name = path.file_stem().and_then(|stem| stem.to_str()).expect("a name");
        let text = std::fs::read_to_string(&path).expect("it can be read");
        let picture = format!("pictures/tutorial/{name}.png");
        let shown = format!(
            "[`{name}.jbt`](tutorial/{name}.jbt):\n\n```jbt\n{text}```\n\n![Step {}]({picture})",
            &name[..1]
        );
        let (_, after) =
            rest.split_once(&shown).unwrap_or_else(|| panic!("the tutorial shows {name} in its place"));
        has_picture(&picture);
        rest = after;
    }
}

/// Reads a text and checks it. Panics with all that is wrong.
fn model(name: &str, text: &str) -> CheckedTree {
    let source = Source { name, text: text.as_bytes() };
    let shown =
        |errors: Diagnostics| -> String { errors.iter().map(|error| source.render(error) + "\n").collect() };
    let model =
        parse(text.as_bytes(), &Options::default()).unwrap_or_else(|errors| panic!("{}", shown(errors)));
    model.check().unwrap_or_else(|errors| panic!("{}", shown(errors)))
}

/// The files of a folder with this extension.
fn entries(folder: &str, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join(folder)).expect("a folder of the project");
    let paths = entries.map(|entry| entry.expect("it can be read").path());
    paths.filter(|path| path.extension().and_then(|found| found.to_str()) == Some(extension)).collect()
}

/// The scenes of a page, each with the line that it begins at: blocks marked `jbt`, and indented ones that
/// begin with the format.
fn scenes(page: &str) -> Vec<(usize, String)> {
    let mut scenes: Vec<(usize, String)> = Vec::new();
    let mut lines = page.lines().enumerate().peekable();
    while let Some((at, line)) = lines.next() {
        let mut scene = String::new();
        if line == "```jbt" {
            for (_, inside) in lines.by_ref().take_while(|(_, inside)| *inside != "```") {
                scene += &format!("{inside}\n");
            }
        } else if line == "    jbt 1" {
            scene += &format!("{line}\n");
            while let Some((_, inside)) = lines.next_if(|(_, inside)| inside.starts_with("    ")) {
                scene += &format!("{inside}\n");
            }
        } else {
            continue;
        }
        scenes.push((at + 1, scene));
    }
    scenes
}

#[test]
fn every_scene_is_a_model() {
    let mut count = 0;
    for path in entries("docs", "md").into_iter().chain([root().join("README.md")]) {
        let page = std::fs::read_to_string(&path).expect("it can be read");
        for (line, scene) in scenes(&page) {
            let text = if scene.trim_start().starts_with("jbt 1") { scene } else { format!("{HEAD}{scene}") };
            model(&format!("{}:{line}", path.display()), &text);
            count += 1;
        }
    }
    assert!(count > 70, "{count} scenes");
}

#[test]
fn every_page_is_linked_from_the_readme() {
    let readme = std::fs::read_to_string(root().join("README.md")).expect("the project has a README");
    for path in entries("docs", "md") {
        let link = format!("(docs/{})", path.file_name().expect("a name").display());
        assert!(readme.contains(&link), "{link}");
    }
}
