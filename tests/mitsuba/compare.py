"""Compares raycost's path tracing with Mitsuba 3, and with a white furnace: compare.py RAYCOST FOLDER [JSON]

Each scene is rendered with N_RUNS seeds by both. The means of blocks of pixels have to agree within their
standard errors, which the runs give. In a white furnace, light of radiance 1 from all sides, a body that
absorbs nothing is invisible: the mean of its picture is 1. FOLDER gets the scenes and the pictures, JSON the
figures.
"""

import json
import pathlib
import subprocess
import sys

import mitsuba as mi
import numpy as np
from PIL import Image

mi.set_variant("scalar_rgb")
import translate  # noqa: E402  (needs the variant)

SIDE = 48  # pixels
BLOCK = 8  # pixels
N_RUNS = 16
SAMPLES = 64  # of each run: 1024 in all
SAVED_EXPOSURE = 1.0
# Materials that absorb nothing.
WHITE = {
    "diffuse": {"color": 1},
    "mirror": {"color": 1, "reflection": 1},
    "glass": {"dielectric": {"index": 1.5}},
    "rough metal": {"conductor": {"index": 0, "extinction": 1}, "roughness": 0.4},
    "frosted glass": {"dielectric": {"index": 1.5}, "roughness": 0.3},
    "principled": {"color": 1, "principled": {"roughness": 0.5}},
}
MOST_FROM_WHITE = 2e-3


def by_raycost(raycost, name, config, folder):
    """The pictures of all runs, in linear light."""
    config = config | {"image": {"width": SIDE, "height": SIDE, "samples_per_pixel": SAMPLES, "sampler": "sobol"}}
    pictures = []
    for seed in range(N_RUNS):
        config["image"]["seed"] = seed
        pictures.append(rendered(raycost, name, config, folder))
    return np.array(pictures)


def rendered(raycost, name, config, folder):
    scene, out = folder / f"{name}.yaml", folder / name
    scene.write_text(json.dumps(config, indent=1))
    arguments = ["render", scene, "--quiet", "--cost=none", "--also=exr", "--out", out]
    subprocess.run([raycost, *arguments], check=True)
    # Its first channels are R, G and B.
    return np.array(mi.Bitmap(str(out / "image.exr")))[:, :, :3]


def in_furnace(raycost, folder):
    """The mean radiance of a sphere of each white material in light of radiance 1."""
    config = {
        "image": {"width": SIDE, "height": SIDE, "samples_per_pixel": 1024, "sampler": "sobol"},
        "camera": {"look_at": {"eye": [0, 0, 4], "target": [0, 0, 0], "fov_y_deg": 30}},
        "shading": {"model": "path", "max_depth": 100},
        "background": 1,
        "lights": [],
        "objects": [{"sphere": {"center": [0, 0, 0], "radius": 1}, "material": "white"}],
    }
    for name, material in WHITE.items():
        picture = rendered(raycost, f"furnace {name}", config | {"materials": {"white": material}}, folder)
        yield {"material": name, "mean": float(picture.mean())}


def by_mitsuba(config):
    scene = mi.load_dict(translate.scene(config, SIDE, SIDE, config["shading"]["max_depth"]))
    return np.array([np.array(mi.render(scene, spp=SAMPLES, seed=seed))[:, :, :3] for seed in range(N_RUNS)])


def blocks(pictures):
    """The means of blocks, and their standard errors."""
    runs, rows, columns, channels = pictures.shape
    shape = (runs, rows // BLOCK, BLOCK, columns // BLOCK, BLOCK, channels)
    means = pictures.reshape(shape).mean(axis=(2, 4))
    return means.mean(axis=0), means.std(axis=0, ddof=1) / np.sqrt(runs)


def save(name, picture, folder):
    encoded = np.clip(SAVED_EXPOSURE * picture, 0, 1) ** (1 / 2.2)
    Image.fromarray((255 * encoded).round().astype(np.uint8)).save(folder / f"{name}.png")


def main():
    raycost, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    failed, scenes = False, []
    for name, config in translate.scenes():
        ours, theirs = by_raycost(raycost, name, config, folder), by_mitsuba(config)
        save(f"{name}.raycost", ours.mean(axis=0), folder)
        save(f"{name}.mitsuba", theirs.mean(axis=0), folder)
        (mean, error), (expected, expected_error) = blocks(ours), blocks(theirs)
        spread = np.sqrt(error**2 + expected_error**2) + 1e-4 * expected.mean()
        z = (mean - expected) / spread
        ratio = mean.mean() / expected.mean()
        within = np.mean(np.abs(z) <= 3)
        print(
            f"{name:<16} mean {ratio:.4f} of Mitsuba's, {100 * within:.1f} % of {z.size} block means "
            f"within 3 standard errors, farthest {np.abs(z).max():.1f}, mean square {np.mean(z**2):.2f}"
        )
        scenes.append({
            "scene": name,
            "mean_ratio": float(ratio),
            "n_means": z.size,
            "within_3_errors": float(within),
            "farthest": float(np.abs(z).max()),
        })
        # With 15 degrees of freedom, 0.9 % of t's distribution lies beyond 3.
        failed |= within < 0.97 or np.mean(z**2) > 1.6 or abs(ratio - 1) > 0.005
    furnace = list(in_furnace(raycost, folder))
    for one in furnace:
        print(f"white furnace, {one['material']}: mean {one['mean']:.5f}")
        failed |= abs(one["mean"] - 1) > MOST_FROM_WHITE
    if len(sys.argv) > 3:
        result = {"mitsuba": mi.__version__, "samples": N_RUNS * SAMPLES, "scenes": scenes, "furnace": furnace}
        pathlib.Path(sys.argv[3]).write_text(json.dumps(result, indent=1) + "\n")
    sys.exit("a picture differs from Mitsuba's" if failed else 0)


main()
