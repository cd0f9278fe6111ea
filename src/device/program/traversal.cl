/* Traversal of raycost's hierarchies, in OpenCL C.

   Hits and counters equal the ones of src/tracer/accel, to the bit: the same order of children, the same tests, no
   operation fused. The formulas of boxes and shapes are recorded from the Rust code (formulas.rs) and stand before
   this text; here are the loop, the stack, and the tests in double precision. */

/* The numbers of a ray, prepared once. */
typedef struct {
  float origin[3], direction[3];
  float slabs[9];   /* boxes */
  float shear[6];   /* triangles: the origin with permuted axes, and the shear */
  float squared[2]; /* spheres */
  uint octant, axes[3];
} Prepared;

/* The state of a search. */
typedef struct {
  float limit, t;
  uint primitive, instance; /* instance: 0 for none, else its number plus 1 */
  uint ignored;             /* an object, or NONE */
  int is_done;
  uint n_visits, n_tests;
} Search;

/* The scene: see scene.rs for the records. */
typedef struct {
  GLOBAL const float *lines;
  GLOBAL const uint *levels, *unbounded, *primitives, *records;
} World;

FUNCTION void prepare(Prepared *ray, float largest) {
  float in[7], out[19];
  for (int i = 0; i < 3; i++) {
    in[i] = ray->origin[i];
    in[3 + i] = ray->direction[i];
  }
  in[6] = largest;
  prepared(in, out);
  for (int i = 0; i < 9; i++) ray->slabs[i] = out[i];
  for (int i = 0; i < 6; i++) ray->shear[i] = out[9 + i];
  ray->squared[0] = out[15];
  ray->squared[1] = out[16];
  uint last = out[18] != 0.0f ? 2u : out[17] != 0.0f ? 1u : 0u;
  ray->axes[0] = (last + 1u) % 3u;
  ray->axes[1] = (last + 2u) % 3u;
  ray->axes[2] = last;
  ray->octant = 0;
  for (int i = 0; i < 3; i++) ray->octant |= (BITS_OF(ray->direction[i]) >> 31) << i;
}

/* Returns where the ray enters and leaves a box, whose near and far planes are the first six of 16 numbers. */
FUNCTION void span(const Prepared *ray, float *in, float limit, float *out) {
  for (int i = 0; i < 9; i++) in[6 + i] = ray->slabs[i];
  in[15] = limit;
  box_span(in, out);
}

/* Shear::intersect_exactly */
FUNCTION float exact_triangle(const float *v, float scale) {
  double ax = v[0], ay = v[1], az = v[2], bx = v[3], by = v[4], bz = v[5], cx = v[6], cy = v[7], cz = v[8];
  double u = bx * cy - by * cx, o = cx * ay - cy * ax, w = ax * by - ay * bx;
  double least = u < o ? u : o, greatest = u > o ? u : o;
  least = least < w ? least : w;
  greatest = greatest > w ? greatest : w;
  double area = u + o + w;
  if ((least < 0.0 && greatest > 0.0) || area == 0.0) return 0.0f;
  double z = (u * az + o * bz + w * cz) / area;
  return (float)(z * (double)scale);
}

/* Returns where the ray hits a triangle; 0 for a miss. Its vertices, whose axes are permuted as the ray's, are the first
   nine of 15 numbers. */
FUNCTION float triangle(const Prepared *ray, float *in) {
  float out[12];
  for (int i = 0; i < 6; i++) in[9 + i] = ray->shear[i];
  triangle_test(in, out);
  if (out[2] != 0.0f) return exact_triangle(out + 3, ray->shear[5]);
  return out[1] != 0.0f ? out[0] : 0.0f;
}

/* Rectangle::intersect */
FUNCTION float rectangle(const float *p, const float *origin, const float *direction) {
  double u[3], v[3], d[3], o[3], n[3], m[3];
  for (int i = 0; i < 3; i++) {
    u[i] = p[3 + i];
    v[i] = p[6 + i];
    d[i] = direction[i];
    o[i] = (double)origin[i] - (double)p[i];
  }
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    n[i] = u[j] * v[k] - v[j] * u[k];
    m[i] = o[j] * d[k] - d[j] * o[k];
  }
  double volume = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
  double min_cos = MIN_COS;
  if (volume * volume < min_cos * min_cos * (n[0] * n[0] + n[1] * n[1] + n[2] * n[2])) return 0.0f;
  double a = -(m[0] * v[0] + m[1] * v[1] + m[2] * v[2]), b = m[0] * u[0] + m[1] * u[1] + m[2] * u[2];
  double least = volume < 0.0 ? volume : 0.0, greatest = volume > 0.0 ? volume : 0.0;
  if (!(least <= a && a <= greatest && least <= b && b <= greatest)) return 0.0f;
  return (float)(-(o[0] * n[0] + o[1] * n[1] + o[2] * n[2]) / volume);
}

