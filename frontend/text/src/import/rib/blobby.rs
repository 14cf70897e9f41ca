//! The program of a `Blobby`: instructions over the fields of leaves become a tree.
//!
//! ```text
//! 1001 0        0: the ellipsoid of floats 0 .. 16          point under a map
//! 1001 16       1: the ellipsoid of floats 16 .. 32
//! 0 2 0 1       2: the sum of the results 0 and 1           sum
//! 4 2 0         3: result 2 less result 0; the last one     expression { field(a) - field(b) }
//!                  is the field                             (result 0 is shared)
//! ```
//!
//! A constant is a number until it meets a field. What a result is far from all leaves is known: where that
//! is not 0, the field ends at the box of the leaves' supports.

use glam::{DAffine3, DMat3, DVec3};
use jbt_model::affine::map_bounds;
use jbt_model::bounds::Bounds;
use jbt_model::combine::{Combinator, Intersection, Sum, Union};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::falloff::Falloff;
use jbt_model::kind::Primitive;
use jbt_model::skeleton::{Point, Segment, Skeleton};
use jbt_model::term::Term;
use jbt_model::tree::Tree;

/// The surface of every `Blobby`: (3/4)^3, so that a lone unit ellipsoid has a surface of radius 1/2.
pub(super) const ISO: f64 = 27.0 / 64.0;

/// The colours of the leaves of a `Blobby`.
pub(super) enum LeafColors {
    /// One for all, which stands above them.
    Common,
    /// One for each, in order.
    Each(Vec<[f64; 3]>),
}

/// A field, or a number that is the same everywhere.
#[derive(Clone)]
struct BlobbyPart {
    /// `None` for a number.
    tree: Option<Tree>,
    /// What it is far from all leaves.
    far: f64,
}

impl BlobbyPart {
    fn number(far: f64) -> Self {
        Self { tree: None, far }
    }

    fn term(&self) -> Term {
        self.tree.as_ref().map_or_else(|| self.far.into(), Tree::field)
    }

    fn tree(&self) -> Tree {
        self.tree.clone().unwrap_or_else(|| Tree::expression(self.far))
    }
}

/// The field of a `Blobby`.
pub(super) struct BlobbyField {
    pub(super) tree: Tree,
    /// What it is far from all leaves.
    pub(super) far: f64,
    /// Boxes of the supports of all leaves.
    pub(super) bounds: Bounds,
}

/// The codes of a `Blobby` and the numbers that they name.
pub(super) struct BlobbyProgram<'a> {
    pub(super) codes: &'a [f64],
    pub(super) floats: &'a [f64],
    /// The strings, for messages.
    pub(super) texts: &'a [String],
    /// The place of the codes.
    pub(super) span: Span,
    /// The place of the floats.
    pub(super) floats_span: Span,
}

/// An instruction: its code and its operands.
type BlobbyInstruction<'a> = (u32, &'a [f64]);

