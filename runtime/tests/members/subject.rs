//! A row, compiled: what the checks ask.

use jbt::diagnostic::{Diagnostic, Source};
use jbt::{Box3, CheckedTree, Compiler, Engine, Evaluator, Model, Points, Query, Samples, text};

use crate::common::answers;
use crate::row::Row;

/// How much larger than the support the box is in which points are taken, on each side, as a part of its
/// longest side.
const AROUND: f64 = 1.0 / 64.0;

/// A row with its model on all engines.
pub struct Subject {
    pub row: Row,
    pub model: Model,
    pub tree: CheckedTree,
    /// Where points are taken: around the support, or where the row says.
    pub bounds: Box3,
    /// For the field alone, one for each engine.
    pub field: Vec<Evaluator>,
    /// For everything, one for each engine.
    pub all: Vec<Evaluator>,
}

/// The diagnostics as people see them.
fn shown(name: &str, text: &str, errors: &[Diagnostic]) -> String {
    let source = Source { name, text: text.as_bytes() };
    errors.iter().map(|error| source.render(error) + "\n").collect()
}

impl Subject {
    /// Reads, checks and compiles a row.
    pub fn new(row: Row) -> Result<Self, String> {
        let text = format!("jbt 1 {}", row.text);
        let model = text::parse(text.as_bytes(), &text::Options::default())
            .map_err(|errors| shown(row.name, &text, &errors))?;
        let tree = model.check().map_err(|errors| shown(row.name, &text, &errors))?;
        let bounds = bounds(&row, &tree)?;
        let compile = |query| {
            let of = |engine| Compiler::for_engine(engine).evaluator(&tree, query);
            Engine::ALL.map(of).into_iter().collect::<Result<Vec<_>, _>>().map_err(|error| error.to_string())
        };
        let (field, all) = (compile(Query::FIELD)?, compile(Query::ALL)?);
        Ok(Self { row, model, tree, bounds, field, all })
    }

    /// Everything at points, by one engine.
    pub fn answers(&self, engine: Engine, points: &Points) -> Samples {
        let evaluator =
            self.all.iter().find(|evaluator| evaluator.engine() == engine).expect("all are there");
        answers(evaluator, points)
    }

    /// The named points.
    pub fn named(&self) -> impl Iterator<Item = [f64; 3]> {
        let attributes = self.row.attributes.iter().map(|attributes| attributes.at);
        self.row.fields.iter().map(|&(at, _)| at).chain(attributes)
    }
}

fn bounds(row: &Row, tree: &CheckedTree) -> Result<Box3, String> {
    let support = tree.support();
    let box3 = |low: [f64; 3], high: [f64; 3]| Box3::new(low.map(|x| x as f32), high.map(|x| x as f32));
    let bounds = match row.unbounded {
        Some([low, high]) => box3(low, high),
        None if support.is_finite() => {
            let around = AROUND * support.longest_side();
            box3(support.low().map(|x| x - around), support.high().map(|x| x + around))
        }
        None => {
            return Err(format!("the support is {support:?}, and the row does not say that it is unbounded"));
        }
    };
    if bounds.is_proper() { Ok(bounds) } else { Err(format!("{bounds:?} is not a box to take points in")) }
}
