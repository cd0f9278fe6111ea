
/* The tables in which recorded formulas look values up: LookupTable::values_at in Rust. Rust's casts from floats
   saturate, C's are undefined. */

/* [[f32; M]]: a row by its index. */
FUNCTION void table_row(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  uint last = table[0] - 1u;
  uint i = at[0] >= 0.0f ? at[0] < (float)last ? (uint)at[0] : last : 0u;
  for (uint k = 0; k < n_values; k++) found[k] = FLOAT_OF(table[1u + n_values * i + k]);
}

/* AliasTable: an index by two numbers. */
FUNCTION void alias_table(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  double scaled = ((double)at[0] + (double)at[1] / 16777216.0) * (double)table[0];
  uint last = table[0] - 1u, bin = (uint)scaled;
  bin = bin < last ? bin : last;
  float own_share = FLOAT_OF(table[1u + 2u * bin]), other = FLOAT_OF(table[2u + 2u * bin]);
  found[0] = scaled - (double)bin < (double)own_share ? (float)bin : other;
}

/* ColorTable: a color by its number. */
FUNCTION double double_at(GLOBAL const uint *words) {
  return DOUBLE_OF((ulong)words[1] << 32 | (ulong)words[0]);
}
FUNCTION void color_table(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  uint n = table[0], choice = table[1], i = 0u;
  double number = (double)at[0] + double_at(table + 2);
  double low = double_at(table + 4), high = double_at(table + 6);
  GLOBAL const uint *colors = table + 11;
  if (at[0] != at[0]) {
    colors = table + 8;
  } else if (choice == 2u) {
    /* The nearest category; beyond 64 bits, the last one. */
    double nearest = round(number);
    long category = nearest >= 9223372036854775807.0   ? 9223372036854775807l
                    : nearest <= -9223372036854775808.0 ? -9223372036854775807l - 1l
                                                        : (long)nearest;
    long rest = category % (long)n;
    i = (uint)(rest < 0l ? rest + (long)n : rest);
  } else {
    double position = (number - low) / (high - low);
    double place = choice == 0u ? position * (double)(n - 1u) + 0.5 : position * (double)n;
    i = place >= 0.0 ? place < (double)n ? (uint)place : n - 1u : 0u;
  }
  for (uint k = 0; k < n_values; k++) found[k] = FLOAT_OF(colors[3u * i + k]);
}

/* FogSphere: the transmittance of a length. */
FUNCTION void fog_transmittance(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  found[0] = exponential(-FLOAT_OF(table[0]) * at[0]);
}

/* FreeFlight: the length of a flight. */
FUNCTION void free_flight(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  found[0] = -logarithm_plus_1(-at[0]) / FLOAT_OF(table[0]);
}
