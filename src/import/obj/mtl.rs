//! MTL: the materials of OBJ files.
//!
//! The format is described in "MTL material format" (Wavefront, 1995); `Pr`, `Pm` and `norm`
//! are the additions that programs for physically based rendering agree on.

use std::path::Path;

use arrayvec::ArrayVec;
use glam::Vec3;

use crate::left_out::LeftOut;
use crate::lines::Lines;
use crate::materials::{
    Finish, MAX_MATERIALS, MeshMaterial, MeshOpacity, MeshPicture, PictureShelf, path_in,
};
use crate::picture::bytes_of_file;
use crate::{FileFault, FileLocation, Result, open};
use world::color::Transfer;
use world::picture::{Sampling, Wrap};

/// Options of pictures, with the maximum number of values that follow them.
const OPTIONS: [(&str, usize); 13] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-bm", 1),
    ("-boost", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
    ("-type", 1),
];

/// Reads the materials of a file, whose pictures are in its folder, and appends them to `found`.
/// Leaves out statements that are damaged.
///
/// # Errors
/// The file cannot be read, or has too many materials.
pub(super) fn read(
    path: &Path,
    shelf: &mut PictureShelf,
    found: &mut Vec<MeshMaterial>,
    left_out: &mut LeftOut,
) -> Result<()> {
    let mut lines = Lines::of_file(open(path)?)?;
    let mut statements: Option<Statements> = None;
    let mut close = |statements: Option<Statements>, line: u64| {
        let made = statements.map(|of| of.material(path, shelf));
        if found.len() >= MAX_MATERIALS {
            let expected = format!("at most {MAX_MATERIALS}");
            let fault = FileFault::new("too many materials", expected);
            return Err(fault.at(FileLocation::Line(line)));
        }
        found.extend(made);
        Ok(())
    };
    while let Some((number, line)) = lines.next()? {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let is_read = match (keyword, &mut statements) {
            ("newmtl", _) => {
                close(statements.replace(Statements::new(rest.trim())), number)?;
                true
            }
            (_, Some(statements)) => statements.add(keyword, rest.trim()).is_some(),
            (word, None) => word.is_empty() || word.starts_with(['#', '$']),
        };
        if !is_read {
            let file = path.file_name().unwrap_or_default().display();
            let place = format_args!("line {number} of `{file}`");
            left_out.add("damaged statements of materials", place);
        }
    }
    close(statements, lines.number())
}

/// The statements about one material.
#[derive(Default)]
struct Statements {
    name: String,
    color: Option<Vec3>,
    specular: Vec3,
    emission: Vec3,
    exponent: Option<f32>,
    /// The number of the illumination model.
    illumination: f32,
    /// The value of `Tr`; programs write either this or `d`.
    transparency: Option<f32>,
    opacity_number: Option<f32>,
    roughness: Option<f32>,
    metallic: Option<f32>,
    index: Option<f32>,
    /// The pictures of the color, of the opacity and of normals.
    picture: Option<MapStatement>,
    opacity: Option<MapStatement>,
    normals: Option<MapStatement>,
}

/// A statement that names a picture.
struct MapStatement {
    file: String,
    wrap: Wrap,
    size: [f32; 2],
    offset: [f32; 2],
}

