//! The door: what the machine code is given, and the checks that make it safe to give.
//!
//! ```text
//! fn(planes, bytes, tables)
//!   planes  one pointer for each input plane, then one for each output plane
//!   bytes   of one plane; a multiple of the block, and not 0
//!   tables  one view for each table:  numbers | active | starts   (three pointers)
//! ```
//!
//! The code follows every pointer and index blindly. So the tables are checked once, when a [`Kernel`] is
//! bound to them; a [`Selection`] leads only to rows that exist by the way it is made, if it was made for as
//! many; and the planes are checked at each [`run`](BoundKernel::run), which costs nothing beside the run.

use std::fmt;
use std::sync::Arc;

use jbt_ir::selection::Extent;
use jbt_ir::{Function, Selection, TableError, Tables, Verified};

use crate::abi::{Arguments, TableView};
use crate::compile;
use crate::error::CompileError;
use crate::memory::Code;
use crate::options::Options;

/// What one kernel and its handles share.
struct Shared {
    code: Code,
    /// The function without its instructions: planes and tables.
    interface: Function,
}

/// Machine code for one function. Cloning gives another handle; the code is freed with the last one.
#[derive(Clone)]
pub struct Kernel {
    shared: Arc<Shared>,
}

impl Kernel {
    /// A multiple of [`lanes`](Self::lanes) of every kernel: planes of as many numbers suit them all.
    pub const MAX_LANES: usize = 32;

    /// Compiles a function, with the settings that measurements favour for one of its size.
    ///
    /// # Errors
    /// When the processor, a limit or the system forbids it; an interpreter then gives the same bits, and
    /// needs more time.
    pub fn compile(function: &Verified) -> Result<Self, CompileError> {
        Self::compile_with(function, &Options::default())
    }

    /// Compiles a function with given settings. They change the time that compiling and running takes, and no
    /// bit of an answer.
    ///
    /// # Errors
    /// As for [`compile`](Self::compile).
    pub fn compile_with(function: &Verified, options: &Options) -> Result<Self, CompileError> {
        let code = compile::compile(function, options)?;
        let mut interface = Function::new(&function.function().name, &[]);
        interface.inputs.clone_from(&function.function().inputs);
        interface.outputs.clone_from(&function.function().outputs);
        interface.tables.clone_from(&function.function().tables);
        Ok(Self { shared: Arc::new(Shared { code, interface }) })
    }

    /// Points in the smallest block: the length of planes must be a multiple of it. Many points run in larger
    /// blocks, which suit the function better.
    #[must_use]
    pub fn lanes(&self) -> usize {
        self.shared.code.lanes()
    }

    /// Bytes of machine code, its constants included.
    #[must_use]
    pub fn code_bytes(&self) -> usize {
        self.shared.code.bytes()
    }

    /// Bytes of stack that a run takes.
    #[must_use]
    pub fn frame_bytes(&self) -> usize {
        self.shared.code.frame_bytes()
    }

    /// Where the code is, for a look at the memory's rights.
    #[cfg(test)]
    pub(crate) fn code_address(&self) -> *const u8 {
        self.shared.code.address()
    }

    /// Gives the kernel the rows that it will run over. Costs one look at every active row, so do it once for
    /// many runs.
    ///
    /// # Errors
    /// When the tables do not fit the function that the kernel was compiled from.
    pub fn bind(&self, tables: Arc<Tables>) -> Result<BoundKernel, TableError> {
        let all = Arc::new(Selection::checked(&self.shared.interface, &tables)?);
        Ok(BoundKernel { kernel: self.clone(), tables, all })
    }
}

impl fmt::Debug for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Kernel")
            .field("function", &self.shared.interface.name)
            .field("lanes", &self.lanes())
            .field("code_bytes", &self.code_bytes())
            .finish_non_exhaustive()
    }
}

/// A kernel together with rows that fit it: the thing that runs. Cloning is cheap.
#[derive(Clone)]
pub struct BoundKernel {
    kernel: Kernel,
    tables: Arc<Tables>,
    /// All rows that are active.
    all: Arc<Selection>,
}

/// Why planes do not fit a kernel.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum RunError {
    /// The number of input planes is not the function's.
    #[error("{given} input planes for a function of {expected}")]
    Inputs {
        /// Planes of the function.
        expected: usize,
        /// Planes of this call.
        given: usize,
    },
    /// The number of output planes is not the function's.
    #[error("{given} output planes for a function of {expected}")]
    Outputs {
        /// Planes of the function.
        expected: usize,
        /// Planes of this call.
        given: usize,
    },
    /// A plane is not as long as the first one.
    #[error("plane {plane} (inputs first) has {given} numbers, the first one has {expected}")]
    Length {
        /// Position of the plane, inputs first.
        plane: usize,
        /// Length of the first plane.
        expected: usize,
        /// Length of this plane.
        given: usize,
    },
    /// The selection was made from rows of other tables.
    #[error("the selection was made for tables with other numbers of rows")]
    Selection,
    /// The planes are shorter than a block.
    #[error("planes of {length} numbers do not fill a block of {lanes}")]
    Partial {
        /// Length of the planes.
        length: usize,
        /// Numbers in a block.
        lanes: usize,
    },
}

