//! The command line: what can be asked, and how it is written.

mod contour;
mod engine;
mod output;
mod render;
mod scene;
mod space;
mod switch;
mod tools;
mod wanted;
mod words;
mod work;

pub use contour::{ContourArguments, ModeName, PaintName};
pub use engine::{EngineArguments, LevelName};
pub use output::OutputArguments;
pub use render::{GroundName, RenderArguments};
pub use scene::{PartArguments, SceneArguments, SceneOptions};
pub use space::LatticeArguments;
pub use switch::Switch;
pub use tools::{
    CheckArguments, CompletionsArguments, ConvertArguments, CountArguments, DiffArguments, ManArguments,
    ShowArguments, StatsArguments,
};
pub use wanted::WantedAnswers;
use wanted::WantedParser;
pub use work::WorkArguments;

use std::collections::HashSet;
use std::num::NonZeroU16;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use jbt::export::{ColorEncoding, Format, LengthUnit, Up};
use jbt::mesh::Simplify;
use jbt::{AnswerKind, Planes, Query};

use crate::formats::{ArrayKind, TableKind};
use crate::shade::Ramp;
use words::{ValueRange, positive, range, simplify, words};

/// Compiles BlobTrees to SIMD machine code, and makes meshes, pictures and values of them.
#[derive(Parser, Debug)]
#[command(name = "jbt", version, max_term_width = 100, after_help = after_help())]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Print no summaries, warnings or progress: errors alone.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Write a timeline of the work to this file, as trace events (JSON) that Perfetto and Chrome show
    ///
    /// Each thread has a row, with a bar for each stage of the work and for each part of a stage.
    #[arg(long, value_name = "FILE.json", global = true)]
    pub trace: Option<PathBuf>,
    /// The most memory to use, as 2000000000, 512M or 1.5G; work that needs more ends with code 3 [default:
    /// three quarters of what is available]
    #[arg(long, value_name = "BYTES", global = true, value_parser = crate::memory::bytes)]
    pub memory: Option<u64>,
}

fn after_help() -> String {
    format!(
        "A SCENE is {}; `-` reads it from the standard input, where its content tells which. {EXIT_CODES}",
        jbt::SceneFormat::list()
    )
}

const EXIT_CODES: &str = "\
Without -o a result is called like the scene, in the current folder.

Exit codes: 0 done, 1 the scene has errors, 2 usage, 3 a limit was hit, 4 a file could not be read or written,
130 and 143 stopped by SIGINT or SIGTERM.

Examples:
  jbt mesh examples/hero.jbt -o hero.glb
  jbt mesh train.scene --cell 0.13 -o train.glb --json
  jbt render hero.jbt -o hero.png
  jbt contour circles.jbt --quadtree -o circles.svg
  jbt sample hero.jbt --resolution 64 -o field.npy
  jbt eval hero.jbt --points points.csv --query all -o answers.csv
  jbt convert drop.pov -o drop.jbt
  jbt show hero.jbt --stage ir
  jbt count hero.jbt
  jbt stats hero.jbt
  jbt check hero.jbt
  jbt diff old.jbt new.jbt";

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Write the surface of a scene as a triangle mesh
    Mesh(MeshArguments),
    /// Make a picture of a scene
    Render(RenderArguments),
    /// Cut a scene by a plane, and write the contour as a drawing or the slice as an image
    Contour(ContourArguments),
    /// Evaluate a scene at the points of a lattice, and write an array for numpy
    Sample(SampleArguments),
    /// Evaluate a scene at the points of a CSV file
    Eval(EvalArguments),
    /// Write a scene of any format as a .jbt text
    Convert(ConvertArguments),
    /// Print a scene as one of the stages that it goes through on its way to machine code
    Show(ShowArguments),
    /// Count the evaluations of primitives that a point and a lattice take, and how many matter
    Count(CountArguments),
    /// Measure the solid of a scene: tight bounds, volume, area, and what a division of space by it is like
    Stats(StatsArguments),
    /// Report everything that is wrong with scenes
    Check(CheckArguments),
    /// Say what two scenes differ in, item by item, and where their fields do
    Diff(DiffArguments),
    /// Print a script by which a shell completes the words of jbt
    Completions(CompletionsArguments),
    /// Write manual pages into a folder
    Man(ManArguments),
}

/// What `jbt mesh` takes.
#[derive(Args, Debug)]
#[command(after_help = "\
The format is that of OUT's extension. Without --region the mesh covers the support of the model: where its field can
differ from zero. docs/files.md says what each format holds, and how other programs read it.

Keys of --json that measure the mesh, in units and axes of the scene:
  bounds: [x0, y0, z0, x1, y1, z1] and size: [x, y, z] (null if it is empty), volume (null if it is not closed: it encloses
  nothing then), area; of the file: format, up, colors (null if it has none), unit (null if it
  states none)

Parts that are thinner than a cell are searched for, since no cell can show them. Keys of thin in --json (null
with --no-thin):
  places: how many places may hold some, near: points of the first eight, cell: the edge of cells that would
  show them (null without places); in blocks of 4^3 cells: missed, where a point of such a part was found;
  shredded, where the mesh is in shreds; unproven, where neither a part was found nor ranges exclude one;
  boxes: ranges that the search took

