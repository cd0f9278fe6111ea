//! `raycost --version` says what was built.

use std::process::Command;

use math::simd::Simd;

use crate::common::{in_repository, raycost};

fn printed(flag: &str) -> String {
    let output = raycost().arg(flag).output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty());
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn one_letter_prints_the_version_alone() {
    let expected = concat!("raycost ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!(printed("-V"), expected);
}

#[test]
fn the_word_prints_commit_features_and_instruction_set() {
    let text = printed("--version");
    let (first, rest) = text.split_once('\n').unwrap();
    assert_eq!(first, concat!("raycost ", env!("CARGO_PKG_VERSION")));
    let value = |name: &str| {
        let line = rest.lines().find_map(|line| line.strip_prefix(name));
        line.unwrap_or_else(|| panic!("{name} in {text}")).trim()
    };
    let best = Simd::available().last().unwrap().to_string();
    assert!(value("simd ").starts_with(&best), "{text}");
    for (feature, is_built_in) in [
        ("hdf5", cfg!(feature = "hdf5")),
        ("profile", cfg!(feature = "profile")),
    ] {
        assert_eq!(value("features ").contains(feature), is_built_in, "{text}");
    }
    assert!(value("compiler ").starts_with("rustc "), "{text}");
    let git = ["rev-parse", "--short=12", "HEAD"];
    let head = Command::new("git")
        .args(git)
        .current_dir(in_repository(""))
        .output();
    // A package has no repository.
    if let Some(head) = head.ok().filter(|output| output.status.success()) {
        let head = String::from_utf8(head.stdout).unwrap();
        assert_eq!(value("commit ").trim_end_matches("-dirty"), head.trim());
    }
}

/// All features of the manifest are in the text of a program that was built with them.
#[test]
fn every_feature_of_the_manifest_is_known() {
    let manifest = std::fs::read_to_string(in_repository("Cargo.toml")).unwrap();
    let (_, section) = manifest.split_once("[features]\n").unwrap();
    let (section, _) = section.split_once("\n[").unwrap();
    let names = section.lines().filter(|line| !line.starts_with('#'));
    let names = names.filter_map(|line| line.split_once(" = ").map(|(name, _)| name));
    let names: Vec<&str> = names.collect();
    let known = std::fs::read_to_string(in_repository("src/cli/version.rs")).unwrap();
    assert!(names.len() >= 2);
    for name in names {
        assert!(
            known.contains(&format!("cfg!(feature = \"{name}\")")),
            "{name}"
        );
    }
}
