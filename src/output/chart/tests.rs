//! Tests of the whole picture.

use image::Rgb;

use super::colors::NO_VALUE;
use super::*;
use world::color::{ColorMap, rgb8};

fn map(values: &[f32], width: u32) -> CostMap<'_> {
    let height = values.len() as u32 / width;
    CostMap {
        values,
        range: Range::spanning(values),
        width,
        height,
        title: "title",
        unit: "ns",
        subtitle: "subtitle",
    }
}

/// Returns the color in the middle of each value's square.
fn drawn_colors(map: &CostMap) -> Vec<Rgb<u8>> {
    let picture = draw(map);
    let Layout {
        map: at,
        magnification,
        ..
    } = Layout::new(map);
    let middle = |start: f32, i: u32| start as u32 + i * magnification + magnification / 2;
    (0..map.values.len() as u32)
        .map(|i| *picture.get_pixel(middle(at.x, i % map.width), middle(at.y, i / map.width)))
        .collect()
}

fn inferno(t: f64) -> Rgb<u8> {
    Rgb(rgb8(ColorMap::Inferno.at(t)))
}

fn is_close(a: Rgb<u8>, b: Rgb<u8>) -> bool {
    a.0.iter().zip(b.0).all(|(a, b)| a.abs_diff(b) <= 8)
}

#[test]
fn each_value_has_its_color() {
    let colors = drawn_colors(&map(&[10.0, 1e5, f32::NAN, 1e5, 10.0, 1e3], 3));
    let [low, high] = [inferno(0.0), inferno(1.0)];
    assert_eq!(colors[..5], [low, high, NO_VALUE, high, low]);
    assert!(is_close(colors[5], inferno(0.5)));
}

#[test]
fn each_change_has_its_color() {
    let values = [-10.0, 0.0, 10.0, f32::NAN];
    let changes = CostMap {
        range: Range::around_zero(&values),
        ..map(&values, 2)
    };
    let red_blue = |t: f64| Rgb(rgb8(ColorMap::RedBlue.at(1.0 - t)));
    let colors = drawn_colors(&changes);
    assert_eq!(
        [colors[0], colors[2], colors[3]],
        [red_blue(0.0), red_blue(1.0), NO_VALUE]
    );
    assert!(is_close(colors[1], red_blue(0.5)));
}

#[test]
fn each_value_is_a_square_within_the_frame() {
    let map = map(&[10.0, 1e5, 1e5, 1e5, 10.0, 1e5], 3);
    let (picture, at) = (draw(&map), Layout::new(&map).map);
    let pixel = |x: f32, y: f32| *picture.get_pixel(x as u32, y as u32);
    let [low, high] = [inferno(0.0), inferno(1.0)];
    assert_eq!([at.width, at.height], [600.0, 400.0]);
    assert_eq!(
        [pixel(at.x, at.y), pixel(at.x + 199.0, at.y + 199.0)],
        [low; 2]
    );
    assert_eq!(
        [pixel(at.x + 200.0, at.y), pixel(at.x, at.y + 200.0)],
        [high; 2]
    );
    assert_eq!(
        [
            pixel(at.x - 1.0, at.y - 1.0),
            pixel(at.right(), at.bottom())
        ],
        [LINE; 2]
    );
}

#[test]
fn an_outlier_does_not_flatten_the_rest() {
    let mut values: Vec<f32> = (0..600)
        .map(|i| if i < 300 { 300.0 } else { 900.0 })
        .collect();
    let calm = drawn_colors(&map(&values, 30));
    values[45] = 4e5;
    let disturbed = drawn_colors(&map(&values, 30));
    assert_eq!([disturbed[0], disturbed[45]], [inferno(0.0), inferno(1.0)]);
    let n_changed = calm
        .iter()
        .zip(&disturbed)
        .filter(|(a, b)| !is_close(**a, **b))
        .count();
    assert_eq!(n_changed, 1);
}

#[test]
fn a_constant_map_has_the_middle_color() {
    let colors = drawn_colors(&map(&[412.0; 12], 4));
    assert!(colors.iter().all(|&color| is_close(color, inferno(0.5))));
}

