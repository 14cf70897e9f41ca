//! Executable memory: this crate's one home of `unsafe`.
//!
//! ```text
//! Pages         owns a Cranelift module: its memory is freed when it goes, on every path
//! MachineCode   Pages with finished code, and the addresses of its functions
//! ```
//!
//! No page is writable and executable at once: the module writes the code, then finalizing takes the right to
//! write away and gives the right to execute.
//!
//! A large frame is no part of the caller's stack, which may be a small one: the code runs on memory that
//! the thread keeps for it ([`FrameMemory`]), and the stack pointer is put back when it returns.
#![allow(unsafe_code)]

use std::cell::Cell;

use cranelift_codegen::Context;
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{Linkage, Module, ModuleError, default_libcall_names};

use jbt_ir::limits;

use crate::abi::{KernelArguments, TableView};
use crate::blob::{CodeBlob, Emitted};
use crate::cranelift::lower::Lowered;
use crate::error::CompileError;
use crate::isa;
use crate::options::{Allocator, OptLevel};

/// A module whose memory goes with it. The module's own drop would leak it.
struct Pages(Option<JITModule>);

impl Drop for Pages {
    fn drop(&mut self) {
        if let Some(module) = self.0.take() {
            // SAFETY: the address of the code is kept in `MachineCode` alone, beside these pages, and is used
            // in `MachineCode::call` alone, which borrows the `MachineCode`. So nothing runs in these pages
            // now, and nothing will.
            unsafe { module.free_memory() };
        }
    }
}

/// A function of finished code.
#[derive(Clone, Copy)]
struct EntryPoint {
    address: *const u8,
    /// Points in a block.
    lanes: usize,
}

/// Finished machine code.
///
/// Contract: `blocks` and `rest` are functions in `pages` which were compiled from a [`Lowered`] or emitted
/// as an [`Emitted`], so they keep to the ABI of [`crate::entry`], with blocks of so many points; the pages
/// are executable, are not writable, and stay until the `MachineCode` is dropped.
pub(crate) struct MachineCode {
    blocks: EntryPoint,
    /// For what is left behind whole blocks, in smaller blocks of which they are multiples.
    rest: Option<EntryPoint>,
    bytes: usize,
    frame_bytes: usize,
    /// Never looked at again: kept so that the code stays where it is.
    _pages: Pages,
}

/// Memory that one run of code takes for its stack.
#[derive(Default)]
struct FrameMemory(Vec<u128>);

thread_local! {
    /// Memory for large frames of runs that have ended on this thread: the frames of all code are in the same
    /// lines of its cache. At most [`limits::MAX_JIT_FRAME_BYTES`] and a little more.
    static FRAME: Cell<FrameMemory> = const { Cell::new(FrameMemory(Vec::new())) };
}

impl FrameMemory {
    /// Bytes besides the frame: the registers that code saves, and what a handler of a signal takes that
    /// comes meanwhile, which the kernel gives all vector registers.
    const BESIDES: usize = 64 << 10;

    /// The memory of this thread, for a frame of so many bytes; `None` if there is not as much.
    fn take(frame_bytes: usize) -> Option<Self> {
        let words = (frame_bytes + Self::BESIDES).div_ceil(size_of::<u128>());
        // A thread that ends has none any more.
        let Self(mut memory) = FRAME.try_with(Cell::take).unwrap_or_default();
        memory.try_reserve_exact(words).ok()?;
        Some(Self(memory))
    }

    /// Keeps the memory for the next run on this thread.
    fn keep(self) {
        // Where nothing is kept any more, it is freed.
        let _ = FRAME.try_with(|place| place.set(self));
    }

    /// Where a stack begins that grows down into it: a multiple of 16.
    fn top(&mut self) -> *mut u8 {
        let words = self.0.capacity();
        self.0.as_mut_ptr().wrapping_add(words).cast()
    }
}

// SAFETY: the module is `Send`, and the addresses are those of memory which belongs to it.
unsafe impl Send for MachineCode {}
// SAFETY: through a shared reference one can only read the numbers and call the code, which changes no memory
// but what its arguments name, the stack of the thread that calls it, and memory for frames, which a thread
// has for itself during a run. The module, which is not `Sync`, cannot be reached.
unsafe impl Sync for MachineCode {}

