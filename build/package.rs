//! The commit of a package that cargo has made.

use std::fs;

/// The file in which cargo notes the commit.
pub const INFO: &str = ".cargo_vcs_info.json";

/// Returns the commit of a package without its git repository; `None` where there is none.
pub fn commit() -> Option<String> {
    commit_in(&fs::read_to_string(INFO).ok()?)
}

/// Returns the commit that the file names, with `-dirty` if files were changed.
pub fn commit_in(info: &str) -> Option<String> {
    let behind = |key: &str| Some(info.split_once(&format!("\"{key}\":"))?.1.trim_start());
    let commit = behind("sha1")?.strip_prefix('"')?.get(..12)?;
    let is_commit = commit.bytes().all(|byte| byte.is_ascii_hexdigit());
    let is_dirty = behind("dirty").is_some_and(|value| value.starts_with("true"));
    is_commit.then(|| commit.to_owned() + if is_dirty { "-dirty" } else { "" })
}
