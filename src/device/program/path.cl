
/* Whole paths: from the camera ray to the end, as the waves of src/tracer/shade follow them. The functions point,
   own_light, light, shadow, reflected, next_ray, late_ray, background and flight are recorded (paths.rs). They read the state
   of a path by its slots: ORIGIN, DIRECTION, and so on. */

/* The cost of a path. */
typedef struct {
  uint n_visits, n_tests;
  uint n_shadows;
  uint n_rays[3]; /* reflected, refracted and diffuse rays */
  uint bounces[N_BOUNCES];
} PathCost;

/* Counts a ray at a bounce. */
FUNCTION void count_ray(PathCost *cost, uint depth) { cost->bounces[depth < N_BOUNCES ? depth : N_BOUNCES - 1u]++; }

/* Searches for the ray of a path, and counts its steps. */
FUNCTION Search search_path(World world, const float *origin, const float *direction, float limit, uint ignored,
                            int is_nearest, PathCost *cost) {
  Search search = answer(world, origin, direction, limit, ignored, is_nearest);
  cost->n_visits += search.n_visits;
  cost->n_tests += search.n_tests;
  return search;
}

/* Adds weighted light to a color. */
FUNCTION void add(float *color, const float *light, const float *weight) {
  for (int i = 0; i < 3; i++) color[i] += light[i] * weight[i];
}

