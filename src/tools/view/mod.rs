//! An output folder → `view.html`, a page that shows all of it in a browser.
//!
//! Converts [`Results`] to a page that needs no server and no network: it embeds the arrays as text
//! and the script that shows them. A rendering that is too large for a page, or for the requested
//! size, is subsampled evenly and deterministically, and the page says so: every shown value is an
//! exact value of the rendering.

mod about;
mod budget;
mod cloud;
mod frame;
mod hottest;
mod html;
mod payload;
mod table;

use std::io::{self, Write};

use rayon::prelude::*;

use host::provenance::{RunId, checksum};
use host::text::Diagnostic;
use output::results::Results;

use cloud::Cloud;
use frame::{MAX_PIXELS, ShownPixels};
use payload::Payload;

/// The page's name in the output folder.
pub const FILE: &str = "view.html";

/// The content of a page.
#[derive(Debug)]
pub struct Page {
    title: String,
    /// The ID of the run.
    run: RunId,
    /// The JSON that the script reads.
    about: String,
    payloads: Vec<Payload>,
    notes: Vec<String>,
    /// The number of shown pixels.
    n_pixels: u64,
    /// The bytes of the page that depend on the shown pixels.
    n_pixel_bytes: u64,
}

impl Page {
    /// Reads the content of a page, with at most the pixels of full HD.
    ///
    /// # Errors
    /// If a file of the folder is missing or damaged.
    pub fn new(results: &Results) -> Result<Self, Diagnostic> {
        Self::read_at_most(MAX_PIXELS, results)
    }

    /// Reads the content of a page with at most `n_pixels` pixels.
    fn read_at_most(n_pixels: u64, results: &Results) -> Result<Self, Diagnostic> {
        let frame = results.frame()?;
        let pixels = ShownPixels::at_most(n_pixels, [frame.width(), frame.height()]);
        // The page cannot be drawn without these arrays: report the missing ones.
        frame.require(&["RGB", "footprint"])?;
        let arrays = pixels.read(&frame)?;
        // Relative to the camera, 32 bits have enough digits for points, wherever they are.
        let camera = results.summary.camera.as_ref();
        let origin = camera.map_or([0.0; 3], |camera| camera.origin);
        let cloud = Cloud::read(&results.hits()?, &pixels, origin)?;
        let table = results.objects()?.map(table::payload).transpose()?;
        let notes = [
            results
                .summary
                .partial
                .map(|partial| format!("The picture is {partial}.")),
            pixels.note(),
            cloud.note(),
            about::missing(&results.summary),
        ];
        let notes: Vec<String> = notes.into_iter().flatten().collect();
        let hottest = hottest::json(&results.summary, &frame, &pixels)?;
        let about = about::json(&results.summary, &pixels, &arrays, &cloud, &notes, hottest);
        let mut payloads: Vec<Payload> = arrays
            .par_iter()
            .enumerate()
            .map(|(i, array)| Payload::encode_numbers(&about::array_id(i), &array.values))
            .collect();
        payloads.extend(cloud.payloads());
        let n_pixel_bytes = payloads.iter().map(Payload::n_bytes).sum();
        payloads.extend(table);
        Ok(Self {
            title: match results.summary.partial {
                Some(_) => format!("{} (partial)", results.summary.scene.name),
                None => results.summary.scene.name.clone(),
            },
            // Outputs of older versions have no ID: the page needs one.
            run: (results.summary.run).unwrap_or_else(|| checksum(about.as_bytes()).into()),
            about,
            payloads,
            notes,
            n_pixels: pixels.n_shown(),
            n_pixel_bytes,
        })
    }

    /// Writes the page.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        html::write(&self.title, self.run, &self.about, &self.payloads, out)
    }

    /// Returns notes on omitted content, with reasons; one or two sentences each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
}
