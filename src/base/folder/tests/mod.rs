//! Common parts of the folder tests.

mod breaking;
mod others;

use std::io::Write;

use super::*;

/// The names of raycost's files in these tests.
const NAMES: [&str; 5] = ["a.png", "b.vti", "c.png", "d.json", "summary.json"];
const OLD: [&str; 4] = ["a.png", "b.vti", "c.png", "summary.json"];
const NEW: [&str; 4] = ["a.png", "b.vti", "d.json", "summary.json"];

/// The method of a commit; a user's folder prevents the exchange of folders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CommitMethod {
    Exchange,
    Journal,
}

/// A folder with old files and foreign files.
struct Scenario {
    temporary: tempfile::TempDir,
    method: CommitMethod,
}

impl Scenario {
    fn new(method: CommitMethod) -> Self {
        let this = Self {
            temporary: tempfile::tempdir().unwrap(),
            method,
        };
        let folder = this.folder();
        fs::create_dir(&folder).unwrap();
        for name in OLD {
            fs::write(folder.join(name), content(name, "old", &OLD)).unwrap();
        }
        fs::write(folder.join("notes.txt"), "the user's own").unwrap();
        if method == CommitMethod::Journal {
            fs::create_dir(folder.join("mine")).unwrap();
            fs::write(folder.join("mine/deep.txt"), "the user's own").unwrap();
        }
        this
    }

    fn folder(&self) -> PathBuf {
        self.temporary.path().join("out")
    }

    /// Replaces the old files with new ones.
    fn run(&self, sync: bool) -> Result<(), WriteError> {
        let folder = OutputFolder::create(&self.folder(), 0)?.synced(sync);
        let staging = folder.stage_files()?;
        let stage = |name| {
            let text = content(name, "new", &NEW);
            staging.stage(name, |out| out.write_all(text.as_bytes()))
        };
        let files: Vec<StagedFile> = NEW.into_iter().map(stage).collect::<Result<_, _>>()?;
        staging.commit(&files, &own())
    }

    /// Returns true if the folder has the new files. Checks that all are old or all are new, and
    /// that the foreign files exist.
    fn is_new(&self, what: &str) -> bool {
        let folder = self.folder();
        let read = |name: &str| fs::read_to_string(folder.join(name));
        assert_eq!(read("notes.txt").unwrap(), "the user's own", "{what}");
        if self.method == CommitMethod::Journal {
            assert_eq!(read("mine/deep.txt").unwrap(), "the user's own", "{what}");
        }
        let is_new = read("summary.json").unwrap().contains("new");
        let (age, names): (_, &[_]) = if is_new { ("new", &NEW) } else { ("old", &OLD) };
        for name in NAMES {
            let expected = names.contains(&name).then(|| content(name, age, names));
            assert_eq!(read(name).ok(), expected, "{what}: {name}");
        }
        is_new
    }

    /// Checks that no workspace and no journal are left.
    fn assert_clean(&self, what: &str) {
        for folder in [self.temporary.path(), &self.folder()] {
            let names = fs::read_dir(folder).unwrap();
            let names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
            let is_left = |name: &&std::ffi::OsString| name.to_string_lossy().starts_with('.');
            assert_eq!(names.iter().find(is_left), None, "{what}");
        }
    }
}

fn own() -> Own {
    Own::Listed {
        names: NAMES.map(str::to_owned).to_vec(),
        is_numbered: |name| name.starts_with("piece_"),
    }
}

fn content(name: &str, age: &str, names: &[&str]) -> String {
    if name != "summary.json" {
        return format!("{age} {name}");
    }
    let files: Vec<_> = names
        .iter()
        .map(|name| serde_json::json!({ "file": name }))
        .collect();
    serde_json::json!({ "raycost": "0", "age": age, "files": files }).to_string()
}

fn names(path: &Path) -> Vec<String> {
    let entries = fs::read_dir(path).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}
