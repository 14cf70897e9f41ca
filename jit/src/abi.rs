//! What machine code is given: see [`crate::entry`].

use std::mem::offset_of;

/// Where the rows of one table are.
#[repr(C)]
#[derive(Clone, Copy)]
pub(crate) struct TableView {
    pub(crate) numbers: *const f32,
    pub(crate) active: *const u32,
    pub(crate) starts: *const u32,
}

impl TableView {
    /// What is there before a view is written.
    pub(crate) const NOWHERE: Self =
        Self { numbers: std::ptr::null(), active: std::ptr::null(), starts: std::ptr::null() };
    /// The offset of the pointer to the numbers.
    pub(crate) const NUMBERS: usize = offset_of!(Self, numbers);
    /// The offset of the pointer to the active rows.
    pub(crate) const ACTIVE: usize = offset_of!(Self, active);
    /// The offset of the pointer to the starts.
    pub(crate) const STARTS: usize = offset_of!(Self, starts);
}

/// Everything that one call of a kernel is given. Made by [`crate::Kernel`] alone, from what its
/// door has checked.
pub(crate) struct KernelArguments<'a> {
    /// Input planes, then output planes. They are moved on to their ends.
    pub(crate) planes: &'a mut [*const f32],
    /// Bytes of each plane.
    pub(crate) bytes: usize,
    /// One view for each table.
    pub(crate) tables: &'a [TableView],
}
