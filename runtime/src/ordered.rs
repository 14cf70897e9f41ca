//! Entries of queues, which are compared by how urgent they are.

/// Lets types that have an `Ord` be compared by its `cmp` alone.
macro_rules! ordered {
    ($($name:ident)+) => { $(
        impl PartialOrd for $name {
            fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
                Some(self.cmp(other))
            }
        }

        impl PartialEq for $name {
            fn eq(&self, other: &Self) -> bool {
                self.cmp(other) == std::cmp::Ordering::Equal
            }
        }

        impl Eq for $name {}
    )+ };
}

pub(crate) use ordered;
