//! Files of every format stand the right way up, with the light that they say.

use jbt_model::orientation::{Handed, ModelUp, Orientation};

use super::super::tests::{bytes, parse_glb, reals, tetrahedron, three_mf_model};
use super::super::*;

/// The positions in a file of the tetrahedron as other programs place them.
fn placed(options: &ExportOptions, format: Format) -> Vec<[f32; 3]> {
    let mut file = Vec::new();
    write_with(&tetrahedron(), format, options, &mut file).unwrap();
    let triples = |bytes: &[u8]| reals(bytes).as_chunks().0.to_vec();
    match format {
        Format::Glb => {
            let (json, binary) = parse_glb(&file);
            let rotation = &json["nodes"][0]["rotation"];
            let turned = rotation.is_array();
            if turned {
                // Half the angle is 45 degrees, and x turns from y to z: (x, y, z) to (x, z, -y).
                let half = 0.5_f64.sqrt();
                let expected = [-half, 0.0, 0.0, half];
                let near = |(index, expected): (usize, f64)| {
                    (rotation[index].as_f64().unwrap() - expected).abs() < 1e-15
                };
                assert!(expected.into_iter().enumerate().all(near));
            }
            let places = triples(&binary[..48]);
            places.into_iter().map(|[x, y, z]| if turned { [x, z, 0.0 - y] } else { [x, y, z] }).collect()
        }
        Format::Ply => {
            let end = b"end_header\n";
            let start = file.windows(end.len()).position(|w| w == end).unwrap() + end.len();
            (0..4).flat_map(|vertex| triples(&file[start + 67 * vertex..start + 67 * vertex + 12])).collect()
        }
        Format::Obj => {
            let text = String::from_utf8(file).unwrap();
            let lines = text.lines().filter_map(|line| line.strip_prefix("v "));
            lines
                .map(|line| [0, 1, 2].map(|axis| line.split(' ').nth(axis).unwrap().parse().unwrap()))
                .collect()
        }
        Format::Usda => {
            let text = String::from_utf8(file).unwrap();
            assert!(text.contains(&format!("upAxis = \"{}\"", options.up_in(format).name().to_uppercase())));
            let list = text.split_once("points = [").unwrap().1.split_once(']').unwrap().0;
            let real = |word: &str| word.trim_matches(['(', ')', ' ', '\n']).parse::<f32>().unwrap();
            list.split(',').map(real).collect::<Vec<f32>>().as_chunks().0.to_vec()
        }
        Format::ThreeMf => {
            let text = three_mf_model(&file);
            let lines = text.lines().filter_map(|line| line.strip_prefix("<vertex "));
            let real = |line: &str, axis: usize| line.split('"').nth(2 * axis + 1).unwrap().parse().unwrap();
            lines.map(|line| [0, 1, 2].map(|axis| real(line, axis))).collect()
        }
        Format::Stl => {
            // The first corner of the first triangle, then the second of the second, and so on.
            let corner = |facet: usize, corner: usize| {
                let start = 84 + 50 * facet + 12 + 12 * corner;
                triples(&file[start..start + 12])[0]
            };
            vec![corner(0, 0), corner(1, 1), corner(0, 1), corner(1, 2)]
        }
    }
}

#[test]
fn files_are_the_right_way_up() {
    let third = 1.0_f32 / 3.0;
    let z_up = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [0.0, 1.0, 0.0], [-0.0, third, 1e-7]];
    let y_up = vec![[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.0, 0.0, -1.0], [-0.0, 1e-7, -third]];
    let usual = Format::ALL.map(|format| match format {
        Format::Glb | Format::Obj => (format, &y_up),
        Format::Ply | Format::Stl | Format::ThreeMf | Format::Usda => (format, &z_up),
    });
    for (format, expected) in usual {
        assert_eq!(&placed(&ExportOptions::default(), format), expected, "{format}");
        for (up, expected) in [(Up::Y, &y_up), (Up::Z, &z_up)] {
            let options = ExportOptions { up: Some(up), ..ExportOptions::default() };
            assert_eq!(&placed(&options, format), expected, "{format}, {up} up");
        }
    }
    // The normal of a facet turns with it.
    let options = ExportOptions { up: Some(Up::Y), ..ExportOptions::default() };
    let (mut turned, plain) = (Vec::new(), bytes(&tetrahedron(), Format::Stl));
    write_with(&tetrahedron(), Format::Stl, &options, &mut turned).unwrap();
    let ([x, y, z], turned) = (reals(&plain[84..96]).try_into().unwrap(), reals(&turned[84..96]));
    assert_eq!(turned, Up::Y.place([x, y, z]));
}

