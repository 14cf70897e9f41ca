//! The mesher on fields whose surfaces are known, and on noise.

mod apart;
mod bricks;
mod fields;
mod models;
mod normals;
mod shape;
mod topology;
mod walls;
