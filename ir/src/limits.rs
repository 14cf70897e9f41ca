//! Every limit of the project, in one place. Each is documented with what it protects, and tested at its
//! value and one past it.
//!
//! A limit is reached by hostile input long before it is reached by a model that somebody drew; reaching one
//! is an error with a place, never a panic and never a long silence.

/// Bytes of one scene file. A larger one is refused before it is read.
pub const MAX_SCENE_BYTES: usize = 64 << 20;
/// Bytes that each turn of a loop, and each node of what a call stands for count for, besides the text that
/// is read. All of them count to [`MAX_SCENE_BYTES`]: an expanded text is no longer than the longest text.
pub const EXPANSION_BYTES: usize = 128;
/// The same for each call of a definition that is expanded, which takes more time and memory than a turn.
pub const CALL_BYTES: usize = 512;
/// Calls and loops of a text that may be open in each other.
pub const MAX_EXPANSION_DEPTH: usize = 256;
/// Files that may include each other, each the next one.
pub const MAX_INCLUDE_DEPTH: usize = 16;
/// Arguments of one definition.
pub const MAX_ARGUMENTS: usize = 64;
/// Lists in lists.
pub const MAX_LIST_DEPTH: usize = 8;
/// Files that one scene may name, directly or through files that it names.
pub const MAX_NAMED_FILES: usize = 1024;
/// Bytes of all files that one scene names: particles and grids are some hundred megabytes, and stay in
/// memory. What is read as text has [`MAX_SCENE_BYTES`], all files of a scene together.
pub const MAX_NAMED_BYTES: usize = 1 << 30;
/// Numbers and strings of one request of a RIB file: 8 bytes each, kept until the request has been read.
pub const MAX_LIST_NUMBERS: usize = 1 << 22;
/// Steps of a scene that is a program, as those of POV-Ray are: directives that run, components, calls of
/// functions. A step takes some tenths of a microsecond.
pub const MAX_SCRIPT_STEPS: usize = 1 << 20;
/// Blocks within each other in a file that has them, each of which keeps a state of some hundred bytes.
pub const MAX_BLOCK_DEPTH: usize = 1 << 16;
/// Errors that are kept for one file; the rest are counted.
pub const MAX_ERRORS: usize = 50;
/// Operators and parentheses of one number expression that wait for their operands.
pub const MAX_EXPRESSION_DEPTH: usize = 1 << 20;
/// Operations of one expression of fields.
pub const MAX_EXPRESSION_STEPS: usize = 100_000;
/// Nodes of one tree, shared ones counted once.
pub const MAX_NODES: usize = 4_000_000;
/// Uses of nodes, counted along every path from the root: what is left when no subtree is shared.
pub const MAX_INSTANCES: usize = 4_000_000;
/// Columns of a table of particles.
pub const MAX_TABLE_COLUMNS: usize = 1 << 12;
/// Particles of one model, which are rows and no nodes: each time that they are used. A row keeps some 200
/// bytes while its model is meshed.
pub const MAX_PARTICLES: usize = 1 << 27;
/// Work that one point of a model is foreseen to take besides a leaf or an operator for each use of a node:
/// pieces of curves by the numbers that each has, and operations of formulas, wherever they reach. A unit
/// takes about two nanoseconds, so a mesh of a million points of which nothing can be left out takes minutes.
pub const MAX_POINT_WORK: usize = 1 << 17;
/// Pairs of boxes that are looked at for the distance of two solids: 24 bytes and some tenths of a
/// microsecond each. With more, the bounds are those of the pairs so far.
pub const MAX_GAP_PAIRS: u32 = 1 << 22;
/// What may be cut for the distance of two solids: rows that run in boxes. Some nanoseconds each.
pub const MAX_GAP_WORK: u64 = 1 << 28;
/// Bytes of the boxes that are kept for the distance of two solids, and of the rows that run in those which
/// are not cut yet. With more, the bounds are those of the pairs so far.
pub const MAX_GAP_BYTES: usize = 256 << 20;
/// What may be cut while two parts are compared: rows that run in boxes, some nanoseconds each.
pub const MAX_OVERLAP_WORK: u64 = 1 << 27;
/// Reals of one attribute group.
pub const MAX_ATTRIBUTE_WIDTH: usize = 64;
/// Attribute groups of one model, colour included.
pub const MAX_ATTRIBUTES: usize = 32;
/// Numbers that the weights of leaves may take: one for each leaf, in each row of a leaf. All of them are
/// read for a point, which takes some tenths of a nanosecond each.
pub const MAX_WEIGHT_NUMBERS: u64 = 1 << 22;
/// Names of constants in one model: the leaves below a node are searched once for each.
pub const MAX_CONSTANTS: usize = 64;
/// Points of one skeleton, and numbers of one list.
pub const MAX_SKELETON_POINTS: usize = 1 << 16;
/// Planes of one convex solid that is given by them: its corners are found by cutting all faces by each.
pub const MAX_PLANES: usize = 1 << 10;
/// How often a cubic curve may be halved into pieces: 4096 of them deviate from their chords by 2^-24 of what
/// it does.
pub const MAX_CURVE_HALVINGS: u32 = 12;
/// The largest exponent of a Ricci blend, in magnitude; the smallest is 1.
pub const MAX_RICCI_EXPONENT: f64 = 1024.0;
/// The most copies that a repetition makes of its child. They cost nothing, but beyond this f32 could not
/// tell their places.
pub const MAX_COPIES: f64 = (1 << 20) as f64;
/// The largest exponent of a norm that is a distance; the smallest is 1.
pub const MAX_METRIC_EXPONENT: f64 = 1024.0;
/// The largest magnitude of any number in a model. Its square is still a finite f32.
pub const MAX_NUMBER: f64 = 1e15;
/// The smallest support radius, smallest scale and so on. The inverse of its square is still a finite f32.
pub const MIN_LENGTH: f64 = 1e-15;
/// Tables of one function. More shapes than this is a generated model that needs another formulation.
pub const MAX_TABLES: usize = 100_000;
/// Folds inside folds.
pub const MAX_FOLD_DEPTH: usize = 64;
/// Values of one function, of any engine and after any pass.
pub const MAX_VALUES: usize = 1_000_000;
/// Values of a function that is compiled to machine code; a larger one is interpreted. It bounds the time
/// that Cranelift takes, and the code of either backend to some megabytes.
pub const MAX_JIT_VALUES: usize = 60_000;
/// Values of the function of one row of a table, whose folds have become straight code: of longer rows no
/// ranges are known.
pub const MAX_ROW_VALUES: usize = 4_000;
/// Copies of the body of a fold in such a function, times the rows of the table: each copy keeps the numbers
/// of its columns for each row.
pub const MAX_ROW_COPIES: usize = 1 << 21;
/// Values that may be alive at once in Cranelift's code (a frame costs 16 bytes each per vector); beyond it
/// the function is interpreted. Wide code has no such limit: its time to compile does not depend on it, and
/// its frame is limited.
pub const MAX_JIT_LIVE_VALUES: usize = 4_000;
/// Bytes of the frame of one call of machine code. A function that needs more is interpreted.
pub const MAX_JIT_FRAME_BYTES: usize = 512 << 10;
/// Bytes of such a frame on the caller's stack: a fraction of the smallest stacks that threads are given, 64
/// KiB. A larger frame is in memory that the thread keeps for all kernels.
pub const MAX_STACK_FRAME_BYTES: usize = 16 << 10;
/// Lattice points that are all visited, as when supports are counted. A mesh has no such limit.
pub const MAX_LATTICE_POINTS: usize = 1 << 30;
/// Bricks of one mesh: the field is kept at all points of each, 5 bytes a point.
pub const MAX_BRICKS: usize = 1 << 22;
/// Cells along one axis of a lattice.
pub const MAX_RESOLUTION: usize = 1 << 20;
/// Squares of a contour in which points are evaluated.
pub const MAX_SQUARES: u64 = 1 << 22;
/// Vertices of a contour before straight lines along the border are joined: about 100 bytes each while loops
/// are closed.
pub const MAX_CONTOUR_VERTICES: u64 = 1 << 24;
/// Pixels of an image, times the points that are evaluated in each.
pub const MAX_PIXELS: usize = 1 << 26;
/// Ranges of boxes that it may take to prove on which side of the surface all of a cube is; beyond it the
/// surface may be there.
pub const MAX_MEMBERSHIP_BOXES: usize = 1 << 10;
/// Boxes that the search for one side of a solid's tight bounds may ask about; beyond it the bounds are as
/// tight as they are.
pub const MAX_SEARCH_BOXES: usize = 1 << 19;
/// Boxes of the division that measures a solid: those with surface keep about half a kilobyte each.
pub const MAX_MEASURE_BOXES: u64 = 1 << 22;
/// Rays of one packet: a picture of many is made of tiles.
pub const MAX_PACKET_RAYS: usize = 1 << 20;
/// Points and boxes that may be asked for each ray of a packet. A good field takes some dozens; one that says
/// nothing of boxes takes a point for each tolerance of the ray's length.
pub const MAX_RAY_WORK: u64 = 1 << 22;
/// How often a box may be split on the way to a part of it. Halving f32 coordinates along three axes ends
/// before.
pub const MAX_DIVISION_DEPTH: usize = 96;
/// Boxes of one division: each keeps about 64 bytes.
pub const MAX_DIVISION_BOXES: u64 = 1 << 24;
/// Threads that the commands start: more than any machine has use for, few enough for its memory.
pub const MAX_THREADS: usize = 256;
/// Pixels along one side of a picture.
pub const MAX_PICTURE_SIDE: usize = 1 << 14;
/// Triangles of the mesh that guides the rays of a picture, about: each keeps 80 bytes while it is made.
pub const MAX_GUIDE_TRIANGLES: usize = 1 << 21;
/// Cells of that mesh along the longest side of the model.
pub const MAX_GUIDE_CELLS: usize = 1 << 10;
/// Pixels of a band of a picture whose light is gathered and smoothed at once: each keeps 150 bytes
/// meanwhile.
pub const MAX_BAND_PIXELS: usize = 1 << 22;
/// Pixels of one picture: each keeps 16 bytes while it is made.
pub const MAX_PICTURE_PIXELS: usize = 1 << 26;
/// Rays along each side of a pixel.
pub const MAX_ANTIALIAS: u32 = 16;
