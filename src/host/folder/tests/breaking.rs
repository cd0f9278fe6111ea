//! Each call of a commit fails, or the process is killed at it: a reader finds all old files, all
//! new ones or, where folders cannot be exchanged, a part that it recognizes.

use super::faults::DiskFault;
use super::*;

const EIO: i32 = 5;
const ENOSPC: i32 = 28;

/// A process that is killed.
const KILL: DiskFault = DiskFault::Errors(EIO);

/// Injects each fault into each call of a run. Returns the number of attempts, and how many left a
/// part of the files.
fn break_at_every_call(method: CommitMethod) -> (usize, usize) {
    let faults = [
        KILL,
        DiskFault::Error(EIO),
        DiskFault::Error(ENOSPC),
        DiskFault::Errors(ENOSPC),
    ];
    let (mut n_tries, mut n_unfinished) = (0, 0);
    for fault in faults {
        for number in 0.. {
            let scenario = Scenario::new(method);
            let what = format!("{method:?}, {fault:?} at call {number}");
            let sync = fault == DiskFault::Error(EIO);
            let (done, n_calls) = faults::with(number, fault, || scenario.run(sync));
            let is_unfinished = scenario.is_unfinished(&what);
            let is_new = !is_unfinished && scenario.is_new(&what);
            let said = done.as_ref().map_err(WriteError::to_string).err();
            let is_unsure = |said: &String| said.contains("may not survive a power cut");
            let expected = said.as_ref().is_none_or(is_unsure);
            assert_eq!(is_new, expected, "{what}: {said:?}");
            if matches!(fault, DiskFault::Error(_)) {
                assert!(!is_unfinished, "{what}");
                scenario.assert_clean(&what);
            }
            // The next run replaces what is unfinished.
            OutputFolder::create(&scenario.folder(), 0).unwrap();
            assert_eq!(scenario.is_unfinished(&what), is_unfinished);
            if !is_unfinished {
                scenario.assert_clean(&what);
                assert_eq!(scenario.is_new(&what), is_new, "{what}");
            }
            scenario.run(false).unwrap();
            assert!(scenario.is_new(&what), "{what}");
            scenario.assert_clean(&what);
            n_tries += 1;
            n_unfinished += usize::from(is_unfinished);
            if number >= n_calls {
                assert!(done.is_ok() && is_new, "{what}");
                break;
            }
        }
    }
    (n_tries, n_unfinished)
}

#[test]
#[cfg(target_os = "linux")]
fn a_broken_exchange_leaves_all_old_files_or_all_new_ones() {
    let (n_tries, n_unfinished) = break_at_every_call(CommitMethod::Exchange);
    assert!(n_tries > 100);
    assert_eq!(n_unfinished, 0);
}

#[test]
fn a_broken_replacement_leaves_one_whole_run_or_a_part_without_a_summary() {
    for method in [CommitMethod::OneByOne, CommitMethod::Within] {
        let (n_tries, n_unfinished) = break_at_every_call(method);
        assert!(n_tries > 100);
        assert!(n_unfinished > 0);
    }
}

#[test]
fn an_unfinished_replacement_is_replaced_however_often_that_is_broken_off() {
    let scenario = Scenario::new(CommitMethod::OneByOne);
    let (_, n_calls) = faults::with(usize::MAX, KILL, || scenario.run(false));
    for first in (0..n_calls).step_by(3) {
        for second in 0.. {
            let scenario = Scenario::new(CommitMethod::OneByOne);
            let what = format!("killed at call {first}, then at {second}");
            let _ = faults::with(first, KILL, || scenario.run(false));
            let (_, n_calls) = faults::with(second, KILL, || scenario.run(false));
            scenario.is_unfinished(&what);
            scenario.run(false).unwrap();
            assert!(scenario.is_new(&what), "{what}");
            scenario.assert_clean(&what);
            if second >= n_calls {
                break;
            }
        }
    }
}

/// Files that a user adds after a kill are not overwritten or removed.
#[test]
fn foreign_files_that_appear_in_a_part_survive() {
    let count = Scenario::new(CommitMethod::OneByOne);
    let (_, n_calls) = faults::with(usize::MAX, KILL, || count.run(false));
    for number in 0..n_calls {
        for names in [&NAMES[..4], &NAMES] {
            let scenario = Scenario::new(CommitMethod::OneByOne);
            let _ = faults::with(number, KILL, || scenario.run(false));
            let paths = names.iter().map(|name| scenario.folder().join(name));
            let free: Vec<PathBuf> = paths.filter(|at| !at.exists()).collect();
            free.iter().for_each(|at| fs::write(at, "mine").unwrap());
            assert_eq!(scenario.run(false).is_err(), !free.is_empty(), "{number}");
            for path in free {
                assert_eq!(fs::read(&path).unwrap(), b"mine", "{number}: {path:?}");
            }
        }
    }
}

/// Returns the exchanged folder in a workspace in this folder.
fn exchanged_in(folder: &Path) -> PathBuf {
    let workspace = workspace::places_in(folder, ".raycost-").next();
    workspace.unwrap().exchanged()
}

/// Other programs use the folder before and after the exchange.
#[test]
#[cfg(target_os = "linux")]
fn files_of_others_survive_a_kill_after_the_exchange() {
    let count = Scenario::new(CommitMethod::Exchange);
    let (_, n_calls) = faults::with(usize::MAX, KILL, || count.run(false));
    let killed_after_the_exchange = (0..n_calls).find_map(|number| {
        let scenario = Scenario::new(CommitMethod::Exchange);
        let _ = faults::with(number, KILL, || scenario.run(false));
        scenario.is_new("").then_some(scenario)
    });
    let scenario = killed_after_the_exchange.unwrap();
    let old = exchanged_in(scenario.temporary.path());
    fs::write(old.join("late.txt"), "came at the last moment").unwrap();
    fs::remove_file(scenario.folder().join("notes.txt")).unwrap();
    OutputFolder::create(&scenario.folder(), 0).unwrap();
    assert_eq!(names(&old), ["late.txt", "notes.txt"]);
}
