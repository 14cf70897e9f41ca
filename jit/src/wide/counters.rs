//! The integers of a kernel: counters and addresses of loops over strips, points and rows.
//!
//! ```text
//! rdi  planes      rsi  bytes of a plane, or the end of the strip      rcx  the block of points, in bytes
//! rdx  tables      rsp  the frame                                      rax  for the next instruction
//! r13 r14 r15      the block in the first three input planes           r8   the block in the slots
//! r9  r10 r11      of every other fold: the cursor, its end, the current row
//! rbp r12 rbx      of the folds between these; those of folds further outside are in the frame
//! ```

use jbt_ir::Entity;

use super::inst::{Base, Condition, Gpr, Inst, Integer, Label, Memory};
use super::linear::{LoopId, NONE, Over, POINTERS};
use super::state::{ALL_BYTES, OpenLoop, SAVED, STRIP_START, WalkState};
use crate::abi::TableView;

/// Bytes of the frame for the registers of one fold.
pub(super) const SAVED_BYTES: usize = 24;

/// The registers of a fold: cursor, end, row.
const BANKS: [[Gpr; 3]; 2] = [[Gpr::R9, Gpr::R10, Gpr::R11], [Gpr::Rbp, Gpr::R12, Gpr::Rbx]];

/// The registers of input planes.
const INPUTS: [Gpr; POINTERS] = [Gpr::R13, Gpr::R14, Gpr::R15];

