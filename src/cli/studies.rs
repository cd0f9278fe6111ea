//! Which study files `raycost study` was given, and where the results of each go.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::text::Diagnostic;

/// What is run if nothing is named: the ready studies of the repository.
const READY: &str = "configs/studies";

/// The study files of a command line, those of a folder by their names, each
/// with the folder for its results.
///
/// # Errors
/// What is not there; a folder that cannot be read or has no study; two studies
/// of one name.
pub(super) fn files(
    named: &[PathBuf],
    out: Option<&Path>,
    quick: bool,
) -> Result<Vec<(PathBuf, PathBuf)>, Diagnostic> {
    if let Some(missing) = named.iter().find(|path| !path.exists()) {
        let message = format!("there is no study `{}`", missing.display());
        return Err(Diagnostic::new(message)
            .with_help("name a study file, such as configs/studies/tiles.yaml, or a folder"));
    }
    let files = match named {
        [] => ready()?,
        [file] if !file.is_dir() => {
            let own = || Path::new("out/studies").join(name_of(file, quick));
            let out = out.map_or_else(own, Path::to_owned);
            return Ok(vec![(file.clone(), out)]);
        }
        several => {
            let lists = several.iter().map(|path| match path.is_dir() {
                true => studies_in(path),
                false => Ok(vec![path.clone()]),
            });
            lists.collect::<Result<Vec<_>, _>>()?.concat()
        }
    };
    let out = out.unwrap_or(Path::new("out/studies"));
    let mut studies: Vec<(PathBuf, PathBuf)> = Vec::new();
    for file in files {
        let folder = out.join(name_of(&file, quick));
        if let Some((other, _)) = studies.iter().find(|(_, other)| *other == folder) {
            let [one, two, folder] = [other, &file, &folder].map(|path| path.display());
            let message = format!("`{one}` and `{two}` would both write to `{folder}`");
            return Err(Diagnostic::new(message).with_help("run them one by one, with `--out`"));
        }
        studies.push((file, folder));
    }
    Ok(studies)
}

fn ready() -> Result<Vec<PathBuf>, Diagnostic> {
    let ready = Path::new(READY);
    match ready.is_dir() {
        true => studies_in(ready),
        false => Err(
            Diagnostic::new(format!("there is no folder `{READY}` here"))
                .with_help("name a study file, or go to the root of the repository"),
        ),
    }
}

/// The YAML files of a folder, sorted.
fn studies_in(folder: &Path) -> Result<Vec<PathBuf>, Diagnostic> {
    let named = folder.display();
    let failed = |error: io::Error| Diagnostic::new(format!("cannot read `{named}`: {error}"));
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let ending = path.extension().unwrap_or_default();
        if ending == "yaml" || ending == "yml" {
            files.push(path);
        }
    }
    if files.is_empty() {
        let message = format!("`{named}` has no study");
        return Err(Diagnostic::new(message).with_help("studies are files that end in `.yaml`"));
    }
    files.sort();
    Ok(files)
}

/// "tiles", or "tiles-quick".
fn name_of(file: &Path, quick: bool) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    format!("{stem}{}", if quick { "-quick" } else { "" })
}
