//! `objects.csv`, where it was asked for.

use serde_json::json;

use super::payload::Payload;
use crate::results::ObjectsTable;

/// The table as text of a page.
pub(super) fn payload(table: &ObjectsTable) -> Payload {
    let text = json!({ "columns": table.columns, "rows": table.rows }).to_string();
    Payload::of_bytes("objects-table", text.as_bytes())
}
