"""Compares raycost with the course's model on random scenes: compare.py RAYCOST FOLDER

Renders the first N_SCENES of random_scenes.py that show something, with the program RAYCOST and with
seed_model.py, and the two scenes of the course with the model alone, whose pictures it has to give to
the last bit. FOLDER gets the scenes, the files of raycost, and the model's pictures: look there when
a scene differs.
"""

import itertools
import json
import pathlib
import subprocess
import sys

import numpy as np
import random_scenes
import seed_model
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
N_SCENES = 50
MIN_COLORS = 256  # that a random scene shows
# Of the pixels, with no channel further than 1 of 255 from the model. raycost computes in 32 bits, the
# model in 64: on an edge and at a tie of rounding the last bit decides.
MIN_SHARE = 0.9995
# The same of rays and hits: what decides a pixel decides the rays that follow.
MAX_COUNT_ERROR = 1e-3


def random_pictures():
    """Number, sections, picture and counts of the random scenes that show something."""
    for number in itertools.count(1):
        sections = random_scenes.scene(number)
        colors, counts = seed_model.render(seed_model.Scene(sections))
        picture = seed_model.rgb8(colors)
        if len(np.unique(picture.reshape(-1, 3), axis=0)) >= MIN_COLORS:
            yield number, sections, picture, counts


def comparisons(raycost, folder):
    """How far raycost is from the model on each of the random scenes."""
    for number, sections, expected, counts in itertools.islice(random_pictures(), N_SCENES):
        scene = folder / f"{number:03}.yaml"
        scene.write_text(json.dumps(sections, indent=1))
        Image.fromarray(expected).save(folder / f"{number:03}.numpy.png")
        out = folder / f"{number:03}"
        subprocess.run([raycost, "render", scene, "--quiet", "--cost=counters", "--out", out], check=True)
        summary = json.loads((out / "summary.json").read_text())
        found = {"hits": summary["n_hits"], **summary["cost"]["totals"]}
        yield {
            "scene": number,
            **difference(rendered(out / "image.png"), expected.astype(int)),
            "counts": [
                {"name": name, "raycost": found[name], "numpy": count} for name, count in counts.items()
            ],
        }


def rendered(path):
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def difference(ours, theirs):
    """How far two pictures are apart; a pixel by the channel that differs most, of 255."""
    apart = np.abs(ours - theirs).max(axis=2)
    return {
        "n_pixels": apart.size,
        "n_different": int((apart > 0).sum()),
        "n_beyond_1": int((apart > 1).sum()),
        "max_difference": int(apart.max()),
    }


def share(case):
    """Of the pixels, those that are the model's but for a rounding."""
    return 1 - case["n_beyond_1"] / case["n_pixels"]


def is_the_models(case):
    are_close = (
        abs(count["raycost"] - count["numpy"]) <= MAX_COUNT_ERROR * count["numpy"]
        for count in case["counts"]
    )
    return share(case) >= MIN_SHARE and all(are_close)


def check_the_model():
    """Fails if the model is not the one that made the course's pictures and counts."""
    reference = ROOT / "tests" / "reference"
    facts = json.loads((reference / "facts.json").read_text())
    for name, expected in facts.items():
        scene_name, size = name.rsplit("_", 1)
        scene = seed_model.read(ROOT / "configs" / f"{scene_name}.yaml")
        scene.size = tuple(map(int, size.split("x")))
        colors, counts = seed_model.render(scene)
        picture = seed_model.rgb8(colors)
        counts["camera_rays"] = picture.shape[0] * picture.shape[1]
        if (picture != rendered(reference / f"{name}.png")).any():
            sys.exit(f"the model does not give the course's picture {name}.png")
        if any(counts[name] != count for name, count in expected.items()):
            sys.exit(f"the model counts {counts} in {name}, the course {expected}")
    # This one is the model's own, for the tests without NumPy.
    colors, _ = seed_model.render(seed_model.read(reference / "seed_variant.yaml"))
    if (seed_model.rgb8(colors) != rendered(reference / "seed_variant.png")).any():
        sys.exit("seed_variant.png is not what the model makes of seed_variant.yaml")


def main():
    raycost, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    check_the_model()
    folder.mkdir(parents=True, exist_ok=True)
    cases = list(comparisons(raycost, folder))
    worst = min(cases, key=share)
    n_same = sum(case["n_different"] == 0 for case in cases)
    print(
        f"{len(cases)} scenes, {sum(case['n_pixels'] for case in cases):,} pixels: "
        f"{n_same} scenes are the model's to the last bit; in the worst, {worst['scene']:03}, "
        f"{100 * share(worst):.4f} % of the pixels are, but for a rounding"
    )
    wrong = [case for case in cases if not is_the_models(case)]
    for case in wrong:
        print(f"not the model's: {folder}/{case['scene']:03}.yaml: {case}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
