//! A scene file → the totals of its counters.

use std::collections::HashMap;
use std::path::{Component, Path};

use indexmap::IndexMap;
use serde_json::Number;

use super::BudgetArguments;
use crate::cli::Failure;
use crate::cli::progress::Bars;
use crate::cli::scene::SceneArguments;
use crate::job::{OpenScene, SceneSource};
use crate::session::{Options, Rendering, Session};
use host::text::{Diagnostic, shown};
use output::estimate::Memory;
use output::writers::{Group, RenderingView, totals};
use render::attribution::{AttributionRule, CostAttribution};
use render::instruments::Stages;
use scene::config::{Config, CostMode, OptionalOutput, Outputs, RatioMetrics, Repeats};
use scene::yaml::{Document, Source};
use tools::budget::{RayTotals, SceneBudget};
use tracer::cost::RayKind;

/// A scene that is rendered only for its counters.
pub(super) struct CountedScene {
    arguments: SceneArguments,
    /// The flags of the command line that change it.
    flags: Vec<String>,
    frame: Option<u32>,
}

/// Renders scenes, and returns their totals.
///
/// # Errors
/// Before the first scene is rendered: a scene with a fault, or two scenes of one folder.
pub(super) fn measure(
    arguments: &BudgetArguments,
    scenes: &[CountedScene],
) -> Result<Vec<SceneBudget>, Failure> {
    if arguments.keep.is_some() {
        refuse_same_folder(scenes.iter().map(CountedScene::file))?;
    }
    if scenes.len() > 1 {
        for scene in scenes {
            OpenScene::read(scene)?.load(scene.frame, Memory::estimate)?;
        }
    }
    let measure = |scene: &CountedScene| scene.measure(arguments);
    scenes.iter().map(measure).collect()
}

impl CountedScene {
    /// Names a scene with these flags of the command line.
    ///
    /// # Errors
    /// A flag that there is not, or standard input.
    pub(super) fn new(
        file: &Path,
        flags: Vec<String>,
        frame: Option<u32>,
    ) -> Result<Self, Failure> {
        let arguments = SceneArguments::from_flags(file, &flags, Path::new("."))?;
        if arguments.is_standard_input() {
            let message = "a budget cannot measure standard input again";
            let help = "write the scene to a file, and name it";
            return Err(Diagnostic::new(message).with_help(help).into());
        }
        Ok(Self {
            arguments,
            flags,
            frame,
        })
    }

    /// Renders the scene, and returns its totals.
    fn measure(&self, arguments: &BudgetArguments) -> Result<SceneBudget, Failure> {
        let open = OpenScene::read(self)?;
        let bars = Bars::new(arguments.quiet);
        let show = |event| bars.show(event);
        let options = Options {
            threads: arguments.threads,
            on_event: Some(&show),
            ..Options::default()
        };
        let input = open.load(self.frame, Memory::estimate)?;
        let base = open.base_of(self.frame, &options)?;
        let session = Session::new(input, Stages::default())?;
        base.into_iter().for_each(|base| session.set_base(base));
        let mut rendering = session.render(&options)?;
        let totals = self.totals(&session, &rendering)?;
        if let Some(folder) = &arguments.keep {
            rendering.write(folder.join(folder_name(self.file())))?;
        }
        Ok(totals)
    }

    /// Returns the totals of a rendering of the scene.
    fn totals(&self, session: &Session, rendering: &Rendering) -> Result<SceneBudget, Failure> {
        let view = rendering.view(None);
        let counted = totals(view.film, view.survey).into_iter();
        let total = |(name, total): (String, Option<Number>)| Some((name, total?.as_u64()?));
        Ok(SceneBudget {
            scene: self.file().to_string_lossy().into_owned(),
            flags: self.flags.clone(),
            frame: self.frame,
            image: (&session.config().image).into(),
            config: session.picture()?,
            totals: counted.filter_map(total).collect(),
            objects: (rendering.attribution())
                .map_or_else(IndexMap::new, |costs| by_object(&view, costs)),
        })
    }
}

impl SceneSource for CountedScene {
    fn file(&self) -> &Path {
        self.arguments.file()
    }

    fn read(&self) -> Result<Source, Diagnostic> {
        self.arguments.read()
    }

    fn settings(&self) -> &[String] {
        self.arguments.settings()
    }

    fn change(&self, config: &mut Config, document: &Document) -> Result<(), Diagnostic> {
        self.arguments.change(config, document)?;
        config.cost = CostMode::Counters;
        config.metrics = RatioMetrics::default();
        config.repeats = Repeats::ONCE;
        config.output = Outputs::default();
        config.output.add(OptionalOutput::Objects);
        config.output.add(OptionalOutput::Tests);
        Ok(())
    }
}

/// Checks that the files of each scene are kept in a folder of its own.
///
/// # Errors
/// Two scenes have the same folder.
fn refuse_same_folder<'a>(files: impl Iterator<Item = &'a Path>) -> Result<(), Diagnostic> {
    let mut folders: HashMap<String, &Path> = HashMap::new();
    for file in files {
        let name = folder_name(file);
        if let Some(other) = folders.insert(name.clone(), file) {
            let [other, file] = [other, file].map(shown);
            let message = format!("`--keep` has one folder, `{name}`, for `{other}` and `{file}`");
            let help = "rename one, leave one out, or keep no files";
            return Err(Diagnostic::new(message).with_help(help));
        }
    }
    Ok(())
}

/// Returns the path of a scene as the name of a folder, which needs no quotes in a web page:
/// `configs-blocks` for `configs/blocks.yaml`.
fn folder_name(file: &Path) -> String {
    let path = file.with_extension("");
    let names = path.components().filter_map(|part| match part {
        Component::Normal(name) => Some(name.to_string_lossy()),
        _ => None,
    });
    let name = names.collect::<Vec<_>>().join("-");
    name.replace(|c: char| !c.is_alphanumeric() && !"._-".contains(c), "-")
}

/// Returns the totals of each object by the kinds of rays, of kinds that it has. Objects of one
/// name are added up.
fn by_object(
    view: &RenderingView,
    attribution: &CostAttribution,
) -> IndexMap<String, IndexMap<String, RayTotals>> {
    let [objects, _] = Group::all(view, attribution);
    let mut all: IndexMap<String, IndexMap<String, RayTotals>> = IndexMap::new();
    for (name, account) in objects.names.into_iter().zip(objects.accounts) {
        let kinds = all.entry(name).or_default();
        for kind in RayKind::ALL {
            let work = account.work(AttributionRule::Primary, kind);
            if work.rays > 0 {
                let of_kind = kinds.entry(kind.name().to_owned()).or_default();
                of_kind.add(work.into());
            }
        }
    }
    all
}
