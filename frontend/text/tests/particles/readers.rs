//! What each reader takes, and what it says of files that are wrong.

use jbt_model::kind::NodeKind;
use jbt_model::particles::Particles;
use jbt_text::Options;
use jbt_text::import::SceneFormat;
use jbt_text::import::particles::{ParticleForm, ParticleOptions};

fn options() -> ParticleOptions {
    ParticleOptions { radius: Some(0.5), ..ParticleOptions::default() }
}

fn try_read(
    name: &str,
    bytes: &[u8],
    particles: &ParticleOptions,
) -> Result<(Particles, Vec<String>), String> {
    let options = Options { particles: particles.clone(), ..Options::default() };
    let format = SceneFormat::of(name, bytes).map_err(|error| error.to_string())?;
    let read = format.read(name, bytes, &options).map_err(|error| error.to_string())?;
    let tree = read.model.check().map_err(|error| error.to_string())?;
    let NodeKind::Particles(particles) = &tree.node(tree.root()).kind else { panic!("it is one node") };
    Ok((particles.clone(), read.warnings.iter().map(|one| one.message.clone()).collect()))
}

#[track_caller]
fn read(name: &str, bytes: &[u8]) -> Particles {
    try_read(name, bytes, &options()).unwrap_or_else(|error| panic!("{error}")).0
}

fn places(particles: &Particles) -> Vec<[f64; 3]> {
    (0..particles.len()).map(|index| particles.at(index).to_array()).collect()
}

const TWO: [[f64; 3]; 2] = [[0.5, 1.0, -2.0], [3.0, 4.5, 5.0]];

/// An array of numpy with these numbers.
fn npy(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let dict = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((dict.len() as u16).to_le_bytes());
    bytes.extend(dict.bytes());
    bytes.extend(data);
    bytes
}

fn bytes_of<const N: usize>(numbers: &[f64], to: fn(f64) -> [u8; N]) -> Vec<u8> {
    numbers.iter().flat_map(|&number| to(number)).collect()
}

#[test]
fn arrays_of_numpy_in_all_orders() {
    let rows: Vec<f64> = TWO.concat();
    let planes: Vec<f64> = (0..3).flat_map(|axis| TWO.map(|place| place[axis])).collect();
    for (bytes, what) in [
        (npy("<f4", "False", "(2, 3)", &bytes_of(&rows, |x| (x as f32).to_le_bytes())), "f4"),
        (npy(">f8", "False", "(2, 3)", &bytes_of(&rows, f64::to_be_bytes)), "big"),
        (npy("<f8", "True", "(2, 3)", &bytes_of(&planes, f64::to_le_bytes)), "fortran"),
        (npy("<f8", "False", "(3, 2)", &bytes_of(&planes, f64::to_le_bytes)), "planes"),
        (npy("<f4", "True", "(3, 2)", &bytes_of(&rows, |x| (x as f32).to_le_bytes())), "planes of fortran"),
    ] {
        assert_eq!(places(&read("a.npy", &bytes)), TWO, "{what}");
        assert_eq!(places(&read("-", &bytes)), TWO, "{what}, by its content");
    }
    let sized: Vec<f64> = vec![0.5, 1.0, -2.0, 0.25, 3.0, 4.5, 5.0, 0.75];
    let bytes = npy("<f8", "False", "(2, 4)", &bytes_of(&sized, f64::to_le_bytes));
    let (found, _) = try_read("a.npy", &bytes, &ParticleOptions::default()).unwrap();
    assert_eq!((places(&found), found.radius(0), found.radius(1)), (TWO.to_vec(), 0.5, 1.5));
    let columns = ["radius", "z", "y", "x"].map(str::to_owned).to_vec();
    let (found, _) =
        try_read("a.npy", &bytes, &ParticleOptions { columns, ..ParticleOptions::default() }).unwrap();
    assert_eq!((found.at(1).to_array(), found.radius(0)), ([0.75, 5.0, 4.5], 1.0));
    let whole = npy("<i4", "False", "(1, 3)", &bytes_of(&[1.0, -2.0, 3.0], |x| (x as i32).to_le_bytes()));
    assert_eq!(places(&read("a.npy", &whole)), [[1.0, -2.0, 3.0]]);
}

