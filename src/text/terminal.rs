//! The one way to the terminal.
//!
//! Names, titles and paths may come from a scene or an output that a stranger
//! made. A control character among them could color, move or delete what
//! stands on a terminal, and a bidirectional override could show a path that is
//! not the one. Here they become text: `\u{1b}`. A test makes sure that nothing
//! else writes to standard output or standard error.

use std::borrow::Cow;
use std::io::{self, Write};

/// The text with all its characters to be seen; line ends and tabs stay.
pub fn visible(text: &str) -> Cow<'_, str> {
    shown(text, |c| !matches!(c, '\n' | '\t') && is_unseen(c))
}

/// The same on one line: for a name, a title or a path.
pub fn one_line(text: &str) -> Cow<'_, str> {
    shown(text, is_unseen)
}

/// JSON with all characters of its strings to be seen, by escapes of JSON.
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

/// Prints to standard output, with all characters to be seen.
///
/// # Errors
/// What the system says; see [`io::ErrorKind::BrokenPipe`].
pub fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(visible(text).as_bytes())?;
    out.flush()
}

/// Prints text with styles to standard output; they are left out where it is
/// no terminal. Whatever of the text is not the program's own has to come from
/// [`one_line`] or [`visible`]: a style of a stranger looks like one of ours.
///
/// # Errors
/// What the system says.
pub fn print_styled(text: &str) -> io::Result<()> {
    let mut out = anstream::stdout().lock();
    out.write_all(visible_but_styles(text).as_bytes())?;
    out.flush()
}

/// Prints text with styles and a line end to standard error, as
/// [`print_styled`] does. Where standard error is closed, nothing can be said.
pub fn print_error(text: &str) {
    let _ = writeln!(anstream::stderr(), "{}", visible_but_styles(text));
}

/// Whether a reader cannot see the character, or sees others in a wrong order:
/// controls, line ends of Unicode, marks of direction and of nothing. Joiners
/// are none of these: names in some languages need them.
fn is_unseen(c: char) -> bool {
    let is_format = matches!(c,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}'
        | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}'
        | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}');
    c.is_control() || is_format
}

fn shown(text: &str, is_unseen: impl Fn(char) -> bool) -> Cow<'_, str> {
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

/// The text with all its characters to be seen, but for sequences that choose
/// a style: ESC, `[`, numbers, `m`.
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

/// Bytes of the sequence at the begin that chooses a style, ESC left out; 0 if
/// there is none.
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
