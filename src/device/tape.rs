//! Formulas as straight programs.
//!
//! A formula that is generic over [`Real`] runs once with [`Register`]s in place of numbers: each
//! operation appends an instruction, and the result is the program that a device runs. So the
//! formula is written once, for lanes, for single numbers and for devices.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use math::simd::{Arithmetic, Double, Integer, LookupTable, Mask, Real};

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
}

/// An instruction, which writes the register with its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Instruction {
    pub(crate) operation: Operation,
    pub(crate) result: Type,
    /// The operands' registers, as many as the operation has.
    pub(crate) operands: [u32; 3],
}

/// Records the instructions of a formula; equal ones once.
#[derive(Default)]
pub(crate) struct Tape {
    instructions: RefCell<Vec<Instruction>>,
    numbers: RefCell<HashMap<Instruction, u32>>,
}

/// A formula without loops and branches.
pub(crate) struct Program {
    pub(crate) name: String,
    pub(crate) instructions: Vec<Instruction>,
    /// The registers of its results.
    pub(crate) results: Vec<u32>,
}

/// The result of an instruction.
#[derive(Clone, Copy)]
pub(crate) struct Register<'a> {
    tape: &'a Tape,
    ty: Type,
    number: u32,
}

impl Tape {
    /// Returns the registers of `N` inputs, from number `first` on.
    pub(crate) fn inputs<const N: usize>(&self, first: usize) -> [Register<'_>; N] {
        std::array::from_fn(|i| {
            let input = Operation::Input((first + i) as u32);
            self.push(input, Type::Float, [0; 3])
        })
    }

    /// Returns the program of this name that computes these results.
    pub(crate) fn program(&self, name: impl Into<String>, results: &[Register]) -> Program {
        Program {
            name: name.into(),
            instructions: self.instructions.borrow().clone(),
            results: results.iter().map(|result| result.number).collect(),
        }
    }

    fn push(&self, operation: Operation, result: Type, operands: [u32; 3]) -> Register<'_> {
        let instruction = Instruction {
            operation,
            result,
            operands,
        };
        let mut instructions = self.instructions.borrow_mut();
        let mut numbers = self.numbers.borrow_mut();
        let number = *numbers.entry(instruction).or_insert_with(|| {
            instructions.push(instruction);
            instructions.len() as u32 - 1
        });
        Register {
            tape: self,
            ty: result,
            number,
        }
    }
}

impl Register<'_> {
    fn constant(self, ty: Type, bits: u64) -> Self {
        self.tape.push(Operation::Constant(bits), ty, [0; 3])
    }

    fn unary(self, operation: Operation, result: Type) -> Self {
        self.tape.push(operation, result, [self.number, 0, 0])
    }

    fn binary(self, operation: Operation, other: Self, result: Type) -> Self {
        let operands = [self.number, other.number, 0];
        self.tape.push(operation, result, operands)
    }

    /// Records an operation whose result has the type of its operands.
    fn with(self, operation: Operation, other: Self) -> Self {
        self.binary(operation, other, self.ty)
    }
}

/// Implements an operator by an operation.
macro_rules! operators {
    ($($trait:ident::$method:ident => $operation:ident,)*) => {
        $(impl $trait for Register<'_> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.with(Operation::$operation, other)
            }
        })*
    };
}

operators! {
    Add::add => Add,
    Sub::sub => Subtract,
    Mul::mul => Multiply,
    Div::div => Divide,
    BitAnd::bitand => And,
    BitOr::bitor => Or,
}

impl Neg for Register<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Operation::Negate, self.ty)
    }
}

impl Not for Register<'_> {
    type Output = Self;
    fn not(self) -> Self {
        self.unary(Operation::Not, self.ty)
    }
}

impl Arithmetic for Register<'_> {
    type Mask = Self;

    fn splat(self, value: f32) -> Self {
        self.constant(Type::Float, value.to_bits().into())
    }

    fn min(self, other: Self) -> Self {
        self.with(Operation::Min, other)
    }

    fn max(self, other: Self) -> Self {
        self.with(Operation::Max, other)
    }

    fn sqrt(self) -> Self {
        self.unary(Operation::Sqrt, self.ty)
    }

    fn flip_sign_by(self, other: Self) -> Self {
        self.with(Operation::FlipSign, other)
    }

    fn lt(self, other: Self) -> Self {
        self.binary(Operation::Less, other, Type::Boolean)
    }

    fn le(self, other: Self) -> Self {
        self.binary(Operation::LessOrEqual, other, Type::Boolean)
    }

    fn select(mask: Self, this: Self, other: Self) -> Self {
        let operands = [mask.number, this.number, other.number];
        mask.tape.push(Operation::Select, this.ty, operands)
    }
}