impl MachineCode {
    /// Compiles a function with blocks of so many points, and makes it executable.
    pub(crate) fn new(lowered: Lowered, lanes: usize, isa: OwnedTargetIsa) -> Result<Self, CompileError> {
        let builder = JITBuilder::with_isa(isa, default_libcall_names());
        let mut pages = Pages(Some(JITModule::new(builder)));
        let module = pages.0.as_mut().expect("the module stays until the pages are dropped");
        let mut context = Context::for_function(lowered.into_function());
        let function = module.declare_function("kernel", Linkage::Export, &context.func.signature)?;
        module.define_function(function, &mut context)?;
        let compiled = context.compiled_code().expect("the function has just been compiled");
        let bytes = compiled.code_info().total_size as usize;
        let frame_bytes = compiled.buffer.frame_layout().map_or(0, |frame| frame.frame_to_fp_offset as usize);
        if frame_bytes > limits::MAX_JIT_FRAME_BYTES {
            return Err(CompileError::Frame { bytes: frame_bytes, limit: limits::MAX_JIT_FRAME_BYTES });
        }
        module.finalize_definitions()?;
        let blocks = EntryPoint { address: module.get_finalized_function(function), lanes };
        Ok(Self { blocks, rest: None, bytes, frame_bytes, _pages: pages })
    }

    /// Makes finished bytes executable. The caller has asked the CPU for what they need.
    pub(crate) fn from_emitted(emitted: &Emitted) -> Result<Self, CompileError> {
        let Emitted { blocks, rest } = emitted;
        // The module compiles nothing: any settings give its pages.
        let isa = isa::host(OptLevel::None, Allocator::SinglePass)?;
        let mut pages = Pages(Some(JITModule::new(JITBuilder::with_isa(isa, default_libcall_names()))));
        let module = pages.0.as_mut().expect("the module stays until the pages are dropped");
        let signature = module.make_signature();
        let mut define = |name, blob: &CodeBlob| {
            let function = module.declare_function(name, Linkage::Export, &signature)?;
            // Constants are read by whole vectors.
            module.define_function_bytes(function, 64, &blob.bytes, &[])?;
            Ok::<_, CompileError>((function, blob.lanes))
        };
        let blocks_function = define("kernel", blocks)?;
        let rest_function = rest.as_ref().map(|rest| define("kernel_of_few", rest)).transpose()?;
        module.finalize_definitions()?;
        let entry =
            |(function, lanes)| EntryPoint { address: module.get_finalized_function(function), lanes };
        let both = || std::iter::once(blocks).chain(rest);
        Ok(Self {
            blocks: entry(blocks_function),
            rest: rest_function.map(entry),
            bytes: both().map(|blob| blob.bytes.len()).sum(),
            frame_bytes: both().map(|blob| blob.frame_bytes).max().unwrap_or(0),
            _pages: pages,
        })
    }

    /// Points in the smallest block.
    pub(crate) fn lanes(&self) -> usize {
        self.rest.unwrap_or(self.blocks).lanes
    }

    /// Bytes of code and constants.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }

    /// Bytes of the frame.
    pub(crate) fn frame_bytes(&self) -> usize {
        self.frame_bytes
    }

    /// Memory for a frame that is too large for the caller's stack. Where there is none it has to do.
    fn take_frame(&self) -> Option<FrameMemory> {
        let is_large = self.frame_bytes > limits::MAX_STACK_FRAME_BYTES;
        is_large.then(|| FrameMemory::take(self.frame_bytes)).flatten()
    }

    /// Where the code is.
    #[cfg(test)]
    pub(crate) fn address(&self) -> *const u8 {
        self.blocks.address
    }

