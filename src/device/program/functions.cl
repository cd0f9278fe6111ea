/* Functions of libm in the operations of Rust's crate libm: its results to the last bit. */

/* expf of a number that is at most 0. */
FUNCTION float exponential(float x) {
  uint magnitude = BITS_OF(x) & 0x7fffffffu;
  int sign = (int)(BITS_OF(x) >> 31);
  if (magnitude > 0x7f800000u) return x;
  if (magnitude >= 0x42cff1b5u) return 0.0f;
  int k = 0;
  float high = x, low = 0.0f;
  if (magnitude > 0x3eb17218u) {
    k = magnitude > 0x3f851592u ? (int)(1.4426950216e+00f * x + (sign ? -0.5f : 0.5f)) : 1 - sign - sign;
    float number = (float)k;
    high = x - number * 6.9314575195e-01f;
    low = number * 1.4286067653e-06f;
    x = high - low;
  } else if (magnitude <= 0x39000000u) {
    return 1.0f + x;
  }
  float square = x * x;
  float c = x - square * (1.6666625440e-1f + square * -2.7667332906e-3f);
  float y = 1.0f + (x * c / (2.0f - c) - low + high);
  /* The product with 2^k, in two steps where it is subnormal. */
  if (k < -126) {
    y = y * FLOAT_OF((uint)(127 - 102) << 23);
    k += 102;
  }
  return y * FLOAT_OF((uint)(127 + k) << 23);
}

/* log2f of a number greater than 1. */
FUNCTION float logarithm_2(float x) {
  uint bits = BITS_OF(x);
  if (bits >= 0x7f800000u) return x;
  bits += 0x3f800000u - 0x3f3504f3u;
  float number = (float)((int)(bits >> 23) - 0x7f);
  float f = FLOAT_OF((bits & 0x007fffffu) + 0x3f3504f3u) - 1.0f;
  float s = f / (2.0f + f);
  float z = s * s, w = z * z;
  float even = w * (0.40000972152f + w * 0.24279078841f);
  float odd = z * (0.66666662693f + w * 0.28498786688f);
  float halved = 0.5f * f * f;
  float high = FLOAT_OF(BITS_OF(f - halved) & 0xfffff000u);
  float low = f - high - halved + s * (halved + (odd + even));
  return (low + high) * -1.7605285393e-04f + low * 1.4428710938e+00f + high * 1.4428710938e+00f + number;
}

/* log1pf of a number in (-1, 0]. */
FUNCTION float logarithm_plus_1(float x) {
  uint bits = BITS_OF(x);
  if (bits << 1 < 0x33800000u << 1) return x;
  int k = 0;
  float f = x, c = 0.0f;
  if (bits > 0xbe95f619u) {
    uint sum = BITS_OF(1.0f + x);
    uint shifted = sum + (0x3f800000u - 0x3f3504f3u);
    k = (int)(shifted >> 23) - 0x7f;
    if (k < 25) {
      c = k >= 2 ? 1.0f - (FLOAT_OF(sum) - x) : x - (FLOAT_OF(sum) - 1.0f);
      c = c / FLOAT_OF(sum);
    }
    f = FLOAT_OF((shifted & 0x007fffffu) + 0x3f3504f3u) - 1.0f;
  }
  float s = f / (2.0f + f);
  float z = s * s, w = z * z;
  float even = w * (0.40000972152f + w * 0.24279078841f);
  float odd = z * (0.66666662693f + w * 0.28498786688f);
  float halved = 0.5f * f * f, number = (float)k;
  return s * (halved + (odd + even)) + (number * 9.0580006145e-06f + c) - halved + f + number * 6.9313812256e-01f;
}

/* A double with the lower half of its bits 0, or with another upper half. */
FUNCTION double upper_half(double x) { return DOUBLE_OF(BITS_OF_DOUBLE(x) & 0xffffffff00000000ul); }
FUNCTION double with_upper_half(double x, uint upper) {
  return DOUBLE_OF((ulong)upper << 32 | (BITS_OF_DOUBLE(x) & 0xfffffffful));
}

