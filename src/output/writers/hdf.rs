//! `hits.vtkhdf` and `frame.vtkhdf`: cloud and frame as VTKHDF.

use super::file::{FileContent, OutputFile};
use super::frame::image;
use super::hits::with_cloud;
use vtk::hdf;

/// The cloud, as in `hits.vtu`.
pub(super) const HITS: OutputFile = OutputFile {
    name: "hits.vtkhdf",
    is_wanted: |request| request.vtkhdf,
    content: FileContent::AtPath(|job, path| {
        let fields = job.encoding_of_pixels().fields;
        let (film, survey) = (job.rendering.film, job.rendering.survey);
        with_cloud(film, film.row_range(), &survey.distances, |cloud| {
            hdf::write(cloud, &fields, path)
        })
    }),
};

/// Every pixel, as in `frame.vti`.
pub(super) const FRAME: OutputFile = OutputFile {
    name: "frame.vtkhdf",
    is_wanted: |request| request.vtkhdf,
    content: FileContent::AtPath(|job, path| {
        let fields = job.encoding_of_pixels().fields;
        let film = job.rendering.film;
        hdf::write(&image(film, film.row_range()), &fields, path)
    }),
};
