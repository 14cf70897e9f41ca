//! Numbers in binary files: their types, and arrays of them.

use jbt_model::particles::NumberArray;

/// The type of a number in a file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum NumberType {
    F32,
    F64,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
}

impl NumberType {
    /// How many bytes it takes.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::F32 | Self::I32 | Self::U32 => 4,
            Self::F64 | Self::I64 | Self::U64 => 8,
        }
    }

    /// A number of as many bytes.
    pub(super) fn read(self, bytes: &[u8], big_endian: bool) -> f64 {
        macro_rules! number {
            ($type:ty) => {{
                let bytes = bytes.try_into().expect("as many bytes as the type has");
                if big_endian { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) }
            }};
        }
        match self {
            Self::F32 => f64::from(number!(f32)),
            Self::F64 => number!(f64),
            Self::I8 => f64::from(number!(i8)),
            Self::U8 => f64::from(number!(u8)),
            Self::I16 => f64::from(number!(i16)),
            Self::U16 => f64::from(number!(u16)),
            Self::I32 => f64::from(number!(i32)),
            Self::U32 => f64::from(number!(u32)),
            // Beyond 2^53 they are rounded.
            Self::I64 => number!(i64) as f64,
            Self::U64 => number!(u64) as f64,
        }
    }

    /// The numbers that bytes are. Panics if the last one is cut off.
    pub(super) fn array(self, bytes: &[u8], big_endian: bool) -> NumberArray {
        let chunks = bytes.chunks_exact(self.size());
        assert!(chunks.remainder().is_empty(), "whoever reads has counted");
        match self {
            Self::F32 if big_endian => {
                chunks.map(|it| f32::from_be_bytes(it.try_into().expect("four"))).collect::<Vec<f32>>().into()
            }
            Self::F32 => {
                chunks.map(|it| f32::from_le_bytes(it.try_into().expect("four"))).collect::<Vec<f32>>().into()
            }
            _ => chunks.map(|it| self.read(it, big_endian)).collect::<Vec<f64>>().into(),
        }
    }
}
