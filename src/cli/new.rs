//! `raycost new`.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf, absolute};

use super::{Failure, keyword, shell_word, shown};
use host::text::{self, Diagnostic};
use tools::schema::SchemaKind;
use tools::starter::{self, UpAxis};

/// The file of the schema, beside the scene.
const SCHEMA: &str = "scene.schema.json";

/// Write a scene file to begin with
///
/// The scene has comments that explain its sections. Its first line names the file
/// scene.schema.json beside it, with which an editor completes keys and marks mistakes; it is
/// written unless it is there. An existing file is never changed.
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

    /// The axis of the mesh that points upward [default: z of STL and of low surfaces such as
    /// terrain, otherwise y]
    #[arg(long, value_name = "AXIS", requires = "mesh", value_parser = keyword::<UpAxis>())]
    up: Option<UpAxis>,
}

pub(super) fn run(arguments: &NewArguments) -> Result<(), Failure> {
    let file = &arguments.file;
    let scene = match &arguments.mesh {
        None => starter::SCENE.to_owned(),
        Some(mesh) => starter::scene_of(mesh, &path_from(file, mesh), arguments.up)?,
    };
    let connection = format!("# yaml-language-server: $schema={SCHEMA}\n");
    write_new(file, &(connection + &scene)).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            let message = format!("`{}` exists already", shown(file));
            Failure::Input(Diagnostic::new(message).with_help("name a file that does not exist"))
        }
        _ => unwritable(file, &error),
    })?;
    let mut written = shown(file);
    let schema = file.with_file_name(SCHEMA);
    match write_new(&schema, &format!("{:#}\n", SchemaKind::Scene.schema())) {
        Ok(()) => written += &format!(", {}", shown(&schema)),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
        Err(error) => return Err(unwritable(&schema, &error)),
    }
    let next = shell_word(file);
    let text = format!("wrote   {written}\nnext    raycost render {next}\n");
    Ok(text::print(&text)?)
}

/// Writes a file that does not exist; leaves none if it fails.
fn write_new(file: &Path, text: &str) -> io::Result<()> {
    let mut created = File::create_new(file)?;
    let written = created.write_all(text.as_bytes());
    written.inspect_err(|_| drop(fs::remove_file(file)))
}

fn unwritable(file: &Path, error: &io::Error) -> Failure {
    let message = format!("cannot write `{}`: {error}", shown(file));
    Failure::Machine(Diagnostic::new(message).with_help("name a file in another folder"))
}

/// Returns the path of a mesh as its scene file has to name it.
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
