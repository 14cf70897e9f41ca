//! fidget (Keeter), which compiles closed-form expressions to straight-line machine code and prunes them by
//! interval evaluation.
//!
//! The function is that of [`crate::model::tree`]: with `s = |p - c|^2 / R^2` and `u = max(1 - s, 0)`, the
//! sum of `u^2 (5 + 4u) / 9`. Fidget's inside is negative, so its surface is that of `iso - F`.
//!
//! ```text
//! blobs -> Expression     nodes of a context            Expression::new
//!       -> FidgetModel    instructions, registers       FidgetModel::compile
//!       -> FieldTape      machine code or bytecode      FidgetModel::field, gradient
//! ```
//!
//! Fidget simplifies an expression for a box where an op with two operands always takes the same one there.
//! How a falloff of compact support is written decides what falls away, see [`Gate`]; whoever reports a time
//! reports the best of them.
//!
//! **In a chain, the accumulator is the right operand of each sum** (`term + acc`): as the left one, it is
//! evaluated before all terms, and all of them are alive at once. A context sorts the operands of a sum by
//! age, so all terms are made before the first sum.

use fidget::context::{Context, Node};
use fidget::eval::{BulkEvaluator, Function, MathFunction};
use fidget::mesh::{Octree, Settings};
use fidget::raster::{pixel, voxel};
use fidget::render::{CancelToken, RenderHints, ThreadPool};
use fidget::shape::{BoundShape, EzShape, Shape, ShapeBulkEval, ShapeTape};
use fidget::types::Grad;
pub use fidget::{jit::JitFunction, vm::VmFunction};

use super::{MeshSize, Threads};
use crate::model::{Blob, ISO};

/// How a term that is zero outside of its ball is written, so that it can be pruned.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Gate {
    /// Just the maximum in u: where it is 0, the polynomial of 0 is still computed and added.
    None,
    /// `and(u, term)`: where u is 0, a zero is added.
    And,
    /// `if u != 0 { term + acc } else { acc }`: where u is 0, nothing is left. Takes four ops more for each
    /// blob elsewhere.
    If,
}

impl Gate {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::None, Self::And, Self::If];

    /// A word for reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::And => "and",
            Self::If => "if",
        }
    }
}

/// In which order terms are added.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Order {
    /// One after the other.
    Chain,
    /// In pairs, and pairs of pairs. Only for gates that are part of the term: an `if` is a chain in any
    /// case.
    Balanced,
}

impl Order {
    /// The one that fidget is faster with: pairs for fields (by a tenth) and for meshes (twice as fast with
    /// `and`), wherever there is a choice.
    #[must_use]
    pub const fn best(gate: Gate) -> Self {
        match gate {
            Gate::None | Gate::And => Self::Balanced,
            Gate::If => Self::Chain,
        }
    }
}

/// A sum of blobs as an expression.
pub struct Expression {
    context: Context,
    field: Node,
    surface: Node,
}

impl Expression {
    /// The expression of the field, and of `iso - field`, in the best order.
    #[must_use]
    pub fn new(blobs: &[Blob], gate: Gate) -> Self {
        Self::ordered(blobs, gate, Order::best(gate))
    }

    /// As [`new`](Self::new), adding in this order.
    #[must_use]
    pub fn ordered(blobs: &[Blob], gate: Gate, order: Order) -> Self {
        let mut context = Context::new();
        let made =
            sum(&mut context, blobs, gate, order).and_then(|field| Ok((field, context.sub(ISO, field)?)));
        let (field, surface) = made.expect("all nodes are of this context");
        Self { context, field, surface }
    }
}

type Made<T> = Result<T, fidget::context::BadNode>;

fn sum(context: &mut Context, blobs: &[Blob], gate: Gate, order: Order) -> Made<Node> {
    let terms: Vec<(Node, Node)> = blobs.iter().map(|blob| term(context, blob)).collect::<Made<_>>()?;
    let zero = context.constant(0.0);
    if gate == Gate::If {
        return terms.into_iter().try_fold(zero, |acc, (u, term)| {
            let more = context.add(term, acc)?;
            context.if_nonzero_else(u, more, acc)
        });
    }
    let gated = |(u, term)| if gate == Gate::And { context.and(u, term) } else { Ok(term) };
    let mut terms: Vec<Node> = terms.into_iter().map(gated).collect::<Made<_>>()?;
    if order == Order::Chain {
        return terms.into_iter().try_fold(zero, |acc, term| context.add(term, acc));
    }
    while terms.len() > 1 {
        let pair = |pair: &[Node]| match pair {
            [a, b] => context.add(*a, *b),
            single => Ok(single[0]),
        };
        terms = terms.chunks(2).map(pair).collect::<Made<_>>()?;
    }
    Ok(terms.pop().unwrap_or(zero))
}

