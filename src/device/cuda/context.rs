//! What lives on one of NVIDIA's cards: a context with its modules, memory and streams.
#![expect(unsafe_code, reason = "functions of C")]

use std::ffi::{CStr, CString, c_int, c_uint, c_void};
use std::ptr::null_mut;
use std::sync::Arc;

use super::driver::{Address, Driver, Handle};
use crate::library::{DeviceFault, GROUP, MAX_LAUNCH, wait};

/// `CUDA_ERROR_NOT_READY`: an event has not happened yet.
const NOT_READY: c_int = 600;
/// `CU_STREAM_NON_BLOCKING`: streams do not wait for each other.
const NON_BLOCKING: c_uint = 1;
/// `CU_JIT_ERROR_LOG_BUFFER` and `CU_JIT_ERROR_LOG_BUFFER_SIZE_BYTES`.
const ERROR_LOG: [c_int; 2] = [5, 6];
/// Bytes of the log of the driver's compiler.
const MAX_LOG: usize = 4096;
/// `CU_FUNC_ATTRIBUTE_LOCAL_SIZE_BYTES`: bytes of memory of an item beyond registers.
pub(super) const LOCAL_BYTES: c_int = 3;
/// `CU_FUNC_ATTRIBUTE_NUM_REGS`: registers of an item.
pub(super) const REGISTERS: c_int = 4;

/// The primary context of a device.
pub(super) struct Context {
    driver: Arc<Driver>,
    device: c_int,
    handle: Handle,
}

impl Context {
    pub(super) fn new(driver: &Arc<Driver>, device: c_int) -> Result<Self, DeviceFault> {
        // SAFETY: the call writes one handle.
        let handle = driver.get(|context| unsafe { (driver.retain_context)(context, device) })?;
        Ok(Self {
            driver: Arc::clone(driver),
            device,
            handle,
        })
    }

    /// Returns an attribute of the device.
    pub(super) fn attribute(&self, attribute: c_int) -> Result<usize, DeviceFault> {
        let number = self.driver.device_attribute(attribute, self.device)?;
        Ok(number as usize)
    }

    /// Returns the driver, for calls of this thread that are about this context.
    fn enter(&self) -> Result<&Driver, DeviceFault> {
        let driver = &*self.driver;
        // SAFETY: the context lives.
        driver.check(unsafe { (driver.set_context)(self.handle) })?;
        Ok(driver)
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        // SAFETY: it was retained once.
        unsafe { (self.driver.release_context)(self.device) };
    }
}

/// What a context owns, and the function that frees it.
struct Owned<T: Copy> {
    context: Arc<Context>,
    handle: T,
    free: unsafe extern "C" fn(T) -> c_int,
}

impl<T: Copy> Owned<T> {
    fn new(context: &Arc<Context>, handle: T, free: unsafe extern "C" fn(T) -> c_int) -> Self {
        Self {
            context: Arc::clone(context),
            handle,
            free,
        }
    }
}

impl<T: Copy> Drop for Owned<T> {
    fn drop(&mut self) {
        if self.context.enter().is_ok() {
            // SAFETY: it lives, and what was queued for it is done.
            unsafe { (self.free)(self.handle) };
        }
    }
}

/// A program on a device.
pub(super) struct Module(Owned<Handle>);

impl Module {
    /// Has the driver compile PTX.
    pub(super) fn new(context: &Arc<Context>, ptx: &str) -> Result<Self, DeviceFault> {
        let driver = context.enter()?;
        let ptx = CString::new(ptx).unwrap_or_default();
        let (mut log, mut handle) = ([0_u8; MAX_LOG], 0);
        let mut options = ERROR_LOG;
        let mut values = [log.as_mut_ptr().cast(), MAX_LOG as *mut c_void];
        // SAFETY: a zero ends the text; the log is as long as the second option says, whose value the
        // driver replaces by the length of what it wrote.
        let code = unsafe {
            (driver.load_module)(
                &mut handle,
                ptx.as_ptr(),
                options.len() as c_uint,
                options.as_mut_ptr(),
                values.as_mut_ptr(),
            )
        };
        driver.check(code).map_err(|fault| {
            let log = CStr::from_bytes_until_nul(&log).unwrap_or_default();
            match log.to_string_lossy().trim() {
                "" => fault,
                log => DeviceFault::of_build(log),
            }
        })?;
        Ok(Self(Owned::new(context, handle, driver.unload_module)))
    }

    /// Returns the context.
    pub(super) fn context(&self) -> &Arc<Context> {
        &self.0.context
    }

    /// Returns the handle of a kernel.
    fn kernel(&self, name: &str) -> Result<Handle, DeviceFault> {
        let driver = self.0.context.enter()?;
        let name = CString::new(name).unwrap_or_default();
        // SAFETY: a zero ends the name; the call writes one handle.
        driver.get(|kernel| unsafe { (driver.kernel)(kernel, self.0.handle, name.as_ptr()) })
    }

    /// Returns an attribute of a kernel.
    pub(super) fn attribute(&self, attribute: c_int, kernel: &str) -> Result<usize, DeviceFault> {
        let (driver, kernel) = (&self.0.context.driver, self.kernel(kernel)?);
        // SAFETY: the call writes one number.
        let n = driver.get(|n| unsafe { (driver.kernel_attribute)(n, attribute, kernel) })?;
        Ok(n as usize)
    }

    /// Returns the number of items of a kernel that a multiprocessor can hold at a time.
    pub(super) fn max_items(&self, kernel: &str) -> Result<usize, DeviceFault> {
        let (driver, kernel) = (&self.0.context.driver, self.kernel(kernel)?);
        // SAFETY: the call writes one number.
        let n = driver.get(|n| unsafe { (driver.max_groups)(n, kernel, GROUP as c_int, 0) })?;
        Ok(n as usize * GROUP)
    }
}

