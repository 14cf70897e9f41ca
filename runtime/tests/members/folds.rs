//! What code a sum has: a fold for each shape, whatever the number of its primitives.

use fastrand::Rng;
use jbt::internals::ir::{Function, Rows, Schema};
use jbt::{Compiler, Engine, Falloff, Model, Query, Tree};
use jbt_lower::lower;
use jbt_model::kind::{NodeKind, Primitive};
use jbt_model::skeleton::SkeletonKind;

use jbt_testkit::random::Random;

/// A sum of so many primitives, of every kind of skeleton in turn.
fn sum(count: usize) -> Model {
    let mut rng = Rng::with_seed(count as u64);
    let mut numbers = Random::new(7, count as u64);
    let leaf = |index: usize| {
        let kind = SkeletonKind::ALL[index % SkeletonKind::ALL.len()];
        let skeleton = numbers.skeleton(kind);
        let radius = 0.5 + rng.f64();
        let leaf = Primitive { skeleton, falloff: Falloff::Soft, radius, strength: 1.0 };
        Tree::new(NodeKind::Primitive(leaf), Vec::new())
    };
    Model::new(Tree::sum((0..count).map(leaf)))
}

/// Tables whose rows are operands of the sum: those under the scene's one row.
fn of_operands(function: &Function) -> Vec<&Schema> {
    let scene =
        function.tables.iter().find(|(_, schema)| schema.parent.is_none()).expect("the scene has one").0;
    function.tables.values().filter(|schema| schema.parent == Some(scene)).collect()
}

#[test]
fn a_sum_of_a_thousand_has_a_fold_for_each_skeleton() {
    let kinds = SkeletonKind::ALL.len();
    let [one_each, thousand] = [kinds, 1000].map(|count| sum(count).check().expect("a good model"));
    for query in Query::EVERY {
        let few = lower(&one_each, query).expect("it lowers");
        let many = lower(&thousand, query).expect("it lowers");
        // Compiling takes functions and no rows, so it takes the same.
        assert!(few.function == many.function, "{}: the shapes are the same", query.name());
        assert_eq!(of_operands(&many.function).len(), kinds);
        let evaluator = Compiler::for_engine(Engine::Lanes).evaluator(&thousand, query).expect("it compiles");
        let compiled = evaluator.program().function();
        assert_eq!(of_operands(compiled).len(), kinds);
        assert_eq!(compiled.folds().iter().flatten().count(), compiled.tables.len());
        assert_eq!(evaluator.evaluations_per_point(), 1000);
        let rows: usize = many.tables.tables.values().map(Rows::len).sum();
        assert!(rows > 1000, "{rows} rows, that of the scene among them");
    }
}
