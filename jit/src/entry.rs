//! The way into machine code: what it is given, and why that is safe to give.
//!
//! ```text
//! fn(planes, bytes, tables)
//!   planes  one pointer for each input plane, then one for each output plane
//!   bytes   of one plane; a multiple of the block, and not 0
//!   tables  one view for each table:  numbers | active | starts   (three pointers)
//!           numbers are those of the tables; active and starts are lists of the selection, by position
//! ```
//!
//! The code follows every pointer and index blindly. So a [`Kernel`] takes [`Run`]s alone, which the door of
//! all engines has checked: tables once, when they are bound; selections and planes at each run. A
//! [`Selection`] leads only to rows that exist by the way it is made, if it was made for as many.

use std::fmt;
use std::sync::Arc;

use jbt_ir::engine::{Interface, Planes, Program, Run};
use jbt_ir::{Function, Selection, Tables};

use crate::abi::{KernelArguments, TableView};
use crate::memory::MachineCode;

/// Machine code for one function.
pub struct Kernel {
    code: MachineCode,
    interface: Arc<Interface>,
}

impl Kernel {
    /// A multiple of the [`block`](Program::block) of every kernel.
    pub const MAX_LANES: usize = 32;

    /// A kernel of code that was made for a function.
    pub(crate) fn new(code: MachineCode, function: &Function) -> Self {
        Self { code, interface: Arc::new(Interface::new(function)) }
    }

    /// Bytes of machine code, its constants included.
    #[must_use]
    pub fn code_bytes(&self) -> usize {
        self.code.bytes()
    }

    /// Bytes that a run takes for its frame: of the caller's stack up to
    /// [`MAX_STACK_FRAME_BYTES`](jbt_ir::limits::MAX_STACK_FRAME_BYTES), else of memory that belongs to the
    /// kernel.
    #[must_use]
    pub fn frame_bytes(&self) -> usize {
        self.code.frame_bytes()
    }

    /// Where the code is, for a look at the memory's rights.
    #[cfg(test)]
    pub(crate) fn code_address(&self) -> *const u8 {
        self.code.address()
    }
}

impl fmt::Debug for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Kernel")
            .field("function", &self.interface.name())
            .field("block", &self.block())
            .field("code_bytes", &self.code_bytes())
            .finish_non_exhaustive()
    }
}

impl Program for Kernel {
    fn interface(&self) -> &Arc<Interface> {
        &self.interface
    }

    /// Points in the smallest block. Many points run in larger blocks, which suit the function better.
    fn block(&self) -> usize {
        self.code.lanes()
    }

    /// Straight from the caller's planes. What is left behind whole blocks is done with the last block that
    /// ends where the planes do: some points twice, with the same bits. Allocates nothing for up to 48 planes
    /// and 4 tables.
    fn run(&self, run: Run<'_, '_>) {
        let planes = run.planes(&self.interface);
        if planes.points >= self.block() {
            let inputs = planes.inputs.iter().map(|plane| plane.as_ptr());
            let outputs = planes.outputs.iter_mut().map(|plane| plane.as_mut_ptr().cast_const());
            self.call((planes.tables, planes.selection), inputs.chain(outputs), planes.points);
        } else if planes.points > 0 {
            self.run_few(planes);
        }
    }
}

/// Planes up to which a call needs no allocation, and tables. Their places are cleared at each call, so there
/// are no more than most models take.
const FEW_PLANES: usize = 16;
const FEW_TABLES: usize = 4;
/// Planes up to which a block that is filled up is on the stack: a range along each axis; field, gradient and
/// colour.
const FEW_INPUTS: usize = 6;
const FEW_OUTPUTS: usize = 8;

/// `count` places, in `small` if they fit, else in `large`.
fn places<'a, T: Copy, const FEW: usize>(
    small: &'a mut [T; FEW],
    large: &'a mut Vec<T>,
    count: usize,
) -> &'a mut [T] {
    if count <= FEW {
        return &mut small[..count];
    }
    large.resize(count, small[0]);
    large
}

impl Kernel {
    /// Fewer points than a block, at least one: they go through a block that is filled up with the last.
    fn run_few(&self, planes: Planes<'_, '_>) {
        let Planes { points, tables, selection, inputs, outputs } = planes;
        let lanes = self.block();
        let (mut small, mut large) = ([0.0_f32; FEW_INPUTS * Self::MAX_LANES], Vec::new());
        let asked = places(&mut small, &mut large, inputs.len() * lanes);
        for (block, plane) in asked.chunks_exact_mut(lanes).zip(inputs) {
            block[..points].copy_from_slice(plane);
            block[points..].fill(plane[points - 1]);
        }
        let (mut small, mut large) = ([0.0_f32; FEW_OUTPUTS * Self::MAX_LANES], Vec::new());
        let answers = places(&mut small, &mut large, outputs.len() * lanes);
        let given = asked.chunks_exact(lanes).map(<[f32]>::as_ptr);
        let wanted = answers.chunks_exact_mut(lanes).map(|block| block.as_mut_ptr().cast_const());
        self.call((tables, selection), given.chain(wanted), lanes);
        for (plane, block) in outputs.iter_mut().zip(answers.chunks_exact(lanes)) {
            plane.copy_from_slice(&block[..points]);
        }
    }

    /// Runs the code on planes of so many points, at least a block: inputs, then outputs, which nothing else
    /// borrows, as many as the function has.
    fn call(
        &self,
        (tables, selection): (&Tables, &Selection),
        planes: impl Iterator<Item = *const f32>,
        points: usize,
    ) {
        let (mut small, mut large) = ([std::ptr::null(); FEW_PLANES], Vec::new());
        let (inputs, outputs) = self.interface.planes();
        let pointers = places(&mut small, &mut large, inputs + outputs);
        for (place, plane) in pointers.iter_mut().zip(planes) {
            *place = plane;
        }
        let (mut small, mut large) = ([TableView::NOWHERE; FEW_TABLES], Vec::new());
        let views = places(&mut small, &mut large, tables.tables.len());
        for ((view, rows), (starts, active)) in
            views.iter_mut().zip(tables.tables.values()).zip(selection.lists())
        {
            *view = TableView {
                numbers: rows.numbers.as_ptr(),
                active: active.as_ptr(),
                starts: starts.as_ptr(),
            };
        }
        let (block, bytes) = (self.block() * size_of::<f32>(), points * size_of::<f32>());
        let rest = bytes % block;
        self.code.call(KernelArguments { planes: &mut *pointers, bytes: bytes - rest, tables: views });
        if rest > 0 {
            pointers.iter_mut().for_each(|plane| *plane = plane.wrapping_byte_sub(block - rest));
            self.code.call(KernelArguments { planes: pointers, bytes: block, tables: views });
        }
    }
}
