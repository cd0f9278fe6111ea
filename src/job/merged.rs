//! The files of the parts of a picture, as its tiles.

use std::path::Path;

use super::{Job, Output, PicturePart};
use crate::session::Session;
use host::text::{Diagnostic, shell_word};
use render::checkpoint::{Checkpoint, Header, PartFaults, PartFiles};

/// Reads the parts in the output folder of a picture.
///
/// # Errors
/// The folder cannot be read.
pub(crate) fn read_parts(folder: &Path) -> Result<PartFiles, Diagnostic> {
    PartFiles::open(folder).map_err(|error| {
        let message = format!("cannot read the parts in `{}`: {error}", folder.display());
        Diagnostic::new(message)
    })
}

/// Opens the tiles of all parts of a session's picture in an output folder.
///
/// # Errors
/// If the parts do not belong to the picture.
pub(super) fn open(job: &Job, session: &Session, folder: &Path) -> Result<Checkpoint, Diagnostic> {
    let found = read_parts(folder)?;
    let expected = session.header(job.scene.flags(), None)?;
    if let Some(why) = found
        .header()
        .and_then(|header| header.foreign_to(&expected))
    {
        let message = format!("the parts in `{}` do not fit: {why}", folder.display());
        let help = "undo what has changed since, or render all parts again";
        return Err(Diagnostic::new(message).with_help(help));
    }
    let parts = found.checked(&expected);
    let parts = parts.map_err(|faults| job.refused(&faults, &expected, folder))?;
    Ok(Checkpoint::from_parts(parts))
}

impl Job<'_> {
    /// Returns the message about parts that do not form a picture.
    fn refused(&self, faults: &PartFaults, expected: &Header, folder: &Path) -> Diagnostic {
        let message = format!("the parts in `{}` make no picture", folder.display());
        let refused = Diagnostic::new(message).with_note(faults.lines.join("\n"));
        let parts: Vec<PicturePart> = faults.again.iter().copied().collect();
        match &parts[..] {
            [] => refused.with_help("remove the files that do not belong there"),
            [first, others @ ..] => {
                let frame = expected.frame.map(|frame| format!(" --frames {frame}"));
                let flags = expected
                    .flags
                    .iter()
                    .map(|flag| shell_word(Path::new(flag)));
                let words = [shell_word(Path::new(&expected.scene))]
                    .into_iter()
                    .chain(flags);
                let words: Vec<String> = words.collect();
                let (Output::Folder(out) | Output::Picture(out)) = &self.output;
                let out = shell_word(out);
                let command = format!(
                    "raycost render {} --out {out}{} --part {first}",
                    words.join(" "),
                    frame.unwrap_or_default(),
                );
                let others: Vec<String> = others.iter().map(PicturePart::to_string).collect();
                let others = match others.len() {
                    0 => String::new(),
                    _ => format!(", and so the parts {}", others.join(", ")),
                };
                refused.with_help(format!("render again: `{command}`{others}"))
            }
        }
    }
}
