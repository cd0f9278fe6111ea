//! Whole paths: the formulas of a scene's surfaces and lights, recorded as functions of the device's
//! language, and the numbers that they read.

use std::fmt::Write;

use indexmap::IndexSet;

use tracer::cost::N_BOUNCES;
use tracer::shade::{PathFormulas, PathRules, SurfaceKind};

use crate::shared::share;
use crate::step::{N_PLACE, N_SLOTS, PathStep, record, slot};
use crate::tape::{Register, Tables, Tape};

/// Words of a followed path.
pub(crate) const N_RESULTS: usize = 18 + N_BOUNCES;
/// Places for the media of a path.
const N_MEDIA: usize = 4;

/// What a device needs to follow the paths of a scene.
pub(crate) struct RecordedPaths {
    /// The functions, and the rules of the loop.
    pub(crate) text: String,
    /// For each primitive the number of its kind, and the start of its numbers in the second array;
    /// the numbers of the primitives; the numbers of the instances; and the tables.
    pub(crate) arrays: [Vec<u32>; 4],
}

impl RecordedPaths {
    /// Records the formulas.
    ///
    /// # Errors
    /// The part of the scene for which there are none.
    pub(crate) fn new(formulas: &PathFormulas) -> Result<Self, String> {
        if let Some(part) = formulas.refusal() {
            return Err(part.to_owned());
        }
        let (mut surfaces, mut data, mut places) = (Vec::new(), Vec::new(), Vec::new());
        let (mut kinds, mut last) = (IndexSet::new(), None);
        for primitive in 0..formulas.n_primitives() {
            let Some(kind) = formulas.kind(primitive) else {
                surfaces.extend([0; 2]);
                continue;
            };
            // Most primitives have the kind of the one before.
            let number = match last {
                Some((before, number)) if before == kind => number,
                _ => kinds.insert_full(kind).0,
            };
            last = Some((kind, number));
            surfaces.extend([number as u32, next_start(data.len(), "surfaces")?]);
            formulas.push_data(kind, primitive, &mut data);
        }
        formulas.push_instances(&mut places);
        let recorder = PathRecorder {
            formulas,
            tables: Tables::default(),
            text: String::new(),
            constants: Vec::new(),
        };
        let kinds: Vec<_> = kinds.into_iter().collect();
        let (text, tables) = recorder.record(&kinds)?;
        let [data, places] = [data, places].map(bytemuck::cast_vec);
        let arrays = [surfaces, data, places, tables];
        Ok(Self { text, arrays })
    }
}

/// Records formulas.
struct PathRecorder<'f> {
    formulas: &'f PathFormulas<'f>,
    tables: Tables,
    text: String,
    /// For each formula and number the function and the start of its constants; and the constants.
    constants: Vec<u32>,
}

/// Parameters of the functions that the loop calls, and of those that they choose from.
const STATE: &str = "const float *in, GLOBAL const uint *data, GLOBAL const uint *place, \
                     GLOBAL const uint *tables, float *out";

