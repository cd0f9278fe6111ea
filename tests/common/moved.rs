//! Scenes of another size and at another place.

use serde_yaml::{Mapping, Value};

/// A similarity: coordinates are scaled, then shifted.
#[derive(Debug, Clone, Copy)]
pub struct Similarity {
    pub scale: f64,
    pub shift: [f64; 3],
}

impl Similarity {
    /// The text of a scene under the similarity, with everything that has a length.
    pub fn of_text(&self, text: &str) -> String {
        let mut scene: Value = serde_yaml::from_str(text).unwrap();
        for camera in values_of(&mut scene, "camera") {
            self.camera(camera);
        }
        for object in list_of(&mut scene, "objects") {
            self.object(object.as_mapping_mut().unwrap());
        }
        for light in list_of(&mut scene, "lights") {
            for (_, light) in light.as_mapping_mut().unwrap() {
                self.light(light.as_mapping_mut().unwrap());
            }
        }
        for material in values_of(&mut scene, "materials") {
            self.material(material);
        }
        if let Some(fog) = scene.get_mut("fog") {
            self.lengths(fog, &["mean_free_path", "radius"], 1);
        }
        if let Some(shading) = scene.get_mut("shading") {
            self.lengths(shading, &["occlusion_distance"], 1);
        }
        serde_yaml::to_string(&scene).unwrap()
    }

    fn camera(&self, camera: &mut Value) {
        let z = camera.get("z").and_then(Value::as_f64);
        for (axis, key) in ["x", "y"].into_iter().enumerate() {
            for edge in list_of(camera, key) {
                let moved = self.scale * edge.as_f64().unwrap() + self.shift[axis];
                *edge = moved.into();
            }
        }
        if let Some(z) = z {
            camera["z"] = (self.scale * z + self.shift[2]).into();
        }
        self.points(camera, &["eye", "target"]);
        self.lengths(camera, &["height"], 1);
        let fov_y_deg = camera
            .get("fov_y_deg")
            .and_then(Value::as_f64)
            .unwrap_or(40.0);
        if let Some(lens) = camera.get_mut("lens") {
            if let Some(n) = lens.get("f_number").and_then(Value::as_f64) {
                // A frame of 24 mm, of world units that are meters.
                let radius = 0.012 / (0.5 * fov_y_deg.to_radians()).tan() / (2.0 * n);
                lens.as_mapping_mut().unwrap().remove("f_number");
                lens["radius"] = radius.into();
            }
            self.lengths(lens, &["radius", "focus_distance"], 1);
            self.points(lens, &["focus_point"]);
        }
    }

    /// Objects are moved by steps of their own transform, in steps of factors that it allows.
    fn object(&self, object: &mut Mapping) {
        let steps = object
            .entry("transform".into())
            .or_insert(Value::Sequence(vec![]));
        let steps = steps.as_sequence_mut().unwrap();
        let step =
            |key: &str, value: Value| Value::Mapping([(key.into(), value)].into_iter().collect());
        // Exact for powers of two.
        let half = self.scale.log2().div_euclid(2.0).exp2();
        steps.push(step("scale", half.into()));
        steps.push(step("scale", (self.scale / half).into()));
        steps.push(step("translate", self.shift.to_vec().into()));
    }

    fn light(&self, light: &mut Mapping) {
        let power = match light.get("falloff").and_then(Value::as_str) {
            Some("inverse_square") => 2,
            Some("inverse") => 1,
            _ => 0,
        };
        let mut light_of = Value::Mapping(std::mem::take(light));
        if power > 0 && light_of.get("intensity").is_none() {
            light_of["intensity"] = 1.0.into();
        }
        self.points(&mut light_of, &["position", "target"]);
        self.lengths(&mut light_of, &["intensity"], power);
        *light = light_of.as_mapping().unwrap().clone();
    }

    fn material(&self, material: &mut Value) {
        if let Some(medium) = material.get_mut("dielectric") {
            match medium.get_mut("absorption") {
                Some(Value::Sequence(channels)) => {
                    for channel in channels {
                        *channel = (channel.as_f64().unwrap() / self.scale).into();
                    }
                }
                Some(gray) => *gray = (gray.as_f64().unwrap() / self.scale).into(),
                None => {}
            }
        }
        for key in ["color", "normal_map", "cutout", "opacity"] {
            let Some(texture) = material.get_mut(key) else {
                continue;
            };
            if let Some(checker) = texture.get_mut("checker") {
                self.lengths(checker, &["size"], 1);
            }
            if let Some(image) = texture.get_mut("image") {
                self.image(image);
            }
        }
    }

