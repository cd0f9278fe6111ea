//! Translates messages of the two YAML parsers to faults in plain language.

use std::ops::Range;

use saphyr_parser::{ScanError, Span};

use super::expansion::MAX_LEVELS;
use super::fault::Fault;
use super::quote;
use host::text::line_start;

/// The remedy for most mistakes.
pub(super) const AFTER_COLON: &str = "expected a space after the `:`";
const ADVICE: &str = "put a space after each `:` (also on the line above), indent all keys of a \
                      mapping by the same number of spaces, and quote a text that contains `: `";
const BRACKETS: &str = "put a comma between two entries and close each bracket";
const BACKSLASH: &str = "write `/` between folders, `\\\\` for a backslash, or use single quotes";
const QUOTE_TEXT: &str = "quote a text that contains such a character";

/// A part of a parser's message, the label that replaces it, and the remedy.
const REWORDED: &[(&str, &str, &str)] = &[
    (
        "tab",
        "a tab",
        "YAML forbids tabs in the indentation: use spaces",
    ),
    ("',' or '}'", "expected `,` or `}`", BRACKETS),
    ("',' or ']'", "expected `,` or `]`", BRACKETS),
    ("misplaced bracket", "no bracket is open here", BRACKETS),
    ("expected node content", "expected a value", BRACKETS),
    (
        "only valid inside a block",
        "`- ` is not allowed in brackets",
        BRACKETS,
    ),
    ("escape character", "not a valid escape in YAML", BACKSLASH),
    // `\x` and `\u` without the digits of a character.
    ("hexadecimal", "not a valid escape in YAML", BACKSLASH),
    (
        "quoted scalar",
        "this quote is not closed",
        "close each quote on the line that opens it",
    ),
    (
        "mapping values are not allowed",
        "a `:` is not allowed here",
        ADVICE,
    ),
    (
        "illegal placement of ':'",
        "a `:` is not allowed here",
        ADVICE,
    ),
    ("unexpected ':'", "a `:` is not allowed here", ADVICE),
    ("':' may not precede", AFTER_COLON, ADVICE),
    ("':' must be followed", AFTER_COLON, ADVICE),
    ("simple key expect", "expected `key: value`", ADVICE),
    (
        "could not find expected ':'",
        "expected `key: value`",
        ADVICE,
    ),
    (
        "mapping keys are not allowed",
        "a key is not allowed here",
        ADVICE,
    ),
    (
        "<document start>",
        "not part of the mapping or list above",
        ADVICE,
    ),
    (
        "did not find expected key",
        "expected a key in the column of the others",
        "indent all keys of a mapping by the same number of spaces",
    ),
    (
        "expected '-' indicator",
        "expected a `- ` in the column of the others",
        "indent all items of a list by the same number of spaces",
    ),
    (
        END_OF_LINE,
        "expected the end of the line",
        "put the rest on a line of its own",
    ),
    (
        "block sequence entries are not allowed",
        "a list is not allowed here",
        "start the list on a line of its own, or write [a, b]",
    ),
    (
        "unknown anchor",
        "this alias has no anchor",
        "define the anchor with `&name` before `*name` refers to it",
    ),
    (
        "invalid indentation",
        "too far to the left",
        "indent the contents of brackets deeper than the line that opens them",
    ),
    (
        "unexpected character",
        "a text cannot begin with this character",
        QUOTE_TEXT,
    ),
    (
        "cannot start any token",
        "a text cannot begin with this character",
        QUOTE_TEXT,
    ),
    (
        "plain scalar cannot start",
        "a text cannot begin with this character",
        QUOTE_TEXT,
    ),
    (
        "scanning a block scalar",
        "a text cannot begin with this character",
        QUOTE_TEXT,
    ),
    (
        "anchor or alias",
        "expected a name right after it",
        QUOTE_TEXT,
    ),
    ("directive", "a line cannot begin with `%`", QUOTE_TEXT),
    (
        "comment intercepting",
        "a comment is not allowed inside a text",
        QUOTE_TEXT,
    ),
    (
        "comments must be separated",
        "expected a space before the `#`",
        QUOTE_TEXT,
    ),
];

/// Replaces a parser's message if the mistake is not at the start of a line.
const END_OF_LINE: &str = "end of the line";
/// Part of a parser's message about text after a closing quote.
const AFTER_QUOTE: &str = "trailing content after";
/// Part of both parsers' messages about brackets in brackets.
const TOO_DEEP: &str = "recursion limit";
const SUBJECT: &str = "invalid YAML syntax";

/// Translates an error of saphyr. `opened` are the starting bytes of the collections that were open
/// at that point, outermost first.
pub(super) fn fault(
    text: &str,
    error: &ScanError,
    opened: impl DoubleEndedIterator<Item = usize>,
) -> Fault {
    let at = byte_of(text, error.marker().index());
    if error.info().contains(TOO_DEEP) {
        return too_deep(at..at);
    }
    if let Some(fault) = quote::unclosed(text, at) {
        return fault;
    }
    if error.info().contains(AFTER_QUOTE) {
        let expected = "expected nothing after the closing quote";
        let fault = Fault::at_bytes(at..at, SUBJECT, expected);
        return fault.with_help(quote::how_to_quote(text, at));
    }
    let bracket = opened
        .rev()
        .find(|&start| text[start..].starts_with(['[', '{']));
    if let Some(bracket) = bracket.filter(|_| text[at..].trim().is_empty()) {
        return broken(bracket..bracket + 1, "never closed", BRACKETS);
    }
    let info = error.info();
    let span = caret(text, at, info);
    let line = line_start(text, span.start);
    let is_first = text[line..span.start].trim_matches([' ', '-']).is_empty();
    let info = match info {
        _ if text[line..].starts_with('%') => "directive",
        _ if info.contains("while parsing a block") && !is_first => END_OF_LINE,
        _ => info,
    };
    if let Some(fault) = without_space(text, line)
        .filter(|_| info.contains("':'") || info.contains("mapping values"))
    {
        return fault;
    }
    let fault = broken(span, info, ADVICE);
    let concerns_brackets = !info.contains("quoted scalar")
        && (info.contains("invalid indentation") || info.contains("',' or"));
    match bracket.filter(|_| concerns_brackets) {
        Some(bracket) => fault.with_help(still_open(text, bracket)),
        None => fault,
    }
}

