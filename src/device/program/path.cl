/* Whole paths: from the camera ray to the end, as the waves of src/tracer/shade follow them. The functions point,
   own_light, light, shadow, reflected, next_ray, late_ray, split, passage, background, flight and fade are recorded
   (paths.rs). They read the state of a path by its slots: ORIGIN, DIRECTION, and so on. */

/* Places for rays that continue a path that splits, and for what its rays add. */
#define MAX_PENDING (SPLITS ? MAX_DEPTH + 1u : 1u)
#define MAX_KEPT (SPLITS ? 32u : 1u)

/* The rules at a kind of surfaces; above their bits, the material of its medium plus 1. */
#define IS_LIT 1u
#define CONTINUES 2u
#define IS_OPEN 4u
#define IS_VEIL 8u
#define MEDIUM_SHIFT 4u

/* All arrays of a scene. */
typedef struct {
  World world;
  GLOBAL const uint *surfaces, *data, *places, *tables;
} Scene;

/* The cost of a path. */
typedef struct {
  uint n_visits, n_tests;
  uint n_shadows;
  uint n_rays[3]; /* reflected, refracted and diffuse rays */
  uint depth;
  uint bounces[N_BOUNCES];
} PathCost;

/* A path at one of its rays. */
typedef struct {
  float state[N_SLOTS];
  Media media;
  uint depth;
  uint kind; /* of the ray: 0 to 2 as in the cost */
} Path;

/* A ray that continues a path later. */
typedef struct {
  float state[10]; /* origin, direction, weight and length */
  Media media;
  uint depth, kind;
} Pending;

/* Light that a path's ray adds to its color. */
typedef struct {
  float light[3];
  uint depth;
} Kept;

/* Counts a ray at a bounce. */
FUNCTION void count_ray(PathCost *cost, uint depth) {
  COUNT(cost->bounces[depth < N_BOUNCES ? depth : N_BOUNCES - 1u], 1u);
}

/* Searches for a ray, and counts its steps. */
FUNCTION Search search_path(const Scene *scene, const float *origin, const float *direction, float limit, uint ignored,
                            int is_nearest, PathCost *cost) {
  Search search = answer(scene->world, origin, direction, limit, ignored, is_nearest);
  COUNT(cost->n_visits, search.n_visits);
  COUNT(cost->n_tests, search.n_tests);
  return search;
}

/* The kind of the surface that was hit, its rules, its numbers, and the numbers of its instance. */
FUNCTION uint kind_of(const Scene *scene, const Search *hit) { return scene->surfaces[2ul * hit->primitive]; }
FUNCTION uint rules_of(const Scene *scene, uint kind) { return scene->tables[FIRST_KIND + kind]; }
FUNCTION GLOBAL const uint *data_of(const Scene *scene, const Search *hit) {
  return scene->data + scene->surfaces[2ul * hit->primitive + 1];
}
FUNCTION GLOBAL const uint *place_of(const Scene *scene, const Search *hit) {
  return scene->places + (hit->instance ? (ulong)N_PLACE * (hit->instance - 1u) : 0ul);
}

/* Searches for the nearest surface that a ray does not pass: src/tracer/trace/openings.rs. Of the light of a shadow ray,
   `share` is left. */
FUNCTION Search search_past(const Scene *scene, const float *origin, const float *direction, float limit, int is_shadow,
                            PathCost *cost, float *share) {
  float rest[T + 1u], length = 0.0f;
  *share = 1.0f;
  for (int i = 0; i < 3; i++) {
    rest[ORIGIN + i] = origin[i];
    rest[DIRECTION + i] = direction[i];
  }
  for (;;) {
    Search search = search_path(scene, rest + ORIGIN, rest + DIRECTION, INFINITY, NONE, 1, cost);
    if (!(search.t < INFINITY)) return search;
    rest[T] = search.t;
    search.t = length + search.t;
    uint kind = kind_of(scene, &search);
    if (!HAS_OPENINGS || !(rules_of(scene, kind) & IS_OPEN) || search.t >= limit) return search;
    float past[6];
    passage(kind, rest, data_of(scene, &search), place_of(scene, &search), scene->tables, past);
    float left = *share * (is_shadow ? past[0] : past[1]), next = length + past[5];
    /* By rounding errors, a ray along the surface may not advance: it ends there. */
    if (left <= 0.0f || !(next > length)) return search;
    *share = left;
    length = next;
    for (int i = 0; i < 3; i++) rest[ORIGIN + i] = past[2 + i];
  }
}

