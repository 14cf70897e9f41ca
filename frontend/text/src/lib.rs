//! The text format `.jbt`: reading and writing models.
//!
//! ```text
//! jbt 1
//! iso 0.5
//! param bulge = 0.6
//!
//! let arm = segment { from (0 0 0) to (1 0 0) radius bulge falloff soft }
//!
//! blend ricci 4 {
//!     color (1 0.3 0.1) { use arm }
//!     rotate axis z degrees 90 { color (0.1 0.4 1) { use arm } }
//! }
//! ```
//!
//! # Grammar
//!
//! ```text
//! file       = "jbt" "1" { statement } ;                     exactly one statement is a node, the root; or there are parts instead
//! statement  = "iso" expression                              before all nodes; 0.5 if not written
//!            | "origin" vector                               where local coordinates begin; found by the check if not written
//!            | "orientation" [ "up" ( "y" | "z" ) ] [ "handed" ( "right" | "left" ) ]      at least one of them; z and right if not written
//!            | "param" NAME "=" expression                   its default; options may set another value
//!              [ "in" expression ".." expression [ "step" expression ] ] [ QUOTED ]    its range and its label
//!            | "attribute" NAME ( width | "direction" ) [ "default" values ] [ "blend" | "dominant" ]
//!            | "let" NAME "=" ( node | item )
//!            | "style" NAME "=" "{" { head } "}"              attributes and constants that have a name together
//!            | "def" NAME "(" [ NAME [ "=" item ] { "," NAME [ "=" item ] } ] ")" body
//!            | "include" QUOTED                              what the file gives a name to
//!            | "part" QUOTED "{" { node } "}"             a solid of its own
//!            | node ;
//! body       = "{" { "let" NAME "=" ( node | item ) | node } "}" ;    nodes of which it stands for all
//! node       = NAME ":" node                                 with a name, which any word may be
//!            | NAME "(" [ [ NAME "=" ] ( item | node ) { "," .. } ] ")"    what a definition stands for
//!            | "for" NAME "in" ( item | expression ".." expression [ "step" expression ] ) body
//!            | "if" condition body { "else" "if" condition body } [ "else" body ]
//!            | "include" QUOTED                              the node of the file
//!            | plain ;
//! condition  = test { ( "and" | "or" ) test } ;              `and` binds before `or`
//! test       = { "not" } expression [ ( "<" | "<=" | ">" | ">=" | "==" | "!=" ) expression ] ;
//! item       = expression | vector | HEX | "srgb" vector | "[" { item [ "," ] } "]" | "use" NAME
//!            | NAME { "[" expression "]" } ;                 a value with a name, or an element of it
//! plain      = primitive | "empty" | particles | operator "{" { node } "}" | map "{" node "}" | "use" NAME | formula ;
//! formula    = "expression" [ box ] "{" { NAME "=" expression "," } expression "}"
//!            | box "{" node "}"                              the node's field, and 0 outside of the box
//!            | "falloff" FALLOFF "radius" expression "{" node "}" ;   the node's field is a distance; what is negative is 0
//! box        = "within" vector "to" vector ;                 smallest corner and largest, in the node's own space
//! primitive  = SKELETON "{" { parameter } "}" ;              in any order, each once
//! parameter  = FIELD value
//!            | "radius" expression                           where the field reaches zero
//!            | "surface_radius" expression                   where the primitive alone meets the iso-value
//!            | "falloff" FALLOFF [ "{" { FIELD value } "}" ]   soft if not written
//!            | "strength" expression ;                       1 if not written
//! particles  = "particles" "{" { parameter | ( "file" | "columns" | "values" ) QUOTED } "}" ;           the sum of points; in any order, each once:
//!              "at" "(" { vector } ")"                        where they are
//!            | ( "radius" | "surface_radius" | "strength" ) ( expression | "(" { number } ")" )     for all, or for each
//!            | "falloff" FALLOFF [ "{" { FIELD value } "}" ]
//!            | [ "with" ] NAME ( values | "(" { vector } ")" ) ;    of an attribute: for all, or for each
//! operator   = "sum" | "product" | "union" | "intersection" | "difference" | "symmetric_difference"
//!            | [ "blend" ] "ricci" expression                at least 1, or at most -1
//!            | ( "smooth_union" | "smooth_intersection" | "smooth_difference" ) [ "width" ] expression
//!            | "rfunction" ( "union" | "intersection" | "difference" )
//!              [ "alpha" expression | "power" expression | "order" expression ]    alpha 0 if not written
//!            | "select" expression ;                         one child: that whose place, from 0, is nearest
//! map        = "complement"
//!            | "clamp" "low" expression "high" expression
//!            | "shell" [ "thickness" ] expression
//!            | "offset" [ "by" ] expression
//!            | "translate" vector
//!            | "rotate" "axis" value ( "degrees" | "radians" ) expression
//!            | "scale" ( expression | vector )
//!            | "reflect" "axis" value                         a mirror image in the plane through the origin across the axis
//!            | "stretch" "axis" value "by" expression         a scale along an axis
//!            | "shear" "axis" value "by" vector               what is at height h along the axis moves by h times the vector
//!            | "affine" vector                               12 numbers: the rows of a 3x4 matrix, child to parent
//!            | WARP { FIELD value } [ "weighted" ]           weighted: two nodes in the block, the second gives the weight
//!            | "warp" "(" { NAME "=" expression "," } expression "," expression "," expression ")" [ box ] [ "weighted" ]
//!                                                            where the node is asked, for each point
//!            | [ "override" ] "style" NAME                  what the style has
//!            | head ;
//! head       = [ "override" ] "constant" NAME ( QUOTED | expression )        what leaves are of: text, or a whole number
//!            | [ "override" ] [ "with" ] NAME given ;        a declared attribute; "with" if its name is a word of the format
//! given      = values                                        the same everywhere
//!            | TEXTURE "{" { "a" values | "b" values | FIELD value } "}"     a pattern in the node's space: a where it is 0, b where it is 1
//!            | { "scale" ( expression | vector ) | "rotate" expression | "shift" vector } ;   uv of the skeletons, for groups of 2 reals
//! value      = expression | vector | WORD ;                  as the field's kind asks
//! values     = vector | expression                           as many as the group is wide
//!            | HEX | "srgb" vector ;                         a colour as screens have it, made linear: 3 reals, or 4 with an opacity
//! vector     = "(" expression { [ "," ] expression } ")" ;
//! expression = NUMBER | NAME { "[" expression "]" } | "count" "(" NAME ")" | "pi" | "-" expression | "+" expression | "(" expression ")"
//!            | expression ( "+" | "-" | "*" | "/" | "^" ) expression
//!            | FUNCTION "(" expression { "," expression } ")" ;
//!            | "x" | "y" | "z" | "field" "(" NAME ")" | NAME    in formulas: coordinates, fields of `let`s, definitions
//! FUNCTION   = a word of [`functions`] ;                  in formulas also FALLOFF, of a distance of which 1 is the end
//! HEX        = a double quote, "#", 3, 4, 6 or 8 digits in hex, a double quote ;
//! QUOTED     = a double quote, text of one line, a double quote ;
//! NAME       = letter { letter | mark | digit | "_" } ;  letters of any script (XID of Unicode, and marks inside of words), in the normal form C
//! ```
//!
//! SKELETON, FALLOFF, WARP, TEXTURE and FIELD are the names that the members of
//! [`skeleton`](jbt_model::skeleton), [`falloff`](jbt_model::falloff), [`warp`](jbt_model::warp) and
//! [`texture`](jbt_model::texture) give themselves. Where a skeleton's own parameter is called like one that
//! every primitive has, the skeleton's name goes before it: a disc has a `disc_radius`, and a `radius` around
//! it.
//!
//! * `#` and `//` begin a comment that ends with the line: at a line feed, a carriage return, or both. Line
//!   ends are blanks like others.
//! * Colours in hex stand in quotes, `color "#ff8800"`: without them they are comments. `srgb` takes numbers
//!   from 0 to 1, which may depend on parameters. Both become linear as they are read.
//! * A parameter can be set from outside, `-D bulge=2`, and again at run time
//!   ([`CheckedTree::with_parameters`](jbt_model::check::CheckedTree::with_parameters)): numbers that mention
//!   it follow it, and so do parameters whose defaults mention it, unless they are set themselves. Parameters
//!   in the width or the default of an attribute group, or in the origin, count as they were read. An
//!   exponent of `ricci` that depends on a parameter is a blend also where it is 1: unlike the plain sum, it
//!   takes negative fields as 0.
//! * `select which { a b c }` is one of its children, and the others do not count: `a` for 0, `b` for 1, `c`
//!   for 2, and what is between is rounded. A number that is near no child is an error.
//! * Names are defined before they are used, and once. `color` is declared in every file (3 reals, white,
//!   blend) and may be declared again to change its default or its mixing.
//! * Behind an attribute's name a texture's name is the texture. A parameter of that name goes in
//!   parentheses: `rough (noise) { .. }`.
//! * `uv { .. }` with `attribute uv 2` gives leaves the uv of their skeletons: the picture is scaled (by one
//!   number or two), then turned by degrees about (0, 0), then shifted. Nothing is wrapped to 0 .. 1.
//! * Angles of functions are radians. `^` goes to the right and binds before a minus sign: `-2^2` is -4.
//! * **Directly inside a vector, a `+` or `-` with a blank before it and none after it begins the next
//!   number**: `(1 -2 3)` are three numbers, `(1 - 2 3)`, `(1-2 3)` and `((1 -2) 3)` are two.
//!
//! * Programs (`program/`) are expanded while they are read: a model knows none of their words. Loops,
//!   conditions and places of elements may follow parameters, which then can be set only by reading the text
//!   again. Words of programs are no reserved words: `for` is a loop where `in` follows its name, `def` a
//!   definition where a name follows, `include` a file where a quote follows, `if` a condition unless a group
//!   of attributes is called so.
//!
//! # Promises
//!
//! `parse(print(model)) == model` for every model that passes the check, with the same bits in every number,
//! and with the same subtrees shared, as long as its text is not longer than
//! [`jbt_ir::limits::MAX_SCENE_BYTES`]. Reading is iterative, takes memory for the model, and a copy of the
//! text for messages, and reports every error with its place. Parameters are printed as such, with their
//! present values, and so are the expressions that mention them.

