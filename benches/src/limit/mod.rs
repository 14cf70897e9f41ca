//! The physical limit: the fastest programs that we can think of for one kind of model, a plain sum of
//! coloured soft-object points, written by hand for the registers of the CPU. What the compiler makes of any
//! model is reported against them.
//!
//! ```
//! use jbt_benches::limit::Blobs;
//! use jbt_benches::model::blobs;
//!
//! let blobs = Blobs::new(&blobs(200, 1));
//! let (x, y, z) = (vec![0.1; 100], vec![0.2; 100], vec![0.3; 100]);
//! let mut field = vec![0.0; 100];
//! blobs.field([&x, &y, &z], &mut field);
//! ```
//!
//! [`Blobs`] evaluates without culling, with AVX-512, AVX2 or neither, whichever the CPU has when the program
//! runs. The three answers of one field differ by rounding only. Different CPUs may give different last bits.
//! [`mesh::mesh`] meshes with culling.

mod dense;
pub mod mesh;
#[cfg(test)]
mod tests;
mod vector;

use crate::model::Blob;

use dense::{Answers, Dense, Field, Full, Gradient, Row};

/// A sum of blobs, prepared for evaluation at any points.
///
/// All slices of a call have one length, which is free; anything else panics.
#[derive(Clone, Debug)]
pub struct Blobs {
    rows: Vec<Row>,
}

/// The name of the instruction set that runs here: `avx512`, `avx2` or `plain`.
#[must_use]
pub fn level() -> &'static str {
    vector::level()
}

impl Blobs {
    /// Prepares blobs. Radii are greater than zero.
    #[must_use]
    pub fn new(blobs: &[Blob]) -> Self {
        Self { rows: blobs.iter().map(Row::new).collect() }
    }

    /// The field at points that are given by their x, y and z.
    pub fn field(&self, points: [&[f32]; 3], field: &mut [f32]) {
        self.answer(points, [field], Field);
    }

    /// The field, and its derivatives along x, y and z.
    pub fn gradient(&self, points: [&[f32]; 3], answers: [&mut [f32]; 4]) {
        self.answer(points, answers, Gradient);
    }

    /// The field, its derivatives along x, y and z, and red, green and blue: the mean of the blobs' colours
    /// weighted by their fields, white where all of them are zero.
    pub fn full(&self, points: [&[f32]; 3], answers: [&mut [f32]; 7]) {
        self.answer(points, answers, Full);
    }

    fn answer<A: Answers<N>, const N: usize>(&self, points: [&[f32]; 3], answers: [&mut [f32]; N], which: A) {
        let lengths = points.iter().map(|plane| plane.len()).chain(answers.iter().map(|plane| plane.len()));
        assert!(
            lengths.into_iter().all(|length| length == points[0].len()),
            "slices of one call have one length"
        );
        vector::dispatch(Dense { rows: &self.rows, points, answers, which });
    }
}
