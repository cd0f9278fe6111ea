//! `docs/results`, and each figure that is made of them.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use super::words::{digits, listed, range};
use crate::common::in_repository;

/// A figure as it stands in a text; `None` without the results that it takes.
type Figure = fn(&Results) -> Option<String>;

/// What stands in place of a figure whose results are not kept.
const NOT_MEASURED: &str = "(not measured)";

/// All figures by name.
pub const FIGURES: &[(&str, Figure)] = &[
    ("counters-time", |of| of.added_time("counters")),
    ("clock-time", |of| of.added_time("time")),
    ("counters-instructions", Results::counters_instructions),
    ("codec-none", |of| of.codec("none")),
    ("codec-lz4", |of| of.codec("lz4")),
    ("codec-zlib", |of| of.codec("zlib")),
    ("vtk-write", Results::vtk_write),
    ("embree", Results::embree),
    ("embree-version", |of| of.version("embree")),
    ("tinybvh", |of| {
        let rows = of.list("tinybvh", "rows")?.iter();
        let ratios = rows.map(|row| row["outcome"]["ratio"]["estimate"].as_f64());
        range(ratios, "")
    }),
    ("tinybvh-slower", Results::tinybvh_slower),
    ("tinybvh-version", |of| of.version("tinybvh")),
    ("device", |of| {
        let runs = of.list("device", "runs")?.iter();
        let inverse = |run: &Value| Some(1.0 / run["speed_by_cpu_time"].as_f64()?);
        range(runs.map(inverse), "")
    }),
    ("card", Results::card),
    ("embree-slowest", Results::embree_slowest),
    ("embree-single", |of| of.embree_ratios("single rays")),
    ("embree-streams", |of| {
        of.embree_ratios("stream / single rays")
    }),
    ("embree-builds", |of| {
        let rows = of.list("embree", "rows")?.iter();
        let built = rows.filter(|row| row["quality"][0] == "high" && is_build(row));
        let times = |row: &Value| Some(1.0 / row["outcome"]["ratio"]["estimate"].as_f64()?);
        range(built.map(times), "")
    }),
    ("embree-fast-builds", |of| of.embree_fast_builds(2)),
    ("embree-fast-builds-1", |of| of.embree_fast_builds(1)),
    ("embree-fast-trees", Results::embree_fast_trees),
    ("povray", Results::povray),
    ("povray-ratio", |of| of.povray_ratio("raycost --no-cost")),
    ("povray-files", |of| of.povray_ratio("raycost")),
    ("mitsuba-race", Results::mitsuba_race),
    ("mitsuba-ratio", |of| of.mitsuba_ratio("raycost, counters")),
    ("mitsuba-causes", Results::mitsuba_causes),
    ("numpy", Results::numpy),
    ("mirrors-pixels", |of| {
        of.share("hall_of_mirrors", "mirrors", "primary", "pixels")
    }),
    ("mirrors-time", |of| {
        of.share("hall_of_mirrors", "mirrors", "primary", "time_ns")
    }),
    ("nothing-time", |of| {
        of.share("hall_of_mirrors", "nothing", "hit", "time_ns")
    }),
    ("slats-pixels", |of| {
        of.share("trellis", "trellis", "primary", "pixels")
    }),
    ("high-quality", Results::high_quality),
    ("visits-of-objects", Results::visits_of_objects),
    ("thread-time", Results::thread_time),
    ("trace", Results::trace),
    ("waves", Results::waves),
    ("sampling", Results::sampling),
    ("sampling-plan", |of| {
        let plan = of.0.get("sampling")?["plan"].as_f64()?;
        Some(format!("{:.0} %", 100.0 * (plan - 1.0)))
    }),
    ("ladder", Results::ladder),
    ("threads-16", Results::speedup_of_16_threads),
];

/// The files of `docs/results` by their stems; texts as JSON strings.
pub struct Results(BTreeMap<String, Value>);

impl Results {
    pub fn read() -> Self {
        let files = fs::read_dir(in_repository("docs/results")).unwrap();
        let mut all = BTreeMap::new();
        for file in files.map(|entry| entry.unwrap().path()) {
            let stem = file.file_stem().unwrap().to_string_lossy().into_owned();
            let value = match file.extension().and_then(|ending| ending.to_str()) {
                Some("json") => serde_json::from_slice(&fs::read(&file).unwrap()).unwrap(),
                Some("txt") => fs::read_to_string(&file).unwrap().into(),
                _ => continue,
            };
            all.insert(stem, value);
        }
        Self(all)
    }