#[test]
fn the_bar_has_the_colors_of_the_values() {
    let values: Vec<f32> = (0..40).map(|i| 10f32.powf(2.0 + i as f32 / 13.0)).collect();
    for width in [40, 5] {
        let map = map(&values, width);
        let range = Range::spanning(&values);
        let (picture, colors) = (draw(&map), Colors::over(&range));
        let Layout {
            bar,
            bar_corner: [x, y],
            map: at,
            ..
        } = Layout::new(&map);
        for value in [101.0, 500.0, 1e4, 99e3] {
            let along = |length: f32| (range.position(value) as f32 * length).floor();
            let [x, y] = match bar.edge {
                AxisEdge::Bottom => [x + along(at.width), y + 2.0],
                _ => [x + 2.0, y + at.height - 1.0 - along(at.height)],
            };
            let pixel = picture.get_pixel(x as u32, y as u32);
            assert!(
                is_close(*pixel, colors.look_up(&[value as f32]).next().unwrap()),
                "{value}: {pixel:?}"
            );
        }
    }
}

#[test]
fn ticks_at_the_ends_of_a_large_bar_stay_within_it() {
    let values: Vec<f32> = (0..40 * 4000).map(|i| 1.0 + (i % 10) as f32).collect();
    let map = map(&values, 40);
    assert_eq!(Layout::new(&map).bar.edge, AxisEdge::Right);
    assert!(has_blank_rim(&draw(&map)));
}

/// Returns true if the outermost four pixels on each side are blank.
fn has_blank_rim(picture: &RgbImage) -> bool {
    let (width, height) = picture.dimensions();
    let is_blank = |x, y| picture.get_pixel(x, y).0 == [PAPER; 3];
    (0..4).all(|i| {
        (0..width).all(|x| is_blank(x, i) && is_blank(x, height - 1 - i))
            && (0..height).all(|y| is_blank(i, y) && is_blank(width - 1 - i, y))
    })
}

#[test]
fn any_text_and_value_fit_without_a_panic() {
    let long = "über-Szene ä, 場面, \n\t, 🙂 ".repeat(40);
    let strange = [
        f32::NAN,
        f32::INFINITY,
        0.0,
        -1.0,
        f32::MAX,
        f32::MIN_POSITIVE,
        1e-42,
        7.0,
    ];
    let strange: Vec<f32> = strange.into_iter().cycle().take(10_000).collect();
    let steady: Vec<f32> = (0..3000).map(|i| 1.0 + i as f32).collect();
    let maps: [(&[f32], u32); 6] = [
        (&[412.0], 1),
        (&[f32::NAN; 4], 2),
        (&strange, 10_000),
        (&strange[..3000], 1),
        (&steady, 100),
        (&steady, 30),
    ];
    for (values, width) in maps {
        let texts = [(long.as_str(), "ns"), ("", long.as_str())];
        let ranges: [fn(&[f32]) -> Range; 2] =
            [|values| Range::spanning(values), Range::around_zero];
        for ((title, unit), range) in texts.into_iter().flat_map(|t| ranges.map(|r| (t, r))) {
            let picture = draw(&CostMap {
                range: range(values),
                title,
                unit,
                subtitle: title,
                ..map(values, width)
            });
            assert!(
                has_blank_rim(&picture),
                "{} values, {width} a row",
                values.len()
            );
        }
    }
}

/// The pixels and the texts of a PNG.
fn decoded(file: &[u8]) -> (Vec<u8>, Vec<(String, String)>) {
    let mut reader = ::png::Decoder::new(std::io::Cursor::new(file))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    reader.finish().unwrap();
    let texts = reader.info().uncompressed_latin1_text.iter();
    let texts = texts.map(|chunk| (chunk.keyword.clone(), chunk.text.clone()));
    (pixels, texts.collect())
}

#[test]
fn a_png_keeps_pixels_of_8_and_16_bits_and_texts() {
    let texts = [("raycost_run", "7"), ("ParaViewState", "<a/>")];
    let pixels: Vec<u8> = (0..300 * 70_u32).map(|i| ((i * i) >> 7) as u8).collect();
    for (width, pixel_bytes) in [(100, 3), (50, 6)] {
        let mut file = Vec::new();
        let write = |rows: &mut dyn Write| rows.write_all(&pixels);
        png::write([width, 70], pixel_bytes, &texts, &mut file, write).unwrap();
        let (found, found_texts) = decoded(&file);
        assert!(found == pixels);
        let expected = texts.map(|(keyword, text)| (keyword.to_owned(), text.to_owned()));
        assert_eq!(found_texts, expected);
    }
}

#[test]
fn a_png_passes_on_the_error_of_its_file() {
    let mut full = [0_u8; 100];
    let write = |rows: &mut dyn Write| rows.write_all(&[1; 3000]);
    let error = png::write([100, 10], 3, &[], &mut &mut full[..], write).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::WriteZero);
}