KERNEL void path(GLOBAL const float *lines, GLOBAL const uint *levels, GLOBAL const uint *unbounded,
                 GLOBAL const uint *primitives, GLOBAL const uint *records, GLOBAL const uint *surfaces,
                 GLOBAL const uint *all_data, GLOBAL const uint *places, GLOBAL const uint *tables,
                 GLOBAL const uint *in, GLOBAL uint *out, uint n) {
  uint id = (uint)ID;
  if (id >= n) return;
  World world = make_world(lines, levels, unbounded, primitives, records);
  float s[N_SLOTS], color[3];
  in += 12ul * id;
  for (uint i = 0; i < 6u; i++) s[ORIGIN + i] = FLOAT_OF(in[i]);
  s[PIXEL] = FLOAT_OF(in[6]);
  s[SAMPLE] = FLOAT_OF(in[7]);
  Media media;
  for (uint i = 0; i < N_MEDIA; i++) media.ids[i] = in[8u + i];
  s[DENSITY] = INFINITY;
  for (uint i = 0; i < 3u; i++) {
    s[EYE + i] = s[ORIGIN + i];
    s[WEIGHT + i] = 1.0f;
    color[i] = 0.0f;
  }
  PathCost cost;
  cost.n_visits = cost.n_tests = cost.n_shadows = 0u;
  for (uint i = 0; i < 3u; i++) cost.n_rays[i] = 0u;
  for (uint i = 0; i < N_BOUNCES; i++) cost.bounces[i] = 0u;
  GLOBAL uint *result = out + (ulong)N_RESULTS * id;

  uint depth = 0u;
  for (;;) {
    /* Find the point that the ray hits. */
    Search search = search_path(world, s + ORIGIN, s + DIRECTION, INFINITY, NONE, 1, &cost);
    int is_hit = search.t < INFINITY;
    if (depth == 0u) {
      result[3] = is_hit ? BITS_OF(search.t) : NONE;
      result[4] = search.primitive;
      result[5] = search.instance;
    }
    float light_of_ray[3];
    s[T] = search.t;
    s[DIMENSION] = FLOAT_OF(FIRST_DIMENSION + depth * DIMENSION_STEP);
    if (HAS_FOG && media.ids[0] == 0u) {
      /* A particle of fog may lie before the hit. */
      float met[2];
      flight(s, all_data, places, tables, met);
      if (met[0] != 0.0f) {
        is_hit = 1;
        search.primitive = PARTICLES;
        search.instance = 0u;
        s[T] = met[1];
      }
    }
    if (HAS_MEDIA) weaken(tables, &media, s[T], s + WEIGHT);
    if (!is_hit) {
      background(s, all_data, places, tables, light_of_ray);
      add(color, light_of_ray, s + WEIGHT);
      break;
    }
    uint kind = surfaces[2ul * search.primitive];
    GLOBAL const uint *data = all_data + surfaces[2ul * search.primitive + 1];
    GLOBAL const uint *place = places + (search.instance ? (ulong)N_PLACE * (search.instance - 1u) : 0ul);
    point(kind, s, data, place, tables, s + POINT);
    /* The media on both sides. */
    Interface met;
    uint medium = HAS_MEDIA ? media_of_kinds[kind] : 0u;
    if (HAS_MEDIA) s[CROSSING + 2u] = s[CROSSING + 3u] = index_in(tables, &media);
    if (medium) {
      met = cross_surface(tables, &media, medium, s[SIDE] > 0.0f);
      s[CROSSING] = met.eta;
      s[CROSSING + 1u] = met.is_visible ? 1.0f : 0.0f;
      s[CROSSING + 3u] = index_in(tables, &met.behind);
    }
    /* Its light: its own, then one light sample after the other. */
    own_light(kind, s, data, place, tables, light_of_ray);
    int is_lit = !NEEDS_LIGHT;
    uint n_lights = LIT_KINDS >> kind & 1ul && (LIGHTS_LAST_POINTS || depth < MAX_DEPTH) ? N_LIGHTS : 0u;
    for (uint i = 0; i < n_lights; i++) {
      float cast[5], arriving[3];
      light(i, s, data, place, tables, s + LIGHT);
      if (HAS_MEDIA) {
        const Media *way = medium && s[LIGHT + 8u] != 0.0f ? &met.behind : &media;
        weaken(tables, way, s[LIGHT + 3u], s + LIGHT + 4);
      }
      shadow(kind, s, data, place, tables, cast);
      if (cast[0] == 0.0f) continue;
      if (CASTS_SHADOWS) {
        cost.n_shadows++;
        count_ray(&cost, depth);
        uint ignored = IGNORES_OWN_OBJECT ? primitives[2ul * search.primitive] : NONE;
        Search way = search_path(world, cast + 1, s + LIGHT, cast[4], ignored, 0, &cost);
        if (way.is_done) continue;
      }
      is_lit = 1;
      reflected(kind, s, data, place, tables, arriving);
      for (int k = 0; k < 3; k++) light_of_ray[k] += arriving[k];
    }
    if (!is_lit) break;
    add(color, light_of_ray, s + WEIGHT);
    /* The next ray. */
    if (depth >= MAX_DEPTH || !(CONTINUING_KINDS >> kind & 1ul)) break;
    float ray[12];
    if (depth < LATE_DEPTH)
      next_ray(kind, s, data, place, tables, ray);
    else
      late_ray(kind, s, data, place, tables, ray);
    if (ray[0] == 0.0f) break;
    depth++;
    uint kind_of_ray = ray[1] == 0.0f ? 0u : ray[1] == 1.0f ? 1u : 2u;
    for (uint i = 0; i < 3u; i++) cost.n_rays[i] += (uint)(i == kind_of_ray);
    count_ray(&cost, depth);
    if (medium && kind_of_ray == 1u) media = met.behind;
    for (uint i = 0; i < 6u; i++) s[ORIGIN + i] = ray[2u + i];
    for (uint i = 0; i < 3u; i++) s[WEIGHT + i] = ray[8u + i];
    s[DENSITY] = ray[11];
  }
  for (uint i = 0; i < 3u; i++) result[i] = BITS_OF(color[i]);
  result[6] = cost.n_visits;
  result[7] = cost.n_tests;
  result[8] = cost.n_shadows;
  for (uint i = 0; i < 3u; i++) result[9u + i] = cost.n_rays[i];
  result[12] = depth;
  for (uint i = 0; i < N_BOUNCES; i++) result[13u + i] = cost.bounces[i];
}
