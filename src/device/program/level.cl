/* Searches one level of the structure: TRAVERSE names the function, STACK is the size of its stack, TEST(i) tests
   the primitive with index i of the level, FOUND(t, i) reports a hit on it. */
FUNCTION void TRAVERSE(const World *world, uint number, Prepared *ray, Search *search, int is_nearest,
                       Placement placement) {
  GLOBAL const uint *level = world->levels + 5u * number;
  prepare(ray, FLOAT_OF(level[1]));
  /* The primitives outside the hierarchy. */
  COUNT(search->n_tests, level[3]);
  for (uint i = 0; i < level[3]; i++) TEST(world->unbounded[level[2] + i]);
  if (level[4] == 0u || search->is_done) return;

  GLOBAL const float *lines = world->lines + 16ul * level[0];
  uint stack[STACK];
  float enters[STACK];
  int top = 1;
  stack[0] = END;
  enters[0] = -INFINITY;
  uint current = 0u;
  for (;;) {
    GLOBAL const float *line = lines + 16ul * (current >> 5);
    uint next = END;
    if (current & 3u) {
      /* At a leaf: test its primitives; an occlusion search may end here. */
      uint n = (current >> 2 & 7u) + 1u, kind = current & 3u;
      if (kind == 3u && (BITS_OF(line[0]) & CAPSULE_BIT)) kind = 4u;
      COUNT(search->n_tests, n);
      for (uint i = 0; i < n; i++) {
        float in[15], out[1];
        uint id_row = 0u;
        if (kind == 1u) {
          for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++) in[3 * k + axis] = line[(3u * k + ray->axes[axis]) * n + i];
          out[0] = triangle(ray, in);
          id_row = 9u;
        } else if (kind == 2u) {
          for (uint k = 0; k < 4u; k++) in[k] = line[k * n + i];
          for (int k = 0; k < 3; k++) {
            in[4 + k] = ray->origin[k];
            in[7 + k] = ray->direction[k];
          }
          in[10] = ray->squared[0];
          in[11] = ray->squared[1];
          sphere_test(in, out);
          id_row = 4u;
        } else if (kind == 4u) {
          for (uint k = 0; k < 8u; k++) in[k] = line[(k + 1u) * n + i];
          in[8] = 0.0f;
          for (int k = 0; k < 3; k++) {
            in[9 + k] = ray->origin[k];
            in[12 + k] = ray->direction[k];
          }
          shape_test(CAPSULE, in, out);
        }
        uint id = BITS_OF(line[id_row * n + i]) & ~(ID_BIT | CAPSULE_BIT);
        if (kind == 3u) {
          TEST(id);
        } else if (0.0f < out[0] && out[0] < search->limit) {
          FOUND(out[0], id);
        }
      }
      if (search->is_done) return;
    } else {
      /* At a node: test its children, push those that are entered, the nearest last. */
      COUNT(search->n_visits, 1u);
      uint entered = 0u;
      float enter[8];
      for (uint i = 0; i < 8u; i++) {
        float box[16], enter_and_exit[2];
        for (uint axis = 0; axis < 3u; axis++) {
          uint is_downward = ray->octant >> axis & 1u;
          box[axis] = line[8u * (axis + 3u * is_downward) + i];
          box[3u + axis] = line[8u * (axis + 3u * (1u - is_downward)) + i];
        }
        span(ray, box, search->limit, enter_and_exit);
        enter[i] = enter_and_exit[0];
        entered |= (uint)(enter_and_exit[0] < enter_and_exit[1]) << i;
      }
      for (uint i = 0; i < 8u && entered; i++) {
        uint child = is_nearest ? BITS_OF(line[56u + i]) >> (3u * ray->octant) & 7u : i;
        if (entered >> child & 1u) {
          stack[top] = BITS_OF(line[48u + child]);
          enters[top] = enter[child];
          top++;
        }
      }
      if (entered) next = stack[--top];
    }
    /* Pop, skipping children past the nearest hit. */
    if (next == END) {
      do {
        next = stack[--top];
      } while (is_nearest && enters[top] >= search->limit);
      if (next == END) return;
    }
    current = next;
  }
}
