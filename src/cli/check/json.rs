//! The report of `raycost check --json` on a scene.

use serde::Serialize;
use serde_json::{Value, json};

use super::CheckedScene;
use crate::job::SceneSource;
use base::Keyword;
use output::limits;
use output::prediction::{ArrayFile, Prediction};
use output::summary::{ImageSection, SceneSection};
use render::schedule::TileGrid;

#[derive(Serialize)]
struct SceneReport {
    scene: SceneSection,
    frames: Option<Value>,
    image: ImageSection,
    #[serde(flatten)]
    others: Value,
}

/// Returns the report. It has the keys of `summary.json` for what both say.
pub(super) fn report(checked: &CheckedScene) -> impl Serialize {
    let CheckedScene { config, scene, .. } = checked;
    let frames = checked.open.frames.as_ref().map(|frames| {
        let [first, last] = [0, frames.n_frames() - 1].map(|number| frames.frame(number).time);
        json!({
            "n": frames.n_frames(),
            "first_time": first,
            "last_time": last,
            "fps": frames.fps(),
        })
    });
    let (image, tiling, acceleration) = (&config.image, &config.tiles, config.acceleration);
    let n_tiles = TileGrid::new(image.width, image.height, tiling.size).n_tiles();
    let world = scene.world();
    let others = json!({
        "n_camera_rays": image.n_camera_rays(),
        "n_objects": config.objects.len(),
        "n_materials": config.materials.len(),
        "n_lights": config.lights.len(),
        "n_primitives": world.n_primitives(),
        "n_instances": world.instances.map(|instances| instances.n_instances()),
        "n_degenerate_triangles": scene.n_degenerate,
        "acceleration": { "kind": acceleration.kind(), "quality": acceleration.quality() },
        "cost": { "mode": config.cost },
        "tiles": { "tile_size": tiling.size, "order": tiling.order.name(), "n_tiles": n_tiles },
        "memory": memory_json(checked),
        "disk": disk_json(&checked.expected),
        "out": checked.folder().to_string_lossy(),
        "files": checked.files(),
    });
    SceneReport {
        scene: SceneSection {
            name: checked.arguments.name(),
            file: checked.arguments.scene.to_string_lossy().into_owned(),
            set: checked.open.settings(),
        },
        frames,
        image: image.into(),
        others,
    }
}

/// Returns the expected peak, the upper bound and the free memory, in bytes.
fn memory_json(checked: &CheckedScene) -> Value {
    let memory = &checked.memory;
    json!({
        "peak": checked.expected.peak_memory,
        "at_most": memory.at_most(),
        "film": memory.film,
        "scene": memory.scene,
        "build": memory.build,
        "attribution": memory.attribution,
        "available": limits::available(),
        "rows_at_a_time": memory.band_rows,
    })
}

/// Returns the lengths of the files in bytes; of arrays whose compressed length is not predicted,
/// the length before compression.
fn disk_json(disk: &Prediction) -> Value {
    let array = |file: &ArrayFile| {
        json!({
            "file": file.name,
            "bytes": file.n_bytes,
            "before_compression": !file.is_known,
        })
    };
    json!({
        "arrays": disk.arrays.iter().map(array).collect::<Vec<_>>(),
        "layers_before_compression": disk.layers,
        "pictures": disk.pictures,
        "texts": disk.texts,
        "tiles_until_the_end": disk.tiles,
    })
}
