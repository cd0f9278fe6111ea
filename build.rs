//! Tells the program what made it: `summary.json` and studies say so. Runs
//! again whenever a file of the package has changed.

use std::env;
use std::process::Command;

fn main() {
    let compiler = env::var("RUSTC")
        .ok()
        .and_then(|rustc| said(&rustc, &["--version"]));
    tell("COMPILER", &compiler.unwrap_or_default());
    tell("PROFILE", &env::var("PROFILE").unwrap_or_default());
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    tell("FLAGS", &flags.replace('\u{1f}', " "));
    // None in a package that was downloaded without its history.
    if let Some(commit) = said("git", &["describe", "--always", "--dirty", "--abbrev=12"]) {
        tell("COMMIT", &commit);
    }
}

/// What a program prints, if it succeeds.
fn said(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

/// Sets a variable for `env!`.
fn tell(name: &str, value: &str) {
    println!("cargo::rustc-env=RAYCOST_{name}={value}");
}
