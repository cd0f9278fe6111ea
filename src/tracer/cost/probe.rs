//! Probes: receivers of the counters of traced rays.

use super::{Cost, Counters, DeviceLaunch, FollowedPath, RayKind, Traversals};

/// Receives the counters of one pixel. Kernels count in local variables and report once per ray.
pub trait Probe {
    /// True if the probe uses the counts; otherwise the kernel compiles without counters.
    const COUNTS: bool;
    /// Records that a ray starts.
    fn ray(&mut self, kind: RayKind);
    /// Records that the traversal of a ray has ended, with these numbers of node visits and
    /// primitive tests.
    fn traversal(&mut self, node_visits: u32, primitive_tests: u32);
    /// Records that a path has reached this number of bounces.
    fn bounce(&mut self, depth: u32);
}

/// A probe that ignores everything and costs nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProbe;

impl Probe for NoProbe {
    const COUNTS: bool = false;

    #[inline(always)]
    fn ray(&mut self, _: RayKind) {}
    #[inline(always)]
    fn traversal(&mut self, _: u32, _: u32) {}
    #[inline(always)]
    fn bounce(&mut self, _: u32) {}
}

impl Probe for Cost {
    const COUNTS: bool = true;

    #[inline]
    fn ray(&mut self, kind: RayKind) {
        self.rays[kind as usize] += 1;
    }

    #[inline]
    fn traversal(&mut self, node_visits: u32, primitive_tests: u32) {
        self.node_visits += u64::from(node_visits);
        self.primitive_tests += u64::from(primitive_tests);
    }

    #[inline]
    fn bounce(&mut self, depth: u32) {
        self.depth = self.depth.max(depth.into());
    }
}

/// Receives the counters of rays that are traced many at a time.
pub trait StreamProbe {
    /// True if [`traversals`](Self::traversals) has to be called.
    const COUNTS: bool;
    /// Records that the traversals of the rays from index `first` on have ended.
    fn traversals<const N: usize>(&mut self, first: usize, traversals: &Traversals<N>);
    /// Records that the traversal of one ray has ended, if it has to.
    #[inline(always)]
    fn traversal(&mut self, ray: usize, n_visits: u32, n_tests: u32) {
        if Self::COUNTS {
            let traversal = Traversals {
                node_visits: &[n_visits],
                primitive_tests: &[n_tests],
                active: 1,
            };
            self.traversals(ray, &traversal);
        }
    }
    /// Records that the rays were traced by a launch on a device.
    #[inline(always)]
    fn launched(&mut self, _: DeviceLaunch) {}
}

impl StreamProbe for NoProbe {
    const COUNTS: bool = false;

    #[inline(always)]
    fn traversals<const N: usize>(&mut self, _: usize, _: &Traversals<N>) {}
}

/// Receives the counters of many pixels, numbered from 0.
pub trait PixelProbe: Default {
    /// True if the probe uses the counts; otherwise the kernel compiles without counters.
    const COUNTS: bool;
    /// Resets all counters for `n_pixels` pixels with `n_samples` camera rays each; 0 if camera
    /// rays will be counted.
    fn reset(&mut self, n_pixels: usize, n_samples: u32);
    /// Records that `n` camera rays, if they are counted, start for a pixel.
    fn camera_rays(&mut self, pixel: usize, n: usize);
    /// Records that the traversal of one ray of each of these pixels has ended.
    fn traversals<const N: usize>(&mut self, pixels: &[u32; N], traversals: &Traversals<N>);
    /// Records that a ray of this kind, which is not a camera ray, starts for each of these pixels.
    fn rays_of_pixels(&mut self, kind: RayKind, pixels: &[u32]);
    /// Records that a path of each of these pixels has reached this number of bounces.
    fn bounce(&mut self, pixels: &[u32], depth: u32);
    /// Records the cost of a path that a device has followed.
    fn path(&mut self, _pixel: usize, _path: &FollowedPath) {}
    /// Records that the last rays were traced by a launch on a device.
    #[inline(always)]
    fn launched(&mut self, _: DeviceLaunch) {}
    /// Returns the nanoseconds of the launches since the last call.
    #[inline(always)]
    fn take_device_ns(&mut self) -> f64 {
        0.0
    }
    /// Returns the counters, if it counts.
    fn counted(&self) -> Option<&Counters>;
}

impl PixelProbe for NoProbe {
    const COUNTS: bool = false;

    fn reset(&mut self, _: usize, _: u32) {}
    #[inline(always)]
    fn camera_rays(&mut self, _: usize, _: usize) {}
    #[inline(always)]
    fn traversals<const N: usize>(&mut self, _: &[u32; N], _: &Traversals<N>) {}
    #[inline(always)]
    fn rays_of_pixels(&mut self, _: RayKind, _: &[u32]) {}
    #[inline(always)]
    fn bounce(&mut self, _: &[u32], _: u32) {}

    fn counted(&self) -> Option<&Counters> {
        None
    }
}

impl PixelProbe for Counters {
    const COUNTS: bool = true;

    fn reset(&mut self, n_pixels: usize, n_samples: u32) {
        self.reset(n_pixels, n_samples);
    }

    fn camera_rays(&mut self, pixel: usize, n: usize) {
        self.add_camera_rays(pixel, n as u64);
    }

    #[inline(always)]
    fn traversals<const N: usize>(&mut self, pixels: &[u32; N], traversals: &Traversals<N>) {
        self.add_traversals(pixels, traversals);
    }

    fn rays_of_pixels(&mut self, kind: RayKind, pixels: &[u32]) {
        self.add_rays_of_pixels(kind, pixels);
    }

    fn bounce(&mut self, pixels: &[u32], depth: u32) {
        self.bounce(pixels, depth.into());
    }

    fn path(&mut self, pixel: usize, path: &FollowedPath) {
        self.add_path(pixel, &path.cost);
    }

    fn launched(&mut self, launch: DeviceLaunch) {
        self.device_ns += launch.ns;
    }

    #[inline(always)]
    fn take_device_ns(&mut self) -> f64 {
        std::mem::take(&mut self.device_ns)
    }

    fn counted(&self) -> Option<&Counters> {
        Some(self)
    }
}

/// Attributes the counters of a stream's rays to their pixels.
#[derive(Debug)]
pub struct ByPixel<'a, P> {
    probe: &'a mut P,
    pixels: &'a [u32],
}

impl<'a, P: PixelProbe> ByPixel<'a, P> {
    /// Attributes the counters of ray `i` to `pixels[i]`.
    pub fn new(probe: &'a mut P, pixels: &'a [u32]) -> Self {
        Self { probe, pixels }
    }

    /// Returns the pixel of ray `i`.
    pub fn pixel(&self, i: usize) -> u32 {
        self.pixels[i]
    }

    /// Attributes the counters of other rays to these pixels.
    pub(crate) fn with_pixels<'b>(&'b mut self, pixels: &'b [u32]) -> ByPixel<'b, P> {
        ByPixel::new(self.probe, pixels)
    }
}

impl<P: PixelProbe> StreamProbe for ByPixel<'_, P> {
    const COUNTS: bool = P::COUNTS;

    #[inline(always)]
    fn traversals<const N: usize>(&mut self, first: usize, traversals: &Traversals<N>) {
        if P::COUNTS {
            let pixels = self.pixels[first..].first_chunk();
            self.probe
                .traversals(pixels.expect("one pixel per ray"), traversals);
        }
    }

    #[inline(always)]
    fn launched(&mut self, launch: DeviceLaunch) {
        self.probe.launched(launch);
    }
}
