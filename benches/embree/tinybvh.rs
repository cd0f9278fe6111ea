//! tinybvh's kernel for single rays, compiled from its header.

#![expect(unsafe_code, reason = "a C++ library has no other way in")]

use std::ffi::c_void;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::ptr::NonNull;

use libloading::Library;

use crate::ffi::Quality;
use crate::kernel::Kernel;
use tracer::accel::{Hit, ShadowStream};
use world::geometry::{Ray, RayStream, Shape};
use world::scene::Primitive;

/// Distance of a miss, `BVH_FAR`.
const FAR: f32 = 1e30;

/// The functions of `tinybvh.cpp`.
pub struct TinyBvh {
    version: unsafe extern "C" fn(*mut [u32; 3]),
    build: unsafe extern "C" fn(*const [f32; 4], u32, bool) -> *mut c_void,
    release: unsafe extern "C" fn(*mut c_void),
    nearest: unsafe extern "C" fn(*const c_void, *const [f32; 6], *mut u32) -> f32,
    any: unsafe extern "C" fn(*const c_void, *const [f32; 6], f32) -> bool,
    /// Keeps the functions in memory.
    _library: Library,
}

impl TinyBvh {
    /// Compiles `tiny_bvh.h` of a folder for this CPU, as fast as its makers advise, and loads it.
    ///
    /// # Errors
    /// If there is no C++ compiler (`$CXX`, or `c++`), or it reports an error.
    pub fn load(folder: &Path) -> Result<Self, String> {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/embree/tinybvh.cpp");
        let library = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("libtinybvh.so");
        let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".into());
        let status = Command::new(&compiler)
            .args([
                "-O3",
                "-march=native",
                "-ffast-math",
                "-shared",
                "-fPIC",
                "-I",
            ])
            .args([folder, &source, "-o".as_ref(), &library])
            .status()
            .map_err(|error| format!("cannot run {compiler}: {error}"))?;
        if !status.success() {
            return Err(format!(
                "cannot compile tinybvh; is tiny_bvh.h in {}?",
                folder.display()
            ));
        }
        // SAFETY: the types are those of `tinybvh.cpp`, whose initializers require nothing.
        let load = || unsafe {
            let library = Library::new(&library)?;
            Ok(Self {
                version: *library.get("tinybvh_version")?,
                build: *library.get("tinybvh_build")?,
                release: *library.get("tinybvh_release")?,
                nearest: *library.get("tinybvh_nearest")?,
                any: *library.get("tinybvh_any")?,
                _library: library,
            })
        };
        load().map_err(|error: libloading::Error| error.to_string())
    }

    /// Returns tinybvh's version.
    pub fn version(&self) -> String {
        let mut version = [0; 3];
        // SAFETY: the function writes three numbers.
        unsafe { (self.version)(&mut version) };
        version.map(|number| number.to_string()).join(".")
    }
}

/// tinybvh's `BVH8_CPU`, which is not watertight.
pub struct Tree<'a> {
    tinybvh: &'a TinyBvh,
    handle: NonNull<c_void>,
    /// The corners of the triangles, to which the hierarchy refers.
    _corners: Vec<[f32; 4]>,
}

// SAFETY: a built hierarchy is only read.
unsafe impl Sync for Tree<'_> {}

impl<'a> Tree<'a> {
    /// Builds the hierarchy of triangles; `None` for other primitives.
    pub fn build(tinybvh: &'a TinyBvh, primitives: &[Primitive], quality: Quality) -> Option<Self> {
        let mut corners = Vec::with_capacity(3 * primitives.len());
        for primitive in primitives {
            let Some(Shape::Triangle(triangle)) = primitive.world_shape() else {
                return None;
            };
            corners.extend(
                triangle
                    .vertices
                    .map(|corner| corner.extend(0.0).to_array()),
            );
        }
        let is_high = quality == Quality::High;
        // SAFETY: the corners are three per triangle, and live as long as the hierarchy.
        let handle = unsafe { (tinybvh.build)(corners.as_ptr(), primitives.len() as u32, is_high) };
        Some(Self {
            tinybvh,
            handle: NonNull::new(handle)?,
            _corners: corners,
        })
    }
}

impl Drop for Tree<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle is a hierarchy, and nothing uses it afterwards.
        unsafe { (self.tinybvh.release)(self.handle.as_ptr()) };
    }
}

impl Kernel for Tree<'_> {
    fn nearest(&self, rays: &RayStream, hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(rays.iter().map(|ray| {
            let mut primitive = 0;
            // SAFETY: the hierarchy is built, and all pointers are to values of this function.
            let t = unsafe {
                (self.tinybvh.nearest)(self.handle.as_ptr(), &numbers(&ray), &mut primitive)
            };
            (t < FAR).then_some(Hit {
                t,
                primitive,
                instance: None,
            })
        }));
    }

    fn any(&self, rays: &ShadowStream, occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.extend(rays.iter().map(|shadow| {
            // SAFETY: as above.
            unsafe { (self.tinybvh.any)(self.handle.as_ptr(), &numbers(&shadow.ray), shadow.t_max) }
        }));
    }
}

/// Returns the numbers of a ray: its origin, then its direction.
#[inline]
fn numbers(ray: &Ray) -> [f32; 6] {
    let (o, d) = (ray.origin, ray.direction);
    [o.x, o.y, o.z, d.x, d.y, d.z]
}
