/* Pictures, and directions with the density of a picture: src/world/picture and EquirectangularDistribution in Rust. */

#define REPEAT 0u
#define CLAMP 1u
#define MIRROR 2u
#define TRILINEAR 0u
#define NEAREST 2u

/* One size of a picture. */
typedef struct {
  uint width, height;
  GLOBAL const uint *texels;
} MipLevel;

/* Level `i` of a picture. */
FUNCTION MipLevel mip_level(GLOBAL const uint *picture, uint i) {
  GLOBAL const uint *numbers = picture + 1 + 3u * i;
  MipLevel level = {numbers[0], numbers[1], picture + 1 + 3u * picture[0] + 4ul * numbers[2]};
  return level;
}

/* Wrap::folded: a position in the picture, from 0 to 1; 0 for NaN. */
FUNCTION float folded(uint wrap, float place) {
  float at = place;
  if (wrap == REPEAT) {
    at = place - floor(place);
  } else if (wrap == MIRROR) {
    float halved = 0.5f * place;
    float in_pair = 2.0f * (halved - floor(halved));
    at = 1.0f - FLOAT_OF(BITS_OF(1.0f - in_pair) & 0x7fffffffu);
  }
  at = at > 0.0f ? at : 0.0f;
  return at < 1.0f ? at : 1.0f;
}

/* Wrap::neighbors: the texels on both sides of a position, and the position between their centers. */
FUNCTION uint neighbor(uint wrap, int i, uint n) {
  int last = (int)n - 1;
  if (wrap == REPEAT && i < 0) return (uint)last;
  if (wrap == REPEAT && i > last) return 0u;
  return (uint)(i < 0 ? 0 : i > last ? last : i);
}
FUNCTION float neighbors(uint wrap, float place, uint n, uint *texels) {
  float at = place * (float)n - 0.5f, before = floor(at);
  int first = (int)before;
  texels[0] = neighbor(wrap, first, n);
  texels[1] = neighbor(wrap, first + 1, n);
  return at - before;
}

/* Picture::between: the mean of the four nearest texels, weighted by their distance. */
FUNCTION void between(MipLevel level, uint wrap_x, uint wrap_y, const float *place, float *found) {
  uint columns[2], rows[2];
  float across = neighbors(wrap_x, place[0], level.width, columns);
  float down = neighbors(wrap_y, place[1], level.height, rows);
  ulong width = level.width;
  GLOBAL const uint *upper = level.texels + 4ul * (width * rows[0]);
  GLOBAL const uint *lower = level.texels + 4ul * (width * rows[1]);
  for (uint i = 0; i < 4u; i++) {
    float a = FLOAT_OF(upper[4ul * columns[0] + i]), b = FLOAT_OF(upper[4ul * columns[1] + i]);
    float c = FLOAT_OF(lower[4ul * columns[0] + i]), d = FLOAT_OF(lower[4ul * columns[1] + i]);
    float above = a + (b - a) * across, below = c + (d - c) * across;
    found[i] = above + (below - above) * down;
  }
}

/* Picture::at */
FUNCTION void image_texture(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  uint filter = table[0], wrap = table[1];
  GLOBAL const uint *picture = table + 2;
  uint last = picture[0] - 1u;
  MipLevel whole = mip_level(picture, 0u);
  float place[2] = {folded(wrap, at[0]), 1.0f - folded(wrap, at[1])};
  if (filter == NEAREST) {
    uint column = (uint)floor(place[0] * (float)whole.width), row = (uint)floor(place[1] * (float)whole.height);
    column = column < whole.width ? column : whole.width - 1u;
    row = row < whole.height ? row : whole.height - 1u;
    for (uint i = 0; i < 4u; i++) found[i] = FLOAT_OF(whole.texels[4ul * ((ulong)whole.width * row + column) + i]);
    return;
  }
  float n_texels = at[2] * sqrt((float)whole.width * (float)whole.height);
  if (filter != TRILINEAR || last == 0u || !(n_texels > 1.0f)) {
    between(whole, wrap, wrap, place, found);
    return;
  }
  float level = logarithm_2(n_texels), coarsest = (float)last, coarse[4];
  level = level < coarsest ? level : coarsest;
  uint finer = (uint)level;
  finer = finer < last - 1u ? finer : last - 1u;
  between(mip_level(picture, finer), wrap, wrap, place, found);
  between(mip_level(picture, finer + 1u), wrap, wrap, place, coarse);
  for (uint i = 0; i < 4u; i++) found[i] = found[i] + (coarse[i] - found[i]) * (level - (float)finer);
}

/* EnvironmentMap: the radiance at a place, as Picture::around. */
FUNCTION void environment_map(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  float intensity = FLOAT_OF(table[0]), most = FLOAT_OF(table[1]), color[4];
  float place[2] = {folded(REPEAT, at[0]), 1.0f - folded(CLAMP, at[1])};
  between(mip_level(table + 2, 0u), REPEAT, CLAMP, place, color);
  for (uint i = 0; i < 3u; i++) {
    float light = color[i] * intensity;
    found[i] = light < most ? light : most;
  }
}

