//! Files of other programs: converted, chosen from, mirrored, shown the right way up.

use crate::folder::Folder;

/// A blob with a bump above and one to the right, and another blob that is declared.
const POV: &str = "
#declare Other = blob { threshold 0.5 sphere { 0, 2, 1 } }
blob { threshold 0.5 sphere { 0, 1, 1 pigment { rgb <1, 0.5, 0> } } sphere { 2*y, 0.5, 1 } sphere { x, 1, 0.75 } }
";
const RIB: &str = "Blobby 1 [1001 0] [1 0 0 0 0 1 0 0 0 0 1 0 0.5 0 0 1] [\"\"]\n";
const JSON: &str = r##"{"type": "RootNode", "children": [{"type": "ScalisPoint", "volType": "dist", "density": 1,
"materials": [{"color": "#ff8800"}], "v": [{"position": {"x": 0, "y": 0, "z": 0}, "thickness": 1}]}]}"##;
const POINTS: &str = "x,y,z\n0.25,0.5,-0.125\n0,2.25,0\n-0.5,0.125,0.25\n";

fn folder() -> Folder {
    Folder::new().with("a.pov", POV).with("a.rib", RIB).with("a.json", JSON).with("points.csv", POINTS)
}

fn answers(folder: &Folder, scene: &str) -> String {
    folder.jbt(&["eval", scene, "--points", "points.csv", "--query", "all", "-o", "-", "-q"]).code(0).stdout()
}

#[test]
fn a_converted_scene_is_the_same() {
    let folder = folder();
    for (scene, stands) in [
        ("a.pov", "orientation up y handed left"),
        ("a.rib", "orientation up y handed left"),
        ("a.json", "orientation up y handed right"),
    ] {
        let told = folder.jbt(&["convert", scene, "-o", "out.jbt"]).code(0).stdout();
        assert!(told.starts_with("out.jbt: ") && told.contains(" nodes, "), "{told}");
        assert_eq!(answers(&folder, "out.jbt"), answers(&folder, scene), "{scene}");
        let text = folder.jbt(&["convert", scene, "-o", "-", "-q"]).code(0).stdout();
        assert!(text.starts_with("jbt 1\n") && text.contains(stands), "{text}");
        assert_eq!(text, folder.jbt(&["show", scene, "--stage", "tree", "-q"]).code(0).stdout());
        let again = folder.jbt(&["convert", "out.jbt", "-o", "-", "-q"]).code(0).stdout();
        assert_eq!(again, text);
    }
    // Without -o it is called like the scene, and nothing is replaced.
    folder.jbt(&["convert", "a.rib"]).code(0);
    assert!(folder.path("a.jbt").is_file());
    folder.jbt(&["convert", "a.pov"]).code(2).says("a.jbt");
    folder.jbt(&["convert", "a.jbt", "-o", "a.jbt"]).code(2).says("would replace it");
    folder.jbt(&["convert", "a.rib", "-o", "a.glb"]).code(2).says("does not end with .jbt");
}

#[test]
fn an_object_is_chosen() {
    let folder = folder();
    let field = |object: &[&str]| {
        let words = [&["eval", "a.pov", "--points", "points.csv", "-o", "-", "-q"], object].concat();
        folder.jbt(&words).code(0).stdout().lines().nth(1).unwrap().rsplit(',').next().unwrap().to_owned()
    };
    // (1 - d^2/4)^2 at the squared distance 0.328125.
    let other: f32 = field(&["--object", "Other"]).parse().unwrap();
    assert!((other - 0.842_666_6).abs() < 1e-6, "{other}");
    assert_ne!(field(&[]), field(&["--object", "Other"]));
    assert_eq!(field(&[]), field(&["--object", "1"]));
    folder.jbt(&["check", "a.pov", "--object", "Othr"]).code(1).says("perhaps Other");
    folder.jbt(&["check", "a.rib", "--object", "Other"]).code(2).says("it has no objects to choose");
}

/// The longest reach of a mesh along each axis of a file.
fn reach(folder: &Folder, words: &[&str]) -> [[f64; 2]; 3] {
    let all = [&["mesh", "a.pov", "-o", "a.obj", "--force", "-q", "--resolution", "32"], words].concat();
    folder.jbt(&all).code(0);
    let text = std::fs::read_to_string(folder.path("a.obj")).unwrap();
    let mut reach = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for line in text.lines().filter_map(|line| line.strip_prefix("v ")) {
        for (axis, word) in line.split(' ').take(3).enumerate() {
            let at: f64 = word.parse().unwrap();
            reach[axis] = [reach[axis][0].min(at), reach[axis][1].max(at)];
        }
    }
    reach
}

