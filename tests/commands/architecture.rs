//! The crates stand in the order of the data, and so do the modules of each: a module uses
//! only those above it. (The compiler holds the crates apart.) Inside a folder no files use
//! each other in a circle. Each name means one type.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::in_repository;

/// The folders of the crates in the order of `Cargo.toml`; the program's is the last.
fn crates() -> Vec<PathBuf> {
    let manifest = fs::read_to_string(in_repository("Cargo.toml")).unwrap();
    let (_, members) = manifest.split_once("\nmembers = [").unwrap();
    let (members, _) = members.split_once(']').unwrap();
    let folders = members.split('"').skip(1).step_by(2);
    folders.chain(["src"]).map(in_repository).collect()
}

/// The modules of a crate in the order of its `lib.rs`.
fn modules(folder: &Path) -> Vec<String> {
    declared(&fs::read_to_string(folder.join("lib.rs")).unwrap())
}

/// The Rust files of a module of a crate.
fn sources(folder: &Path, module: &str) -> Vec<PathBuf> {
    let file = folder.join(module).with_extension("rs");
    if file.exists() {
        vec![file]
    } else {
        files(&folder.join(module))
    }
}

/// The modules that a source text declares.
fn declared(text: &str) -> Vec<String> {
    let name = |line: &str| {
        let (_, name) = line.split_once("mod ")?;
        let is_item = line.starts_with("mod ") || line.starts_with("pub");
        Some(name.strip_suffix(';')?.to_owned()).filter(|_| is_item)
    };
    text.lines().filter_map(name).collect()
}

/// All Rust files below a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// The code of a file without comments, and without its unit tests.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    let uncommented = |line: &str| line.split("//").next().unwrap().to_owned();
    text.lines().map(uncommented).collect::<Vec<_>>().join("\n")
}

/// The paths in the code that begin with this word, such as `crate`, without it.
/// A tree in braces gives a path for each leaf.
fn paths(code: &str, root: &str) -> Vec<String> {
    let begin = format!("{root}::");
    let mut found = Vec::new();
    for (at, _) in code.match_indices(&begin) {
        let before = code[..at].chars().next_back();
        if !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
            leaves("", &code[at + begin.len()..], &mut found);
        }
    }
    found
}

/// Adds the paths of a tree that stands at the start of `code`, and returns the
/// code behind it.
fn leaves<'c>(before: &str, code: &'c str, found: &mut Vec<String>) -> &'c str {
    let Some(mut rest) = code.strip_prefix('{') else {
        let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        let end = code.find(|c| !is_path(c)).unwrap_or(code.len());
        let (path, rest) = code.split_at(end);
        if path.ends_with("::") && rest.starts_with('{') {
            return leaves(&format!("{before}{path}"), rest, found);
        }
        found.push(format!("{before}{path}"));
        return rest;
    };
    loop {
        rest = rest.trim_start_matches(|c: char| c.is_whitespace() || c == ',');
        if let Some(behind) = rest.strip_prefix('}') {
            return behind;
        }
        let behind = leaves(before, rest, found);
        // Over ` as name`.
        let end = behind.find([',', '}']).expect("a closing brace");
        rest = &behind[end..];
    }
}

fn first(path: &str) -> &str {
    path.split("::").next().unwrap()
}

#[test]
fn a_crate_uses_only_those_above_it() {
    let crates = crates();
    assert_eq!(crates.len(), 13);
    let names = crates.iter().map(|folder| folder.file_name().unwrap());
    let names: Vec<&str> = names.map(|name| name.to_str().unwrap()).collect();
    for (index, folder) in crates.iter().take(crates.len() - 1).enumerate() {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        // Tests of a crate may read its types from YAML.
        let (dependencies, _) = manifest
            .split_once("[dev-dependencies]")
            .unwrap_or((&manifest, ""));
        for line in dependencies.lines() {
            let used = line.strip_prefix("raycost-");
            let used = used.and_then(|line| line.split_once('.'));
            if let Some((used, _)) = used {
                let name = names[index];
                assert!(names[..index].contains(&used), "{name} uses {used}");
            }
        }
    }
}

