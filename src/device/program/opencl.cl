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
#define SQRT(x) sqrt(x)
#ifdef cl_khr_kernel_clock
#define CYCLES clock_read_device()
#endif