impl BlobbyProgram<'_> {
    fn error<T>(&self, message: impl Into<String>) -> Result<T, Diagnostic> {
        Err(Diagnostic::error(Some(self.span), message))
    }

    /// The instructions, in order.
    pub(super) fn instructions(&self) -> Result<Vec<BlobbyInstruction<'_>>, Diagnostic> {
        let (mut all, mut rest) = (Vec::new(), self.codes);
        while let Some((&code, after)) = rest.split_first() {
            let number = all.len();
            let count = match code {
                1000.0 | 1001.0 | 1002.0 | 6.0 | 7.0 => 1,
                1003.0 | 4.0 | 5.0 => 2,
                1004.0 => 5,
                0.0 | 1.0 | 2.0 | 3.0 | 9000.0 => {
                    let Some(count) = after.first().copied().and_then(index) else {
                        return self.error(format!("instruction {number} has no number of operands"));
                    };
                    count.saturating_add(1)
                }
                _ => {
                    return self
                        .error(format!("instruction {number} has the code {code}, which is not known"));
                }
            };
            let Some((operands, after)) = after.split_at_checked(count) else {
                return self.error(format!("the codes end within instruction {number}"));
            };
            all.push((code as u32, operands));
            rest = after;
        }
        if all.is_empty() { self.error("the Blobby has no instructions") } else { Ok(all) }
    }

    /// The field of the last instruction.
    pub(super) fn field(
        &self,
        instructions: &[BlobbyInstruction<'_>],
        colors: &LeafColors,
    ) -> Result<BlobbyField, Diagnostic> {
        let mut results: Vec<BlobbyPart> = Vec::with_capacity(instructions.len());
        let (mut bounds, mut leaves) = (Bounds::EMPTY, 0);
        for (number, &(code, operands)) in instructions.iter().enumerate() {
            let part = match code {
                1000 => BlobbyPart::number(self.floats(number, operands[0], 1)?[0]),
                1001 => {
                    let map = self.matrix(number, self.floats(number, operands[0], 16)?)?;
                    bounds = bounds.hull(map_bounds(&map, Bounds::new(DVec3::NEG_ONE, DVec3::ONE)));
                    self.leaf(ellipsoid(&map), leaves, colors)
                }
                1002 => {
                    let (map, segment, radius) = self.segment(number, operands[0])?;
                    let own = Bounds::around([segment.from, segment.to]).grown(radius);
                    bounds = bounds.hull(map_bounds(&map, own));
                    self.leaf(placed(leaf(segment, radius), &map), leaves, colors)
                }
                0..=3 => self.several(number, code, &operands[1..], &results)?,
                4..=7 => self.few(number, code, operands, &results)?,
                _ => return self.plug_in(number, code, operands),
            };
            leaves += usize::from(code >= 1000);
            results.push(BlobbyPart { tree: part.tree.map(|tree| tree.located(self.span)), ..part });
        }
        let last = &results[results.len() - 1];
        Ok(BlobbyField { tree: last.tree(), far: last.far, bounds })
    }

    fn leaf(&self, tree: Tree, number: usize, colors: &LeafColors) -> BlobbyPart {
        let tree = match colors {
            LeafColors::Common => tree,
            LeafColors::Each(all) => all.get(number).map_or(tree.clone(), |color| tree.color(*color)),
        };
        BlobbyPart { tree: Some(tree), far: 0.0 }
    }

    /// The error about a leaf that asks for more than the file has.
    fn plug_in<T>(&self, number: usize, code: u32, operands: &[f64]) -> Result<T, Diagnostic> {
        let name = operands.iter().filter_map(|&operand| index(operand)).find_map(|at| {
            // The first operand that is a place among the strings; a plug-in of AIR has its number before it.
            self.texts.get(at).filter(|name| !name.is_empty())
        });
        let name = name.map_or_else(String::new, |name| format!(" `{}`", jbt_model::report::clip(name)));
        match code {
            1003 => self.error(format!(
                "instruction {number} is a repelling plane (1003) over the depth map{name}, another file"
            )),
            _ => self.error(format!("instruction {number} calls a plug-in ({code}){name}, a program")),
        }
    }

    /// Numbers of the floats from a place on.
    fn floats(&self, number: usize, at: f64, count: usize) -> Result<&[f64], Diagnostic> {
        let found = index(at).and_then(|at| self.floats.get(at..at.checked_add(count)?));
        found.ok_or_else(|| {
            let message = format!("instruction {number} asks for {count} numbers from {at} on");
            let help = format!("there are {}", self.floats.len());
            Diagnostic::error(Some(self.span), message).expected(help)
        })
    }

    /// The result of an earlier instruction.
    fn earlier<'p>(
        &self,
        number: usize,
        operand: f64,
        results: &'p [BlobbyPart],
    ) -> Result<&'p BlobbyPart, Diagnostic> {
        let found = index(operand).and_then(|operand| results.get(operand));
        found.ok_or_else(|| {
            let message = format!("instruction {number} asks for the result of instruction {operand}");
            Diagnostic::error(Some(self.span), message).expected("expected the number of an earlier one")
        })
    }

    /// A sum, product, maximum or minimum.
    fn several(
        &self,
        number: usize,
        code: u32,
        operands: &[f64],
        results: &[BlobbyPart],
    ) -> Result<BlobbyPart, Diagnostic> {
        if operands.is_empty() {
            return self.error(format!("instruction {number} has no operands"));
        }
        let parts = operands.iter().map(|&operand| self.earlier(number, operand, results));
        let parts: Vec<&BlobbyPart> = parts.collect::<Result<_, _>>()?;
        let numbers = parts.iter().filter(|part| part.tree.is_none()).map(|part| part.far);
        let of_numbers = numbers.reduce(|a, b| combined(code, a, b));
        let fields: Vec<Tree> = parts.iter().filter_map(|part| part.tree.clone()).collect();
        let far = parts.iter().map(|part| part.far).reduce(|a, b| combined(code, a, b)).unwrap_or(0.0);
        if fields.is_empty() {
            return Ok(BlobbyPart::number(far));
        }
        let over = |operator: Combinator, mut fields: Vec<Tree>| {
            if fields.len() == 1 { fields.remove(0) } else { Tree::at(self.span, operator, fields) }
        };
        let with_number = |mut fields: Vec<Tree>| {
            fields.extend(of_numbers.map(Tree::expression));
            fields
        };
        let tree = match code {
            0 => {
                let sum = over(Sum {}.into(), fields);
                of_numbers.map_or_else(|| sum.clone(), |number| Tree::expression(sum.field() + number))
            }
            1 => {
                let mut terms = fields.iter().map(Tree::field).chain(of_numbers.map(Term::from));
                let first = terms.next().unwrap_or_else(|| 1.0.into());
                if fields.len() == 1 && of_numbers.is_none() {
                    fields[0].clone()
                } else {
                    Tree::expression(terms.fold(first, |product, term| product * term))
                }
            }
            2 => over(Union {}.into(), with_number(fields)),
            _ => over(Intersection {}.into(), with_number(fields)),
        };
        Ok(BlobbyPart { tree: Some(tree), far })
    }

    /// A difference, quotient, opposite or the same.
    fn few(
        &self,
        number: usize,
        code: u32,
        operands: &[f64],
        results: &[BlobbyPart],
    ) -> Result<BlobbyPart, Diagnostic> {
        let a = self.earlier(number, operands[0], results)?;
        let b = operands.get(1).map_or(Ok(a), |&operand| self.earlier(number, operand, results))?;
        let far = match code {
            4 => a.far - b.far,
            5 if b.far == 0.0 => 0.0,
            5 => a.far / b.far,
            6 => -a.far,
            _ => a.far,
        };
        if a.tree.is_none() && b.tree.is_none() {
            return Ok(BlobbyPart::number(far));
        }
        let tree = match code {
            4 => Tree::expression(a.term() - b.term()),
            5 => Tree::expression(a.term() / b.term()),
            6 => Tree::expression(-a.term()),
            _ => a.tree(),
        };
        Ok(BlobbyPart { tree: Some(tree), far })
    }

    /// The line, its radius and its map.
    fn segment(&self, number: usize, at: f64) -> Result<(DAffine3, Segment, f64), Diagnostic> {
        let numbers = self.floats(number, at, 23)?;
        let (from, to) = (DVec3::from_slice(numbers), DVec3::from_slice(&numbers[3..]));
        let radius = numbers[6];
        if radius <= 0.0 {
            let message = format!("the segment of instruction {number} has the radius {radius}");
            let error = Diagnostic::error(Some(self.floats_span), message);
            return Err(error.expected("expected a number above 0"));
        }
        Ok((self.matrix(number, &numbers[7..])?, Segment { from, to }, radius))
    }

    fn matrix(&self, number: usize, numbers: &[f64]) -> Result<DAffine3, Diagnostic> {
        affine(numbers).ok_or_else(|| {
            let message = format!("the matrix of instruction {number} has no inverse, or is no affine map");
            Diagnostic::error(Some(self.floats_span), message)
        })
    }
}

