//! Spans: what a thread does, from here to the end of a block, for timelines.
//!
//! With the feature `trace` they are spans of the crate `tracing`, which any of its subscribers may record.
//! Nobody listens as a rule: a span is then one load, and stands around thousands of points at least.

/// Names what the thread does up to the end of the block: `span!("sample");`.
#[cfg(feature = "trace")]
macro_rules! span {
    ($name:literal) => {
        let _span = tracing::info_span!($name).entered();
    };
}

#[cfg(not(feature = "trace"))]
macro_rules! span {
    ($name:literal) => {};
}

pub(crate) use span;
