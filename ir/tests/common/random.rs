//! Random functions with fitting rows: every op, nested folds over tables with parents, inactive rows, and
//! spicy numbers.

use jbt_ir::{
    Domain, FoldKind, Function, FunctionBuilder, Op, Rows, Rule, Schema, Table, Tables, Type, Value,
};
use jbt_testkit::points::OPERANDS;

/// The input planes of every random function.
pub const INPUTS: [&str; 3] = ["x", "y", "z"];

/// A spicy number, or any other one.
pub fn number(random: &mut fastrand::Rng) -> f32 {
    match random.u8(0..8) {
        // Zeros and ones of both signs are the first four.
        0..3 => OPERANDS[random.usize(0..4)],
        3 | 4 => OPERANDS[random.usize(0..OPERANDS.len())],
        5 => f32::from_bits(random.u32(..)),
        _ => (random.f32() - 0.5) * 8.0,
    }
}

/// A fold whose body is being written.
struct Open {
    table: Table,
    /// How many values could be used before it.
    before: usize,
    /// Its accumulators.
    params: Vec<(Type, Value)>,
}

struct Generator {
    random: fastrand::Rng,
    builder: FunctionBuilder,
    /// The values that can be used, in the order of their definition.
    values: Vec<(Type, Value)>,
    open: Vec<Open>,
}

/// A function that this seed makes. It has about `size` instructions and 24 outputs.
pub fn function(seed: u64, size: usize) -> Function {
    let mut generator = Generator {
        random: fastrand::Rng::with_seed(seed),
        builder: FunctionBuilder::new("random", &INPUTS),
        values: Vec::new(),
        open: Vec::new(),
    };
    let depth = 3;
    for _ in 0..size {
        match generator.random.u8(0..30) {
            0 | 1 if generator.open.len() < depth => generator.begin_fold(),
            2 if !generator.open.is_empty() => generator.end_fold(),
            _ => generator.step(),
        }
    }
    while !generator.open.is_empty() {
        generator.end_fold();
    }
    let outputs: Vec<(String, Value)> =
        (0..24).map(|i| (format!("out{i}"), generator.any(Type::Real))).collect();
    generator.builder.finish(&outputs)
}

impl Generator {
    /// Any value of a type, made if there is none.
    fn any(&mut self, type_: Type) -> Value {
        let all: Vec<Value> =
            self.values.iter().filter(|(of, _)| *of == type_).map(|&(_, value)| value).collect();
        if all.is_empty() || self.random.u8(0..8) == 0 {
            self.fresh(type_)
        } else {
            all[self.random.usize(0..all.len())]
        }
    }

    /// One of the last values of a type.
    fn recent(&mut self, type_: Type) -> Value {
        let all: Vec<Value> = self
            .values
            .iter()
            .rev()
            .filter(|(of, _)| *of == type_)
            .take(12)
            .map(|&(_, value)| value)
            .collect();
        if all.is_empty() { self.fresh(type_) } else { all[self.random.usize(0..all.len())] }
    }

    /// A constant, an input or a column.
    fn fresh(&mut self, type_: Type) -> Value {
        let value = match type_ {
            Type::Real => match (self.random.u8(0..4), self.open.last()) {
                (0, _) => {
                    let index = self.random.usize(0..INPUTS.len());
                    self.builder.input(index)
                }
                (1 | 2, Some(&Open { table, .. })) => {
                    let column = self.random.usize(0..3);
                    self.builder.column(table, column)
                }
                _ => {
                    let number = number(&mut self.random);
                    self.builder.constant(number)
                }
            },
            Type::Bits => {
                let bits = match self.random.u8(0..4) {
                    0 => 0,
                    1 => u32::MAX,
                    2 => self.random.u32(0..40),
                    _ => self.random.u32(..),
                };
                self.builder.bits_constant(bits)
            }
            Type::Mask => {
                let (a, b) = (self.any(Type::Real), self.any(Type::Real));
                self.builder.lt(a, b)
            }
        };
        self.values.push((type_, value));
        value
    }

    /// A random op on random values.
    fn step(&mut self) {
        let mut op = Op::ALL[self.random.usize(0..Op::ALL.len())];
        if op == Op::LowEnd || op.is_slope() {
            // The range of an end encloses nothing, and a slope is one of the whole function, which no op
            // computes by itself.
            op = Op::StopGradient;
        }
        let mut args: Vec<Value> = op
            .operands()
            .iter()
            .map(|&type_| if self.random.bool() { self.recent(type_) } else { self.any(type_) })
            .collect();
        if op == Op::ToBits {
            // A NaN has no certain bits, so it is replaced.
            let equal = self.builder.eq(args[0], args[0]);
            let zero = self.builder.constant(0.0);
            args[0] = self.builder.select(equal, args[0], zero);
        }
        if op == Op::Shl || op == Op::Shr {
            let by = self.random.u32(0..40);
            args[1] = self.builder.bits_constant(by);
        }
        let value = self.builder.op(op, &args);
        self.values.push((op.result(), value));
    }

    fn begin_fold(&mut self) {
        let schema = Schema {
            name: "row".into(),
            columns: vec!["a".into(), "b".into(), "c".into()],
            parent: self.open.last().map(|open| open.table),
            slots: vec![],
        };
        let table = self.builder.table(schema);
        let choice = self.random.usize(0..FoldKind::ALL.len() * Rule::ALL.len());
        let kind = FoldKind::ALL[choice % FoldKind::ALL.len()];
        let rule = Rule::ALL[choice / FoldKind::ALL.len()];
        let initial: Vec<(Type, Value)> = (0..self.random.usize(1..5))
            .map(|_| {
                let type_ = [Type::Real, Type::Real, Type::Mask, Type::Bits][self.random.usize(0..4)];
                (type_, self.any(type_))
            })
            .collect();
        let values: Vec<Value> = initial.iter().map(|&(_, value)| value).collect();
        let params = self.builder.begin_fold(table, (kind, rule), &values);
        let params: Vec<(Type, Value)> =
            initial.iter().zip(params).map(|(&(type_, _), param)| (type_, param)).collect();
        self.open.push(Open { table, before: self.values.len(), params: params.clone() });
        self.values.extend(params);
    }

    fn end_fold(&mut self) {
        let params = self.open.last().expect("a fold is open").params.clone();
        let next: Vec<Value> = params
            .iter()
            .map(|&(type_, param)| if self.random.u8(0..6) == 0 { param } else { self.recent(type_) })
            .collect();
        let results = self.builder.end_fold(&next);
        let open = self.open.pop().expect("a fold is open");
        self.values.truncate(open.before);
        self.values.extend(params.iter().zip(results).map(|(&(type_, _), result)| (type_, result)));
    }
}

/// Rows for the tables of a random function: some parent rows own none, some rows are not active.
pub fn tables(function: &Function, seed: u64) -> Tables {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut tables = Tables::default();
    for schema in function.tables.values() {
        let parents = schema.parent.map_or(1, |parent| tables.tables[parent].len());
        let mut rows = Rows { stride: schema.columns.len(), starts: vec![0], ..Rows::default() };
        for _ in 0..parents {
            for _ in 0..random.u32(0..4) {
                rows.numbers.extend((0..rows.stride).map(|_| number(&mut random)));
                if random.u8(0..4) > 0 {
                    rows.active.push(u32::try_from(rows.count).expect("there are few rows"));
                }
                rows.count += 1;
            }
            rows.starts.push(u32::try_from(rows.active.len()).expect("there are few rows"));
        }
        tables.tables.push(rows);
    }
    tables.check(function).expect("the rows fit");
    tables
}