/// u and the field of a blob.
fn term(context: &mut Context, blob: &Blob) -> Made<(Node, Node)> {
    let mut square = None;
    for (x, center) in context.axes().into_iter().zip(blob.center) {
        let away = context.sub(x, center)?;
        let part = context.square(away)?;
        square = Some(match square {
            None => part,
            Some(sum) => context.add(sum, part)?,
        });
    }
    let square = square.expect("there are three axes");
    let scaled = context.mul(square, -1.0 / (blob.radius * blob.radius))?;
    let inside = context.add(scaled, 1.0)?;
    let u = context.max(inside, 0.0)?;
    let slope = context.mul(u, 4.0 / 9.0)?;
    let slope = context.add(slope, 5.0 / 9.0)?;
    let square = context.square(u)?;
    Ok((u, context.mul(square, slope)?))
}

/// A sum of blobs in fidget's instructions, for one of its engines: [`JitFunction`] or [`VmFunction`].
pub struct FidgetModel<F> {
    field: Shape<F>,
    surface: Shape<F>,
}

impl<F: MathFunction + RenderHints> FidgetModel<F> {
    /// Expression and instructions at once.
    #[must_use]
    pub fn new(blobs: &[Blob], gate: Gate) -> Self {
        Self::of(&Expression::new(blobs, gate))
    }

    /// The instructions of the field alone: the stage between an expression and a tape, for timing.
    #[must_use]
    pub fn compile(expression: &Expression) -> Shape<F> {
        Shape::new(&expression.context, expression.field).expect("the node is of this context")
    }

    /// The instructions of the surface, negative inside.
    #[must_use]
    pub fn compile_surface(expression: &Expression) -> Shape<F> {
        Shape::new(&expression.context, expression.surface).expect("the node is of this context")
    }

    /// The model of an expression.
    #[must_use]
    pub fn of(expression: &Expression) -> Self {
        Self { field: Self::compile(expression), surface: Self::compile_surface(expression) }
    }

    /// Code for fields.
    #[must_use]
    pub fn field(&self) -> FieldTape<F> {
        FieldTape::new(&self.field)
    }

    /// Code for fields with gradients.
    #[must_use]
    pub fn gradient(&self) -> GradientTape<F> {
        GradientTape::new(&self.field)
    }

    /// A mesh of the cube [-1, 1]^3, fidget's own domain, by manifold dual contouring with `2^depth` cells
    /// along each side: at depth 7, cells are those of a lattice of 129^3 points. Fidget merges cells where
    /// the surface is flat enough, and makes positions alone, neither normals nor attributes. Code is made on
    /// the way.
    #[must_use]
    pub fn mesh(&self, depth: u8, threads: Threads) -> MeshSize {
        mesh(&self.surface, depth, threads)
    }
}

fn mesh<F: MathFunction + RenderHints>(shape: &Shape<F>, depth: u8, threads: Threads) -> MeshSize {
    let shape: BoundShape<'_, F, f32> = shape.clone().try_into().expect("x, y and z alone");
    let settings =
        Settings { depth, threads: pool(threads), cancel: CancelToken::new(), ..Settings::default() };
    let octree = Octree::build(&shape, &settings).expect("nobody cancels");
    let mesh = octree.walk_dual();
    MeshSize { triangles: mesh.triangles.len(), vertices: mesh.vertices.len() }
}

impl<F: MathFunction + RenderHints> FidgetModel<F> {
    /// A picture of the cube [-1, 1]^3 along z, of so many pixels along each side: the depth and the gradient
    /// of each. How many pixels see the surface. Code is made on the way.
    #[must_use]
    pub fn picture(&self, side: u32, threads: Threads) -> usize {
        let shape: BoundShape<'_, F, f32> = self.surface.clone().try_into().expect("x, y and z alone");
        let config = voxel::RenderConfig::from_size(side.into());
        let settings = voxel::EvalConfig { threads: pool(threads), ..Default::default() };
        let image = voxel::render(shape, &config, &settings).expect("nobody cancels");
        image.iter().filter(|pixel| pixel.depth > 0).count()
    }
}

/// A program of instructions (`.vm`), negative inside.
pub struct FidgetProgram<F>(Shape<F>);

