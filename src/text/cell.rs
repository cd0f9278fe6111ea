//! Text in tables that spreadsheets open.
//!
//! A spreadsheet takes a cell that begins with `=` for a formula, and a formula
//! may run a program or send what is in the table. Text that begins like one
//! gets an apostrophe before it, as OWASP advises for CSV; text that begins
//! with an apostrophe gets one more, so that a reader can take them off again.
//! Numbers are no text: -1 stays -1.

use std::borrow::Cow;

/// The text as a cell.
pub(crate) fn text_cell(text: &str) -> Cow<'_, str> {
    let begins_a_formula = |c| matches!(c, '=' | '+' | '-' | '@' | '\t' | '\r' | '\n' | '\'');
    // Some keyboards have signs of another width, which count as well.
    let is_wide = |c| matches!(c, '＝' | '＋' | '－' | '＠');
    if text.starts_with(|c| begins_a_formula(c) || is_wide(c)) {
        Cow::Owned(format!("'{text}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// The text of a cell that [`text_cell`] made.
pub(crate) fn text_of_cell(cell: &str) -> &str {
    cell.strip_prefix('\'').unwrap_or(cell)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_cell_is_a_formula_and_each_is_read_back() {
        for text in [
            "=cmd|' /C calc'!A0",
            "+1",
            "-1",
            "@SUM(A1)",
            "\t=1",
            "\r=1",
            "＝1",
            "'quoted'",
            "''",
            "plain",
            "a=b",
            "",
        ] {
            let cell = text_cell(text);
            assert!(
                !cell.starts_with(['=', '+', '-', '@', '\t', '\r', '＝']),
                "{text:?}"
            );
            assert_eq!(text_of_cell(&cell), text);
        }
        assert_eq!(text_cell("a=b"), "a=b");
    }
}
