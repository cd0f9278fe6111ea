//! Formulas as straight programs.
//!
//! A formula that is generic over [`Real`] runs once with [`Register`]s in place of numbers: each
//! operation appends an instruction, and the result is the program that a device runs. So the
//! formula is written once, for lanes, for single numbers and for devices.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use indexmap::IndexMap;
use math::simd::{Arithmetic, DeviceTable, Double, Integer, LookupTable, Mask, Real};

/// The type of a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Type {
    Float,
    Double,
    Unsigned,
    Boolean,
}

/// The operation of an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Operation {
    /// A number of the input, by its index.
    Input(u32),
    /// A number of the primitive that was hit.
    Data(u32),
    /// A number of the instance that was hit.
    Place(u32),
    /// A constant, by its bits.
    Constant(u64),
    Add,
    Subtract,
    Multiply,
    Divide,
    Negate,
    Min,
    Max,
    Sqrt,
    FlipSign,
    Floor,
    Truncate,
    Less,
    LessOrEqual,
    /// The second operand where the first is true, else the third.
    Select,
    And,
    Or,
    Xor,
    Not,
    ShiftLeft(u32),
    ShiftRight(u32),
    /// The same bits as another type.
    Bits,
    /// The nearest number of another type; from float to unsigned, the bits of the whole number.
    Convert,
    /// 0 where the number is less than the second operand.
    ZeroBelow,
    /// Looks up the values of a table at the operands; its result is the first value.
    LookUp {
        /// The table, by its index.
        table: u32,
        n_values: u32,
    },
    /// A further value of a look-up, which is the operand.
    Value(u32),
}

/// An instruction, which writes the register with its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Instruction {
    pub(crate) operation: Operation,
    pub(crate) result: Type,
    /// The operands' registers.
    pub(crate) operands: [Option<u32>; 3],
}

/// Records the instructions of a formula; equal ones once, but for constants.
#[derive(Default)]
pub(crate) struct Tape<'t> {
    instructions: RefCell<Vec<Instruction>>,
    numbers: RefCell<HashMap<Instruction, u32>>,
    /// The tables of all formulas; `None` for formulas that look nothing up.
    tables: Option<&'t Tables>,
    refusal: OnceCell<&'static str>,
}

