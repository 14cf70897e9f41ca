//! Files that texts name besides scenes: particles, and what POV-Ray scenes include.

use std::sync::Arc;

use jbt_model::particles::NumberArray;
use jbt_model::walk::walk;
use jbt_model::written::Written;
use jbt_text::files::{FileRequest, Files, NamedFile, ResolveError, Resolver};
use jbt_text::import::SceneFormat;
use jbt_text::{Options, parse, print};

/// Files in memory.
struct Memory(Vec<(&'static str, &'static [u8])>);

impl Resolver for Memory {
    fn resolve(&self, request: &FileRequest<'_>) -> Result<NamedFile, ResolveError> {
        let path = request.joined();
        let (_, bytes) = self.0.iter().find(|(name, _)| *name == path).ok_or(ResolveError::Missing)?;
        Ok(NamedFile { identity: path.clone(), path, bytes: bytes.to_vec() })
    }
}

fn options(files: &[(&'static str, &'static [u8])]) -> Options {
    Options { files: Files::new(Arc::new(Memory(files.to_vec()))), ..Options::default() }
}

const TABLE: &[u8] = b"x,y,z,radius,heat\n0,0,0,1,5\n3,0,0,0.5,7\n";
const SECRET: &[u8] = b"x,y,z\n1,2,3\nroot:secret:0\n";

#[test]
fn particles_of_a_file_are_those_of_a_list() {
    let options = options(&[("a.csv", TABLE)]);
    let read = |text: &str| parse(text.as_bytes(), &options).unwrap_or_else(|error| panic!("{error}"));
    let listed = "jbt 1 particles { at ((0 0 0) (3 0 0)) surface_radius (1 0.5) }";
    assert_eq!(read("jbt 1 particles { file \"a.csv\" }"), read(listed));
    let one = read("jbt 1 particles { file \"a.csv\" radius 2 color (1 0 0) strength 0.5 }");
    assert_eq!(one, read("jbt 1 particles { at ((0 0 0) (3 0 0)) radius 2 color (1 0 0) strength 0.5 }"));
    let hot = read("jbt 1 attribute heat 1 particles { file \"a.csv\" values \"heat\" }").check().unwrap();
    assert_eq!(walk(&hot, [0.1, 0.0, 0.0]).attributes[1], [5.0]);
    assert_eq!(walk(&hot, [3.1, 0.0, 0.0]).attributes[1], [7.0]);
    let columns = read("jbt 1 particles { file \"a.csv\" columns \"x,y,z,radius,-\" }");
    assert_eq!(columns, read(listed));
    // A printed model has the numbers.
    assert_eq!(parse(print(&one).as_bytes(), &Options::default()).unwrap(), one);
}

#[test]
fn wrong_files_are_errors_that_quote_nothing() {
    let options =
        options(&[("a.csv", TABLE), ("secret.csv", SECRET), ("b.jbt", b"jbt 1 point { radius 1 }")]);
    for (text, expected) in [
        ("particles { file \"none.csv\" radius 1 }", "cannot read `none.csv`: there is no such file"),
        (
            "particles { file \"secret.csv\" radius 1 }",
            "`secret.csv` has no particles that can be read: line 3",
        ),
        ("particles { file \"b.jbt\" radius 1 }", "`b.jbt` is no file of particles"),
        ("particles { at ((0 0 0)) file \"a.csv\" radius 1 }", "`at` and `file` of one node"),
        ("particles { file \"a.csv\" file \"a.csv\" radius 1 }", "a second `file`"),
    ] {
        let errors = parse(format!("jbt 1 {text}").as_bytes(), &options).expect_err(text);
        assert_eq!(errors[0].message, expected, "{text}");
        assert!(!errors.to_string().contains("root:"), "{errors}");
    }
    let refused = parse(b"jbt 1 particles { file \"a.csv\" radius 1 }", &Options::default()).unwrap_err();
    assert!(refused[0].message.contains("may name no files"), "{refused}");
}

const SCENE: &[u8] = b"#include \"parts/ball.inc\"\n#declare N = 0;\n#while (N < 2)\n\
    blob { threshold 0.5 #include \"parts/one.inc\" translate 4*N*x }\n#declare N = N + 1;\n#end\n#include \"colors.inc\"\n";

#[test]
fn pov_scenes_include_files() {
    let files: &[(&str, &[u8])] = &[
        ("parts/ball.inc", b"#declare R = 1.5;\n#include \"deep.inc\""),
        ("parts/deep.inc", b"#declare S = 0.75;"),
        ("parts/one.inc", b"// a component\n#if (1)\nsphere { 0, R, S }\n#end"),
    ];
    let read = |bytes: &[u8], options: &Options| SceneFormat::Pov.read("a.pov", bytes, options);
    let found = read(SCENE, &options(files)).unwrap();
    assert!(found.warnings.is_empty(), "{}", found.warnings);
    let plain = b"blob { threshold 0.5 sphere { 0, 1.5, 0.75 } translate 0*x }
        blob { threshold 0.5 sphere { 0, 1.5, 0.75 } translate 4*x }";
    let tree = |imported: &jbt_text::import::Imported| imported.model.check().unwrap();
    let (a, b) = (tree(&found), tree(&read(plain, &Options::default()).unwrap()));
    for x in [-1.0, 0.0, 0.7, 2.0, 3.9, 4.4] {
        assert_eq!(walk(&a, [x, 0.2, 0.1]).field, walk(&b, [x, 0.2, 0.1]).field);
    }
    // An error in a file has its name and its line.
    let wrong: &[(&str, &[u8])] = &[("b.inc", b"#declare R = 1;\nblob { sphere { 0, Q, 1 } }")];
    let error = read(b"#include \"b.inc\"\n", &options(wrong)).unwrap_err();
    assert!(error.to_string().starts_with("b.inc:2:"), "{error}");
    // What is no scene is not read, and a circle ends.
    let secret: &[(&str, &[u8])] = &[("s.inc", b"root:x:0"), ("c.inc", b"#include \"c.inc\"")];
    let with = |text: &[u8]| read(text, &options(secret));
    let text = b"#include \"s.inc\"\nblob { threshold 0.5 sphere { 0, 1, 1 } }";
    let warnings = with(text).unwrap().warnings.to_string();
    assert!(warnings.contains("s.inc") && !warnings.contains("root"), "{warnings}");
    assert!(with(b"#include \"c.inc\"").unwrap_err()[0].message.contains("deep"));
}

/// A file that is named often is read once: its arrays are shared, and so is what is wrong with it.
#[test]
fn a_file_is_read_once() {
    let options = options(&[("a.csv", TABLE), ("secret.csv", SECRET)]);
    let text = "jbt 1 sum { particles { file \"a.csv\" } particles { file \"a.csv\" strength 2 } \
                particles { file \"a.csv\" radius 1 } }";
    let model = parse(text.as_bytes(), &options).unwrap_or_else(|error| panic!("{error}"));
    let places: Vec<*const f64> = model
        .root
        .node()
        .children()
        .iter()
        .map(|child| match child.node().written() {
            Written::Particles(particles) => match &particles.positions {
                NumberArray::Double(numbers) => numbers.as_ptr(),
                NumberArray::Single(_) => panic!("a table has numbers of 64 bits"),
            },
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(places[0], places[1]);
    assert_ne!(places[0], places[2], "a radius of the text is another way to read the file");
    let one = "particles { file \"secret.csv\" radius 1 }";
    let wrong = parse(format!("jbt 1 sum {{ {one} {one} }}").as_bytes(), &options).unwrap_err();
    assert_eq!(wrong.iter().count(), 2, "{wrong}");
}