#[test]
fn tables_of_text() {
    for text in [
        "x,y,z\n0.5,1,-2\n3,4.5,5",
        "0.5 1 -2\r\n3 4.5 5\r\n",
        "# places\n\"z\";\"x\";\"y\"\n-2;0.5;1\n5; 3; 4.5\n",
        "id\tz\ty\tx\nfirst\t-2\t1\t.5\nsecond\t5e0\t4.5\t3",
    ] {
        assert_eq!(places(&read("a.csv", text.as_bytes())), TWO, "{text}");
    }
    let text = b"x,y,z,radius,r,g,b,strength,heat,age\n0,0,0,0.5,255,0,0,2,7,1\n1,0,0,0.25,0,0,255,1,8,2";
    let wanted = ParticleOptions { values: vec!["heat".to_owned()], ..ParticleOptions::default() };
    let (found, warnings) = try_read("a.csv", text, &wanted).unwrap();
    assert_eq!((found.radius(0), found.radius(1), found.strength(0)), (1.0, 0.5, 2.0));
    let values = |name: &str| found.values_of(name).unwrap().of(1).collect::<Vec<f64>>();
    assert_eq!((values("color"), values("heat")), (vec![0.0, 0.0, 1.0], vec![8.0]));
    assert_eq!(warnings, ["`age` is left out: --values makes attributes of them"]);
    let (_, warnings) = try_read("a.csv", b"0,0,0\n0,0,0\n1,1,1", &options()).unwrap();
    assert_eq!(warnings, ["1 point stands where another one does: they add up"]);
}

#[test]
fn xyz_files_of_three_kinds() {
    let frames = b" 1\ncomment\nC12 0.5 1 -2 9 9\n\n2\n\nXx 0 0 0\n8 1.0D+00 0 0\n";
    let (first, _) = try_read("a.xyz", frames, &ParticleOptions::default()).unwrap();
    assert_eq!((places(&first), first.radius(0)), (vec![TWO[0]], 3.4));
    let second = ParticleOptions { frame: Some(2), ..ParticleOptions::default() };
    let (second, warnings) = try_read("a.xyz", frames, &second).unwrap();
    assert_eq!((second.radius(0), second.radius(1), second.at(1).x), (4.0, 3.04, 1.0));
    assert_eq!(warnings, ["1 atom is of no known element: radius 2, pink"]);
    let extended = b"1\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=id:I:1:pos:R:3:species:S:1\n7 0.5 1 -2 O";
    let (found, _) = try_read("a.xyz", extended, &ParticleOptions::default()).unwrap();
    assert_eq!((places(&found), found.radius(0)), (vec![TWO[0]], 3.04));
    assert_eq!(places(&read("a.xyz", b"0.5 1 -2\n3 4.5 5\n")), TWO);
    let colored = read("a.xyz", b"0.5 1 -2 1 0 0\n3 4.5 5 0 0 1\n");
    assert_eq!(colored.values_of("color").unwrap().of(1).collect::<Vec<f64>>(), [0.0, 0.0, 1.0]);
    let raw = bytes_of(&TWO.concat(), |x| (x as f32).to_le_bytes());
    assert_eq!(places(&read("a.xyz", &raw)), TWO);
}

#[test]
fn polygon_files() {
    let head = |coding: &str| {
        format!(
            "ply\nformat {coding} 1.0\ncomment c\nelement edge 1\nproperty list uchar int ends\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float radius\nend_header\n"
        )
    };
    let text = head("ascii") + "2 0 1\n0.5 1 -2 255 0 0 0.25\n3 4.5 5 0 0 255 0.5\n";
    let mut all = vec![text.into_bytes()];
    for (coding, big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let mut bytes = head(coding).into_bytes();
        let int = |x: i32| if big { x.to_be_bytes() } else { x.to_le_bytes() };
        let float = |x: f64| if big { (x as f32).to_be_bytes() } else { (x as f32).to_le_bytes() };
        bytes.push(2);
        bytes.extend([int(0), int(1)].concat());
        for (place, (color, radius)) in TWO.iter().zip([([255, 0, 0], 0.25), ([0, 0, 255], 0.5)]) {
            bytes.extend(place.iter().flat_map(|&x| float(x)));
            bytes.extend(color);
            bytes.extend(float(radius));
        }
        all.push(bytes);
    }
    for bytes in &all {
        let (found, _) = try_read("a.ply", bytes, &ParticleOptions::default()).unwrap();
        assert_eq!((places(&found), found.radius(1)), (TWO.to_vec(), 1.0));
        assert_eq!(found.values_of("color").unwrap().of(0).collect::<Vec<f64>>(), [1.0, 0.0, 0.0]);
    }
}

