//! The ParaView states of the frames.

use std::path::PathBuf;

use super::PREFIX;
use base::provenance::{RunId, stamped};
use output::writers::{StateValues, state_template};

/// The readers of single files, as the templates name them.
const READERS: [&str; 2] = [
    "type=\"XMLImageDataReader\"",
    "type=\"XMLUnstructuredGridReader\"",
];
/// The reader of `.pvd` files.
const COLLECTION_READER: &str = "type=\"PVDReader\"";

/// Returns the states among the files of a frame, for all frames, which span `times`: their names
/// and texts. `path_of` returns the path of the `.pvd` of a VTK file.
pub(super) fn of_files(
    files: &[String],
    values: &StateValues,
    times: [f64; 2],
    path_of: impl Fn(&str) -> PathBuf,
    run: RunId,
) -> Vec<(String, String)> {
    let state = |file: &String| {
        let template = READERS
            .iter()
            .fold(state_template(file)?.to_owned(), |text, reader| {
                text.replace(reader, COLLECTION_READER)
            });
        let state = with_time(&values.filled(&template, &path_of), times);
        Some((format!("{PREFIX}_{file}"), stamped(&state, run)))
    };
    files.iter().filter_map(state).collect()
}

/// The line before which the proxies of a state end.
const COLLECTIONS: &str = "\n  <ProxyCollection ";
/// IDs of proxies that no template has.
const KEEPER: u32 = 900_001;
const SCENE: u32 = 900_002;
const CUE: u32 = 900_003;

/// Returns a state with the proxies by which ParaView steps through the times of its readers; a
/// still has none.
fn with_time(state: &str, [begin, end]: [f64; 2]) -> String {
    let Some((proxies, collections)) = state.split_once(COLLECTIONS) else {
        return state.to_owned();
    };
    let sources = ids(
        state,
        &format!("<Proxy group=\"sources\" {COLLECTION_READER}"),
    );
    let views = ids(state, "<Proxy group=\"views\"");
    let proxy = |id: &u32| vec![format!("<Proxy value=\"{id}\"/>")];
    let many = |ids: &[String]| -> Vec<String> {
        ids.iter()
            .map(|id| format!("<Proxy value=\"{id}\"/>"))
            .collect()
    };
    let number = |value: f64| vec![format!("<Element index=\"0\" value=\"{value}\"/>")];
    let added = [
        proxy_text(
            "misc",
            "TimeKeeper",
            KEEPER,
            &[
                ("Time", number(begin)),
                ("TimeSources", many(&sources)),
                ("Views", many(&views)),
            ],
        ),
        proxy_text(
            "animation",
            "AnimationScene",
            SCENE,
            &[
                ("AnimationTime", number(begin)),
                ("Cues", proxy(&CUE)),
                ("StartTime", number(begin)),
                ("EndTime", number(end)),
                // From time step to time step.
                ("PlayMode", number(2.0)),
                ("TimeKeeper", proxy(&KEEPER)),
                ("ViewModules", many(&views)),
            ],
        ),
        proxy_text(
            "animation",
            "TimeAnimationCue",
            CUE,
            &[
                ("AnimatedProxy", proxy(&KEEPER)),
                (
                    "AnimatedPropertyName",
                    vec!["<Element index=\"0\" value=\"Time\"/>".to_owned()],
                ),
                ("UseAnimationTime", number(1.0)),
            ],
        ),
    ];
    let groups = [
        ("animation", SCENE, "AnimationScene1"),
        ("animation", CUE, "TimeAnimationCue1"),
        ("timekeeper", KEEPER, "TimeKeeper1"),
    ];
    let groups = groups.map(|(group, id, name)| {
        format!(
            "\n  <ProxyCollection name=\"{group}\">\n   <Item id=\"{id}\" name=\"{name}\"/>\n  \
             </ProxyCollection>"
        )
    });
    format!(
        "{proxies}{}{}{COLLECTIONS}{collections}",
        added.concat(),
        groups.concat()
    )
}

/// Returns a proxy with its properties: the name and the elements of each.
fn proxy_text(group: &str, kind: &str, id: u32, properties: &[(&str, Vec<String>)]) -> String {
    let property = |(name, elements): &(&str, Vec<String>)| {
        format!(
            "\n   <Property name=\"{name}\" id=\"{id}.{name}\" number_of_elements=\"{}\">\n    {}\n   \
             </Property>",
            elements.len(),
            elements.join("\n    ")
        )
    };
    let properties: String = properties.iter().map(property).collect();
    format!(
        "\n  <Proxy group=\"{group}\" type=\"{kind}\" id=\"{id}\" servers=\"16\">{properties}\n  </Proxy>"
    )
}

/// Returns the IDs of the proxies whose tags start with `begin`.
fn ids(state: &str, begin: &str) -> Vec<String> {
    let tags = state.split(begin).skip(1);
    let id = tags.filter_map(|rest| rest.split_once(" id=\"")?.1.split_once('"'));
    id.map(|(id, _)| id.to_owned()).collect()
}