/* Adds the light samples of a point to its light; returns 1 if any arrives. */
FUNCTION int add_lights(const Scene *scene, Path *path, const Search *hit, const Interface *met, PathCost *cost,
                        float *light_of_ray) {
  float *s = path->state;
  uint kind = kind_of(scene, hit);
  GLOBAL const uint *data = data_of(scene, hit), *place = place_of(scene, hit), *tables = scene->tables;
  int is_lit = 0;
  for (uint i = 0; i < N_LIGHTS; i++) {
    float cast[5], arriving[3], share = 1.0f;
    light(i, s, data, place, tables, s + LIGHT);
    if (WEAKENS_LIGHTS) {
      const Media *way = rules_of(scene, kind) >> MEDIUM_SHIFT && s[LIGHT + 8u] != 0.0f ? &met->behind : &path->media;
      weaken(tables, way, s[LIGHT + 3u], s + LIGHT + 4);
    }
    shadow(kind, s, data, place, tables, cast);
    if (cast[0] == 0.0f) continue;
    if (CASTS_SHADOWS) {
      COUNT(cost->n_shadows, 1u);
      count_ray(cost, path->depth);
      if (HAS_OPENINGS) {
        Search way = search_past(scene, cast + 1, s + LIGHT, cast[4], 1, cost, &share);
        if (way.t < cast[4] || share <= 0.0f) continue;
      } else {
        uint ignored = IGNORES_OWN_OBJECT ? scene->world.primitives[2ul * hit->primitive] : NONE;
        Search way = search_path(scene, cast + 1, s + LIGHT, cast[4], ignored, 0, cost);
        if (way.is_done) continue;
      }
    }
    is_lit = 1;
    for (int k = 0; k < 3; k++) s[LIGHT + 4 + k] *= share;
    reflected(kind, s, data, place, tables, arriving);
    for (int k = 0; k < 3; k++) light_of_ray[k] += arriving[k];
  }
  return is_lit;
}

/* Continues a path with the ray of these numbers: origin, direction and weight. */
FUNCTION void continue_path(Path *path, const float *ray, uint kind, const Media *media) {
  for (uint i = 0; i < 9u; i++) path->state[ORIGIN + i] = ray[i];
  path->state[LENGTH] += path->state[T];
  path->media = *media;
  path->depth++;
  path->kind = kind;
}

/* Follows the ray of a path to the point that it hits; `added` is what it adds to the color. Returns 1 if another ray
   continues the path, which is its next ray; 3 if it splits, and `other` continues it, too. `first` is its hit. */