    fn image(&self, image: &mut Value) {
        let Some(mapping) = image.get("mapping").cloned() else {
            return;
        };
        let (kind, mut keys) = match &mapping {
            Value::String(kind) => (kind.clone(), Value::Mapping(Mapping::new())),
            Value::Mapping(kinds) => {
                let (kind, keys) = kinds.iter().next().unwrap();
                (kind.as_str().unwrap().to_owned(), keys.clone())
            }
            _ => return,
        };
        let point = match kind.as_str() {
            "planar" => "origin",
            "spherical" => "center",
            _ => "",
        };
        if !point.is_empty() {
            if keys.get(point).is_none() {
                keys[point] = vec![0.0; 3].into();
            }
            self.points(&mut keys, &[point]);
            image["mapping"] = Value::Mapping([(kind.clone().into(), keys)].into_iter().collect());
        }
        if ["planar", "triplanar"].contains(&kind.as_str()) {
            if image.get("size").is_none() {
                image["size"] = 1.0.into();
            }
            self.lengths(image, &["size"], 1);
        }
    }

    fn points(&self, of: &mut Value, keys: &[&str]) {
        for key in keys {
            for (axis, coordinate) in list_of(of, key).enumerate() {
                let moved = self.scale * coordinate.as_f64().unwrap() + self.shift[axis];
                *coordinate = moved.into();
            }
        }
    }

    /// Multiplies numbers, or lists of them, by a power of the scale.
    fn lengths(&self, of: &mut Value, keys: &[&str], power: i32) {
        let factor = self.scale.powi(power);
        for key in keys {
            match of.get_mut(*key) {
                Some(Value::Sequence(numbers)) => {
                    for number in numbers {
                        *number = (factor * number.as_f64().unwrap()).into();
                    }
                }
                Some(number) if number.is_number() => {
                    *number = (factor * number.as_f64().unwrap()).into();
                }
                _ => {}
            }
        }
    }
}

/// The values of a mapping at a key.
fn values_of<'a>(of: &'a mut Value, key: &str) -> impl Iterator<Item = &'a mut Value> {
    let mapping = of.get_mut(key).and_then(Value::as_mapping_mut);
    mapping.into_iter().flatten().map(|(_, value)| value)
}

/// The items of a list at a key.
fn list_of<'a>(of: &'a mut Value, key: &str) -> impl Iterator<Item = &'a mut Value> {
    of.get_mut(key)
        .and_then(Value::as_sequence_mut)
        .into_iter()
        .flatten()
}

/// A rotation about the vertical axis, which turns a scene without patterns in world space.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    pub angle_deg: f64,
}

impl Turn {
    /// The text of the turned scene; `None` for one with a camera, a light or a texture whose
    /// directions are fixed.
    pub fn of_text(&self, text: &str) -> Option<String> {
        const FIXED: [&str; 8] = [
            "checker:",
            "planar",
            "triplanar",
            "spherical",
            "sky:",
            "environment:",
            "window:",
            "panorama:",
        ];
        if FIXED.iter().any(|word| text.contains(word)) {
            return None;
        }
        let mut scene: Value = serde_yaml::from_str(text).unwrap();
        for camera in values_of(&mut scene, "camera") {
            self.vectors(camera, &["eye", "target", "up"]);
        }
        for light in list_of(&mut scene, "lights") {
            for (_, light) in light.as_mapping_mut().unwrap() {
                self.vectors(light, &["position", "target", "direction"]);
            }
        }
        let rotate = format!(
            "{{ rotate: {{ axis: [0, 1, 0], angle_deg: {} }} }}",
            self.angle_deg
        );
        for object in list_of(&mut scene, "objects") {
            let object = object.as_mapping_mut().unwrap();
            let none = Value::Sequence(vec![]);
            let steps = object.entry("transform".into()).or_insert(none);
            let step = serde_yaml::from_str(&rotate).unwrap();
            steps.as_sequence_mut().unwrap().push(step);
        }
        Some(serde_yaml::to_string(&scene).unwrap())
    }

    fn vectors(&self, of: &mut Value, keys: &[&str]) {
        let (sin, cos) = self.angle_deg.to_radians().sin_cos();
        for key in keys {
            let Some(vector) = of.get_mut(*key) else {
                continue;
            };
            let [x, y, z] = [0, 1, 2].map(|axis| vector[axis].as_f64().unwrap());
            *vector = vec![cos * x + sin * z, y, cos * z - sin * x].into();
        }
    }
}
