//! What to say to people who know another program's words: loops, modules, shapes with arguments in
//! parentheses.

use super::words::field_word;
use jbt_model::skeleton::SkeletonKind;

/// Words of other programs, and what stands for them here.
const WORDS: &[(&[&str], &str)] = &[
    (
        &["for", "foreach", "while", "loop", "intersection_for"],
        "a loop is `for i in 0 .. 6 { .. }`, or over a list, `for p in [(0 0 0) (1 0 0)] { .. }`",
    ),
    (
        &["module", "function", "def", "macro", "fn", "object"],
        "a part with arguments is `def NAME(a, b = 1) { .. }`, one without `let NAME = ..` and `use NAME`",
    ),
    (&["include", "import", "require"], "a file beside the scene is `include \"parts.jbt\"`"),
    (
        &["if", "else", "switch", "case"],
        "a condition is `if i > 2 { .. } else { .. }`, and what may change later `select which { a b }`",
    ),
    (
        &["var", "const", "define", "set", "float", "int", "double"],
        "a number with a name is `param NAME = 1`",
    ),
    (&["cube", "cuboid", "brick", "rounded_box"], "a box is `box { half (1 1 1) surface_radius 0.1 }`"),
    (&["ball", "metaball", "blob", "uv_sphere"], "a ball is `point { at (0 0 0) surface_radius 1 }`"),
    (&["ellipse", "egg"], "see `ellipsoid`, `disc` and `scale (2 1 1) { .. }`"),
    (
        &["capsule", "line", "rod", "stick", "pill", "line_segment"],
        "a rod with round ends is `segment { from (0 0 0) to (1 0 0) surface_radius 0.5 }`",
    ),
    (&["tube", "pipe", "wire"], "a tube is a `polyline` or `bezier` with a radius"),
    (&["circle"], "a circular line is a `ring`, a flat figure a `disc`"),
    (&["square"], "a flat figure is a `rectangle`"),
    (&["plane", "ground", "halfspace"], "everything on one side of a plane is a `half_space`"),
    (
        &["smin", "smooth_min", "softmin", "smoothunion", "round_union", "hull", "minkowski"],
        "what blends is `sum { .. }`, `blend ricci 4 { .. }` or `smooth_union width 0.2 { .. }`",
    ),
    (
        &["add", "plus", "group", "merge", "combine", "join"],
        "`sum { .. }` adds fields, `union { .. }` does not blend",
    ),
    (&["subtract", "minus", "cut", "carve", "hole"], "what cuts is `difference { what minus_what .. }`"),
    (&["and", "intersect", "common"], "what is common to all is `intersection { .. }`"),
    (&["or"], "what is in one of them is `union { .. }`"),
    (&["not", "invert", "inverse"], "what is inside out is `complement { .. }`"),
    (&["move", "shift", "position", "transform"], "what moves a node is `translate (1 0 0) { .. }`"),
    (&["rotate_x", "rotatex", "rotx"], "`rotate axis x degrees 90 { .. }`"),
    (&["rotate_y", "rotatey", "roty"], "`rotate axis y degrees 90 { .. }`"),
    (&["rotate_z", "rotatez", "rotz"], "`rotate axis z degrees 90 { .. }`"),
    (&["multmatrix", "matrix"], "12 numbers are a map: `affine (1 0 0 0  0 1 0 0  0 0 1 0) { .. }`"),
    (&["resize"], "`scale 2 { .. }`, or along the axes `scale (1 1 2) { .. }`"),
    (
        &["material", "texture", "pigment"],
        "a colour is `color \"#ff8800\" { .. }`; other numbers are declared: attribute shine 1",
    ),
    (
        &["linear_extrude", "rotate_extrude", "extrude", "lathe", "revolve"],
        "nothing is extruded: a `polygon` has a radius all around, and a formula is `expression { .. }`",
    ),
];

/// What stands here for a word of another program.
pub(super) fn foreign_word(word: &str) -> Option<&'static str> {
    let known = |known: &&str| known.eq_ignore_ascii_case(word);
    WORDS.iter().find(|(words, _)| words.iter().any(&known)).map(|(_, hint)| *hint)
}

/// What stands here for a mark of another program.
pub(super) fn foreign_mark(text: &str) -> Option<&'static str> {
    match text.as_bytes().first()? {
        b'[' | b']' => Some("a vector is (1 0 0), without brackets; a list of vectors is [(1 0 0) (0 1 0)]"),
        b';' => Some("nothing stands between nodes"),
        b'"' if text.len() > 1 && text.ends_with('"') => {
            Some("quotes are for colours alone, without parentheses: color \"#ff8800\" { .. }")
        }
        b'"' => Some("this quote is not closed on its line"),
        b'<' | b'>' => {
            Some("comparisons stand behind `if`; in a formula `step(a, x)` is 1 where x is at least a")
        }
        b'%' => Some("a remainder is `mod(a, b)`"),
        _ => None,
    }
}

/// How a primitive is written, for who wrote its parameters in parentheses.
pub(super) fn in_braces(kind: SkeletonKind) -> String {
    let words: Vec<_> = kind.fields().iter().map(|field| field_word(kind, field)).collect();
    let own = ["surface_radius", "radius"].map(Into::into);
    let all: Vec<_> = words.into_iter().chain(own).collect();
    let name = kind.name();
    let more = plain_ball(kind).map(|ball| format!("; {ball}")).unwrap_or_default();
    format!("parameters stand in braces by name, `{name} {{ .. }}`: {}{more}", all.join(", "))
}

/// What is told about a primitive whose radii are not all there.
pub(super) fn radii(kind: SkeletonKind, has_radius: bool) -> Option<String> {
    let ball = plain_ball(kind).map(str::to_owned);
    let radius = || "`surface_radius` is where its surface is, `radius` where its field ends".to_owned();
    ball.or_else(|| (!has_radius).then(radius))
}

fn plain_ball(kind: SkeletonKind) -> Option<&'static str> {
    (kind == SkeletonKind::Sphere).then_some("a plain ball is `point { surface_radius 1 }`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_format_are_not_foreign() {
        let words: Vec<&str> = WORDS.iter().flat_map(|(words, _)| words.iter().copied()).collect();
        assert!(words.iter().all(|word| !crate::words::is_reserved(word)), "{words:?}");
        let mut sorted = words.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), words.len());
    }
}
