//! Foreign files remain, and are not overwritten.

use std::io::Write;

use super::*;

#[test]
fn the_root_is_no_output_folder() {
    for path in ["/", "/.", "//"] {
        let error = OutputFolder::create(Path::new(path), 0).unwrap_err();
        assert!(error.to_string().contains("root of the file system"));
    }
    assert!(lock_folder(Path::new("/")).is_err());
}

#[test]
fn a_second_run_is_refused_until_the_first_one_ends() {
    let scenario = Scenario::new(CommitMethod::Exchange);
    let first = OutputFolder::create(&scenario.folder(), 0).unwrap();
    let refused = OutputFolder::create(&scenario.folder(), 0).unwrap_err();
    assert!(refused.to_string().contains("another run"), "{refused}");
    drop(first);
    let folder = OutputFolder::create(&scenario.folder(), 0).unwrap();
    let staging = folder.stage_files().unwrap();
    let stage = |name| {
        let text = content(name, "new", &NEW);
        let staged = staging.stage(name, |out| out.write_all(text.as_bytes()));
        staged.unwrap()
    };
    let files = NEW.map(stage);
    staging.commit(&files, &own()).unwrap();
    // The name now belongs to another folder, which is locked too.
    let refused = OutputFolder::create(&scenario.folder(), 0).unwrap_err();
    assert!(refused.to_string().contains("another run"), "{refused}");
    drop(folder);
    scenario.run(false).unwrap();
}

#[test]
fn files_of_others_by_our_names_are_refused() {
    for name in ["a.png", "d.json", "summary.json"] {
        let temporary = tempfile::tempdir().unwrap();
        let path = temporary.path().join(name);
        fs::write(&path, "{}").unwrap();
        let folder = OutputFolder::create(temporary.path(), 0).unwrap();
        let error = folder.refuse_foreign(&own()).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        let staging = folder.stage_files().unwrap();
        let file = staging.stage("b.vti", |out| out.write_all(b"x")).unwrap();
        assert!(staging.commit(&[file], &own()).is_err());
        assert_eq!(names(temporary.path()), [name]);
        assert_eq!(fs::read(&path).unwrap(), b"{}");
    }
}

#[test]
fn marked_files_are_replaced_and_no_others() {
    let temporary = tempfile::tempdir().unwrap();
    let own = Own::Marked(vec!["rays.vtp"]);
    let path = temporary.path().join("rays.vtp");
    let write = |text: &'static [u8]| {
        let folder = OutputFolder::create(temporary.path(), 0)?;
        let staging = folder.stage_files()?;
        let file = staging.stage("rays.vtp", |out| out.write_all(text))?;
        staging.commit(&[file], &own)
    };
    write(b"raycost_run first").unwrap();
    write(b"unmarked").unwrap();
    assert!(write(b"raycost_run third").is_err());
    assert_eq!(fs::read(&path).unwrap(), b"unmarked");
}

#[test]
#[cfg(unix)]
fn permissions_stay() {
    use std::os::unix::fs::PermissionsExt;
    for method in [CommitMethod::Exchange, CommitMethod::OneByOne] {
        let scenario = Scenario::new(method);
        let folder = scenario.folder();
        let set = |path: &Path, mode| {
            fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
        };
        set(&folder, 0o2751);
        set(&folder.join("a.png"), 0o604);
        scenario.run(false).unwrap();
        let mode = |path: &Path| path.metadata().unwrap().permissions().mode() & 0o7777;
        assert_eq!(mode(&folder), 0o2751);
        assert_eq!(mode(&folder.join("a.png")), 0o604);
    }
}

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let scenario = Scenario::new(CommitMethod::Exchange);
    let folder = OutputFolder::create(&scenario.folder(), 0).unwrap();
    let staging = folder.stage_files().unwrap();
    let full = || io::Error::from(io::ErrorKind::StorageFull);
    let error = staging
        .stage("a.png", |out| out.write_all(b"half").and(Err(full())))
        .unwrap_err();
    assert!(error.to_string().contains("a.png"), "{error}");
    assert!(error.help().contains("free some space"));
    drop(staging);
    assert!(!scenario.is_new("failed write"));
    scenario.assert_clean("failed write");
}

#[test]
fn a_full_disk_is_seen_before_anything_is_written() {
    let temporary = tempfile::tempdir().unwrap();
    let error = OutputFolder::create(temporary.path(), u64::MAX).unwrap_err();
    assert!(error.to_string().contains("are needed"), "{error}");
}

#[test]
fn paths_that_states_cannot_hold_are_refused() {
    let temporary = tempfile::tempdir().unwrap();
    for name in ["a\u{1}b", "a\nb", "a\u{7f}b", "a\u{85}b"] {
        let path = temporary.path().join(name);
        let error = OutputFolder::create(&path, 0).unwrap_err();
        assert!(error.to_string().contains("control character"), "{error}");
        assert!(!path.exists());
    }
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        let path = temporary.path().join(std::ffi::OsStr::from_bytes(b"a\xff"));
        let error = OutputFolder::create(&path, 0).unwrap_err();
        assert!(error.to_string().contains("UTF-8"), "{error}");
    }
}