/// The tables of all formulas: for each its function, and the index of its first word.
pub(crate) type TablePlaces = [(&'static str, u64)];

/// The tables in which formulas look values up; equal ones once.
#[derive(Default)]
pub(crate) struct Tables {
    /// The tables, each with the index of its first word.
    all: RefCell<IndexMap<DeviceTable, u64>>,
}

impl Tables {
    /// Returns the index of a table.
    fn index(&self, table: DeviceTable) -> u32 {
        let mut all = self.all.borrow_mut();
        let last = all.last();
        let first = last.map_or(0, |(table, first)| first + table.words.len() as u64);
        let entry = all.entry(table);
        let index = entry.index() as u32;
        entry.or_insert(first);
        index
    }

    /// Returns the function of each table, and the index of its first word.
    pub(crate) fn all(&self) -> Vec<(&'static str, u64)> {
        let place = |(table, first): (&DeviceTable, &u64)| (table.function, *first);
        self.all.borrow().iter().map(place).collect()
    }

    /// Returns the words of all tables.
    pub(crate) fn into_words(self) -> Vec<u32> {
        let all = self.all.into_inner();
        all.into_keys().flat_map(|table| table.words).collect()
    }
}

/// A formula without loops and branches.
pub(crate) struct Program {
    pub(crate) instructions: Vec<Instruction>,
    /// The registers of its results.
    pub(crate) results: Vec<u32>,
}

/// The result of an instruction.
#[derive(Clone, Copy)]
pub(crate) struct Register<'a> {
    tape: &'a Tape<'a>,
    ty: Type,
    number: u32,
}

impl<'t> Tape<'t> {
    /// Creates a tape of a formula that looks values up in tables.
    pub(crate) fn with_tables(tables: &'t Tables) -> Self {
        Self {
            tables: Some(tables),
            ..Self::default()
        }
    }

    /// Returns the registers of `N` inputs, from number `first` on.
    pub(crate) fn inputs<const N: usize>(&'t self, first: usize) -> [Register<'t>; N] {
        std::array::from_fn(|i| self.leaf(Operation::Input((first + i) as u32)))
    }

    /// Returns the register of a number that no operands make.
    pub(crate) fn leaf(&'t self, operation: Operation) -> Register<'t> {
        self.push(operation, Type::Float, &[])
    }

    /// Returns the reason, in words, if the formula is not a straight program.
    pub(crate) fn refusal(&self) -> Option<&'static str> {
        self.refusal.get().copied()
    }

    /// Returns the program that computes these results.
    pub(crate) fn program(&self, results: &[Register]) -> Program {
        let instructions = self.instructions.borrow();
        // Find the instructions that results depend on.
        let mut is_used = vec![false; instructions.len()];
        for result in results {
            is_used[result.number as usize] = true;
        }
        for (number, instruction) in instructions.iter().enumerate().rev() {
            for operand in instruction.operands.into_iter().flatten() {
                is_used[operand as usize] |= is_used[number];
            }
        }
        // Number these anew.
        let mut numbers = vec![0; instructions.len()];
        let mut kept = Vec::new();
        for (i, &of) in instructions.iter().enumerate().filter(|(i, _)| is_used[*i]) {
            numbers[i] = kept.len() as u32;
            let operands = of.operands.map(|before| Some(numbers[before? as usize]));
            kept.push(Instruction { operands, ..of });
        }
        let results = results.iter().map(|of| numbers[of.number as usize]);
        Program {
            results: results.collect(),
            instructions: kept,
        }
    }

    fn push(&'t self, operation: Operation, ty: Type, operands: &[Register]) -> Register<'t> {
        let instruction = Instruction {
            operation,
            result: ty,
            operands: [0, 1, 2].map(|i| operands.get(i).map(|of| of.number)),
        };
        let append = || {
            let mut instructions = self.instructions.borrow_mut();
            instructions.push(instruction);
            instructions.len() as u32 - 1
        };
        // Each constant anew, so that other constants do not change the structure.
        let number = match operation {
            Operation::Constant(_) => append(),
            _ => *(self.numbers.borrow_mut().entry(instruction)).or_insert_with(append),
        };
        Register {
            tape: self,
            ty,
            number,
        }
    }
}

impl Register<'_> {
    fn constant(self, ty: Type, bits: u64) -> Self {
        self.tape.push(Operation::Constant(bits), ty, &[])
    }
}

/// Implements operators, whose results have the type of their operands.
macro_rules! operators {
    ($($trait:ident::$method:ident($first:ident $(, $second:ident)?) => $operation:ident,)*) => {
        $(impl $trait for Register<'_> {
            type Output = Self;
            fn $method($first: Self $(, $second: Self)?) -> Self {
                let operands = [$first $(, $second)?];
                $first.tape.push(Operation::$operation, $first.ty, &operands)
            }
        })*
    };
}

operators! {
    Add::add(self, other) => Add,
    Sub::sub(self, other) => Subtract,
    Mul::mul(self, other) => Multiply,
    Div::div(self, other) => Divide,
    Neg::neg(self) => Negate,
    BitAnd::bitand(self, other) => And,
    BitOr::bitor(self, other) => Or,
    Not::not(self) => Not,
}

/// Implements methods by an operation and the type of its result.
macro_rules! methods {
    ($($method:ident($first:ident $(, $more:ident)*) => $operation:ident: $result:ident,)*) => {
        $(fn $method($first: Self $(, $more: Self)*) -> Self {
            let operands = [$first $(, $more)*];
            $first.tape.push(Operation::$operation, Type::$result, &operands)
        })*
    };
}

