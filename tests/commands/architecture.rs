//! The order of the modules in `lib.rs` is the order of the data: a module
//! uses only those above it.

use std::fs;
use std::path::Path;

use crate::common::in_repository;

/// The modules in the order of `lib.rs`.
fn modules() -> Vec<String> {
    let lib = fs::read_to_string(in_repository("src/lib.rs")).unwrap();
    let module = |line: &str| {
        let name = line.strip_prefix("pub mod ")?.strip_suffix(';')?;
        Some(name.to_owned())
    };
    lib.lines().filter_map(module).collect()
}

/// The modules of the crate that a source text uses.
fn used(text: &str) -> Vec<String> {
    let code = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    let code = code.collect::<Vec<_>>().join("\n");
    let name = |after: &str| -> String {
        after
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    code.split("crate::")
        .skip(1)
        .map(name)
        .filter(|name| !name.is_empty())
        .collect()
}

fn sources(path: &Path, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(path).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push((
                path.display().to_string(),
                fs::read_to_string(&path).unwrap(),
            ));
        }
    }
}

#[test]
fn a_module_uses_only_those_above_it() {
    let modules = modules();
    assert!(modules.len() >= 10, "{modules:?}");
    for (index, module) in modules.iter().enumerate() {
        let mut found = Vec::new();
        let file = in_repository(&format!("src/{module}.rs"));
        match file.exists() {
            true => found.push((module.clone(), fs::read_to_string(file).unwrap())),
            false => sources(&in_repository(&format!("src/{module}")), &mut found),
        }
        assert!(!found.is_empty(), "{module} has no source");
        for (file, text) in found {
            for name in used(&text) {
                let position = modules.iter().position(|other| *other == name);
                let position = position.unwrap_or_else(|| panic!("{file} uses crate::{name}"));
                assert!(
                    position <= index,
                    "{file}: {module} stands above {name} but uses it"
                );
            }
        }
    }
}

#[test]
fn files_and_folders_belong_to_a_module() {
    let modules = modules();
    for entry in fs::read_dir(in_repository("src")).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let known = modules.contains(&stem) || ["lib", "main"].contains(&stem.as_str());
        assert!(known, "{} is not listed in lib.rs", path.display());
    }
}

#[test]
fn the_scan_sees_what_it_should() {
    let text =
        "use crate::yaml::{self, Source};\n// crate::cli is not used\nlet x = crate::film::y();";
    assert_eq!(used(text), ["yaml", "film"]);
}
