//! `Debug` of what holds code and tables: a few of its values, and not megabytes of them.

/// Implements `Debug` for a type: what it is called, and what is worth showing.
macro_rules! brief_debug {
    ($type:ty, $name:literal, $this:ident: $($field:ident = $value:expr),+ $(,)?) => {
        impl std::fmt::Debug for $type {
            /// A few values, without code and tables.
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                let $this = self;
                f.debug_struct($name)$(.field(stringify!($field), &$value))+.finish_non_exhaustive()
            }
        }
    };
}

pub(crate) use brief_debug;
