//! A study file → many runs of `raycost render` → statistics and plots.
//!
//! Takes a [`StudyPlan`]: scenes, factors to vary and the number of repeats. Each run is a separate
//! process, so no run inherits memory, caches or threads from another one, and the study measures
//! the program that users run. Each round runs all points once, in a new random order, so that a
//! drift of the machine affects all points equally (Hoefler and Belli, "Scientific Benchmarking of
//! Parallel Computing Systems", SC15, rules 4 and 9). The [`RunLog`] gets each run as soon as it
//! ends, and a logged run is never repeated.

mod factor_level;
mod factor;
mod vary;
mod launcher;
mod step;
mod point;
mod plot_spec;
mod plan;
mod metric_list;
mod plan_check;
mod run_metrics;
mod run_log;
mod median_interval;
mod sample;
mod table;
mod by_round;
mod scaling;
mod overhead;
mod step_rows;
mod cost_law;
mod log_law;
mod limits_file;
mod roofline_point;
mod plot;

pub use cost_law::{CostLaw, CostSample, PowerLaw};
pub use factor::{Factor, FlagFactor};
pub use launcher::Launcher;
pub use limits_file::LimitsFile;
pub use log_law::LogLaw;
pub use metric_list::{MetricNeed, StudyMetric};
pub use overhead::overhead_rows;
pub use plan::{PlannedRun, QuickPlan, StudyPlan};
pub use plan_check::OVERRIDING;
pub use plot::{Ceiling, Figure, PlotPoint, Series};
pub use plot_spec::PlotSpec;
pub use point::{StudyPoint, label_of};
pub use roofline_point::{Bound, RooflinePoint, bottleneck_report, roofline_points};
pub use run_log::{Run, RunLog, RunLogError};
pub use run_metrics::RunMetrics;
pub use sample::SampleStatistics;
pub use scaling::scaling_rows;
pub use step::{LeftOutStep, StepCommand, StudyStep};
pub use step_rows::step_rows;
pub use table::{StatisticsRow, statistics_rows, write_csv};
pub use vary::{Case, Vary};
