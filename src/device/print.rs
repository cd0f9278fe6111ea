//! A straight program → a function of the device's language.

use std::collections::HashMap;
use std::fmt::Write;

use crate::tape::{Instruction, Operation, Program, TablePlaces, Type};

/// Returns the text of a program as a function, which reads its numbers from `in` and writes its
/// results to `out`.
pub(crate) fn function(program: &Program) -> String {
    let body = body(program, &[], &HashMap::new());
    format!(
        "FUNCTION void {}(const float *in, float *out) {{\n{body}}}\n",
        program.name
    )
}

/// Returns the statements of a program's function. The tables have these functions and first words;
/// instructions that are `varying` read their constant from `constants`, from this word on.
pub(crate) fn body(
    program: &Program,
    tables: &TablePlaces,
    varying: &HashMap<usize, usize>,
) -> String {
    let Program {
        instructions,
        results,
        ..
    } = program;
    let mut text = String::new();
    for (number, instruction) in instructions.iter().enumerate() {
        let word = varying.get(&number);
        if let Operation::LookUp { table, sizes } = instruction.operation {
            let (function, first) = tables[table as usize];
            let first = word.map_or_else(|| format!("{first}ul"), |word| wide(*word));
            text += &look_up(number, &instruction.operands, (function, &first), sizes);
        }
        let value = match (instruction.operation, instruction.result, word) {
            (Operation::Constant(_), Type::Float, Some(word)) => {
                format!("FLOAT_OF(constants[{word}])")
            }
            (Operation::Constant(_), Type::Double, Some(word)) => {
                format!("DOUBLE_OF({})", wide(*word))
            }
            (Operation::Constant(_), _, Some(word)) => format!("constants[{word}]"),
            _ => expression(instructions, number),
        };
        let ty = name_of(instruction.result);
        let _ = writeln!(text, "  {ty} r{number} = {value};");
    }
    for (i, result) in results.iter().enumerate() {
        let _ = writeln!(text, "  out[{i}] = r{result};");
    }
    text
}

/// Returns two words of the constants as one number.
fn wide(word: usize) -> String {
    let upper = word + 1;
    format!("((ulong)constants[{upper}] << 32 | constants[{word}])")
}

/// Returns the statements that call the function of a table for instruction `number`.
fn look_up(
    number: usize,
    operands: &[u32; 3],
    (function, first): (&str, &str),
    [n_at, n_values]: [u32; 2],
) -> String {
    let mut text = format!("  float at{number}[{n_at}], found{number}[{n_values}];\n");
    for (i, operand) in operands[..n_at as usize].iter().enumerate() {
        let _ = writeln!(text, "  at{number}[{i}] = r{operand};");
    }
    let _ = writeln!(
        text,
        "  {function}(tables + {first}, {n_values}, at{number}, found{number});"
    );
    text
}

fn name_of(ty: Type) -> &'static str {
    match ty {
        Type::Float => "float",
        Type::Double => "double",
        Type::Unsigned => "uint",
        Type::Boolean => "int",
    }
}

/// Returns the value of instruction `number`.
fn expression(instructions: &[Instruction], number: usize) -> String {
    let instruction = &instructions[number];
    let [a, b, c] = instruction.operands.map(|number| format!("r{number}"));
    let result = instruction.result;
    let operand = instructions[instruction.operands[0] as usize].result;
    match instruction.operation {
        Operation::Input(i) if result == Type::Unsigned => format!("BITS_OF(in[{i}])"),
        Operation::Input(i) => format!("in[{i}]"),
        Operation::Data(i) => format!("FLOAT_OF(data[{i}])"),
        Operation::Place(i) => format!("FLOAT_OF(place[{i}])"),
        Operation::LookUp { .. } => format!("found{number}[0]"),
        Operation::Value(i) => format!("found{}[{i}]", instruction.operands[0]),
        Operation::Constant(bits) => match result {
            Type::Float => format!("FLOAT_OF(0x{bits:x}u)"),
            Type::Double => format!("DOUBLE_OF(0x{bits:x}ul)"),
            Type::Unsigned | Type::Boolean => format!("{bits}u"),
        },
        Operation::Add => format!("{a} + {b}"),
        Operation::Subtract => format!("{a} - {b}"),
        Operation::Multiply => format!("{a} * {b}"),
        Operation::Divide => format!("{a} / {b}"),
        Operation::Negate => format!("-{a}"),
        Operation::Min => format!("{a} < {b} ? {a} : {b}"),
        Operation::Max => format!("{a} > {b} ? {a} : {b}"),
        Operation::Sqrt => format!("SQRT({a})"),
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
