// tinybvh's fastest hierarchy for single rays on the CPU, as C functions over batches of rays.
// tinybvh.rs compiles this file with the folder of tiny_bvh.h among the includes.
#define TINYBVH_IMPLEMENTATION
#include <cstdint>

#include "tiny_bvh.h"

using namespace tinybvh;

// A ray from origin x, y, z along direction x, y, z.
static Ray ray_along(const float *ray, float t_max) {
    return Ray(bvhvec3(ray[0], ray[1], ray[2]), bvhvec3(ray[3], ray[4], ray[5]), t_max);
}

extern "C" {

// Major, minor and patch.
void tinybvh_version(uint32_t *version) {
    version[0] = TINY_BVH_VERSION_MAJOR;
    version[1] = TINY_BVH_VERSION_MINOR;
    version[2] = TINY_BVH_VERSION_SUB;
}

// Builds the hierarchy of triangles, each three vertices of four floats, with spatial splits if
// `is_high`.
BVH8_CPU *tinybvh_build(const float *vertices, uint32_t n_triangles, bool is_high) {
    BVH8_CPU *bvh = new BVH8_CPU;
    const bvhvec4 *corners = reinterpret_cast<const bvhvec4 *>(vertices);
    is_high ? bvh->BuildHQ(corners, n_triangles) : bvh->Build(corners, n_triangles);
    return bvh;
}

void tinybvh_release(BVH8_CPU *bvh) { delete bvh; }

// Sets `triangle` to the nearest one, and returns the distance: BVH_FAR without a hit.
float tinybvh_nearest(const BVH8_CPU *bvh, const float *ray, uint32_t *triangle) {
    Ray traced = ray_along(ray, BVH_FAR);
    bvh->Intersect(traced);
    *triangle = traced.hit.prim;
    return traced.hit.t;
}

bool tinybvh_any(const BVH8_CPU *bvh, const float *ray, float t_max) {
    return bvh->IsOccluded(ray_along(ray, t_max));
}
}