/// Returns the fault of a value that lies within too many others.
pub(super) fn too_deep(bytes: Range<usize>) -> Fault {
    let expected = format!("expected at most {MAX_LEVELS} levels");
    Fault::at_bytes(bytes, "lists and mappings are nested too deeply", expected)
        .with_help("use fewer levels of brackets and indentation")
}

/// Returns the fault of the line above the one that starts at byte `line`, if it is a key and a
/// value without a space between them, as in `width:640`: YAML joins it to the next line.
fn without_space(text: &str, line: usize) -> Option<Fault> {
    let above = text[..line].trim_end();
    let start = line_start(text, above.len());
    let (key, value) = above[start..].split_once(':')?;
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let key = key.trim_start_matches([' ', '-']);
    let is_joined = !value.is_empty() && !value.starts_with(' ');
    if key.is_empty() || !key.chars().all(is_word) || !is_joined {
        return None;
    }
    let colon = above.len() - value.len();
    let fault = Fault::at_bytes(colon - 1..colon, SUBJECT, AFTER_COLON);
    Some(fault.with_help(format!("write `{key}: {}`", value.trim_start())))
}

fn still_open(text: &str, bracket: usize) -> String {
    let line = 1 + text[..bracket].matches('\n').count();
    let rest = text[bracket..].lines().next().unwrap_or_default();
    let advice = if rest.contains(" #") {
        "`#` starts a comment unless it is in quotes"
    } else {
        BRACKETS
    };
    let bracket = &text[bracket..=bracket];
    format!("the `{bracket}` of line {line} is still open here: {advice}")
}

/// Translates an error that only libyaml found.
pub(super) fn translate_libyaml(text: &str, error: &serde_yaml::Error) -> Fault {
    let message = error.to_string();
    let info = message.split(" at ").next().unwrap_or(&message);
    // libyaml's "index" counts characters.
    let at = error
        .location()
        .map_or(0, |place| byte_of(text, place.index()));
    if info.contains(TOO_DEEP) {
        return too_deep(at..at);
    }
    broken(at..at, info, ADVICE)
}

/// Checks that the text has no characters that YAML forbids.
pub(super) fn check_characters(text: &str) -> Result<(), Fault> {
    let is_forbidden = |c: char| match c {
        '\t' | '\n' | '\r' | '\u{85}' => false,
        '\u{feff}' | '\u{fffe}' | '\u{ffff}' => true,
        _ => c.is_control(),
    };
    match text.char_indices().find(|&(_, c)| is_forbidden(c)) {
        None => Ok(()),
        Some((at, c)) => Err(broken(
            at..at + c.len_utf8(),
            "an invisible character that YAML does not allow",
            "delete it, or write it as `\\u…` in double quotes",
        )),
    }
}

fn broken(span: Range<usize>, info: &str, help: &str) -> Fault {
    let words = REWORDED.iter().find(|(part, ..)| info.contains(part));
    let (expected, help) = words.map_or((info, help), |&(_, expected, help)| (expected, help));
    Fault::at_bytes(span, SUBJECT, expected).with_help(help)
}

/// Returns the bytes to underline: the parser reports only where it stopped.
fn caret(text: &str, at: usize, info: &str) -> Range<usize> {
    let line_start = line_start(text, at);
    if info.contains("tab") {
        let tab = text[line_start..]
            .find('\t')
            .map_or(at, |tab| line_start + tab);
        return tab..tab;
    }
    if text[line_start..]
        .lines()
        .next()
        .is_none_or(|line| line.trim().is_empty())
    {
        // For a blank line, underline the last line before it that is not blank.
        let end = text[..line_start].trim_end().len();
        let line = text[..end].lines().next_back().unwrap_or_default();
        return end - line.trim_start().len()..end;
    }
    at..at
}

/// Converts a span of characters to bytes, without trailing blanks.
pub(super) fn bytes(text: &str, span: Span) -> Range<usize> {
    bytes_after(text, span, [0; 2])
}

/// Converts a span as [`bytes`] does, counting from a place before it: its characters and bytes.
/// Counting from the start for each of many spans takes the square of their number.
pub(super) fn bytes_after(text: &str, span: Span, known: [usize; 2]) -> Range<usize> {
    let [start, end] = [span.start.index(), span.end.index()];
    let [n_characters, n_bytes] = if known[0] <= start { known } else { [0; 2] };
    let start_byte = n_bytes + byte_of(&text[n_bytes..], start - n_characters);
    let inside = &text[start_byte..];
    let inside = &inside[..byte_of(inside, end.saturating_sub(start))];
    start_byte..start_byte + inside.trim_end().len()
}

/// Returns the byte at which character `n_characters` starts.
fn byte_of(text: &str, n_characters: usize) -> usize {
    text.char_indices()
        .nth(n_characters)
        .map_or(text.len(), |(byte, _)| byte)
}
