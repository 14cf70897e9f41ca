//! Morton order (Morton 1966): places that are near each other have numbers that are near each other, mostly.

/// The number of a place in Morton order: the bits of x, y and z interleaved, x lowest. Of 21 bits each.
pub(crate) fn morton(place: [u32; 3]) -> u64 {
    let spread = |index: u32| {
        let mut bits = u64::from(index);
        for (shift, mask) in [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    spread(place[0]) | spread(place[1]) << 1 | spread(place[2]) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_interleaved() {
        assert_eq!(morton([0b111, 0, 0]), 0b100_1001);
        assert_eq!(morton([0, 0b10, 1]), 0b01_0100);
        let most = (1 << 21) - 1;
        assert_eq!(morton([most; 3]), (1 << 63) - 1);
        assert_eq!(morton([1 << 20, 0, 0]), 1 << 60);
    }
}
