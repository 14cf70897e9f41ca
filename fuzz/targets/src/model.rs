//! Models from bytes: a few bytes are seeds of a random model, more of them are its text.

use fastrand::Rng;
use jbt::text::{Options, parse};
use jbt::{CheckedTree, Compiler, Engine, Model, Pruner, Query};
use jbt_testkit::random::{Numbers, Random, Settings};

/// Up to so many bytes are seeds. No text of a model is as short.
const SEEDS: usize = 18;
/// Leaves along all paths of a model that is compiled for one input.
const MAX_USES: u64 = 400;
/// Leaves along all paths of a model that the scalar engine evaluates at hundreds of points: it takes ten
/// times as long as lanes do.
const MAX_SCALAR_USES: u64 = 8;
/// Nodes of such a model.
const MAX_NODES: usize = 600;

/// The model that bytes mean; none for a text with errors. Texts may have hostile numbers of their own.
pub(crate) fn model(bytes: &[u8], numbers: Numbers) -> Option<Model> {
    if bytes.len() > SEEDS {
        return parse(bytes, &Options::default()).ok();
    }
    let mut padded = [0; SEEDS];
    padded[..bytes.len()].copy_from_slice(bytes);
    let [shape, values] = [0, 8].map(|at| {
        let word: [u8; 8] = padded[at..at + 8].try_into().expect("eight bytes");
        u64::from_le_bytes(word)
    });
    let settings = Settings { numbers, walls: padded[17] & 1 == 0, ..Settings::default() };
    Some(Random::with_settings(shape, values, settings).model(1 + usize::from(padded[16] % 24)))
}

/// The checked model that bytes mean, unless it has errors or is too large to be compiled many times.
pub(crate) fn small_tree(bytes: &[u8]) -> Option<CheckedTree> {
    let tree = model(bytes, Numbers::Ordinary)?.check().ok()?;
    let is_small = tree.nodes().len() <= MAX_NODES && jbt::statistics::leaf_uses(&tree) <= MAX_USES;
    is_small.then_some(tree)
}

/// One of some engines that is quick enough for hundreds of points of a model.
pub(crate) fn quick_engine(rng: &mut Rng, tree: &CheckedTree, engines: &[Engine]) -> Engine {
    let is_small = jbt::statistics::leaf_uses(tree) <= MAX_SCALAR_USES;
    let quick: Vec<Engine> =
        engines.iter().copied().filter(|&engine| is_small || engine != Engine::Scalar).collect();
    quick[rng.usize(0..quick.len())]
}

/// The ops of the field at one point, with all rows; `u64::MAX` if the model is too large to be compiled.
pub(crate) fn ops_per_point(tree: &CheckedTree) -> u64 {
    let compiler = Compiler::for_engine(Engine::Scalar);
    let field = compiler.compile(tree).evaluator(Query::FIELD);
    let both = field.ok().zip(Pruner::new(&compiler, tree).ok());
    both.map_or(u64::MAX, |(field, pruner)| field.ops_in(&pruner.everywhere()))
}

/// Random numbers that are always the same for the same bytes.
pub(crate) fn rng(bytes: &[u8]) -> Rng {
    // FNV-1a, of 64 bits.
    let hash = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
    Rng::with_seed(bytes.iter().fold(0xcbf2_9ce4_8422_2325, hash))
}
