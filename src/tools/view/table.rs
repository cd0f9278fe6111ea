//! `objects.csv`, if the rendering has one.

use serde_json::json;

use super::payload::{Payload, PayloadEncoder};
use host::text::Diagnostic;
use output::results::ObjectsTable;

/// Returns the table as JSON, with the keys `columns` and `rows`.
///
/// # Errors
/// The table is damaged.
pub(super) fn payload(table: ObjectsTable) -> Result<Payload, Diagnostic> {
    let mut payload = PayloadEncoder::new("objects-table");
    payload.encode(format!("{{\"columns\":{},\"rows\":[", json!(table.columns())).as_bytes());
    let mut separator = "";
    table.read_rows(|row| {
        payload.encode(format!("{separator}{}", json!(row)).as_bytes());
        separator = ",";
    })?;
    payload.encode(b"]}");
    Ok(payload.finish())
}
