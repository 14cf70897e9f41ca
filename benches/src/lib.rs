//! How fast, compared with what: models, the checks that answers have to pass before anything is timed, and what we compare with.

pub mod check;
pub mod limit;
pub mod model;