impl<F: MathFunction + RenderHints> FidgetProgram<F> {
    /// Reads a program.
    ///
    /// # Errors
    /// What fidget says about it.
    pub fn new(text: &[u8]) -> Result<Self, String> {
        let (context, root) = Context::from_text(text).map_err(|error| error.to_string())?;
        Shape::new(&context, root).map(Self).map_err(|error| error.to_string())
    }

    /// Code that answers with its value at points.
    #[must_use]
    pub fn tape(&self) -> FieldTape<F> {
        FieldTape::new(&self.0)
    }

    /// A mesh, as [`FidgetModel::mesh`] makes it.
    #[must_use]
    pub fn mesh(&self, depth: u8, threads: Threads) -> MeshSize {
        mesh(&self.0, depth, threads)
    }

    /// The square [-1, 1]^2 of the plane z = 0, of so many pixels along each side: how many are inside. Code
    /// is made on the way.
    #[must_use]
    pub fn inside(&self, side: u32, threads: Threads) -> usize {
        let shape: BoundShape<'_, F, f32> = self.0.clone().try_into().expect("x, y and z alone");
        let config = pixel::RenderConfig::from_size(side.into());
        let settings = pixel::EvalConfig { threads: pool(threads), ..Default::default() };
        let image = pixel::render(shape, &config, &settings).expect("nobody cancels");
        image.iter().filter(|pixel| pixel.inside()).count()
    }
}

/// Fidget's way to say on which threads.
fn pool(threads: Threads) -> Option<&'static ThreadPool> {
    match threads {
        Threads::One => None,
        Threads::All => Some(&ThreadPool::Global),
    }
}

type Tape<E> = ShapeTape<<E as BulkEvaluator>::Tape>;

/// Code that answers with fields, and its scratch.
pub struct FieldTape<F: Function> {
    tape: Tape<F::FloatSliceEval>,
    evaluator: ShapeBulkEval<F::FloatSliceEval>,
}

impl<F: Function> FieldTape<F> {
    /// Points in a call, so that what is copied in and out stays in the innermost cache.
    pub const SLICE: usize = 256;

    /// Makes the code: the last stage.
    #[must_use]
    pub fn new(shape: &Shape<F>) -> Self {
        Self { tape: shape.ez_float_slice_tape(), evaluator: Shape::<F>::new_float_slice_eval() }
    }

    /// The field at points. Panics if the lengths differ.
    pub fn eval(&mut self, points: [&[f32]; 3], out: &mut [f32]) {
        self.eval_by(Self::SLICE, points, out);
    }

    /// The same with `slice` points in a call.
    pub fn eval_by(&mut self, slice: usize, points: [&[f32]; 3], out: &mut [f32]) {
        let [x, y, z] = points.map(|plane| plane.chunks(slice));
        for (((x, y), z), out) in x.zip(y).zip(z).zip(out.chunks_mut(slice)) {
            out.copy_from_slice(self.evaluator.eval(&self.tape, x, y, z).expect("slices of one length"));
        }
    }
}

/// Code that answers with fields and gradients, and its scratch.
pub struct GradientTape<F: Function> {
    tape: Tape<F::GradSliceEval>,
    evaluator: ShapeBulkEval<F::GradSliceEval>,
    points: [Vec<Grad>; 3],
}

impl<F: Function> GradientTape<F> {
    /// Points in a call.
    pub const SLICE: usize = 256;

    /// Makes the code: the last stage.
    #[must_use]
    pub fn new(shape: &Shape<F>) -> Self {
        let evaluator = Shape::<F>::new_grad_slice_eval();
        Self { tape: shape.ez_grad_slice_tape(), evaluator, points: Default::default() }
    }

    /// Field and gradient at points; `outs` are the planes of the field and of the gradient's x, y and z.
    /// Panics if lengths differ.
    pub fn eval(&mut self, points: [&[f32]; 3], outs: [&mut [f32]; 4]) {
        let [f, gx, gy, gz] = outs;
        for start in (0..f.len()).step_by(Self::SLICE) {
            let range = start..f.len().min(start + Self::SLICE);
            for (axis, plane) in self.points.iter_mut().enumerate() {
                let [dx, dy, dz] = [0, 1, 2].map(|k| f32::from(u8::from(k == axis)));
                plane.clear();
                plane.extend(points[axis][range.clone()].iter().map(|&x| Grad::new(x, dx, dy, dz)));
            }
            let [x, y, z] = &self.points;
            let answers = self.evaluator.eval(&self.tape, x, y, z).expect("slices of one length");
            for (i, answer) in range.zip(answers) {
                (f[i], gx[i], gy[i], gz[i]) = (answer.v, answer.dx, answer.dy, answer.dz);
            }
        }
    }
}
