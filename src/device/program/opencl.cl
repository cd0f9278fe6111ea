/* The names of what differs between the languages of devices, here of OpenCL C. */
#pragma OPENCL FP_CONTRACT OFF
#define KERNEL __kernel
#define GLOBAL __global
#define FUNCTION static inline
#define SEPARATE_FUNCTION static
#define ID get_global_id(0)
#define BITS_OF(x) as_uint(x)
#define FLOAT_OF(x) as_float(x)
#define DOUBLE_OF(x) as_double(x)
#define BITS_OF_DOUBLE(x) as_ulong(x)
/* The clock of the device's cycles, its time in nanoseconds, and the multiprocessor; 0 and NONE where there is none. */
#ifdef cl_khr_kernel_clock
#define CYCLES clock_read_device()
#else
#define CYCLES 0ul
#endif
#define TIME 0ul
#define SM NONE
