//! The sections on machine and program.

use serde::{Deserialize, Serialize};
use sysinfo::System;

use host::provenance;
use scene::config::Pinning;

/// Bytes of a GiB.
const GIB: f64 = (1_u64 << 30) as f64;

/// The machine that rendered, as far as the system reports it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// The operating system with its version.
    pub os: Option<String>,
    /// The operating system's kernel with its version.
    #[serde(default)]
    pub kernel: Option<String>,
    /// `x86_64`, `aarch64`, …
    pub arch: String,
    /// The name of the processor.
    pub cpu: Option<String>,
    /// The number of logical CPUs that the process may use.
    pub logical_cpus: Option<u64>,
    /// The memory of the machine in GiB, rounded.
    #[serde(default)]
    pub memory_gib: Option<u64>,
}

/// The build of raycost that rendered.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Build {
    /// The version of the crate.
    pub version: String,
    /// The commit, if the build was given one.
    pub commit: Option<String>,
    /// The version of the compiler.
    pub compiler: String,
    /// The Cargo profile.
    pub profile: String,
    /// The compiler flags.
    pub flags: String,
}

/// The threads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Threads {
    /// Threads that rendered.
    pub used: usize,
    /// Threads that the machine can run at once.
    pub available: usize,
    /// The places of the threads that the user asked for.
    #[serde(default)]
    pub pin: Pinning,
    /// The CPUs on which each thread of this process may run, as Linux lists them, such as
    /// `0-3,8`; null where the system does not report them.
    #[serde(default)]
    pub affinity: Vec<Option<String>>,
}

impl Machine {
    /// Describes the machine that runs this process.
    pub fn current() -> Self {
        let mut system = System::new();
        system.refresh_cpu_list(sysinfo::CpuRefreshKind::nothing());
        system.refresh_memory();
        let cpu = system.cpus().first().map(|cpu| cpu.brand().trim());
        let logical_cpus = std::thread::available_parallelism().ok();
        Self {
            os: System::long_os_version(),
            kernel: Some(System::kernel_long_version()),
            arch: std::env::consts::ARCH.to_owned(),
            cpu: cpu.map(str::to_owned),
            logical_cpus: logical_cpus.map(|n| n.get() as u64),
            memory_gib: Some(system.total_memory())
                .filter(|bytes| *bytes > 0)
                .map(|bytes| (bytes as f64 / GIB).round() as u64),
        }
    }
}

impl Build {
    /// Returns the program with its version and its commit.
    pub fn title(&self) -> String {
        provenance::program(&self.version, self.commit.as_deref())
    }
}
