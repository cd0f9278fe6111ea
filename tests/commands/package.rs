//! The package that cargo makes of the repository.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use crate::architecture::files;
use crate::common::{assert_success, in_repository};

#[path = "../../build/package.rs"]
#[allow(dead_code, reason = "the build script reads the file")]
mod info;

#[test]
fn it_has_the_pictures_of_the_readme_and_no_documents_in_pdf() {
    let readme = fs::read_to_string(in_repository("README.md")).unwrap();
    let links = readme.split("](").skip(1);
    let pictures = links.filter_map(|link| link.split(')').next());
    let pictures: BTreeSet<&str> = pictures.filter(|link| link.ends_with(".png")).collect();
    assert!(!pictures.is_empty());
    let output = Command::new(env!("CARGO"))
        .args([
            "package",
            "--list",
            "--allow-dirty",
            "--offline",
            "--package",
            "raycost",
        ])
        .current_dir(in_repository(""))
        .output()
        .unwrap();
    assert_success(&output);
    let files = String::from_utf8(output.stdout).unwrap();
    let files: BTreeSet<&str> = files.lines().collect();
    let of_docs = |extension: &str| {
        let files = files.iter().filter(|file| file.starts_with("docs/"));
        let found = files.filter(|file| file.ends_with(extension));
        found.copied().collect::<BTreeSet<&str>>()
    };
    assert_eq!(of_docs(".png"), pictures);
    assert_eq!(of_docs(".pdf"), BTreeSet::new());
}

/// `cargo publish` of a crate needs this; that the packages build, `cargo package` itself checks.
#[test]
fn each_crate_can_be_packaged() {
    let target = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO"))
        .args(["package", "--workspace", "--no-verify", "--offline"])
        .args(["--allow-dirty", "--target-dir"])
        .arg(target.path())
        .current_dir(in_repository(""))
        .output()
        .unwrap();
    assert_success(&output);
    let packages = fs::read_dir(target.path().join("package")).unwrap();
    let packages = packages.map(|entry| entry.unwrap().path());
    let n_packages = packages.filter(|path| path.extension().is_some_and(|it| it == "crate"));
    let crates = fs::read_dir(in_repository("src")).unwrap();
    let folders = crates.map(|entry| entry.unwrap().path());
    let folders: Vec<_> = folders
        .filter(|it| it.join("Cargo.toml").exists())
        .collect();
    assert_eq!(n_packages.count(), folders.len() + 1);
    for folder in folders {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        for key in ["readme", "keywords", "categories", "description"] {
            assert!(
                manifest.contains(&format!("\n{key} = ")),
                "{}",
                folder.display()
            );
        }
        let name = folder.file_name().unwrap().to_string_lossy();
        assert!(manifest.contains(&format!("name = \"raycost_{name}\"")));
    }
}

/// A crate's package has nothing from outside of its folder.
#[test]
fn no_crate_includes_files_of_others() {
    let src = in_repository("src");
    let mut n_found = 0;
    for file in files(&src) {
        let text = fs::read_to_string(&file).unwrap();
        let names = ["include_str!(\"", "include_bytes!(\"", "#[path = \""];
        let is_other_file = |line: &&str| names.iter().any(|name| line.contains(name));
        for line in text.lines().filter(is_other_file) {
            n_found += 1;
            // Folders from the crate down to the file.
            let depth = file.strip_prefix(&src).unwrap().iter().count() - 2;
            let up = line.matches("../").count();
            assert!(up <= depth, "{}: {line}", file.display());
        }
    }
    assert!(n_found > 10);
}

#[test]
fn the_commit_is_that_of_cargos_note() {
    let hash = "5c37ff0cba9876543210fedcba9876543210fedc";
    let note = |more: &str| format!("{{\n  \"git\": {{\n    \"sha1\": \"{hash}\"{more}\n  }}\n}}");
    let clean = info::commit_in(&note(""));
    assert_eq!(clean.as_deref(), Some("5c37ff0cba98"));
    let dirty = info::commit_in(&note(",\n    \"dirty\": true"));
    assert_eq!(dirty.as_deref(), Some("5c37ff0cba98-dirty"));
    for other in [
        "",
        "{}",
        "{ \"sha1\": \"\" }",
        "{ \"sha1\": \"$(id)$(id)$(id)\" }",
    ] {
        assert_eq!(info::commit_in(other), None);
    }
}
