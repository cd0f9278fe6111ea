//! The kernels that devices ran for two outputs, and their times.

use serde::Serialize;

use super::Side;
use output::summary::KernelEntry;
use tracer::cost::KernelWork;

/// The times of one kernel, of A and B.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KernelTimes {
    /// The name of the kernel.
    pub name: String,
    /// Its launches for A; `None` if the processor traced the rays itself.
    pub a: Option<KernelWork>,
    /// Its launches for B.
    pub b: Option<KernelWork>,
}

/// Returns the kernels of both sides, each once, first A's.
pub(super) fn compare(sides: &[Side; 2]) -> Vec<KernelTimes> {
    let [a, b] = sides
        .each_ref()
        .map(|side| side.summary().acceleration.kernels.as_slice());
    let only_in_b = b
        .iter()
        .filter(|kernel| work(a, &kernel.work.name).is_none());
    let names = a.iter().chain(only_in_b).map(|kernel| &kernel.work.name);
    let times = |name: &String| KernelTimes {
        name: name.clone(),
        a: work(a, name).cloned(),
        b: work(b, name).cloned(),
    };
    names.map(times).collect()
}

/// Returns the launches of the kernel with this name.
fn work<'a>(kernels: &'a [KernelEntry], name: &str) -> Option<&'a KernelWork> {
    let kernel = kernels.iter().find(|kernel| kernel.work.name == name);
    kernel.map(|kernel| &kernel.work)
}
