//! What a kernel may touch: planes, tables, its own stack and code. Between two regions there is nothing, and
//! whoever reads or writes there faults.

use crate::abi::TableView;
use crate::blob::CodeBlob;

/// What an instruction may say instead of a result.
pub(super) type Simulated<T = ()> = Result<T, String>;

/// Where the code is.
pub(super) const CODE: u64 = 0x10_0000;
/// Where the code returns to.
pub(super) const CALLER: u64 = 0xCA11_E400;

/// The function's arguments: see [`crate::entry`].
pub(super) struct Call<'a> {
    pub(super) inputs: &'a [Vec<f32>],
    pub(super) outputs: usize,
    /// Of each table: numbers, active rows, starts.
    pub(super) tables: &'a [(&'a [f32], &'a [u32], &'a [u32])],
}

/// A stretch of addresses.
struct AddressRegion {
    first: u64,
    bytes: Vec<u8>,
    is_writable: bool,
}

/// Regions in the order of their addresses.
pub(super) struct SimulatedMemory {
    regions: Vec<AddressRegion>,
}

/// Where a run's arguments are.
pub(super) struct ArgumentLayout {
    pub(super) planes: u64,
    pub(super) views: u64,
    /// The stack pointer of the call.
    pub(super) stack: u64,
    outputs: Vec<u64>,
}

/// Bytes between two regions, at least.
const GAP: u64 = 4096;
/// Registers that a function saves, and the address that it returns to.
const SAVED_BYTES: usize = 7 * 8;
/// A page: a large frame is touched page by page, and the last one may end below it.
const PAGE: usize = 4096;
/// What nobody has written yet.
const POISON: u8 = 0xAD;

fn bytes_of<T: Copy, const N: usize>(items: &[T], to_bytes: impl Fn(T) -> [u8; N]) -> Vec<u8> {
    items.iter().flat_map(|&item| to_bytes(item)).collect()
}

impl SimulatedMemory {
    /// Lays out what a call of a function gets.
    pub(super) fn new(blob: &CodeBlob, call: &Call<'_>) -> (Self, ArgumentLayout) {
        let code = AddressRegion { first: CODE, bytes: blob.bytes.clone(), is_writable: false };
        let mut memory = Self { regions: vec![code] };
        let numbers = |plane: &[f32]| bytes_of(plane, f32::to_le_bytes);
        let words = |list: &[u32]| bytes_of(list, u32::to_le_bytes);
        let pointers = |list: &[u64]| bytes_of(list, u64::to_le_bytes);
        let mut planes: Vec<u64> =
            call.inputs.iter().map(|plane| memory.add(numbers(plane), false)).collect();
        let length = call.inputs.first().map_or(0, Vec::len) * size_of::<f32>();
        let outputs: Vec<u64> = (0..call.outputs).map(|_| memory.add(vec![POISON; length], true)).collect();
        planes.extend(&outputs);
        let mut views = Vec::new();
        for &(table, active, starts) in call.tables {
            let mut view = [0; size_of::<TableView>() / 8];
            view[TableView::NUMBERS / 8] = memory.add(numbers(table), false);
            view[TableView::ACTIVE / 8] = memory.add(words(active), false);
            view[TableView::STARTS / 8] = memory.add(words(starts), false);
            views.extend(view);
        }
        let planes = memory.add(pointers(&planes), false);
        let views = memory.add(pointers(&views), false);
        let below = if blob.frame_bytes > PAGE { PAGE } else { 0 };
        let size = (below + blob.frame_bytes + SAVED_BYTES).next_multiple_of(16);
        let first = memory.add(vec![POISON; size], true);
        // A call finds the stack at 8 bytes from a multiple of 16.
        let stack = first + size as u64 - 8;
        memory.write(stack, &CALLER.to_le_bytes()).expect("the stack has room for an address");
        (memory, ArgumentLayout { planes, views, stack, outputs })
    }

    /// A new region behind all others. It begins at an odd multiple of 4 where it may, as planes do that
    /// nobody has aligned.
    fn add(&mut self, bytes: Vec<u8>, is_writable: bool) -> u64 {
        let last = self.regions.last().map_or(0, |last| last.first + last.bytes.len() as u64);
        let offset = if bytes.len().is_multiple_of(16) { 0 } else { 4 };
        let first = (last + GAP).next_multiple_of(64) + offset;
        self.regions.push(AddressRegion { first, bytes, is_writable });
        first
    }

    /// The region around an access, and where in it that begins.
    fn find(&self, address: u64, length: usize) -> Simulated<(usize, usize)> {
        let nowhere = || format!("there are no {length} bytes at {address:x}");
        let behind = self.regions.partition_point(|region| region.first <= address);
        let index = behind.checked_sub(1).ok_or_else(nowhere)?;
        let offset = (address - self.regions[index].first) as usize;
        let fits = offset.checked_add(length).is_some_and(|end| end <= self.regions[index].bytes.len());
        if fits { Ok((index, offset)) } else { Err(nowhere()) }
    }

    pub(super) fn read(&self, address: u64, length: usize) -> Simulated<&[u8]> {
        let (index, offset) = self.find(address, length)?;
        Ok(&self.regions[index].bytes[offset..offset + length])
    }

    pub(super) fn read_word(&self, address: u64) -> Simulated<u32> {
        let bytes = self.read(address, 4)?;
        Ok(u32::from_le_bytes(bytes.try_into().expect("four bytes were read")))
    }

    pub(super) fn read_pointer(&self, address: u64) -> Simulated<u64> {
        let bytes = self.read(address, 8)?;
        Ok(u64::from_le_bytes(bytes.try_into().expect("eight bytes were read")))
    }

    pub(super) fn write(&mut self, address: u64, bytes: &[u8]) -> Simulated {
        let (index, offset) = self.find(address, bytes.len())?;
        let region = &mut self.regions[index];
        if !region.is_writable {
            return Err(format!("nobody may write at {address:x}"));
        }
        region.bytes[offset..offset + bytes.len()].copy_from_slice(bytes);
        Ok(())
    }

    /// The output planes.
    pub(super) fn outputs(&self, layout: &ArgumentLayout) -> Vec<Vec<f32>> {
        let plane = |&first: &u64| {
            let index = self.regions.partition_point(|region| region.first < first);
            let words = self.regions[index].bytes.chunks_exact(4);
            words.map(|word| f32::from_le_bytes(word.try_into().expect("a chunk has four bytes"))).collect()
        };
        layout.outputs.iter().map(plane).collect()
    }
}