mod attribute;
mod block;
mod color;
mod comment;
mod compare;
mod constant;
mod expression;
mod falloff;
mod field_difference;
pub mod files;
mod formula;
mod hash;
mod hints;
pub mod import;
mod item;
mod lex;
mod map;
mod node;
mod operator;
mod pairs;
mod parameter;
mod parse;
mod part;
mod particle_file;
mod particles;
mod primitive;
mod print;
mod program;
mod rust;
mod scope;
mod stack;
mod state;
mod texts;
mod value;
mod words;

use std::borrow::Cow;

use jbt_ir::limits::MAX_SCENE_BYTES;
use jbt_ir::watch;
use jbt_model::diagnostic::{Diagnostics, SourceText};
pub use jbt_model::function::Function;
use jbt_model::model::Model;
use jbt_model::word::normalized;

pub use compare::{MAX_DIFFERENCES, ModelDifference, compare};
pub use field_difference::field_difference;
pub use hash::{HASH_VERSION, ModelHash, hash};
pub use print::print;
pub use rust::print_rust;
pub use state::Options;
use texts::Texts;
pub use words::COMMON_FIELDS;

/// The model of a text.
///
/// ```
/// use jbt_text::{Options, parse, print};
/// let model = parse(b"jbt 1 point { surface_radius 2 - 1 }", &Options::default()).unwrap();
/// assert_eq!(parse(print(&model).as_bytes(), &Options::default()).unwrap(), model);
/// ```
///
/// # Errors
///
/// All that is wrong with the text, in its order, up to [`jbt_ir::limits::MAX_ERRORS`] and a count of the
/// others. Whether the model makes sense, [`check`](jbt_model::check) says.
pub fn parse(text: &[u8], options: &Options) -> Result<Model, Diagnostics> {
    watch::guarded(|| parse_guarded(text, options))?
}