Examples:
  jbt mesh hero.jbt -o hero.glb
  jbt mesh hero.jbt --resolution 200 -D radius=2 -o hero.ply
  jbt mesh hero.jbt --cell 0.05 --region -1,-1,-1,1,1,1 -o corner.stl --json
  cat hero.jbt | jbt mesh - -o - --format obj | less
  jbt mesh 'frame_{}.vtk' -o 'frame_{}.glb' --radius 0.02 --values heat --color-by heat --jobs 2
                                    all frames of a sequence that have no newer result
  jbt mesh robot.jbt --parts -o 'robot_{}.stl'
                                    a file for each part, with its name")]
pub struct MeshArguments {
    /// What to mesh.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where the mesh goes.
    #[command(flatten)]
    pub output: OutputArguments<Format>,
    #[arg(long, value_name = "AXIS", value_parser = words(Up::ALL, up_in_words), help = up_help())]
    pub up: Option<Up>,
    #[arg(long, value_name = "ENCODING", value_parser = words(ColorEncoding::ALL, colors_in_words), help = colors_help())]
    pub colors: Option<ColorEncoding>,
    #[arg(long, value_name = "UNIT", value_parser = words(LengthUnit::ALL, unit_in_words), help = unit_help())]
    pub unit: Option<LengthUnit>,
    /// At most so many materials, each triangle of one, in a .3mf file: for printers
    #[arg(long, value_name = "K")]
    pub palette: Option<NonZeroU16>,
    /// Where the field is asked.
    #[command(flatten)]
    pub lattice: LatticeArguments,
    /// Do not search for parts that are thinner than a cell
    #[arg(long)]
    pub no_thin: bool,
    /// Whether vertices go to the edges and corners of the surface, and normals are split there; smooth
    /// scenes have none
    #[arg(long, value_enum, default_value_t = Switch::On)]
    pub sharp: Switch,
    /// Fewer triangles: 25% keeps a quarter of them, and a number lets the surface move by that, in units of
    /// the scene; what is closed stays closed, attributes are kept
    #[arg(long, value_name = "RATIO%|TOLERANCE", value_parser = simplify)]
    pub simplify: Option<Simplify>,
    /// Cut off what is lower than this above the lowest point, along the axis that points up: for printers
    #[arg(long, value_name = "HEIGHT", value_parser = positive)]
    pub flat_bottom: Option<f64>,
    /// Colours by an attribute: its value, or its length if it has several reals, through --ramp
    #[arg(long, value_name = "ATTRIBUTE")]
    pub color_by: Option<String>,
    /// The colours of --color-by, from the least value to the largest
    #[arg(long, value_enum, default_value_t = Ramp::Viridis, requires = "color_by")]
    pub ramp: Ramp,
    /// The values that have the first and the last colour of --color-by [default: the least and the largest];
    /// frames of a sequence look alike with it
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, requires = "color_by", allow_hyphen_values = true)]
    pub color_range: Option<ValueRange>,
    /// A file for each part of the scene: its name takes the place of {} in -o
    #[arg(long)]
    pub parts: bool,
    /// Frames of a sequence that are made at once
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub jobs: u16,
    /// Look at every edge of the mesh to say that it is closed, and do not take it from how meshes are made
    #[arg(long)]
    pub verify: bool,
    #[command(flatten)]
    pub work: WorkArguments,
}

fn up_in_words(up: Up) -> (&'static str, &'static str) {
    let help = match up {
        Up::Y => "The scene's (x, y, z) is (x, z, -y) in the file",
        Up::Z => "As in the scene",
    };
    (up.name(), help)
}

fn colors_in_words(encoding: ColorEncoding) -> (&'static str, &'static str) {
    let help = match encoding {
        ColorEncoding::Srgb => "As screens take them: 0.5 in the scene is 188 of 255",
        ColorEncoding::Linear => "As in the scene: 0.5 is 128 of 255",
    };
    (encoding.name(), help)
}

fn unit_in_words(unit: LengthUnit) -> (&'static str, &'static str) {
    let help = match unit {
        LengthUnit::Micrometre => "Micrometres",
        LengthUnit::Millimetre => "Millimetres",
        LengthUnit::Centimetre => "Centimetres",
        LengthUnit::Inch => "Inches",
        LengthUnit::Foot => "Feet",
        LengthUnit::Metre => "Metres",
    };
    (unit.name(), help)
}

fn unit_help() -> String {
    let usual = |format: Format| format.conventions().unit.map(LengthUnit::name);
    format!(
        "What a unit of the scene is, in files that say so; lengths stay as they are [default: {}]",
        by_format(usual)
    )
}

fn up_help() -> String {
    let usual = |format: Format| Some(format.conventions().up.name());
    format!("The axis of the file that points up [default: {}]", by_format(usual))
}

fn colors_help() -> String {
    let usual = |format: Format| format.conventions().colors.map(|colors| colors.encoding.name());
    format!("What the numbers of colours mean [default: {}]", by_format(usual))
}

