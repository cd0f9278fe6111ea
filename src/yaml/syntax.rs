//! What the two YAML parsers say → faults in the user's words.

use std::ops::Range;

use saphyr_parser::{ScanError, Span};

use super::diagnostic::Fault;

/// What to do about most mistakes.
const ADVICE: &str = "put a space after each `:` (on the line above, too), indent all keys of a \
                      mapping alike, and put a text that holds `: ` in quotes";
const BRACKETS: &str = "put a comma between two entries and close each bracket";
const QUOTE_TEXT: &str = "put a text with such characters in quotes";
const CLOSE_QUOTES: &str = "close a quote on the line that opens it";

/// Part of a parser's message, what is wrong in the user's words, what to do.
const WORDS: &[(&str, &str, &str)] = &[
    (
        "tab",
        "a tab",
        "YAML forbids tabs in the indentation: use spaces",
    ),
    ("',' or '}'", "expected `,` or `}`", BRACKETS),
    ("',' or ']'", "expected `,` or `]`", BRACKETS),
    ("misplaced bracket", "it closes nothing", BRACKETS),
    ("expected node content", "expected a value", BRACKETS),
    (
        "only valid inside a block",
        "a `- ` cannot stand in brackets",
        BRACKETS,
    ),
    ("indentation in quoted scalar", "not closed", CLOSE_QUOTES),
    (
        "quoted scalar, found unexpected",
        "not closed",
        CLOSE_QUOTES,
    ),
    ("unexpected end of stream", "not closed", CLOSE_QUOTES),
    (
        "trailing content after",
        "expected nothing behind the closing quote",
        "write two of them for a quote inside a text in single quotes",
    ),
    (
        "escape character",
        "a `\\` that begins no escape of YAML",
        "write `\\\\` for a backslash, or use single quotes",
    ),
    (
        "mapping values are not allowed",
        "a `:` cannot stand here",
        ADVICE,
    ),
    (
        "illegal placement of ':'",
        "a `:` cannot stand here",
        ADVICE,
    ),
    ("unexpected ':'", "a `:` cannot stand here", ADVICE),
    (
        "':' may not precede",
        "expected a space behind the `:`",
        ADVICE,
    ),
    (
        "':' must be followed",
        "expected a space behind the `:`",
        ADVICE,
    ),
    ("simple key expect", "expected `key: value`", ADVICE),
    (
        "could not find expected ':'",
        "expected `key: value`",
        ADVICE,
    ),
    (
        "mapping keys are not allowed",
        "a key cannot stand here",
        ADVICE,
    ),
    (
        "<document start>",
        "it does not belong to what stands above",
        ADVICE,
    ),
    (
        "did not find expected key",
        "expected a key in the column of the others",
        "indent all keys of a mapping alike",
    ),
    (
        "expected '-' indicator",
        "expected a `- ` in the column of the others",
        "indent all items of a list alike",
    ),
    (
        END_OF_LINE,
        "expected the end of the line",
        "begin what follows on a line of its own",
    ),
    (
        "block sequence entries are not allowed",
        "a list cannot begin here",
        "begin it on a line of its own, or write [a, b]",
    ),
    (
        "unknown anchor",
        "this alias has no anchor",
        "give a value a name by `&name` before `*name` repeats it",
    ),
    (
        "recursion limit",
        "nested too deep",
        "a scene needs few levels of brackets",
    ),
    (
        "invalid indentation",
        "too far to the left",
        "indent what is in brackets deeper than the line that opens them",
    ),
    (
        "unexpected character",
        "no text can begin with this",
        QUOTE_TEXT,
    ),
    (
        "cannot start any token",
        "no text can begin with this",
        QUOTE_TEXT,
    ),
    (
        "plain scalar cannot start",
        "no text can begin with this",
        QUOTE_TEXT,
    ),
    (
        "scanning a block scalar",
        "no text can begin with this",
        QUOTE_TEXT,
    ),
    (
        "anchor or alias",
        "expected a name right behind it",
        QUOTE_TEXT,
    ),
    ("directive", "a line cannot begin with `%`", QUOTE_TEXT),
    (
        "comment intercepting",
        "a comment cannot stand inside a text",
        QUOTE_TEXT,
    ),
    (
        "comments must be separated",
        "expected a space before the `#`",
        QUOTE_TEXT,
    ),
];

/// Stands for a parser's message where the mistake is not at a line's begin.
const END_OF_LINE: &str = "end of the line";

/// The fault that saphyr found, while the collections that begin at the bytes
/// `opened` were open, the outermost first.
pub(super) fn fault(
    text: &str,
    error: &ScanError,
    opened: impl DoubleEndedIterator<Item = usize>,
) -> Fault {
    let at = byte_of(text, error.marker().index());
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
    let fault = broken(span, info, ADVICE);
    let speaks_of_brackets = info.contains("invalid indentation") || info.contains("',' or");
    match bracket.filter(|_| speaks_of_brackets) {
        Some(bracket) => fault.with_help(still_open(text, bracket)),
        None => fault,
    }
}

fn still_open(text: &str, bracket: usize) -> String {
    let line = 1 + text[..bracket].matches('\n').count();
    let rest = text[bracket..].lines().next().unwrap_or_default();
    let advice = match rest.contains(" #") {
        true => "`#` begins a comment unless it is in quotes",
        false => BRACKETS,
    };
    let bracket = &text[bracket..=bracket];
    format!("the `{bracket}` of line {line} is still open here: {advice}")
}

/// The fault that libyaml found and saphyr did not.
pub(super) fn of_libyaml(text: &str, error: &serde_yaml::Error) -> Fault {
    let message = error.to_string();
    let info = message.split(" at ").next().unwrap_or(&message);
    // libyaml's "index" counts characters.
    let at = error
        .location()
        .map_or(0, |place| byte_of(text, place.index()));
    broken(at..at, info, ADVICE)
}

/// Makes sure that there are no characters that YAML forbids.
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
            "a character that nobody can see",
            "delete it, or write it as `\\u…` in double quotes",
        )),
    }
}

fn broken(span: Range<usize>, info: &str, help: &str) -> Fault {
    let words = WORDS.iter().find(|(part, ..)| info.contains(part));
    let (expected, help) = words.map_or((info, help), |&(_, expected, help)| (expected, help));
    Fault::of_bytes(span, "the YAML syntax is broken", expected).with_help(help)
}

/// The mistake's own characters: a parser tells where it gave up.
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
        // Nothing to see here: show the last line that holds something.
        let end = text[..line_start].trim_end().len();
        let line = text[..end].lines().next_back().unwrap_or_default();
        return end - line.trim_start().len()..end;
    }
    at..at
}

/// Where the line that holds byte `at` begins.
pub(super) fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |newline| newline + 1)
}

/// The bytes of a span, which counts characters and may end in blanks.
pub(super) fn bytes(text: &str, span: Span) -> Range<usize> {
    let start = byte_of(text, span.start.index());
    let end = byte_of(text, span.end.index()).max(start);
    start..start + text[start..end].trim_end().len()
}

/// The byte at which the character with this index starts.
fn byte_of(text: &str, n_characters: usize) -> usize {
    text.char_indices()
        .nth(n_characters)
        .map_or(text.len(), |(byte, _)| byte)
}
