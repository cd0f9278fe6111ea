//! A clear sky with its sun.
//!
//! Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DMat3, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::EnvironmentMap;
use super::sun::Sun;
use crate::kinds;
use crate::picture::{Picture, Texels};
use crate::values::{self, Number};

/// A clear sky by day, its sun, and a ground below the horizon that both illuminate. A white
/// surface facing the sun above the atmosphere has radiance 1.
///
/// ```
/// # use raycost_world::background::Background;
/// let morning: Background = scene::yaml::from_str("
/// sky:
///   sun: { elevation_deg: 20, azimuth_deg: 90 }   # above the horizon, from -z toward +x
///   turbidity: 3     # haze: 2 for very clear air, 10 for a hazy day
///   ground: 0.2      # the albedo of the ground
///   intensity: 1     # a factor on all of it
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(from = "SkyKeys", into = "SkyKeys")]
pub struct Sky {
    keys: SkyKeys,
    /// The cosine of the angle between the sun and the zenith.
    cos_zenith: f64,
    turbidity: f64,
    /// The sky and the ground: white until they are [drawn](Self::draw).
    pub map: EnvironmentMap,
    /// The sun.
    pub sun: Sun,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "a sky such as { sun: { elevation_deg: 40 } }"
)]
struct SkyKeys {
    /// The position of the sun.
    sun: SunKeys,
    /// The haze of the air, 2 to 10: 2 for very clear air; 3 by default.
    #[serde(default = "turbidity", with = "Turbidity")]
    turbidity: f32,
    /// The albedo of the ground below the horizon; 0.2 by default.
    #[serde(default = "ground", with = "values::Color")]
    ground: Vec3,
    /// A factor on the light of the sky and the sun, at least 0; 1 by default.
    #[serde(default = "values::one", with = "values::NonNegative")]
    intensity: f32,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "a place such as { elevation_deg: 40, azimuth_deg: 120 }"
)]
struct SunKeys {
    /// The angle above the horizon in degrees, 0 to 90.
    #[serde(with = "Elevation")]
    elevation_deg: f32,
    /// The angle from -z toward +x in degrees, clockwise as seen from above; 0 by default.
    #[serde(default, with = "values::Coordinate")]
    azimuth_deg: f32,
}

fn turbidity() -> f32 {
    3.0
}

fn ground() -> Vec3 {
    Vec3::splat(0.2)
}

kinds! {
    Turbidity: f32 = Number { expected: "a number from 2 to 10", ranges: &[[2.0, 10.0]] };
    Elevation: f32 = Number { expected: "an angle from 0 to 90", ranges: &[[0.0, 90.0]] };
}

impl From<SkyKeys> for Sky {
    fn from(keys: SkyKeys) -> Self {
        let turbidity = keys.turbidity.into();
        let elevation = f64::from(keys.sun.elevation_deg).to_radians();
        let azimuth = f64::from(keys.sun.azimuth_deg).to_radians();
        let [height, around] = [libm::sin(elevation), libm::cos(elevation)];
        let direction = DVec3::new(
            around * libm::sin(azimuth),
            height,
            -around * libm::cos(azimuth),
        );
        let of_white = f64::from(keys.intensity) * sunlight(height, turbidity);
        Self {
            cos_zenith: height,
            turbidity,
            map: EnvironmentMap {
                rotation_deg: -keys.sun.azimuth_deg,
                intensity: keys.intensity,
                ..EnvironmentMap::default()
            },
            sun: Sun::new(direction.as_vec3().normalize(), of_white.as_vec3()),
            keys,
        }
    }
}

impl From<Sky> for SkyKeys {
    fn from(sky: Sky) -> Self {
        sky.keys
    }
}

/// Columns and rows of the map, which is smooth.
const SIZE: [u32; 2] = [256, 128];

/// The luminance of radiance 1, in kcd/m²: a white surface under 127.5 klx, the solar illuminance
/// constant of the IES, "Recommended Practice for the Calculation of Daylight Availability", 1984.
const UNIT: f64 = 127.5 / PI;

impl Sky {
    /// Draws the map, with the sun above the middle column.
    pub fn draw(&mut self) {
        let [width, height] = SIZE;
        let zenith = Zenith::new(self.cos_zenith, self.turbidity);
        let mut texels = Vec::with_capacity((width * height) as usize);
        let mut irradiance = DVec3::ZERO;
        for row in 0..height / 2 {
            let latitude = PI * (0.5 - (f64::from(row) + 0.5) / f64::from(height));
            let (sin, cos) = (libm::sin(latitude), libm::cos(latitude));
            for column in 0..width {
                let longitude = 2.0 * PI * ((f64::from(column) + 0.5) / f64::from(width) - 0.5);
                let to_sun = sin * self.cos_zenith
                    + cos * libm::sqrt(1.0 - self.cos_zenith.powi(2)) * libm::cos(longitude);
                let radiance = zenith.radiance(sin, to_sun);
                irradiance += radiance * sin * cos;
                texels.push(texel(radiance));
            }
        }
        let steradians = 2.0 * PI / f64::from(width) * PI / f64::from(height);
        let of_sun = self.cos_zenith * sunlight(self.cos_zenith, self.turbidity);
        let ground = self.keys.ground.as_dvec3() * (irradiance * steradians / PI + of_sun);
        texels.resize((width * height) as usize, texel(ground));
        if let Some(picture) = Picture::new(SIZE, Texels::Floats(texels)) {
            self.map.picture = Arc::new(picture);
        }
    }
}