impl PathRecorder<'_> {
    /// Returns the text of all functions and rules for surfaces of these kinds, and the tables: of
    /// look-ups, the media, the constants, and the rules of the kinds.
    fn record(mut self, kinds: &[SurfaceKind]) -> Result<(String, Vec<u32>), String> {
        let formulas = self.formulas;
        let rules = formulas.rules();
        let lights: Vec<usize> = (0..rules.n_lights).collect();
        // The loop calls nothing else.
        let lit = if rules.n_lights > 0 { kinds } else { &[] };
        let open = if rules.has_openings { kinds } else { &[] };
        self.by_number("point", kinds, |step, kind| step.point(kind))?;
        self.by_number("own_light", kinds, |step, kind| step.own_light(kind))?;
        self.by_number("light", &lights, |step, i| step.light(i))?;
        self.by_number("shadow", lit, |step, kind| step.shadow(kind))?;
        self.by_number("reflected", lit, |step, kind| step.reflected(kind))?;
        self.by_number("passage", open, |step, kind| step.passage(kind))?;
        if rules.splits {
            self.by_number("split", kinds, |step, kind| step.split(kind))?;
        } else {
            self.by_number("next_ray", kinds, |step, kind| step.next(kind, false))?;
            self.by_number("late_ray", kinds, |step, kind| step.next(kind, true))?;
        }
        self.by_number("background", &[()], |step, ()| step.background())?;
        self.by_number("flight", &[()], |step, ()| step.flight())?;
        self.by_number("fade", &[()], |step, ()| step.fade())?;
        let (mut text, mut tables) = (String::new(), self.tables.into_words());
        let mut append = |name: &str, words: Vec<u32>| {
            let _ = writeln!(text, "#define {name} {}ul", tables.len());
            tables.extend(words);
        };
        let media = formulas.media();
        let media = media.as_flattened().iter().map(|number| number.to_bits());
        append("FIRST_MEDIUM", media.collect());
        append("FIRST_CONSTANT", self.constants);
        let kinds = kinds.iter().map(|kind| kind_rules(formulas, *kind));
        append("FIRST_KIND", kinds.collect());
        Ok((text + &self.text + &defines(&rules), tables))
    }

    /// Records a step for each of these kinds or lights: as one function where only constants
    /// differ, and a function that chooses one by its number.
    fn by_number<K: Copy>(
        &mut self,
        stem: &str,
        of: &[K],
        step: impl for<'a, 't> Fn(&PathStep<'a, Register<'t>>, K) -> Vec<Register<'t>>,
    ) -> Result<(), String> {
        let mut programs = Vec::new();
        for &kind in of {
            let tape = Tape::with_tables(&self.tables);
            programs.push(record(self.formulas, &tape, |of| step(of, kind)));
            if let Some(reason) = tape.refusal() {
                return Err(reason.to_owned());
            }
        }
        let places = self.tables.all();
        let (shared, constants) = share(&programs, &places);
        let mut cases = String::new();
        for (i, statements) in shared.into_iter().enumerate() {
            let name = format!("{stem}_{i}");
            let _ = writeln!(
                self.text,
                "FUNCTION void {name}({STATE}, GLOBAL const uint *constants) {{\n{statements}}}"
            );
            let call = format!("{name}(in, data, place, tables, out, constants); break;");
            let _ = writeln!(cases, "    case {i}u: {call}");
        }
        let first = self.constants.len();
        self.constants.resize(first + 2 * of.len(), 0);
        for (number, (function, constants)) in constants.into_iter().enumerate() {
            let start = next_start(self.constants.len(), "materials and lights")?;
            self.constants[first + 2 * number..][..2].copy_from_slice(&[function as u32, start]);
            self.constants.extend(constants);
        }
        let _ = writeln!(
            self.text,
            "FUNCTION void {stem}(uint number, {STATE}) {{
  GLOBAL const uint *chosen = tables + FIRST_CONSTANT + {first}ul + 2ul * number;
  GLOBAL const uint *constants = tables + FIRST_CONSTANT + chosen[1];
  switch (chosen[0]) {{
{cases}  }}
}}"
        );
        Ok(())
    }
}

/// Returns the rules of the loop at a kind of surfaces: bits that `path.cl` names; above these the
/// material plus 1 if a medium is behind the surface.
fn kind_rules(formulas: &PathFormulas, kind: SurfaceKind) -> u32 {
    let rules = formulas.surface(formulas.material(kind));
    let medium = u32::from(rules.is_medium) * (kind.class.material().0 + 1);
    let flags = [rules.is_veil, rules.is_open, rules.continues, rules.is_lit];
    let with = |bits: u32, flag: bool| bits << 1 | u32::from(flag);
    flags.into_iter().fold(medium, with)
}

