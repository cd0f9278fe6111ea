//! The interface of all kernels: they trace batches of rays.

use tracer::accel::{Accel, Hit, ShadowRay, ShadowStream};
use tracer::cost::{Cost, NoProbe, Probe, StreamProbe, Traversals};
use world::geometry::RayStream;

/// Traces batches of rays, on several threads at once.
pub trait Kernel: Sync {
    /// Overwrites `hits` with the nearest hit of each ray.
    fn nearest(&self, rays: &RayStream, hits: &mut Vec<Option<Hit>>);
    /// Overwrites `occluded` with true for each occluded ray.
    fn any(&self, rays: &ShadowStream, occluded: &mut Vec<bool>);
}

/// raycost, one ray at a time; it counts if the probe `P` does.
pub struct Single<'a, P> {
    accel: &'a Accel<'a>,
    probe: P,
}

impl<'a> Single<'a, Cost> {
    pub fn counting(accel: &'a Accel) -> Self {
        let probe = Cost::default();
        Self { accel, probe }
    }
}

impl<'a> Single<'a, NoProbe> {
    pub fn bare(accel: &'a Accel) -> Self {
        let probe = NoProbe;
        Self { accel, probe }
    }
}

impl<P: Probe + Copy + Sync> Kernel for Single<'_, P> {
    fn nearest(&self, rays: &RayStream, hits: &mut Vec<Option<Hit>>) {
        let mut probe = self.probe;
        hits.clear();
        hits.extend(rays.iter().map(|ray| self.accel.nearest(&ray, &mut probe)));
        std::hint::black_box(probe);
    }

    fn any(&self, rays: &ShadowStream, occluded: &mut Vec<bool>) {
        let mut probe = self.probe;
        let any = |shadow: ShadowRay| {
            self.accel
                .occluded(&shadow.ray, shadow.t_max, shadow.ignored, &mut probe)
        };
        occluded.clear();
        occluded.extend(rays.iter().map(any));
        std::hint::black_box(probe);
    }
}

/// raycost, a batch at a time, without counters.
pub struct BareStream<'a>(pub &'a Accel<'a>);

impl Kernel for BareStream<'_> {
    fn nearest(&self, rays: &RayStream, hits: &mut Vec<Option<Hit>>) {
        self.0.nearest_stream(rays, hits, &mut NoProbe);
    }

    fn any(&self, rays: &ShadowStream, occluded: &mut Vec<bool>) {
        self.0.occluded_stream(rays, occluded, &mut NoProbe);
    }
}

/// raycost, a batch at a time, with the counters of each ray.
pub struct CountingStream<'a>(pub &'a Accel<'a>);

impl Kernel for CountingStream<'_> {
    fn nearest(&self, rays: &RayStream, hits: &mut Vec<Option<Hit>>) {
        let mut counts = RayCounts::of(rays.len());
        self.0.nearest_stream(rays, hits, &mut counts);
        std::hint::black_box(counts);
    }

    fn any(&self, rays: &ShadowStream, occluded: &mut Vec<bool>) {
        let mut counts = RayCounts::of(rays.len());
        self.0.occluded_stream(rays, occluded, &mut counts);
        std::hint::black_box(counts);
    }
}

/// Node visits and primitive tests of each ray of a batch.
struct RayCounts(Vec<[u32; 2]>);

impl RayCounts {
    fn of(n_rays: usize) -> Self {
        Self(vec![[0; 2]; n_rays])
    }
}

impl StreamProbe for RayCounts {
    const COUNTS: bool = true;

    #[inline]
    fn traversals<const N: usize>(&mut self, first: usize, traversals: &Traversals<N>) {
        traversals.for_each(|i, node_visits, primitive_tests| {
            self.0[first + i] = [node_visits, primitive_tests];
        });
    }
}
