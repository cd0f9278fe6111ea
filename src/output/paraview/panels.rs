//! The layout of a state's panels, and the size of the picture in each.

use super::template::StateValue;

/// Minimum aspect ratio, width over height, of the area of all panels in ParaView's window: a
/// narrower area cuts off the sides of the pictures.
const AREA_ASPECT: f64 = 1.55;
/// Height of a title as a fraction of that area's height.
const TITLE: f64 = 0.05;
/// Height of a color bar with its labels as a fraction of that area's height.
const COLOR_BAR: f64 = 0.085;
/// Maximum fraction of a panel's width that a picture fills.
const FILLED_WIDTH: f64 = 0.96;
/// Aspect ratio above which panels are stacked in rows.
const WIDE: f64 = 2.1;
/// Aspect ratio below which panels stand side by side in columns.
const TALL: f64 = 0.64;
/// ParaView's direction of a split into rows.
const ROWS: u8 = 1;
/// ParaView's direction of a split into columns.
const COLUMNS: u8 = 2;

/// The layout of two, three or four panels that show pictures of the same size.
#[derive(Clone, Copy, Debug)]
pub struct Panels {
    n: u32,
    /// Width over height.
    picture_aspect: f64,
}

impl Panels {
    /// Creates the layout of `n` panels for pictures of `width * height`.
    pub fn new(n: u32, [width, height]: [f64; 2]) -> Self {
        Self {
            n,
            picture_aspect: width / height,
        }
    }

    /// Splits a key such as `image3.parallel_scale`, where `name` is `image`, into the number of
    /// panels and the rest after the dot.
    pub(crate) fn split_key<'k>(key: &'k str, name: &str) -> Option<(u32, &'k str)> {
        let (n, rest) = key.strip_prefix(name)?.split_once('.')?;
        Some((n.parse().ok()?, rest))
    }

    /// Returns ParaView's direction of the first split (`outer`) or of the remaining splits
    /// (`inner`).
    pub fn direction(self, split: &str) -> Option<u8> {
        let (is_wide, is_tall) = (self.is_wide(), self.is_tall());
        let is_in_rows = match (self.n, split) {
            (2, "outer") | (3, "inner") => is_wide,
            (3 | 4, "outer") => !is_tall,
            (4, "inner") => false,
            _ => return None,
        };
        Some(if is_in_rows { ROWS } else { COLUMNS })
    }

    /// Returns the shape of one panel.
    pub fn panel(self) -> Panel {
        let [width, height] = match self.n {
            2 if self.is_wide() => [1.0, 0.5],
            2 => [0.5, 1.0],
            3 if self.is_wide() => [1.0, 0.335],
            3 if self.is_tall() => [0.335, 1.0],
            3 => [0.5, 0.67],
            _ if self.is_tall() => [0.25, 1.0],
            _ => [0.5, 0.5],
        };
        Panel {
            aspect: AREA_ASPECT * width / height,
            title: TITLE / height,
            color_bar: COLOR_BAR / height,
        }
    }

    /// Returns the number of labels that fit beside a panel's color bar.
    pub fn n_labels(self) -> usize {
        if self.is_tall() && self.n > 2 { 4 } else { 6 }
    }

    fn is_wide(self) -> bool {
        self.picture_aspect > WIDE
    }

    fn is_tall(self) -> bool {
        self.picture_aspect < TALL
    }
}

/// The shape of a panel.
#[derive(Clone, Copy, Debug)]
pub struct Panel {
    /// Width over height.
    aspect: f64,
    /// Height of the title as a fraction of the panel's height.
    title: f64,
    /// Height of the color bar as a fraction of the panel's height.
    color_bar: f64,
}

impl Panel {
    /// Returns half the height of the view for which an object of `width * height` in its middle
    /// fills the panel between title and color bar, in the unit of `width` and `height`.
    pub(crate) fn half_height(self, [width, height]: [f64; 2]) -> f64 {
        let by_height = height / (2.0 * (1.0 - 2.0 * self.color_bar.max(self.title)));
        by_height.max(self.half_height_for(width))
    }

    fn half_height_for(self, width: f64) -> f64 {
        width / (2.0 * FILLED_WIDTH * self.aspect)
    }

    /// Returns the value of a key of a flat picture's camera, in pixels. The camera looks at a
    /// point below the middle, since the color bar is higher than the title.
    pub(crate) fn picture_camera(self, [width, height]: [f64; 2], key: &str) -> Option<f64> {
        let by_height = height / (2.0 * (1.0 - self.title - self.color_bar));
        let scale = by_height.max(self.half_height_for(width));
        match key {
            "parallel_scale" => Some(scale),
            "center.0" => Some(0.5 * (width - 1.0)),
            "center.1" => Some(0.5 * (height - 1.0) - (self.color_bar - self.title) * scale),
            _ => None,
        }
    }
}

/// Returns the value of a layout key, such as `panels3.outer`, or of a camera key of a picture in
/// one of its panels, such as `image3.parallel_scale`; `None` for other keys.
pub fn value_of_panels(size: [f64; 2], key: &str) -> Option<StateValue> {
    if let Some((n, split)) = Panels::split_key(key, "panels") {
        return Some(Panels::new(n, size).direction(split)?.to_string().into());
    }
    let (n, key) = Panels::split_key(key, "image")?;
    let number = Panels::new(n, size).panel().picture_camera(size, key)?;
    Some(number.to_string().into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_fits_between_title_and_color_bar_and_fills_its_panel() {
        for n in 2..=4 {
            for size in [[400.0, 300.0], [1600.0, 400.0], [300.0, 900.0], [1.0, 1.0]] {
                let panel = Panels::new(n, size).panel();
                let at = |key| panel.picture_camera(size, key).unwrap();
                let scale = at("parallel_scale");
                let [part_of_width, part_of_height] =
                    [size[0] / panel.aspect, size[1]].map(|length| length / (2.0 * scale));
                let room = 1.0 - panel.title - panel.color_bar;
                assert!(part_of_width <= 0.961 && part_of_height <= room + 1e-9);
                let filled = (part_of_width / 0.96).max(part_of_height / room);
                assert!(filled > 0.999, "{n} panels, {size:?}: {filled}");
                let bottom = at("center.1") - scale;
                let free = (-0.5 - bottom) / (2.0 * scale);
                assert!(
                    free >= panel.color_bar - 1e-9,
                    "{n} panels, {size:?}: {free}"
                );
            }
        }
    }

    #[test]
    fn wide_pictures_stand_in_rows_and_tall_ones_in_columns() {
        let splits = |n, size| {
            let panels = Panels::new(n, size);
            ["outer", "inner"].map(|split| panels.direction(split))
        };
        let (usual, wide, tall) = ([4.0, 3.0], [4.0, 1.0], [1.0, 3.0]);
        assert_eq!(splits(2, usual)[0], Some(COLUMNS));
        assert_eq!(splits(2, wide)[0], Some(ROWS));
        assert_eq!(splits(3, usual), [Some(ROWS), Some(COLUMNS)]);
        assert_eq!(splits(3, wide), [Some(ROWS), Some(ROWS)]);
        assert_eq!(splits(3, tall), [Some(COLUMNS), Some(COLUMNS)]);
        assert_eq!(splits(4, usual), [Some(ROWS), Some(COLUMNS)]);
        assert_eq!(splits(4, tall), [Some(COLUMNS), Some(COLUMNS)]);
    }
}