#[test]
#[cfg(unix)]
fn a_single_file_keeps_permissions_and_spares_what_is_not_ours() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let temporary = tempfile::tempdir().unwrap();
    let path = |name: &str| temporary.path().join(name);
    let write = |name: &str, text: &'static [u8]| {
        write_file(&path(name), Replace::Marked, |out| out.write_all(text))
    };
    write("page.html", b"raycost_run 1").unwrap();
    fs::set_permissions(path("page.html"), fs::Permissions::from_mode(0o600)).unwrap();
    write("page.html", b"raycost_run 2").unwrap();
    assert_eq!(fs::read(path("page.html")).unwrap(), b"raycost_run 2");
    let mode = path("page.html").metadata().unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);

    fs::write(path("mine.html"), "mine").unwrap();
    fs::create_dir(path("folder")).unwrap();
    symlink("page.html", path("link")).unwrap();
    symlink("nothing", path("dangling")).unwrap();
    let socket = std::os::unix::net::UnixListener::bind(path("socket")).unwrap();
    for name in ["mine.html", "folder", "link", "dangling", "socket"] {
        assert!(write(name, b"raycost_run 3").is_err(), "{name}");
    }
    assert!(write_file(Path::new("/dev/null"), Replace::Known, |_| Ok(())).is_err());
    drop(socket);
    assert_eq!(fs::read(path("mine.html")).unwrap(), b"mine");
    assert_eq!(fs::read(path("page.html")).unwrap(), b"raycost_run 2");
    let found = [
        "dangling",
        "folder",
        "link",
        "mine.html",
        "page.html",
        "socket",
    ];
    assert_eq!(names(temporary.path()), found);
}

/// Another run gives the folder's name to another folder while a file is written to it.
#[test]
fn a_single_file_is_written_again_if_its_folder_was_exchanged() {
    let temporary = tempfile::tempdir().unwrap();
    let [out, away] = ["out", "away"].map(|name| temporary.path().join(name));
    fs::create_dir(&out).unwrap();
    let written = write_file(&out.join("page.html"), Replace::Marked, |file| {
        if !away.exists() {
            fs::rename(&out, &away)?;
            fs::create_dir(&out)?;
        }
        file.write_all(b"raycost_run")
    });
    written.unwrap();
    assert_eq!(names(&out), ["page.html"]);
}

/// A stranger's workspace lies in and beside the folder, as `git clone` leaves it.
#[test]
#[cfg(unix)]
fn a_copied_workspace_stays_as_it_is() {
    let scenario = Scenario::new(CommitMethod::OneByOne);
    let mut left = Vec::new();
    let hash = crate::provenance::checksum(b"out").to_string();
    for parent in [&scenario.folder(), scenario.temporary.path()] {
        let path = parent.join(format!(".raycost-{}-AAAAAA", &hash[..16]));
        for inner in ["new", "new-1", "old-1", "exchanged-1"] {
            fs::create_dir_all(path.join(inner)).unwrap();
            let summary = content("summary.json", "old", &OLD);
            fs::write(path.join(inner).join("summary.json"), summary).unwrap();
        }
        fs::write(path.join("plan.json"), r#"{"folder":"mine"}"#).unwrap();
        left.push(path);
    }
    scenario.run(false).unwrap();
    assert!(scenario.is_new(""));
    for path in left {
        assert_eq!(
            names(&path),
            ["exchanged-1", "new", "new-1", "old-1", "plan.json"]
        );
        assert_eq!(names(&path.join("new-1")), ["summary.json"]);
    }
}

/// Neither links nor folders in what a killed run left lead to files elsewhere.
#[test]
#[cfg(unix)]
fn a_left_workspace_does_not_lead_out_of_its_folder() {
    use std::os::unix::fs::symlink;
    let temporary = tempfile::tempdir().unwrap();
    let [out, home] = ["out", "home"].map(|name| temporary.path().join(name));
    fs::create_dir_all(&home).unwrap();
    for name in ["mine.txt", "summary.json"] {
        fs::write(
            home.join(name),
            content("summary.json", "old", &["mine.txt"]),
        )
        .unwrap();
    }
    let make: [&dyn Fn(&Path); 3] = [
        &|inner| symlink(&home, inner).unwrap(),
        &|inner| {
            fs::create_dir(inner).unwrap();
            symlink(home.join("mine.txt"), inner.join("mine.txt")).unwrap();
            symlink(home.join("summary.json"), inner.join("summary.json")).unwrap();
            symlink(&home, inner.join("home")).unwrap();
        },
        &|inner| {
            fs::create_dir_all(inner.join("deep")).unwrap();
            fs::write(inner.join("deep/mine.txt"), "mine").unwrap();
            let listing = content("summary.json", "old", &["../mine.txt", "deep/mine.txt"]);
            fs::write(inner.join("summary.json"), listing).unwrap();
        },
    ];
    for (number, make) in make.iter().enumerate() {
        for kind in ["new", "old", "exchanged"] {
            let left = out.join(format!(".raycost-{number}{kind}"));
            fs::create_dir_all(&left).unwrap();
            let inode = lock::number_of(&left.metadata().unwrap());
            let inner = left.join(format!("{kind}-{inode}"));
            make(&inner);
            let _ = OutputFolder::create(&out, 0);
            assert_eq!(names(&home), ["mine.txt", "summary.json"]);
            assert_eq!(inner.join("deep/mine.txt").exists(), number == 2);
        }
    }
}
