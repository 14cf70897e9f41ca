//! `jbt._jbt`: the native part of the Python package `jbt`, which says in Python what users see.
//!
//! ```text
//! jbt/*.py     names, types, documentation; arguments become arrays and numbers         what users see
//! jbt._jbt     models, evaluators, long work; arrays are borrowed or given away      this crate
//! jbt (Rust)   everything else
//! ```
//!
//! Nothing here has a name that users call, but for classes that have no Python part (numbers and
//! formulas). Errors of jbt become exceptions in one place (`error.rs`), long work and threads have
//! one door (`work.rs`). Whatever takes time runs without the interpreter's lock.

mod build;
mod cloud;
mod columns;
mod constant;
mod contour;
mod error;
mod evaluator;
mod falloff;
mod fields;
mod members;
mod merge;
mod mesh;
mod model;
mod number;
mod picture;
mod rays;
mod remote;
mod sample;
mod solid;
mod term;
mod work;

/// The native part of `jbt`.
#[pyo3::pymodule]
mod _jbt {
    #[pymodule_export]
    use crate::cloud::points;
    #[pymodule_export]
    use crate::evaluator::PyEvaluator;
    #[pymodule_export]
    use crate::falloff::{PyFalloff, PyPattern};
    #[pymodule_export]
    use crate::members::{engines, functions, members, mesh_formats, scene_formats, views};
    #[pymodule_export]
    use crate::mesh::save_mesh;
    #[pymodule_export]
    use crate::model::PyModel;
    #[pymodule_export]
    use crate::number::PyNumber;
    #[pymodule_export]
    use crate::picture::encode_png;
    #[pymodule_export]
    use crate::remote::{PyLattice, PyRowSource, PyShape, block_facts, cpu_level, join};
    #[pymodule_export]
    use crate::term::{PyTerm, call, coordinate, falloff_of};
    #[pymodule_export]
    use crate::work::{compile_counters, thread_count};

    /// The version of the package.
    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
