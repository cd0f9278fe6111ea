//! Programs that differ only in constants, as one function whose constants are data.
//!
//! The same formula for two materials or two lights mostly is the same program with other numbers: a
//! scene of many materials then has few functions, which its device compiles in a fraction of the
//! time.

use indexmap::IndexMap;

use crate::print::body;
use crate::tape::{Instruction, Operation, Program, TablePlaces, Type};

/// Shares programs of the same structure. Returns the statements of their functions; and for each
/// program the index of its function, and its constants.
pub(crate) fn share(
    programs: &[Program],
    tables: &TablePlaces,
) -> (Vec<String>, Vec<(usize, Vec<u32>)>) {
    // Group the programs by their structure.
    let mut groups: IndexMap<_, Vec<&Program>> = IndexMap::new();
    let group = programs.iter().map(|program| {
        let instructions = program.instructions.iter();
        let structure: Vec<_> = instructions.map(|of| structure(of, tables)).collect();
        let group = groups.entry((structure, &program.results));
        let index = group.index();
        group.or_default().push(program);
        index
    });
    let places: Vec<usize> = group.collect();
    // Find the instructions whose constants differ, and number their words.
    let varying = |group: &Vec<&Program>| -> IndexMap<usize, usize> {
        let (first, mut n_words) = (&group[0].instructions, 0);
        let differs = |&i: &usize| group.iter().any(|of| of.instructions[i] != first[i]);
        let number = |i| {
            let word = n_words;
            n_words += words(&first[i], tables).count();
            (i, word)
        };
        (0..first.len()).filter(differs).map(number).collect()
    };
    let varying: Vec<_> = groups.values().map(varying).collect();
    let shared = groups.values().zip(&varying);
    let statements = shared.map(|(group, varying)| body(group[0], tables, varying));
    let constants = programs.iter().zip(places).map(|(program, place)| {
        let of = varying[place].keys().map(|&i| &program.instructions[i]);
        (place, of.flat_map(|of| words(of, tables)).collect())
    });
    (statements.collect(), constants.collect())
}

/// Returns an instruction without its constant.
fn structure(of: &Instruction, tables: &TablePlaces) -> Instruction {
    let operation = match of.operation {
        Operation::Constant(_) if of.result != Type::Boolean => Operation::Constant(0),
        Operation::LookUp { table, n_values } => {
            let (function, _) = tables[table as usize];
            let same = tables.iter().position(|(other, _)| *other == function);
            Operation::LookUp {
                table: same.unwrap_or(0) as u32,
                n_values,
            }
        }
        other => other,
    };
    Instruction { operation, ..*of }
}

/// Returns the words of an instruction's constant; of a look-up, the place of the table.
fn words(of: &Instruction, tables: &TablePlaces) -> impl Iterator<Item = u32> {
    let (number, n) = match of.operation {
        Operation::Constant(bits) => (bits, if of.result == Type::Double { 2 } else { 1 }),
        Operation::LookUp { table, .. } => (tables[table as usize].1, 2),
        _ => (0, 0),
    };
    [number as u32, (number >> 32) as u32].into_iter().take(n)
}
