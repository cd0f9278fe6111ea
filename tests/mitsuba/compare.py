"""Compares raycost's path tracing with Mitsuba 3: compare.py RAYCOST FOLDER

Each scene is rendered with N_RUNS seeds by both. The means of blocks of pixels have to agree within their
standard errors, which the runs give. FOLDER gets the scenes, both pictures and their difference.
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


def by_raycost(raycost, name, config, folder):
    """The pictures of all runs, in linear light."""
    config = config | {"image": {"width": SIDE, "height": SIDE, "samples_per_pixel": SAMPLES, "sampler": "sobol"}}
    pictures = []
    for seed in range(N_RUNS):
        config["image"]["seed"] = seed
        scene, out = folder / f"{name}.yaml", folder / name
        scene.write_text(json.dumps(config, indent=1))
        arguments = ["render", scene, "--quiet", "--cost=none", "--also=exr", "--out", out]
        subprocess.run([raycost, *arguments], check=True)
        # Its first channels are R, G and B.
        pictures.append(np.array(mi.Bitmap(str(out / "image.exr")))[:, :, :3])
    return np.array(pictures)


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
    failed = False
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
        # With 15 degrees of freedom, 0.9 % of t's distribution lies beyond 3.
        failed |= within < 0.97 or np.mean(z**2) > 1.6 or abs(ratio - 1) > 0.005
    sys.exit("a picture differs from Mitsuba's" if failed else 0)


main()
