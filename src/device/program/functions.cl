
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
