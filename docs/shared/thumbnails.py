"""The scenes of the thumbnails in the reference of scene files: a ball in a small studio, and one change in each."""

import copy
import json
from pathlib import Path

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
STUDIO = {
    "image": {
        "width": 200,
        "height": 200,
        "samples_per_pixel": 256,
        "sampler": "sobol",
        "filter": "blackman_harris",
        "filter_radius": 1.5,
    },
    "camera": {"look_at": {"eye": [0, 1.7, 4.6], "target": [0, 0.7, 0], "fov_y_deg": 26}},
    "background": {"gradient": {"bottom": [0.3, 0.28, 0.26], "top": [0.5, 0.55, 0.65]}},
    "shading": {"model": "path", "max_depth": 12},
    "film": {"tone_curve": "aces", "exposure": 0.3, "sample_limit": 10},
    "materials": {
        "ball": {"color": [0.6, 0.15, 0.08]},
        "floor": {"color": {"checker": {"even": 0.5, "odd": 0.2, "size": 0.4, "axes": "xz"}}},
        "wall": {"color": [0.4, 0.42, 0.45]},
        "window": {"emission": [9, 8.2, 7], "two_sided": False},
    },
    "lights": [],
    "objects": [
        {"plane": {"point": [0, 0, 0], "normal": [0, 1, 0]}, "material": "floor"},
        {"plane": {"point": [0, 0, -3], "normal": [0, 0, 1]}, "material": "wall"},
        {
            "rectangle": {"corner": [-3.2, 1.2, 2.2], "edges": [[0.8, 0, -2.2], [0, 2, 0]]},
            "material": "window",
        },
        {
            "rectangle": {"corner": [2.2, 3.4, -1], "edges": [[0.9, -0.9, 0], [0, 0, 1.6]]},
            "material": "window",
        },
        {"sphere": {"center": [0, 0.72, 0], "radius": 0.72}, "material": "ball"},
    ],
}


def ball(**material):
    """The studio with a ball of another material."""
    return {"materials": {"ball": material}}


def metal(**material):
    """The studio in warm colors, which metals mirror."""
    wood = {"even": [0.34, 0.24, 0.17], "odd": [0.1, 0.06, 0.04], "size": 0.4, "axes": "xz"}
    materials = {
        "ball": material,
        "floor": {"color": {"checker": wood}},
        "wall": {"color": [0.3, 0.2, 0.15]},
        "window": {"emission": [12, 8.6, 5.6], "two_sided": False},
    }
    return {"materials": materials, "background": {"gradient": {"bottom": [0.1, 0.06, 0.04], "top": [0.5, 0.36, 0.24]}}}


def texture(mapping):
    return {"image": {"file": str(CONFIGS / "pictures" / mapping.pop("file")), **mapping}}


def globe():
    spherical = {"center": [0, 0.72, 0], "up": [-0.3, 1, 0.2], "front": [0, 0, 1]}
    return texture({"file": "globe.png", "mapping": {"spherical": spherical}})


def planks(file):
    return texture({"file": file, "mapping": "triplanar", "size": 0.9})


def magnified(**image):
    """The studio in few pixels, so that each can be seen, with a fine pattern on the ball."""
    checker = {"even": [0.75, 0.7, 0.6], "odd": [0.4, 0.05, 0.05], "size": 0.12}
    return {"image": {"width": 50, "height": 50, **image}, **ball(color={"checker": checker})}


def lit(background, *lights, **sections):
    """The ball on the floor without the studio's lamps and wall."""
    objects = [STUDIO["objects"][0], STUDIO["objects"][-1]]
    return {"background": background, "lights": list(lights), "objects": objects, **sections}


def through(lens):
    """A row of balls, the second in focus."""
    balls = [
        {"sphere": {"center": [0.9 - 0.75 * i, 0.3, 1.5 - 1.5 * i], "radius": 0.3}, "material": "ball"} for i in range(5)
    ]
    # Points of light far behind, whose blur has the shape of the aperture.
    centers = [[-1.1 + 0.55 * i, 0.9 + 0.25 * (i % 2), -2.7] for i in range(5)]
    points = [{"sphere": {"center": center, "radius": 0.02}, "material": "point"} for center in centers]
    eye = {"eye": [0, 1.1, 4.6], "target": [0, 0.45, 0], "fov_y_deg": 26, "lens": lens}
    materials = {"point": {"emission": [60, 48, 30]}}
    return {"camera": {"look_at": eye}, "materials": materials, "objects": [*STUDIO["objects"][:-1], *balls, *points]}


def in_fog(**fog):
    light = {"directional": {"direction": [-0.6, -0.5, 0.7], "color": [1, 0.85, 0.65], "intensity": 5}}
    bars = [
        {"box": {"min": [x, 0, -1.5], "max": [x + 0.3, 2.4, -1.4]}, "material": "wall"} for x in (-1.2, -0.5, 0.2, 0.9, 1.6)
    ]
    sections = lit(0.05, light, fog=fog, film={"tone_curve": "aces", "exposure": -1})
    image = {**STUDIO["image"], "samples_per_pixel": 1024}
    return {**sections, "image": image, "objects": [*sections["objects"], *bars]}


def toned(curve):
    light = {"point": {"position": [-2, 3, 2.5], "intensity": 22, "falloff": "inverse_square"}}
    return {**lit({"gradient": {"bottom": 0.2, "top": [0.3, 0.4, 0.7]}}, light), "film": {"tone_curve": curve}}


