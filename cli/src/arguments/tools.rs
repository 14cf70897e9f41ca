//! What the commands take that tell about scenes, and those about jbt itself.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;
use jbt::{Box3, Query, SceneFormat};

use super::space::region;
use super::wanted::{WantedAnswers, WantedParser};
use super::words::positive;
use super::words::queries;
use super::{LatticeArguments, LevelName, OutputArguments, SceneArguments, SceneOptions};
use crate::formats::TextKind;

/// What `jbt show` takes.
#[derive(Args, Debug)]
#[command(after_help = "\
Stages: `tree` (the scene as .jbt text), `ir` (the lowered program), the name of a pass (the program after it), and, where
machine code is built in, `clif` (Cranelift's own language) and `asm` (the machine's instructions). A wrong name lists them all.

Examples:
  jbt show train.scene --stage tree > train.jbt
  jbt show hero.jbt --stage schedule --query field
  jbt show hero.jbt --stage asm --level avx512")]
pub struct ShowArguments {
    /// What to show.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The stage to print
    #[arg(long, value_name = "STAGE")]
    pub stage: String,
    /// The answers that the program gives, and names of attribute groups if not all are wanted
    #[arg(long, default_value_t = Query::ALL.into(), value_parser = WantedParser)]
    pub query: WantedAnswers,
    /// Show the straight code of formulas that have much in common: what points anywhere run, while regions
    /// run rows
    #[arg(long)]
    pub straight: bool,
    /// The instruction set of `asm`, which this CPU need not have [default: the best that it has, or
    /// JBT_LEVEL]
    #[arg(long, value_enum)]
    pub level: Option<LevelName>,
}

/// What `jbt convert` takes.
#[derive(Args, Debug)]
#[command(after_help = "\
The text is the same model: it has the same field and attributes to the last bit, and stands the same way up. Names stay, and
comments in front of statements; calls and loops are written out. docs/readers.md says what is read of each format, and what is left out.

Examples:
  jbt convert drop.pov -o drop.jbt
  jbt convert scene.pov --object Flower -o flower.jbt
  jbt convert tree.json -o - | less")]
pub struct ConvertArguments {
    /// What to write.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where the text goes.
    #[command(flatten)]
    pub output: OutputArguments<TextKind>,
}

/// What `jbt count` takes.
#[derive(Args, Debug)]
#[command(after_help = COUNT_HELP)]
pub struct CountArguments {
    /// What to count.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Count for one query only
    #[arg(long, value_parser = queries())]
    pub query: Option<Query>,
    /// The points of the totals.
    #[command(flatten)]
    pub lattice: LatticeArguments,
    /// Print one JSON object instead of a table
    #[arg(long)]
    pub json: bool,
}