#[test]
fn files_of_vtk() {
    let text = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0.5 1 -2 3\n4.5 5\nVERTICES 2 4\n1 0\n1 1\nPOINT_DATA 2\nSCALARS mass float\nLOOKUP_TABLE default\n7 8\nFIELD FieldData 2\nid 1 2 int\n4 5\nvelocity 3 2 double\n1 2 3 4 5 6\n";
    let wanted = |names: &[&str]| ParticleOptions {
        values: names.iter().map(|&name| name.to_owned()).collect(),
        ..options()
    };
    let (found, _) = try_read("a.vtk", text.as_bytes(), &wanted(&["mass", "velocity"])).unwrap();
    assert_eq!(places(&found), TWO);
    let of = |name: &str| found.values_of(name).unwrap().of(1).collect::<Vec<f64>>();
    assert_eq!((of("mass"), of("velocity")), (vec![8.0], vec![4.0, 5.0, 6.0]));
    let error = try_read("a.vtk", text.as_bytes(), &wanted(&["heat"])).unwrap_err();
    assert!(error.contains("points have no array `heat`"), "{error}");
    let mut binary =
        b"# vtk DataFile Version 2.0\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 2 double\n".to_vec();
    binary.extend(bytes_of(&TWO.concat(), f64::to_be_bytes));
    binary.extend(b"\nCELLS 0 0\nPOINT_DATA 2\nSCALARS mass float 1\nLOOKUP_TABLE default\n");
    binary.extend(bytes_of(&[7.0, 8.0], |x| (x as f32).to_be_bytes()));
    let (found, _) = try_read("a.vtk", &binary, &wanted(&["mass"])).unwrap();
    assert_eq!(
        (places(&found), found.values_of("mass").unwrap().of(1).collect::<Vec<f64>>()),
        (TWO.to_vec(), vec![8.0])
    );
}

/// A text in base64.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |chunk: &[u8]| {
        let mut three = [0; 3];
        three[..chunk.len()].copy_from_slice(chunk);
        let bits = u32::from_be_bytes([0, three[0], three[1], three[2]]);
        let letter = |place: u32| LETTERS[(bits >> (18 - 6 * place)) as usize & 63] as char;
        let kept = |place: u32| if place <= chunk.len() as u32 { letter(place) } else { '=' };
        (0..4).map(kept).collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}