#[test]
fn a_mesh_is_upright_and_its_mirror_image_is_another() {
    let folder = Folder::new()
        .with("a.pov", "blob { threshold 0.5 sphere { 0, 1, 1 } sphere { y, 1, 1 } sphere { 0.5*z, 1, 1 } }");
    // OBJ has y up, and z to the viewer: where POV-Ray's z leads away.
    let [_, [low, high], [near, far]] = reach(&folder, &[]);
    assert!(high > 1.5 && low > -0.9 && near < -1.0 && far < 0.7, "{low} {high} {near} {far}");
    let [_, upright, [near, far]] = reach(&folder, &["--mirror"]);
    assert_eq!(upright, [low, high]);
    assert!(far > 1.0 && near > -0.7, "{near} {far}");
    let [_, [low, high], [down, up]] = reach(&folder, &["--up", "z"]);
    assert!(up > 1.5 && down > -0.9 && high > 1.0 && low > -0.7, "{low} {high} {down} {up}");
    // A picture is mirrored too.
    let picture = |words: &[&str]| {
        let all = [
            &["render", "a.pov", "-o", "-", "-q", "--size", "64x48", "--view", "left", "--quality", "draft"],
            words,
        ];
        folder.jbt(&all.concat()).code(0).stdout_bytes().to_vec()
    };
    assert_ne!(picture(&[]), picture(&["--mirror"]));
}

/// A table does not say which of its axes points up.
#[test]
fn a_table_stands_as_it_is_told_to() {
    let folder = Folder::new().with("a.csv", "x,y,z\n0,0,0\n0,1,0\n");
    let low_and_high = |words: &[&str]| {
        let all = [&["mesh", "a.csv", "-o", "a.obj", "--radius", "0.4", "--resolution", "16", "-q"], words];
        folder.jbt(&[&all.concat()[..], &["--force"]].concat()).code(0);
        let text = std::fs::read_to_string(folder.path("a.obj")).unwrap();
        let heights =
            text.lines().filter_map(|line| line.strip_prefix("v ")?.split(' ').nth(1)?.parse().ok());
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y: f64| [low.min(y), high.max(y)])
    };
    assert!(low_and_high(&[])[1] < 0.5);
    let [low, high] = low_and_high(&["--scene-up", "y"]);
    assert!(low > -0.5 && high > 1.3, "{low} {high}");
    folder.jbt(&["convert", "a.csv", "-o", "a.jbt", "--radius", "0.4", "--scene-up", "y"]).code(0);
    let text = std::fs::read_to_string(folder.path("a.jbt")).unwrap();
    assert!(text.contains("\norientation up y"), "{text}");
    folder.jbt(&["check", "a.csv", "--scene-up", "x"]).code(2).says("expected y or z");
}

#[test]
fn errors_of_files_have_places() {
    let folder = Folder::new()
        .with("loop.pov", "blob {\n  #while (1) sphere { 0, 1, 1 } #end\n}")
        .with("plane.rib", "Blobby 1 [1003 0 0]\n[1 2 3 4] [\"depth.z\"]")
        .with("bad.json", "{\"type\": \"RootNode\",\n \"children\": [{\"type\": \"Rici\"}]}");
    folder.jbt(&["check", "loop.pov"]).code(1).says("loop.pov:2:4: error: the loop never ends");
    folder.jbt(&["check", "plane.rib"]).code(1).says("plane.rib:1:10: error: ").says("`depth.z`");
    folder
        .jbt(&["check", "bad.json"])
        .code(1)
        .says("bad.json:2:24: error: there is no node of the type Rici");
}

/// Arrays of VTK that zlib has compressed, also where this package is built alone.
#[test]
fn compressed_arrays_are_read() {
    let array = "AQAAABgAAAAAAAAAEgAAAA==eJxjYEAGDfZAwgGIHAAJTwGA";
    let folder = Folder::new().with(
        "a.vtp",
        format!(
            "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" compressor=\"vtkZLibDataCompressor\"><PolyData>
            <Piece NumberOfPoints=\"2\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">
            {array}</DataArray></Points></Piece></PolyData></VTKFile>"
        ),
    );
    let text = folder.jbt(&["convert", "a.vtp", "--radius", "1", "-o", "-", "-q"]).code(0).stdout();
    assert!(text.contains("at ((0 0 0) (1 2 3))"), "{text}");
}
