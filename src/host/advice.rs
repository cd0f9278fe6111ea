//! Advice on I/O errors that choosing another file or folder does not solve.

use std::io;

/// Returns advice on the error; `None` if it is specific to the given path.
pub fn advice(error: &io::Error) -> Option<&'static str> {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            return Some("free some space, or choose another folder with `--out`");
        }
        io::ErrorKind::FileTooLarge => {
            return Some("raise the limit of a file's size (`ulimit -f`)");
        }
        io::ErrorKind::OutOfMemory => {
            return Some("stop other programs, or raise the limit of memory (`ulimit -v`)");
        }
        _ => {}
    }
    of_code(
        error
            .raw_os_error()
            .or_else(|| code_in(&error.to_string()))?,
    )
}

/// Returns the error number in a message that ends with a path: tempfile keeps only the message.
fn code_in(message: &str) -> Option<i32> {
    let (_, behind) = message.split_once("(os error ")?;
    behind.split_once(')')?.0.parse().ok()
}

/// Returns advice for error numbers that have no stable [`io::ErrorKind`].
#[cfg(unix)]
fn of_code(code: i32) -> Option<&'static str> {
    use nix::errno::Errno;
    match Errno::from_raw(code) {
        Errno::EMFILE | Errno::ENFILE => {
            Some("stop other programs, or raise the limit of open files (`ulimit -n`)")
        }
        Errno::EAGAIN => Some("stop other programs, or raise the limit of threads (`ulimit -u`)"),
        Errno::EIO => Some("the disk or the network behind it fails: see the system's log"),
        _ => None,
    }
}

#[cfg(not(unix))]
fn of_code(_: i32) -> Option<&'static str> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn advice_fits_the_error() {
        use nix::errno::Errno;
        let of = |errno: Errno| advice(&io::Error::from_raw_os_error(errno as i32));
        for (errno, part) in [
            (Errno::EMFILE, "ulimit -n"),
            (Errno::ENFILE, "ulimit -n"),
            (Errno::EAGAIN, "ulimit -u"),
            (Errno::EFBIG, "ulimit -f"),
            (Errno::ENOMEM, "ulimit -v"),
            (Errno::ENOSPC, "free some space"),
            (Errno::EIO, "the system's log"),
        ] {
            assert!(
                of(errno).is_some_and(|advice| advice.contains(part)),
                "{errno}"
            );
        }
        let file = io::Error::from_raw_os_error(Errno::EMFILE as i32);
        let wrapped = io::Error::new(file.kind(), format!("{file} at path \"a\""));
        assert_eq!(advice(&wrapped), of(Errno::EMFILE));
        assert_eq!(of(Errno::ENOENT), None);
        assert_eq!(of(Errno::EACCES), None);
    }
}