const COUNT_HELP: &str = "\
An evaluation is the distance to one skeleton at one place. It is counted for one point, and for the lattice that `jbt
mesh` would take with the same options.

  separate  a walk of the tree for the field, four for the gradient by differences (the point and a step along each
            axis), one for the attributes; each meets a shared leaf again at every use
  cached    the same walks with a memory for each point: a leaf at a position once for each of the four places
  fused     what the compiled program evaluates
  waste     evaluations of the field on the lattice for each pair of a point and a primitive whose support the point
            is inside of; 1 is none

Keys of --json. For one point:
  formula, instances, uses, queries: [{query, walks, separate, cached, fused, total: {separate, cached, fused}}],
  leaves: [{node, kind, line, column, uses, evaluations: {QUERY: count}, pairs_in_support}]
For the lattice (`total` and `pairs_in_support` too):
  lattice: {region: [x0, y0, z0, x1, y1, z1], cell, cells: [nx, ny, nz]}, points, evaluations (of primitives, for the
  field, if no point and no primitive is left out), origin: [x, y, z] (see docs/text.md; 0 for most scenes), pairs_in_support, waste, warnings; interval_evaluations (of primitives
  over boxes, for a mesh) and mesh: {stages: {division: {boxes, interval_evaluations}, lattice, pulls, vertices: {points,
  evaluations}}, avoided_by_support, avoided_by_interval} (evaluations of the lattice that a mesh does without)
A model that is empty or unbounded has no lattice without --region: `lattice`, `waste` and `mesh` are null, and the counts are 0.

Examples:
  jbt count hero.jbt
  jbt count train.scene --cell 0.13 --json";

/// What `jbt stats` takes.
#[derive(Args, Debug)]
#[command(after_help = STATS_HELP)]
pub struct StatsArguments {
    /// What to measure.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where, and how small boxes get.
    #[command(flatten)]
    pub lattice: LatticeArguments,
    /// How often the region's longest side is halved, instead of --cell or --resolution
    #[arg(long, value_name = "N", conflicts_with_all = ["cell", "resolution"], value_parser = clap::value_parser!(u8).range(0..=20))]
    pub depth: Option<u8>,
    /// How tight the bounds are, in units of the scene [default: 1/1024 of the region's longest side]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub tolerance: Option<f32>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    pub json: bool,
}

const STATS_HELP: &str = "\
The solid is where the field is at least the iso-value. A region (without --region the support of the model) is divided
into boxes that are proven to be all inside (solid) or all outside (air), and boxes of one cell that may hold surface.

  volume    between the solid boxes and these with the surface boxes: proven; and an estimate
  area      an estimate: in each surface box, of the plane that the field has there; it converges with the cell
  tight     a box that holds all of the solid in the region: proven; each side is within the tolerance of the solid
            if it has converged
  contents  primitives that matter in a surface box

Keys of --json:
  support: [x0, y0, z0, x1, y1, z1] (null if empty or unbounded), region: [...], cell,
  origin: [x, y, z] (from which 32-bit coordinates count, see docs/text.md; 0 for most scenes),
  tight: {outer: [...], inner: [...], tolerance, converged} (null: no inside point is there, or none was found),
  volume: {low, high, estimate}, area, center: [x, y, z] (of mass; null if nothing is there),
  division: {boxes, splits, solid, air, surface, levels: [{depth, splits, solid, air, surface}]}, counts of boxes,
  shares: {solid, air, surface} of the region's volume, contents: {mean, most},
  points, evaluations (of primitives, at points), ranges (of the field in boxes), interval_evaluations (of primitives
  over boxes), total_ms, warnings

Examples:
  jbt stats hero.jbt
  jbt stats hero.jbt --depth 6
  jbt stats train.scene --cell 0.13 --tolerance 0.001 --json";

/// What `jbt check` takes.
#[derive(Args, Debug)]
#[command(after_help = CHECK_HELP)]
pub struct CheckArguments {
    #[arg(
        value_name = "SCENE",
        required = true,
        help = format!("The scenes, each {}; `-` is the standard input", SceneFormat::list())
    )]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub options: SceneOptions,
    /// Compare the parts of each scene: volumes, and which of them overlap, touch or are apart
    #[arg(long)]
    pub overlaps: bool,
    /// How near to each other points of two parts touch; without it a 1024th of the longest side, or as
    /// near as can be told
    #[arg(long, value_name = "T", requires = "overlaps", value_parser = positive)]
    pub tolerance: Option<f64>,
    /// The box in which parts are compared: its smallest and its largest corner; unbounded parts need one
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", requires = "overlaps", value_parser = region, allow_hyphen_values = true)]
    pub region: Option<Box3<f64>>,
    /// Print one JSON object instead of messages and summaries
    #[arg(long)]
    pub json: bool,
}

const CHECK_HELP: &str = "\
All files are checked. The exit code is that of the first one with which something is wrong.

Parts that overlap, and parts that are farther apart than the tolerance, are proven to. Others touch, if that could not
be told down to boxes as small as the tolerance; they are undecided if there were too many such boxes. Then a
larger tolerance says more.

Keys of --json:
  files: [{file, ok, model: {nodes, leaves, instances, iso, parameters: {NAME: value}, bounds: [x0, y0, z0, x1, y1, z1]
  (null if empty or unbounded), origin: [x, y, z], attributes: [{name, width, mixing, direction}],
  overlaps: {parts: [{name, volume: {low, high, estimate}}], pairs: [{parts: [NAME, NAME], relation (apart, touching,
  overlapping, undecided), at: [x, y, z], volume, within, more_than, thinner_than}]} (with --overlaps)}}]
  (model is null where something is wrong),
  diagnostics: [{file, severity (error, warning or limit), line, column, end: {line, column}, message, hint}], where end
  is one past the last character, columns count characters from 1, and what is not there is null

Examples:
  jbt check hero.jbt
  jbt check examples/*.jbt -q
  jbt check machine.jbt --overlaps
  jbt check hero.jbt --json | jq '.diagnostics[].message'";

/// What `jbt diff` takes.
#[derive(Args, Debug)]
#[command(after_help = "\
Nodes are compared by what they mean: their names, comments and sharing do not count, names of parts do. Children meet by
equal content first, then by name, then by kind; those that stand in another order than the others are told. Outside of
the boxes that are told, fields are proven equal, but for rounding.

Keys of --json:
  same (equal hashes), hashes: [A, B] (stable over runs and versions), differences: [{path, first, second, moved}] (path is
  empty for statements, first or second null for what is in the other alone, moved: the places in both of what stands in
  another order, or null), field: [{box: [x0, y0, z0, x1, y1, z1], at: [x, y, z], most}] (at: where they differ most of the
  points that were asked, most: by how much, 0 if they differ at none; null if they are the same model or reach to infinity)

Examples:
  jbt diff old.jbt new.jbt
  jbt diff robot.jbt robot.jbt --json")]
pub struct DiffArguments {
    /// One scene
    #[arg(value_name = "SCENE")]
    pub first: PathBuf,
    /// Another one
    #[arg(value_name = "OTHER")]
    pub second: PathBuf,
    #[command(flatten)]
    pub options: SceneOptions,
    /// The box in which fields are compared: its smallest and its largest corner [default: where they may
    /// differ]
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", value_parser = region, allow_hyphen_values = true)]
    pub region: Option<Box3<f64>>,
    /// Print one JSON object instead of words
    #[arg(long)]
    pub json: bool,
}

/// What `jbt completions` takes.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  jbt completions bash > ~/.local/share/bash-completion/completions/jbt
  jbt completions zsh > ~/.zfunc/_jbt
  jbt completions fish > ~/.config/fish/completions/jbt.fish")]
pub struct CompletionsArguments {
    /// The shell
    pub shell: Shell,
}

/// What `jbt man` takes.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  mkdir -p ~/.local/share/man/man1 && jbt man ~/.local/share/man/man1 && man jbt-mesh")]
pub struct ManArguments {
    /// The folder, which is there already; pages of the same names are replaced
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}
