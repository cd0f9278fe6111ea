//! Common parts of the folder tests.

mod breaking;
pub(super) mod faults;
mod others;

use std::io::Write;

use super::*;

/// The names of raycost's files in these tests.
const NAMES: [&str; 5] = ["a.png", "b.vti", "c.png", "d.json", "summary.json"];
const OLD: [&str; 4] = ["a.png", "b.vti", "c.png", "summary.json"];
const NEW: [&str; 4] = ["a.png", "b.vti", "d.json", "summary.json"];

/// The method of a commit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CommitMethod {
    /// Folders are exchanged.
    Exchange,
    /// A user's folder in the output folder prevents the exchange.
    OneByOne,
    /// The workspace is in the output folder, as if that were of another file system.
    Within,
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
        if method == CommitMethod::OneByOne {
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
        let mut staging = folder.stage_files()?;
        if self.method == CommitMethod::Within {
            let moved = staging.workspace.move_to(&folder.place);
            moved.map_err(|error| WriteError::new(&folder.place, error))?;
        }
        let stage = |name| {
            let text = content(name, "new", &NEW);
            staging.stage(name, |out| out.write_all(text.as_bytes()))
        };
        let files: Vec<Written> = NEW.into_iter().map(stage).collect::<Result<_, _>>()?;
        staging.commit(&files, &own())
    }

    /// Returns true if the folder has the new files. Checks that all are old or all are new, and
    /// that the foreign files exist.
    fn is_new(&self, what: &str) -> bool {
        self.assert_foreign(what);
        let folder = self.folder();
        let read = |name: &str| fs::read_to_string(folder.join(name));
        let is_new = read("summary.json").unwrap().contains("new");
        let (age, names): (_, &[_]) = if is_new { ("new", &NEW) } else { ("old", &OLD) };
        for name in NAMES {
            let expected = names.contains(&name).then(|| content(name, age, names));
            assert_eq!(read(name).ok(), expected, "{what}: {name}");
        }
        is_new
    }

    /// Checks that readers recognize that a part is missing, and that no file is of another run than
    /// the rest; or that all are old or all are new. Returns true if a part is missing.
    fn is_unfinished(&self, what: &str) -> bool {
        self.assert_foreign(what);
        if !is_unfinished(&self.folder()) {
            self.is_new(what);
            return false;
        }
        let read = |name: &&str| fs::read_to_string(self.folder().join(name)).ok();
        let texts: Vec<String> = NAMES.iter().filter_map(read).collect();
        let n_old = texts.iter().filter(|text| text.contains("old")).count();
        assert!(n_old == 0 || n_old == texts.len(), "{what}: {texts:?}");
        assert!(!self.folder().join("summary.json").exists(), "{what}");
        true
    }

    fn assert_foreign(&self, what: &str) {
        let read = |name: &str| fs::read_to_string(self.folder().join(name)).unwrap();
        assert_eq!(read("notes.txt"), "the user's own", "{what}");
        if self.method == CommitMethod::OneByOne {
            assert_eq!(read("mine/deep.txt"), "the user's own", "{what}");
        }
    }

    /// Checks that no workspace is left.
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
