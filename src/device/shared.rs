//! Programs that differ only in constants, as one function whose constants are data.
//!
//! The same formula for two materials or two lights mostly is the same program with other numbers: a
//! scene of many materials then has few functions, which its device compiles in a fraction of the
//! time.

use std::collections::HashMap;

use crate::print::body;
use crate::tape::{Instruction, Operation, Program, TablePlaces, Type};

/// Programs of the same structure.
pub(crate) struct SharedProgram {
    /// The first of them.
    program: Program,
    /// The instructions whose constants differ, with the index of the first word of each among the
    /// constants.
    varying: HashMap<usize, usize>,
}

impl SharedProgram {
    /// Returns the statements of the function.
    pub(crate) fn statements(&self, tables: &TablePlaces) -> String {
        body(&self.program, tables, &self.varying)
    }
}

/// Shares programs of the same structure. Returns for each program the index of its shared one, and
/// its constants.
pub(crate) fn share(
    programs: Vec<Program>,
    tables: &TablePlaces,
) -> (Vec<SharedProgram>, Vec<(usize, Vec<u32>)>) {
    // Group the programs by their structure.
    let mut groups: Vec<Vec<Program>> = Vec::new();
    let mut by_structure = HashMap::new();
    let mut places = Vec::new();
    for program in programs {
        let instructions = program.instructions.iter();
        let structure: Vec<_> = instructions.map(|of| structure(of, tables)).collect();
        let group = *by_structure
            .entry((structure, program.results.clone()))
            .or_insert_with(|| {
                groups.push(Vec::new());
                groups.len() - 1
            });
        places.push((group, groups[group].len()));
        groups[group].push(program);
    }
    // Find the constants that differ.
    let varying = |group: &Vec<Program>| -> Vec<usize> {
        let n = group[0].instructions.len();
        let differs = |&i: &usize| {
            let first = group[0].instructions[i];
            group.iter().any(|program| program.instructions[i] != first)
        };
        (0..n).filter(differs).collect()
    };
    let varying: Vec<Vec<usize>> = groups.iter().map(varying).collect();
    let constants = |&(group, member): &(usize, usize)| {
        let instructions = &groups[group][member].instructions;
        let of = varying[group].iter().map(|&i| &instructions[i]);
        (group, of.flat_map(|of| words(of, tables)).collect())
    };
    let constants = places.iter().map(constants).collect();
    // Number their words.
    let shared = groups.into_iter().zip(varying).map(|(group, varying)| {
        let mut n_words = 0;
        let first = &group[0].instructions;
        let words = varying.into_iter().map(|i| {
            let word = n_words;
            n_words += words(&first[i], tables).count();
            (i, word)
        });
        SharedProgram {
            varying: words.collect(),
            program: group.into_iter().next().unwrap_or_default(),
        }
    });
    (shared.collect(), constants)
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
