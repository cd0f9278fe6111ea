"""Random scenes of the course's model: the same ones for the same seeds, on every machine.

They vary what the course's two scenes leave at one value: the light's color, the eye and an off-axis
window, planes of any direction seen from either side, an eye inside a sphere, all materials, and the
number of segments.
"""

import random


class Generator:
    def __init__(self, seed):
        self.random = random.Random(seed)

    def uniform(self, least, most):
        """Few digits: the file says it, and people can read it."""
        return round(least + (most - least) * self.random.random(), 3)

    def whole(self, least, most):
        return least + int((most - least + 1) * self.random.random())

    def happens(self, probability):
        return self.random.random() < probability

    def vector(self, least, most):
        return [self.uniform(least, most) for _ in range(3)]

    def material(self, has_checker):
        color = self.vector(0, 1)
        if has_checker:
            color = {
                "checker": {
                    "even": color,
                    "odd": self.vector(0, 1),
                    "size": self.uniform(0.3, 1),
                    "axes": "xz",
                    "rounding": "truncate",
                }
            }
        return {
            "color": color,
            "diffuse": self.uniform(0.2, 1),
            "specular": self.uniform(0, 1),
            "exponent": self.whole(5, 200),
            "reflection": self.uniform(0.1, 0.9) if self.happens(0.7) else 0,
        }


def scene(seed):
    """The sections of a scene file, as a dictionary that can be written as JSON, which is YAML."""
    generator = Generator(seed)
    eye = generator.vector(-1, 1)
    window = random_window(generator, eye)
    shapes = [random_sphere(generator, window) for _ in range(generator.whole(2, 6))]
    shapes += [random_plane(generator, window) for _ in range(generator.whole(0, 2))]
    if generator.happens(0.1):
        shapes.append({"sphere": {"center": eye, "radius": generator.uniform(3, 9)}})
    materials = {
        f"material {number}": generator.material("plane" in shape and generator.happens(0.7))
        for number, shape in enumerate(shapes)
    }
    ambient = generator.vector(0, 0.2) if generator.happens(0.3) else generator.uniform(0, 0.2)
    return {
        "image": {"width": generator.whole(150, 350), "height": generator.whole(150, 350)},
        "camera": {"window": window},
        "shading": {"model": "seed", "ambient": ambient, "max_depth": generator.whole(0, 5)},
        "materials": materials,
        "lights": [{"point": random_light(generator, window)}],
        "objects": [
            {**shape, "material": f"material {number}"} for number, shape in enumerate(shapes)
        ],
    }


def random_window(generator, eye):
    """Before the eye toward +z or -z; its middle is seldom opposite the eye."""
    forward = generator.uniform(0.6, 1.5) * (1 if generator.happens(0.7) else -1)
    # Opposite the eye, a row of pixels may look along the floor.
    shift = 0 if generator.happens(0.2) else 0.4
    bounds = []
    for axis in (0, 1):
        middle, half = eye[axis] + generator.uniform(-shift, shift), generator.uniform(0.4, 1.2)
        bounds.append([round(middle - half, 3), round(middle + half, 3)])
    z = round(eye[2] + forward, 3)
    return {"eye": eye, "x": bounds[0], "y": bounds[1], "z": z, "samples": "edges"}


def random_light(generator, window):
    """Mostly on the eye's side of what it sees."""
    position = generator.vector(-10, 10)
    eye_z, window_z = window["eye"][2], window["z"]
    if generator.happens(0.8) and (position[2] > eye_z) == (window_z > eye_z):
        position[2] = -position[2]
    return {"position": position, "color": generator.vector(0, 1.2)}


def seen_point(generator, window, distance):
    """A point behind the window, `distance` times as far from the eye."""
    corners = [window["x"], window["y"], [window["z"], window["z"]]]
    through = [generator.uniform(*bounds) for bounds in corners]
    return [round(e + distance * (t - e), 3) for e, t in zip(window["eye"], through)]


def random_sphere(generator, window):
    distance = generator.uniform(1.5, 6)
    center = seen_point(generator, window, distance)
    return {"sphere": {"center": center, "radius": round(distance * generator.uniform(0.1, 0.4), 3)}}


def random_plane(generator, window):
    """A floor, a ceiling, or a wall of any direction behind all else, seen from either side."""
    side = 1 if generator.happens(0.7) else -1
    if generator.happens(0.6):
        x, y, z = window["eye"]
        level = round(y + generator.uniform(0.4, 2) * (-1 if generator.happens(0.8) else 1), 3)
        return {"plane": {"point": [x, level, z], "normal": [0, side, 0]}}
    normal = [generator.uniform(-1, 1), generator.uniform(-1, 1), side]
    return {"plane": {"point": seen_point(generator, window, generator.uniform(4, 9)), "normal": normal}}
