//! Output to the terminal.
//!
//! Names, titles and paths may come from untrusted scenes or outputs. Their control characters
//! could color, move or delete the terminal's text, and a bidirectional override could make a path
//! look like another. This module escapes them as `\u{1b}`. A test checks that no other module
//! writes to standard output or standard error.

use std::borrow::Cow;
use std::io::{self, IsTerminal, Write};
use std::path::Path;

/// Spaces before the text of a line that begins with a word of a summary, such as `image`.
const INDENT: &str = "        ";

/// Escapes invisible characters except line ends and tabs.
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, |c| !matches!(c, '\n' | '\t') && is_unseen(c))
}

/// Escapes invisible characters and line ends: for a name, a title or a path.
pub fn one_line(text: &str) -> Cow<'_, str> {
    escaped(text, is_unseen)
}

/// Returns the path, safe to print on a terminal.
pub fn shown(path: &Path) -> String {
    one_line(&path.to_string_lossy()).into_owned()
}

/// Quotes the path as one word for a shell.
pub fn shell_word(path: &Path) -> String {
    let text = one_line(&path.to_string_lossy()).into_owned();
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@%,".contains(c);
    if text.chars().all(plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

/// Escapes the invisible characters in JSON strings as JSON does.
pub fn visible_json(json: &str) -> String {
    let mut shown = String::with_capacity(json.len());
    for c in json.chars() {
        if c != '\n' && is_unseen(c) {
            let mut units = [0; 2];
            let units = c.encode_utf16(&mut units).iter();
            shown.extend(units.map(|unit| format!("\\u{unit:04x}")));
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Prints to standard output, with invisible characters escaped.
///
/// # Errors
/// An I/O error, such as [`io::ErrorKind::BrokenPipe`].
pub fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(visible(text).as_bytes())?;
    out.flush()
}

/// Breaks the lines of a summary between words if standard output is a terminal that is narrower
/// than they are.
pub fn wrapped(text: &str) -> Cow<'_, str> {
    if io::stdout().is_terminal() {
        Cow::Owned(wrapped_to(text, textwrap::termwidth()))
    } else {
        Cow::Borrowed(text)
    }
}

/// Stands for a space that no line breaks at.
const GLUE: char = '\u{e000}';

/// Breaks lines of more than `width` characters between words, but not after a number, whose unit
/// follows. Indents what follows in a line.
fn wrapped_to(text: &str, width: usize) -> String {
    let options = textwrap::Options::new(width)
        .subsequent_indent(INDENT)
        .break_words(false)
        .word_splitter(textwrap::WordSplitter::NoHyphenation);
    let before = std::iter::once(' ').chain(text.chars());
    let glued = |(c, before): (char, char)| match c {
        ' ' if before.is_ascii_digit() => GLUE,
        c => c,
    };
    let glued: String = text.chars().zip(before).map(glued).collect();
    let lines = glued.split_inclusive('\n');
    let filled: String = lines.map(|line| textwrap::fill(line, &options)).collect();
    filled.replace(GLUE, " ")
}

/// Prints styled text to standard output, without styles unless it is a terminal. Untrusted parts
/// of the text must come from [`one_line`] or [`visible`], because their styles are
/// indistinguishable from the program's.
///
/// # Errors
/// An I/O error.
pub fn print_styled(text: &str) -> io::Result<()> {
    let mut out = anstream::stdout().lock();
    out.write_all(visible_but_styles(text).as_bytes())?;
    out.flush()
}

/// Prints styled text and a line end to standard error, as [`print_styled`] does. Ignores errors,
/// which cannot be reported.
pub fn print_error(text: &str) {
    let _ = writeln!(anstream::stderr(), "{}", visible_but_styles(text));
}

/// Returns true if the character is invisible or reorders others: control characters, Unicode line
/// ends, direction marks, zero-width characters and noncharacters. Joiners count as visible, because
/// names in some languages require them.
fn is_unseen(c: char) -> bool {
    let is_format = matches!(c,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}'
        | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}'
        | '\u{fff9}'..='\u{fffb}' | '\u{fffe}' | '\u{ffff}' | '\u{e0000}'..='\u{e007f}');
    c.is_control() || is_format
}

fn escaped(text: &str, is_unseen: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_unseen) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_unseen(c) {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// Escapes invisible characters except sequences that select a style: ESC, `[`, numbers, `m`.
fn visible_but_styles(text: &str) -> String {
    let mut pieces = text.split('\u{1b}');
    let mut shown = visible(pieces.next().unwrap_or_default()).into_owned();
    for piece in pieces {
        let style = style_length(piece);
        shown.push_str(if style > 0 { "\u{1b}" } else { "\\u{1b}" });
        shown.push_str(&piece[..style]);
        shown.push_str(&visible(&piece[style..]));
    }
    shown
}

/// Returns the length in bytes of the leading sequence that selects a style, without
/// its ESC; 0 if there is none.
fn style_length(text: &str) -> usize {
    let is_number = |c: char| c.is_ascii_digit() || c == ';';
    match text.strip_prefix('[') {
        Some(rest) => {
            let end = rest.trim_start_matches(is_number);
            let n_numbers = rest.len() - end.len();
            if end.starts_with('m') {
                n_numbers + 2
            } else {
                0
            }
        }
        None => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_seen_becomes_text() {
        let evil = "a\u{1b}]0;title\u{7}b\r\n\u{202e}gnp.exe\u{9b}31m\u{2028}\t";
        let text = "a\\u{1b}]0;title\\u{7}b\\r\n\\u{202e}gnp.exe\\u{9b}31m\\u{2028}\t";
        assert_eq!(visible(evil), text);
        let line = text.replace('\n', "\\n").replace('\t', "\\t");
        assert_eq!(one_line(evil), line);
    }

    #[test]
    fn long_lines_break_between_words() {
        let text =
            "image   200 x 150 pixels, 4 samples per pixel\nnote    short\n        a  table\n";
        let narrow = "image   200 x 150 pixels,\n        4 samples per pixel\nnote    short\n        \
                      a  table\n";
        assert_eq!(wrapped_to(text, 30), narrow);
        assert_eq!(wrapped_to(text, 80), text);
        let path = "wrote   /a/path/that/is/longer/than/the/line/of/a/terminal\n";
        assert_eq!(wrapped_to(path, 20).matches("terminal").count(), 1);
    }

    #[test]
    fn json_stays_json() {
        let evil = "\u{202e}\u{9b}\u{e0041}\u{1b}\n\"";
        let json = visible_json(&serde_json::json!({ "name": evil }).to_string());
        assert!(json.is_ascii(), "{json}");
        let value: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(value["name"], evil);
    }

    #[test]
    fn what_can_be_seen_stays() {
        let fine = "größe → 3 µs, 名前, क्‍ष, 👩‍🚀, ├─ └─ …";
        assert!(matches!(visible(fine), Cow::Borrowed(text) if text == fine));
        assert_eq!(visible_but_styles(fine), fine);
    }

    #[test]
    fn styles_alone_pass() {
        let styled = "\u{1b}[1m\u{1b}[38;5;9merror\u{1b}[0m: it";
        assert_eq!(visible_but_styles(styled), styled);
        for (evil, text) in [
            ("\u{1b}[2J", "\\u{1b}[2J"),
            ("\u{1b}[1", "\\u{1b}[1"),
            ("\u{1b}", "\\u{1b}"),
            ("\u{1b}[1mx\u{1b}]8;;x\u{7}", "\u{1b}[1mx\\u{1b}]8;;x\\u{7}"),
        ] {
            assert_eq!(visible_but_styles(evil), text);
        }
    }
}
