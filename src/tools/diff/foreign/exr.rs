//! OpenEXR pictures, with the channels `R`, `G` and `B`, and maps of one channel.

use std::io::Cursor;

use exr::error::Error;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, Vec2};

use super::source::{ForeignNumbers, ForeignSource};
use host::text::Diagnostic;

/// The first bytes of a file.
pub(super) const SIGNATURE: &[u8] = b"\x76\x2f\x31\x01";

/// Errors in parts that are not read are not reported.
const IS_STRICT: bool = false;

/// Reads the numbers of the only part.
pub(super) fn read(source: &ForeignSource) -> Result<ForeignNumbers, Diagnostic> {
    let damaged = |error: Error| {
        let problem = format!("the OpenEXR picture cannot be decoded: {error}");
        source.refuse(problem, "write it again, and close the file")
    };
    let file = exr::block::read(Cursor::new(&source.bytes), IS_STRICT).map_err(damaged)?;
    let [header] = file.headers() else {
        let problem = format!("it has {} parts", file.headers().len());
        return Err(source.refuse(problem, "write a file with one part"));
    };
    let Vec2(width, height) = header.layer_size;
    source.check_size([width as u64, height as u64])?;
    let names = header.channels.list.iter();
    let names: Vec<String> = names.map(|channel| channel.name.to_string()).collect();
    let rgb = ["R", "G", "B"].map(str::to_owned);
    let chosen = match &names[..] {
        names if rgb.iter().all(|name| names.contains(name)) => &rgb[..],
        [_] => &names[..],
        _ => {
            let problem = format!("its channels are {}", names.join(", "));
            let help = "write `R`, `G` and `B` for a picture, a single channel for a cost map";
            return Err(source.refuse(problem, help));
        }
    };
    let n_channels = chosen.len();
    let mut values = vec![0.0; n_channels * source.n_pixels()];
    for (i, name) in chosen.iter().enumerate() {
        let channel = read_channel(source, name).map_err(damaged)?;
        let of_channel = values.iter_mut().skip(i).step_by(n_channels);
        of_channel
            .zip(channel)
            .for_each(|(value, number)| *value = number.into());
    }
    Ok(ForeignNumbers { n_channels, values })
}

/// Reads a channel, row-major, row 0 on top.
fn read_channel(source: &ForeignSource, name: &str) -> Result<Vec<f32>, Error> {
    let reader = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(name)
        .collect_pixels(
            |size: Vec2<usize>, _| (size.0, vec![0.0; size.area()]),
            |(width, numbers), at: Vec2<usize>, (number,): (f32,)| {
                numbers[at.1 * *width + at.0] = number;
            },
        );
    let reader = reader.first_valid_layer().all_attributes().non_parallel();
    let image = reader.from_buffered(Cursor::new(&source.bytes))?;
    Ok(image.layer_data.channel_data.pixels.1)
}