#[test]
fn a_module_uses_only_those_above_it() {
    for folder in crates() {
        let modules = modules(&folder);
        for (index, module) in modules.iter().enumerate() {
            let sources = sources(&folder, module);
            assert!(!sources.is_empty(), "{module} has no source");
            for file in sources {
                let text = fs::read_to_string(&file)
                    .unwrap()
                    .replace("#[cfg(test)]", "");
                for path in paths(&code(&text), "crate") {
                    let name = first(&path);
                    let position = modules.iter().position(|other| other == name);
                    // What `lib.rs` gives out is not a module.
                    assert!(
                        position.is_none_or(|position| position <= index),
                        "{}: {module} stands above {name} but uses it",
                        file.display()
                    );
                }
            }
        }
    }
}

/// The files and folders in a folder by their names, and those that each uses.
fn uses_within(folder: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let face = code(&fs::read_to_string(folder.join("mod.rs")).unwrap());
    let names = declared(&face);
    // What `mod.rs` gives out, and the file that it is from.
    let mut origins = BTreeMap::new();
    for name in &names {
        for path in paths(&face, name) {
            let item = path.rsplit("::").next().unwrap().to_owned();
            origins.insert(item, name.clone());
        }
    }
    let of_crate = folder.ancestors().find(|path| path.join("lib.rs").exists());
    let place = folder.strip_prefix(of_crate.unwrap()).unwrap();
    let parts: Vec<&str> = place.iter().map(|part| part.to_str().unwrap()).collect();
    let inside = format!("{}::", parts.join("::"));
    let mut uses = BTreeMap::new();
    for name in &names {
        let mut used = BTreeSet::new();
        let file = folder.join(format!("{name}.rs"));
        let sources = if file.exists() {
            vec![(file, 1)]
        } else {
            let within = folder.join(name);
            let depth = |file: &PathBuf| {
                let n = file.strip_prefix(folder).unwrap().iter().count();
                n - usize::from(file.ends_with("mod.rs"))
            };
            let found = files(&within).into_iter();
            found.map(|file| (file.clone(), depth(&file))).collect()
        };
        for (file, depth) in sources {
            let code = code(&fs::read_to_string(file).unwrap());
            let relative = paths(&code, &vec!["super"; depth].join("::"));
            let absolute = paths(&code, "crate").into_iter();
            let absolute = absolute.filter_map(|path| Some(path.strip_prefix(&inside)?.to_owned()));
            for path in relative.into_iter().chain(absolute) {
                let item = first(&path);
                let from = if names.iter().any(|name| name == item) {
                    Some(item)
                } else {
                    origins.get(item).map(String::as_str)
                };
                used.extend(from.filter(|from| from != name).map(str::to_owned));
            }
        }
        uses.insert(name.clone(), used);
    }
    uses
}

/// A circle in the graph, if there is one: each uses the next, the last the first.
fn circle(uses: &BTreeMap<String, BTreeSet<String>>) -> Option<Vec<String>> {
    fn visit(
        name: &str,
        uses: &BTreeMap<String, BTreeSet<String>>,
        path: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> Option<Vec<String>> {
        if let Some(begin) = path.iter().position(|other| other == name) {
            return Some(path[begin..].to_vec());
        }
        if !done.contains(name) {
            path.push(name.to_owned());
            let below = uses.get(name).into_iter().flatten();
            for next in below {
                if let Some(circle) = visit(next, uses, path, done) {
                    return Some(circle);
                }
            }
            path.pop();
            done.insert(name.to_owned());
        }
        None
    }
    let mut done = BTreeSet::new();
    uses.keys()
        .find_map(|name| visit(name, uses, &mut Vec::new(), &mut done))
}

#[test]
fn no_files_of_a_folder_use_each_other_in_a_circle() {
    let faces = files(&in_repository("src")).into_iter();
    let folders = faces.filter(|file| file.ends_with("mod.rs"));
    let circles: Vec<String> = folders
        .filter_map(|face| {
            let folder = face.parent().unwrap();
            let circle = circle(&uses_within(folder))?;
            Some(format!("{}: {}", folder.display(), circle.join(" -> ")))
        })
        .collect();
    assert!(circles.is_empty(), "{circles:#?}");
}

#[test]
fn files_and_folders_belong_to_a_module() {
    let crates = crates();
    for folder in &crates {
        let modules = modules(folder);
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let known = modules.contains(&stem)
                || ["lib", "main", "Cargo", "README"].contains(&stem.as_str())
                || crates.contains(&path);
            assert!(known, "{} is not listed in lib.rs", path.display());
        }
    }
}