SUN = {"directional": {"direction": [0.8, -1, -0.6], "intensity": 1.2}}
DIM = {"gradient": {"bottom": 0.1, "top": [0.14, 0.16, 0.2]}}
SCENES = {
    "diffuse": ball(color=[0.6, 0.15, 0.08]),
    "specular": ball(color=[0.6, 0.15, 0.08], specular=0.3, exponent=60),
    "reflection": ball(color=[0.6, 0.15, 0.08], reflection=0.4),
    "conductor_gold": metal(conductor="gold"),
    "conductor_copper": metal(conductor="copper"),
    "conductor_silver": ball(conductor="silver"),
    "conductor_aluminum": ball(conductor="aluminum", roughness=0.35),
    "roughness_02": metal(conductor="gold", roughness=0.2),
    "roughness_05": metal(conductor="gold", roughness=0.5),
    "roughness_10": metal(conductor="gold", roughness=1),
    "dielectric": ball(dielectric={"index": 1.5}),
    "dielectric_index": ball(dielectric={"index": 2.42}),
    "dielectric_absorption": ball(dielectric={"index": 1.5, "absorption": [1.4, 0.2, 0.7]}),
    "dielectric_rough": ball(dielectric={"index": 1.5}, roughness=0.3),
    "principled_rough_0": ball(color=[0.05, 0.2, 0.55], principled={"roughness": 0}),
    "principled_rough_05": ball(color=[0.05, 0.2, 0.55], principled={"roughness": 0.5}),
    "principled_rough_1": ball(color=[0.05, 0.2, 0.55], principled={"roughness": 1}),
    "principled_metallic": metal(color=[0.9, 0.75, 0.35], principled={"metallic": 1, "roughness": 0.25}),
    "principled_transmission": ball(color=[0.7, 0.9, 0.8], principled={"transmission": 1, "roughness": 0.2}),
    "emission": ball(emission=[2.2, 1.4, 0.6]),
    "checker": ball(color={"checker": {"even": [0.75, 0.7, 0.6], "odd": [0.4, 0.05, 0.05], "size": 0.3}}),
    "image": ball(color=globe(), specular=0.1),
    "triplanar": ball(color=planks("planks.png")),
    "normal_map": ball(
        color=[0.5, 0.32, 0.2], specular=0.2, normal_map={**planks("plank_normals.png"), "strength": 4}
    ),
    "cutout": ball(color=[0.5, 0.35, 0.1], cutout={**globe(), "threshold": 0.35}),
    "light_point": lit(DIM, {"point": {"position": [-1.5, 2.6, 2], "intensity": 9, "falloff": "inverse_square"}}),
    "light_spot": lit(
        DIM,
        {
            "spot": {
                "position": [-1.5, 3.4, 1.5],
                "target": [0, 0.5, 0],
                "angle_deg": 30,
                "soft_edge": 0.2,
                "intensity": 16,
                "falloff": "inverse_square",
            }
        },
    ),
    "light_directional": lit(DIM, SUN),
    "light_area": {},
    "environment_map": lit({"environment_map": {"file": str(CONFIGS / "pictures" / "evening.hdr"), "rotation_deg": 120}}),
    "sky_40": lit({"sky": {"sun": {"elevation_deg": 40, "azimuth_deg": 240}}}, film={"tone_curve": "aces", "exposure": 0.7}),
    "sky_8": lit({"sky": {"sun": {"elevation_deg": 8, "azimuth_deg": 240}}}, film={"tone_curve": "aces", "exposure": 2}),
    "sky_hazy": lit(
        {"sky": {"turbidity": 9, "sun": {"elevation_deg": 40, "azimuth_deg": 240}}},
        film={"tone_curve": "aces", "exposure": 0.7},
    ),
    "fog": in_fog(mean_free_path=14, radius=6),
    "fog_forward": in_fog(mean_free_path=14, radius=6, anisotropy=0.8),
    "lens_0": through({"radius": 0}),
    "lens_circle": through({"radius": 0.3, "focus_point": [0.15, 0.3, 0]}),
    "lens_blades": through({"radius": 0.3, "focus_point": [0.15, 0.3, 0], "blades": 5}),
    "curve_none": toned("none"),
    "curve_agx": toned("agx"),
    "curve_aces": toned("aces"),
    "model_blinn_phong": lit(DIM, SUN, shading={"ambient": 0.15}),
    "model_path": lit({"gradient": {"bottom": 0.3, "top": [0.4, 0.45, 0.55]}}, SUN),
    "model_ambient_occlusion": {
        **lit(0.5),
        "shading": {"model": "ambient_occlusion"},
        "film": {"exposure": 0},
    },
    "occlusion_near": {
        **lit(0.5),
        "shading": {"model": "ambient_occlusion", "occlusion_distance": 0.5},
        "film": {"exposure": 0},
    },
    "sampler_stratified": magnified(samples_per_pixel=4, sampler="stratified"),
    "sampler_sobol": magnified(samples_per_pixel=4, sampler="sobol"),
    "filter_box": magnified(samples_per_pixel=256, sampler="sobol", filter="box"),
    "filter_tent": magnified(samples_per_pixel=256, sampler="sobol", filter="tent"),
    "filter_blackman_harris": magnified(samples_per_pixel=256, sampler="sobol", filter="blackman_harris"),
}


def scene(name):
    """The text of a thumbnail's scene."""
    sections = copy.deepcopy(STUDIO)
    for key, section in SCENES[name].items():
        if key == "materials":
            sections[key].update(section)
        else:
            sections[key] = section
    used = {one["material"] for one in sections["objects"]}
    sections["materials"] = {key: one for key, one in sections["materials"].items() if key in used}
    return json.dumps(sections, indent=1) + "\n"
