//! The page in a real browser.

mod extremes;
mod interaction;
mod layout;
mod values;

use std::collections::HashSet;
use std::path::Path;

use image::RgbaImage;
use serde_json::Value;

use crate::common::chromium::Chromium;
use crate::view::SIZE;
use output::results::{LoadedArray, Results};

/// The size of a typical window.
pub const WINDOW: [u32; 2] = [1400, 1000];

/// All arrays of a rendering.
pub fn arrays(folder: &Path) -> Vec<LoadedArray> {
    let frame = Results::open(folder).unwrap().frame().unwrap();
    let names: Vec<String> = frame
        .arrays()
        .iter()
        .map(|info| info.name.clone())
        .collect();
    names.iter().map(|name| frame.read(name).unwrap()).collect()
}

pub fn array<'a>(arrays: &'a [LoadedArray], name: &str) -> &'a LoadedArray {
    arrays.iter().find(|array| array.name == name).unwrap()
}

/// Moves the pointer to the center of a pixel of a pane.
pub fn point_at_pixel(browser: &mut Chromium, pane: &str, [x, y]: [u32; 2]) {
    let [left, top, width, height] = browser.place(&format!("{pane} canvas"));
    let at = |begin, size, i, n| begin + size * (f64::from(i) + 0.5) / f64::from(n);
    let (x, y) = (at(left, width, x, SIZE[0]), at(top, height, y, SIZE[1]));
    browser.point("mouseMoved", x, y);
}

/// The numbers of an array in the probe panel.
pub fn probed(browser: &mut Chromium, array: &str) -> Vec<f64> {
    let values = browser.value(&format!(
        "Array.from(document.querySelectorAll('#probe [data-array={array}] data'), (data) => data.value)"
    ));
    let number = |value: &Value| value.as_str().unwrap().parse().unwrap();
    values.as_array().unwrap().iter().map(number).collect()
}

/// A canvas's pixels, four bytes each.
pub fn pixels(browser: &mut Chromium, pane: &str) -> Vec<[u8; 4]> {
    let pixels = browser.value(&format!(
        "(() => {{
            const canvas = document.querySelector('{pane} canvas');
            const copy = new OffscreenCanvas(canvas.width, canvas.height);
            const context = copy.getContext('2d', {{ willReadFrequently: true }});
            context.drawImage(canvas, 0, 0);
            return Array.from(context.getImageData(0, 0, canvas.width, canvas.height).data);
        }})()"
    ));
    let bytes: Vec<u8> = serde_json::from_value(pixels).unwrap();
    bytes
        .chunks_exact(4)
        .map(|pixel| pixel.try_into().unwrap())
        .collect()
}

/// The number of different colors in a part of a screenshot.
pub fn n_colors(picture: &RgbaImage, [left, top, width, height]: [f64; 4]) -> usize {
    let part = image::imageops::crop_imm(
        picture,
        left as u32,
        top as u32,
        width as u32,
        height as u32,
    );
    let colors = part
        .to_image()
        .pixels()
        .map(|pixel| pixel.0)
        .collect::<HashSet<_>>();
    colors.len()
}

/// Chooses an entry of a menu.
pub fn choose(browser: &mut Chromium, menu: &str, entry: &str) {
    browser.value(&format!(
        "(() => {{
            const menu = document.querySelector('{menu}');
            menu.value = '{entry}';
            menu.dispatchEvent(new Event('change'));
        }})()"
    ));
    browser.wait_until("true");
}

/// A table of objects.
pub const OBJECTS: &str = "\
kind,id,name,charge,ray_kind,pixels,rays,time_ns,pixels_share,rays_share,time_ns_share
object,0,blue ball,primary,all,20000,40000,3000000,0.4,0.3,0.25
object,1,\"<img src=x onerror=alert(1)>\",primary,all,10000,60000,8000000,0.2,0.5,0.65
object,2,,primary,all,20000,30000,1000000,0.4,0.2,0.1
material,0,blue,primary,all,20000,40000,3000000,0.4,0.3,0.25
object,0,blue ball,hit,all,20000,40000,3000000,0.4,0.3,0.25
";
