//! All kernels of raycost and Embree on the same rays.

use std::fmt;

use raycost::accel::Accel;

use crate::device::Scene;
use crate::kernel::{BareStream, CountingStream, Kernel, Single};
use crate::race::{Course, median};
use crate::rays::{Kind, Rays};
use crate::report::{Discipline, Outcome};
use crate::trace::{Packets, Singles};

/// A kernel of Embree.
pub struct Rival<'a> {
    isa: &'static str,
    takes_packets: bool,
    pub kernel: Box<dyn Kernel + 'a>,
}

impl fmt::Display for Rival<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let packets = if self.takes_packets {
            ", packets of 16"
        } else {
            ""
        };
        write!(f, "{}{packets}", self.isa)
    }
}

/// The kernels that Embree has for these scenes and this kind of rays.
pub fn rivals<'a>(scenes: &'a [(&'static str, Scene)], kind: Kind) -> Vec<Rival<'a>> {
    let mut rivals = Vec::new();
    for (isa, scene) in scenes {
        rivals.push(Rival {
            isa,
            takes_packets: false,
            kernel: Box::new(Singles(scene)),
        });
        if scene.has_packets_of_16() {
            let is_coherent = matches!(kind, Kind::Primary | Kind::Shadow);
            rivals.push(Rival {
                isa,
                takes_packets: true,
                kernel: Box::new(Packets { scene, is_coherent }),
            });
        }
    }
    rivals
}

/// Runs all kernels in turn: single rays against single rays, batches against
/// single rays, and batches against packets.
pub fn outcomes(
    course: Course,
    accel: &Accel,
    rivals: &[Rival],
    kind: Kind,
    rays: &Rays,
) -> Vec<Outcome> {
    let (bare, counting) = (Single::bare(accel), Single::counting(accel));
    let (bare_stream, counting_stream) = (BareStream(accel), CountingStream(accel));
    let mut kernels: Vec<&dyn Kernel> = vec![&bare, &counting, &bare_stream, &counting_stream];
    kernels.extend(rivals.iter().map(|rival| rival.kernel.as_ref()));
    let times = course.times(&kernels, rays);
    let [bare, counting, bare_stream, counting_stream] = [0, 1, 2, 3].map(|i| times[i].as_slice());
    let theirs = &times[4..];

    let fastest_of = |packets: bool| {
        let all = rivals.iter().zip(theirs);
        let some = all.filter(|(rival, _)| rival.takes_packets == packets);
        fastest(some.map(|(rival, times)| (rival.isa, times.as_slice())))
    };
    let outcome = |discipline, ours, bare, embree: Option<(&'static str, &[f64])>| {
        embree.map(|(isa, theirs)| Outcome {
            counters_cost: Some(median(ours) / median(bare) - 1.0),
            ..Outcome::new(discipline, rays.len(), ours, theirs, isa)
        })
    };
    let (singles, packets) = (fastest_of(false), fastest_of(true));
    let against_packets = Discipline::StreamAgainstPackets(kind);
    [
        outcome(Discipline::Single(kind), counting, bare, singles),
        outcome(
            Discipline::Stream(kind),
            counting_stream,
            bare_stream,
            singles,
        ),
        outcome(against_packets, counting_stream, bare_stream, packets),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The kernel with the smallest median.
pub fn fastest<'a>(
    times: impl Iterator<Item = (&'static str, &'a [f64])>,
) -> Option<(&'static str, &'a [f64])> {
    times.min_by(|a, b| median(a.1).total_cmp(&median(b.1)))
}
