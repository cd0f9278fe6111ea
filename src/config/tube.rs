//! A tube through points that the scene file gives.

use std::fmt;

use glam::Vec3;
use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, IntoDeserializer, SeqAccess, Visitor};

use crate::geometry::Sphere;
use crate::import::Tubes;
use crate::yaml;

/// A tube along the line through points, with round joints and ends.
///
/// ```
/// # use raycost::config::Tube;
/// let pipe: Tube = raycost::yaml::from_str("
/// { points: [[0, 0, 2], [1, 0, 2], [1, 1, 2]], radius: 0.1 }
/// ").unwrap();
/// let horn: Tube = raycost::yaml::from_str("
/// { points: [[0, 0, 2], [1, 0, 2], [1, 1, 2]], radius: [0.1, 0.2, 0.4] }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "TubeKeys")]
pub struct Tube(Tubes);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TubeKeys {
    /// The points, of which two or more differ.
    points: Vec<LinePoint>,
    /// The radius, greater than 0, or a list with one for each point.
    radius: LineRadius,
}

#[derive(Deserialize)]
struct LinePoint(#[serde(deserialize_with = "yaml::point")] Vec3);

enum LineRadius {
    Same(f32),
    Each(Vec<f32>),
}

impl TryFrom<TubeKeys> for Tube {
    type Error = String;

    fn try_from(TubeKeys { points, radius }: TubeKeys) -> Result<Self, String> {
        let radii = match radius {
            LineRadius::Same(radius) => vec![radius; points.len()],
            LineRadius::Each(radii) if radii.len() == points.len() => radii,
            LineRadius::Each(radii) => {
                let (n, n_points) = (radii.len(), points.len());
                return Err(format!(
                    "cannot have {n} radii for {n_points} points, expected one radius for each \
                     point, or one number for all"
                ));
            }
        };
        let spheres = points.into_iter().zip(radii);
        let spheres = spheres.map(|(LinePoint(center), radius)| Sphere { center, radius });
        Tubes::of_line(spheres)
            .map(Self)
            .map_err(|_| "cannot be without a length, expected two different points".to_owned())
    }
}

impl Tube {
    /// The YAML key.
    pub const KEY: &'static str = "tube";

    /// The tube's segments.
    pub fn tubes(&self) -> &Tubes {
        &self.0
    }
}

impl<'de> Deserialize<'de> for LineRadius {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(LineRadiusVisitor)
    }
}

struct LineRadiusVisitor;

impl<'de> Visitor<'de> for LineRadiusVisitor {
    type Value = LineRadius;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a radius greater than 0, or a list with one for each point")
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<LineRadius, E> {
        yaml::positive(found.into_deserializer()).map(LineRadius::Same)
    }

    fn visit_i64<E: Error>(self, found: i64) -> Result<LineRadius, E> {
        self.visit_f64(found as f64)
    }

    fn visit_u64<E: Error>(self, found: u64) -> Result<LineRadius, E> {
        self.visit_f64(found as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<LineRadius, A::Error> {
        #[derive(Deserialize)]
        struct PositiveRadius(#[serde(deserialize_with = "yaml::positive")] f32);

        let radii = Vec::<PositiveRadius>::deserialize(SeqAccessDeserializer::new(list))?;
        let radii = radii.into_iter().map(|PositiveRadius(radius)| radius);
        Ok(LineRadius::Each(radii.collect()))
    }
}
