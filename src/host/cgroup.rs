//! Memory limits of Linux control groups, versions 1 and 2.

use std::fs;
use std::path::Path;

/// The files of one version: limit, usage, and the key of `memory.stat` that counts cached file
/// pages, which the system reclaims if needed.
struct Version {
    /// Folders in which the groups may be mounted.
    folders: [&'static str; 2],
    limit: &'static str,
    usage: &'static str,
    reclaimable: &'static str,
}

const V1: Version = Version {
    folders: ["memory", "memory"],
    limit: "memory.limit_in_bytes",
    usage: "memory.usage_in_bytes",
    reclaimable: "total_inactive_file ",
};

const V2: Version = Version {
    folders: [".", "unified"],
    limit: "memory.max",
    usage: "memory.current",
    reclaimable: "inactive_file ",
};

/// Returns the bytes available within the limits of the process's groups; `None` without a limit.
/// `root` is the mount point of the groups, and `memberships` the text of `/proc/self/cgroup`: a
/// line `number:controllers:path` per hierarchy.
pub(super) fn free(root: &Path, memberships: &str) -> Option<u64> {
    let of_line = |line: &str| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?);
        let version = match controllers {
            "" => V2,
            _ if controllers.split(',').any(|name| name == "memory") => V1,
            _ => return None,
        };
        let folders = version.folders.iter().map(|folder| root.join(folder));
        folders
            .filter_map(|folder| version.free(&folder, path))
            .min()
    };
    memberships.lines().filter_map(of_line).min()
}

impl Version {
    /// Returns the bytes available to the group at `path` within the limits of the
    /// group and its ancestors. In a container the path may not exist: then only
    /// ancestors that exist count.
    fn free(&self, folder: &Path, path: &str) -> Option<u64> {
        let path = Path::new(path.trim_start_matches('/'));
        let groups = path.ancestors().map(|group| folder.join(group));
        groups.filter_map(|group| self.free_in(&group)).min()
    }

    fn free_in(&self, group: &Path) -> Option<u64> {
        let read = |file: &str| fs::read_to_string(group.join(file)).ok();
        let number = |file: &str| read(file)?.trim().parse::<u64>().ok();
        // A limit that is not a number means no limit.
        let limit = number(self.limit)?;
        let usage = number(self.usage).unwrap_or(0);
        let statistics = read("memory.stat").unwrap_or_default();
        let reclaimable = statistics
            .lines()
            .find_map(|line| line.strip_prefix(self.reclaimable)?.parse::<u64>().ok());
        let needed = usage.saturating_sub(reclaimable.unwrap_or(0));
        Some(limit.saturating_sub(needed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a file system of groups, each with its files and their content.
    fn root(groups: &[(&str, &[(&str, &str)])]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (group, files) in groups {
            let folder = root.path().join(group);
            fs::create_dir_all(&folder).unwrap();
            for (file, text) in *files {
                fs::write(folder.join(file), text).unwrap();
            }
        }
        root
    }

    #[test]
    fn the_tightest_group_around_the_process_counts() {
        let outer = [("memory.max", "1000\n"), ("memory.current", "900\n")];
        let inner = [
            ("memory.max", "max\n"),
            ("memory.current", "300\n"),
            ("memory.stat", "anon 200\ninactive_file 100\n"),
        ];
        let root = root(&[("jobs", &outer), ("jobs/one", &inner)]);
        assert_eq!(free(root.path(), "0::/jobs/one\n"), Some(100));
        assert_eq!(free(root.path(), "0::/jobs\n"), Some(100));
        assert_eq!(free(root.path(), "0::/\n"), None);
    }

    #[test]
    fn pages_of_files_are_free() {
        let files = [
            ("memory.limit_in_bytes", "1000\n"),
            ("memory.usage_in_bytes", "900\n"),
            ("memory.stat", "inactive_file 1\ntotal_inactive_file 600\n"),
        ];
        let root = root(&[("memory", &files)]);
        // The group's own folder is not mounted, but its parent is.
        let memberships = "5:devices:/x\n4:cpu,memory:/container/abc\n0::/\n";
        assert_eq!(free(root.path(), memberships), Some(700));
    }

    #[test]
    fn a_group_over_its_limit_leaves_nothing() {
        let files = [("memory.max", "10"), ("memory.current", "11")];
        let root = root(&[("unified/a", &files)]);
        assert_eq!(free(root.path(), "0::/a"), Some(0));
        assert_eq!(free(root.path(), "no line of its kind"), None);
    }
}