    /// The figure of a name, if there is one.
    pub fn figure(&self, name: &str) -> Option<String> {
        let (_, figure) = FIGURES.iter().find(|(known, _)| *known == name)?;
        Some(figure(self).unwrap_or_else(|| NOT_MEASURED.to_owned()))
    }

    /// Which commit made each file, where it says so.
    pub fn programs(&self) -> Vec<(&str, &Value)> {
        let of = self.0.iter().filter_map(|(name, file)| {
            let made_by = file.get("made_by")?;
            let commit = made_by.get("commit").or(made_by.pointer("/build/commit"))?;
            Some((name.as_str(), commit))
        });
        of.collect()
    }

    /// A list in a file.
    fn list(&self, file: &str, key: &str) -> Option<&Vec<Value>> {
        self.0.get(file)?.get(key)?.as_array()
    }

    /// "4.4": the version of a peer in its race, without the patch.
    fn version(&self, peer: &str) -> Option<String> {
        let (version, _) = self.0.get(peer)?[peer].as_str()?.rsplit_once('.')?;
        Some(version.to_owned())
    }

    /// "3 % [2, 4] in `spot`, …": the CPU time that measuring adds.
    fn added_time(&self, mode: &str) -> Option<String> {
        let rows = self.list("instrumentation", "relative")?.iter();
        let of_mode = rows.filter(|row| row["cost"] == mode);
        let scene = |row: &Value| {
            let percent = |key: &str| row[key].as_f64().map(|ratio| 100.0 * (ratio - 1.0));
            let [median, low, high] = [percent("median")?, percent("low")?, percent("high")?];
            let name = row["scene"].as_str()?;
            Some(format!("{median:.0} % [{low:.0}, {high:.0}] for `{name}`"))
        };
        Some(listed(&of_mode.map(scene).collect::<Option<Vec<_>>>()?))
    }

    /// "1.00 to 1.04 times …": what the clock of waves costs, and how well it agrees.
    fn waves(&self) -> Option<String> {
        let rows = self.list("waves", "rows")?;
        let ratios = |key: &str| {
            let ratios: Option<Vec<f64>> = rows.iter().map(|row| row[key].as_f64()).collect();
            let ratios = ratios?.into_iter().map(|ratio| format!("{ratio:.2}"));
            let (least, most) = (ratios.clone().min()?, ratios.max()?);
            Some(if least == most {
                least
            } else {
                format!("{least} to {most}")
            })
        };
        let agreeing = |row: &Value| {
            let windows = row["window_over_map"].as_array()?;
            let agrees = |ratio: &&Value| ratio.as_f64().is_some_and(|it| (it - 1.0).abs() <= 0.1);
            let scene = row["scene"].as_str()?.to_owned();
            Some((windows.iter().filter(agrees).count(), windows.len(), scene))
        };
        let agreeing: Vec<_> = rows.iter().map(agreeing).collect::<Option<_>>()?;
        let (least, n, scene) = agreeing.iter().min()?;
        Some(format!(
            "The times are {} times as long, the sums {}, and in {} scenes {least} (`{scene}`) to {} of {n} windows agree",
            ratios("time_over_counters")?,
            ratios("sum_over_thread_time")?,
            rows.len(),
            agreeing.iter().max()?.0,
        ))
    }

