/* Arithmetic on triples of numbers, compared with the processor's before the first ray. */
KERNEL void arithmetic(GLOBAL const uint *in, GLOBAL uint *out, uint n) {
  uint id = (uint)ID;
  if (id >= n) return;
  float x = FLOAT_OF(in[3ul * id]), y = FLOAT_OF(in[3ul * id + 1]), z = FLOAT_OF(in[3ul * id + 2]);
  double product = (double)x * (double)y;
  out[8ul * id] = BITS_OF(x / y);
  out[8ul * id + 1] = BITS_OF(SQRT(x));
  out[8ul * id + 2] = BITS_OF(x * y + z);
  out[8ul * id + 3] = BITS_OF(x * y - z);
  out[8ul * id + 4] = BITS_OF((float)(product + (double)z));
  out[8ul * id + 5] = BITS_OF((float)(product / (double)z));
  out[8ul * id + 6] = (uint)(x < y) | (uint)(x <= y) << 1 | (uint)(x > y) << 2;
  out[8ul * id + 7] = BITS_OF(x + y);
}
