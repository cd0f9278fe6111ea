//! The driver of NVIDIA's cards: functions of `libcuda.so.1` (CUDA Driver API, reference manual).
#![expect(unsafe_code, reason = "functions of C")]

use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::ptr::null;

use super::functions::{functions, load};
use crate::library::DeviceFault;

/// A handle of the driver, of a context, a module, a kernel, a stream or an event: the bits of a
/// pointer. All threads may use it.
pub(super) type Handle = usize;
/// An address in a device's memory.
pub(super) type Address = u64;

/// `CU_DEVICE_ATTRIBUTE_WARP_SIZE`.
pub(super) const WARP_SIZE: c_int = 10;
/// `CU_DEVICE_ATTRIBUTE_MAX_THREADS_PER_MULTIPROCESSOR`.
pub(super) const MAX_THREADS: c_int = 39;
/// `CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR` and `_MINOR`.
pub(super) const CAPABILITY: [c_int; 2] = [75, 76];

functions! {
    /// The functions of the driver. They return 0, or the number of an error.
    Driver {
        init: b"cuInit"(c_uint);
        version: b"cuDriverGetVersion"(*mut c_int);
        error_name: b"cuGetErrorName"(c_int, *mut *const c_char);
        device_count: b"cuDeviceGetCount"(*mut c_int);
        device: b"cuDeviceGet"(*mut c_int, c_int);
        device_name: b"cuDeviceGetName"(*mut c_char, c_int, c_int);
        device_bytes: b"cuDeviceTotalMem_v2"(*mut usize, c_int);
        device_attribute: b"cuDeviceGetAttribute"(*mut c_int, c_int, c_int);
        retain_context: b"cuDevicePrimaryCtxRetain"(*mut Handle, c_int);
        release_context: b"cuDevicePrimaryCtxRelease_v2"(c_int);
        set_context: b"cuCtxSetCurrent"(Handle);
        load_module: b"cuModuleLoadDataEx"(
            *mut Handle, *const c_char, c_uint, *mut c_int, *mut *mut c_void
        );
        unload_module: b"cuModuleUnload"(Handle);
        kernel: b"cuModuleGetFunction"(*mut Handle, Handle, *const c_char);
        kernel_attribute: b"cuFuncGetAttribute"(*mut c_int, c_int, Handle);
        max_groups: b"cuOccupancyMaxActiveBlocksPerMultiprocessor"(*mut c_int, Handle, c_int, usize);
        allocate: b"cuMemAlloc_v2"(*mut Address, usize);
        free: b"cuMemFree_v2"(Address);
        copy_to_device: b"cuMemcpyHtoDAsync_v2"(Address, *const u32, usize, Handle);
        copy_to_host: b"cuMemcpyDtoHAsync_v2"(*mut u32, Address, usize, Handle);
        create_stream: b"cuStreamCreate"(*mut Handle, c_uint);
        destroy_stream: b"cuStreamDestroy_v2"(Handle);
        create_event: b"cuEventCreate"(*mut Handle, c_uint);
        destroy_event: b"cuEventDestroy_v2"(Handle);
        record_event: b"cuEventRecord"(Handle, Handle);
        query_event: b"cuEventQuery"(Handle);
        milliseconds: b"cuEventElapsedTime"(*mut f32, Handle, Handle);
        launch: b"cuLaunchKernel"(
            Handle, c_uint, c_uint, c_uint, c_uint, c_uint, c_uint, c_uint, Handle,
            *mut *mut c_void, *mut *mut c_void
        );
    }
}

impl Driver {
    /// Loads the driver and starts it.
    pub(super) fn open() -> Result<Self, DeviceFault> {
        let driver = load("libcuda.so.1").and_then(Self::of);
        let driver = driver.ok_or(DeviceFault::Missing("libcuda.so.1"))?;
        // SAFETY: this is the first call of the driver.
        driver.check(unsafe { (driver.init)(0) })?;
        Ok(driver)
    }

    /// Returns the version of CUDA up to which the driver goes, as "13.0".
    pub(super) fn version(&self) -> Result<String, DeviceFault> {
        // SAFETY: the call writes one number.
        let number = self.get(|number| unsafe { (self.version)(number) })?;
        Ok(format!("{}.{}", number / 1000, number % 1000 / 10))
    }

    /// Returns the numbers of all devices.
    pub(super) fn devices(&self) -> Result<Vec<c_int>, DeviceFault> {
        // SAFETY: the call writes one number.
        let n = self.get(|n| unsafe { (self.device_count)(n) })?;
        // SAFETY: as above.
        let device = |i| self.get(|device| unsafe { (self.device)(device, i) });
        (0..n).map(device).collect()
    }

    /// Returns the name of a device.
    pub(super) fn device_name(&self, device: c_int) -> Result<String, DeviceFault> {
        let mut name = [0_u8; 256];
        let n = name.len() as c_int;
        // SAFETY: the call writes at most `n` bytes.
        self.check(unsafe { (self.device_name)(name.as_mut_ptr().cast(), n, device) })?;
        let name = CStr::from_bytes_until_nul(&name).unwrap_or_default();
        Ok(name.to_string_lossy().trim().to_owned())
    }

    /// Returns the bytes of a device's memory.
    pub(super) fn device_bytes(&self, device: c_int) -> Result<usize, DeviceFault> {
        // SAFETY: the call writes one number.
        self.get(|n| unsafe { (self.device_bytes)(n, device) })
    }

    /// Returns an attribute of a device.
    pub(super) fn device_attribute(
        &self,
        attribute: c_int,
        device: c_int,
    ) -> Result<c_int, DeviceFault> {
        // SAFETY: the call writes one number.
        self.get(|value| unsafe { (self.device_attribute)(value, attribute, device) })
    }

    /// Returns what a call writes.
    pub(super) fn get<T: Default>(
        &self,
        call: impl FnOnce(*mut T) -> c_int,
    ) -> Result<T, DeviceFault> {
        let mut value = T::default();
        self.check(call(&mut value))?;
        Ok(value)
    }

    /// Returns the error with this number by its name; none for 0.
    pub(super) fn check(&self, code: c_int) -> Result<(), DeviceFault> {
        if code == 0 {
            return Ok(());
        }
        let mut name = null();
        // SAFETY: the name is a text that stays, and null if the driver does not know the number.
        let name = unsafe {
            (self.error_name)(code, &mut name);
            (!name.is_null()).then(|| CStr::from_ptr(name).to_string_lossy())
        };
        let name = name.map_or_else(|| format!("CUDA's error {code}"), Into::into);
        Err(DeviceFault::Call(name))
    }
}
