//! The range of a row alone holds every f32 that the row gives in a box, for every skeleton with every
//! falloff: at the sides and corners of boxes that touch the edge of what the row reaches.

use jbt::Tree;
use jbt::internals::ir::domain::interval::enclose;
use jbt::internals::ir::domain::scalar::Scalar;
use jbt::internals::ir::interpret::run;
use jbt::internals::ir::{RowFunction, Tables, verify};
use jbt_lower::lower_ranges;
use jbt_model::falloff::FalloffKind;
use jbt_model::kind::{NodeKind, Primitive};
use jbt_model::skeleton::SkeletonKind;

use super::*;

/// Rows of a skeleton with a falloff.
const ROWS: usize = 8;

/// A union of rows of one shape.
fn rows(skeleton: SkeletonKind, falloff: FalloffKind, seed: u64) -> Model {
    let mut rng = Rng::with_seed(seed);
    let leaf = |_| {
        // The same shape, other numbers.
        let mut numbers = Random::new(seed, rng.u64(..));
        let skeleton = numbers.skeleton(skeleton);
        let falloff = falloff.from_fields(&numbers.fields(falloff.fields()));
        let leaf = Primitive { skeleton, falloff, radius: 0.3 + rng.f64(), strength: 1.0 };
        Tree::new(NodeKind::Primitive(leaf), Vec::new())
    };
    Model::new(Tree::union((0..ROWS).map(leaf)))
}

/// A box at the edge of a support, or anywhere near.
fn box_at(rng: &mut Rng, support: &jbt_lower::prune_info::Support) -> Box3 {
    let radius = support.radius_squared.sqrt();
    let size = [0.0, 1e-4, 0.05, 0.5][rng.usize(0..4)];
    let low = std::array::from_fn(|axis| {
        let (first, last) = (support.low[axis] - radius, support.high[axis] + radius);
        let (first, last) = (first.clamp(-8.0, 8.0), last.clamp(-8.0, 8.0));
        match rng.u8(0..4) {
            0 => first - size * rng.f32(),
            1 => last - size * rng.f32(),
            _ => first + (last - first).max(0.0) * rng.f32(),
        }
    });
    Box3::new(low, low.map(|side| side + size * rng.f32()))
}

#[test]
fn ranges_of_rows_hold_their_fields() {
    let (mut values, mut positive, mut pairs) = (0, 0, 0);
    for (number, &skeleton) in SkeletonKind::ALL.iter().enumerate() {
        for (other, &falloff) in FalloffKind::ALL.iter().enumerate() {
            let seed = (100 * number + other) as u64;
            let model = rows(skeleton, falloff, seed);
            let Ok(tree) = model.check() else { continue };
            let info = lower_ranges(&tree).expect("it lowers");
            for contest in &info.info.contests {
                for group in contest.groups.iter().filter(|group| group.rows) {
                    let row = RowFunction::new(&info.function, &info.tables, group.table, group.field);
                    // With many pieces it is too long to be one: its range is not known.
                    let Some(row) = row else { continue };
                    let function = verify(row.function.clone()).expect("it obeys the rules");
                    pairs += 1;
                    let mut rng = Rng::with_seed(seed);
                    for index in 0..row.numbers.first().map_or(0, Vec::len) {
                        let numbers: Vec<f32> = row.numbers.iter().map(|plane| plane[index]).collect();
                        for _ in 0..8 {
                            let support = &info.info.tables[group.table].supports[index];
                            let bounds = box_at(&mut rng, support);
                            let sides = (0..3).map(|axis| [bounds.low[axis], bounds.high[axis]]);
                            let inputs: Vec<[f32; 2]> =
                                sides.chain(numbers.iter().map(|&number| [number; 2])).collect();
                            let [low, high] = enclose(&function, &Tables::default(), &inputs)[0];
                            let points = points_in(&mut rng, &bounds, 6);
                            for at in (0..points.len()).map(|point| points.get(point)) {
                                let planes: Vec<f32> = at.into_iter().chain(numbers.clone()).collect();
                                let field = run(&function, &Tables::default(), &mut Scalar, &planes)[0];
                                let holds = low <= field && field <= high;
                                assert!(
                                    holds,
                                    "{} with {}: {field:e} is not in {low:e} to {high:e}, at {at:?}\n{}",
                                    skeleton.name(),
                                    falloff.name(),
                                    print(&model)
                                );
                                // At a point whose support misses it, the row is 0.
                                assert!(!support.misses(at, at) || field == 0.0, "{}", skeleton.name());
                                values += 1;
                                positive += usize::from(field > 0.0);
                            }
                        }
                    }
                }
            }
        }
    }
    println!("{values} values, {positive} above 0, of {pairs} tables");
    let all = SkeletonKind::ALL.len() * FalloffKind::ALL.len();
    assert!(pairs * 10 > all * 8, "most pairs are checked: {pairs} of {all}");
    // Most boxes touch the edge from outside or inside, where fields are 0 or tiny.
    assert!(positive * 12 > values, "some values are inside: {positive} of {values}");
}
