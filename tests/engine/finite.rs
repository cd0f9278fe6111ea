//! Random materials at the ends of their ranges, under lights at the ends of theirs: every pixel
//! is a number.

use std::fmt::Write;

use crate::common::radiance;

/// Its smooth normals are those of its corners, far from those of its faces.
const TETRAHEDRON: &str = "v 0.5 0.5 0.5
v -0.5 -0.5 0.5
v -0.5 0.5 -0.5
v 0.5 -0.5 -0.5
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
";

/// Chooses among values.
struct Random(u32);

impl Random {
    fn of<'a>(&mut self, choices: &[&'a str]) -> &'a str {
        // The linear congruential generator of Numerical Recipes.
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        choices[(self.0 >> 16) as usize % choices.len()]
    }

    fn material(&mut self) -> String {
        let fraction = &["0", "1e-9", "0.01", "0.011", "0.4", "1"];
        let metal = &["0", "1e-15", "1", "3", "1000", "[0, 1000, 1]"];
        let index = &["1", "1.0004", "1.002", "1.5", "10"];
        let color = self.of(&["0", "1", "[1, 0, 0]", "[0.2, 0.5, 1]"]);
        let kind = match self.of(&["lobes", "conductor", "dielectric", "principled"]) {
            "lobes" => format!(
                "diffuse: {}, specular: {}, exponent: {}, reflection: {}",
                self.of(fraction),
                self.of(fraction),
                self.of(&["0", "1", "50", "1e9", "1e15"]),
                self.of(fraction)
            ),
            "conductor" => format!(
                "conductor: {{ index: {}, extinction: {} }}, roughness: {}",
                self.of(metal),
                self.of(metal),
                self.of(fraction)
            ),
            "dielectric" => format!(
                "dielectric: {{ index: {}, absorption: {} }}, roughness: {}",
                self.of(index),
                self.of(&["0", "1e15", "[0, 1e-15, 3]"]),
                self.of(fraction)
            ),
            _ => format!(
                "principled: {{ metallic: {}, roughness: {}, transmission: {}, index: {} }}",
                self.of(fraction),
                self.of(fraction),
                self.of(fraction),
                self.of(index)
            ),
        };
        let multiple = self.of(&["true", "false"]);
        let emission = self.of(&["0", "0", "0", "0", "0", "[1e15, 0, 1]"]);
        format!(
            "{{ color: {color}, {kind}, multiple_scattering: {multiple}, emission: {emission} }}"
        )
    }
}

#[test]
fn no_pixel_of_900_random_materials_is_not_a_number() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tetrahedron.obj");
    std::fs::write(&file, TETRAHEDRON).unwrap();
    let mesh = format!("mesh: {{ file: {file:?}, normals: smooth }}");
    let mut random = Random(1);
    for surroundings in [
        "background: 1",
        "background: 1e15",
        "background: { sky: { sun: { elevation_deg: 0 }, turbidity: 10, intensity: 1e15 } }",
        "background: { sky: { sun: { elevation_deg: 90 } } }
fog: { mean_free_path: 1e-15, anisotropy: 0.99 }",
        "background: 1
fog: { mean_free_path: 1e15, anisotropy: -0.99, radius: 1e15 }",
        "background: 1
fog: { mean_free_path: 0.1, color: [1, 0, 0.5], anisotropy: -0.99 }",
    ] {
        let (mut materials, mut objects) = (String::new(), String::new());
        for i in 0..150 {
            writeln!(materials, "  m{i}: {}", random.material()).unwrap();
            let (x, y) = (i % 15, i / 15);
            let shape = random.of(&[
                "sphere: { center: [0, 0, 0], radius: 0.5 }",
                "box: { min: [-0.4, -0.4, -0.4], max: [0.4, 0.4, 0.4] }",
                &mesh,
            ]);
            writeln!(
                objects,
                "  - {{ {shape}, transform: [{{ translate: [{x}, {y}, 0] }}], material: m{i} }}"
            )
            .unwrap();
        }
        let radiance = radiance(&format!(
            "image: {{ width: 60, height: 40, samples_per_pixel: 2 }}
camera: {{ orthographic: {{ eye: [7, 4.5, 5], target: [7, 4.5, 0], height: 10 }} }}
shading: {{ model: path, max_depth: 8, masking: {masking} }}
cost: counters
{surroundings}
materials:
{materials}lights:
  - point: {{ position: [3, 4, 0.5], intensity: 1e15, color: [1e15, 0, 1], falloff: inverse_square }}
  - directional: {{ direction: [0, -1, -1], intensity: 1e15, color: 1e15 }}
  - spot: {{ position: [0, 0, 9], target: [7, 4, 0], angle_deg: 60, intensity: 3 }}
objects:
{objects}",
            masking = random.of(&["separable", "height_correlated"])
        ));
        let wrong = radiance.iter().filter(|light| !light.is_finite()).count();
        assert_eq!(wrong, 0, "{surroundings}");
    }
}