/// Where files are opened in another way: the one place of all others, folders, what the system
/// says of itself, and HDF5, which opens a path itself once it is known to be a regular file.
const OPENERS: [&str; 7] = [
    "host/files.rs",
    "host/folder/disk.rs",
    "host/folder/lock.rs",
    "host/affinity.rs",
    "host/cgroup.rs",
    "render/instruments/memory_benchmark.rs",
    "import/vtk/hdf/data_set.rs",
];

/// A FIFO or a device in the place of a file would let a program wait, or read without an end.
#[test]
fn only_one_place_opens_files() {
    let calls = [
        "File::open(",
        "File::options(",
        "fs::read(",
        "fs::read_to_string(",
    ];
    let opens = |line: &&str| {
        let other = |(before, behind): (&str, &str)| {
            let is_longer_name = before.ends_with(|c: char| c.is_alphanumeric());
            !is_longer_name && !behind.starts_with("\"/proc/")
        };
        calls
            .iter()
            .filter_map(|call| line.split_once(call))
            .any(other)
    };
    for path in files(&in_repository("src")) {
        let within = path.strip_prefix(in_repository("src")).unwrap();
        let is_of_tests = within
            .iter()
            .any(|part| part == "tests" || part == "tests.rs");
        if is_of_tests || OPENERS.iter().any(|opener| within == Path::new(opener)) {
            continue;
        }
        let code = code(&fs::read_to_string(&path).unwrap());
        let found: Vec<&str> = code.lines().filter(opens).collect();
        assert!(found.is_empty(), "{}: {found:#?}", path.display());
        let count = |word| code.matches(word).count();
        let [made, used] = ["OpenOptions::new()", "files::open_to_change("].map(count);
        assert_eq!(made, used, "{}", path.display());
    }
    assert!(opens(&"    let file = File::open(path)?;") && !opens(&"CheckpointFile::open(path)"));
}

/// The name of the type that a line defines outside other items.
fn defined_type(line: &str) -> Option<&str> {
    let item = if line.starts_with("pub(") {
        line.split_once(") ")?.1
    } else {
        line.strip_prefix("pub ").unwrap_or(line)
    };
    let kinds = ["struct ", "enum ", "trait ", "type "];
    let rest = kinds.iter().find_map(|kind| item.strip_prefix(kind))?;
    rest.split(|c: char| !c.is_alphanumeric()).next()
}

#[test]
fn no_two_types_have_the_same_name() {
    let mut files_of: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for path in files(&in_repository("src")) {
        let text = fs::read_to_string(&path).unwrap();
        for name in text.lines().filter_map(defined_type) {
            let found = files_of.entry(name.to_owned()).or_default();
            found.push(path.clone());
        }
    }
    assert!(files_of.len() > 200 && files_of.contains_key("Sphere"));
    files_of.retain(|_, files| files.len() > 1);
    assert_eq!(files_of, BTreeMap::new());
}

#[test]
fn the_scan_sees_what_it_should() {
    let text = "use crate::yaml::{self, Source as Text, a::{B, c::D}};\n\
        use crate::{film, cost::Cost};\n\
        // crate::cli is not used\n\
        let x = crate::film::y(); some_crate::z();\n";
    let found = paths(&code(text), "crate");
    let expected = [
        "yaml::self",
        "yaml::Source",
        "yaml::a::B",
        "yaml::a::c::D",
        "film",
        "cost::Cost",
        "film::y",
    ];
    assert_eq!(found, expected);
    assert_eq!(
        paths("use super::super::a;\nuse super::b;", "super"),
        ["super::a", "b"]
    );
    assert_eq!(paths("use super::super::a;", "super::super"), ["a"]);
    assert_eq!(
        declared("mod a;\npub(crate) mod b;\n    mod c;\n"),
        ["a", "b"]
    );
    let graph = |edges: &[(&str, &str)]| {
        let mut uses = BTreeMap::<String, BTreeSet<String>>::new();
        for (from, to) in edges {
            let used = uses.entry((*from).to_owned()).or_default();
            used.insert((*to).to_owned());
        }
        uses
    };
    assert_eq!(circle(&graph(&[("a", "b"), ("b", "c"), ("a", "c")])), None);
    let round = circle(&graph(&[("a", "b"), ("b", "c"), ("c", "b")]));
    assert_eq!(round.unwrap(), ["b", "c"]);
}
