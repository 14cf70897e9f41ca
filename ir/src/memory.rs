//! Memory that may not be there: whoever needs much of it asks first, and answers with an error.
//!
//! Rust ends the process when memory cannot be had. So sizes that follow an input are asked for in ways that
//! may fail: [`room`] for a vector, [`probe`] for what will be asked for in many pieces. Where errors have no
//! way, [`take`](super::watch::take) stops the work, as a watch does.
//!
//! What is there now may be gone when it is used: others take memory too. So nothing is promised, and yet
//! most of what is too large is told at once.

use std::hint::black_box;

use thiserror::Error;

/// The memory for so many bytes is not to be had.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Error)]
#[error("there is no memory for {bytes} bytes")]
pub struct NoMemory {
    /// How many were asked for at once.
    pub bytes: usize,
}

/// What else is needed meanwhile, in bytes: small parts that nobody counts.
const SLACK: usize = 4 << 20;

/// An empty vector with room for this many values.
///
/// # Errors
/// The memory is not to be had.
pub fn room<T>(length: usize) -> Result<Vec<T>, NoMemory> {
    let bytes = length.saturating_mul(size_of::<T>());
    let mut values = Vec::new();
    values.try_reserve_exact(length).map_err(|_| NoMemory { bytes })?;
    Ok(values)
}

/// Whether so many bytes, and some more, are there: they are asked for at once and given back.
///
/// # Errors
/// They are not.
pub fn probe(bytes: usize) -> Result<(), NoMemory> {
    let asked = bytes.saturating_add(SLACK);
    // Memory that nobody uses would never be asked for.
    black_box(room::<u8>(asked).map_err(|_| NoMemory { bytes })?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg_attr(miri, ignore = "there an allocation that fails ends the run")]
    fn what_is_too_large_is_an_error() {
        const HUGE: usize = isize::MAX as usize;
        assert_eq!(room::<u8>(HUGE).map(drop), Err(NoMemory { bytes: HUGE }));
        assert_eq!(room::<u64>(usize::MAX).map(drop), Err(NoMemory { bytes: usize::MAX }));
        assert_eq!(probe(HUGE), Err(NoMemory { bytes: HUGE }));
        assert_eq!(probe(usize::MAX), Err(NoMemory { bytes: usize::MAX }));
        assert!(probe(0).is_ok());
        assert!(room::<u64>(10).is_ok_and(|values| values.capacity() >= 10));
    }
}
