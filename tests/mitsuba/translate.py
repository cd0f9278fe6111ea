"""Scenes of raycost as scenes of Mitsuba 3: what tests/mitsuba/compare.py and benches need."""

import math
import pathlib

import mitsuba as mi
import numpy as np
import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def scenes():
    """The names of the scenes that are compared, and their configs."""
    for path in [*sorted((ROOT / "tests/mitsuba").glob("*.yaml")), ROOT / "configs/cornell_box.yaml"]:
        config = yaml.safe_load(path.read_text())
        if isinstance(background := config.get("background"), dict):
            keys = background["environment_map"]
            keys["file"] = str(path.parent / keys["file"])
        yield path.stem, config


def scene(config, width, height, max_depth):
    """The dictionary of a scene, whose path integrator has as many bounces as raycost's."""
    materials = {name: bsdf(keys) for name, keys in config["materials"].items()}
    result = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": max_depth + 1, "rr_depth": 5},
        "sensor": sensor(config["camera"]["look_at"], width, height),
    }
    for i, light in enumerate(config["lights"]):
        result[f"light{i}"] = light_source(light)
    for i, thing in enumerate(config["objects"]):
        keys = config["materials"][thing["material"]]
        result[f"object{i}"] = shape(thing) | {"bsdf": materials[thing["material"]]}
        if "emission" in keys:
            result[f"object{i}"]["emitter"] = {"type": "area", "radiance": rgb(keys["emission"])}
    if "background" in config:
        result["sky"] = sky(config["background"])
    if "fog" in config:
        result["integrator"]["type"] = "volpath"
        result["fog"] = fog(config)
    return result


def fog(config):
    """A sphere of fog, with a surface that lets all light through."""
    keys = config["fog"]
    return {
        "type": "sphere",
        "center": center(config["objects"]),
        "radius": keys["radius"],
        "bsdf": {"type": "null"},
        "interior": {
            "type": "homogeneous",
            "sigma_t": 1 / keys["mean_free_path"],
            "albedo": rgb(keys["color"]),
            "phase": {"type": "hg", "g": keys["anisotropy"]},
        },
    }


def center(objects):
    """The center of the bounds of spheres and rectangles."""
    corners = []
    for thing in objects:
        if keys := thing.get("sphere"):
            corners += [[c + sign * keys["radius"] for c in keys["center"]] for sign in (-1, 1)]
        else:
            keys = thing["rectangle"]
            corners += [keys["corner"], [sum(of_axis) for of_axis in zip(keys["corner"], *keys["edges"])]]
    return [(low + high) / 2 for low, high in zip(np.min(corners, axis=0), np.max(corners, axis=0))]


def sky(background):
    if not isinstance(background, dict):
        return {"type": "constant", "radiance": rgb(background)}
    keys = background["environment_map"]
    # Mitsuba's middle column is at +z, and what is right of it toward -x.
    angle = 180 + keys.get("rotation_deg", 0)
    return {
        "type": "envmap",
        "bitmap": mi.Bitmap(finer(np.array(mi.Bitmap(keys["file"]).convert(component_format=mi.Struct.Type.Float32)))),
        "scale": keys.get("intensity", 1),
        "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], angle),
    }


def finer(picture, factor=64):
    """The picture with more texels, linear between the centers of its own.

    Mitsuba has the centers of the first and the last row at the poles, which is far off in a small picture.
    """
    rows, columns, _ = picture.shape
    y = np.clip(np.linspace(0, rows, factor * rows) - 0.5, 0, rows - 1)
    x = (np.arange(factor * columns) + 0.5) / factor - 0.5
    top, left = np.floor(y).astype(int), np.floor(x).astype(int)
    down, across = (y - top)[:, None, None], (x - left)[None, :, None]
    bottom = np.minimum(top + 1, rows - 1)
    left, right = left % columns, (left + 1) % columns
    upper = picture[top][:, left] * (1 - across) + picture[top][:, right] * across
    lower = picture[bottom][:, left] * (1 - across) + picture[bottom][:, right] * across
    return (upper * (1 - down) + lower * down).astype(np.float32)


def rgb(color):
    return {"type": "rgb", "value": color if isinstance(color, list) else [color] * 3}


def sensor(keys, width, height):
    return {
        "type": "perspective",
        "fov": keys["fov_y_deg"],
        "fov_axis": "y",
        "to_world": mi.ScalarTransform4f().look_at(keys["eye"], keys["target"], [0, 1, 0]),
        "film": {
            "type": "hdrfilm",
            "width": width,
            "height": height,
            "rfilter": {"type": "box"},
            "component_format": "float32",
        },
        "sampler": {"type": "independent"},
    }


def bsdf(keys):
    roughness = keys.get("roughness", 0)
    # Mitsuba's facets lose the light that they reflect onto each other.
    assert not roughness or keys["multiple_scattering"] is False
    rough = {"distribution": "ggx", "alpha": roughness**2} if roughness else {}
    kind = "rough" if roughness else ""
    if "dielectric" in keys:
        return {"type": f"{kind}dielectric", "int_ior": keys["dielectric"]["index"], "ext_ior": 1.0} | rough
    if "conductor" in keys:
        metal = keys["conductor"]
        optical = {"eta": rgb(metal["index"]), "k": rgb(metal["extinction"])}
        return {"type": f"{kind}conductor"} | optical | rough
    diffuse = {"type": "diffuse", "reflectance": rgb(keys.get("color", [0, 0, 0]))}
    return {"type": "twosided", "bsdf": diffuse}


def light_source(light):
    ((kind, keys),) = light.items()
    assert kind == "point" and keys["falloff"] == "inverse_square"
    # A white surface that faces the light has its intensity as radiance.
    intensity = [math.pi * keys.get("intensity", 1) * channel for channel in keys.get("color", [1, 1, 1])]
    return {"type": "point", "position": keys["position"], "intensity": rgb(intensity)}


def shape(thing):
    world = transform(thing.get("transform", []))
    if keys := thing.get("sphere"):
        return {"type": "sphere", "center": keys["center"], "radius": keys["radius"]}
    if keys := thing.get("rectangle"):
        corner, (u, v) = keys["corner"], keys["edges"]
        normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        columns = [
            [x / 2 for x in u],
            [x / 2 for x in v],
            normal,
            [c + (a + b) / 2 for c, a, b in zip(corner, u, v)],
        ]
        rows = [[column[i] for column in columns] for i in range(3)] + [[0, 0, 0, 1]]
        return {"type": "rectangle", "to_world": world @ mi.ScalarTransform4f(rows)}
    if keys := thing.get("box"):
        low, high = keys["min"], keys["max"]
        center = [(a + b) / 2 for a, b in zip(low, high)]
        half = [(b - a) / 2 for a, b in zip(low, high)]
        return {
            "type": "cube",
            "to_world": world @ mi.ScalarTransform4f().translate(center) @ mi.ScalarTransform4f().scale(half),
        }
    raise ValueError(f"no translation of {thing}")


def transform(steps):
    world = mi.ScalarTransform4f()
    for step in steps:
        ((kind, keys),) = step.items()
        if kind == "translate":
            moved = mi.ScalarTransform4f().translate(keys)
        else:
            moved = mi.ScalarTransform4f().rotate(keys["axis"], keys["angle_deg"])
        world = moved @ world
    return world
