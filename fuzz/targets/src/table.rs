//! The targets: a row for each.

use jbt::SceneFormat;

use crate::read::{format_word, read};
use crate::{engines, function, mesh, points, print, prune};

/// What is done with bytes.
type TargetRun = Box<dyn Fn(&[u8])>;

/// Something that takes bytes.
pub struct FuzzTarget {
    /// Its name, which is that of its folders of inputs.
    pub name: String,
    /// The program of libFuzzer that runs it.
    pub program: &'static str,
    /// What holds for any bytes.
    pub what: String,
    run: TargetRun,
}

impl std::fmt::Debug for FuzzTarget {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Target").field("name", &self.name).finish_non_exhaustive()
    }
}

impl FuzzTarget {
    fn new(name: &'static str, what: &str, run: fn(&[u8])) -> Self {
        Self { name: name.to_owned(), program: name, what: what.to_owned(), run: Box::new(run) }
    }

    fn of_format(format: SceneFormat) -> Self {
        Self {
            name: format!("read-{}", format_word(format)),
            program: "read",
            what: format!("{} is read or refused, with located errors; what was read prints", format.text()),
            run: Box::new(move |bytes| read(format, bytes)),
        }
    }

    /// Whether models are compiled for each input: such targets take milliseconds an input.
    #[must_use]
    pub fn compiles(&self) -> bool {
        ["engines", "mesh", "prune"].contains(&self.name.as_str())
    }

    /// Panics if what holds for all bytes does not hold for these.
    pub fn run(&self, bytes: &[u8]) {
        (self.run)(bytes);
    }
}

/// All targets.
#[must_use]
pub fn targets() -> Vec<FuzzTarget> {
    let others = [
        FuzzTarget::new(
            "function",
            "IR text is read or refused; passes and engines keep its bits",
            function::run,
        ),
        FuzzTarget::new("points", "points as CSV are read or refused, with located errors", read_points),
        FuzzTarget::new("print", "what is printed of a model reads back as the same model", print::run),
        FuzzTarget::new("engines", "all engines and levels give the same bits", engines::run),
        FuzzTarget::new(
            "prune",
            "rows that are left out in a box change no bit; ranges hold the field",
            prune::run,
        ),
        FuzzTarget::new(
            "mesh",
            "meshes are closed manifolds, with the same bits on other engines",
            mesh::run,
        ),
    ];
    SceneFormat::ALL.into_iter().map(FuzzTarget::of_format).chain(others).collect()
}

/// The target of a name. Panics with all names if there is none.
#[must_use]
pub fn target(name: &str) -> FuzzTarget {
    let all = targets();
    let names: Vec<String> = all.iter().map(|target| target.name.clone()).collect();
    let found = all.into_iter().find(|target| target.name == name);
    found.unwrap_or_else(|| panic!("there is no target {name}; there are {}", names.join(", ")))
}

fn read_points(bytes: &[u8]) {
    let all = || {
        let mut reader = points::PointReader::new(bytes, "p.csv".to_owned())?;
        while !reader.batch(100)?.is_empty() {}
        Ok(reader.bytes())
    };
    match all() {
        Ok(read) => assert_eq!(read, bytes.len() as u64, "all bytes are read"),
        Err(points::PointTableError::Text { rendered, .. }) => {
            assert!(rendered.starts_with("p.csv:"), "{rendered}");
        }
        Err(points::PointTableError::Limit(_)) => {}
        Err(points::PointTableError::Io { error, .. }) => panic!("bytes can be read: {error}"),
    }
}
