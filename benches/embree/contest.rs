//! All kernels of raycost and Embree on the same rays.

use std::fmt;

use crate::device::{Mode, Scene};
use crate::kernel::{BareStream, CountingStream, Kernel, Single};
use crate::race::{Course, median};
use crate::rays::{Kind, Rays};
use crate::report::{Discipline, Outcome};
use crate::tinybvh::Tree;
use crate::trace::{Packets, Singles};
use tracer::accel::Accel;

/// The way in which Embree traces rays.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// One ray at a time.
    Single,
    /// One ray at a time, in a robust scene.
    Robust,
    /// 16 rays at a time.
    Packets,
}

/// A kernel of Embree.
pub struct Rival<'a> {
    isa: &'static str,
    way: Way,
    pub kernel: Box<dyn Kernel + 'a>,
}

impl fmt::Display for Rival<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let way = match self.way {
            Way::Single => "",
            Way::Robust => ", robust",
            Way::Packets => ", packets of 16",
        };
        write!(f, "{}{way}", self.isa)
    }
}

/// Returns the kernels that Embree has for these scenes and this kind of rays.
pub fn rivals<'a>(scenes: &'a [(&'static str, Scene)], kind: Kind) -> Vec<Rival<'a>> {
    let mut rivals = Vec::new();
    for (isa, scene) in scenes {
        let way = match scene.mode {
            Mode::Fast => Way::Single,
            Mode::Robust => Way::Robust,
        };
        rivals.push(Rival {
            isa,
            way,
            kernel: Box::new(Singles(scene)),
        });
        if way == Way::Single && scene.has_packets_of_16() {
            let is_coherent = matches!(kind, Kind::Primary | Kind::Shadow);
            rivals.push(Rival {
                isa,
                way: Way::Packets,
                kernel: Box::new(Packets { scene, is_coherent }),
            });
        }
    }
    rivals
}

/// Runs all kernels in turn: single rays against single rays, batches against single rays, in both
/// of Embree's modes, and batches against packets.
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

    let fastest_of = |way: Way| {
        let all = rivals.iter().zip(theirs);
        let some = all.filter(|(rival, _)| rival.way == way);
        fastest(some.map(|(rival, times)| (rival.isa, times.as_slice())))
    };
    let outcome = |discipline, ours, bare, rival: Option<(&'static str, &[f64])>| {
        rival.map(|(isa, theirs)| Outcome {
            counters_cost: Some(median(ours) / median(bare) - 1.0),
            ..Outcome::new(discipline, rays.len(), ours, theirs, isa)
        })
    };
    let stream = |discipline: fn(Kind) -> Discipline, way| {
        let rival = fastest_of(way);
        outcome(discipline(kind), counting_stream, bare_stream, rival)
    };
    let singles = fastest_of(Way::Single);
    [
        outcome(Discipline::Single(kind), counting, bare, singles),
        stream(Discipline::Stream, Way::Single),
        stream(Discipline::StreamAgainstRobust, Way::Robust),
        stream(Discipline::StreamAgainstPackets, Way::Packets),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Runs single rays of raycost and of tinybvh in turn.
pub fn against_tinybvh(
    course: Course,
    accel: &Accel,
    tree: &Tree,
    kind: Kind,
    rays: &Rays,
) -> Outcome {
    let (bare, counting) = (Single::bare(accel), Single::counting(accel));
    let times = course.times(&[&bare, &counting, tree], rays);
    let discipline = Discipline::SingleAgainstTinyBvh(kind);
    Outcome {
        counters_cost: Some(median(&times[1]) / median(&times[0]) - 1.0),
        ..Outcome::new(discipline, rays.len(), &times[1], &times[2], "BVH8_CPU")
    }
}

/// Returns the kernel with the smallest median.
pub fn fastest<'a>(
    times: impl Iterator<Item = (&'static str, &'a [f64])>,
) -> Option<(&'static str, &'a [f64])> {
    times.min_by(|a, b| median(a.1).total_cmp(&median(b.1)))
}
