//! The settings and the machines of two outputs, from their summaries.

use std::fmt;

use serde::Serialize;
use serde_json::Value;

use output::summary::Summary;
use scene::yaml::json_of;

/// A setting, or a property of the machine, that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Setting {
    /// Path of the setting in `summary.json`.
    pub name: String,
    /// Value in A; null if A does not have it.
    pub a: Value,
    /// Value in B; null if B does not have it.
    pub b: Value,
}

/// Shows the name and both values.
impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, a, b } = self;
        write!(f, "{name}: {a} → {b}")
    }
}

/// Paths in `summary.json` that describe the machine and the program.
const MACHINE: [&str; 5] = [
    "raycost",
    "machine",
    "acceleration/device",
    "cost/kernel",
    "cost/clock/source",
];

/// The name of the device that traced the rays, among the machine's differences.
pub(super) const DEVICE: &str = "acceleration.device";

/// Paths in `summary.json` that describe the settings.
const SETTINGS: [&str; 16] = [
    "scene",
    "image",
    "film",
    "objects",
    "materials",
    "n_primitives",
    "n_instances",
    "n_degenerate_triangles",
    "acceleration/kind",
    "acceleration/quality",
    "threads/used",
    "cost/mode",
    "repeats/asked",
    "schedule/tile_size",
    "schedule/order",
    "arrays",
];

/// Returns the values of a summary, by its keys.
pub(super) fn values(summary: &Summary) -> Value {
    // Cannot fail: all keys are strings.
    json_of(summary).unwrap_or_default()
}

/// Returns the differences of machine and program.
pub(super) fn compare_machines(sides: &[Value; 2]) -> Vec<Setting> {
    differences(&MACHINE, sides)
}

/// Returns the differences of the settings.
pub(crate) fn compare_runs(sides: &[Value; 2]) -> Vec<Setting> {
    differences(&SETTINGS, sides)
}

fn differences(paths: &[&str], sides: &[Value; 2]) -> Vec<Setting> {
    let mut found = Vec::new();
    for path in paths {
        let [a, b] = sides
            .each_ref()
            .map(|summary| summary.pointer(&format!("/{path}")));
        let name = path.replace('/', ".");
        compare(
            name,
            a.unwrap_or(&Value::Null),
            b.unwrap_or(&Value::Null),
            &mut found,
        );
    }
    found
}

/// Compares mappings key by key, so that `image.seed` differs and not `image`.
fn compare(name: String, a: &Value, b: &Value, found: &mut Vec<Setting>) {
    if a == b {
        return;
    }
    let (Value::Object(in_a), Value::Object(in_b)) = (a, b) else {
        let [a, b] = [a, b].map(Value::clone);
        found.push(Setting { name, a, b });
        return;
    };
    let only_in_b = in_b.keys().filter(|key| !in_a.contains_key(*key));
    for key in in_a.keys().chain(only_in_b) {
        let [a, b] = [in_a, in_b].map(|map| map.get(key).unwrap_or(&Value::Null));
        compare(format!("{name}.{key}"), a, b, found);
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn settings_differ_by_their_paths_and_results_never_do() {
        let a = json!({
            "image": { "width": 4, "seed": 1 }, "threads": { "used": 2, "available": 2 },
            "acceleration": { "kind": "bvh", "quality": "fast", "bvh": { "n_nodes": 7 } },
            "machine": { "cpu": "one" }, "n_hits": 3,
        });
        let b = json!({
            "image": { "width": 4, "seed": 2 }, "threads": { "used": 2, "available": 8 },
            "acceleration": {
                "kind": "brute_force", "quality": null, "bvh": null, "device": "card",
                "kernels": [{ "name": "nearest", "seconds": 1.5 }],
            },
            "machine": { "cpu": "two" }, "n_hits": 5,
        });
        let sides = [a, b];
        let named = |settings: Vec<Setting>| -> Vec<String> {
            let line = |setting: Setting| format!("{} {} {}", setting.name, setting.a, setting.b);
            settings.into_iter().map(line).collect()
        };
        assert_eq!(
            named(compare_runs(&sides)),
            [
                "image.seed 1 2",
                "acceleration.kind \"bvh\" \"brute_force\"",
                "acceleration.quality \"fast\" null"
            ]
        );
        assert_eq!(
            named(compare_machines(&sides)),
            [
                "machine.cpu \"one\" \"two\"",
                "acceleration.device null \"card\""
            ]
        );
    }
}
