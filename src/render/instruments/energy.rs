//! The energy of the processor packages, through Linux perf events or powercap.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use host::files;

/// The meters of all processor packages of the machine, or the reason why there are none. They
/// measure all programs, and the idle processors too.
#[derive(Debug)]
pub(super) struct EnergyMeters {
    packages: Result<Vec<Package>, String>,
}

/// The meter of a package.
#[derive(Debug)]
struct Package {
    source: EnergySource,
    joules_per_count: f64,
    /// The last count.
    before: u64,
}

#[derive(Debug)]
enum EnergySource {
    #[cfg(target_os = "linux")]
    Perf(perf_event::Counter),
    /// The file of a count that starts anew after a greatest one.
    Powercap { file: PathBuf, greatest: u64 },
}

impl EnergyMeters {
    /// Finds all meters below the mount point of sysfs: perf's, which count without an end, or
    /// else powercap's.
    pub(super) fn start(sysfs: &Path) -> Self {
        let packages = open_perf(sysfs).or_else(|of_perf| {
            open_powercap(sysfs).map_err(|of_powercap| reason(&of_perf, &of_powercap))
        });
        Self { packages }
    }

    /// Starts no meters, for this reason.
    pub(super) fn none(why_not: &str) -> Self {
        Self {
            packages: Err(why_not.to_owned()),
        }
    }

    /// Returns the reason why there are no meters, if there are none.
    pub(super) fn why_not(&self) -> Option<&str> {
        self.packages.as_ref().err().map(String::as_str)
    }

    /// Returns the energy of all packages since the last call, or since the start, in joules.
    pub(super) fn lap(&mut self) -> Option<f64> {
        let packages = self.packages.as_mut().ok()?;
        let joules: io::Result<f64> = packages.iter_mut().map(Package::lap).sum();
        if let Err(error) = &joules {
            self.packages = Err(format!("not available any more: {error}"));
        }
        joules.ok()
    }
}

impl Package {
    fn start(mut source: EnergySource, joules_per_count: f64) -> io::Result<Self> {
        let before = source.read()?;
        Ok(Self {
            source,
            joules_per_count,
            before,
        })
    }

    fn lap(&mut self) -> io::Result<f64> {
        let now = self.source.read()?;
        let counted = match &self.source {
            EnergySource::Powercap { greatest, .. } if now < self.before => {
                now + greatest.saturating_sub(self.before)
            }
            _ => now.saturating_sub(self.before),
        };
        self.before = now;
        Ok(counted as f64 * self.joules_per_count)
    }
}

impl EnergySource {
    fn read(&mut self) -> io::Result<u64> {
        match self {
            #[cfg(target_os = "linux")]
            Self::Perf(counter) => counter.read(),
            Self::Powercap { file, .. } => read_number(file),
        }
    }
}

/// Opens perf's counter `power/energy-pkg/` on the one CPU of each package that has it.
#[cfg(target_os = "linux")]
fn open_perf(sysfs: &Path) -> io::Result<Vec<Package>> {
    use perf_event::Builder;
    use perf_event::events::Dynamic;
    let pmu = sysfs.join("bus/event_source/devices/power");
    let mut event = Dynamic::builder(&pmu)?;
    event.event("energy-pkg")?;
    let joules_per_count = event.scale()?.ok_or(ErrorKind::NotFound)?;
    let event = event.build().map_err(io::Error::other)?;
    let cpus = host::affinity::parse_cpu_list(&read(&pmu.join("cpumask"))?);
    let package = |cpu| {
        let mut builder = Builder::new(event);
        // These counters refuse to exclude anything.
        builder.any_pid().one_cpu(cpu).include_kernel().include_hv();
        let counter = builder.enabled(true).build()?;
        Package::start(EnergySource::Perf(counter), joules_per_count)
    };
    let cpus = cpus.ok_or(ErrorKind::InvalidData)?.into_iter();
    cpus.map(package).collect()
}

#[cfg(not(target_os = "linux"))]
fn open_perf(_: &Path) -> io::Result<Vec<Package>> {
    Err(io::Error::other("it is supported on Linux only"))
}

/// Finds the zones of packages, such as `intel-rapl:0`, whose processors may be AMD's, too. Their
/// parts, such as `intel-rapl:0:0`, the same packages in `intel-rapl-mmio:0`, and the platform,
/// whose `name` is `psys`, would count energy twice.
///
/// # Errors
/// `NotFound` if there are none, or the first file that cannot be read.
fn open_powercap(sysfs: &Path) -> io::Result<Vec<Package>> {
    let mut packages = Vec::new();
    for entry in sysfs.join("class/powercap").read_dir()? {
        let zone = entry?;
        let is_whole = (zone.file_name().to_str())
            .and_then(|name| name.strip_prefix("intel-rapl:"))
            .is_some_and(|number| number.parse::<u32>().is_ok());
        let zone = zone.path();
        if is_whole && read(&zone.join("name"))?.starts_with("package") {
            let source = EnergySource::Powercap {
                file: zone.join("energy_uj"),
                greatest: read_number(&zone.join("max_energy_range_uj"))?,
            };
            packages.push(Package::start(source, 1e-6)?);
        }
    }
    if packages.is_empty() {
        return Err(ErrorKind::NotFound.into());
    }
    Ok(packages)
}

fn read_number(file: &Path) -> io::Result<u64> {
    let number = read(file)?.trim().parse();
    number.map_err(|_| io::Error::other(format!("{} has no number", file.display())))
}

