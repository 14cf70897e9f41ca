//! Work on as many threads as the command line says.

use crate::failure::Failure;

/// Runs the work on so many threads; on one for each processor if no number is given.
pub fn in_pool<T: Send>(threads: Option<u16>, work: &mut (impl FnMut() -> T + Send)) -> Result<T, Failure> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(threads))
        .build()
        .map_err(|error| Failure::Limit(format!("{threads} threads cannot be had: {error}")))?;
    Ok(pool.install(work))
}
