//! Where a value is while the tape runs.

/// The number of a register, or the number of a splat with the top bit set.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct ScratchPlace(u32);

impl ScratchPlace {
    const SPLAT: u32 = 1 << 31;

    pub fn block(register: usize) -> Self {
        Self(narrow(register))
    }

    pub fn splat(slot: usize) -> Self {
        Self(narrow(slot) | Self::SPLAT)
    }

    /// Whether this is a splat.
    #[inline(always)]
    pub const fn is_splat(self) -> bool {
        self.0 & Self::SPLAT != 0
    }

    /// The number of the register or of the splat.
    #[inline(always)]
    pub const fn index(self) -> usize {
        (self.0 & !Self::SPLAT) as usize
    }
}

fn narrow(index: usize) -> u32 {
    u32::try_from(index)
        .ok()
        .filter(|index| index & ScratchPlace::SPLAT == 0)
        .expect("limits::MAX_VALUES is far below 2^31")
}
