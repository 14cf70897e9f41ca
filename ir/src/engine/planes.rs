//! The one check of planes: how many there are, and how long.

/// Why a program does not run on what it is given. Nothing is written then.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum RunError {
    /// The selection was made from tables with other numbers of rows.
    #[error("the selection was made for tables with other numbers of rows")]
    Selection,
    /// Another number of input planes.
    #[error("the function has {expected} input planes, {given} were given")]
    Inputs {
        /// Planes of the function.
        expected: usize,
        /// Planes of this run.
        given: usize,
    },
    /// Another number of output planes.
    #[error("the function has {expected} output planes, {given} were given")]
    Outputs {
        /// Planes of the function.
        expected: usize,
        /// Planes of this run.
        given: usize,
    },
    /// Planes of different lengths.
    #[error("the first plane has {expected} points, plane {plane} (inputs first) has {given}")]
    Length {
        /// The first plane that differs, inputs first, from 0.
        plane: usize,
        /// The length of the first input plane; of the first output plane, where there are no inputs.
        expected: usize,
        /// The length of the plane that differs.
        given: usize,
    },
}

/// The common length of planes, of which there are to be so many: inputs, outputs. Without planes it is 0.
pub(crate) fn check(
    counts: (usize, usize),
    inputs: &[&[f32]],
    outputs: &[&mut [f32]],
) -> Result<usize, RunError> {
    if inputs.len() != counts.0 {
        return Err(RunError::Inputs { expected: counts.0, given: inputs.len() });
    }
    if outputs.len() != counts.1 {
        return Err(RunError::Outputs { expected: counts.1, given: outputs.len() });
    }
    let lengths = inputs.iter().map(|plane| plane.len()).chain(outputs.iter().map(|plane| plane.len()));
    let mut lengths = lengths.enumerate();
    let (_, expected) = lengths.next().unwrap_or_default();
    match lengths.find(|&(_, given)| given != expected) {
        Some((plane, given)) => Err(RunError::Length { plane, expected, given }),
        None => Ok(expected),
    }
}
