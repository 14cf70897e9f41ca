//! Loops over the rows of a table.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::types::{F32X4, I32X4, I64};
use cranelift_codegen::ir::{self, BlockArg, InstBuilder};
use cranelift_frontend::FunctionBuilder;
use jbt_ir::{Any, Entity, Fold, Table};

use super::{CurrentRow, Lowering, READ, ValuePlace, offset};
use crate::abi::TableView;
use crate::cranelift::vectors::Vectors;

/// The active rows of a table that the current row of its parent owns: addresses.
#[derive(Clone, Copy)]
struct Active {
    /// Of the first number of the table.
    numbers: ir::Value,
    /// Of the first active row of the whole table.
    first: ir::Value,
    /// Of the first one that is owned.
    begin: ir::Value,
    /// Behind the last one that is owned.
    end: ir::Value,
}

impl<'f, const K: usize> Lowering<'f, K> {
    /// Emits a fold that is not cut, and returns the final accumulators.
    pub(super) fn fold(&mut self, fold: &Fold) -> Vec<Any<Vectors<'f, K>>> {
        let initial = self.operands(&fold.initial);
        self.each_row(fold.table, &initial, |lowering, accumulators| {
            for (&param, &accumulator) in lowering.function.blocks[fold.body].params.iter().zip(accumulators)
            {
                lowering.places[param.index()] = Some(ValuePlace::Computed(accumulator));
            }
            lowering.block(fold.body)
        })
    }

    /// Emits a loop over the active rows that the parent's row owns: `body` takes the accumulators and
    /// returns the next ones. Returns the final ones.
    pub(super) fn each_row(
        &mut self,
        table: Table,
        initial: &[Any<Vectors<'f, K>>],
        body: impl FnOnce(&mut Self, &[Any<Vectors<'f, K>>]) -> Vec<Any<Vectors<'f, K>>>,
    ) -> Vec<Any<Vectors<'f, K>>> {
        let Active { numbers, first, begin, end } = self.active(table);
        let builder = &mut self.vectors.builder;
        let [header, row, exit] = [(); 3].map(|()| builder.create_block());
        let cursor = builder.append_block_param(header, I64);
        let accumulators: Vec<_> = initial.iter().map(|value| block_params(builder, header, value)).collect();
        builder.ins().jump(header, &block_args(begin, initial));

        self.switch_to(header);
        let builder = &mut self.vectors.builder;
        // Of two successors Cranelift places the second next in memory: the row, so that the loop is one
        // stretch of code.
        let over = builder.ins().icmp(IntCC::Equal, cursor, end);
        builder.ins().brif(over, exit, &[], row, &[]);

        self.switch_to(row);
        self.rows[table.index()] = Some(self.read_row(table, numbers, first, cursor));
        let next = body(self, &accumulators);
        self.rows[table.index()] = None;
        let builder = &mut self.vectors.builder;
        let next_cursor = builder.ins().iadd_imm_s(cursor, size_of::<u32>() as i64);
        builder.ins().jump(header, &block_args(next_cursor, &next));

        self.switch_to(exit);
        accumulators
    }

    /// The address of a table's numbers, and where its active rows begin and end for the parent's current
    /// row.
    fn active(&mut self, table: Table) -> Active {
        let parent = self.function.tables[table].parent.map(|parent| self.row(parent).position);
        let view = self.frame.tables;
        let builder = &mut self.vectors.builder;
        let mut field = |field| {
            let at = i32::try_from(table.index() * size_of::<TableView>() + field);
            let at = at.expect("limits::MAX_TABLES keeps every view within 2^31 bytes");
            builder.ins().load(I64, READ, view, at)
        };
        let numbers = field(TableView::NUMBERS);
        let first = field(TableView::ACTIVE);
        let mut starts = field(TableView::STARTS);
        if let Some(parent) = parent {
            // A start is as long as an active row, so the bytes are the same.
            starts = builder.ins().iadd(starts, parent);
        }
        let [begin, end] = [0, 1].map(|which| {
            let position = builder.ins().uload32(READ, starts, offset(which, size_of::<u32>()));
            let skipped = builder.ins().imul_imm_s(position, size_of::<u32>() as i64);
            builder.ins().iadd(first, skipped)
        });
        Active { numbers, first, begin, end }
    }

    /// The row that the cursor points at.
    fn read_row(
        &mut self,
        table: Table,
        numbers: ir::Value,
        first: ir::Value,
        cursor: ir::Value,
    ) -> CurrentRow {
        let row_bytes = self.function.tables[table].columns.len() * size_of::<f32>();
        let builder = &mut self.vectors.builder;
        let index = builder.ins().uload32(READ, cursor, 0);
        let skipped = builder.ins().imul_imm_s(index, row_bytes as i64);
        let numbers = builder.ins().iadd(numbers, skipped);
        CurrentRow { position: builder.ins().isub(cursor, first), numbers }
    }
}

/// Adds a block parameter for each vector of a value of the type of `like`.
fn block_params<'f, const K: usize>(
    builder: &mut FunctionBuilder<'f>,
    block: ir::Block,
    like: &Any<Vectors<'f, K>>,
) -> Any<Vectors<'f, K>> {
    let mut params = |type_| std::array::from_fn(|_| builder.append_block_param(block, type_));
    match like {
        Any::Real(_) => Any::Real(params(F32X4)),
        Any::Mask(_) => Any::Mask(params(I32X4)),
        Any::Bits(_) => Any::Bits(params(I32X4)),
    }
}

/// The cursor and the accumulators of a loop, as its header takes them.
fn block_args<'f, const K: usize>(cursor: ir::Value, accumulators: &[Any<Vectors<'f, K>>]) -> Vec<BlockArg> {
    let vectors = accumulators.iter().flat_map(|accumulator| match accumulator {
        Any::Real(vectors) | Any::Mask(vectors) | Any::Bits(vectors) => *vectors,
    });
    std::iter::once(cursor).chain(vectors).map(BlockArg::Value).collect()
}
