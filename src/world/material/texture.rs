//! Colors that may depend on the position.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::texture_point::TexturePoint;
use crate::material::ArrayChoice;
use crate::values::{ColorOr, ColorPattern};
use math::simd::{Real, Vector};

/// Defines [`Texture`], its YAML keys and its dispatch from one list. A row has the
/// kind, whose YAML key is its name in snake case, and the type in the kind's file.
macro_rules! textures {
    ($($(#[doc = $doc:literal])* $(#[serde($write:ident)])? $kind:ident($file:ident::$texture:ident),)*) => {
        $(pub use super::$file::$texture;)*

        /// The color of each point of a surface.
        #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "ColorOr<TexturePattern>"))]
        #[serde(from = "ColorOr<TexturePattern>", rename_all = "snake_case")]
        pub enum Texture {
            $($(#[doc = $doc])* $(#[serde($write)])? $kind($texture),)*
            /// The same everywhere.
            #[serde(untagged)]
            Color(Vec3),
        }

        /// A texture other than one color.
        #[derive(Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[serde(rename_all = "snake_case")]
        enum TexturePattern {
            $($(#[doc = $doc])* $kind($texture),)*
        }

        impl From<ColorOr<TexturePattern>> for Texture {
            fn from(found: ColorOr<TexturePattern>) -> Self {
                match found {
                    ColorOr::Color(color) => Self::Color(color),
                    $(ColorOr::Other(TexturePattern::$kind(pattern)) => Self::$kind(pattern),)*
                }
            }
        }

        impl Texture {
            /// Returns the color at a point.
            #[inline(always)]
            pub fn color_at<R: Real>(&self, point: &TexturePoint<R>) -> Vector<R> {
                match self {
                    Self::Color(color) => Vector::splat(point.position.x, *color),
                    $(Self::$kind(pattern) => pattern.color_at(point),)*
                }
            }
        }
    };
}

textures! {
    /// Two colors in a checkerboard.
    Checker(checker::Checker),
    /// A picture from a file.
    Image(image::ImageTexture),
    /// The numbers of an array of a VTK file.
    Array(array::ArrayTexture),
    /// The colors of the vertices of a mesh.
    #[serde(untagged)]
    VertexColors(vertex_colors::VertexColors),
}

impl ColorPattern for TexturePattern {
    const WORDS: &[&str] = &["vertex_colors"];
}

impl Texture {
    /// Returns true if the colors come from the vertices.
    pub fn is_of_vertices(&self) -> bool {
        matches!(self, Self::VertexColors(_))
    }

    /// Returns the array that is read for the colors, if there is one.
    pub fn array_choice(&self) -> Option<&ArrayChoice> {
        match self {
            Self::Array(array) => Some(&array.choice),
            Self::VertexColors(colors) => colors.array.as_ref(),
            _ => None,
        }
    }

    /// Returns the array that gives the colors, if it is one.
    pub fn array(&self) -> Option<&ArrayTexture> {
        match self {
            Self::Array(array) => Some(array),
            _ => None,
        }
    }

    /// Returns the array that gives the colors, if it is one.
    pub fn array_mut(&mut self) -> Option<&mut ArrayTexture> {
        match self {
            Self::Array(array) => Some(array),
            _ => None,
        }
    }

    /// Returns the picture if there is one.
    pub fn image(&self) -> Option<&ImageTexture> {
        match self {
            Self::Image(image) => Some(image),
            Self::VertexColors(colors) => colors.image.as_deref(),
            _ => None,
        }
    }

    /// Returns the picture if there is one.
    pub fn image_mut(&mut self) -> Option<&mut ImageTexture> {
        match self {
            Self::Image(image) => Some(image),
            Self::VertexColors(colors) => colors.image.as_deref_mut(),
            _ => None,
        }
    }
}
