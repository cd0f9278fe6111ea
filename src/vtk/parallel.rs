//! Files that list the pieces of a data set (`.pvti`, `.pvtu`), each in a separate file.

use std::fmt::Write as _;
use std::io::{self, Write};

use crate::array::Array;
use crate::data_set::Extent;
use crate::header::byte_order;
use crate::read::vtk_type;
use host::provenance::{KEY, RunId};

/// The pieces of a data set, as files in the same folder.
pub enum PieceFiles {
    /// Pieces of an image with spacing 1 and the first point at the origin.
    Image {
        /// Columns and rows of the whole image.
        size: [u32; 2],
        /// The name of each file, and its part of the image.
        files: Vec<(String, Extent)>,
    },
    /// Grids of cells with 32-bit points.
    Grids {
        /// The name of each file.
        files: Vec<String>,
    },
}

/// Writes the file that lists the pieces, which all have these point arrays.
pub fn write(
    pieces: &PieceFiles,
    arrays: &[Array],
    run: RunId,
    out: &mut impl Write,
) -> io::Result<()> {
    let order = byte_order();
    // List the files of the pieces.
    let (kind, attributes, body) = match pieces {
        PieceFiles::Image { size, files } => {
            let whole = Extent::of_size(*size);
            let attributes = format!(" WholeExtent=\"{whole}\" Origin=\"0 0 0\" Spacing=\"1 1 1\"");
            let piece = |(file, extent): &(String, Extent)| {
                format!("<Piece Extent=\"{extent}\" Source=\"{file}\"/>\n")
            };
            let files: String = files.iter().map(piece).collect();
            ("PImageData", attributes, files)
        }
        PieceFiles::Grids { files } => {
            let piece = |file: &String| format!("<Piece Source=\"{file}\"/>\n");
            let files: String = files.iter().map(piece).collect();
            let points = "<PPoints>\n<PDataArray type=\"Float32\" Name=\"Points\" \
                          NumberOfComponents=\"3\"/>\n</PPoints>\n";
            (
                "PUnstructuredGrid",
                String::new(),
                format!("{points}{files}"),
            )
        }
    };
    let normals = match pieces {
        PieceFiles::Grids { .. } if arrays.iter().any(|array| array.name == "Normals") => {
            " Normals=\"Normals\""
        }
        _ => "",
    };
    // List the arrays that all pieces have.
    let mut listed = String::new();
    for array in arrays {
        let (scalar, name, n) = (vtk_type(array.scalar), array.name, array.n_components);
        let _ = writeln!(
            listed,
            "<PDataArray type=\"{scalar}\" Name=\"{name}\" NumberOfComponents=\"{n}\"/>"
        );
    }
    write!(
        out,
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"{order}\" \
         header_type=\"UInt64\" {KEY}=\"{run}\">\n\
         <{kind} GhostLevel=\"0\"{attributes}>\n\
         <PPointData{normals}>\n{listed}</PPointData>\n\
         {body}</{kind}>\n</VTKFile>\n"
    )
}
