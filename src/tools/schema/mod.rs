//! The JSON Schemas of scene files and studies, which editors use to complete and check them.
//!
//! The schema is not written down: the `Explorer` finds out which values the parser accepts, by
//! parsing small scenes, and describes them. So a new key is in the schema as soon as it can be
//! read, with its range and its default. Descriptions are the doc comments of the sources, which a test collects,
//! and the values that the parser says it expects.

mod attempt;
mod defaults;
mod doc_comments;
mod numbers;
mod relations;
mod explorer;

use std::fmt::Debug;

use serde_json::{Value, json};

use crate::study::StudyPlan;
use base::keywords;
use defaults::add_defaults;
use explorer::Explorer;
use scene::config::Config;
use scene::yaml::YamlFile;

keywords! {
    /// A kind of file that has a schema.
    #[derive(Default)]
    pub enum SchemaKind {
        /// A scene
        #[default]
        Scene = "scene",
        /// A file that scenes include
        Part = "part",
        /// A study
        Study = "study",
    }
}

impl SchemaKind {
    /// Returns the JSON Schema of such files.
    pub fn schema(self) -> Value {
        match self {
            Self::Scene => {
                let mut schema = schema_of::<Config>("a scene of raycost");
                if let Some(required) = schema.as_object_mut().and_then(|s| s.remove("required")) {
                    // Included files may have the other sections.
                    schema["if"] = json!({ "required": ["include"] });
                    schema["else"] = json!({ "required": required });
                }
                schema
            }
            Self::Part => {
                let mut schema = schema_of::<Config>("a part of a scene of raycost");
                schema
                    .as_object_mut()
                    .and_then(|schema| schema.remove("required"));
                schema
            }
            Self::Study => schema_of::<StudyPlan>("a study of raycost"),
        }
    }
}

/// Returns the JSON Schema of the files that a `T` is read from.
fn schema_of<T: YamlFile + Debug + PartialEq>(title: &str) -> Value {
    let mut schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
    });
    let mut root = Explorer::<T>::new().explore_all();
    add_defaults::<T>(&mut root);
    if let (Value::Object(schema), Value::Object(root)) = (&mut schema, root) {
        schema.extend(root);
    }
    schema
}