fn texel(light: DVec3) -> [f32; 4] {
    light.as_vec3().extend(1.0).to_array()
}

/// Returns the radiance of a white surface that faces the sun, after scattering by air and haze:
/// appendix A.1 of the paper, at the dominant wavelengths of the sRGB primaries, in micrometers.
fn sunlight(cos_zenith: f64, turbidity: f64) -> DVec3 {
    let degrees = libm::acos(cos_zenith.clamp(0.0, 1.0)).to_degrees();
    let air_mass = 1.0 / (cos_zenith + 0.15 * libm::pow(93.885 - degrees, -1.253));
    let haze = 0.04608 * turbidity - 0.04586;
    let transmittance = |wavelength: f64| {
        let of_air = 0.008735 * libm::pow(wavelength, -4.08);
        let of_haze = haze * libm::pow(wavelength, -1.3);
        libm::exp(-(of_air + of_haze) * air_mass)
    };
    DVec3::from([0.611, 0.549, 0.464].map(transmittance))
}

/// The sky relative to its color at the zenith: appendix A.2 of the paper. Each array has the
/// luminance in kcd/m² and the chromaticities x and y of CIE 1931.
struct Zenith {
    color: [f64; 3],
    /// The coefficients A to E of Perez' formula.
    coefficients: [[f64; 5]; 3],
    /// The value of the formula at the zenith.
    there: [f64; 3],
}

impl Zenith {
    fn new(cos_zenith: f64, turbidity: f64) -> Self {
        let t = turbidity;
        let angle = libm::acos(cos_zenith.clamp(0.0, 1.0));
        let slope = libm::tan((4.0 / 9.0 - t / 120.0) * (PI - 2.0 * angle));
        let chromaticity = |rows: [[f64; 4]; 3]| {
            let [of_square, of_t, of_one] = rows.map(|[cubic, square, linear, one]| {
                ((cubic * angle + square) * angle + linear) * angle + one
            });
            (of_square * t + of_t) * t + of_one
        };
        let coefficients = PEREZ.map(|rows| rows.map(|[of_t, of_one]| of_t * t + of_one));
        Self {
            color: [
                (4.0453 * t - 4.9710) * slope - 0.2155 * t + 2.4192,
                chromaticity(ZENITH_X),
                chromaticity(ZENITH_Y),
            ],
            coefficients,
            there: coefficients.map(|of| perez(of, 1.0, cos_zenith)),
        }
    }

    /// Returns the radiance in a direction, given the cosines of its angles with the zenith and the
    /// sun.
    fn radiance(&self, cos_zenith: f64, cos_sun: f64) -> DVec3 {
        let value = |i: usize| {
            self.color[i] * perez(self.coefficients[i], cos_zenith, cos_sun) / self.there[i]
        };
        let (luminance, x, y) = (value(0), value(1), value(2));
        let xyz = DVec3::new(x / y, 1.0, (1.0 - x - y) / y) * (luminance / UNIT);
        (SRGB_FROM_XYZ * xyz).max(DVec3::ZERO)
    }
}

/// Evaluates Perez' formula for skies: equation 3 of the paper.
fn perez([a, b, c, d, e]: [f64; 5], cos_zenith: f64, cos_sun: f64) -> f64 {
    let to_sun = libm::acos(cos_sun.clamp(-1.0, 1.0));
    let gradient = 1.0 + a * libm::exp(b / cos_zenith.max(1e-3));
    gradient * (1.0 + c * libm::exp(d * to_sun) + e * cos_sun * cos_sun)
}

/// Coefficients A to E of luminance, x and y, linear in the turbidity.
const PEREZ: [[[f64; 2]; 5]; 3] = [
    [
        [0.1787, -1.4630],
        [-0.3554, 0.4275],
        [-0.0227, 5.3251],
        [0.1206, -2.5771],
        [-0.0670, 0.3703],
    ],
    [
        [-0.0193, -0.2592],
        [-0.0665, 0.0008],
        [-0.0004, 0.2125],
        [-0.0641, -0.8989],
        [-0.0033, 0.0452],
    ],
    [
        [-0.0167, -0.2608],
        [-0.0950, 0.0092],
        [-0.0079, 0.2102],
        [-0.0441, -1.6537],
        [-0.0109, 0.0529],
    ],
];