/// An operation of several operands on two numbers.
fn combined(code: u32, a: f64, b: f64) -> f64 {
    match code {
        0 => a + b,
        1 => a * b,
        2 => a.max(b),
        _ => a.min(b),
    }
}

/// A whole number that may be a place in a list.
fn index(number: f64) -> Option<usize> {
    (number >= 0.0 && number.fract() == 0.0 && number < 1e9).then_some(number as usize)
}

/// The map of a matrix by rows for row vectors, the last row of which is the shift. `None` if it is no affine
/// map, or has no inverse.
pub(super) fn affine(numbers: &[f64]) -> Option<DAffine3> {
    let rows: [[f64; 4]; 4] =
        std::array::from_fn(|row| std::array::from_fn(|column| numbers[4 * row + column]));
    let last = rows.map(|row| row[3]);
    if last[..3] != [0.0; 3] || last[3] == 0.0 {
        return None;
    }
    let [x, y, z, shift] = rows.map(|row| DVec3::new(row[0], row[1], row[2]) / last[3]);
    let map = DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: shift };
    let determinant = map.matrix3.determinant();
    (map.is_finite() && determinant.is_normal()).then_some(map)
}

/// A leaf with Wyvill's cubic, which is that of every `Blobby`.
fn leaf(skeleton: impl Into<Skeleton>, radius: f64) -> Tree {
    let skeleton = skeleton.into();
    Tree::new(Primitive { skeleton, falloff: Falloff::Wyvill, radius, strength: 1.0 }, Vec::new())
}

/// The image of the unit ball: a ball without a map, where it is one along the axes.
fn ellipsoid(map: &DAffine3) -> Tree {
    let scale = map.matrix3.x_axis.x;
    if map.matrix3 == DMat3::from_diagonal(DVec3::splat(scale)) {
        return leaf(Point { at: map.translation }, scale.abs());
    }
    placed(leaf(Point { at: DVec3::ZERO }, 1.0), map)
}

/// A tree under a map, if it moves anything.
pub(super) fn placed(tree: Tree, map: &DAffine3) -> Tree {
    if *map == DAffine3::IDENTITY { tree } else { Tree::new(*map, vec![tree]) }
}