/* Moves a vector by a matrix of three columns. */
FUNCTION void transformed(GLOBAL const uint *columns, const float *v, float *out) {
  for (int i = 0; i < 3; i++)
    out[i] = FLOAT_OF(columns[i]) * v[0] + FLOAT_OF(columns[3 + i]) * v[1] + FLOAT_OF(columns[6 + i]) * v[2];
}

/* Returns where the ray hits a shape of a record; not a positive number for a miss. */
FUNCTION float shape(GLOBAL const uint *record, const Prepared *ray) {
  float in[15], out[1], *origin = in + 9, *direction = in + 12;
  for (int i = 0; i < 9; i++) in[i] = FLOAT_OF(record[2 + i]);
  if (record[0] == TRIANGLE) {
    float permuted[15];
    for (int k = 0; k < 3; k++)
      for (int i = 0; i < 3; i++) permuted[3 * k + i] = in[3 * k + ray->axes[i]];
    return triangle(ray, permuted);
  }
  if (record[1]) {
    transformed(record + 11, ray->origin, origin);
    for (int i = 0; i < 3; i++) origin[i] = origin[i] + FLOAT_OF(record[20 + i]);
    transformed(record + 11, ray->direction, direction);
  } else {
    for (int i = 0; i < 3; i++) {
      origin[i] = ray->origin[i];
      direction[i] = ray->direction[i];
    }
  }
  if (record[0] == RECTANGLE) return rectangle(in, origin, direction);
  shape_test(record[0], in, out);
  return out[0];
}

/* Reports a hit before the limit to the search. */
FUNCTION void found(const World *world, Search *search, int is_nearest, float t, uint primitive, uint instance) {
  if (!is_nearest) {
    if (search->ignored == NONE || world->primitives[2ul * primitive] != search->ignored) search->is_done = 1;
    return;
  }
  int is_first = instance < search->instance || (instance == search->instance && primitive < search->primitive);
  if (t < search->t || (t == search->t && is_first)) {
    search->t = t;
    search->primitive = primitive;
    search->instance = instance;
    search->limit = FLOAT_OF(BITS_OF(t) + 1u);
  }
}

/* An instance, whose mesh a ray traverses. */
typedef struct {
  const Prepared *ray; /* in render space */
  GLOBAL const uint *record;
} Placement;

/* InMesh::enters_box_before: a hit on a mesh counts only if the ray enters the instance's box before it. */
FUNCTION int enters_box_before(Placement placement, float t) {
  Prepared ray = *placement.ray;
  prepare(&ray, FLOAT_OF(placement.record[4]));
  float box[16], enter_and_exit[2];
  for (int i = 0; i < 3; i++) {
    int is_downward = (int)(ray.octant >> i & 1u);
    box[i] = FLOAT_OF(placement.record[(is_downward ? 8 : 5) + i]);
    box[3 + i] = FLOAT_OF(placement.record[(is_downward ? 5 : 8) + i]);
  }
  span(&ray, box, INFINITY, enter_and_exit);
  return enter_and_exit[0] < enter_and_exit[1] && enter_and_exit[0] < t;
}

/* Reports a hit on a triangle of an instance's mesh. */
FUNCTION void found_in_mesh(const World *world, Search *search, int is_nearest, Placement placement, float t, uint i) {
  if (enters_box_before(placement, t)) found(world, search, is_nearest, t, placement.record[3] + i, placement.record[1]);
}

/* Tests a triangle of an instance's mesh. */
FUNCTION void test_in_mesh(const World *world, const Prepared *ray, Search *search, int is_nearest, Placement placement,
                           uint i) {
  float t = shape(world->records + world->primitives[2ul * (placement.record[3] + i) + 1], ray);
  if (0.0f < t && t < search->limit) found_in_mesh(world, search, is_nearest, placement, t, i);
}
