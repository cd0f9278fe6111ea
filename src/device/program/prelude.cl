/* The languages that share this text. */
#if defined(__OPENCL_VERSION__)
#pragma OPENCL FP_CONTRACT OFF
#define KERNEL __kernel
#define GLOBAL __global
#define FUNCTION static inline
#define ID get_global_id(0)
#define BITS_OF(x) as_uint(x)
#define FLOAT_OF(x) as_float(x)
#define DOUBLE_OF(x) as_double(x)
#define SQRT(x) sqrt(x)
#else
#include <cmath>
#include <cstring>
typedef unsigned int uint;
static thread_local uint ID;
#define KERNEL extern "C"
#define GLOBAL
#define FUNCTION static inline
static inline uint BITS_OF(float x) { uint u; std::memcpy(&u, &x, 4); return u; }
static inline float FLOAT_OF(uint u) { float x; std::memcpy(&x, &u, 4); return x; }
static inline double DOUBLE_OF(unsigned long u) { double x; std::memcpy(&x, &u, 8); return x; }
#define SQRT(x) std::sqrt(x)
#endif

#define NONE 0xffffffffu
#define END 3u
FUNCTION float flip_sign(float x, float y) { return FLOAT_OF(BITS_OF(x) ^ (BITS_OF(y) & 0x80000000u)); }

