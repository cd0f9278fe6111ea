//! `raycost new`.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf, absolute};

use super::{Failure, shell_word, shown};
use crate::starter;
use crate::text::{self, Diagnostic};

/// Write a scene file to begin with
///
/// The scene has comments that explain its sections. An existing file is never changed.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost new first.yaml
  raycost new --mesh bunny.ply bunny.yaml")]
pub(super) struct NewArguments {
    /// The file to write
    #[arg(default_value = "scene.yaml")]
    file: PathBuf,

    /// Write a scene of this mesh, the one that `raycost render MESH` renders
    #[arg(long, value_name = "MESH")]
    mesh: Option<PathBuf>,
}

pub(super) fn run(arguments: &NewArguments) -> Result<(), Failure> {
    let file = &arguments.file;
    let scene = match &arguments.mesh {
        None => starter::SCENE.to_owned(),
        Some(mesh) => starter::scene_of(mesh, &path_from(file, mesh))?,
    };
    let created = File::create_new(file);
    let written = created.and_then(|mut created| created.write_all(scene.as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            let message = format!("`{}` exists already", shown(file));
            Failure::Input(Diagnostic::new(message).with_help("name a file that does not exist"))
        }
        _ => {
            let message = format!("cannot write `{}`: {error}", shown(file));
            Failure::Machine(Diagnostic::new(message).with_help("name a file in another folder"))
        }
    })?;
    let next = format!(
        "wrote   {}\nnext    raycost render {}\n",
        shown(file),
        shell_word(file)
    );
    Ok(text::print(&next)?)
}

/// The path of a mesh as its scene file has to name it.
fn path_from(scene: &Path, mesh: &Path) -> PathBuf {
    let folder = scene.parent().unwrap_or(Path::new(""));
    if folder == Path::new("") || mesh.is_absolute() {
        return mesh.to_owned();
    }
    match (absolute(folder), absolute(mesh)) {
        (Ok(folder), Ok(mesh)) => match mesh.strip_prefix(folder) {
            Ok(inside) => inside.to_owned(),
            Err(_) => mesh,
        },
        _ => mesh.to_owned(),
    }
}