#[test]
fn models_that_stand_otherwise_are_the_right_way_up_too() {
    let y_right = Orientation { up: ModelUp::Y, handed: Handed::Right };
    let mut mesh = Mesh { orientation: y_right, ..tetrahedron() };
    let obj = |mesh: &Mesh, up: Up| {
        let options = ExportOptions { up: Some(up), ..ExportOptions::default() };
        let mut file = Vec::new();
        write_with(mesh, Format::Obj, &options, &mut file).unwrap();
        String::from_utf8(file).unwrap()
    };
    let lines = |text: &str, begin: &str| -> Vec<String> {
        text.lines().filter_map(|line| line.strip_prefix(begin)).map(str::to_owned).collect()
    };
    let places = |text: &str| -> Vec<[f32; 3]> {
        let numbers = |line: &String| {
            let numbers: Vec<f32> = line.split(' ').take(3).map(|word| word.parse().unwrap()).collect();
            [numbers[0], numbers[1], numbers[2]]
        };
        lines(text, "v ").iter().map(numbers).collect()
    };
    // As it is, where the file has y up as well; turned about x, where it has z up.
    assert_eq!(places(&obj(&mesh, Up::Y)), mesh.positions);
    let turned: Vec<[f32; 3]> = mesh.positions.iter().map(|[x, y, z]| [*x, 0.0 - z, *y]).collect();
    assert_eq!(places(&obj(&mesh, Up::Z)), turned);
    let (json, _) = parse_glb(&bytes(&mesh, Format::Glb));
    assert!(json["nodes"][0]["rotation"].is_null());

    // Left-handed axes are mirrored, and triangles turned around: a closed mesh has the same volume again.
    mesh.orientation.handed = Handed::Left;
    let file = obj(&mesh, Up::Y);
    let mirrored: Vec<[f32; 3]> = mesh.positions.iter().map(|[x, y, z]| [*x, *y, 0.0 - z]).collect();
    assert_eq!(places(&file), mirrored);
    assert_eq!(lines(&file, "vn ")[3], "0 0 -1");
    assert_eq!(lines(&file, "f ")[0], "1//1 2//2 3//3");
    assert_eq!(lines(&obj(&tetrahedron(), Up::Y), "f ")[0], "1//1 3//3 2//2");
    let right = mesh.right_handed();
    assert_eq!((right.orientation, &right.attributes.len()), (y_right, &mesh.attributes.len()));
    assert_eq!(right.right_handed().positions, right.positions);
}

#[test]
fn half_the_light_is_188() {
    let grey = Attribute { name: "color".to_owned(), width: 3, values: vec![0.5; 12] };
    let mesh = Mesh { attributes: vec![grey], ..tetrahedron() };
    let file = |format, colors| {
        let mut file = Vec::new();
        write_with(&mesh, format, &ExportOptions { colors, ..ExportOptions::default() }, &mut file).unwrap();
        file
    };
    let ply = |colors| {
        let file = file(Format::Ply, colors);
        let end = b"end_header\n";
        let start = file.windows(end.len()).position(|w| w == end).unwrap() + end.len() + 24;
        [file[start], file[start + 1], file[start + 2]]
    };
    assert_eq!(ply(None), [188; 3]);
    assert_eq!(ply(Some(ColorEncoding::Srgb)), [188; 3]);
    assert_eq!(ply(Some(ColorEncoding::Linear)), [128; 3]);
    let obj = |colors| {
        let text = String::from_utf8(file(Format::Obj, colors)).unwrap();
        let line = text.lines().find(|line| line.starts_with("v ")).unwrap().to_owned();
        line.split(' ').skip(4).map(|word| word.parse().unwrap()).collect::<Vec<f32>>()
    };
    assert_eq!(obj(None), [0.735_357; 3]);
    assert_eq!(obj(Some(ColorEncoding::Linear)), [0.5; 3]);
    let glb = |colors| {
        let file = file(Format::Glb, colors);
        reals(&parse_glb(&file).1[96..108])
    };
    assert_eq!(glb(None), [0.5; 3]);
    assert_eq!(glb(Some(ColorEncoding::Srgb)), [0.735_357; 3]);
}

#[test]
fn words_are_those_that_print() {
    for format in Format::ALL {
        assert_eq!(format.to_string().parse(), Ok(format));
    }
    for up in Up::ALL {
        assert_eq!(up.to_string().parse(), Ok(up));
    }
    for encoding in ColorEncoding::ALL {
        assert_eq!(encoding.to_string().parse(), Ok(encoding));
    }
    assert_eq!("x".parse::<Up>().unwrap_err().to_string(), "\"x\" is none of: y, z");
}