/// Planes up to which a call needs no allocation, and tables.
const FEW_PLANES: usize = 48;
const FEW_TABLES: usize = 12;

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

impl BoundKernel {
    /// The kernel.
    #[must_use]
    pub fn kernel(&self) -> &Kernel {
        &self.kernel
    }

    /// The rows.
    #[must_use]
    pub fn tables(&self) -> &Arc<Tables> {
        &self.tables
    }

    /// All rows that are active.
    #[must_use]
    pub fn all(&self) -> &Arc<Selection> {
        &self.all
    }

    /// What selections are made from: those of other kernels fit if their tables have as many rows.
    #[must_use]
    pub fn extent(&self) -> &Arc<Extent> {
        self.all.extent()
    }

    /// Answers for all points: `inputs[plane][point]` to `outputs[plane][point]`.
    ///
    /// Any number is fine as an input, NaN and infinities included. What is left behind whole blocks of
    /// [`Kernel::lanes`] points is done with the last block that ends where the planes do: some points twice,
    /// with the same bits. Allocates nothing for up to 48 planes and 12 tables.
    ///
    /// # Errors
    /// When the planes are not as many as the function's, not of one length, or that length is less than
    /// [`Kernel::lanes`] and not zero. Nothing is written then.
    pub fn run(&self, inputs: &[&[f32]], outputs: &mut [&mut [f32]]) -> Result<(), RunError> {
        self.run_selected(&self.all, inputs, outputs)
    }

    /// As [`run`](Self::run), with the rows of a selection.
    ///
    /// # Errors
    /// As for [`run`](Self::run), and when the selection was made for other numbers of rows.
    pub fn run_selected(
        &self,
        selection: &Selection,
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
    ) -> Result<(), RunError> {
        if !selection.fits(self.extent()) {
            return Err(RunError::Selection);
        }
        let length = self.check(inputs, outputs)?;
        if length == 0 {
            return Ok(());
        }
        let (mut small, mut large) = ([std::ptr::null(); FEW_PLANES], Vec::new());
        let planes = places(&mut small, &mut large, inputs.len() + outputs.len());
        let inputs = inputs.iter().map(|plane| plane.as_ptr());
        let outputs = outputs.iter_mut().map(|plane| plane.as_mut_ptr().cast_const());
        for (place, plane) in planes.iter_mut().zip(inputs.chain(outputs)) {
            *place = plane;
        }
        let (mut small, mut large) = ([TableView::NOWHERE; FEW_TABLES], Vec::new());
        let views = places(&mut small, &mut large, self.tables.tables.len());
        for ((view, rows), (starts, active)) in
            views.iter_mut().zip(self.tables.tables.values()).zip(selection.lists())
        {
            *view = TableView {
                numbers: rows.numbers.as_ptr(),
                active: active.as_ptr(),
                starts: starts.as_ptr(),
            };
        }
        let code = &self.kernel.shared.code;
        let (block, bytes) = (code.lanes() * size_of::<f32>(), length * size_of::<f32>());
        let rest = bytes % block;
        code.call(Arguments { planes: &mut *planes, bytes: bytes - rest, tables: views });
        if rest > 0 {
            planes.iter_mut().for_each(|plane| *plane = plane.wrapping_byte_sub(block - rest));
            code.call(Arguments { planes, bytes: block, tables: views });
        }
        Ok(())
    }

    /// The common length of the planes.
    fn check(&self, inputs: &[&[f32]], outputs: &[&mut [f32]]) -> Result<usize, RunError> {
        let Shared { code, interface } = &*self.kernel.shared;
        if inputs.len() != interface.inputs.len() {
            return Err(RunError::Inputs { expected: interface.inputs.len(), given: inputs.len() });
        }
        if outputs.len() != interface.outputs.len() {
            return Err(RunError::Outputs { expected: interface.outputs.len(), given: outputs.len() });
        }
        let mut lengths =
            inputs.iter().map(|plane| plane.len()).chain(outputs.iter().map(|plane| plane.len())).enumerate();
        let (_, expected) = lengths.next().unwrap_or_default();
        if let Some((plane, given)) = lengths.find(|&(_, given)| given != expected) {
            return Err(RunError::Length { plane, expected, given });
        }
        let lanes = code.lanes();
        if (1..lanes).contains(&expected) {
            return Err(RunError::Partial { length: expected, lanes });
        }
        Ok(expected)
    }
}

impl fmt::Debug for BoundKernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BoundKernel").field("kernel", &self.kernel).finish_non_exhaustive()
    }
}