    /// Runs the code: whole blocks first, then what is left. The arguments were made for the function that
    /// this is compiled from, see [`KernelArguments`].
    pub(crate) fn call(&self, KernelArguments { planes, bytes, tables }: KernelArguments<'_>) {
        let block = self.blocks.lanes * size_of::<f32>();
        let whole = if self.rest.is_some() { bytes - bytes % block } else { bytes };
        let mut frame = self.take_frame();
        let stack = frame.as_mut().map_or(std::ptr::null_mut(), FrameMemory::top);
        for (entry, bytes) in [(Some(self.blocks), whole), (self.rest, bytes - whole)] {
            let Some(entry) = entry.filter(|_| bytes > 0) else { continue };
            // SAFETY: the contract of `MachineCode` says that this is a function of the ABI that `enter`
            // expects. `KernelArguments` come from `Kernel::call`: there is a plane of this many bytes for
            // each input and output, at least one block long and whole blocks; outputs come from exclusive
            // borrows, so that no other plane overlaps them; the tables have been checked against the
            // function, the selection fits them, and both are borrowed by the caller. What else the code
            // writes is its frame. A small one is on the caller's stack, and is touched page by page: a stack
            // that is too short for it ends at the guard page. A large one is in `frame`, which is longer and
            // belongs to this run alone. What is left behind whole blocks ends where the planes end, and is
            // whole smaller blocks, as larger ones are.
            unsafe { enter(entry.address, planes.as_ptr(), bytes, tables.as_ptr(), stack) };
            for plane in &mut *planes {
                *plane = plane.wrapping_byte_add(bytes);
            }
        }
        frame.into_iter().for_each(FrameMemory::keep);
    }
}

/// The floating-point environment of a new thread: round to nearest, subnormals kept, all exceptions masked.
#[cfg(target_arch = "x86_64")]
static DEFAULT_MXCSR: u32 = 0x1F80;

/// Calls code in the default floating-point environment, and puts the caller's back.
///
/// All of it is one piece of assembly, because Rust promises nothing about code of its own that runs in
/// another environment. The upper halves of the vector registers are cleared first: Cranelift writes its
/// moves in the legacy encoding, which waits for whatever the caller has left there.
///
/// # Safety
/// `code` is a System V function of these three parameters, which may do what it does with these arguments,
/// does not unwind, and leaves the floating-point environment as it is. `stack` is null, or the end of memory
/// that nothing else uses, a multiple of 16, and there is as much of it as `code` takes.
#[cfg(target_arch = "x86_64")]
unsafe fn enter(
    code: *const u8,
    planes: *const *const f32,
    bytes: usize,
    tables: *const TableView,
    stack: *mut u8,
) {
    let mut saved = 0_u32;
    // SAFETY: the stack is aligned for a call, as it is wherever assembly may use it, and as `stack` is. r12
    // to r14 survive the call by its convention; r12 and r13 point at two words that live here, r14 keeps the
    // stack pointer. Everything that the convention lets a callee change is named, and the environment, with
    // its exception flags, is what it was.
    unsafe {
        std::arch::asm!(
            "vzeroupper",
            "stmxcsr [r12]",
            "ldmxcsr [r13]",
            "mov r14, rsp",
            "test r15, r15",
            "cmovnz rsp, r15",
            "call {code}",
            "mov rsp, r14",
            "ldmxcsr [r12]",
            code = in(reg) code,
            in("rdi") planes,
            in("rsi") bytes,
            in("rdx") tables,
            in("r12") &raw mut saved,
            in("r13") &raw const DEFAULT_MXCSR,
            out("r14") _,
            in("r15") stack,
            clobber_abi("sysv64"),
        );
    }
}

/// There is no code to call on this processor: [`crate::isa`] declines it.
///
/// # Safety
/// None is needed.
#[cfg(not(target_arch = "x86_64"))]
unsafe fn enter(_: *const u8, _: *const *const f32, _: usize, _: *const TableView, _: *mut u8) {
    unreachable!("isa::host declines this processor");
}

impl From<ModuleError> for CompileError {
    fn from(error: ModuleError) -> Self {
        match error {
            // The memory provider's only errors are those of mmap and mprotect.
            ModuleError::Allocation { .. } | ModuleError::Backend(_) => Self::Memory(error.to_string()),
            ModuleError::Undeclared(_)
            | ModuleError::IncompatibleDeclaration(_)
            | ModuleError::IncompatibleSignature(..)
            | ModuleError::DuplicateDefinition(_)
            | ModuleError::InvalidImportDefinition(_)
            | ModuleError::Compilation(_)
            | ModuleError::Flag(_) => Self::Cranelift(error.to_string()),
        }
    }
}

#[cfg(all(test, target_arch = "x86_64", target_os = "linux"))]
mod tests {
    use std::arch::asm;
    use std::process::Command;
    use std::sync::Arc;

    use jbt_ir::engine::BoundProgram;
    use jbt_ir::{Domain, FunctionBuilder, Level, Tables, Verified, verify};

    use crate::{CompileError, Cranelift, Kernel, Wide};

