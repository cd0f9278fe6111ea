//! `objects.csv`, if the rendering has one.

use serde_json::json;

use super::payload::Payload;
use output::results::ObjectsTable;

/// Returns the table as JSON, with the keys `columns` and `rows`.
pub(super) fn payload(table: &ObjectsTable) -> Payload {
    let text = json!({ "columns": table.columns, "rows": table.rows }).to_string();
    Payload::of_bytes("objects-table", text.as_bytes())
}
