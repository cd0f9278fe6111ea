//! A safe interface to Embree: the library, its devices and its scenes.

#![expect(unsafe_code, reason = "a C library has no other way in")]

use std::collections::HashMap;
use std::ffi::{CString, c_int, c_void};
use std::ptr;

use crate::ffi::{
    self, Arguments, Context, Functions, Handle, Quality, Ray1, Ray16, RayHit1, RayHit16, Valid16,
};
use world::geometry::Shape;
use world::scene::Primitive;

/// A mesh or a cloud of spheres in Embree's layout.
pub struct Geometry {
    /// x, y, z and, for a sphere, its radius. Four floats, since Embree reads 16 bytes even where
    /// it needs 12.
    vertices: Vec<[f32; 4]>,
    /// The vertices of each triangle; empty for spheres.
    triangles: Vec<[u32; 3]>,
}

impl Geometry {
    /// Converts the same primitives in the same order: either triangles, with shared vertices, or
    /// spheres.
    pub fn of(primitives: &[Primitive]) -> Self {
        let mut geometry = Self {
            vertices: Vec::new(),
            triangles: Vec::new(),
        };
        let mut known = HashMap::new();
        for primitive in primitives {
            match primitive.world_shape() {
                Some(Shape::Triangle(triangle)) => {
                    let corners = triangle.vertices.map(|corner| {
                        *known
                            .entry(corner.to_array().map(f32::to_bits))
                            .or_insert_with(|| {
                                geometry.vertices.push(corner.extend(0.0).to_array());
                                geometry.vertices.len() as u32 - 1
                            })
                    });
                    geometry.triangles.push(corners);
                }
                Some(Shape::Sphere(sphere)) => {
                    let vertex = sphere.center.extend(sphere.radius);
                    geometry.vertices.push(vertex.to_array());
                }
                other => unreachable!("the scenes are made of triangles or spheres: {other:?}"),
            }
        }
        geometry
    }
}

/// Embree's modes of intersection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Rays may pass between neighboring triangles.
    Fast,
    /// Watertight up to rare cases.
    Robust,
}

/// Embree with an instruction set and a number of threads.
pub struct Device {
    embree: &'static Functions,
    handle: Handle,
    /// The major version: 3 or 4.
    major: isize,
}

impl Device {
    /// Creates a device with this `isa`, `avx2` or `avx512`, that builds with `n_threads` threads.
    /// Devices that live at the same time all build with the largest number of threads of any of
    /// them.
    ///
    /// # Errors
    /// Embree's error code, if it has no such device for this CPU.
    pub fn new(embree: &'static Functions, isa: &str, n_threads: usize) -> Result<Self, String> {
        let configuration = format!("isa={isa},threads={n_threads}");
        let text = CString::new(configuration.clone()).map_err(|error| error.to_string())?;
        // SAFETY: `text` is a C string that outlives the call.
        let handle = unsafe { (embree.new_device)(text.as_ptr()) };
        let mut device = Self {
            embree,
            handle,
            major: 0,
        };
        match (handle.is_null(), device.error()) {
            (false, 0) => {
                device.major = device.property(ffi::VERSION_MAJOR);
                Ok(device)
            }
            (_, code) => Err(format!("no Embree device `{configuration}`: error {code}")),
        }
    }

    /// Returns Embree's version.
    pub fn version(&self) -> String {
        let [minor, patch] = [ffi::VERSION_MINOR, ffi::VERSION_PATCH].map(|p| self.property(p));
        format!("{}.{minor}.{patch}", self.major)
    }