FUNCTION uint follow_ray(const Scene *scene, Path *path, PathCost *cost, float *added, Search *first, Pending *other) {
  float *s = path->state, light_of_ray[3], gained[4] = {0.0f};
  GLOBAL const uint *tables = scene->tables;
  float share;
  Search hit = *first = search_past(scene, s + ORIGIN, s + DIRECTION, INFINITY, 0, cost, &share);
  for (int i = 0; i < 3; i++) added[i] = 0.0f;
  int is_hit = hit.t < INFINITY;
  s[T] = hit.t;
  s[DIMENSION] = FLOAT_OF(FIRST_DIMENSION + path->depth * DIMENSION_STEP);
  if (PARTICLES != NONE && path->media.ids[0] == 0u) {
    /* A particle of fog may lie before the hit. */
    float met[2];
    flight(0u, s, scene->data, scene->places, tables, met);
    if (met[0] != 0.0f) {
      is_hit = 1;
      hit.primitive = PARTICLES;
      hit.instance = 0u;
      s[T] = met[1];
    }
  }
  /* Media and fog weaken the light on the way; fog adds some. */
  if (HAS_MEDIA) weaken(tables, &path->media, s[T], s + WEIGHT);
  if (HAS_FADING_FOG && path->media.ids[0] == 0u) {
    fade(0u, s, scene->data, scene->places, tables, gained);
    for (int i = 0; i < 3; i++) {
      gained[1 + i] *= s[WEIGHT + i];
      s[WEIGHT + i] *= gained[0];
    }
  }
  if (!is_hit) {
    background(0u, s, scene->data, scene->places, tables, light_of_ray);
    for (int i = 0; i < 3; i++) added[i] = light_of_ray[i] * s[WEIGHT + i] + gained[1 + i];
    return 0u;
  }
  uint kind = kind_of(scene, &hit);
  GLOBAL const uint *data = data_of(scene, &hit), *place = place_of(scene, &hit);
  point(kind, s, data, place, tables, s + POINT);
  /* The media on both sides. */
  Interface met;
  uint rules = rules_of(scene, kind), medium = HAS_MEDIA ? rules >> MEDIUM_SHIFT : 0u;
  if (HAS_MEDIA) s[CROSSING + 2u] = s[CROSSING + 3u] = index_in(tables, &path->media);
  if (medium) {
    met = cross_surface(tables, &path->media, medium, s[SIDE] > 0.0f);
    s[CROSSING] = met.eta;
    s[CROSSING + 1u] = met.is_visible ? 1.0f : 0.0f;
    s[CROSSING + 3u] = index_in(tables, &met.behind);
  } else {
    met.behind = path->media;
  }
  /* Its light: its own, then one light sample after the other. */
  int is_lit = !NEEDS_LIGHT, has_lights = LIGHTS_LAST_POINTS || path->depth < MAX_DEPTH;
  own_light(kind, s, data, place, tables, light_of_ray);
  if (has_lights && (rules & IS_LIT) != 0u) is_lit |= add_lights(scene, path, &hit, &met, cost, light_of_ray);
  if (!is_lit) return 0u;
  float opacity = SPLITS ? s[OPACITY] : 1.0f;
  for (int i = 0; i < 3; i++) added[i] = light_of_ray[i] * (s[WEIGHT + i] * opacity) + gained[1 + i];
  /* The next rays. */
  int may_bounce = path->depth < MAX_DEPTH && (rules & CONTINUES) != 0u;
#if SPLITS
  float rays[20];
  if (!may_bounce && !(rules & IS_VEIL)) return 0u;
  split(kind, s, data, place, tables, rays);
  int is_reflected = may_bounce && rays[0] != 0.0f, passes = rays[10] != 0.0f;
  if (is_reflected && passes) {
    for (uint i = 0; i < 9u; i++) other->state[i] = rays[11u + i];
    other->state[9] = s[LENGTH] + s[T];
    other->media = met.behind;
    other->depth = path->depth + 1u;
    other->kind = 1u;
  }
  if (is_reflected)
    continue_path(path, rays + 1, 0u, &path->media);
  else if (passes)
    continue_path(path, rays + 11, 1u, &met.behind);
  return (uint)(is_reflected || passes) + 2u * (uint)(is_reflected && passes);
#else
  if (!may_bounce) return 0u;
  float ray[12];
  if (path->depth < LATE_DEPTH)
    next_ray(kind, s, data, place, tables, ray);
  else
    late_ray(kind, s, data, place, tables, ray);
  if (ray[0] == 0.0f) return 0u;
  uint kind_of_ray = ray[1] == 0.0f ? 0u : ray[1] == 1.0f ? 1u : 2u;
  s[DENSITY] = ray[11];
  continue_path(path, ray + 2, kind_of_ray, medium && kind_of_ray == 1u ? &met.behind : &path->media);
  return 1u;
#endif
}

/* Resumes a path with another ray. */
FUNCTION void resume(Path *path, const Pending *ray) {
  for (uint i = 0; i < 10u; i++) path->state[ORIGIN + i] = ray->state[i];
  path->media = ray->media;
  path->depth = ray->depth;
  path->kind = ray->kind;
}

/* Keeps what a ray adds. If there are too many, the deepest go, and `last` is the depth above them. */
FUNCTION void keep(Kept *kept, uint *n_kept, const float *added, uint depth, uint *last) {
  if (depth > *last || (added[0] == 0.0f && added[1] == 0.0f && added[2] == 0.0f)) return;
  if (*n_kept == MAX_KEPT) {
    uint deepest = depth, n = 0u;
    for (uint i = 0; i < MAX_KEPT; i++)
      if (kept[i].depth > deepest) deepest = kept[i].depth;
    *last = deepest - 1u;
    for (uint i = 0; i < MAX_KEPT; i++)
      if (kept[i].depth < deepest) kept[n++] = kept[i];
    *n_kept = n;
    if (depth == deepest) return;
  }
  for (uint i = 0; i < 3u; i++) kept[*n_kept].light[i] = added[i];
  kept[(*n_kept)++].depth = depth;
}

