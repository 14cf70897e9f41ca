//! splashsurf (Löschner and others), which reconstructs the surface of particle fluids by marching cubes.
//!
//! It computes another function: a density by smoothed-particle hydrodynamics, with the cubic spline kernel
//! and a volume for each particle that it finds from the neighbours first. So surfaces differ, and only the
//! amount of work can be compared. It is alike where
//!
//! * there are as many particles as blobs, at the same places;
//! * the kernel reaches as far as a blob of the mean volume: the cubic mean of the radii, since particles
//!   have one radius. Then as many pairs of particles and samples meet;
//! * a cell of its lattice is one of ours.
//!
//! The radius of a particle is a quarter of the kernel's reach (a smoothing length of 2 radii); it cancels
//! out of the density, which is relative to the particle's own volume, and only sets margins. The iso-value
//! is its default, 0.6. Positions and triangles are made, neither normals nor attributes.

use splashsurf_lib::nalgebra::Vector3;
use splashsurf_lib::{GridDecompositionParameters, Parameters, SpatialDecomposition, reconstruct_surface};

use super::{MeshSize, Threads};
use crate::model::Blob;

/// Reach of the kernel in radii of a particle.
pub const REACH_IN_RADII: f32 = 4.0;

/// Whether the lattice is divided.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Division {
    /// One sparse lattice.
    None,
    /// Dense lattices of 64^3 cells, the library's default.
    Subdomains,
}

/// Particles, and how to mesh them.
pub struct Particles {
    positions: Vec<Vector3<f32>>,
    parameters: Parameters<f32>,
    pool: rayon::ThreadPool,
}

/// It did not work, in splashsurf's words.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[error("splashsurf: {0}")]
pub struct SplashsurfError(String);

impl Particles {
    /// Particles in place of blobs, to be meshed with cells of side `cell`: for the lattice of 129^3 points
    /// in the cube [-1, 1]^3, 1/64. Makes the threads, too.
    ///
    /// # Errors
    /// Threads could not be made.
    pub fn new(
        blobs: &[Blob],
        cell: f32,
        division: Division,
        threads: Threads,
    ) -> Result<Self, SplashsurfError> {
        let reach = cubic_mean(blobs.iter().map(|blob| blob.radius));
        let mut parameters = Parameters::new(reach / REACH_IN_RADII, reach, cell);
        parameters.enable_multi_threading = threads == Threads::All;
        parameters.spatial_decomposition = match division {
            Division::None => SpatialDecomposition::None,
            Division::Subdomains => SpatialDecomposition::UniformGrid(GridDecompositionParameters {
                auto_disable: false,
                ..GridDecompositionParameters::default()
            }),
        };
        // Parts of the library use all threads of the pool they run in, whatever its parameters say.
        let count = match threads {
            Threads::One => 1,
            Threads::All => rayon::current_num_threads(),
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
        let pool = pool.map_err(|error| SplashsurfError(error.to_string()))?;
        let positions = blobs.iter().map(|blob| Vector3::from(blob.center)).collect();
        Ok(Self { positions, parameters, pool })
    }

    /// The mesh.
    ///
    /// # Errors
    /// What the library says.
    pub fn mesh(&self) -> Result<MeshSize, SplashsurfError> {
        let made = self.pool.install(|| reconstruct_surface::<i64, f32>(&self.positions, &self.parameters));
        let mesh = made.map_err(|error| SplashsurfError(error.to_string()))?.mesh;
        Ok(MeshSize { triangles: mesh.triangles.len(), vertices: mesh.vertices.len() })
    }
}

/// The radius of a ball of the mean volume.
fn cubic_mean(radii: impl ExactSizeIterator<Item = f32>) -> f32 {
    let count = radii.len().max(1) as f64;
    (radii.map(|radius| f64::from(radius).powi(3)).sum::<f64>() / count).cbrt() as f32
}
