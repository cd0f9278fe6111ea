//! NVIDIA's compiler of CUDA C++ at run time: NVRTC, a library of the CUDA toolkit, and of PyPI as
//! `nvidia-cuda-nvrtc` (NVRTC, user guide).
#![expect(unsafe_code, reason = "functions of C")]

use std::ffi::{CStr, CString, c_char, c_int};
use std::ptr::null;
use std::sync::LazyLock;

use super::functions::{functions, load};
use super::ptx;
use crate::library::DeviceFault;

/// The names of the library, newest first.
const NAMES: [&str; 4] = [
    "libnvrtc.so.13",
    "libnvrtc.so.12",
    "libnvrtc.so.11.2",
    "libnvrtc.so",
];

/// No fused operations, no flushed subnormals, and correct rounding.
const OPTIONS: [&CStr; 4] = [
    c"--fmad=false",
    c"--ftz=false",
    c"--prec-div=true",
    c"--prec-sqrt=true",
];

/// The compute capability, times 10, that the program needs at most: newer cards run it, too, and
/// compilers of CUDA 10 to 13 know it.
const CAPABILITY: c_int = 75;

/// A handle of a program: the bits of a pointer.
type ProgramHandle = usize;

functions! {
    /// The compiler. Its functions return 0, or the number of an error.
    Compiler {
        create: b"nvrtcCreateProgram"(
            *mut ProgramHandle, *const c_char, *const c_char, c_int, *const *const c_char, *const *const c_char
        );
        compile: b"nvrtcCompileProgram"(ProgramHandle, c_int, *const *const c_char);
        log_size: b"nvrtcGetProgramLogSize"(ProgramHandle, *mut usize);
        log: b"nvrtcGetProgramLog"(ProgramHandle, *mut c_char);
        ptx_size: b"nvrtcGetPTXSize"(ProgramHandle, *mut usize);
        ptx: b"nvrtcGetPTX"(ProgramHandle, *mut c_char);
        destroy: b"nvrtcDestroyProgram"(*mut ProgramHandle);
    }
}

impl Compiler {
    /// Returns the compiler, which is loaded once.
    pub(super) fn open() -> Result<&'static Self, DeviceFault> {
        static COMPILER: LazyLock<Option<Compiler>> =
            LazyLock::new(|| NAMES.iter().find_map(|name| Compiler::of(load(name)?)));
        COMPILER.as_ref().ok_or(DeviceFault::Missing("libnvrtc.so"))
    }

    /// Compiles CUDA C++ for cards of a compute capability, times 10, and newer ones. Returns PTX
    /// for the driver, whose arithmetic is exact.
    pub(super) fn compile(&self, text: &str, capability: c_int) -> Result<String, DeviceFault> {
        let capability = capability.min(CAPABILITY);
        let architecture = format!("--gpu-architecture=compute_{capability}");
        let architecture = CString::new(architecture).unwrap_or_default();
        let options = OPTIONS.into_iter().chain([&*architecture]);
        let options: Vec<_> = options.map(CStr::as_ptr).collect();
        let text = CString::new(text).unwrap_or_default();
        let mut program = 0;
        // SAFETY: the texts end with a zero and outlive the calls, which keep none of them; there are
        // no headers; `read` reads with the functions of a size and a text.
        unsafe {
            check((self.create)(
                &mut program,
                text.as_ptr(),
                c"raycost.cu".as_ptr(),
                0,
                null(),
                null(),
            ))?;
            let code = (self.compile)(program, options.len() as c_int, options.as_ptr());
            let result = if code == 0 {
                read(program, self.ptx_size, self.ptx)
            } else {
                let log = read(program, self.log_size, self.log);
                log.and_then(|log| Err(DeviceFault::of_build(&log)))
            };
            (self.destroy)(&mut program);
            ptx::exact(&result?).map_err(DeviceFault::Build)
        }
    }
}

/// Reads a text of a program, given the functions for its size and its bytes.
///
/// # Safety
/// The functions are such ones, and the program exists.
unsafe fn read(
    program: ProgramHandle,
    size: unsafe extern "C" fn(ProgramHandle, *mut usize) -> c_int,
    bytes: unsafe extern "C" fn(ProgramHandle, *mut c_char) -> c_int,
) -> Result<String, DeviceFault> {
    let mut n = 0;
    // SAFETY: `bytes` writes as many bytes as `size` says, the last one a zero.
    let text = unsafe {
        check(size(program, &mut n))?;
        let mut text = vec![0_u8; n];
        check(bytes(program, text.as_mut_ptr().cast()))?;
        text
    };
    let text = String::from_utf8_lossy(&text);
    Ok(text.trim_end_matches('\0').to_owned())
}

fn check(code: c_int) -> Result<(), DeviceFault> {
    match code {
        0 => Ok(()),
        _ => Err(DeviceFault::Call(format!("error {code} of NVRTC"))),
    }
}
