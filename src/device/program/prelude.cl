/* The names of what differs between the languages of devices, here of OpenCL C. */
#pragma OPENCL FP_CONTRACT OFF
#define KERNEL __kernel
#define GLOBAL __global
#define CONSTANT __constant
#define FUNCTION static inline
#define ID get_global_id(0)
#define BITS_OF(x) as_uint(x)
#define FLOAT_OF(x) as_float(x)
#define DOUBLE_OF(x) as_double(x)
#define SQRT(x) sqrt(x)

#define NONE 0xffffffffu
#define END 3u
FUNCTION float flip_sign(float x, float y) { return FLOAT_OF(BITS_OF(x) ^ (BITS_OF(y) & 0x80000000u)); }

