//! The study files of a command line and the output folder of each.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use host::text::Diagnostic;

/// The default: the studies of the repository.
const DEFAULT_FOLDER: &str = "configs/studies";

/// Returns the study files of a command line, the files in a folder sorted by name, each with its
/// output folder.
///
/// # Errors
/// If a file does not exist, a folder cannot be read or has no study, or two studies have the same
/// name.
pub(super) fn find(
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
        [] => default_studies()?,
        [file] if !file.is_dir() => {
            let own = || Path::new("out/studies").join(name_of(file, quick));
            let out = out.map_or_else(own, Path::to_owned);
            return Ok(vec![(file.clone(), out)]);
        }
        several => {
            let lists = several.iter().map(|path| {
                if path.is_dir() {
                    studies_in(path)
                } else {
                    Ok(vec![path.clone()])
                }
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

fn default_studies() -> Result<Vec<PathBuf>, Diagnostic> {
    let folder = Path::new(DEFAULT_FOLDER);
    if folder.is_dir() {
        return studies_in(folder);
    }
    let message = format!("there is no folder `{DEFAULT_FOLDER}` here");
    Err(Diagnostic::new(message)
        .with_help("name a study file, or go to the root of the repository"))
}

/// Returns the YAML files of a folder, sorted by path.
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

/// Returns the name of the output folder, such as "tiles" or "tiles-quick".
fn name_of(file: &Path, quick: bool) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    format!("{stem}{}", if quick { "-quick" } else { "" })
}
