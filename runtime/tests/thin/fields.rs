//! A model as a field of the mesher, with or without pruning, that takes edits.

use jbt::boxes::{Divisible, Range};
use jbt::mesh::{Field, FieldWork};
use jbt::{Box3, CheckedTree, Compiler, Engine, EvalError, Evaluator, Pruner, Query, Region};

pub struct ModelField {
    pruner: Pruner,
    evaluators: [Evaluator; 3],
    is_pruned: bool,
}

impl ModelField {
    pub fn new(tree: &CheckedTree, engine: Engine, is_pruned: bool) -> Self {
        let compiler = Compiler::for_engine(engine);
        let evaluators = [Query::FIELD, Query::GRADIENT, Query::ALL]
            .map(|query| compiler.evaluator(tree, query).expect("it compiles"));
        Self { pruner: Pruner::new(&compiler, tree).expect("it compiles"), evaluators, is_pruned }
    }

    /// The same for another model, by an edit.
    pub fn updated(mut self, tree: &CheckedTree) -> Self {
        self.pruner = self.pruner.updated(tree).expect("it compiles");
        for evaluator in &mut self.evaluators {
            evaluator.update(tree).expect("it compiles");
        }
        self
    }
}

impl Divisible for ModelField {
    type Error = EvalError;
    type Region = Region;

    fn region(&self, bounds: Box3) -> Result<Region, EvalError> {
        if self.is_pruned { self.pruner.region(bounds) } else { Ok(self.pruner.everywhere()) }
    }

    fn ranges(&self, region: &Region, boxes: &[Box3], ranges: &mut [Range]) -> Result<(), EvalError> {
        self.pruner.ranges(region, boxes, ranges)
    }

    fn narrow(&self, region: &Region, boxes: &[Box3], parts: &mut Vec<Region>) -> Result<(), EvalError> {
        if self.is_pruned {
            return self.pruner.narrow(region, boxes, parts);
        }
        parts.extend(boxes.iter().map(|_| region.clone()));
        Ok(())
    }
}

impl Field for ModelField {
    fn attributes(&self) -> Vec<(String, usize)> {
        let layout = self.evaluators[2].layout();
        layout.attributes().map(|(name, _, width)| (name.to_owned(), width)).collect()
    }

    fn work(&self, region: &Region) -> FieldWork {
        let rows = region.rows() as u64;
        FieldWork { evaluations: rows, ops: 30 * rows }
    }

    fn field(
        &self,
        region: &Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
    ) -> Result<(), EvalError> {
        self.evaluators[0].eval_region(region, [x, y, z], &mut [field])
    }

    fn gradient(
        &self,
        region: &Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        [gx, gy, gz]: [&mut [f32]; 3],
    ) -> Result<(), EvalError> {
        self.evaluators[1].eval_region(region, [x, y, z], &mut [field, gx, gy, gz])
    }

    fn all(
        &self,
        region: &Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        [gx, gy, gz]: [&mut [f32]; 3],
        attributes: &mut [&mut [f32]],
    ) -> Result<(), EvalError> {
        let mut planes: Vec<&mut [f32]> = vec![field, gx, gy, gz];
        planes.extend(attributes.iter_mut().map(|plane| &mut **plane));
        self.evaluators[2].eval_region(region, [x, y, z], &mut planes)
    }
}
