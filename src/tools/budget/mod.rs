//! Exact totals of the counters of scenes, which a later rendering may not exceed.
//!
//! A [`CostBudget`] is a file that a project keeps beside its sources. [`BudgetCheck`] compares its totals with
//! the totals of a rendering now, and [`report()`] shows what grew. Counters are the same on every machine and
//! number of threads, so a budget allows no growth at all unless an [`Allowance`] says otherwise.

mod check;
mod file;
mod report;

pub use check::{Allowance, BudgetCheck, Growth};
pub use file::{CostBudget, FILE, RayTotals, SceneBudget};
pub use report::{BudgetFormat, badge, benchmark, markdown, report};