impl Arithmetic for Register<'_> {
    type Mask = Self;

    fn splat(self, value: f32) -> Self {
        self.constant(Type::Float, value.to_bits().into())
    }

    methods! {
        min(self, other) => Min: Float,
        max(self, other) => Max: Float,
        sqrt(self) => Sqrt: Float,
        flip_sign_by(self, other) => FlipSign: Float,
        lt(self, other) => Less: Boolean,
        le(self, other) => LessOrEqual: Boolean,
        select(mask, this, other) => Select: Float,
    }
}

/// A straight program has no branches on lanes.
impl Mask for Register<'_> {
    fn bits(self) -> u8 {
        self.tape.refusal.get_or_init(|| "bits of masks");
        0
    }

    fn all(self) -> bool {
        false
    }

    fn none(self) -> bool {
        false
    }
}

impl Real for Register<'_> {
    type Integer = Self;
    type Double = Self;

    methods! {
        floor(self) => Floor: Float,
        trunc(self) => Truncate: Float,
        to_integer_bits(self) => Bits: Unsigned,
        to_integer(self) => Convert: Unsigned,
        to_double(self) => Convert: Double,
        from_integer(integer) => Convert: Float,
        from_integer_bits(bits) => Bits: Float,
        from_double(double) => Convert: Float,
    }

    fn next_index(self, _: Self, least: usize) -> Option<usize> {
        Some(least)
    }

    fn look_up<const N: usize, const M: usize, T: LookupTable<N, M> + ?Sized>(
        table: &T,
        at: [Self; N],
    ) -> [Self; M] {
        const { assert!(0 < N && N <= 3) }
        let tape = at[0].tape;
        let tables = tape.tables.ok_or("a look-up");
        let found = tables.and_then(|tables| Ok(tables.index(table.on_device()?)));
        let table = found.unwrap_or_else(|reason| {
            tape.refusal.get_or_init(|| reason);
            0
        });
        let n_values = M as u32;
        let look_up = Operation::LookUp { table, n_values };
        let first = tape.push(look_up, Type::Float, &at);
        std::array::from_fn(|i| match i {
            0 => first,
            _ => tape.push(Operation::Value(i as u32), Type::Float, &[first]),
        })
    }
}

impl Integer for Register<'_> {
    fn splat(self, value: u32) -> Self {
        self.constant(Type::Unsigned, value.into())
    }

    methods! {
        plus(self, other) => Add: Unsigned,
        times(self, other) => Multiply: Unsigned,
        and(self, other) => And: Unsigned,
        xor(self, other) => Xor: Unsigned,
    }

    fn shift_left<const N: i32>(self) -> Self {
        let shift = Operation::ShiftLeft(N as u32);
        self.tape.push(shift, Type::Unsigned, &[self])
    }

    fn shift_right<const N: i32>(self) -> Self {
        let shift = Operation::ShiftRight(N as u32);
        self.tape.push(shift, Type::Unsigned, &[self])
    }
}

impl Double for Register<'_> {
    fn splat(self, value: f64) -> Self {
        self.constant(Type::Double, value.to_bits())
    }

    fn zero_below(self, limit: f64) -> Self {
        let operands = [self, Double::splat(self, limit)];
        self.tape
            .push(Operation::ZeroBelow, Type::Double, &operands)
    }
}

#[cfg(test)]
impl Program {
    /// Checks that the results for these numbers are the expected ones, to the bit but for NaN.
    pub(crate) fn check(&self, input: [&[f32]; 3], expected: &[f32]) -> Result<(), String> {
        let found = self.evaluate(input);
        let is_same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
        let are_same = found.len() == expected.len() && found.iter().zip(expected).all(is_same);
        let difference = || format!("{found:?} is not {expected:?}");
        are_same.then_some(()).ok_or_else(difference)
    }