/// Reads a file of sysfs; an error names it.
fn read(file: &Path) -> io::Result<String> {
    files::read_text(file, 1 << 12).map_err(|error| unreadable(file, &error))
}

fn unreadable(file: &Path, error: &io::Error) -> io::Error {
    let shown = file.display();
    let why = match error.kind() {
        ErrorKind::PermissionDenied => {
            format!("the kernel denies access: allow it by `sudo chmod a+r {shown}`")
        }
        _ => format!("cannot read {shown}: {error}"),
    };
    io::Error::new(error.kind(), why)
}

/// Describes why there are no meters.
fn reason(of_perf: &io::Error, of_powercap: &io::Error) -> String {
    let why = match (of_perf.kind(), of_powercap.kind()) {
        (ErrorKind::NotFound, ErrorKind::NotFound) => {
            "the processor or the virtual machine reports none".to_owned()
        }
        (ErrorKind::PermissionDenied, ErrorKind::NotFound) => {
            "the kernel denies access: set /proc/sys/kernel/perf_event_paranoid to 0 or less"
                .to_owned()
        }
        (_, ErrorKind::NotFound) => of_perf.to_string(),
        _ => of_powercap.to_string(),
    };
    format!("not available here: {why}")
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// Writes a zone of powercap in a made-up sysfs.
    fn write_zone(sysfs: &Path, zone: &str, name: &str, count: u64) {
        let zone = sysfs.join("class/powercap").join(zone);
        fs::create_dir_all(&zone).unwrap();
        let count = format!("{count}\n");
        for (file, text) in [
            ("name", format!("{name}\n").as_str()),
            ("energy_uj", &count),
            ("max_energy_range_uj", "10000000\n"),
        ] {
            fs::write(zone.join(file), text).unwrap();
        }
    }

    #[test]
    fn packages_are_added_up_and_their_parts_count_once() {
        let sysfs = tempfile::tempdir().unwrap();
        let write = |zone: &str, name: &str, count| write_zone(sysfs.path(), zone, name, count);
        let write_others = |count| {
            for (zone, name) in [
                ("intel-rapl:0:0", "core"),
                ("intel-rapl:2", "psys"),
                ("intel-rapl-mmio:0", "package-0"),
            ] {
                write(zone, name, count);
            }
        };
        write_others(0);
        write("intel-rapl:0", "package-0", 1_000_000);
        write("intel-rapl:1", "package-1", 9_500_000);
        let mut meters = EnergyMeters::start(sysfs.path());
        assert_eq!(meters.why_not(), None);
        assert_eq!(meters.lap(), Some(0.0));
        write_others(5_000_000);
        write("intel-rapl:0", "package-0", 3_000_000);
        // This one has started anew.
        write("intel-rapl:1", "package-1", 500_000);
        assert_eq!(meters.lap(), Some(3.0));
        assert_eq!(meters.lap(), Some(0.0));
    }

    #[test]
    fn the_reason_why_there_are_none_has_a_remedy() {
        let sysfs = tempfile::tempdir().unwrap();
        let none = EnergyMeters::start(sysfs.path());
        let why_not = "not available here: the processor or the virtual machine reports none";
        assert_eq!(none.why_not(), Some(why_not));
        let [absent, denied] = [ErrorKind::NotFound, ErrorKind::PermissionDenied].map(Into::into);
        let file = Path::new("/sys/class/powercap/intel-rapl:0/energy_uj");
        let of_file = reason(&absent, &unreadable(file, &denied));
        let remedy = "allow it by `sudo chmod a+r /sys/class/powercap/intel-rapl:0/energy_uj`";
        assert!(of_file.ends_with(remedy), "{of_file}");
        let of_perf = reason(&denied, &absent);
        assert!(of_perf.contains("perf_event_paranoid to 0"), "{of_perf}");
    }

    #[test]
    fn a_meter_that_ends_gives_no_wrong_energy() {
        let sysfs = tempfile::tempdir().unwrap();
        write_zone(sysfs.path(), "intel-rapl:0", "package-0", 5);
        let mut meters = EnergyMeters::start(sysfs.path());
        fs::remove_dir_all(sysfs.path().join("class")).unwrap();
        assert_eq!((meters.lap(), meters.lap()), (None, None));
        let why_not = meters.why_not().unwrap();
        assert!(why_not.contains("intel-rapl:0/energy_uj"), "{why_not}");
    }

    /// The clock of a CPU, which all machines have, stands for a package.
    #[test]
    #[cfg(target_os = "linux")]
    fn counters_of_perf_are_found_by_their_files() {
        let sysfs = tempfile::tempdir().unwrap();
        let pmu = sysfs.path().join("bus/event_source/devices/power");
        for folder in ["events", "format"] {
            fs::create_dir_all(pmu.join(folder)).unwrap();
        }
        for (file, text) in [
            ("type", "1\n"),
            ("cpumask", "0\n"),
            ("format/event", "config:0-7\n"),
            ("events/energy-pkg", "event=0x00\n"),
            ("events/energy-pkg.scale", "1e-9\n"),
        ] {
            fs::write(pmu.join(file), text).unwrap();
        }
        let mut meters = EnergyMeters::start(sysfs.path());
        if let Some(why_not) = meters.why_not() {
            assert!(why_not.contains("perf_event_paranoid"), "{why_not}");
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
        let seconds = meters.lap().unwrap();
        assert!((0.02..60.0).contains(&seconds), "{seconds}");
    }
}
