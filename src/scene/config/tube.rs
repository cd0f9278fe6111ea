//! A tube through points listed in the scene file.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use import::Tubes;
use world::geometry::{Sphere, origin_near};
use world::kinds;
use world::values::{self, OneOrList, positive_or_list};

/// A tube along the line through points, with round joints and ends.
///
/// ```
/// # use raycost_scene::config::Tube;
/// let pipe: Tube = raycost_scene::yaml::from_str("
/// { points: [[0, 0, 2], [1, 0, 2], [1, 1, 2]], radius: 0.1 }
/// ").unwrap();
/// let horn: Tube = raycost_scene::yaml::from_str("
/// { points: [[0, 0, 2], [1, 0, 2], [1, 1, 2]], radius: [0.1, 0.2, 0.4] }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(try_from = "TubeKeys", into = "TubeKeys")]
pub struct Tube {
    keys: TubeKeys,
    tubes: Tubes,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TubeKeys {
    /// The points, at least two of which differ.
    points: Vec<LinePoint>,
    /// The radius, or one for each point.
    #[serde(with = "Radius")]
    radius: OneOrList,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
struct LinePoint(#[serde(with = "values::Point")] DVec3);

impl TryFrom<TubeKeys> for Tube {
    type Error = String;

    fn try_from(keys: TubeKeys) -> Result<Self, String> {
        let points = &keys.points;
        let radii = match &keys.radius {
            OneOrList::One(radius) => vec![*radius; points.len()],
            OneOrList::List(radii) if radii.len() == points.len() => radii.clone(),
            OneOrList::List(radii) => {
                let (n, n_points) = (radii.len(), points.len());
                return Err(format!(
                    "cannot have {n} radii for {n_points} points, expected one radius for each \
                     point, or one number for all"
                ));
            }
        };
        let origin = origin_near(points.iter().map(|LinePoint(point)| *point));
        let spheres = points.iter().zip(radii);
        let spheres = spheres.map(|(LinePoint(center), radius)| Sphere {
            center: (*center - origin).as_vec3(),
            radius: radius as f32,
        });
        let line = Tubes::of_line(spheres)
            .map_err(|_| "cannot be without a length, expected two different points".to_owned())?;
        let tubes = line.at(origin);
        Ok(Self { keys, tubes })
    }
}

impl From<Tube> for TubeKeys {
    fn from(tube: Tube) -> Self {
        tube.keys
    }
}

impl Tube {
    /// The YAML key.
    pub const KEY: &'static str = "tube";

    /// Returns the tube's segments.
    pub fn tubes(&self) -> &Tubes {
        &self.tubes
    }
}

kinds! {
    Radius: OneOrList =
        positive_or_list("a radius greater than 0, or a list with one for each point");
}