    /// Computes the results for these numbers, one instruction after the other; not with tables.
    ///
    /// The numbers are inputs, then the primitive's and the instance's.
    fn evaluate(&self, input: [&[f32]; 3]) -> Vec<f32> {
        let mut registers: Vec<u64> = Vec::new();
        for instruction in &self.instructions {
            let operands = instruction.operands.map(|of| of.unwrap_or(0) as usize);
            let ty = self.instructions[operands[0]].result;
            let bits = operands.map(|i| registers.get(i).copied().unwrap_or(0));
            registers.push(instruction.evaluate(input, ty, bits));
        }
        let bits = self.results.iter().map(|&i| registers[i as usize]);
        bits.map(|bits| f32::from_bits(bits as u32)).collect()
    }
}

#[cfg(test)]
impl Instruction {
    /// Returns the bits of the result, given the type of the first operand and the bits of all.
    fn evaluate(&self, input: [&[f32]; 3], ty: Type, [a, b, c]: [u64; 3]) -> u64 {
        let number = |of: usize, i: u32| u64::from(input[of][i as usize].to_bits());
        let [i, j] = [a as u32, b as u32];
        let [x, y] = [i, j].map(f32::from_bits);
        let [u, v] = [a, b].map(f64::from_bits);
        let float = match (self.operation, ty) {
            (Operation::Input(i), _) => return number(0, i),
            (Operation::Data(i), _) => return number(1, i),
            (Operation::Place(i), _) => return number(2, i),
            (Operation::Constant(bits), _) => return bits,
            (Operation::Select, _) => return if a == 0 { c } else { b },
            (Operation::Bits, _) => return a,
            (Operation::And, Type::Boolean | Type::Unsigned) => return a & b,
            (Operation::Or, Type::Boolean) => return a | b,
            (Operation::Not, Type::Boolean) => return a ^ 1,
            (Operation::Xor, Type::Unsigned) => return a ^ b,
            (Operation::Add, Type::Unsigned) => return i.plus(j).into(),
            (Operation::Multiply, Type::Unsigned) => return i.times(j).into(),
            (Operation::ShiftLeft(n), Type::Unsigned) => return (i << n).into(),
            (Operation::ShiftRight(n), Type::Unsigned) => return (i >> n).into(),
            (Operation::Multiply, Type::Double) => return (u * v).to_bits(),
            (Operation::ZeroBelow, Type::Double) => return u.zero_below(v).to_bits(),
            (Operation::Less, Type::Float) => return (x < y).into(),
            (Operation::LessOrEqual, Type::Float) => return (x <= y).into(),
            (Operation::Convert, Type::Float) => match self.result {
                Type::Double => return f64::from(x).to_bits(),
                _ => return Real::to_integer(x).into(),
            },
            (Operation::Convert, Type::Unsigned) => f32::from_integer(i),
            (Operation::Convert, Type::Double) => u as f32,
            (Operation::Add, Type::Float) => x + y,
            (Operation::Subtract, Type::Float) => x - y,
            (Operation::Multiply, Type::Float) => x * y,
            (Operation::Divide, Type::Float) => x / y,
            (Operation::Negate, Type::Float) => -x,
            (Operation::Min, Type::Float) => Arithmetic::min(x, y),
            (Operation::Max, Type::Float) => Arithmetic::max(x, y),
            (Operation::Sqrt, Type::Float) => x.sqrt(),
            (Operation::FlipSign, Type::Float) => x.flip_sign_by(y),
            (Operation::Floor, Type::Float) => Real::floor(x),
            (Operation::Truncate, Type::Float) => Real::trunc(x),
            (other, ty) => panic!("{other:?} of {ty:?}"),
        };
        float.to_bits().into()
    }
}

#[cfg(test)]
mod tests {
    use math::optics::{AlbedoByRoughness, Masking};

    use super::*;

    #[test]
    fn look_ups_that_devices_do_not_have_are_named_in_words() {
        let tables = Tables::default();
        let tape = Tape::with_tables(&tables);
        let table = AlbedoByRoughness::with_masking(Masking::Separable);
        Register::look_up(table, tape.inputs(0));
        let part = "a picture of roughness with multiple scattering";
        assert_eq!(tape.refusal(), Some(part));
    }
}
