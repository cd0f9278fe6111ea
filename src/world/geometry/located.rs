//! Geometry near its own origin: 32-bit coordinates around a 64-bit point.

use glam::{DVec3, Vec3};
use std::fmt;

use serde::de::{Deserialize, DeserializeOwned, Deserializer, Error};
use serde::{Serialize, Serializer};

/// The distance from the origin, in sizes of the geometry, up to which 32 bits are precise enough.
const NEAR: f64 = 16.0;

/// A geometry whose coordinates are relative to an origin, so that they keep their digits however
/// far away it is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Located<G> {
    /// The origin of the coordinates; zero where 32 bits are precise enough without it.
    pub origin: DVec3,
    /// The geometry.
    pub geometry: G,
}

impl<G> Located<G> {
    /// Creates a geometry with coordinates relative to `origin`.
    pub fn new(origin: DVec3, geometry: G) -> Self {
        Self { origin, geometry }
    }

    /// Applies `change` to the geometry, keeping its origin.
    pub fn map<H>(self, change: impl FnOnce(G) -> H) -> Located<H> {
        Located::new(self.origin, change(self.geometry))
    }
}

/// Converts the points to coordinates relative to an origin near them: zero if they are not far
/// from it.
pub fn located<const N: usize>(points: [DVec3; N]) -> Located<[Vec3; N]> {
    let origin = origin_near(points.iter().copied());
    Located::new(origin, points.map(|point| (point - origin).as_vec3()))
}

/// Converts any number of points as [`located`] does.
pub fn located_points(points: &[DVec3]) -> Located<Vec<Vec3>> {
    let origin = origin_near(points.iter().copied());
    let near = points.iter().map(|point| (point - origin).as_vec3());
    Located::new(origin, near.collect())
}

/// Returns the origin of [`located`] for any number of points.
pub fn origin_near(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let bounds = points.fold(None, |bounds: Option<[DVec3; 2]>, point| {
        let [min, max] = bounds.unwrap_or([point; 2]);
        Some([min.min(point), max.max(point)])
    });
    let Some([min, max]) = bounds else {
        return DVec3::ZERO;
    };
    let is_near = min.abs().max(max.abs()).max_element() <= NEAR * (max - min).max_element();
    if is_near {
        DVec3::ZERO
    } else {
        0.5 * (min + max)
    }
}

/// A shape that scene files describe.
pub trait Described: Sized {
    /// The YAML keys, with 64-bit points.
    type Keys: fmt::Debug + Clone + PartialEq + Serialize + DeserializeOwned;

    /// Returns the shape with these keys.
    ///
    /// # Errors
    /// The keys contradict each other.
    fn from_keys(keys: Self::Keys) -> Result<Located<Self>, &'static str>;
}

impl<'de, S: Described> Deserialize<'de> for Located<S> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        Keyed::deserialize(d).map(|keyed| keyed.shape)
    }
}

/// A shape beside the keys that describe it: the shape alone has rounded them.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(
    feature = "schema",
    schemars(with = "S::Keys", bound = "S::Keys: schemars::JsonSchema")
)]
pub struct Keyed<S: Described> {
    keys: S::Keys,
    /// The shape.
    pub shape: Located<S>,
}

impl<'de, S: Described> Deserialize<'de> for Keyed<S> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        let keys = S::Keys::deserialize(d)?;
        let shape = S::from_keys(keys.clone()).map_err(D::Error::custom)?;
        Ok(Self { keys, shape })
    }
}

impl<S: Described> Serialize for Keyed<S> {
    fn serialize<T: Serializer>(&self, s: T) -> Result<T::Ok, T::Error> {
        self.keys.serialize(s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_far_away_keep_their_digits() {
        let far = DVec3::new(3e5, 4e6, 0.0);
        let [a, b] = [DVec3::new(0.25, 0.1, 0.0), DVec3::new(0.5, 0.75, 1.0)];
        let Located { origin, geometry } = located([far + a, far + b]);
        for (exact, found) in [a, b].into_iter().zip(geometry) {
            assert!((origin + found.as_dvec3()).distance(far + exact) < 1e-7);
        }
        assert_eq!(located([a, b]).origin, DVec3::ZERO);
        assert_eq!(located([far]).geometry, [Vec3::ZERO]);
    }
}
