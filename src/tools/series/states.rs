//! The ParaView states of the frames.

use std::path::PathBuf;

use super::PREFIX;
use host::provenance::{RunId, stamped};
use output::writers::{StateValues, state_template, with_time_in_subject};

/// The readers of single files, as the templates name them.
const READERS: [&str; 2] = [
    "type=\"XMLImageDataReader\"",
    "type=\"XMLUnstructuredGridReader\"",
];
/// The reader of `.pvd` files.
const COLLECTION_READER: &str = "type=\"PVDReader\"";

/// Returns the states among the files of a frame, for all frames, which span `times`: their names
/// and texts. `path_of` returns the path of the `.pvd` of a VTK file.
pub(super) fn from_files(
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
        let template = with_time_in_subject(&template);
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
    let [n_sources, n_views] = [sources.len(), views.len()];
    let [sources, views] = [sources, views].map(|ids| -> String {
        let proxy = |id: &String| format!("<Proxy value=\"{id}\"/>");
        ids.iter().map(proxy).collect()
    });
    // Play mode 2: from time step to time step.
    format!(
        r#"{proxies}
  <Proxy group="misc" type="TimeKeeper" id="{KEEPER}" servers="16">
   <Property name="Time" id="{KEEPER}.Time" number_of_elements="1"><Element index="0" value="{begin}"/></Property>
   <Property name="TimeSources" id="{KEEPER}.TimeSources" number_of_elements="{n_sources}">{sources}</Property>
   <Property name="Views" id="{KEEPER}.Views" number_of_elements="{n_views}">{views}</Property>
  </Proxy>
  <Proxy group="animation" type="AnimationScene" id="{SCENE}" servers="16">
   <Property name="AnimationTime" id="{SCENE}.AnimationTime" number_of_elements="1"><Element index="0" value="{begin}"/></Property>
   <Property name="Cues" id="{SCENE}.Cues" number_of_elements="1"><Proxy value="{CUE}"/></Property>
   <Property name="StartTime" id="{SCENE}.StartTime" number_of_elements="1"><Element index="0" value="{begin}"/></Property>
   <Property name="EndTime" id="{SCENE}.EndTime" number_of_elements="1"><Element index="0" value="{end}"/></Property>
   <Property name="PlayMode" id="{SCENE}.PlayMode" number_of_elements="1"><Element index="0" value="2"/></Property>
   <Property name="TimeKeeper" id="{SCENE}.TimeKeeper" number_of_elements="1"><Proxy value="{KEEPER}"/></Property>
   <Property name="ViewModules" id="{SCENE}.ViewModules" number_of_elements="{n_views}">{views}</Property>
  </Proxy>
  <Proxy group="animation" type="TimeAnimationCue" id="{CUE}" servers="16">
   <Property name="AnimatedProxy" id="{CUE}.AnimatedProxy" number_of_elements="1"><Proxy value="{KEEPER}"/></Property>
   <Property name="AnimatedPropertyName" id="{CUE}.AnimatedPropertyName" number_of_elements="1"><Element index="0" value="Time"/></Property>
   <Property name="UseAnimationTime" id="{CUE}.UseAnimationTime" number_of_elements="1"><Element index="0" value="1"/></Property>
  </Proxy>
  <ProxyCollection name="animation">
   <Item id="{SCENE}" name="AnimationScene1"/>
  </ProxyCollection>
  <ProxyCollection name="animation">
   <Item id="{CUE}" name="TimeAnimationCue1"/>
  </ProxyCollection>
  <ProxyCollection name="timekeeper">
   <Item id="{KEEPER}" name="TimeKeeper1"/>
  </ProxyCollection>{COLLECTIONS}{collections}"#
    )
}

/// Returns the IDs of the proxies whose tags start with `begin`.
fn ids(state: &str, begin: &str) -> Vec<String> {
    let tags = state.split(begin).skip(1);
    let id = tags.filter_map(|rest| rest.split_once(" id=\"")?.1.split_once('"'));
    id.map(|(id, _)| id.to_owned()).collect()
}