    /// Builds a scene of this geometry.
    ///
    /// # Errors
    /// Embree's error code.
    pub fn scene<'a>(
        &'a self,
        geometry: &'a Geometry,
        quality: Quality,
        mode: Mode,
    ) -> Result<Scene<'a>, String> {
        let Functions {
            new_scene,
            set_scene_flags,
            set_scene_quality,
            commit_scene,
            ..
        } = *self.embree;
        // SAFETY: the handles belong to this device; the geometry outlives the scene, which
        // releases its handle when it is dropped.
        let handle = unsafe {
            let scene = new_scene(self.handle);
            set_scene_quality(scene, quality);
            if mode == Mode::Robust {
                set_scene_flags(scene, ffi::ROBUST);
            }
            self.attach(scene, geometry, quality);
            commit_scene(scene);
            scene
        };
        let scene = Scene {
            device: self,
            handle,
            mode,
            _geometry: geometry,
        };
        match self.error() {
            0 => Ok(scene),
            code => Err(format!("Embree cannot build the scene: error {code}")),
        }
    }

    /// # Safety
    /// The scene belongs to this device, and the geometry outlives it.
    unsafe fn attach(&self, scene: Handle, geometry: &Geometry, quality: Quality) {
        let embree = self.embree;
        let (kind, format) = if geometry.triangles.is_empty() {
            (ffi::SPHERES, ffi::FLOAT4)
        } else {
            (ffi::TRIANGLES, ffi::FLOAT3)
        };
        let (vertices, triangles) = (&geometry.vertices, &geometry.triangles);
        // SAFETY: the caller's promise; offsets, strides and counts match the vectors.
        unsafe {
            let handle = (embree.new_geometry)(self.handle, kind);
            let share = |buffer, format, data, stride, n| {
                (embree.set_shared_buffer)(handle, buffer, 0, format, data, 0, stride, n);
            };
            share(
                ffi::VERTICES,
                format,
                vertices.as_ptr().cast(),
                16,
                vertices.len(),
            );
            if kind == ffi::TRIANGLES {
                share(
                    ffi::INDICES,
                    ffi::UINT3,
                    triangles.as_ptr().cast(),
                    12,
                    triangles.len(),
                );
            }
            (embree.set_geometry_quality)(handle, quality);
            (embree.commit_geometry)(handle);
            (embree.attach_geometry)(scene, handle);
            (embree.release_geometry)(handle);
        }
    }

    fn property(&self, property: c_int) -> isize {
        // SAFETY: the handle is a device.
        unsafe { (self.embree.device_property)(self.handle, property) }
    }

    /// Returns the code of the last error, 0 for none; without a device, the code of the last
    /// failed creation.
    fn error(&self) -> c_int {
        // SAFETY: the handle is a device, or null, which Embree allows.
        unsafe { (self.embree.device_error)(self.handle) }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: the handle is a device, and nothing uses it afterwards.
            unsafe { (self.embree.release_device)(self.handle) }
        }
    }
}

/// A built scene.
pub struct Scene<'a> {
    device: &'a Device,
    handle: Handle,
    /// The mode in which its rays are intersected.
    pub mode: Mode,
    _geometry: &'a Geometry,
}

// SAFETY: Embree's scenes may be traced from many threads at once, once built.
unsafe impl Sync for Scene<'_> {}

impl Scene<'_> {
    /// Intersects a ray.
    #[inline]
    pub fn intersect1(&self, ray: &mut RayHit1) {
        let intersect = self.device.embree.intersect1;
        // SAFETY: the scene is built, and the pointers are to the ray and the arguments.
        self.query(ray, false, |a, b| unsafe { intersect(self.handle, a, b) });
    }

    /// Tests a ray for occlusion.
    #[inline]
    pub fn occluded1(&self, ray: &mut Ray1) {
        let occlude = self.device.embree.occluded1;
        // SAFETY: as above.
        self.query(ray, false, |a, b| unsafe { occlude(self.handle, a, b) });
    }

    /// Intersects the valid ones of 16 rays. The device has packets of 16.
    #[inline]
    pub fn intersect16(&self, valid: &Valid16, is_coherent: bool, rays: &mut RayHit16) {
        let intersect = self.device.embree.intersect16;
        // SAFETY: as above.
        let call = |a, b| unsafe { intersect(valid, self.handle, a, b) };
        self.query(rays, is_coherent, call);
    }

    /// Tests the valid ones of 16 rays for occlusion. The device has packets of 16.
    #[inline]
    pub fn occluded16(&self, valid: &Valid16, is_coherent: bool, rays: &mut Ray16) {
        let occlude = self.device.embree.occluded16;
        // SAFETY: as above.
        let call = |a, b| unsafe { occlude(valid, self.handle, a, b) };
        self.query(rays, is_coherent, call);
    }

    /// Calls `query` with pointers to the context and the rays for Embree 3, and to the rays and
    /// the arguments for Embree 4.
    #[inline]
    fn query<R>(
        &self,
        rays: &mut R,
        is_coherent: bool,
        query: impl FnOnce(*mut c_void, *mut c_void),
    ) {
        let rays = (&raw mut *rays).cast();
        if self.device.major == 3 {
            let mut context = Context {
                flags: is_coherent.into(),
                filter: ptr::null(),
                instance: ffi::INVALID_ID,
            };
            query((&raw mut context).cast(), rays);
        } else {
            let mut arguments = Arguments {
                flags: u32::from(is_coherent) * Arguments::COHERENT,
                features: u32::MAX,
                callbacks: [ptr::null(); 3],
            };
            query(rays, (&raw mut arguments).cast());
        }
    }

    /// Returns true if packets of 16 rays can be traced through the scene.
    pub fn has_packets_of_16(&self) -> bool {
        self.device.property(ffi::NATIVE_RAY16) != 0
    }
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle is a scene, and nothing uses it afterwards.
        unsafe { (self.device.embree.release_scene)(self.handle) }
    }
}