/// A straight program has no branches on lanes.
impl Mask for Register<'_> {
    fn bits(self) -> u8 {
        unreachable!("recorded formulas read no bits of masks")
    }

    fn all(self) -> bool {
        false
    }
}

impl Real for Register<'_> {
    type Integer = Self;
    type Double = Self;

    fn floor(self) -> Self {
        self.unary(Operation::Floor, self.ty)
    }

    fn trunc(self) -> Self {
        self.unary(Operation::Truncate, self.ty)
    }

    fn to_integer_bits(self) -> Self {
        self.unary(Operation::Bits, Type::Unsigned)
    }

    fn to_integer(self) -> Self {
        self.unary(Operation::Convert, Type::Unsigned)
    }

    fn to_double(self) -> Self {
        self.unary(Operation::Convert, Type::Double)
    }

    fn from_integer(integer: Self) -> Self {
        integer.unary(Operation::Convert, Type::Float)
    }

    fn from_integer_bits(bits: Self) -> Self {
        bits.unary(Operation::Bits, Type::Float)
    }

    fn from_double(double: Self) -> Self {
        double.unary(Operation::Convert, Type::Float)
    }

    fn lane(self, _: usize) -> f32 {
        unreachable!("recorded formulas read no lanes")
    }

    fn look_up<const N: usize, const M: usize, T: LookupTable<N, M> + ?Sized>(
        _: &T,
        _: [Self; N],
    ) -> [Self; M] {
        unreachable!("recorded formulas look nothing up")
    }
}

impl Integer for Register<'_> {
    fn splat(self, value: u32) -> Self {
        self.constant(Type::Unsigned, value.into())
    }

    fn plus(self, other: Self) -> Self {
        self.with(Operation::Add, other)
    }

    fn times(self, other: Self) -> Self {
        self.with(Operation::Multiply, other)
    }

    fn and(self, other: Self) -> Self {
        self.with(Operation::And, other)
    }

    fn xor(self, other: Self) -> Self {
        self.with(Operation::Xor, other)
    }

    fn shift_left<const N: i32>(self) -> Self {
        self.unary(Operation::ShiftLeft(N as u32), self.ty)
    }

    fn shift_right<const N: i32>(self) -> Self {
        self.unary(Operation::ShiftRight(N as u32), self.ty)
    }
}

impl Double for Register<'_> {
    fn splat(self, value: f64) -> Self {
        self.constant(Type::Double, value.to_bits())
    }

    fn zero_below(self, limit: f64) -> Self {
        let limit = Double::splat(self, limit);
        self.with(Operation::ZeroBelow, limit)
    }

    fn map(self, _: impl Fn(f64) -> f64) -> Self {
        unreachable!("recorded formulas call no functions")
    }
}

#[cfg(test)]
impl Program {
    /// Computes the results for these numbers, one instruction after the other.
    pub(crate) fn evaluate(&self, input: &[f32]) -> Vec<f32> {
        let mut registers: Vec<u64> = Vec::new();
        for instruction in &self.instructions {
            registers.push(instruction.evaluate(input, &registers));
        }
        let results = self.results.iter();
        results
            .map(|&number| f32::from_bits(registers[number as usize] as u32))
            .collect()
    }
}

#[cfg(test)]
impl Instruction {
    /// Returns the bits of the result, given the bits of the registers before it; of numbers in
    /// single precision.
    fn evaluate(&self, input: &[f32], registers: &[u64]) -> u64 {
        let bits = |i: usize| registers[self.operands[i] as usize];
        let number = |i: usize| f32::from_bits(bits(i) as u32);
        let float = |value: f32| u64::from(value.to_bits());
        // Operands that an instruction has not are register 0.
        let [x, y] = [0, 1].map(|i| if registers.is_empty() { 0.0 } else { number(i) });
        match self.operation {
            Operation::Input(i) => float(input[i as usize]),
            Operation::Constant(bits) => bits,
            Operation::Add => float(x + y),
            Operation::Subtract => float(x - y),
            Operation::Multiply => float(x * y),
            Operation::Divide => float(x / y),
            Operation::Negate => float(-x),
            Operation::Min => float(Arithmetic::min(x, y)),
            Operation::Max => float(Arithmetic::max(x, y)),
            Operation::Sqrt => float(x.sqrt()),
            Operation::FlipSign => float(x.flip_sign_by(y)),
            Operation::Less => (x < y).into(),
            Operation::LessOrEqual => (x <= y).into(),
            Operation::Select => bits(if bits(0) == 0 { 2 } else { 1 }),
            Operation::And => bits(0) & bits(1),
            Operation::Or => bits(0) | bits(1),
            Operation::Not => bits(0) ^ 1,
            other => panic!("no shape has {other:?}"),
        }
    }
}
