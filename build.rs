//! Sets the variables `RAYCOST_…` that the crate reads by `env!` and `option_env!` to describe the build:
//! compiler, profile, flags and commit.

#[path = "build/package.rs"]
mod package;

use std::env;
use std::path::Path;
use std::process::Command;

/// Everything that the binary is built from. Cargo runs this script again only if one of
/// these files or the commit changes.
const SOURCES: [&str; 7] = [
    "src",
    "paraview",
    "Cargo.toml",
    "Cargo.lock",
    "build.rs",
    "build",
    package::INFO,
];

fn main() {
    let compiler = env::var("RUSTC").ok();
    let version = compiler.and_then(|rustc| output_of(&rustc, &["--version"]));
    set_variable("COMPILER", &version.unwrap_or_default());
    set_variable("PROFILE", &env::var("PROFILE").unwrap_or_default());
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    // The same program wherever it is built: flags that hide paths name them.
    let kept = |flag: &&str| !flag.starts_with("--remap-path-prefix=");
    let flags: Vec<&str> = flags.split('\u{1f}').filter(kept).collect();
    set_variable("FLAGS", &flags.join(" "));
    if let Some(commit) = commit().or_else(package::commit) {
        set_variable("COMMIT", &commit);
    }
    for path in SOURCES.map(str::to_owned).into_iter().chain(head_files()) {
        // Cargo would run the script on each build for a path that does not exist.
        if Path::new(&path).exists() {
            println!("cargo::rerun-if-changed={path}");
        }
    }
}

/// Returns the commit, with `-dirty` if a source differs from it; `None` in a package
/// without its git repository.
fn commit() -> Option<String> {
    // The package may lie in the repository of something else.
    git(&["ls-files", "--error-unmatch", "build.rs"])?;
    let commit = git(&["describe", "--always", "--abbrev=12"])?;
    let changes = git(&[&["status", "--porcelain", "--"][..], &SOURCES].concat())?;
    Some(if changes.is_empty() {
        commit
    } else {
        commit + "-dirty"
    })
}

/// Returns the files of the git repository of which one changes whenever the current
/// commit changes: HEAD, its branch, and the log of HEAD.
fn head_files() -> Vec<String> {
    let branch = git(&["symbolic-ref", "--quiet", "HEAD"]);
    let names = [
        Some("HEAD".to_owned()),
        branch,
        Some("logs/HEAD".to_owned()),
    ];
    // In a worktree, these files are in different folders.
    let path = |name: String| git(&["rev-parse", "--git-path", &name]);
    names.into_iter().flatten().filter_map(path).collect()
}

fn git(arguments: &[&str]) -> Option<String> {
    output_of("git", &[&["--no-optional-locks"], arguments].concat())
}

/// Runs a program and returns what it prints; `None` if it fails.
fn output_of(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

/// Sets the variable `RAYCOST_name` for `env!`.
fn set_variable(name: &str, value: &str) {
    println!("cargo::rustc-env=RAYCOST_{name}={value}");
}