impl WalkState<'_> {
    /// Computes the first address or counter of a loop.
    pub(super) fn find(&mut self, id: LoopId) {
        match self.linear.loops[id as usize].over {
            Over::Strips => {}
            Over::Points => self.find_points(id),
            Over::RowsOfStrip(table) | Over::Rows(table) | Over::Guard(table) => {
                self.find_rows(table.index());
            }
        }
    }

    /// Begins a loop, once registers hold the values of its top.
    pub(super) fn begin(&mut self, id: LoopId, top: Label) {
        match self.linear.loops[id as usize].over {
            Over::Strips => self.begin_strips(top),
            Over::Points => self.integer(Inst::Here(top)),
            Over::RowsOfStrip(table) | Over::Rows(table) | Over::Guard(table) => {
                self.begin_rows(table.index());
            }
        }
    }

    /// Continues with the next iteration of a loop, or leaves it.
    pub(super) fn end(&mut self, id: LoopId, open: &OpenLoop) {
        match self.linear.loops[id as usize].over {
            Over::Strips => self.end_strips(open),
            Over::Points => self.end_points(id, open),
            Over::RowsOfStrip(table) | Over::Rows(table) | Over::Guard(table) => {
                self.end_rows(table.index(), open);
            }
        }
    }

    /// Where the frame holds the registers of the fold at a depth.
    fn saved(depth: usize, which: usize) -> Memory {
        let displacement = SAVED as usize + SAVED_BYTES * depth + 8 * which;
        Memory::at(Gpr::Rsp, i32::try_from(displacement).expect("limits::MAX_FOLD_DEPTH is small"))
    }

    /// The register with the address of the current row of a table.
    pub(super) fn row(&mut self, table: usize) -> Gpr {
        let depth = self.rows[table].expect("a verified function names a row inside the fold over its table");
        if depth + 2 >= self.depth {
            return BANKS[depth % 2][2];
        }
        self.integer(Integer::LoadPointer { to: Gpr::Rax, from: Self::saved(depth, 2) });
        Gpr::Rax
    }

    /// The current block of points in an input plane, at a displacement in bytes.
    pub(super) fn input(&mut self, plane: usize, displacement: i32) -> Memory {
        if let Some(&register) = INPUTS.get(plane) {
            return Memory::at(register, displacement);
        }
        self.integer(Integer::LoadPointer { to: Gpr::Rax, from: plane_pointer(plane) });
        Memory { base: Base::Sum(Gpr::Rax, Gpr::Rcx, 1), displacement, is_one: false }
    }

    /// Finds the rows of a table that the current row of its parent owns.
    fn find_rows(&mut self, table: usize) {
        let view = |table: usize, field: usize| {
            let at = i32::try_from(table * size_of::<TableView>() + field);
            Memory::at(Gpr::Rdx, at.expect("limits::MAX_TABLES keeps every view within 2^31 bytes"))
        };
        let depth = self.depth;
        if depth >= 2 {
            for (which, from) in BANKS[depth % 2].into_iter().enumerate() {
                self.integer(Integer::StorePointer { to: Self::saved(depth - 2, which), from });
            }
        }
        let [cursor, end, _] = BANKS[depth % 2];
        self.integer(Integer::LoadPointer { to: cursor, from: view(table, TableView::ACTIVE) });
        self.integer(Integer::LoadPointer { to: Gpr::Rax, from: view(table, TableView::STARTS) });
        if let Some(parent) = self.parents[table] {
            // A start and an active row have the same size, so the byte offsets are equal.
            let above = self.rows[parent].expect("a verified fold stands inside that of its parent");
            let parent_cursor = BANKS[above % 2][0];
            self.integer(if above + 1 == depth {
                Integer::AddRegister { to: Gpr::Rax, from: parent_cursor }
            } else {
                Integer::AddPointer { to: Gpr::Rax, from: Self::saved(above, 0) }
            });
            self.integer(Integer::SubPointer { to: Gpr::Rax, from: view(parent, TableView::ACTIVE) });
        }
        let word = |base, displacement| Memory::at(base, displacement);
        let rows = |first, count| Memory { base: Base::Sum(first, count, 4), displacement: 0, is_one: false };
        self.integer(Integer::LoadWord { to: end, from: word(Gpr::Rax, 4) });
        self.integer(Integer::Address { to: end, of: rows(cursor, end) });
        self.integer(Integer::LoadWord { to: Gpr::Rax, from: word(Gpr::Rax, 0) });
        self.integer(Integer::Address { to: cursor, of: rows(cursor, Gpr::Rax) });
        self.rows[table] = Some(depth);
        self.depth += 1;
    }

    /// Opens a loop over rows, once registers hold the values of its top.
    fn begin_rows(&mut self, table: usize) {
        let [cursor, end, row] = BANKS[(self.depth - 1) % 2];
        let Some(&OpenLoop { top, exit, .. }) = self.open.last() else { return };
        self.integer(Integer::Compare64 { a: cursor, b: end });
        self.integer(Inst::Jump { condition: Condition::Equal, to: exit });
        self.integer(Inst::Here(top));
        self.integer(Integer::LoadWord { to: row, from: Memory::at(cursor, 0) });
        let number = i32::try_from(self.strides[table]).expect("a row has fewer bytes");
        self.integer(Integer::Multiply { to: row, number });
        let numbers = i32::try_from(table * size_of::<TableView>() + TableView::NUMBERS);
        let numbers = numbers.expect("limits::MAX_TABLES keeps every view within 2^31 bytes");
        self.integer(Integer::AddPointer { to: row, from: Memory::at(Gpr::Rdx, numbers) });
    }

    /// Ends a loop over rows.
    fn end_rows(&mut self, table: usize, open: &OpenLoop) {
        let depth = self.depth - 1;
        let [cursor, end, _] = BANKS[depth % 2];
        self.integer(Integer::AddConstant { to: cursor, number: size_of::<u32>() as i32 });
        self.integer(Integer::Compare64 { a: cursor, b: end });
        self.integer(Inst::Jump { condition: Condition::NotEqual, to: open.top });
        self.integer(Inst::Here(open.exit));
        if depth >= 2 {
            for (which, to) in BANKS[depth % 2].into_iter().enumerate() {
                self.integer(Integer::LoadPointer { to, from: Self::saved(depth - 2, which) });
            }
        }
        self.rows[table] = None;
        self.depth -= 1;
    }

    /// Finds the first block of points.
    fn find_points(&mut self, id: LoopId) {
        let is_whole = self.linear.loops[id as usize].parent == NONE;
        self.integer(if is_whole {
            Integer::ClearRegister { to: Gpr::Rcx }
        } else {
            Integer::LoadPointer { to: Gpr::Rcx, from: Memory::at(Gpr::Rsp, STRIP_START) }
        });
        if !is_whole {
            self.slot_addresses.push(self.code.len());
            self.integer(Integer::Address { to: Gpr::R8, of: Memory::at(Gpr::Rsp, 0) });
        }
        for (plane, to) in self.inputs(id) {
            self.integer(Integer::LoadPointer { to, from: plane_pointer(plane) });
            self.integer(Integer::AddRegister { to, from: Gpr::Rcx });
        }
    }

    /// The input planes that a loop over points reads, with their registers.
    fn inputs(&self, id: LoopId) -> impl Iterator<Item = (usize, Gpr)> + use<> {
        let inputs = self.linear.loops[id as usize].inputs;
        INPUTS.into_iter().enumerate().filter(move |&(plane, _)| inputs >> plane & 1 == 1)
    }

    fn end_points(&mut self, id: LoopId, open: &OpenLoop) {
        let number = (self.vectors as usize * self.shape.bytes) as i32;
        let is_whole = self.linear.loops[id as usize].parent == NONE;
        for (_, to) in self.inputs(id) {
            self.integer(Integer::AddConstant { to, number });
        }
        if !is_whole {
            self.integer(Integer::AddConstant { to: Gpr::R8, number });
        }
        self.integer(Integer::AddConstant { to: Gpr::Rcx, number });
        self.integer(Integer::Compare64 { a: Gpr::Rcx, b: Gpr::Rsi });
        self.integer(Inst::Jump { condition: Condition::Below, to: open.top });
    }

    fn begin_strips(&mut self, top: Label) {
        let all = Memory::at(Gpr::Rsp, ALL_BYTES);
        let number = i32::try_from(self.strip_bytes).expect("a strip is short");
        self.integer(Integer::StorePointer { to: all, from: Gpr::Rsi });
        self.integer(Integer::ClearRegister { to: Gpr::Rcx });
        self.integer(Inst::Here(top));
        self.integer(Integer::StorePointer { to: Memory::at(Gpr::Rsp, STRIP_START), from: Gpr::Rcx });
        self.integer(Integer::Address { to: Gpr::Rsi, of: Memory::at(Gpr::Rcx, number) });
        self.integer(Integer::CompareMemory { a: Gpr::Rsi, b: all });
        self.integer(Integer::TakeIfAbove { to: Gpr::Rsi, from: all });
    }

    fn end_strips(&mut self, open: &OpenLoop) {
        let number = i32::try_from(self.strip_bytes).expect("a strip is short");
        self.integer(Integer::LoadPointer { to: Gpr::Rcx, from: Memory::at(Gpr::Rsp, STRIP_START) });
        self.integer(Integer::AddConstant { to: Gpr::Rcx, number });
        self.integer(Integer::CompareMemory { a: Gpr::Rcx, b: Memory::at(Gpr::Rsp, ALL_BYTES) });
        self.integer(Inst::Jump { condition: Condition::Below, to: open.top });
    }
}

/// The memory with the address of an input plane.
fn plane_pointer(plane: usize) -> Memory {
    Memory::at(Gpr::Rdi, i32::try_from(8 * plane).expect("planes are limited"))
}
