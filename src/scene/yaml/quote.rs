//! Quotes that are not closed on their line.
//!
//! YAML lets a quoted text span lines, so a parser reports an unclosed quote where the next one
//! ends it, or not at all. Scenes have no such texts.

use super::fault::Fault;
use host::text::line_start;

/// Returns the fault of the quote that is open at the start of the line of byte `at`,
/// or opens at `at` and is not closed on that line; `None` if there is none.
pub(super) fn unclosed(text: &str, at: usize) -> Option<Fault> {
    let line = line_start(text, at);
    let is_open = |quoted: &QuotedText| {
        let ends_below = quoted
            .end
            .is_none_or(|end| text[quoted.start..end].contains('\n'));
        let reaches_line = quoted.end.is_none_or(|end| end > line);
        ends_below && reaches_line && (quoted.start < line || quoted.start == at)
    };
    let QuotedText { start, .. } = quoted_texts(text).into_iter().find(is_open)?;
    let quote = &text[start..=start];
    let fault = Fault::at_bytes(
        start..start + 1,
        "a quote is not closed",
        "no closing quote on this line",
    );
    Some(fault.with_help(format!("put another `{quote}` at the end of the text")))
}

/// Returns the remedy for text after the quote that ends at byte `end`.
pub(super) fn how_to_quote(text: &str, end: usize) -> &'static str {
    if text[..end].trim_end().ends_with('\'') {
        "close each quote, and inside single quotes write a single quote twice"
    } else {
        "close each quote, and inside double quotes write `\\\"` for a quote"
    }
}

/// A text in quotes.
struct QuotedText {
    /// The byte of the opening quote.
    start: usize,
    /// The byte after the closing quote; `None` if there is none.
    end: Option<usize>,
}

/// Returns the quoted texts of a YAML text, up to the first that is not closed.
fn quoted_texts(text: &str) -> Vec<QuotedText> {
    let mut found = Vec::new();
    let mut next = 0;
    while let Some(start) = next_opening(text, next) {
        let end = end_of_quoted(text, start);
        found.push(QuotedText { start, end });
        next = end.unwrap_or(text.len());
    }
    found
}

/// Returns the first quote at or after byte `from` that opens a text: one at which a value or a key
/// can begin, outside of comments.
fn next_opening(text: &str, from: usize) -> Option<usize> {
    let mut in_comment = false;
    text[from..].char_indices().find_map(|(offset, c)| {
        let before = &text[..from + offset];
        match c {
            '\n' => in_comment = false,
            '#' if before.is_empty() || before.ends_with([' ', '\t', '\n']) => in_comment = true,
            _ => {}
        }
        let can_open = || {
            let before = before.trim_end_matches(' ');
            before.is_empty() || before.ends_with(['\n', '[', '{', ',', ':', '-'])
        };
        (matches!(c, '"' | '\'') && !in_comment && can_open()).then_some(from + offset)
    })
}

/// Returns the byte after the quote that closes the one at byte `start`.
fn end_of_quoted(text: &str, start: usize) -> Option<usize> {
    let quote = text.as_bytes()[start];
    let mut bytes = (start + 1..).zip(text[start + 1..].bytes()).peekable();
    while let Some((at, byte)) = bytes.next() {
        let next = bytes.peek().map(|&(_, byte)| byte);
        let is_escape = (quote == b'"' && byte == b'\\')
            || (quote == b'\'' && byte == quote && next == Some(quote));
        if is_escape {
            bytes.next();
        } else if byte == quote {
            return Some(at + 1);
        }
    }
    None
}