    /// A table of squared errors by the rules of adaptive sampling.
    fn sampling(&self) -> Option<String> {
        let plan = self.0.get("sampling")?["plan"].as_f64()?;
        let all = self.list("sampling", "rows")?;
        let ratio = |row: &Value, error: &str| {
            let [ratio, low, high] = ["ratio", "low", "high"].map(|key| row[error][key].as_f64());
            let [ratio, low, high] = [ratio?, low?, high?];
            Some((ratio, format!("{ratio:.2} [{low:.2}, {high:.2}]")))
        };
        let of_scene = |by_efficiency: &Value| {
            let scene = by_efficiency["scene"].as_str()?;
            let is_other = |row: &&Value| row["scene"] == scene && row["rule"] == "noise";
            let by_noise = all.iter().find(is_other)?;
            let (linear, shown) = ratio(by_efficiency, "linear")?;
            let (perceived, shown_perceived) = ratio(by_efficiency, "perceived")?;
            let (noise, noise_perceived) = (
                ratio(by_noise, "linear")?.0,
                ratio(by_noise, "perceived")?.0,
            );
            let row = format!(
                "| `{scene}` | {shown} | {:.2} | {noise:.2} | {shown_perceived} | {:.2} | {noise_perceived:.2} |\n",
                plan * linear,
                plan * perceived,
            );
            Some((linear, row))
        };
        let rows = all.iter().filter(|row| row["rule"] == "efficiency");
        let mut rows = rows.map(of_scene).collect::<Option<Vec<_>>>()?;
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let rows: String = rows.into_iter().map(|(_, row)| row).collect();
        let head = "\n\n| scene | by efficiency | with its plan | by noise | seen: by efficiency | with its plan | by noise |\n\
                    |---|--:|--:|--:|--:|--:|--:|\n";
        Some(format!("{head}{rows}\n"))
    }

    /// The table of the ladder's steps, and the steps that were left out.
    fn ladder(&self) -> Option<String> {
        let cell = |point: &Value, metric: &str, unit: &str| {
            let values = point["metrics"][metric].as_array();
            let number = |column: usize| values.and_then(|values| values[column].as_f64());
            let [median, low, high] = [1, 2, 3].map(|column| number(column).map(whole_or_digits));
            match (median, low.zip(high)) {
                (Some(median), Some((low, high))) if low != high => {
                    format!("{median}{unit} [{low}, {high}]")
                }
                (Some(median), _) => format!("{median}{unit}"),
                _ => "-".to_owned(),
            }
        };
        let roofline = self.list("ladder", "roofline");
        let waits = |point: &Value| {
            let mut points = roofline.into_iter().flatten();
            let found = points.find(|of| of["point"] == point["point"]);
            let share = found.and_then(|of| of["latency_share"].as_f64());
            share.map_or("-".to_owned(), |share| {
                format!("{} %", digits(100.0 * share))
            })
        };
        let row = |point: &Value| {
            let [time, step, start, visits, tests, difference] = [
                ("render_wall_ms", " ms"),
                ("speedup_over_step", ""),
                ("speedup_over_start", ""),
                ("node_visits_per_ray", ""),
                ("primitive_tests_per_ray", ""),
                ("picture_difference", ""),
            ]
            .map(|(metric, unit)| cell(point, metric, unit));
            let name = point["point"]["step"].as_str()?;
            let waits = waits(point);
            Some(format!(
                "| {name} | {time} | {step} | {start} | {visits} | {tests} | {waits} | {difference} |\n"
            ))
        };
        let rows = self.list("ladder", "points")?.iter().map(row);
        let left_out = self.list("ladder", "left_out")?.iter().map(|step| {
            Some(format!(
                "\n`{}` is left out: {}.\n",
                step["step"].as_str()?,
                step["reason"].as_str()?
            ))
        });
        let head = "\n\n| step | render time | over the step before | in all | visits / ray | tests / ray | memory | picture |\n\
                    |---|--:|--:|--:|--:|--:|--:|--:|\n";
        let [rows, left_out] = [
            rows.collect::<Option<String>>()?,
            left_out.collect::<Option<String>>()?,
        ];
        Some(format!("{head}{rows}{left_out}\n"))
    }

    /// The speedups of 16 threads over one.
    fn speedup_of_16_threads(&self) -> Option<String> {
        let points = self.list("strong_scaling_to_16_threads", "points")?.iter();
        let with_all = points.filter(|point| point["point"]["threads"] == 16);
        range(
            with_all.map(|point| point["metrics"]["speedup"][1].as_f64()),
            "",
        )
    }

