//! An output folder → `view.html`, one page to look at all of it in a browser.
//!
//! Takes [`Results`]; gives a page that needs no server and no network: the
//! arrays stand in it as text, the script that shows them beside them. What is
//! too much for a page, or for the size that was asked for, is thinned out,
//! evenly and the same way each time, and the page says so: a value that it
//! shows is always one of the rendering's.

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

use crate::provenance::{RunId, checksum};
use crate::results::Results;
use crate::text::Diagnostic;

use cloud::Cloud;
use frame::{MAX_PIXELS, Pixels};
use payload::Payload;

/// The page's name in the output folder.
pub const FILE: &str = "view.html";

/// All that goes into a page.
#[derive(Debug)]
pub struct View {
    title: String,
    /// The run that it shows.
    run: RunId,
    /// What the script reads, as JSON.
    about: String,
    payloads: Vec<Payload>,
    notes: Vec<String>,
    /// Pixels that are shown, and how many bytes of the page are theirs.
    n_pixels: u64,
    n_pixel_bytes: u64,
}

impl View {
    /// Reads what the page shows.
    ///
    /// # Errors
    /// A diagnostic where a file of the folder is missing or damaged.
    pub fn of(results: &Results) -> Result<Self, Diagnostic> {
        Self::of_at_most(MAX_PIXELS, results)
    }

    /// Reads what a page of at most this many pixels shows.
    fn of_at_most(n_pixels: u64, results: &Results) -> Result<Self, Diagnostic> {
        let mut frame = results.frame()?;
        let pixels = Pixels::at_most(n_pixels, [frame.width(), frame.height()]);
        // Without these there is nothing to draw: say so.
        if let Some(missing) = ["RGB", "footprint"].iter().find(|name| !frame.has(name)) {
            frame.read(missing)?;
        }
        let arrays = pixels.read(&mut frame)?;
        let cloud = Cloud::read(&mut results.hits()?, &pixels)?;
        let table = results.objects()?;
        let notes = [
            pixels.note(),
            cloud.note(),
            about::missing(&results.summary),
        ];
        let notes: Vec<String> = notes.into_iter().flatten().collect();
        let hottest = hottest::json(&results.summary, &mut frame, &pixels)?;
        let about = about::json(&results.summary, &pixels, &arrays, &cloud, &notes, hottest);
        let mut payloads: Vec<Payload> = arrays
            .par_iter()
            .enumerate()
            .map(|(i, array)| Payload::of_numbers(&about::array_id(i), &array.values))
            .collect();
        payloads.extend(cloud.payloads());
        let n_pixel_bytes = payloads.iter().map(Payload::n_bytes).sum();
        payloads.extend(table.as_ref().map(table::payload));
        Ok(Self {
            title: results.summary.scene.name.clone(),
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
    /// What `out` says.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        html::write(&self.title, self.run, &self.about, &self.payloads, out)
    }

    /// What the page does not show, and why; one sentence or two each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
}
