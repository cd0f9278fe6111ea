//! The ground: strings, files and folders, the machine, and the request to stop.

pub mod stop;
pub mod host;
pub mod text;
pub mod files;
pub mod provenance;
pub mod folder;
