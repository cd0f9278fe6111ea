//! Checks that the ranks of a study can and may be started.

use std::path::Path;

use render::ranks;
use scene::yaml::{Fault, FieldPath};
use tools::study::{Launcher, StudyPlan};

/// Checks that the launcher starts nothing but ranks of this program.
///
/// # Errors
/// If it may start another program.
fn check_harmless(launcher: &Launcher) -> Result<(), Fault> {
    let Some(word) = launcher.suspect() else {
        return Ok(());
    };
    let path = FieldPath::default().key("launcher");
    let message = format!("`{word}` in the `launcher` may start any program");
    let expected = "expected `mpirun`, `mpiexec` or `srun` without a path, and plain options";
    Err(Fault::new(path, message, expected)
        .with_help("if you trust this command, let the study start it: `--allow-commands`"))
}

/// Checks that ranks can be started here. Unless `any_command`, the launcher has to be harmless.
/// Steps over ranks that cannot be started are left out later.
pub(super) fn check(plan: &StudyPlan, any_command: bool) -> Result<(), Fault> {
    let Some(launcher) = &plan.launcher else {
        return Ok(());
    };
    if !any_command {
        check_harmless(launcher)?;
    }
    if plan.steps.is_empty() {
        check_startable(launcher)?;
    }
    Ok(())
}

/// Checks that the program that starts ranks can be run, and that this one can be a rank.
pub(super) fn check_startable(launcher: &Launcher) -> Result<(), Fault> {
    let fault = |message: String, expected: &str, help: &str| {
        let path = FieldPath::default().key("launcher");
        Err(Fault::new(path, message, expected).with_help(help))
    };
    if !ranks::IS_BUILT {
        let message = "this raycost was built without MPI, which ranks need";
        let help = "install MPI (on Debian, `apt-get install libopenmpi-dev libclang-dev`), then \
                    `cargo install --path . --features mpi`";
        return fault(message.to_owned(), "starts ranks", help);
    }
    let program = launcher.program();
    let path = Path::new(program);
    let (is_found, expected) = if program.contains('/') {
        (is_executable(path), "is not a file")
    } else {
        let folders = std::env::var_os("PATH").unwrap_or_default();
        let mut folders = std::env::split_paths(&folders);
        let is_in_one = folders.any(|folder| is_executable(&folder.join(program)));
        (is_in_one, "is not in PATH")
    };
    if is_found {
        return Ok(());
    }
    if program.contains('/') && path.is_file() {
        let message = format!("`{program}` cannot be executed");
        return fault(
            message,
            "is not a program",
            "make it executable: `chmod +x`",
        );
    }
    let message = format!("there is no program `{program}`");
    fault(message, expected, "install MPI, or give its path")
}

/// Returns true if this user may execute a file.
fn is_executable(path: &Path) -> bool {
    #[cfg(unix)]
    let may_execute = rustix::fs::access(path, rustix::fs::Access::EXEC_OK).is_ok();
    #[cfg(not(unix))]
    let may_execute = true;
    may_execute && path.is_file()
}
