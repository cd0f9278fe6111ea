/* The names of what differs between the languages of devices, here of CUDA C++. */
typedef unsigned int uint;
typedef unsigned long ulong;
#define KERNEL extern "C" __global__
#define GLOBAL
#define FUNCTION static __device__ inline
#define SEPARATE_FUNCTION static __device__ __noinline__
#define ID (blockIdx.x * blockDim.x + threadIdx.x)
#define BITS_OF(x) __float_as_uint(x)
#define FLOAT_OF(x) __uint_as_float(x)
#define DOUBLE_OF(x) __longlong_as_double((long long)(x))
#define BITS_OF_DOUBLE(x) ((ulong)__double_as_longlong(x))
#define CYCLES ((ulong)clock64())
#define SM number_of_sm()
#define TIME time_ns()
#define INFINITY FLOAT_OF(0x7f800000u)
#define round(x) rounded_half_away(x)

FUNCTION uint number_of_sm(void) {
  uint number;
  asm volatile("mov.u32 %0, %%smid;" : "=r"(number));
  return number;
}

/* The nanoseconds of the clock that all multiprocessors share. */
FUNCTION ulong time_ns(void) {
  ulong ns;
  asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(ns));
  return ns;
}

/* CUDA's own function adds in another mode of rounding. */
FUNCTION double rounded_half_away(double x) {
  double whole = trunc(x), rest = x - whole;
  return rest >= 0.5 ? whole + 1.0 : rest <= -0.5 ? whole - 1.0 : whole;
}

