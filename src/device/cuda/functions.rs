//! Libraries that are loaded at run time, and tables of their functions.
#![expect(unsafe_code, reason = "libraries run code when they are loaded")]

use std::path::Path;

use libloading::Library;

/// Declares a table of functions of C, by their names in a library. They return an `int`.
macro_rules! functions {
    ($(#[$doc:meta])* $table:ident { $($name:ident: $symbol:literal ($($parameter:ty),*);)* }) => {
        $(#[$doc])*
        pub(super) struct $table {
            $(pub(super) $name: unsafe extern "C" fn($($parameter),*) -> std::ffi::c_int,)*
        }

        impl $table {
            /// Finds the functions in a library, which stays loaded until the program ends; `None`
            /// if it does not have all of them.
            fn of(library: libloading::Library) -> Option<Self> {
                let library: &'static _ = Box::leak(Box::new(library));
                // SAFETY: the library's manual declares the functions so.
                unsafe { Some(Self { $($name: *library.get($symbol).ok()?,)* }) }
            }
        }
    };
}
pub(super) use functions;

/// Folders of libraries: where the system looks for them, and where the toolkit has them.
const FOLDERS: [&str; 2] = ["", "/usr/local/cuda/lib64"];

/// Loads a library by its name; `None` if the system does not have it.
pub(super) fn load(name: &str) -> Option<Library> {
    // SAFETY: NVIDIA's libraries may be loaded at any time.
    let load = |folder: &str| unsafe { Library::new(Path::new(folder).join(name)) }.ok();
    FOLDERS.into_iter().find_map(load)
}