impl Statements {
    fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            ..Self::default()
        }
    }

    /// Adds a statement; unsupported ones are ignored. Returns `None` for a damaged one.
    fn add(&mut self, keyword: &str, rest: &str) -> Option<()> {
        match keyword {
            "Kd" => self.color = Some(color(rest)?),
            "Ks" => self.specular = color(rest)?,
            "Ke" => self.emission = color(rest)?,
            "Ns" => self.exponent = Some(number(rest)?.max(0.0)),
            "illum" => self.illumination = number(rest)?,
            "d" => self.opacity_number = Some(number(rest.trim_start_matches("-halo "))?),
            "Tr" => self.transparency = Some(number(rest)?),
            "Ni" => self.index = Some(number(rest)?),
            "Pr" => self.roughness = Some(number(rest)?.clamp(0.0, 1.0)),
            "Pm" => self.metallic = Some(number(rest)?.clamp(0.0, 1.0)),
            "map_Kd" => self.picture = Some(MapStatement::new(rest)?),
            "map_d" => self.opacity = Some(MapStatement::new(rest)?),
            "norm" => self.normals = Some(MapStatement::new(rest)?),
            _ => {}
        }
        Some(())
    }

    /// Returns the material, with its pictures.
    fn material(self, path: &Path, shelf: &mut PictureShelf) -> MeshMaterial {
        let mut color = self
            .color
            .unwrap_or(MeshMaterial::default().color)
            .min(Vec3::ONE);
        if self.picture.is_some() && color == Vec3::ZERO {
            // Programs write black if only the picture counts.
            color = Vec3::ONE;
        }
        let mut load = |map: Option<&MapStatement>, transfer| {
            map.and_then(|map| map.load(path, shelf, transfer))
        };
        let picture = load(self.picture.as_ref(), None);
        let picture = picture.map(|of| MeshPicture { tint: color, ..of });
        let opacity = load(self.opacity.as_ref(), Some(Transfer::Linear));
        let normals = load(self.normals.as_ref(), Some(Transfer::Linear));
        // The opacity of the picture of the color counts only without a picture of its own.
        let of_picture = || picture.clone().filter(|of| !of.picture.is_opaque());
        let opacity = MeshOpacity {
            factor: self.opacity(),
            picture: opacity.or_else(of_picture),
            threshold: None,
        };
        let doubts = self.doubts();
        MeshMaterial {
            finish: self.finish(),
            transmission: f32::from(u8::from(self.refracts())),
            index: self.index_behind(),
            emission: self.emission,
            opacity: Some(opacity).filter(|of| !of.is_full()),
            normal_map: normals.map(|normals| (normals, 1.0)),
            picture,
            doubts,
            ..MeshMaterial::new(&self.name, color)
        }
    }

    /// Returns the statements that programs write with different meanings.
    fn doubts(&self) -> Vec<&'static str> {
        let opaque = "`Tr 1` without `d` is read as opaque: write `d 0` for an invisible one";
        let dull = "an `Ns` below 1 is read as no highlight: write `Ns 1` for a wide one";
        let is_opaque = self.is_opaque_by_transparency() && !self.refracts();
        let is_dull = self.exponent.is_some() && self.highlight_exponent().is_none();
        let is_dull = is_dull && self.specular != Vec3::ZERO && !self.has_facets();
        let found = [is_opaque.then_some(opaque), is_dull.then_some(dull)];
        found.into_iter().flatten().collect()
    }

    /// Returns true if its illumination model describes glass, with refraction.
    fn is_glass(&self) -> bool {
        [4.0, 6.0, 7.0, 9.0].contains(&self.illumination)
    }

    /// Returns true if light passes through the glass everywhere.
    fn refracts(&self) -> bool {
        self.is_glass() && self.opacity.is_none()
    }

    /// Returns true if its transparency of 1 means opaque: programs that mistake it for the opacity
    /// write this for opaque surfaces, and an invisible one would serve no purpose.
    fn is_opaque_by_transparency(&self) -> bool {
        self.opacity_number.is_none() && self.transparency == Some(1.0)
    }

    /// Returns the share of light that the surface meets.
    fn opacity(&self) -> f32 {
        if self.refracts() || self.is_opaque_by_transparency() {
            return 1.0;
        }
        let opposite = self.transparency.map(|transparency| 1.0 - transparency);
        let opacity = self.opacity_number.or(opposite);
        opacity.unwrap_or(1.0).clamp(0.0, 1.0)
    }

    /// Returns the index of refraction of the inside: 1 if it is transparent without refraction.
    fn index_behind(&self) -> f32 {
        if self.is_glass() {
            let index = self.index.filter(|index| (1.0..=10.0).contains(index));
            index.unwrap_or(1.5)
        } else {
            1.0
        }
    }

    /// Returns true if it is described by a roughness or by a share of metal.
    fn has_facets(&self) -> bool {
        self.roughness.is_some() || self.metallic.is_some()
    }

    /// Returns the exponent of the highlight; `None` for a dull surface. Programs write an exponent
    /// below 1, a highlight as wide as the surface, for a dull one.
    fn highlight_exponent(&self) -> Option<f32> {
        self.exponent.filter(|exponent| *exponent >= 1.0)
    }

    fn finish(&self) -> Finish {
        if self.has_facets() {
            return Finish::Facets {
                metallic: self.metallic.unwrap_or(0.0),
                roughness: self.roughness.unwrap_or(0.5),
            };
        }
        let strength = self.specular.max_element().min(1.0);
        let mirrors = [3.0, 5.0].contains(&self.illumination);
        let exponent = self.highlight_exponent();
        Finish::Highlight {
            specular: exponent.map_or(0.0, |_| strength),
            exponent: exponent.unwrap_or(50.0),
            reflection: if mirrors { strength } else { 0.0 },
        }
    }
}

