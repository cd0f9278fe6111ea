//! Each call of a commit fails, or the process is killed at it: a reader finds all old
//! files or all new ones.

use super::*;
use crate::folder::disk::faults;
use crate::folder::disk::faults::DiskFault;

const EIO: i32 = 5;
const ENOSPC: i32 = 28;

/// Injects each fault into each call of a run; returns the number of attempts.
fn break_at_every_call(method: CommitMethod) -> usize {
    let faults = [
        DiskFault::Kill,
        DiskFault::Error(EIO),
        DiskFault::Error(ENOSPC),
        DiskFault::Errors(EIO),
        DiskFault::Errors(ENOSPC),
    ];
    let mut n_tries = 0;
    for fault in faults {
        for number in 0.. {
            let scenario = Scenario::new(method);
            let what = format!("{method:?}, {fault:?} at call {number}");
            let sync = fault == DiskFault::Error(EIO);
            let (done, n_calls) = faults::with(number, fault, || scenario.run(sync));
            if method == CommitMethod::Journal {
                settle(&scenario.folder()).unwrap();
            }
            let is_new = scenario.is_new(&what);
            let said = done.as_ref().map_err(WriteError::to_string).err();
            let is_unsure = |said: &String| said.contains("may not survive a power cut");
            if fault != DiskFault::Kill {
                let expected = said.as_ref().is_none_or(is_unsure);
                assert_eq!(is_new, expected, "{what}: {said:?}");
            }
            if matches!(fault, DiskFault::Error(_)) && method == CommitMethod::Exchange {
                scenario.assert_clean(&what);
            }
            OutputFolder::create(&scenario.folder(), 0).unwrap();
            scenario.assert_clean(&what);
            assert_eq!(scenario.is_new(&what), is_new, "{what}");
            scenario.run(false).unwrap();
            assert!(scenario.is_new(&what), "{what}");
            scenario.assert_clean(&what);
            n_tries += 1;
            if number >= n_calls {
                assert!(done.is_ok() && is_new, "{what}");
                break;
            }
        }
    }
    n_tries
}

#[test]
#[cfg(target_os = "linux")]
fn a_broken_exchange_leaves_all_old_files_or_all_new_ones() {
    assert!(break_at_every_call(CommitMethod::Exchange) > 100);
}

#[test]
fn a_broken_journal_leaves_all_old_files_or_all_new_ones() {
    assert!(break_at_every_call(CommitMethod::Journal) > 100);
}

/// A rollback that is interrupted at any call can be repeated.
#[test]
fn a_journal_is_taken_back_however_often_that_is_broken_off() {
    let scenario = Scenario::new(CommitMethod::Journal);
    let (_, n_calls) = faults::with(usize::MAX, DiskFault::Kill, || scenario.run(false));
    for first in 0..n_calls {
        for second in 0.. {
            let scenario = Scenario::new(CommitMethod::Journal);
            let what = format!("killed at call {first}, then at {second}");
            let _ = faults::with(first, DiskFault::Kill, || scenario.run(false));
            let (_, n_calls) = faults::with(second, DiskFault::Kill, || settle(&scenario.folder()));
            settle(&scenario.folder()).unwrap();
            scenario.is_new(&what);
            OutputFolder::create(&scenario.folder(), 0).unwrap();
            scenario.assert_clean(&what);
            if second >= n_calls {
                break;
            }
        }
    }
}

/// Other programs use the folder before and after the exchange.
#[test]
#[cfg(target_os = "linux")]
fn files_of_others_survive_a_kill_after_the_exchange() {
    let count = Scenario::new(CommitMethod::Exchange);
    let (_, n_calls) = faults::with(usize::MAX, DiskFault::Kill, || count.run(false));
    let killed_after_the_exchange = (0..n_calls).find_map(|number| {
        let scenario = Scenario::new(CommitMethod::Exchange);
        let _ = faults::with(number, DiskFault::Kill, || scenario.run(false));
        scenario.is_new("").then_some(scenario)
    });
    let scenario = killed_after_the_exchange.unwrap();
    let left = fs::read_dir(scenario.temporary.path()).unwrap();
    let left = left.map(|entry| entry.unwrap().path());
    let left = left.into_iter().find(|path| *path != scenario.folder());
    let old = workspace::new_files(&left.unwrap());
    fs::write(old.join("late.txt"), "came at the last moment").unwrap();
    fs::remove_file(scenario.folder().join("notes.txt")).unwrap();
    OutputFolder::create(&scenario.folder(), 0).unwrap();
    let names = names(&scenario.folder());
    assert!(names.contains(&"late.txt".to_owned()), "{names:?}");
    assert!(!names.contains(&"notes.txt".to_owned()), "{names:?}");
    assert!(!names.contains(&"c.png".to_owned()), "{names:?}");
    scenario.assert_clean("");
}
