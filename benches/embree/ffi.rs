//! The part of the C APIs of Embree 3 and 4 that the race needs, loaded at run time: names, values
//! and layouts follow the headers `rtcore_*.h` of versions 3.13 and 4.4.

#![expect(unsafe_code, reason = "a C library has no other way in")]

use std::ffi::{OsStr, c_char, c_int, c_void};

use libloading::Library;

/// `RTC_INVALID_GEOMETRY_ID`.
pub const INVALID_ID: u32 = u32::MAX;
/// `RTC_GEOMETRY_TYPE_TRIANGLE`.
pub const TRIANGLES: c_int = 0;
/// `RTC_GEOMETRY_TYPE_SPHERE_POINT`.
pub const SPHERES: c_int = 50;
/// `RTC_BUFFER_TYPE_INDEX`.
pub const INDICES: c_int = 0;
/// `RTC_BUFFER_TYPE_VERTEX`.
pub const VERTICES: c_int = 1;
/// `RTC_FORMAT_UINT3`.
pub const UINT3: c_int = 0x5003;
/// `RTC_FORMAT_FLOAT3`.
pub const FLOAT3: c_int = 0x9003;
/// `RTC_FORMAT_FLOAT4`.
pub const FLOAT4: c_int = 0x9004;
/// `RTC_SCENE_FLAG_ROBUST`.
pub const ROBUST: c_int = 4;
/// `RTC_DEVICE_PROPERTY_VERSION_MAJOR`.
pub const VERSION_MAJOR: c_int = 1;
/// `RTC_DEVICE_PROPERTY_VERSION_MINOR`.
pub const VERSION_MINOR: c_int = 2;
/// `RTC_DEVICE_PROPERTY_VERSION_PATCH`.
pub const VERSION_PATCH: c_int = 3;
/// `RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED`.
pub const NATIVE_RAY16: c_int = 34;

/// `RTCBuildQuality`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub enum Quality {
    /// Embree's default: binned SAH.
    Medium = 1,
    /// With spatial splits.
    High = 2,
}

/// `RTCDevice`, `RTCScene` and `RTCGeometry`.
pub type Handle = *mut c_void;

/// `RTCIntersectContext` of Embree 3.
#[repr(C)]
pub struct Context {
    /// 0 for incoherent rays, 1 for coherent ones.
    pub flags: u32,
    /// A filter function, here always null.
    pub filter: *const c_void,
    /// The instance that the rays are in, here always [`INVALID_ID`].
    pub instance: u32,
}

/// `RTCIntersectArguments` and `RTCOccludedArguments` of Embree 4.
#[repr(C)]
pub struct Arguments {
    /// 0 for incoherent rays, [`COHERENT`](Self::COHERENT) for coherent ones.
    pub flags: u32,
    /// `RTC_FEATURE_FLAG_ALL`.
    pub features: u32,
    /// The context, a filter and an intersection function, here always null.
    pub callbacks: [*const c_void; 3],
}

impl Arguments {
    /// `RTC_RAY_QUERY_FLAG_COHERENT`.
    pub const COHERENT: u32 = 1 << 16;
}

/// `RTCRay`, one ray; `RTCRay16`, lane by lane.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct RayFields<F, U> {
    pub origin: [F; 3],
    pub t_near: F,
    pub direction: [F; 3],
    pub time: F,
    /// Set to the hit's distance, or to negative infinity if the ray is occluded.
    pub t_far: F,
    pub mask: U,
    pub id: U,
    pub flags: U,
}

/// `RTCHit` and `RTCHit16`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct HitFields<F, U> {
    pub normal: [F; 3],
    pub uv: [F; 2],
    pub primitive: U,
    /// [`INVALID_ID`] for a miss.
    pub geometry: U,
    pub instance: U,
    /// Embree 4 alone reads and writes it.
    pub instance_primitive: U,
}

/// `RTCRay`.
#[repr(C, align(16))]
pub struct Ray1(pub RayFields<f32, u32>);

/// `RTCRayHit`.
#[repr(C, align(16))]
pub struct RayHit1 {
    pub ray: RayFields<f32, u32>,
    pub hit: HitFields<f32, u32>,
}

/// `RTCRay16`.
#[repr(C, align(64))]
pub struct Ray16(pub RayFields<[f32; 16], [u32; 16]>);

/// `RTCRayHit16`.
#[repr(C, align(64))]
pub struct RayHit16 {
    pub ray: RayFields<[f32; 16], [u32; 16]>,
    pub hit: HitFields<[f32; 16], [u32; 16]>,
}

/// The lanes of 16 that hold a ray: -1, the others 0.
#[repr(C, align(64))]
pub struct Valid16(pub [c_int; 16]);

/// Declares the table of functions and its loader.
macro_rules! functions {
    ($($field:ident = $symbol:literal ($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// Embree's functions.
        pub struct Functions {
            $(pub $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
            /// Keeps the functions in memory.
            _library: Library,
        }

        impl Functions {
            /// Loads the library of this name or path.
            ///
            /// # Errors
            /// If it is not installed, or a function is missing.
            pub fn load(name: &OsStr) -> Result<Self, libloading::Error> {
                // SAFETY: Embree's initializers require nothing of the program, and the types below
                // match its headers.
                unsafe {
                    let library = Library::new(name)?;
                    Ok(Self {
                        $($field: *library.get($symbol)?,)*
                        _library: library,
                    })
                }
            }
        }
    };
}

functions! {
    new_device = "rtcNewDevice" (*const c_char) -> Handle;
    release_device = "rtcReleaseDevice" (Handle);
    device_property = "rtcGetDeviceProperty" (Handle, c_int) -> isize;
    device_error = "rtcGetDeviceError" (Handle) -> c_int;
    new_scene = "rtcNewScene" (Handle) -> Handle;
    release_scene = "rtcReleaseScene" (Handle);
    set_scene_flags = "rtcSetSceneFlags" (Handle, c_int);
    set_scene_quality = "rtcSetSceneBuildQuality" (Handle, Quality);
    attach_geometry = "rtcAttachGeometry" (Handle, Handle) -> u32;
    commit_scene = "rtcCommitScene" (Handle);
    new_geometry = "rtcNewGeometry" (Handle, c_int) -> Handle;
    release_geometry = "rtcReleaseGeometry" (Handle);
    commit_geometry = "rtcCommitGeometry" (Handle);
    set_geometry_quality = "rtcSetGeometryBuildQuality" (Handle, Quality);
    set_shared_buffer = "rtcSetSharedGeometryBuffer"
        (Handle, c_int, u32, c_int, *const c_void, usize, usize, usize);
    intersect1 = "rtcIntersect1" (Handle, *mut c_void, *mut c_void);
    occluded1 = "rtcOccluded1" (Handle, *mut c_void, *mut c_void);
    intersect16 = "rtcIntersect16" (*const Valid16, Handle, *mut c_void, *mut c_void);
    occluded16 = "rtcOccluded16" (*const Valid16, Handle, *mut c_void, *mut c_void);
}

// The sizes given by the headers; a `RayHit1` of Embree 3 has the first 80 bytes, a `RayHit16` the
// first 1,280.
const _: () = assert!(size_of::<Context>() == 24 && size_of::<Arguments>() == 32);
const _: () = assert!(size_of::<Ray1>() == 48 && size_of::<RayHit1>() == 96);
const _: () = assert!(size_of::<Ray16>() == 768 && size_of::<RayHit16>() == 1344);
