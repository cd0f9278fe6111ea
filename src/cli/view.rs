//! `raycost view`.

use std::io::{self, Write};
use std::path::PathBuf;

use super::Failure;
use crate::output::{format::bytes, write_file};
use crate::results::Results;
use crate::view::{self, View};

/// Write a page that shows an output folder in a browser
///
/// The page stands alone: it needs no server and no network.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  raycost view out/seed_extended")]
pub(super) struct Arguments {
    /// A folder that `raycost render` wrote
    #[arg(value_name = "DIR")]
    folder: PathBuf,

    /// File to write [default: DIR/view.html]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let results = Results::open(&arguments.folder)?;
    let view = View::of(&results)?;
    let path = match &arguments.out {
        Some(path) => path.clone(),
        None => arguments.folder.join(view::FILE),
    };
    let n_bytes = write_file(&path, |out| view.write(out))?;
    let mut text = String::new();
    for note in view.notes() {
        text += &format!("note    {note}\n");
    }
    text += &format!("wrote   {} ({})\n", path.display(), bytes(n_bytes));
    text += "next    open it in a browser\n";
    Ok(io::stdout().write_all(text.as_bytes())?)
}