impl MapStatement {
    /// Splits options from the name of the file, which may contain blanks; `None` without a name.
    fn new(value: &str) -> Option<Self> {
        let (mut rest, mut wrap) = (value, Wrap::Repeat);
        let (mut size, mut offset) = ([1.0; 2], [0.0; 2]);
        while let Some(((name, most), behind)) = option(rest) {
            let words = behind.split_ascii_whitespace();
            let mut taken = 1;
            if most == 1 {
                if name == "-clamp" && words.clone().next() == Some("on") {
                    wrap = Wrap::Clamp;
                }
            } else {
                let numbers = words.map_while(|word| word.parse::<f32>().ok());
                let numbers: ArrayVec<f32, 3> = numbers.take(most).collect();
                taken = numbers.len();
                let values = |default: f32| [0, 1].map(|i| *numbers.get(i).unwrap_or(&default));
                match name {
                    "-s" if values(1.0).iter().all(|factor| factor.is_normal()) => {
                        size = values(1.0).map(|factor| 1.0 / factor);
                    }
                    "-o" if values(0.0).iter().all(|offset| offset.is_finite()) => {
                        offset = values(0.0);
                    }
                    _ => {}
                }
            }
            rest = behind_words(behind, taken);
        }
        (!rest.is_empty()).then(|| Self {
            file: rest.to_owned(),
            wrap,
            size,
            offset,
        })
    }

    /// Reads the picture; `None` with a note on the shelf if it cannot be read.
    fn load(
        &self,
        path: &Path,
        shelf: &mut PictureShelf,
        transfer: Option<Transfer>,
    ) -> Option<MeshPicture> {
        let name = path_in(path.parent().unwrap_or(Path::new("")), &self.file);
        let picture = shelf.picture_or_note(&name, transfer, || bytes_of_file(&name))?;
        let sampling = Sampling {
            wrap: self.wrap,
            ..Sampling::default()
        };
        Some(MeshPicture {
            sampling,
            size: self.size,
            offset: self.offset,
            ..MeshPicture::new(name, picture)
        })
    }
}

/// Returns the option that a value begins with, and the rest.
fn option(value: &str) -> Option<((&str, usize), &str)> {
    let (word, rest) = value.split_once(char::is_whitespace)?;
    let known = OPTIONS.iter().find(|(name, _)| *name == word)?;
    Some((*known, rest.trim_start()))
}

/// Returns a text without its first `n` words.
fn behind_words(text: &str, n: usize) -> &str {
    let behind = |text: &'_ str| -> usize {
        let end = text.find(char::is_whitespace).unwrap_or(text.len());
        text.len() - text[end..].trim_start().len()
    };
    (0..n).fold(text, |text, _| &text[behind(text)..])
}

/// Parses one to three numbers; the last one fills in for missing ones.
fn color(text: &str) -> Option<Vec3> {
    let mut words = text.split_ascii_whitespace();
    let first = number(words.next().unwrap_or_default())?;
    let mut color = Vec3::splat(first);
    for (channel, word) in (1..3).zip(words) {
        color[channel] = number(word)?;
    }
    Some(color.max(Vec3::ZERO))
}

/// Parses the first word as a finite number.
fn number(text: &str) -> Option<f32> {
    let word = text.split_ascii_whitespace().next()?;
    word.parse().ok().filter(|number: &f32| number.is_finite())
}
