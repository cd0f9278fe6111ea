//! Text in CSV tables that spreadsheets open.
//!
//! A spreadsheet interprets a cell that begins with `=` as a formula, which may run a program or
//! send the table's content. Text that begins like a formula is prefixed with an apostrophe, as
//! OWASP recommends for CSV; so is text that begins with an apostrophe, so that a reader can remove
//! the prefix. Numbers are not changed.

use std::borrow::Cow;

/// Returns the text as a cell.
pub fn text_cell(text: &str) -> Cow<'_, str> {
    let begins_a_formula = |c| matches!(c, '=' | '+' | '-' | '@' | '\t' | '\r' | '\n' | '\'');
    // Spreadsheets also accept the full-width forms of these characters.
    let is_wide = |c| matches!(c, '＝' | '＋' | '－' | '＠');
    if text.starts_with(|c| begins_a_formula(c) || is_wide(c)) {
        Cow::Owned(format!("'{text}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// Returns the text of a cell that [`text_cell`] returned.
pub fn text_of_cell(cell: &str) -> &str {
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