#[test]
fn files_of_vtk_in_xml() {
    let data = bytes_of(&TWO.concat(), |x| (x as f32).to_le_bytes());
    let file = |settings: &str, array: &str, behind: &[u8]| {
        let mut bytes = format!("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" {settings}>\n<UnstructuredGrid><Piece NumberOfPoints=\"2\" NumberOfCells=\"0\"><PointData><DataArray type=\"Int32\" Name=\"id\" format=\"ascii\">4 5</DataArray></PointData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" {array}</DataArray></Points></Piece></UnstructuredGrid>").into_bytes();
        bytes.extend(behind);
        bytes.extend(b"</VTKFile>");
        bytes
    };
    let length = (data.len() as u32).to_le_bytes();
    let long = (data.len() as u64).to_le_bytes();
    let appended = |data: &[u8], coding: &str| {
        [format!("<AppendedData encoding=\"{coding}\">\n _").as_bytes(), data, b"</AppendedData>"].concat()
    };
    let packed = miniz_oxide::deflate::compress_to_vec_zlib(&data, 6);
    let head: Vec<u8> =
        [1, data.len(), 0, packed.len()].iter().flat_map(|&word| (word as u32).to_le_bytes()).collect();
    for (bytes, what) in [
        (file("", "format=\"ascii\">\n0.5 1 -2\n3 4.5 5\n", b""), "text"),
        (
            file("", &format!("format=\"binary\">\n{}\n", base64(&[&length[..], &data].concat())), b""),
            "base64",
        ),
        (
            file(
                "header_type=\"UInt64\"",
                "format=\"appended\" offset=\"0\">",
                &appended(&[&long[..], &data].concat(), "raw"),
            ),
            "raw",
        ),
        (
            file(
                "",
                "format=\"appended\" offset=\"0\">",
                &appended(base64(&[&length[..], &data].concat()).as_bytes(), "base64"),
            ),
            "base64 behind",
        ),
        (
            file(
                "compressor=\"vtkZLibDataCompressor\"",
                &format!("format=\"binary\">{}{}", base64(&head), base64(&packed)),
                b"",
            ),
            "compressed",
        ),
        (
            file(
                "compressor=\"vtkZLibDataCompressor\"",
                "format=\"appended\" offset=\"0\">",
                &appended(&[&head[..], &packed].concat(), "raw"),
            ),
            "compressed raw",
        ),
    ] {
        if what.starts_with("compressed") && !cfg!(feature = "zlib") {
            let error = try_read("a.vtu", &bytes, &options()).unwrap_err();
            assert!(error.contains("arrays compressed by vtkZLibDataCompressor"), "{error}");
            continue;
        }
        let wanted = ParticleOptions { values: vec!["id".to_owned()], ..options() };
        let (found, _) = try_read("a.vtu", &bytes, &wanted).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert_eq!(places(&found), TWO, "{what}");
        assert_eq!(found.values_of("id").unwrap().of(1).collect::<Vec<f64>>(), [5.0], "{what}");
    }
}

#[test]
fn radii_and_forms_are_options() {
    let text = b"0 0 0\n1 0 0";
    let error = try_read("a.csv", text, &ParticleOptions::default()).unwrap_err();
    assert!(error.contains("the points have no radius of their own"), "{error}");
    let blinn = ParticleOptions { form: Some(ParticleForm::Blinn(2.0)), scale: Some(0.5), ..options() };
    let (found, _) = try_read("a.csv", text, &blinn).unwrap();
    assert_eq!((found.radius(0), found.strength(0)), (1.0, 2.0_f64.exp()));
    let error = try_read("a.jbt", b"jbt 1 point { radius 1 }", &options()).unwrap_err();
    assert!(error.contains("no particles for options to be about"), "{error}");
}

/// Errors of files that are wrong, with their places.
#[test]
fn what_is_wrong_is_told() {
    let long = |text: &str| text.as_bytes().to_vec();
    for (name, bytes, expected) in [
        ("a.csv", long("x,y\n1,2"), "a.csv:1:1: error: this line tells no places"),
        ("a.csv", "1,".repeat(5000).into_bytes(), "a.csv:1:8193: limit: the line has more than 4096 columns"),
        ("a.csv", long("1,2,3\n4,5"), "a.csv:2:1: error: a line of 2 columns"),
        ("a.csv", long("1,2,3\n4,5,six"), "a.csv:2:5: error: column 3 is `six`"),
        ("a.csv", long("1,2,3\n4,5,nan"), "a.csv:2:5: error: column 3 is `nan`"),
        ("a.csv", long(""), "the file has no lines"),
        ("a.csv", long("1,2,1e300"), "the position of particle 0"),
        ("a.xyz", long("3\n\nC 0 0 0\n"), "the frame ends after 1 atoms"),
        ("a.xyz", long("99999999999\n\nC 0 0 0\n"), "the frame ends after 1 atoms"),
        ("a.xyz", long("1\n\nC 0 zero 0\n"), "a.xyz:3:5: error: a coordinate is `zero`"),
        ("a.xyz", vec![0, 1, 2, 3, 4], "5 bytes, which are neither text nor points"),
        ("a.pdb", long("HEADER\nEND"), "there are no atoms"),
        (
            "a.pdb",
            long("ATOM      1  CA  ALA A   1      11.104  xx.134  -6.504"),
            "a.pdb:1:41: error: y is `xx.134`",
        ),
        ("a.cif", long("data_x\nloop_\n_atom_site.Cartn_x\n1\n"), "atoms have no places"),
        (
            "a.cif",
            long("data_x\nloop_\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n1 2\n"),
            "the last row of atoms is cut off",
        ),
        ("a.npy", npy("|O", "False", "(1, 3)", b""), "an array of type |O"),
        ("a.npy", npy("<f4", "False", "(3,)", &[0; 12]), "the array has not two axes"),
        ("a.npy", npy("<f4", "False", "(1, 5)", &[0; 20]), "an array of shape (1, 5)"),
        ("a.npy", npy("<f4", "False", "(99999999999999999999, 3)", &[0; 12]), "the array has not two axes"),
        ("a.npy", npy("<f4", "False", "(4611686018427387904, 4)", &[0; 12]), "12 bytes of numbers"),
        ("a.npy", npy("<f4", "False", "(0, 3)", b""), "there are no points"),
        (
            "a.npy",
            npy("<f4", "False", "(1, 3)", &f32::NAN.to_le_bytes().repeat(3)),
            "point 0 is at (NaN NaN NaN)",
        ),
        (
            "a.ply",
            long("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
            "the vertices have no places",
        ),
        (
            "a.ply",
            long(
                "ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
            ),
            "the file ends after 0 elements",
        ),
        (
            "a.vtk",
            long("# vtk DataFile Version 2.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 9999999999 float\n1 2 3\n"),
            "the file ends after 3 of 29999999997 numbers",
        ),
        (
            "a.vtk",
            long("# vtk DataFile Version 2.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 2 float\n1 2 3\n"),
            "the file ends after 1 of 6 numbers",
        ),
        ("a.vtu", long("<VTKFile type=\"ImageData\">"), "a file without points"),
        (
            "a.vtu",
            long("<VTKFile type=\"PolyData\"><Points><DataArray type=\"Float32\" format=\"binary\">////////"),
            "the array is cut off",
        ),
    ] {
        let error = try_read(name, &bytes, &options()).expect_err(expected);
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

/// What a file says besides what is read: a warning names it.
#[test]
fn nothing_is_left_out_silently() {
    let two = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOINT_DATA 1\nSCALARS heat float 1\nLOOKUP_TABLE default\n1\nFIELD F 1\nvel 3 1 double\n1 2 3\n";
    let xml = "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"1\"><PointData><DataArray type=\"Float32\" Name=\"heat\">1</DataArray></PointData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">0 0 0</DataArray></Points></Piece></PolyData></VTKFile>";
    let faces = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int ends\nend_header\n0 0 0\n3 0 0 0\n";
    let line = "ATOM      1  C   UNK A   1       0.000   0.000   0.000  1.00  0.00           C\n";
    let models = format!("MODEL        1\n{line}ENDMDL\nMODEL        2\n{line}ENDMDL\n");
    let tags =
        ["Cartn_x", "Cartn_y", "Cartn_z", "pdbx_PDB_model_num"].map(|tag| format!("_atom_site.{tag}\n"));
    let cif = format!("data_x loop_\n{} 0 0 0 1 0 0 0 2 0 0 0 3\n", tags.concat());
    let wide: String = (0..12).map(|n| format!(",c{n}")).collect();
    for (name, text, expected) in [
        ("a.vtk", two, "`heat`, `vel` are left out: --values makes attributes of them"),
        ("a.vtu", xml, "`heat` is left out: --values makes attributes of them"),
        ("a.ply", faces, "`face` is left out: vertices alone are read"),
        ("a.pdb", &models, "1 more model is left out: --frame chooses one"),
        ("a.cif", &cif, "2 more models are left out: --frame chooses one"),
        ("a.xyz", "1\n\nC 0 0 0\n1\n\nC 1 0 0\n", "1 more frame is left out: --frame chooses one"),
        ("a.xyz", "1\n\nC 0 0 0\nC 1 0 0\n", "what begins no frame is left out, up to the end"),
        ("a.xyz", "1\nProperties=species:S:1:pos:R:3:forces:R:3\nC 0 0 0 9 9 9\n", "`forces` is left out"),
        (
            "a.csv",
            &format!("x,y,z{wide}\n0,0,0{}\n", ",1".repeat(12)),
            "`c0`, `c1`, `c2`, `c3`, `c4`, `c5`, `c6`, `c7` and 4 more are left out: --values makes attributes of them",
        ),
    ] {
        let (_, warnings) = try_read(name, text.as_bytes(), &options()).unwrap();
        let is_known = |one: &&String| !one.contains("element");
        assert_eq!(warnings.iter().filter(is_known).collect::<Vec<_>>(), [expected], "{name}: {text}");
    }
    // Whoever chooses a frame, or asks for an array, knows of the others.
    let chosen = ParticleOptions { frame: Some(2), ..options() };
    assert_eq!(try_read("a.pdb", models.as_bytes(), &chosen).unwrap().1, [""; 0]);
    let asked = ParticleOptions { values: vec!["vel".into()], ..options() };
    let (_, warnings) = try_read("a.vtk", two.as_bytes(), &asked).unwrap();
    assert_eq!(warnings, ["`heat` is left out: --values makes attributes of them"]);
    // No format takes names of arrays that it has not.
    for (name, text) in [("a.xyz", "1\n\nC 0 0 0\n"), ("a.csv", "0 0 0\n"), ("a.pdb", line), ("a.vtu", xml)] {
        let error = try_read(name, text.as_bytes(), &asked).expect_err(name);
        assert!(error.contains("points have no array `vel`"), "{name}: {error}");
    }
}

/// Atoms are known without an ending, clouds are not.
#[test]
fn atoms_are_known_by_their_content() {
    for (text, expected) in [
        ("2\nwater\nO 0 0 0.1\nH 0 1 0\n", SceneFormat::Xyz),
        (" 1 \n\n8 0 0 1.0D+00", SceneFormat::Xyz),
        ("2\n\nO 0 0\n", SceneFormat::Jbt),
        ("jbt 1\npoint { radius 1 }\n", SceneFormat::Jbt),
        ("1 2 3\n4 5 6\n7 8 9\n", SceneFormat::Jbt),
    ] {
        assert_eq!(SceneFormat::of_content(text.as_bytes()), expected, "{text}");
    }
}

/// Every beginning of a good file, and files with a byte changed, give an answer.
#[test]
fn no_file_is_too_wrong() {
    let files: Vec<(&str, Vec<u8>)> = vec![
        ("a.npy", npy("<f8", "True", "(2, 3)", &bytes_of(&TWO.concat(), f64::to_le_bytes))),
        ("a.ply", b"ply\nformat binary_little_endian 1.0\nelement f 1\nproperty list uchar int a\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0".to_vec()),
        ("a.vtk", b"# vtk DataFile Version 5.1\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n1 2 3\nMETADATA\n\nPOINT_DATA 1\nFIELD F 1\nm 1 1 float\n3\n".to_vec()),
        ("a.vtu", b"<VTKFile type=\"PolyData\" compressor=\"vtkZLibDataCompressor\"><Points><DataArray type=\"Float32\" format=\"binary\">AQAAABgAAAAAAAAAAAAAAA==AAAA</DataArray></Points><AppendedData encoding=\"raw\">_".to_vec()),
        ("a.cif", b"data_x\nloop_\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n_atom_site.type_symbol\n1 2 3 'C'\n;text\n;\n4 5 6\n".to_vec()),
        ("a.pdb", b"MODEL\nATOM      1  CA  ALA A   1      11.104   6.134  -6.504  1.00  0.00           C\nENDMDL\n".to_vec()),
        ("a.xyz", b"1\nProperties=species:S:1:pos:R:3\nC 0 0 0\n2\n\nC 1 1 1\n".to_vec()),
        ("a.csv", b"x,y,z,radius\n1,2,3,4\n".to_vec()),
    ];
    let mut rng = fastrand::Rng::with_seed(5);
    let (plain, wanted) =
        (options(), ParticleOptions { values: vec!["m".to_owned()], frame: Some(2), ..options() });
    for (name, file) in &files {
        for length in 0..file.len() {
            let _ = try_read(name, &file[..length], &options());
        }
        for _ in 0..3000 {
            let mut bytes = file.clone();
            for _ in 0..rng.usize(1..4) {
                let at = rng.usize(0..bytes.len());
                bytes[at] = if rng.bool() { rng.u8(..) } else { b"0129.-+ \n\"';_<>="[rng.usize(0..16)] };
            }
            let _ = try_read(name, &bytes, if rng.bool() { &wanted } else { &plain });
        }
    }
}