/// What formats do by themselves, those that do the same together: `y in .glb and .obj, z in .ply and .stl`.
fn by_format(usual: impl Fn(Format) -> Option<&'static str>) -> String {
    let mut words: Vec<&str> = Format::ALL.into_iter().filter_map(&usual).collect();
    let mut seen = HashSet::new();
    words.retain(|word| seen.insert(*word));
    let entry = |word: &str| {
        let formats = Format::ALL.into_iter().filter(|&format| usual(format) == Some(word));
        let endings: Vec<String> = formats.map(|format| format!(".{format}")).collect();
        format!("{word} in {}", endings.join(" and "))
    };
    words.into_iter().map(entry).collect::<Vec<_>>().join(", ")
}

/// What `jbt sample` takes.
#[derive(Args, Debug)]
#[command(after_help = "\
OUT is a .npy file: an array of 32 bit floats of the shape (nx, ny, nz), where [i, j, k] is the field at the point with these
indices; with several answers (nx, ny, nz, n), in the order field, gx, gy, gz, color.r, color.g, color.b and the other attributes. The
points are the corners of the cells of the lattice. Without --region it covers the support of the model.

Examples:
  jbt sample hero.jbt -o field.npy
  jbt sample hero.jbt --cell 0.05 --query all -o all.npy --json
  python3 -c 'import numpy; print(numpy.load(\"field.npy\").max())'")]
pub struct SampleArguments {
    /// What to sample.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where the samples go.
    #[command(flatten)]
    pub output: OutputArguments<ArrayKind>,
    /// The answers wanted, and names of attribute groups if not all are: field,color
    #[arg(long, default_value_t = Query::FIELD.into(), value_parser = WantedParser)]
    pub query: WantedAnswers,
    /// Of a .vdb: distances from the surface, up to three cells to both sides, in place of the field
    #[arg(long)]
    pub level_set: bool,
    /// Where they are wanted.
    #[command(flatten)]
    pub lattice: LatticeArguments,
    #[command(flatten)]
    pub work: WorkArguments,
}

/// What `jbt eval` takes.
#[derive(Args, Debug)]
#[command(after_help = eval_help())]
pub struct EvalArguments {
    /// What to evaluate.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// CSV file of the points; `-` is the standard input
    #[arg(long, value_name = "FILE.csv")]
    pub points: PathBuf,
    /// The answers wanted, and names of attribute groups if not all are: field,color
    #[arg(long, default_value_t = Query::FIELD.into(), value_parser = WantedParser)]
    pub query: WantedAnswers,
    /// What computes.
    #[command(flatten)]
    pub engine: EngineArguments,
    /// Number of threads; what is written does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Where the answers go.
    #[command(flatten)]
    pub output: OutputArguments<TableKind>,
}

const EVAL_HELP: &str = "\
The points are read from the columns x, y and z, found by the header; other columns are ignored. Coordinates are finite:
`nan`, `inf` and what is beyond 3.4e38 are errors, with their place. The answers keep the order of the points. Columns: {columns}.
--query owner.path adds the number of the leaf that decides and, last, the way down to it in words; --query weights adds
how much each leaf has to say, and --query body/arm.weight what has a name.

Examples:
  jbt eval hero.jbt --points points.csv --query all -o answers.csv
  jbt eval hero.jbt --points - --query field -o - < points.csv";

/// The columns of `jbt eval`, from the table of answers.
fn columns() -> String {
    let of = |answer: AnswerKind| match answer.row().planes {
        Planes::Named(names) => names.join(","),
        Planes::Channels => "color.r,color.g,color.b and the other attributes of the scene".to_owned(),
    };
    format!("x,y,z,{}", AnswerKind::ALL.map(of).join(", then "))
}

fn eval_help() -> String {
    EVAL_HELP.replace("{columns}", &columns())
}

#[cfg(test)]
mod tests {
    use super::scene::definition;
    use super::space::region;
    use super::*;
    use jbt::Box3;

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory as _;
        Arguments::command().debug_assert();
    }

    #[test]
    fn regions_and_definitions() {
        let unit = Box3::new([0.0; 3], [1.0; 3]);
        assert_eq!(region("0,0,0,1,1,1"), Ok(unit));
        assert_eq!(region(" 0, 0,0, 1,1 ,1"), Ok(unit));
        for bad in
            ["", "0,0,0,1,1", "0,0,0,1,1,1,1", "0,0,0,1,1,nan", "0,0,0,0,1,1", "0,0,0,1,1,x", "0,0,0,1,1,inf"]
        {
            assert!(region(bad).is_err(), "{bad}");
        }
        assert_eq!(definition("r=2"), Ok(("r".to_owned(), 2.0)));
        assert_eq!(definition("r = -1e3"), Ok(("r".to_owned(), -1000.0)));
        assert_eq!(definition("r=2 * (1 + sqrt(4))"), Ok(("r".to_owned(), 6.0)));
        for bad in ["r", "=2", "r=", "r=x", "r=inf", "r=1 2", "r=1/0", "r=(", "r=2)"] {
            assert!(definition(bad).is_err(), "{bad}");
        }
    }
}
