"""The course's ray tracer in NumPy, for any of its scenes: seed_model.py SCENE.yaml OUT.png

The model behind raycost's `shading: { model: seed }`, written from the course's description and not
from raycost: what raycost renders is compared with it. All pixels are computed at once, in 64 bits.

It takes a scene file of raycost with spheres, planes and one point light, seen through a window that
is sampled from edge to edge. Everything else in a file is an error: the course has nothing else.
"""

import sys

import numpy as np
import yaml
from PIL import Image

OFFSET = 1e-4  # new rays start that far off the surface, along its normal
MIN_COSINE = 1e-6  # rays flatter than that against a plane miss it


class Sphere:
    """Its normal points outward, also for a ray that comes from the inside."""

    def __init__(self, center, radius):
        self.center, self.radius = vector(center), float(radius)

    def distances(self, origins, directions):
        from_center = origins - self.center
        b = dot(from_center, directions)
        discriminant = b**2 - dot(from_center, from_center) + self.radius**2
        root = np.sqrt(np.maximum(discriminant, 0))
        nearest = np.where(-b - root >= 0, -b - root, -b + root)
        return np.where((discriminant > 0) & (nearest >= 0), nearest, np.inf)

    def normals(self, points):
        return normalized(points - self.center)


class Plane:
    """Its normal is the one that the file gives, also for a ray that comes from below."""

    def __init__(self, point, normal):
        self.point, self.normal = vector(point), normalized(vector(normal))

    def distances(self, origins, directions):
        cosines = directions @ self.normal
        is_missed = np.abs(cosines) < MIN_COSINE
        distances = (self.point - origins) @ self.normal / np.where(is_missed, 1, cosines)
        return np.where(is_missed | (distances < 0), np.inf, distances)

    def normals(self, points):
        return np.broadcast_to(self.normal, points.shape)


class Material:
    def __init__(self, color, ambient=1, diffuse=1, specular=0, exponent=50, reflection=0):
        self.checker = Checker(**color["checker"]) if isinstance(color, dict) else None
        self.color = None if self.checker else vector(color)
        self.ambient, self.diffuse, self.specular = float(ambient), float(diffuse), float(specular)
        self.exponent, self.reflection = float(exponent), float(reflection)

    def colors(self, points):
        if self.checker:
            return self.checker.colors(points)
        return np.broadcast_to(self.color, points.shape)


class Checker:
    """Squares along x and z. Those at x = 0 and z = 0 are twice as wide: `trunc` goes toward zero."""

    def __init__(self, even, odd, size, axes, rounding):
        require((axes, rounding) == ("xz", "truncate"), "a checker of other axes or rounding")
        self.even, self.odd, self.size = vector(even), vector(odd), float(size)

    def colors(self, points):
        x, z = (np.trunc(points[:, axis] / self.size) % 2 for axis in (0, 2))
        return np.where((x == z)[:, np.newaxis], self.even, self.odd)


class Scene:
    """What a file says, as a dictionary of sections."""

    def __init__(self, sections):
        require(sections.keys() <= SECTIONS, "sections that the course's scenes do not have")
        self.size = (int(sections["image"]["width"]), int(sections["image"]["height"]))
        require(len(sections["image"]) == 2, "more in `image` than its size")
        self._read_window(**sections["camera"]["window"])
        self._read_shading(**sections["shading"])
        (light,) = sections["lights"]
        self._read_light(**light["point"])
        materials = {name: Material(**keys) for name, keys in sections["materials"].items()}
        self.objects = [self._object(materials, **keys) for keys in sections["objects"]]

    def _read_window(self, eye, x, y, z, samples):
        require(samples == "edges", "a window that is not sampled from edge to edge")
        self.eye = vector(eye)
        self.window = [float(bound) for bound in (*x, *y, z)]

    def _read_shading(self, model, ambient, max_depth):
        require(model == "seed", "another shading model")
        self.ambient = vector(ambient)
        # The course counts the segments of a path, raycost its bounces.
        self.n_segments = int(max_depth) + 1

    def _read_light(self, position, color=(1, 1, 1)):
        self.light, self.light_color = vector(position), vector(color)

    @staticmethod
    def _object(materials, material, sphere=None, plane=None):
        return (Sphere(**sphere) if sphere else Plane(**plane)), materials[material]


SECTIONS = {"image", "camera", "shading", "materials", "lights", "objects"}