/// Memory of a device.
pub(super) struct CudaMemory {
    words: Owned<Address>,
    /// Number of words.
    len: usize,
}

impl CudaMemory {
    /// Allocates memory for a number of words, at least one.
    pub(super) fn new(context: &Arc<Context>, len: usize) -> Result<Self, DeviceFault> {
        let driver = context.enter()?;
        // SAFETY: the call writes one address.
        let address = driver.get(|address| unsafe { (driver.allocate)(address, 4 * len) })?;
        let words = Owned::new(context, address, driver.free);
        Ok(Self { words, len })
    }

    /// Returns memory for a number of words, the last one if it is long enough. Shorter memory stays:
    /// to free it would wait for the launches of all threads, and one may hang.
    pub(super) fn last_of<'a>(
        all: &'a mut Vec<Self>,
        context: &Arc<Context>,
        len: usize,
    ) -> Result<&'a Self, DeviceFault> {
        if all.last().is_none_or(|last| last.len < len) {
            all.push(Self::new(context, len.next_power_of_two())?);
        }
        Ok(&all[all.len() - 1])
    }
}

/// A queue of copies and launches.
pub(super) struct Stream {
    stream: Owned<Handle>,
    /// The events at the start and the end of a launch.
    events: [Owned<Handle>; 2],
}

impl Stream {
    pub(super) fn new(context: &Arc<Context>) -> Result<Self, DeviceFault> {
        let driver = context.enter()?;
        // SAFETY: the call writes one handle.
        let event = || driver.get(|event| unsafe { (driver.create_event)(event, 0) });
        let event = || event().map(|event| Owned::new(context, event, driver.destroy_event));
        // SAFETY: as above.
        let stream =
            driver.get(|stream| unsafe { (driver.create_stream)(stream, NON_BLOCKING) })?;
        Ok(Self {
            stream: Owned::new(context, stream, driver.destroy_stream),
            events: [event()?, event()?],
        })
    }

    /// Copies words to memory, which is long enough; [`wait`](Self::wait) waits for the end.
    pub(super) fn write(&self, to: &CudaMemory, words: &[u32]) -> Result<(), DeviceFault> {
        assert!(words.len() <= to.len);
        let (driver, n) = (self.stream.context.enter()?, size_of_val(words));
        // SAFETY: both sides are that long. The words may change at the return: the call has copied
        // them, since their memory is not page-locked (CUDA Driver API, "API synchronization
        // behavior").
        driver.check(unsafe {
            (driver.copy_to_device)(to.words.handle, words.as_ptr(), n, self.stream.handle)
        })
    }

    /// Copies words from memory, which is long enough.
    pub(super) fn read(&self, from: &CudaMemory, words: &mut [u32]) -> Result<(), DeviceFault> {
        assert!(words.len() <= from.len);
        let (driver, n) = (self.stream.context.enter()?, size_of_val(words));
        // SAFETY: both sides are that long, and the words live until all is copied, or for ever if the
        // device hangs.
        driver.check(unsafe {
            (driver.copy_to_host)(words.as_mut_ptr(), from.words.handle, n, self.stream.handle)
        })?;
        self.wait()
    }

    /// Runs a kernel for `n` items, with arrays and then `n` as its arguments. Returns the
    /// nanoseconds that it took.
    pub(super) fn run<'a>(
        &self,
        module: &Module,
        kernel: &str,
        arrays: impl Iterator<Item = &'a CudaMemory>,
        n: usize,
    ) -> Result<f64, DeviceFault> {
        let kernel = module.kernel(kernel)?;
        let driver = self.stream.context.enter()?;
        let [begin, end] = [0, 1].map(|i| self.events[i].handle);
        let mut addresses: Vec<Address> = arrays.map(|memory| memory.words.handle).collect();
        let (n_groups, group, mut n) = (n.div_ceil(GROUP) as c_uint, GROUP as c_uint, n as u32);
        let addresses = addresses
            .iter_mut()
            .map(|address| (&raw mut *address).cast());
        let mut arguments: Vec<*mut c_void> = addresses.chain([(&raw mut n).cast()]).collect();
        let (arguments, stream) = (arguments.as_mut_ptr(), self.stream.handle);
        // SAFETY: the kernel's parameters are such arrays and a number, which the call reads before it
        // returns; the arrays live until the end of the launch, or for ever if the device hangs.
        driver.check(unsafe { (driver.record_event)(begin, stream) })?;
        driver.check(unsafe {
            (driver.launch)(
                kernel,
                n_groups,
                1,
                1,
                group,
                1,
                1,
                0,
                stream,
                arguments,
                null_mut(),
            )
        })?;
        self.wait()?;
        // SAFETY: both events have happened; the call writes one number.
        let ms = driver.get(|ms| unsafe { (driver.milliseconds)(ms, begin, end) })?;
        Ok(1e6 * f64::from(ms))
    }

    /// Waits until all is done that was queued.
    pub(super) fn wait(&self) -> Result<(), DeviceFault> {
        let (driver, end) = (self.stream.context.enter()?, self.events[1].handle);
        // SAFETY: stream and event live.
        driver.check(unsafe { (driver.record_event)(end, self.stream.handle) })?;
        // SAFETY: the event lives.
        wait(MAX_LAUNCH, || match unsafe { (driver.query_event)(end) } {
            NOT_READY => Ok(None),
            code => driver.check(code).map(Some),
        })
    }
}
