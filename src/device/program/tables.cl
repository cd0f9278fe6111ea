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
  uint n = table[0], choice = table[1], is_log = table[2], i = 0u;
  double number = (double)at[0] + double_at(table + 3);
  double low = double_at(table + 5), high = double_at(table + 7);
  GLOBAL const uint *colors = table + 12;
  if (at[0] != at[0]) {
    colors = table + 9;
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
    if (is_log) {
      double least = DOUBLE_OF(0x0010000000000000ul);
      position = logarithm((number > least ? number : least) / low) / logarithm(high / low);
    }
    double place = choice == 0u ? position * (double)(n - 1u) + 0.5 : position * (double)n;
    i = place >= 0.0 ? place < (double)n ? (uint)place : n - 1u : 0u;
  }
  for (uint k = 0; k < n_values; k++) found[k] = FLOAT_OF(colors[3u * i + k]);
}

/* Power: a power of a base; 0 below a limit. */
FUNCTION void power_of_base(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  double found_power = power((double)at[0], (double)FLOAT_OF(table[0]));
  found[0] = found_power < double_at(table + 1) ? 0.0f : (float)found_power;
}

/* FogSphere: the transmittance of a length. */
FUNCTION void fog_transmittance(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  found[0] = exponential(-FLOAT_OF(table[0]) * at[0]);
}

/* FreeFlight: the length of a flight. */
FUNCTION void free_flight(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  found[0] = -logarithm_plus_1(-at[0]) / FLOAT_OF(table[0]);
}
