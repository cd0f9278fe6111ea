"""Clouds of spheres as a NumPy loop over the pixels: cloud.py SCENE.yaml OUT.png [--width=N] [--height=N]

The first step of the ladder: one ray after the other, each tested with all spheres at once. Prints the metrics
of the rendering, without reading the scene and writing the picture, for `raycost study`.
"""

import argparse
import time

import numpy as np
import yaml
from PIL import Image

WORD = 0xFFFFFFFF
OFFSET = 1e-4  # a shadow ray starts that far off the surface, along its normal


def pcg4d(words):
    """The hash of Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020, on words of 32 bits."""
    words = [1664525 * word + 1013904223 & WORD for word in words]
    for is_last in (False, True):
        for to, a, b in ((0, 1, 3), (1, 2, 0), (2, 0, 1), (3, 1, 2)):
            words[to] = words[to] + words[a] * words[b] & WORD
        if not is_last:
            words = [word ^ word >> 16 for word in words]
    return words


def uniform(seed, i):
    """The four random numbers of sphere `i` in raycost, from 0 to 1."""
    key = [one ^ other for one, other in zip([seed, i, 0, 0], pcg4d([0, 0, 0, 0]))]
    return [(word >> 8) / (1 << 24) for word in pcg4d(key)]


def normalized(vector):
    return vector / np.sqrt(vector @ vector)


def spheres_of(cloud):
    """Centers and radii, rounded as in raycost."""
    numbers = np.array([uniform(cloud["seed"], i) for i in range(cloud["count"])], dtype=np.float32)
    low, high = (np.array(cloud[corner], dtype=np.float32) for corner in ("min", "max"))
    least, most = np.array(cloud["radius"], dtype=np.float32)
    centers = low + (high - low) * numbers[:, :3]
    return centers.astype(float), (least + (most - least) * numbers[:, 3]).astype(float)


class Scene:
    """A window, a light and clouds of spheres, as arrays over all spheres."""

    def __init__(self, file):
        window = file["camera"]["window"]
        self.eye = np.array(window["eye"], dtype=float)
        self.window = [*window["x"], *window["y"], window["z"]]
        self.ambient = file["shading"]["ambient"]
        self.light = np.array(file["lights"][0]["point"]["position"], dtype=float)
        spheres = [spheres_of(one["sphere_cloud"]) for one in file["objects"]]
        self.centers = np.concatenate([centers for centers, _ in spheres])
        self.radii_2 = np.concatenate([radii for _, radii in spheres]) ** 2
        self.objects = np.repeat(np.arange(len(spheres)), [len(radii) for _, radii in spheres])
        self.materials = [file["materials"][one["material"]] for one in file["objects"]]

    def distances(self, origin, direction):
        """How far each sphere is along a ray; infinite for a miss."""
        from_centers = origin - self.centers
        b = from_centers @ direction
        discriminant = b * b - np.einsum("ij,ij->i", from_centers, from_centers) + self.radii_2
        root = np.sqrt(np.maximum(discriminant, 0))
        nearest = np.where(-b - root >= 0, -b - root, -b + root)
        return np.where((discriminant > 0) & (nearest >= 0), nearest, np.inf)

    def color_along(self, direction):
        """The color of a camera ray; `None` if it hits nothing."""
        distances = self.distances(self.eye, direction)
        met = np.argmin(distances)
        if np.isinf(distances[met]):
            return None
        point = self.eye + distances[met] * direction
        normal = normalized(point - self.centers[met])
        to_light = normalized(self.light - point)
        toward_light = self.distances(point + OFFSET * normal, to_light)
        # The course's model: no object shadows itself, and a point in the shadow is black.
        if np.isfinite(toward_light[self.objects != self.objects[met]]).any():
            return np.zeros(3)
        material = self.materials[self.objects[met]]
        half = normalized(to_light + normalized(self.eye - point))
        diffuse = np.array(material["color"]) * max(normal @ to_light, 0)
        highlight = max(normal @ half, 0) ** material["exponent"]
        return self.ambient + diffuse + material["specular"] * highlight


def render(scene, width, height):
    """Colors from 0 to 1, row 0 on top, and the number of hits."""
    left, right, bottom, top, z = scene.window
    pixels, n_hits = np.zeros((height, width, 3)), 0
    for j, y in enumerate(np.linspace(top, bottom, height)):
        for i, x in enumerate(np.linspace(left, right, width)):
            color = scene.color_along(normalized(np.array([x, y, z]) - scene.eye))
            if color is not None:
                pixels[j, i], n_hits = color, n_hits + 1
    return np.clip(pixels, 0, 1), n_hits


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("scene")
    arguments.add_argument("image")
    arguments.add_argument("--width", type=int)
    arguments.add_argument("--height", type=int)
    arguments = arguments.parse_args()
    with open(arguments.scene, encoding="utf-8") as file:
        file = yaml.safe_load(file)
    scene = Scene(file)
    width, height = (getattr(arguments, key) or file["image"][key] for key in ("width", "height"))
    start = time.perf_counter()
    pixels, n_hits = render(scene, width, height)
    seconds = time.perf_counter() - start
    Image.fromarray(np.round(255 * pixels).astype(np.uint8)).save(arguments.image)
    n_rays = width * height + n_hits
    metrics = {
        "render_wall_ms": 1e3 * seconds,
        "n_pixels": width * height,
        "n_hits": n_hits,
        "rays": n_rays,
        "primitive_tests": n_rays * len(scene.radii_2),
    }
    for name, value in metrics.items():
        print(name, value)


if __name__ == "__main__":
    main()
