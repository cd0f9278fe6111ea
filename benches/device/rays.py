"""Races the rays of a device with NVIDIA Warp's: rays.py PROGRAM DEVICE WARP_DEVICE FILE [--triangles N ...]

Camera rays of 1920 x 1080 pixels on a bumpy sphere, diffuse rays from their hits, and shadow rays to a light:
rays per second of kernels by the device's clock, raycost's with counters, in scenes whose rays it traces one
stream after the other; Warp's by `mesh_query_ray`. FILE gets the rates. Needs Warp (PyPI's warp-lang).
"""

import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np
import warp as wp

WIDTH, HEIGHT, FOV_Y_DEG = 1920, 1080, 40
EYE, LIGHT = np.array([0.0, 0.0, 3.2]), np.array([4.0, 5.0, 4.0])
N_ROUNDS = 5
# Scenes whose surfaces the processor shades: an exponent above 2^31, and a choice among more than 32 lights.
DIRECT = "shading: { ambient: 0, max_depth: 0 }\nmaterials: { clay: { color: 0.8, specular: 0.1, exponent: 3.0e9 } }\n"
PATHS = "shading: { model: path, max_depth: 1 }\nmaterials: { clay: { color: 0.8 } }\n"


def bumpy_sphere(n_triangles):
    """Points and triangles of a sphere with bumps: a grid of latitudes and longitudes."""
    n = round((n_triangles / 2) ** 0.5)
    v, u = np.meshgrid(np.linspace(0, np.pi, n + 1), np.linspace(0, 2 * np.pi, n + 1), indexing="ij")
    radius = 1 + 0.02 * np.sin(40 * u) * np.sin(40 * v)
    points = np.stack([radius * np.sin(v) * np.cos(u), radius * np.cos(v), radius * np.sin(v) * np.sin(u)], axis=-1)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    a, b, c, d = corner, corner + 1, corner + n + 2, corner + n + 1
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return points.reshape(-1, 3).astype("<f4"), triangles.astype("<i4")


def write_ply(path, points, triangles):
    faces = np.empty(len(triangles), dtype=[("n", "u1"), ("corners", "<i4", 3)])
    faces["n"], faces["corners"] = 3, triangles
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property float {axis}" for axis in "xyz"]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header", ""]
    path.write_bytes("\n".join(header).encode() + points.tobytes() + faces.tobytes())


def raycost_rates(program, device, folder):
    """Rays per second by kind."""

    def kernels(surfaces, n_lights):
        light = f"{{ point: {{ position: {LIGHT.tolist()}, intensity: {1 / n_lights} }} }}"
        (folder / "scene.yaml").write_text(f"""
image: {{ width: {WIDTH}, height: {HEIGHT} }}
camera: {{ look_at: {{ eye: {EYE.tolist()}, target: [0, 0, 0], fov_y_deg: {FOV_Y_DEG} }} }}
lights: [{", ".join([light] * n_lights)}]
objects: [{{ mesh: {{ file: sphere.ply, normals: flat }}, material: clay }}]
""" + surfaces)
        command = [program, "render", folder / "scene.yaml", "--out", folder / "out", "--quiet", "--cost=counters"]
        command += [f"--device={device}", "--tile-size=256", "--threads=1"]
        runs = []
        for _ in range(N_ROUNDS):
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            found = json.loads((folder / "out/summary.json").read_text())["acceleration"]["kernels"]
            runs.append({kernel["name"]: (kernel["rays"], kernel["seconds"]) for kernel in found})
        return {name: (runs[0][name][0], min(run[name][1] for run in runs)) for name in runs[0]}

    direct, paths = kernels(DIRECT, 1), kernels(PATHS, 33)
    n_diffuse, s_diffuse = (both - camera for both, camera in zip(paths["nearest"], direct["nearest"]))
    return {
        "primary": direct["nearest"][0] / direct["nearest"][1],
        "diffuse": n_diffuse / s_diffuse,
        "shadow": direct["occluded"][0] / direct["occluded"][1],
    }


@wp.kernel
def trace(
    mesh: wp.uint64,
    origins: wp.array(dtype=wp.vec3),
    directions: wp.array(dtype=wp.vec3),
    limit: float,
    distances: wp.array(dtype=float),
    normals: wp.array(dtype=wp.vec3),
):
    i = wp.tid()
    query = wp.mesh_query_ray(mesh, origins[i], directions[i], limit)
    distances[i] = -1.0
    if query.result:
        distances[i] = query.t
        normals[i] = query.normal


def warp_rates(device, points, triangles):
    """Rays per second by kind, and the share of the camera rays that hit."""
    with wp.ScopedDevice(device):
        mesh = wp.Mesh(wp.array(points, dtype=wp.vec3), wp.array(triangles.ravel(), dtype=int))

        def rate(origins, directions, limit):
            n = len(directions)
            rays = [wp.array(rays.astype("f4"), dtype=wp.vec3) for rays in (origins, directions)]
            distances, normals = wp.zeros(n, dtype=float), wp.zeros(n, dtype=wp.vec3)
            seconds = []
            for _ in range(N_ROUNDS + 1):
                wp.synchronize()
                start = time.perf_counter()
                wp.launch(trace, dim=n, inputs=[mesh.id, *rays, limit, distances, normals])
                wp.synchronize()
                seconds.append(time.perf_counter() - start)
            return n / min(seconds), distances.numpy(), normals.numpy()

        x, y = np.meshgrid(2 * (np.arange(WIDTH) + 0.5) / WIDTH - 1, 1 - 2 * (np.arange(HEIGHT) + 0.5) / HEIGHT)
        tangent = np.tan(np.radians(FOV_Y_DEG / 2))
        directions = np.stack([tangent * x * WIDTH / HEIGHT, tangent * y, -np.ones_like(x)], axis=-1).reshape(-1, 3)
        primary, distances, normals = rate(np.broadcast_to(EYE, directions.shape), directions, 1e9)
        hit = distances >= 0
        normals = normals[hit] * -np.sign(np.sum(normals[hit] * directions[hit], axis=1, keepdims=True))
        hits = EYE + distances[hit, None] * directions[hit] + 1e-4 * normals
        # The normal plus a point of the unit sphere is a direction by the cosine.
        random = np.random.default_rng(7).normal(size=hits.shape)
        diffuse, _, _ = rate(hits, normals + random / np.linalg.norm(random, axis=1, keepdims=True), 1e9)
        lit = np.sum((LIGHT - hits) * normals, axis=1) > 0
        shadow, _, _ = rate(hits[lit], (LIGHT - hits)[lit], 1.0)
    return {"primary": primary, "diffuse": diffuse, "shadow": shadow}, float(hit.mean())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("device")
    parser.add_argument("warp_device")
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--triangles", type=int, nargs="*", default=[1_000_000, 10_000_000])
    options = parser.parse_args()
    wp.init()
    results = []
    for n_triangles in options.triangles:
        points, triangles = bumpy_sphere(n_triangles)
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            write_ply(folder / "sphere.ply", points, triangles)
            own = raycost_rates(options.program, options.device, folder)
        peer, share = warp_rates(options.warp_device, points, triangles)
        ratios = {kind: round(own[kind] / peer[kind], 3) for kind in own}
        results.append({"triangles": len(triangles), "rays_per_s": own, "warp_rays_per_s": peer, "ratios": ratios})
        print(f"{len(triangles):,} triangles, {share:.1%} of the camera rays hit: {ratios}")
    options.file.write_text(json.dumps({"warp": wp.config.version, "races": results}))


main()