/// Cubic polynomials in the sun's angle from the zenith: coefficients of the turbidity squared, the
/// turbidity, and 1.
const ZENITH_X: [[f64; 4]; 3] = [
    [0.00166, -0.00375, 0.00209, 0.0],
    [-0.02903, 0.06377, -0.03202, 0.00394],
    [0.11693, -0.21196, 0.06052, 0.25886],
];
const ZENITH_Y: [[f64; 4]; 3] = [
    [0.00275, -0.00610, 0.00317, 0.0],
    [-0.04214, 0.08970, -0.04153, 0.00516],
    [0.15346, -0.26756, 0.06670, 0.26688],
];

/// Linear light with the primaries of sRGB (IEC 61966-2-1), by columns.
const SRGB_FROM_XYZ: DMat3 = DMat3::from_cols_array(&[
    3.2406, -0.9689, 0.0557, -1.5372, 1.8758, -0.2040, -0.4986, 0.0415, 1.0570,
]);

#[cfg(test)]
mod tests {
    use super::*;
    use math::simd::Vector;

    fn sky(elevation_deg: f32, turbidity: f32) -> Sky {
        let keys = format!(
            "{{ sun: {{ elevation_deg: {elevation_deg}, azimuth_deg: 90 }}, turbidity: {turbidity} }}"
        );
        let mut sky: Sky = scene::yaml::from_str(&keys).unwrap();
        sky.draw();
        sky
    }

    fn above(sky: &Sky, direction: Vec3) -> Vec3 {
        sky.map.radiance(Vector::from(direction.normalize())).into()
    }

    #[test]
    fn skies_are_blue_and_low_suns_red() {
        let noon = sky(60.0, 2.5);
        let [r, g, b] = above(&noon, Vec3::new(-0.2, 1.0, 0.1)).to_array();
        assert!(r < g && g < b && b > 2.0 * r, "{r} {g} {b}");
        let high = noon.sun.white_radiance();
        let low = sky(3.0, 2.5).sun.white_radiance();
        assert!(
            high.z > 0.75 * high.x && low.z < 0.2 * low.x,
            "{high} {low}"
        );
    }

    #[test]
    fn the_sky_is_brightest_around_the_sun() {
        let sky = sky(30.0, 3.0);
        let near = above(&sky, Vec3::new(0.82, 0.5, 0.1)).y;
        for direction in [
            Vec3::Y,
            Vec3::new(-0.82, 0.5, 0.0),
            Vec3::new(0.0, 0.5, 0.82),
        ] {
            assert!(above(&sky, direction).y < 0.5 * near);
        }
        let sun = Vec3::new(30_f32.to_radians().cos(), 0.5, 0.0);
        assert!(Vec3::from(sky.sun.radiance(sun.into())).y > 1e3 * near);
    }

    /// Clear skies give about 10 to 20 klx besides the sun at this height, and the model more:
    /// Zotti, Wilkie and Purgathofer, "A Critical Review of the Preetham Skylight Model", WSCG
    /// 2007. The sun gives 80 to 110 klx to a surface that faces it.
    #[test]
    fn light_is_as_much_as_outdoors() {
        let sky = sky(60.0, 2.5);
        let mut illuminance = 0.0;
        const N: u16 = 100;
        for i in 0..N * N {
            let [u, v] = [i / N, i % N].map(|k| (f32::from(k) + 0.5) / f32::from(N));
            let [x, z, y] = math::sampling::hemisphere([u, v]);
            let radiance = above(&sky, Vec3::new(x, y, z));
            illuminance += radiance.dot(Vec3::new(0.2126, 0.7152, 0.0722)) / f32::from(N * N);
        }
        let klx = 127.5 * illuminance;
        assert!((10.0..30.0).contains(&klx), "{klx}");
        let klx = 127.5 * sky.sun.white_radiance().y;
        assert!((80.0..110.0).contains(&klx), "{klx}");
    }

    #[test]
    fn no_sky_has_numbers_that_are_not_finite() {
        for elevation in [0.0, 0.5, 10.0, 45.0, 90.0] {
            for turbidity in [2.0, 2.2, 6.0, 10.0] {
                let sky = sky(elevation, turbidity);
                for i in 0..1000_u16 {
                    let direction = sky
                        .map
                        .direction(f32::from(i % 31) / 31.0, f32::from(i) / 1000.0);
                    let radiance = Vec3::from(sky.map.radiance(direction));
                    assert!(
                        radiance.is_finite() && radiance.max_element() > 0.0,
                        "{elevation} {turbidity}"
                    );
                }
                assert!(sky.sun.white_radiance().is_finite() && sky.sun.white_radiance().x > 0.0);
            }
        }
    }
}