    /// "5.4 nodes among 10,000 of them and 8.2 among 1,000,000".
    fn visits_of_objects(&self) -> Option<String> {
        let points = self.list("objects", "points")?;
        let visits = |n: u64| {
            let point = points.iter().find(|point| point["point"]["objects"] == n)?;
            Some(digits(point["metrics"]["node_visits_per_ray"][1].as_f64()?))
        };
        let [some, many] = [visits(10_000)?, visits(1_000_000)?];
        Some(format!(
            "{some} nodes among 10,000 of them and {many} among 1,000,000"
        ))
    }

    fn counters_instructions(&self) -> Option<String> {
        let rows = self.list("counters", "rows")?.iter();
        let added = |row: &Value| Some(row["counters"].as_f64()? / row["none"].as_f64()? - 1.0);
        range(rows.map(added).map(|share| Some(100.0 * share?)), "%")
    }

    /// The cells of the table of codecs: sizes of both files, and CPU time.
    fn codec(&self, codec: &str) -> Option<String> {
        let relative = |metric: &'static str| {
            let points = self.list("codecs", "points")?;
            let of = |codec: &str, scene: &Value| {
                let mut points = points.iter();
                let is_it = |point: &&Value| {
                    point["point"]["compress"] == codec && point["point"]["scene"] == *scene
                };
                points.find(is_it)?["metrics"][metric][1].as_f64()
            };
            let scenes = points
                .iter()
                .filter(|point| point["point"]["compress"] == "none");
            let ratio = |point: &Value| {
                let scene = &point["point"]["scene"];
                Some(of(codec, scene)? / of("none", scene)?)
            };
            Some(scenes.map(ratio).collect::<Vec<_>>())
        };
        let percent = |metric| range(relative(metric)?.into_iter().map(|x| Some(100.0 * x?)), "%");
        let time = range(relative("write_cpu_ms")?.into_iter(), "");
        Some(format!(
            " {} | {} | {} ",
            percent("frame_vti_bytes")?,
            percent("hits_vtu_bytes")?,
            time?
        ))
    }

    fn vtk_write(&self) -> Option<String> {
        let rows = self.list("vtk_write", "rows")?.iter();
        let plain = rows.filter(|row| row["codec"] == "none");
        range(
            plain.map(|row| row["write_over_plain"]["estimate"].as_f64()),
            "",
        )
    }

    /// The ratios of the rays a second to Embree's, in one kind of race, on any number of threads.
    fn embree_ratios(&self, race: &str) -> Option<String> {
        let races = self.embree_races("high")?.into_iter();
        let raced = races.filter(|of| of.race == race);
        range(raced.map(|of| of.ratio["estimate"].as_f64()), "")
    }

    /// "0.77 to 2.8 times Embree's rate, slower in 6 of 32 races": the rates of rays in trees built fast.
    fn embree_fast_trees(&self) -> Option<String> {
        let races = self.embree_races("fast")?.into_iter();
        let ratios: Vec<&Value> = races.map(|race| race.ratio).collect();
        let rates = range(ratios.iter().map(|ratio| ratio["estimate"].as_f64()), "")?;
        let (n_slower, n) = (
            ratios.iter().filter(|ratio| is_slower(ratio)).count(),
            ratios.len(),
        );
        Some(format!(
            "{rates} times Embree's rate, slower in {n_slower} of {n} races"
        ))
    }

    /// A table: the ratios of rays a second to Embree's, on two threads.
    fn embree(&self) -> Option<String> {
        let scenes = ["spheres", "soup", "architecture"];
        let mut rows: Vec<([&str; 2], [Option<String>; 3])> = Vec::new();
        let races = self.embree_races("high")?.into_iter();
        for EmbreeRace {
            race,
            kind,
            scene,
            ratio,
            ..
        } in races.filter(|race| race.n_threads == 2)
        {
            let at = scenes.iter().position(|name| *name == scene)?;
            let row = [kind, race];
            let found = rows.iter().position(|(of, _)| *of == row);
            let index = found.unwrap_or(rows.len());
            if found.is_none() {
                rows.push((row, [None, None, None]));
            }
            rows[index].1[at] = Some(with_interval(ratio)?);
        }
        let row = |([kind, race], cells): &([&str; 2], [Option<String>; 3])| {
            let cells = cells
                .each_ref()
                .map(|cell| cell.as_deref().unwrap_or_default());
            format!("| {kind} | {race} | {} |", cells.join(" | "))
        };
        let rows: Vec<String> = rows.iter().map(row).collect();
        let head = format!(
            "| rays | race | {} |\n|---|---|--:|--:|--:|",
            scenes.join(" | ")
        );
        (!rows.is_empty()).then(|| format!("\n{head}\n{}\n", rows.join("\n")))
    }

    /// The races of rays with Embree, by hierarchies of a quality.
    fn embree_races(&self, quality: &str) -> Option<Vec<EmbreeRace<'_>>> {
        let rows = self.list("embree", "rows")?.iter();
        let raced = rows.filter(|row| row["quality"][0] == quality);
        let races = raced.filter_map(|row| {
            let outcome = &row["outcome"];
            let (race, kind) = race_of(&outcome["discipline"])?;
            Some(EmbreeRace {
                race,
                kind,
                scene: row["scene"].as_str()?,
                n_threads: row["n_threads"].as_u64()?,
                ratio: &outcome["ratio"],
            })
        });
        Some(races.collect())
    }

    /// "0.61 [0.60, 0.61] (shadow, single rays, architecture, one thread)": the lowest ratio.
    fn embree_slowest(&self) -> Option<String> {
        let estimate = |race: &EmbreeRace| race.ratio["estimate"].as_f64();
        let races = self.embree_races("high")?.into_iter();
        let slowest = races.min_by(|a, b| estimate(a).partial_cmp(&estimate(b)).unwrap())?;
        let EmbreeRace {
            race,
            kind,
            scene,
            n_threads,
            ratio,
        } = slowest;
        let threads = if n_threads == 1 {
            "one thread"
        } else {
            "all threads"
        };
        Some(format!(
            "{} ({kind}, {race}, {scene}, {threads})",
            with_interval(ratio)?
        ))
    }

    /// "1.9 [1.8, 2.0] (soup), …": the times to build hierarchies fast over Embree's of medium quality.
    fn embree_fast_builds(&self, n_threads: u64) -> Option<String> {
        let rows = self.list("embree", "rows")?.iter();
        let built = rows.filter(|row| {
            row["n_threads"] == n_threads && row["quality"][0] == "fast" && is_build(row)
        });
        let build = |row: &Value| {
            let ratio = &row["outcome"]["ratio"];
            let times = [
                &ratio["estimate"],
                &ratio["interval"][1],
                &ratio["interval"][0],
            ];
            let [times, low, high] = times.map(|ratio| Some(digits(1.0 / ratio.as_f64()?)));
            let scene = row["scene"].as_str()?;
            Some(format!("{} [{}, {}] ({scene})", times?, low?, high?))
        };
        Some(listed(&built.map(build).collect::<Option<Vec<_>>>()?))
    }

    /// "0.58 [0.56, 0.60] (shadow, trellis), …": the races that raycost loses to tinybvh, the slowest first.
    fn tinybvh_slower(&self) -> Option<String> {
        let rows = self.list("tinybvh", "rows")?.iter();
        let raced = rows.filter(|row| is_slower(&row["outcome"]["ratio"]));
        let mut slower: Vec<&Value> = raced.collect();
        let estimate = |row: &Value| row["outcome"]["ratio"]["estimate"].as_f64();
        slower.sort_by(|a, b| estimate(a).partial_cmp(&estimate(b)).unwrap());
        // The slower quality of each scene and kind.
        let mut seen = Vec::new();
        slower.retain(|row| {
            let of = (&row["scene"], &row["outcome"]["discipline"]);
            let is_new = !seen.contains(&of);
            seen.push(of);
            is_new
        });
        let shown = |row: &&Value| {
            let (_, kind) = race_of(&row["outcome"]["discipline"])?;
            let [scene, quality] = [&row["scene"], &row["quality"][0]].map(Value::as_str);
            let (scene, ratio) = (scene?, with_interval(&row["outcome"]["ratio"])?);
            let built = if quality? == "fast" {
                ", built fast"
            } else {
                ""
            };
            Some(format!("{ratio} ({kind}, {scene}{built})"))
        };
        let slower: Option<Vec<_>> = slower.iter().map(shown).collect();
        Some(slower?.join(", ")).filter(|shown| !shown.is_empty())
    }

    /// Returns the ratio of POV-Ray's time to a program's: both are ratios to the base program of their round.
    fn povray_ratio(&self, program: &str) -> Option<String> {
        let ratios = &self.0.get("povray")?["ratios"];
        let over_base = |name: &str| match name {
            "raycost --no-cost" => Some(1.0),
            _ => ratios[name]["median"].as_f64(),
        };
        Some(digits(over_base("POV-Ray")? / over_base(program)?))
    }

    fn povray(&self) -> Option<String> {
        let race = self.0.get("povray")?;
        let seconds = |name: &str| {
            race["ms"][name]["median"]
                .as_f64()
                .map(|ms| digits(ms / 1e3))
        };
        Some(format!(
            "POV-Ray {} takes {} s, raycost with all of its files {} s and without costs {} s, {} s of them for \
             rendering and {} s for writing, at {} x {} pixels on {} threads",
            race["povray"].as_str()?,
            seconds("POV-Ray")?,
            seconds("raycost")?,
            seconds("raycost --no-cost")?,
            seconds("raycost --no-cost, render")?,
            seconds("raycost --no-cost, write")?,
            race["width"],
            race["height"],
            race["threads"],
        ))
    }

    /// "1.1 [0.95, 1.1]": the ratio of Mitsuba's time to a racer's.
    fn mitsuba_ratio(&self, racer: &str) -> Option<String> {
        let ratio = &self.0.get("mitsuba_race")?["ratios"][racer];
        let inverse = |end: &str| Some(digits(1.0 / ratio[end].as_f64()?));
        let [median, low, high] = ["median", "high", "low"].map(inverse);
        Some(format!("{} [{}, {}]", median?, low?, high?))
    }

    /// "Mitsuba 3 takes 93 ms …; raycost's speed over it: 1.1 [1.0, 1.2] with `cost: none`, …".
    fn mitsuba_race(&self) -> Option<String> {
        let race = self.0.get("mitsuba_race")?;
        let times = |cost: &str| {
            let ratio = self.mitsuba_ratio(&format!("raycost, {cost}"))?;
            Some(format!("{ratio} with `cost: {cost}`"))
        };
        let modes = ["none", "counters", "time", "single_ray_time"].map(times);
        Some(format!(
            "Mitsuba {} takes {} ms at {} x {} pixels with {} samples on {} threads; raycost's speed over it: {}",
            race["mitsuba"].as_str()?,
            digits(race["ms"]["Mitsuba llvm_ad_rgb"]["median"].as_f64()?),
            race["width"],
            race["height"],
            race["samples"],
            race["threads"],
            listed(&modes.into_iter().collect::<Option<Vec<_>>>()?),
        ))
    }

    /// "0.93 [0.90, 0.96] with AVX2 on both sides, …": the race without two of its differences; on a
    /// processor without AVX-512, one is none.
    fn mitsuba_causes(&self) -> Option<String> {
        let [avx2, later] = ["AVX2", "third frame"]
            .map(|with| self.mitsuba_ratio(&format!("raycost, counters, {with}")));
        let later = format!(
            "{} in the third frame of an animation, whose memory is mapped",
            later?
        );
        Some(match avx2 {
            Some(avx2) => format!("{avx2} with AVX2 on both sides, {later}"),
            None => later,
        })
    }

    /// What a graphics card is worth, by the rows with goals of the race of devices.
    fn card(&self) -> Option<String> {
        let rows = self.list("device", "rows").into_iter().flatten();
        let on_card = rows.filter(|row| {
            row["device"]
                .as_str()
                .is_some_and(|it| it.starts_with("cuda"))
        });
        let measured = on_card.filter_map(|row| {
            let ratios = row["found"].as_object()?.values();
            let ratios = range(ratios.map(Value::as_f64), "")?;
            let [work, anchor] = ["work", "anchor"].map(|key| row[key].as_str());
            let (work, anchor) = (work?, anchor?);
            Some(format!(
                "{ratios} times as fast as {anchor} ({work}; goal {})",
                row["goal"]
            ))
        });
        let measured: Vec<_> = measured.collect();
        if measured.is_empty() {
            return Some("No graphics card is measured".to_owned());
        }
        Some(format!("A graphics card is {}", listed(&measured)))
    }

    fn numpy(&self) -> Option<String> {
        let races = self.list("validation", "loop")?.iter();
        let race = |race: &Value| {
            let ratio = &race["ratios"]["numpy"];
            let [median, low, high] = ["median", "low", "high"].map(|key| ratio[key].as_f64());
            Some(format!(
                "{} [{}, {}] times as long at {} x {}",
                digits(median?),
                digits(low?),
                digits(high?),
                race["width"],
                race["height"]
            ))
        };
        Some(listed(&races.map(race).collect::<Option<Vec<_>>>()?))
    }

    /// What an object takes of a scene.
    fn share(&self, scene: &str, name: &str, charge: &str, part: &str) -> Option<String> {
        let objects = self.0.get("shares")?[scene]["objects"].as_array()?;
        let is_it = |row: &&Value| {
            row["name"] == name && row["charge"] == charge && row["ray_kind"] == "all"
        };
        let share = objects.iter().find(is_it)?[format!("{part}_share")].as_f64()?;
        Some(format!("{} %", digits(100.0 * share)))
    }

    /// What the quality `high` saves of the tests in `trellis`.
    fn high_quality(&self) -> Option<String> {
        let points = self.list("prediction", "points")?;
        let tests = |quality: &str| {
            let is_it = |point: &&Value| {
                point["point"]["scene"] == "trellis" && point["point"]["acceleration"] == quality
            };
            points.iter().find(is_it)?["metrics"]["primitive_tests_per_ray"][1].as_f64()
        };
        Some(format!(
            "{:.0} %",
            100.0 * (1.0 - tests("high")? / tests("balanced")?)
        ))
    }

    /// The line that `render` prints with `--repeats`.
    fn thread_time(&self) -> Option<String> {
        let time = &self.0.get("shares")?["hall_of_mirrors"]["thread_time"];
        let busy = time["busy_ns"].as_f64()?;
        let share = |part: &str| Some(100.0 * time[format!("{part}_ns")].as_f64()? / busy);
        // Results of an earlier program have no warm-up.
        let warm_up = share("warm_up").map(|percent| format!("{percent:.1} % warm-up, "));
        Some(format!(
            "\n\n    threads {:.2} s at work: {:.1} % pixels, {:.1} % film, {:.1} % clock, {}{:.1} % unexplained\n\n",
            busy / 1e9,
            share("pixels")?,
            share("film")?,
            share("clock")?,
            warm_up.unwrap_or_default(),
            share("unexplained")?
        ))
    }

    fn trace(&self) -> Option<String> {
        let tree = self.0.get("trace")?.as_str()?.trim_end();
        Some(format!("\n\n```\n{tree}\n```\n\n"))
    }
}

