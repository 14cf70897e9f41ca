//! The mesher on fields whose surfaces are known, and on noise.

mod fields;
mod shape;
mod topology;