/* Starts a path with its camera ray. */
FUNCTION void start(Path *path, GLOBAL const uint *in) {
  float *s = path->state;
  for (uint i = 0; i < 6u; i++) s[ORIGIN + i] = FLOAT_OF(in[i]);
  s[PIXEL] = FLOAT_OF(in[6]);
  s[SAMPLE] = FLOAT_OF(in[7]);
  for (uint i = 0; i < N_MEDIA; i++) path->media.ids[i] = in[8u + i];
  s[DENSITY] = INFINITY;
  s[LENGTH] = 0.0f;
  for (uint i = 0; i < 3u; i++) {
    s[EYE + i] = s[ORIGIN + i];
    s[WEIGHT + i] = 1.0f;
  }
  path->depth = 0u;
}

KERNEL void path(WORLD_ARRAYS, GLOBAL const uint *surfaces, GLOBAL const uint *all_data, GLOBAL const uint *places,
                 GLOBAL const uint *tables, GLOBAL const uint *in, GLOBAL uint *out, uint n) {
  uint id = (uint)ID;
  if (id >= n) return;
  Scene scene = {WORLD, surfaces, all_data, places, tables};
  GLOBAL uint *result = out + (ulong)N_RESULTS * id;
  ulong begin = CYCLES, begin_ns = TIME;
  PathCost cost, no_cost = {0u};
  float color[3] = {0.0f};

  /* The rays of a path add to its color in the order of their bounces. One that splits is followed depth first, and keeps
     what rays below `level` add. Where it does not fit, the rays below `last` follow in another pass. */
  for (uint level = 0u, last;; level = last + 1u) {
    Path path;
    Pending pending[MAX_PENDING];
    Kept kept[MAX_KEPT];
    uint n_pending = 0u, n_kept = 0u;
    last = NONE;
    cost = no_cost;
    start(&path, in + 12ul * id);
    for (;;) {
      uint depth = path.depth;
      if (depth != 0u) {
        COUNT(cost.n_rays[path.kind], 1u);
        count_ray(&cost, depth);
        if (depth > cost.depth) cost.depth = depth;
      }
      Search first;
      float added[3];
      uint next = follow_ray(&scene, &path, &cost, added, &first, pending + n_pending);
      if (depth == 0u) {
        result[3] = first.t < INFINITY ? BITS_OF(first.t) : NONE;
        result[4] = first.primitive;
        result[5] = first.instance;
      }
      if (!SPLITS || depth == level)
        for (uint i = 0; i < 3u; i++) color[i] += added[i];
      else if (depth > level)
        keep(kept, &n_kept, added, depth, &last);
      if (SPLITS && depth >= last) next = 0u;
      if (next == 3u) n_pending++;
      if (next) continue;
      if (n_pending == 0u) break;
      resume(&path, pending + --n_pending);
    }
    for (uint depth = level + 1u, n = 0u; n < n_kept; depth++)
      for (uint i = 0; i < n_kept; i++)
        if (kept[i].depth == depth) {
          for (uint k = 0; k < 3u; k++) color[k] += kept[i].light[k];
          n++;
        }
    if (last == NONE) break;
  }
  for (uint i = 0; i < 3u; i++) result[i] = BITS_OF(color[i]);
  result[6] = cost.n_visits;
  result[7] = cost.n_tests;
  result[8] = cost.n_shadows;
  for (uint i = 0; i < 3u; i++) result[9u + i] = cost.n_rays[i];
  result[12] = cost.depth;
  for (uint i = 0; i < N_BOUNCES; i++) result[13u + i] = cost.bounces[i];
  ulong cycles = CYCLES - begin, ns = TIME - begin_ns;
  result[N_RESULTS - 5u] = (uint)begin_ns;
  result[N_RESULTS - 4u] = (uint)(begin_ns >> 32);
  result[N_RESULTS - 3u] = ns < NONE ? (uint)ns : NONE;
  result[N_RESULTS - 2u] = cycles < NONE ? (uint)cycles : NONE;
  result[N_RESULTS - 1u] = SM;
}