/* log of a positive double. */
FUNCTION double logarithm(double x) {
  int k = 0;
  if (x < DOUBLE_OF(0x0010000000000000ul)) {
    k = -54;
    x = x * DOUBLE_OF(0x4350000000000000ul);
  }
  ulong bits = BITS_OF_DOUBLE(x);
  uint upper = (uint)(bits >> 32);
  if (upper >= 0x7ff00000u) return x;
  upper += 0x3ff00000u - 0x3fe6a09eu;
  k += (int)(upper >> 20) - 0x3ff;
  double f = with_upper_half(x, (upper & 0x000fffffu) + 0x3fe6a09eu) - 1.0;
  double halved = 0.5 * f * f, s = f / (2.0 + f), number = (double)k;
  double z = s * s, w = z * z;
  double even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  double odd = z * (6.666666666666735130e-01 +
                    w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  return s * (halved + (odd + even)) + number * 1.90821492927058770002e-10 - halved + f +
         number * 6.93147180369123816490e-01;
}

/* pow of a float of at least 0 and an exponent from 2^-20 to 2^31; 0 for results below 2^-1000. */
FUNCTION double power(double x, double y) {
  if (x != x || x == 0.0 || x == 1.0) return x;
  if (y == 0.5) return sqrt(x);
  /* The logarithm of x to base 2 in two parts: of its fraction, near 1 or near 1.5, and its exponent. */
  uint upper = (uint)(BITS_OF_DOUBLE(x) >> 32), fraction = upper & 0x000fffffu;
  int n = (int)(upper >> 20) - 0x3ff;
  upper = fraction | 0x3ff00000u;
  int is_near_one = fraction <= 0x3988eu;
  if (fraction >= 0xbb67au) {
    is_near_one = 1;
    n++;
    upper -= 0x00100000u;
  }
  double near = is_near_one ? 1.0 : 1.5, near_high = is_near_one ? 0.0 : 5.84962487220764160156e-01;
  double near_low = is_near_one ? 0.0 : 1.35003920212974897128e-08;
  x = with_upper_half(x, upper);
  double u = x - near, v = 1.0 / (x + near), s = u * v, s_high = upper_half(s);
  double t_high = with_upper_half(0.0, ((upper >> 1) | 0x20000000u) + 0x00080000u + (is_near_one ? 0u : 1u << 18));
  double t_low = x - (t_high - near);
  double s_low = v * ((u - s_high * t_high) - s_high * t_low);
  double s2 = s * s;
  double r = s2 * s2 *
             (5.99999999999994648725e-01 +
              s2 * (4.28571428578550184252e-01 +
                    s2 * (3.33333329818377432918e-01 +
                          s2 * (2.72728123808534006489e-01 +
                                s2 * (2.30660745775561754067e-01 + s2 * 2.06975017800338417784e-01)))));
  r = r + s_low * (s_high + s);
  s2 = s_high * s_high;
  t_high = upper_half(3.0 + s2 + r);
  t_low = r - ((t_high - 3.0) - s2);
  u = s_high * t_high;
  v = s_low * t_high + t_low * s;
  double p_high = upper_half(u + v), p_low = v - (p_high - u);
  double z_high = 9.61796700954437255859e-01 * p_high;
  double z_low = -7.02846165095275826516e-09 * p_high + p_low * 9.61796693925975554329e-01 + near_low;
  double number = (double)n;
  double log_high = upper_half(((z_high + z_low) + near_high) + number);
  double log_low = z_low - (((log_high - number) - near_high) - z_high);
  /* Its product with y. */
  double y_high = upper_half(y);
  p_low = (y - y_high) * log_high + y * log_low;
  p_high = y_high * log_high;
  double z = p_low + p_high;
  if (z >= 1024.0) return INFINITY;
  if (z < -1000.0) return 0.0;
  /* 2 to this power. */
  int j = (int)(uint)(BITS_OF_DOUBLE(z) >> 32), i = j & 0x7fffffff;
  n = 0;
  if (i > 0x3fe00000) {
    n = j + (0x00100000 >> ((i >> 20) - 0x3fe));
    int k = ((n & 0x7fffffff) >> 20) - 0x3ff;
    p_high = p_high - with_upper_half(0.0, (uint)(n & ~(0x000fffff >> k)));
    n = ((n & 0x000fffff) | 0x00100000) >> (20 - k);
    if (j < 0) n = -n;
  }
  double t = upper_half(p_low + p_high);
  u = t * 6.93147182464599609375e-01;
  v = (p_low - (t - p_high)) * 6.93147180559945286227e-01 + t * -1.90465429995776804525e-09;
  z = u + v;
  double w = v - (z - u);
  t = z * z;
  double t1 = z - t * (1.66666666666666019037e-01 +
                       t * (-2.77777777770155933842e-03 +
                            t * (6.61375632143793436117e-05 +
                                 t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08))));
  r = (z * t1) / (t1 - 2.0) - (w + z * w);
  z = 1.0 - (r - z);
  return with_upper_half(z, (uint)((int)(uint)(BITS_OF_DOUBLE(z) >> 32) + n * 0x00100000));
}