def render(scene):
    """Colors from 0 to 1 of shape (height, width, 3), row 0 on top, and counts of rays and hits."""
    pixels, origins, directions = camera_rays(scene)
    colors = np.zeros((len(pixels), 3))
    weights = np.ones(len(pixels))
    counts = {"hits": 0, "shadow_rays": 0, "reflection_rays": 0}
    for segment in range(scene.n_segments):
        counts["reflection_rays"] += len(pixels) if segment > 0 else 0
        distances = np.array([shape.distances(origins, directions) for shape, _ in scene.objects])
        met, distances = np.argmin(distances, axis=0), np.min(distances, axis=0)
        hit = np.isfinite(distances)
        pixels, met, weights, directions = (of[hit] for of in (pixels, met, weights, directions))
        points = origins[hit] + distances[hit, np.newaxis] * directions
        normals = of_objects(scene, met, points, lambda shape, _, points: shape.normals(points))
        counts["hits"] += len(pixels) if segment == 0 else 0
        counts["shadow_rays"] += len(pixels)

        # A point in the shadow gives nothing, and ends its path.
        lit = ~shadowed(scene, met, points, normals)
        pixels, met, weights, directions, points, normals = (
            of[lit] for of in (pixels, met, weights, directions, points, normals)
        )
        colors[pixels] += weights[:, np.newaxis] * local_colors(scene, met, points, normals)

        reflections = of_objects(scene, met, points, lambda _, material, __: material.reflection)
        weights = weights * reflections[:, 0]
        origins = points + OFFSET * normals
        directions = normalized(directions - 2 * dot(directions, normals)[:, np.newaxis] * normals)
        # What follows a path that is worth nothing would only be counted.
        mirrors = weights > 0
        pixels, weights, origins, directions = (
            of[mirrors] for of in (pixels, weights, origins, directions)
        )
    width, height = scene.size
    return np.clip(colors, 0, 1).reshape(height, width, 3), counts


def camera_rays(scene):
    """The number, the origin and the direction of each pixel's ray, row 0 on top."""
    width, height = scene.size
    left, right, bottom, top, z = scene.window
    x, y = np.meshgrid(np.linspace(left, right, width), np.linspace(top, bottom, height))
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], axis=1)
    origins = np.broadcast_to(scene.eye, points.shape)
    return np.arange(x.size), origins, normalized(points - scene.eye)


def local_colors(scene, met, points, normals):
    """Ambient light, diffuse light and the highlight of points that the light reaches."""
    to_light = normalized(scene.light - points)
    to_eye = normalized(scene.eye - points)  # also after a bounce
    diffuse = np.maximum(dot(normals, to_light), 0)[:, np.newaxis]
    highlight = np.maximum(dot(normals, normalized(to_light + to_eye)), 0)[:, np.newaxis]

    def of_material(of):
        return of_objects(scene, met, points, lambda _, material, points: of(material, points))

    # The light's color is in the highlight alone, that of the surface in its diffuse light alone.
    return (
        of_material(lambda material, _: material.ambient) * scene.ambient
        + of_material(lambda material, points: material.diffuse * material.colors(points)) * diffuse
        + of_material(lambda material, _: material.specular)
        * scene.light_color
        * highlight ** of_material(lambda material, _: material.exponent)
    )


def shadowed(scene, met, points, normals):
    """Whether anything but the object itself is between a point and the light, or behind the light."""
    origins, directions = points + OFFSET * normals, normalized(scene.light - points)
    is_shadowed = np.zeros(len(points), dtype=bool)
    for number, (shape, _) in enumerate(scene.objects):
        is_met = np.isfinite(shape.distances(origins, directions))
        is_shadowed |= is_met & (met != number)
    return is_shadowed


def of_objects(scene, met, points, value):
    """`value(shape, material, points)` of each point's own object, of shape (n, 3)."""
    values = np.empty((len(points), 3))
    for number, (shape, material) in enumerate(scene.objects):
        of_object = met == number
        values[of_object] = value(shape, material, points[of_object])
    return values


def vector(numbers):
    """Three numbers; one stands for all three, as for a gray."""
    return np.broadcast_to(np.array(numbers, dtype=float), 3)


def dot(a, b):
    return np.sum(a * b, axis=-1)


def normalized(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def require(condition, otherwise):
    if not condition:
        raise ValueError(f"the course's model has no such thing: {otherwise}")


def rgb8(colors):
    return np.round(255 * colors).astype(np.uint8)


def read(path):
    with open(path, encoding="utf-8") as file:
        return Scene(yaml.safe_load(file))


if __name__ == "__main__":
    scene_file, png = sys.argv[1:]
    picture, _ = render(read(scene_file))
    Image.fromarray(rgb8(picture)).save(png)
