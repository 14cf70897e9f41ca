//! Values of numbers: those of parameters.

use std::collections::HashMap;
use std::sync::Arc;

/// The values of parameters, by name.
pub(crate) type ParameterValues = HashMap<Arc<str>, f64>;
