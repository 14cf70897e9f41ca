//! Finished machine code as bytes: what an emitter of our own gives.

/// A function of [`crate::entry`]'s ABI, with its constants, that runs at any address which is a multiple of
/// 64.
#[derive(Clone, Debug)]
pub(crate) struct CodeBlob {
    pub(crate) bytes: Vec<u8>,
    /// Bytes of `bytes` that are instructions, at its start.
    #[cfg_attr(not(any(feature = "listing", test)), expect(dead_code, reason = "for listings"))]
    pub(crate) code_bytes: usize,
    /// Bytes of `bytes` that are constants, at its end.
    #[cfg_attr(not(any(feature = "listing", test)), expect(dead_code, reason = "for listings"))]
    pub(crate) constants: usize,
    /// Bytes of the frame.
    pub(crate) frame_bytes: usize,
    /// Points in a block.
    pub(crate) lanes: usize,
}

/// The functions that a kernel consists of.
#[derive(Clone, Debug)]
pub(crate) struct Emitted {
    /// For whole blocks of points, as large as suits the function.
    pub(crate) blocks: CodeBlob,
    /// For the points that are left, in blocks of one vector.
    pub(crate) rest: Option<CodeBlob>,
}
