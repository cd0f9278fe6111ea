//! Values of settings that are checked as they are read: numbers in a range, points and directions,
//! colors, names. For `#[serde(deserialize_with = "…")]`, in any format of serde.

mod default;
mod color;
mod name;
mod number;

pub use color::{ColorOr, ColorPattern, RadianceOr, channels, color, hex_color, radiance};
pub use default::{half, one, white};
pub use name::{MAX_NAME, is_long, name};
pub use number::{
    Number, OneOrList, between, byte, cone_radii, coordinate, coordinate_or_list, count, direction,
    exact_coordinate, exact_positive, fraction, intensity, non_empty, non_negative, point,
    positive, positive_or_list, positive_range, radii, range, scale, size, unsigned, vector, whole,
    within,
};
