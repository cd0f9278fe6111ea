//! Fills the page's template with its style, script and content.

use std::io::{self, Write};

use super::payload::Payload;
use host::provenance::RunId;

/// Placeholders such as `{{about}}` are replaced.
const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
/// The parts of the script; each uses only names of the parts above it.
const SCRIPT: [&str; 15] = [
    include_str!("page/payload.js"),
    include_str!("page/dom.js"),
    include_str!("page/format.js"),
    include_str!("page/scale.js"),
    include_str!("page/ruler.js"),
    include_str!("page/zoom.js"),
    include_str!("page/marks.js"),
    include_str!("page/panes.js"),
    include_str!("page/probe.js"),
    include_str!("page/camera.js"),
    include_str!("page/points.js"),
    include_str!("page/cloud.js"),
    include_str!("page/table.js"),
    include_str!("page/hottest.js"),
    include_str!("page/main.js"),
];

/// Writes the page; `about` is JSON.
pub(super) fn write(
    title: &str,
    run: RunId,
    about: &str,
    payloads: &[Payload],
    out: &mut impl Write,
) -> io::Result<()> {
    for piece in TEMPLATE.split("{{") {
        let Some((placeholder, text)) = piece.split_once("}}") else {
            out.write_all(piece.as_bytes())?;
            continue;
        };
        match placeholder {
            "title" => out.write_all(escaped(title).as_bytes())?,
            "run" => write!(out, "{run}")?,
            "about" => out.write_all(inert(about).as_bytes())?,
            "style" => out.write_all(STYLE.as_bytes())?,
            "script" => out.write_all(SCRIPT.join("\n").as_bytes())?,
            "payloads" => payloads.iter().try_for_each(|payload| payload.write(out))?,
            _ => unreachable!("the template has no other placeholders"),
        }
        out.write_all(text.as_bytes())?;
    }
    Ok(())
}

/// Escapes text between tags.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

/// Escapes JSON within a script element, so that it cannot end the element.
fn inert(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;
    use host::provenance::checksum;

    #[test]
    fn names_cannot_inject_markup() {
        let evil = "</script><img src=x onerror=alert(1)>&amp;";
        let about = serde_json::json!({ "name": evil }).to_string();
        let mut page = Vec::new();
        write(evil, checksum(b"").into(), &about, &[], &mut page).unwrap();
        let page = String::from_utf8(page).unwrap();
        assert!(!page.contains("<img"));
        let (_, json) = page.split_once("id=\"about\">").unwrap();
        let (json, _) = json.split_once("</script>").unwrap();
        let about: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!(about["name"], evil);
    }

    #[test]
    fn the_page_loads_nothing_from_elsewhere() {
        let parts = [TEMPLATE, STYLE].into_iter().chain(SCRIPT);
        for part in parts {
            for word in ["http://", "https://", "@import", "fetch(", "XMLHttpRequest"] {
                assert!(!part.contains(word), "{word}");
            }
        }
        assert!(TEMPLATE.contains("default-src 'none'"));
    }
}
