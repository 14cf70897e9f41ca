//! Random functions that are awkward to print: names in need of quotes, accumulators of every type, NaNs of
//! every kind, origins on any instruction. They obey every rule.

use fastrand::Rng;
use jbt_ir::{
    Domain, Entity, FoldKind, Function, FunctionBuilder, Op, Origin, Part, Rows, Rule, Schema, Tables, Type,
    Value,
};

/// Names that a printer has to be careful with, some of them twice.
const NAMES: [&str; 9] = ["x", "color.r", "x", "v3", "", "a b", "\u{1b}[31m\"\\", "größe", "7up"];

/// Numbers with unusual texts.
const NUMBERS: [u32; 12] = [
    0x0000_0000,
    0x8000_0000,
    0x3f80_0000,
    0x7f80_0000,
    0xff80_0000,
    0x7fc0_0000,
    0xffc0_0000,
    0x7f80_0001,
    0x0000_0001,
    0x7f7f_ffff,
    0x3dcc_cccd,
    0x4b80_0001,
];

/// A writer of random functions.
struct Writer<'a> {
    rng: &'a mut Rng,
    builder: FunctionBuilder,
    /// What can be used now, by type.
    visible: [Vec<Value>; 3],
    slots: u32,
}

/// A random function of one to two roots of nested folds, and 0 to 3 outputs.
pub fn function(rng: &mut Rng) -> Function {
    let builder = FunctionBuilder::new(rng.choice(NAMES).expect("there are names"), &["x", "color.r", "x"]);
    let mut writer = Writer { rng, builder, visible: Default::default(), slots: 0 };
    for index in 0..3 {
        let value = writer.builder.input(index);
        writer.visible[0].push(value);
    }
    let truth = writer.builder.lt(writer.visible[0][0], writer.visible[0][1]);
    let bits = writer.builder.bits_constant(0x0f0f_0f0f);
    writer.visible[1].push(truth);
    writer.visible[2].push(bits);
    writer.insts(12);
    for _ in 0..writer.rng.usize(1..3) {
        writer.fold(None, 0);
        writer.insts(4);
    }
    let outputs: Vec<(String, Value)> =
        (0..writer.rng.usize(0..4)).map(|_| (writer.name(), writer.any(Type::Real))).collect();
    writer.builder.finish(&outputs)
}

impl Writer<'_> {
    fn name(&mut self) -> String {
        self.rng.choice(NAMES).expect("there are names").to_owned()
    }

    fn any(&mut self, type_: Type) -> Value {
        let values = &self.visible[type_ as usize];
        values[self.rng.usize(0..values.len())]
    }

    fn insts(&mut self, count: usize) {
        for _ in 0..count {
            let part = self.rng.choice(Part::ALL).expect("there are parts");
            let slot = (self.slots > 0 && self.rng.bool()).then(|| self.rng.u32(0..self.slots));
            self.builder.set_origin(Origin::new(slot, part));
            let op = *self.rng.choice(Op::ALL).expect("there are ops");
            let mut args: Vec<Value> = op.operands().iter().map(|&type_| self.any(type_)).collect();
            if matches!(op, Op::Shl | Op::Shr) {
                args[1] = self.builder.bits_constant(self.rng.u32(0..40));
            }
            let value = self.builder.op(op, &args);
            self.visible[op.result() as usize].push(value);
            let number = self.rng.choice(NUMBERS).expect("there are numbers");
            let constant = self.builder.constant(f32::from_bits(number));
            self.visible[0].push(constant);
        }
    }

    fn fold(&mut self, parent: Option<jbt_ir::Table>, depth: usize) {
        let columns = (0..self.rng.usize(0..4)).map(|_| self.name()).collect::<Vec<_>>();
        let slots: Vec<u32> = (self.slots..self.slots + self.rng.u32(0..3)).collect();
        self.slots += u32::try_from(slots.len()).expect("there are few slots");
        let count = columns.len();
        let name = self.name();
        let table = self.builder.table(Schema { name, columns, parent, slots });
        let types: Vec<Type> =
            (0..self.rng.usize(0..4)).map(|_| self.rng.choice(Type::ALL).expect("there are types")).collect();
        let initial: Vec<Value> = types.iter().map(|&type_| self.any(type_)).collect();
        let kind = self.rng.choice(FoldKind::ALL).expect("there are kinds");
        let rule = self.rng.choice(Rule::ALL).expect("there are rules");
        let outside = self.visible.clone();
        let accumulators = self.builder.begin_fold(table, (kind, rule), &initial);
        for (&type_, accumulator) in types.iter().zip(accumulators) {
            self.visible[type_ as usize].push(accumulator);
        }
        for column in 0..count {
            let value = self.builder.column(table, column);
            self.visible[0].push(value);
        }
        self.insts(6);
        if depth < 2 && self.rng.bool() {
            let parent = if self.rng.bool() { Some(table) } else { parent };
            self.fold(parent, depth + 1);
            self.insts(2);
        }
        let next: Vec<Value> = types.iter().map(|&type_| self.any(type_)).collect();
        self.visible = outside;
        for (type_, result) in types.into_iter().zip(self.builder.end_fold(&next)) {
            self.visible[type_ as usize].push(result);
        }
    }
}

/// Tables that fit a verified function: every parent row owns two rows, the second table row of five is not
/// active.
pub fn tables(function: &Function) -> Tables {
    let mut tables = Tables::default();
    for schema in function.tables.values() {
        let parents = schema.parent.map_or(1, |parent| tables.tables[parent].len());
        let stride = schema.columns.len();
        let rows = 2 * parents;
        let active: Vec<u32> = (0..rows).filter(|row| row % 5 != 1 || stride == 0).map(index).collect();
        let starts =
            (0..=parents).map(|parent| index(active.iter().filter(|&&row| row < index(2 * parent)).count()));
        tables.tables.push(Rows {
            count: rows,
            stride,
            numbers: (0..rows * stride).map(|number| 0.25 * index(number) as f32 - 1.0).collect(),
            starts: starts.collect(),
            active,
            nodes: vec![0; rows * schema.slots.len()],
        });
    }
    tables
}

fn index(number: usize) -> u32 {
    u32::try_from(number).expect("samples are small")
}

/// The function with its instructions numbered in the order of the text, and its constants told apart by
/// their bits.
pub fn canonical(function: &Function) -> Function {
    use jbt_ir::{InstKind, Store};
    let mut result = function.clone();
    result.insts = Store::new();
    let mut open = vec![(function.body, 0)];
    while let Some((block, next)) = open.last_mut() {
        let (block, at) = (*block, *next);
        *next += 1;
        let Some(&inst) = function.blocks[block].insts.get(at) else {
            open.pop();
            continue;
        };
        let mut data = function.insts[inst].clone();
        match &data.kind {
            InstKind::Constant(number) => data.kind = InstKind::BitsConstant(number.to_bits()),
            InstKind::Fold(fold) => open.push((fold.body, 0)),
            InstKind::Input(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. }
            | InstKind::Op { .. } => {}
        }
        result.blocks[block].insts[at] = result.insts.push(data);
    }
    assert_eq!(result.insts.len(), function.insts.len(), "every instruction was met once");
    debug_assert!(function.body.index() < function.blocks.len());
    result
}
