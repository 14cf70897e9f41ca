//! The mesher on fields whose surfaces are known, and on noise.

mod bricks;
mod fields;
mod shape;
mod topology;
