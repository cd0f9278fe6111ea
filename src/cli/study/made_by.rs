//! The provenance of a study's results.

use serde_json::{Value, json};

use crate::cli::Failure;
use crate::session::this_build;
use host::folder::checksum_of;
use host::text::Diagnostic;
use output::summary::Machine;
use render::instruments::HardwareCounters;

/// Returns the provenance of tables: machine and build.
pub(super) fn describe_tables() -> Value {
    let hardware = HardwareCounters::start();
    json!({
        "machine": Machine::current(),
        "build": this_build(),
        "no_hardware_counters": hardware.why_not(),
        "no_energy": hardware.why_no_energy(),
    })
}

/// Returns the provenance of measurements: the provenance of tables and, because builds of
/// different sources may have one description, a checksum of this program.
///
/// # Errors
/// If the program's file cannot be read.
pub(super) fn describe_measurements(of_tables: &Value) -> Result<Value, Failure> {
    let program = std::env::current_exe().and_then(|program| checksum_of(&program));
    let program = program.map_err(|error| {
        Failure::Machine(Diagnostic::new(format!(
            "cannot read this program: {error}"
        )))
    })?;
    let mut made_by = of_tables.clone();
    made_by["program"] = json!(program);
    Ok(made_by)
}