/// Returns the start of the next numbers in an array of this length.
///
/// # Errors
/// Devices have 32 bits for it; `of` names the numbers.
pub(crate) fn next_start(len: usize, of: &str) -> Result<u32, String> {
    u32::try_from(len).map_err(|_| format!("more than 2^32 numbers of {of}"))
}

/// Returns the slots and the rules of the loop as macros.
fn defines(rules: &PathRules) -> String {
    let [first, step] = rules.dimensions;
    let numbers = [
        ("N_SLOTS", N_SLOTS as u32),
        ("N_MEDIA", N_MEDIA as u32),
        ("N_RESULTS", N_RESULTS as u32),
        ("N_BOUNCES", N_BOUNCES as u32),
        ("N_PLACE", N_PLACE as u32),
        ("N_LIGHTS", rules.n_lights as u32),
        ("SPLITS", rules.splits.into()),
        ("HAS_MEDIA", rules.has_media.into()),
        ("HAS_OPENINGS", rules.has_openings.into()),
        ("WEAKENS_LIGHTS", rules.weakens_lights.into()),
        ("HAS_FADING_FOG", rules.has_fading_fog.into()),
        ("PARTICLES", rules.particles.unwrap_or(u32::MAX)),
        ("MAX_DEPTH", rules.max_depth),
        ("LATE_DEPTH", rules.late_depth),
        ("FIRST_DIMENSION", first),
        ("DIMENSION_STEP", step),
        ("LIGHTS_LAST_POINTS", rules.lights_last_points.into()),
        ("CASTS_SHADOWS", rules.casts_shadows.into()),
        ("IGNORES_OWN_OBJECT", rules.ignores_own_object.into()),
        ("NEEDS_LIGHT", rules.needs_light.into()),
    ];
    let numbers = slot::ALL.iter().chain(&numbers);
    let lines = numbers.map(|(name, number)| format!("#define {name} {number}u\n"));
    lines.collect()
}

#[cfg(test)]
mod tests {
    use math::sampling::{PixelPattern, Sampler};
    use tracer::shade::Shader;

    use super::*;
    use crate::step::tests::built;

    #[test]
    fn materials_of_other_numbers_share_their_functions() {
        let text = |material: &str| {
            let scene = built(&format!(
                "lights: []
materials: {{ a: {{ color: [0.1, 1, 0.3], specular: 0.5 }}, b: {{ {material} }} }}
objects:
  - {{ sphere: {{ center: [0, 0, 0], radius: 1 }}, material: a }}
  - {{ sphere: {{ center: [3, 0, 0], radius: 1 }}, material: b }}
"
            ));
            let shader = Shader::new(&scene, Sampler::new(PixelPattern::Sobol, 1, 7));
            RecordedPaths::new(&shader.formulas(None)).unwrap().text
        };
        let same = text("color: 0.5, specular: 0.1");
        assert!(!same.contains("point_1("), "{same}");
        assert!(text("color: { checker: { even: 1, odd: 0, size: 1 } }").contains("point_1("));
    }

    #[test]
    fn scenes_without_formulas_are_refused_by_name() {
        let light = "{ directional: { direction: [0, -1, 0], intensity: 1 } }";
        let scene = built(&format!(
            "shading: {{ model: path }}
materials: {{ a: {{ color: 1 }} }}
lights: [{}]
objects: [{{ sphere: {{ center: [0, 0, 0], radius: 1 }}, material: a }}]
",
            [light; 33].join(", ")
        ));
        let formulas = Shader::new(&scene, Sampler::new(PixelPattern::Sobol, 1, 7)).formulas(None);
        assert_eq!(
            RecordedPaths::new(&formulas).err().as_deref(),
            Some("a choice among more than 32 lights")
        );
    }

    #[test]
    fn starts_of_more_than_32_bits_are_refused() {
        assert_eq!(next_start(u32::MAX as usize, "surfaces"), Ok(u32::MAX));
        let refused = next_start(1 << 32, "surfaces").unwrap_err();
        assert_eq!(refused, "more than 2^32 numbers of surfaces");
    }
}
