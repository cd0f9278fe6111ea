/* Arithmetic on triples of numbers, compared with the processor's before the first ray. */

/* The bits of a number; 0 for NaN, whose bits may differ. */
FUNCTION uint bits(float x) { return x == x ? BITS_OF(x) : 0u; }

/* The halves of a number's bits as one word; 0 for NaN. */
FUNCTION uint folded(double x) {
  ulong both = BITS_OF_DOUBLE(x);
  return x == x ? (uint)both ^ (uint)(both >> 32) : 0u;
}

KERNEL void arithmetic(GLOBAL const uint *in, GLOBAL uint *out, uint n) {
  uint id = (uint)ID;
  if (id >= n) return;
  float x = FLOAT_OF(in[3ul * id]), y = FLOAT_OF(in[3ul * id + 1]), z = FLOAT_OF(in[3ul * id + 2]);
  double product = (double)x * (double)y;
  int is_small = -2147483648.0f <= x && x < 2147483648.0f;
  out += 15ul * id;
  out[0] = bits(x / y);
  out[1] = bits(sqrt(x));
  out[2] = bits(x * y + z);
  out[3] = bits(x * y - z);
  out[4] = folded(product + (double)z);
  out[5] = folded(product - (double)z);
  out[6] = folded(product / (double)z);
  out[7] = bits((float)product);
  out[8] = (uint)(x < y) | (uint)(x <= y) << 1 | (uint)(x > y) << 2;
  out[9] = bits(floor(x));
  out[10] = folded(trunc(product));
  out[11] = (uint)(int)(is_small ? x : 0.0f);
  out[12] = bits((float)(int)BITS_OF(x));
  out[13] = folded(sqrt(product));
  out[14] = bits(x + y);
}
