//! Threads, as this crate knows them: somebody who does tasks that do not depend on each other.

use std::sync::Mutex;

/// Does tasks, on as many threads as it likes. This crate starts none.
pub trait Workers: Sync {
    /// Calls `task` once for each number below `count`, in any order, and returns when all are done.
    fn each(&self, count: usize, task: &(dyn Fn(usize) + Sync));
}

/// The caller does everything, in order.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Workers for Serial {
    fn each(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        (0..count).for_each(task);
    }
}

/// Parts of a slice that are made at once: `make` is given the number of the first element of a part, and the
/// part. What it returns comes back in the order of parts, which do not depend on the workers.
pub(super) fn in_parts<T: Send, R: Send>(
    workers: &dyn Workers,
    all: &mut [T],
    part: usize,
    make: impl Fn(usize, &mut [T]) -> R + Sync,
) -> Vec<R> {
    let parts: Vec<Mutex<(&mut [T], Option<R>)>> =
        all.chunks_mut(part).map(|part| Mutex::new((part, None))).collect();
    workers.each(parts.len(), &|index| {
        // Nobody else has this part, so nobody can have panicked with it.
        let mut place = parts[index].lock().expect("a part is made once");
        let (elements, made) = &mut *place;
        *made = Some(make(index * part, elements));
    });
    let made = |part: Mutex<(&mut [T], Option<R>)>| part.into_inner().expect("a part is made once").1;
    parts.into_iter().map(|part| made(part).expect("workers do all tasks")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_made_once_and_come_in_order() {
        let mut numbers = vec![0; 10];
        let firsts = in_parts(&Serial, &mut numbers, 4, |first, part| {
            part.iter_mut().enumerate().for_each(|(index, number)| *number += first + index);
            first
        });
        assert_eq!((numbers, firsts), ((0..10).collect(), vec![0, 4, 8]));
    }
}
