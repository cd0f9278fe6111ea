//! Missing files.

use std::path::Path;

use super::suggestion::did_you_mean;

/// Maximum number of files of a folder to search for a similar name.
const MAX_NAMES: usize = 1000;

/// Returns the likely reason why a file is missing; `None` if it exists, or no reason is known.
pub fn why_missing(path: &Path) -> Option<String> {
    if path.exists() {
        return None;
    }
    let text = path.to_string_lossy();
    let mut steps = text.split(['/', '\\']);
    if steps.any(|step| step.starts_with(['~', '$'])) {
        return Some("`~` and `$` have no meaning here: write the whole path".to_owned());
    }
    if cfg!(unix) && text.contains('\\') {
        return Some("write `/` between folders".to_owned());
    }
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Some(format!("there is no folder `{}`", folder.display()));
    }
    let entries = folder.read_dir().into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let names: Vec<String> = names.take(MAX_NAMES).collect();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    did_you_mean(&name, names.iter().map(String::as_str))
}
