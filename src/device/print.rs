//! A straight program → a function of the device's language.

use std::fmt::Write;

use indexmap::IndexMap;

use crate::tape::{Instruction, Operation, Program, TablePlaces, Type};

/// Returns the text of a program as a function of this name, which reads its numbers from `in` and
/// writes its results to `out`.
pub(crate) fn function(name: &str, program: &Program) -> String {
    let body = body(program, &[], &IndexMap::new());
    format!("FUNCTION void {name}(const float *in, float *out) {{\n{body}}}\n")
}

/// Returns the statements of a program's function. The tables have these functions and first words;
/// instructions that are `varying` read their constant from `constants`, from this word on.
pub(crate) fn body(
    program: &Program,
    tables: &TablePlaces,
    varying: &IndexMap<usize, usize>,
) -> String {
    let instructions = &program.instructions;
    let mut text = String::new();
    for (number, instruction) in instructions.iter().enumerate() {
        let word = varying.get(&number);
        if let Operation::LookUp { table, n_values } = instruction.operation {
            let (function, first) = tables[table as usize];
            let first = constant(first, true, word);
            let at = instruction.operands.iter().flatten();
            let at: Vec<_> = at.map(|operand| format!("r{operand}")).collect();
            let _ = writeln!(
                text,
                "  float at{number}[] = {{{}}}, found{number}[{n_values}];
  {function}(tables + {first}, {n_values}, at{number}, found{number});",
                at.join(", ")
            );
        }
        let value = expression(instructions, number, word);
        let ty = name_of(instruction.result);
        let _ = writeln!(text, "  {ty} r{number} = {value};");
    }
    for (i, result) in program.results.iter().enumerate() {
        let _ = writeln!(text, "  out[{i}] = r{result};");
    }
    text
}

/// Returns a number of one or two words: these bits, or from this word of `constants` on.
fn constant(bits: u64, is_wide: bool, word: Option<&usize>) -> String {
    match (word, is_wide) {
        (None, false) => format!("0x{bits:x}u"),
        (None, true) => format!("0x{bits:x}ul"),
        (Some(word), false) => format!("constants[{word}]"),
        (Some(word), true) => {
            let upper = word + 1;
            format!("((ulong)constants[{upper}] << 32 | constants[{word}])")
        }
    }
}

fn name_of(ty: Type) -> &'static str {
    match ty {
        Type::Float => "float",
        Type::Double => "double",
        Type::Unsigned => "uint",
        Type::Boolean => "int",
    }
}

/// Returns the value of instruction `number`, a constant from this word on if there is one.
fn expression(instructions: &[Instruction], number: usize, word: Option<&usize>) -> String {
    let instruction = &instructions[number];
    let operands = instruction.operands.map(|operand| operand.unwrap_or(0));
    let ([first, ..], [a, b, c]) = (operands, operands.map(|number| format!("r{number}")));
    let result = instruction.result;
    let operand = instructions[first as usize].result;
    match instruction.operation {
        Operation::Input(i) => format!("in[{i}]"),
        Operation::Data(i) => format!("FLOAT_OF(data[{i}])"),
        Operation::Place(i) => format!("FLOAT_OF(place[{i}])"),
        Operation::LookUp { .. } => format!("found{number}[0]"),
        Operation::Value(i) => format!("found{first}[{i}]"),
        Operation::Constant(bits) => match (result, constant(bits, result == Type::Double, word)) {
            (Type::Float, bits) => format!("FLOAT_OF({bits})"),
            (Type::Double, bits) => format!("DOUBLE_OF({bits})"),
            (Type::Unsigned | Type::Boolean, bits) => bits,
        },
        Operation::Add => format!("{a} + {b}"),
        Operation::Subtract => format!("{a} - {b}"),
        Operation::Multiply => format!("{a} * {b}"),
        Operation::Divide => format!("{a} / {b}"),
        Operation::Negate => format!("-{a}"),
        Operation::Min => format!("{a} < {b} ? {a} : {b}"),
        Operation::Max => format!("{a} > {b} ? {a} : {b}"),
        Operation::Sqrt => format!("sqrt({a})"),
        Operation::FlipSign => {
            format!("FLOAT_OF(BITS_OF({a}) ^ (BITS_OF({b}) & 0x80000000u))")
        }
        Operation::Floor => format!("floor({a})"),
        Operation::Truncate => format!("trunc({a})"),
        Operation::Less => format!("{a} < {b}"),
        Operation::LessOrEqual => format!("{a} <= {b}"),
        Operation::Select => format!("{a} ? {b} : {c}"),
        Operation::And => format!("{a} & {b}"),
        Operation::Or => format!("{a} | {b}"),
        Operation::Xor => format!("{a} ^ {b}"),
        Operation::Not => format!("!{a}"),
        Operation::ShiftLeft(n) => format!("{a} << {n}"),
        Operation::ShiftRight(n) => format!("{a} >> {n}"),
        Operation::Bits if result == Type::Float => format!("FLOAT_OF({a})"),
        Operation::Bits => format!("BITS_OF({a})"),
        Operation::Convert => match (operand, result) {
            (Type::Float, Type::Unsigned) => format!("(uint)(int){a}"),
            (Type::Unsigned, _) => format!("(float)(int){a}"),
            _ => format!("({}){a}", name_of(result)),
        },
        Operation::ZeroBelow => format!("{a} < {b} ? 0.0 : {a}"),
    }
}
