
/* Answers the query of a ray: finds the nearest hit, or any hit before a limit that does not belong to an object. */
SEPARATE_FUNCTION Search answer(World world, const float *origin, const float *direction, float limit, uint ignored,
                                int is_nearest) {
  Prepared ray;
  for (int i = 0; i < 3; i++) {
    ray.origin[i] = origin[i];
    ray.direction[i] = direction[i];
  }
  Search search;
  search.t = INFINITY;
  search.limit = limit;
  search.primitive = NONE;
  search.instance = NONE;
  search.ignored = ignored;
  search.is_done = 0;
  search.n_visits = 0u;
  search.n_tests = 0u;
  Placement none;
  none.ray = &ray;
  none.record = world.records;
  search_world(&world, 0u, &ray, &search, is_nearest, none);
  return search;
}

/* Answers the query of ray `id`: `rays` has origin, direction, limit and ignored object, `out` the parameter of the hit
   (NONE without one; for occlusion 0), its primitive, its instance, the node visits and the primitive tests. */
FUNCTION void answer_ray(World world, GLOBAL const float *rays, GLOBAL uint *out, uint id, int is_nearest) {
  float ray[7];
  for (int i = 0; i < 7; i++) ray[i] = rays[8ul * id + i];
  Search search = answer(world, ray, ray + 3, ray[6], BITS_OF(rays[8ul * id + 7]), is_nearest);
  int is_hit = is_nearest ? search.t < INFINITY : search.is_done;
  out[5ul * id] = !is_hit ? NONE : is_nearest ? BITS_OF(search.t) : 0u;
  out[5ul * id + 1] = search.primitive;
  out[5ul * id + 2] = search.instance;
  out[5ul * id + 3] = search.n_visits;
  out[5ul * id + 4] = search.n_tests;
}

FUNCTION World make_world(GLOBAL const float *lines, GLOBAL const uint *levels, GLOBAL const uint *unbounded,
                          GLOBAL const uint *primitives, GLOBAL const uint *records) {
  World world;
  world.lines = lines;
  world.levels = levels;
  world.unbounded = unbounded;
  world.primitives = primitives;
  world.records = records;
  return world;
}

#define PARAMETERS                                                                                              \
  GLOBAL const float *lines, GLOBAL const uint *levels, GLOBAL const uint *unbounded,                            \
      GLOBAL const uint *primitives, GLOBAL const uint *records, GLOBAL const float *rays, GLOBAL uint *out,     \
      uint n
#define ANSWER(is_nearest)                                                                                      \
  {                                                                                                             \
    uint id = (uint)ID;                                                                                         \
    if (id >= n) return;                                                                                        \
    answer_ray(make_world(lines, levels, unbounded, primitives, records), rays, out, id, is_nearest);           \
  }

KERNEL void nearest(PARAMETERS) ANSWER(1)
KERNEL void occluded(PARAMETERS) ANSWER(0)