/// "0.61 [0.60, 0.61]": a ratio with its interval.
fn with_interval(ratio: &Value) -> Option<String> {
    let [low, high] = [0, 1].map(|end| ratio["interval"][end].as_f64());
    let estimate = ratio["estimate"].as_f64()?;
    Some(format!("{estimate:.2} [{:.2}, {:.2}]", low?, high?))
}

/// A count with all its digits, and other numbers with the ones that count.
fn whole_or_digits(value: f64) -> String {
    match value.fract() {
        0.0 => value.to_string(),
        _ => digits(value),
    }
}

/// raycost is slower if the interval of its ratio is below 1.
fn is_slower(ratio: &Value) -> bool {
    ratio["interval"][1].as_f64() < Some(1.0)
}

fn is_build(row: &Value) -> bool {
    row["outcome"]["discipline"] == "build"
}

/// A race of rays with Embree.
struct EmbreeRace<'a> {
    /// How both trace.
    race: &'a str,
    /// The kind of rays.
    kind: &'a str,
    scene: &'a str,
    n_threads: u64,
    /// The ratio of the rates with its interval.
    ratio: &'a Value,
}

/// "single" and "primary" of `{"single": "primary"}`; none of a build.
fn race_of(discipline: &Value) -> Option<(&str, &str)> {
    let (race, kind) = discipline.as_object()?.iter().next()?;
    let race = match race.as_str() {
        "single" => "single rays",
        "stream" => "stream / single rays",
        "stream_against_robust" => "stream / robust single rays",
        _ => "stream / packets of 16",
    };
    Some((race, kind.as_str()?))
}