fn parse_guarded(text: &[u8], options: &Options) -> Result<Model, Diagnostics> {
    // The model keeps it.
    watch::take(text.len());
    let text = &*in_normal_form(text);
    let texts = Texts::new(text.len());
    let source = || Some(SourceText::new(SourceText::UNNAMED, text).including(texts.included()));
    match parse::read(text, &texts, options) {
        Ok(model) => Ok(Model { source: source(), ..model }),
        Err(list) => Err(Diagnostics::new(list, source())),
    }
}

/// The text in the normal form C of Unicode, as names have it; messages quote it so. What is no text, or is
/// too long for one, stays as it is.
fn in_normal_form(text: &[u8]) -> Cow<'_, [u8]> {
    let known = (text.len() <= MAX_SCENE_BYTES).then(|| std::str::from_utf8(text).ok()).flatten();
    match known.map(normalized) {
        Some(Cow::Owned(text)) => Cow::Owned(text.into_bytes()),
        Some(Cow::Borrowed(_)) | None => Cow::Borrowed(text),
    }
}

/// The model of a text: [`parse`] without options.
///
/// ```
/// let model = jbt_text::model("jbt 1 point { surface_radius 1 }")?;
/// assert_eq!(jbt_text::model(&jbt_text::print(&model))?, model);
/// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
/// ```
///
/// # Errors
/// Those of [`parse`].
pub fn model(text: &str) -> Result<Model, Diagnostics> {
    parse(text.as_bytes(), &Options::default())
}

/// The names of the functions of expressions, as `sqrt`; in formulas of fields, falloffs are functions too.
pub fn functions() -> impl Iterator<Item = &'static str> {
    Function::ALL.into_iter().map(Function::name)
}

/// The value of an expression of numbers alone, as `2 * pi`.
///
/// # Errors
///
/// All that is wrong with it.
pub fn number(text: &str) -> Result<f64, Diagnostics> {
    let source = || SourceText::new(SourceText::UNNAMED, text.as_bytes());
    parse::read_number(text).map_err(|list| Diagnostics::new(list, Some(source())))
}
