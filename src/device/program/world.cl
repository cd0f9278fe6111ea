/* Tests a primitive of the upper level: a shape, or the mesh of an instance. */
FUNCTION void test_in_world(const World *world, Prepared *ray, Search *search, int is_nearest, uint i) {
  GLOBAL const uint *record = world->records + world->primitives[2ul * i + 1];
#ifdef MESH_STACK
  if (record[0] == INSTANCE) {
    Prepared moved;
    float from_position[3];
    for (int k = 0; k < 3; k++) from_position[k] = ray->origin[k] - FLOAT_OF(record[20 + k]);
    transformed(record + 11, from_position, moved.origin);
    transformed(record + 11, ray->direction, moved.direction);
    Placement placement = {ray, record};
    search_mesh(world, record[2], &moved, search, is_nearest, placement);
    return;
  }
#endif
  float t = shape(record, ray);
  if (0.0f < t && t < search->limit) found(world, search, is_nearest, t, i, 0u);
}
