//! The scalar reference as an engine: one point after the other, in the simplest way.

use std::sync::Arc;

use crate::domain::scalar::Scalar;
use crate::environment::Standard;
use crate::interpret;
use crate::level::Level;
use crate::verify::Verified;

use super::backend::{Backend, Declined, Form};
use super::program::{Interface, Planes, Program, Run};

/// The reference: it defines what every engine gives.
#[derive(Clone, Copy, Debug)]
pub struct Reference;

impl Backend for Reference {
    fn name(&self) -> &'static str {
        "scalar"
    }

    fn covers(&self, _: Level) -> bool {
        true
    }

    fn supports(&self, level: Level) -> Result<(), Declined> {
        Ok(level.require()?)
    }

    fn compile(&self, function: &Arc<Verified>, level: Level) -> Result<Arc<dyn Program>, Declined> {
        self.supports(level)?;
        let interface = Arc::new(Interface::new(function.function()));
        Ok(Arc::new(ScalarProgram { function: Arc::clone(function), interface }))
    }

    fn forms(&self) -> &'static [Form] {
        &[]
    }
}

/// A function as it is.
#[derive(Debug)]
struct ScalarProgram {
    function: Arc<Verified>,
    interface: Arc<Interface>,
}

impl Program for ScalarProgram {
    fn interface(&self) -> &Arc<Interface> {
        &self.interface
    }

    fn block(&self) -> usize {
        1
    }

    fn run(&self, run: Run<'_, '_>) {
        let Planes { points, tables, selection, inputs, outputs } = run.planes(&self.interface);
        let _environment = Standard::enter();
        for point in 0..points {
            let at: Vec<f32> = inputs.iter().map(|plane| plane[point]).collect();
            let answers = interpret::run_selected(&self.function, tables, selection, &mut Scalar, &at);
            for (plane, answer) in outputs.iter_mut().zip(answers) {
                plane[point] = answer;
            }
        }
    }
}