    /// Code for the level that is used here.
    fn compile(function: &Verified) -> Result<Kernel, CompileError> {
        match Level::best() {
            Level::Baseline => Cranelift::STANDARD.kernel(function),
            level @ (Level::Avx2 | Level::Avx512Vl | Level::Avx512) => Wide::STANDARD.kernel(function, level),
        }
    }

    /// `x * y` and `x / y`.
    fn arithmetic() -> Verified {
        let mut b = FunctionBuilder::new("arithmetic", &["x", "y"]);
        let (x, y) = (b.input(0), b.input(1));
        let outputs = [b.mul(x, y), b.div(x, y)];
        verify(b.finish(&[("product".to_owned(), outputs[0]), ("quotient".to_owned(), outputs[1])]))
            .expect("it obeys the rules")
    }

    fn mxcsr() -> u32 {
        let mut word = 0_u32;
        // SAFETY: writes the word.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut word) };
        word
    }

    fn set_mxcsr(word: u32) {
        // SAFETY: the test does no arithmetic until it has put the default back.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const word) };
    }

    #[test]
    fn a_kernel_runs_in_the_default_environment_and_leaves_that_of_its_caller() {
        let Ok(kernel) = compile(&arithmetic()) else { return };
        let kernel =
            BoundProgram::new(Arc::new(kernel), Arc::new(Tables::default())).expect("there are no tables");
        let (subnormal, third) = (vec![1e-40_f32; 32], vec![3.0_f32; 32]);
        let (mut product, mut quotient) = (vec![0.0; 32], vec![0.0; 32]);
        // Flush to zero, subnormals are zeros, round toward zero; all exceptions masked, one flag raised.
        let odd = 0x1F80 | 1 << 15 | 1 << 6 | 0b11 << 13 | 1;
        let before = mxcsr();
        set_mxcsr(odd);
        let done = kernel.run(&[&subnormal, &third], &mut [&mut product, &mut quotient]);
        let after = mxcsr();
        set_mxcsr(before);
        done.expect("the planes fit");
        assert_eq!(after, odd);
        assert!(product.iter().all(|&number| number.to_bits() == (1e-40_f32 * 3.0).to_bits()));
        assert!(quotient.iter().all(|&number| number.to_bits() == (1e-40_f32 / 3.0).to_bits()));
    }

    #[test]
    fn code_is_executable_and_not_writable() {
        let Ok(kernel) = compile(&arithmetic()) else { return };
        let address = kernel.code_address().addr();
        let maps = std::fs::read_to_string("/proc/self/maps").expect("Linux lists the mappings");
        let holds_the_code = |line: &&str| {
            let (from, to) = line.split(' ').next().and_then(|range| range.split_once('-')).expect("a range");
            let [from, to] = [from, to].map(|end| usize::from_str_radix(end, 16).expect("an address"));
            (from..to).contains(&address)
        };
        let line = maps.lines().find(holds_the_code).expect("the code is mapped");
        assert_eq!(line.split(' ').nth(1), Some("r-xp"));
    }

    /// Runs itself in another process, whose memory is then never made executable by the system.
    #[test]
    fn refused_memory_is_an_error() {
        const CHILD: &str = "JBT_TEST_REFUSE_EXECUTABLE_MEMORY";
        if std::env::var_os(CHILD).is_none() {
            let program = std::env::current_exe().expect("the test has a path");
            let name = "memory::tests::refused_memory_is_an_error";
            let child = Command::new(program).args(["--exact", name]).env(CHILD, "1").output();
            let child = child.expect("the test can run itself");
            assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stdout));
            return;
        }
        let (prctl, set_mdwe, refuse_gain) = (157_usize, 65_usize, 1_usize);
        let mut result = prctl;
        // SAFETY: prctl with numbers only; it forbids this process to make memory executable.
        unsafe {
            asm!("syscall", inout("rax") result, in("rdi") set_mdwe, in("rsi") refuse_gain, in("rdx") 0, in("r10") 0,
                in("r8") 0, out("rcx") _, out("r11") _);
        }
        // An older kernel does not know the request, and an older processor gets another error first.
        if result == 0 && !matches!(compile(&arithmetic()), Err(CompileError::Processor { .. })) {
            assert!(matches!(compile(&arithmetic()), Err(CompileError::Memory(_))));
        }
    }
}
