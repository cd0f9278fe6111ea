/* Answers the query of a ray: finds the nearest hit, or any hit before a limit that does not belong to an object. */
SEPARATE_FUNCTION Search answer(World world, const float *origin, const float *direction, float limit, uint ignored,
                                int is_nearest) {
  Prepared ray;
  for (int i = 0; i < 3; i++) {
    ray.origin[i] = origin[i];
    ray.direction[i] = direction[i];
  }
  Search search = {limit, INFINITY, NONE, NONE, ignored, 0, 0u, 0u};
  Placement none = {&ray, world.records};
  search_world(&world, 0u, &ray, &search, is_nearest, none);
  return search;
}

/* Answers the query of a ray of `n`: `rays` has origin, direction, limit and ignored object, `out` the parameter of the hit
   (NONE without one; for occlusion 0), its primitive, its instance, the node visits and the primitive tests. */
FUNCTION void answer_ray(World world, GLOBAL const float *rays, GLOBAL uint *out, uint n, int is_nearest) {
  uint id = (uint)ID;
  if (id >= n) return;
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

#define WORLD_ARRAYS                                                                                            \
  GLOBAL const float *lines, GLOBAL const uint *levels, GLOBAL const uint *unbounded,                            \
      GLOBAL const uint *primitives, GLOBAL const uint *records
#define WORLD {lines, levels, unbounded, primitives, records}
#define ANSWER(is_nearest) { World world = WORLD; answer_ray(world, rays, out, n, is_nearest); }

KERNEL void nearest(WORLD_ARRAYS, GLOBAL const float *rays, GLOBAL uint *out, uint n) ANSWER(1)
KERNEL void occluded(WORLD_ARRAYS, GLOBAL const float *rays, GLOBAL uint *out, uint n) ANSWER(0)