/* EquirectangularDistribution. */
typedef struct {
  uint n_columns, n_rows;
  GLOBAL const uint *texels, *sums, *columns, *bands, *heights;
} Equirectangular;
FUNCTION Equirectangular equirectangular(GLOBAL const uint *table) {
  Equirectangular of = {table[0], table[1], table + 2};
  of.sums = of.texels + (ulong)of.n_columns * of.n_rows;
  of.columns = of.sums + of.n_rows;
  of.bands = of.columns + (ulong)(of.n_columns + 1u) * of.n_rows;
  of.heights = of.bands + of.n_rows + 2;
  return of;
}

/* The rows above and below a band. */
FUNCTION void rows_around(Equirectangular of, uint band, uint *rows) {
  rows[0] = band ? band - 1u : 0u;
  rows[1] = band < of.n_rows ? band : of.n_rows - 1u;
}

/* BetweenRows::at_center: the density at the center of a column, between two rows. */
FUNCTION float at_center(Equirectangular of, const uint *rows, float down, uint column) {
  ulong n = of.n_columns, i = column % of.n_columns;
  float above = FLOAT_OF(of.texels[n * rows[0] + i]), below = FLOAT_OF(of.texels[n * rows[1] + i]);
  return above + (below - above) * down;
}

/* Cumulative::up_to_center: the density between two rows, from the center of the first column to another one's. */
FUNCTION float up_to_center(Equirectangular of, const uint *rows, float down, uint column) {
  ulong n = of.n_columns + 1u;
  float above = FLOAT_OF(of.columns[n * rows[0] + column]), below = FLOAT_OF(of.columns[n * rows[1] + column]);
  return above * (FLOAT_OF(of.sums[rows[0]]) * (1.0f - down)) + below * (FLOAT_OF(of.sums[rows[1]]) * down);
}

/* linear: the position up to which a linear density has this share. */
FUNCTION float linear(float from, float to, float share) {
  float square = from * from + (to * to - from * from) * share;
  float root = sqrt(square > 0.0f ? square : 0.0f);
  if (!(from + root > 0.0f)) return share;
  float place = share * (from + to) / (from + root);
  return place < 1.0f ? place : 1.0f;
}

FUNCTION void sample_equirectangular(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  Equirectangular of = equirectangular(table);
  /* The band, and the position in it. */
  uint first = 0u, n = of.n_rows + 2u, rows[2];
  while (n > 0u) {
    uint middle = n / 2u;
    if (FLOAT_OF(of.bands[first + middle]) <= at[1]) {
      first += middle + 1u;
      n -= middle + 1u;
    } else {
      n = middle;
    }
  }
  uint last = of.n_rows + 1u;
  uint band = (first < 1u ? 1u : first > last ? last : first) - 1u;
  float from = FLOAT_OF(of.bands[band]), to = FLOAT_OF(of.bands[band + 1u]);
  rows_around(of, band, rows);
  float down = linear(FLOAT_OF(of.sums[rows[0]]), FLOAT_OF(of.sums[rows[1]]), (at[1] - from) / (to - from));
  /* The column, and the position in it. */
  float target = at[0] * up_to_center(of, rows, down, of.n_columns);
  uint column = 0u;
  for (n = of.n_columns; n > 1u; n -= n / 2u)
    if (up_to_center(of, rows, down, column + n / 2u) <= target) column += n / 2u;
  from = up_to_center(of, rows, down, column);
  to = up_to_center(of, rows, down, column + 1u);
  float share = to > from ? (target - from) / (to - from) : 0.5f;
  float left = at_center(of, rows, down, column), right = at_center(of, rows, down, column + 1u);
  float across = linear(left, right, share < 0.0f ? 0.0f : share > 1.0f ? 1.0f : share);
  float upper = FLOAT_OF(of.heights[band]), lower = FLOAT_OF(of.heights[band + 1u]);
  found[0] = ((float)column + 0.5f + across) / (float)of.n_columns;
  found[1] = upper + (lower - upper) * down;
  found[2] = left + (right - left) * across;
}

FUNCTION void equirectangular_density(GLOBAL const uint *table, uint n_values, const float *at, float *found) {
  Equirectangular of = equirectangular(table);
  float row = (1.0f - at[1]) * (float)of.n_rows + 0.5f;
  uint band = row > 0.0f ? row < (float)of.n_rows ? (uint)row : of.n_rows : 0u, rows[2];
  float upper = FLOAT_OF(of.heights[band]), lower = FLOAT_OF(of.heights[band + 1u]);
  float down = (upper - at[2]) / (upper - lower);
  down = down < 0.0f ? 0.0f : down > 1.0f ? 1.0f : down;
  rows_around(of, band, rows);
  float column = (at[0] - floor(at[0])) * (float)of.n_columns + (float)of.n_columns - 0.5f;
  float left = floor(column);
  float from = at_center(of, rows, down, (uint)left), to = at_center(of, rows, down, (uint)left + 1u);
  found[0] = from + (to - from) * (column - left);
}
