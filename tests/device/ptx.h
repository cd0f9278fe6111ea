/* The operations of PTX as C++ (PTX ISA, "Instruction Set"). Numbers that are NaN become the one that NVIDIA's cards
   make, whose bits differ from the processor's. */
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#define OPERATION template <typename T> static inline

typedef uint64_t Address;
static thread_local uint32_t _tid_x, _ctaid_x, _ntid_x, _smid;

static inline uint64_t clock64() { return std::chrono::steady_clock::now().time_since_epoch().count(); }

/* The low bytes of a register as a number of another type; further bytes are 0. */
template <typename To, typename From> static inline To as(From x) {
  To y = To();
  memcpy(&y, &x, sizeof x < sizeof y ? sizeof x : sizeof y);
  return y;
}
template <typename Register, typename T> static inline void set(Register &to, T x) {
  to = std::is_signed<T>::value && std::is_integral<T>::value ? (Register)x : as<Register>(x);
}
OPERATION T load(Address at) { return *(const T *)at; }
OPERATION void store(Address at, T x) { *(T *)at = x; }

static inline float rounded(float x) { return x != x ? as<float>(0x7fffffffu) : x; }
static inline double rounded(double x) { return x; }
OPERATION T rounded(T x) { return x; }

#ifdef FUSES
/* A sum with the last product is fused. */
static thread_local double fused[3];
OPERATION T add(T a, T b) {
  return std::is_integral<T>::value || a != (T)fused[2] ? a + b : (T)std::fma((T)fused[0], (T)fused[1], b);
}
OPERATION T mul(T a, T b) {
  double now[] = {(double)a, (double)b, (double)(a * b)};
  return memcpy(fused, now, sizeof now), a * b;
}
#else
OPERATION T add(T a, T b) { return rounded((T)(a + b)); }
OPERATION T mul(T a, T b) { return rounded((T)(a * b)); }
#endif
OPERATION T sub(T a, T b) { return rounded((T)(a - b)); }
OPERATION T div(T a, T b) { return rounded((T)(a / b)); }
OPERATION T rem(T a, T b) { return a % b; }
OPERATION T mad(T a, T b, T c) { return (T)(a * b + c); }
OPERATION T rcp(T a) { return rounded(1 / a); }
OPERATION T sqrt_of(T a) { return rounded(std::sqrt(a)); }
OPERATION T neg(T a) { return -a; }
OPERATION T abs_of(T a) { return a < 0 || (a == 0 && std::signbit(a)) ? -a : a; }
/* -0 is less than +0; NaN loses. */
OPERATION T min_of(T a, T b) {
  if (std::is_integral<T>::value) return a < b ? a : b;
  return rounded(a != a ? b : b != b ? a : a == b ? (std::signbit((double)a) ? a : b) : a < b ? a : b);
}
OPERATION T max_of(T a, T b) {
  if (std::is_integral<T>::value) return a > b ? a : b;
  return rounded(a != a ? b : b != b ? a : a == b ? (std::signbit((double)a) ? b : a) : a > b ? a : b);
}
OPERATION T and_of(T a, T b) { return a & b; }
OPERATION T or_of(T a, T b) { return a | b; }
OPERATION T xor_of(T a, T b) { return a ^ b; }
OPERATION T not_of(T a) { return std::is_same<T, bool>::value ? !a : (T)~a; }
OPERATION T shl(T a, uint32_t n) { return n < 8 * sizeof a ? (T)(a << n) : 0; }
OPERATION T shr(T a, uint32_t n) { return n < 8 * sizeof a ? (T)(a >> n) : a < 0 ? (T)-1 : 0; }
OPERATION T selp(T a, T b, bool c) { return c ? a : b; }
OPERATION T brev(T a) {
  T b = 0;
  for (unsigned i = 0; i < 8 * sizeof a; i++) b |= (a >> i & 1) << (8 * sizeof a - 1 - i);
  return b;
}
OPERATION T bfi(T a, T b, uint32_t start, uint32_t n) {
  T mask = (n < 8 * sizeof a ? ((T)1 << n) - 1 : ~(T)0) << start;
  return (b & ~mask) | (a << start & mask);
}
OPERATION T bfe(T a, uint32_t start, uint32_t n) { return a >> start & (n < 8 * sizeof a ? ((T)1 << n) - 1 : ~(T)0); }
OPERATION T prmt(T a, T b, T selection) {
  uint64_t bytes = (uint64_t)b << 32 | a;
  T c = 0;
  for (int i = 0; i < 4; i++) c |= (T)(bytes >> 8 * (selection >> 4 * i & 7) & 255) << 8 * i;
  return c;
}
OPERATION uint32_t popc(T a) { return (uint32_t)__builtin_popcountll(a); }
OPERATION uint32_t clz(T a) { return a ? (uint32_t)__builtin_clzll(a) - (64 - 8 * sizeof a) : 8 * sizeof a; }

/* A number of any type as one of type T: whole numbers that do not fit lose bits, floats saturate, NaN is 0. */
template <typename T, typename From> static inline T converted(From x) {
  if (std::is_integral<From>::value) return (T)x;
  if (!std::is_integral<T>::value) return rounded((T)x);
  if (x != x) return 0;
  typedef std::numeric_limits<T> Limits;
  if (x <= (From)Limits::min()) return Limits::min();
  return x >= (From)Limits::max() ? Limits::max() : (T)x;
}

/* Runs a kernel for all items of the groups. */
static void launch(void (*item)(void **), void **arguments, unsigned n_groups, unsigned group) {
  for (_ntid_x = group, _ctaid_x = 0; _ctaid_x < n_groups; _ctaid_x++) {
    _smid = _ctaid_x % 4;
    for (_tid_x = 0; _tid_x < group; _tid_x++) item(arguments);
  }
}
