//! `raycost view`.

use std::ffi::OsStr;
use std::path::PathBuf;

use super::{Failure, on_threads, refuse_file, shown};
use base::numbers::bytes;
use host::folder::{Replace, refuse_foreign_file, write_file};
use host::text::{self, Diagnostic};
use output::results::{Results, read_unchanged};
use tools::view::{self, Page};

/// Write a page that shows an output folder in a browser
///
/// The page is self-contained: it needs no server and no network.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost view out/seed_extended
  raycost view out/seed_extended --max-mb 10 --out page.html")]
pub(super) struct ViewArguments {
    /// A folder that `raycost render` wrote
    #[arg(value_name = "DIR")]
    folder: PathBuf,

    /// File to write [default: DIR/view.html]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Largest size of the page in MB (1,000,000 bytes), such as a limit for mail:
    /// shows fewer pixels until the page fits
    #[arg(long, value_name = "N", value_parser = megabytes, allow_negative_numbers = true)]
    max_mb: Option<u64>,
}

/// Parses a number of megabytes as bytes.
fn megabytes(text: &str) -> Result<u64, String> {
    let wrong = "expected a number above 0, such as 10 or 0.5";
    let n_bytes = text.parse::<f64>().map_err(|_| wrong)? * 1e6;
    if n_bytes >= 1.0 {
        Ok(n_bytes as u64)
    } else {
        Err(wrong.to_owned())
    }
}

pub(super) fn run(arguments: &ViewArguments) -> Result<(), Failure> {
    on_threads(|| write_page(arguments))
}

fn write_page(arguments: &ViewArguments) -> Result<(), Failure> {
    refuse_file(&arguments.folder)?;
    let path = match &arguments.out {
        Some(path) => path.clone(),
        None => arguments.folder.join(view::FILE),
    };
    // A table or a state of raycost would be replaced, too.
    let is_page = |extension: &OsStr| extension.eq_ignore_ascii_case("html");
    if path.is_file() && !path.extension().is_some_and(is_page) {
        let message = format!("`{}` is not a page", shown(&path));
        return Err(Diagnostic::new(message)
            .with_help("name another file, such as `view.html`")
            .into());
    }
    refuse_foreign_file(&path, Replace::Marked)?;
    let folder = &arguments.folder;
    let page = read_unchanged(&[folder], || {
        let results = Results::open(folder)?;
        match arguments.max_mb {
            Some(max_bytes) => Page::within(max_bytes, &results),
            None => Page::new(&results),
        }
    })?;
    let written = write_file(&path, Replace::Marked, |out| page.write(out))?;
    let mut text = String::new();
    for note in page.notes() {
        text += &format!("note    {note}\n");
    }
    text += &format!("wrote   {} ({})\n", shown(&path), bytes(written.bytes));
    text += "next    open it in a browser\n";
    Ok(text::print(&text)?)
}
