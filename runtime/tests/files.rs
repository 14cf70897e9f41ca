//! The page about mesh files is true: its table is that of the formats.

use jbt::export::{Conventions, Format, LengthUnit};

fn row(conventions: &Conventions) -> String {
    let &Conventions {
        extension,
        title,
        up,
        normals,
        colors,
        uv,
        attributes,
        name,
        constants,
        far,
        unit,
        splits: _,
        materials: _,
    } = conventions;
    let (place, encoding) = match colors {
        Some(colors) => (colors.place, colors.encoding.name()),
        None => ("none", ""),
    };
    let (uv, attributes) = (uv.unwrap_or("none"), attributes.unwrap_or("none"));
    format!(
        "| `.{extension}` | {title} | {up} | {place} | {encoding} | {normals} | {uv} | {attributes} | {} | {} | {} | {} |",
        name.unwrap_or("none"),
        constants.unwrap_or("none"),
        far.name(),
        unit.map_or("none", LengthUnit::name)
    )
}

#[test]
fn the_page_has_the_table_of_formats() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/files.md");
    let page = std::fs::read_to_string(path).expect("a page about files");
    let found: Vec<&str> = page.lines().filter(|line| line.starts_with("| `.")).collect();
    let expected: Vec<String> = Format::ALL.iter().map(|format| row(format.conventions())).collect();
    assert_eq!(found, expected);
}
