"""Squared error times work of uniform sampling and of both rules of adaptive sampling.

    benches/noise/run [--json FILE] [--seeds N] [--samples N] [SCENE ...]

Each scene is rendered small with N seeds: with the same number of samples for all pixels; and by noise, and by
efficiency, with the limit and the mean number of samples that take about the same work, the sum of node
visits and primitive tests. The error is the mean over pixels and channels of the squared difference from a
picture with many more samples, in linear light and as a display shows it (the square root of light, up to
white). Ratios are of error times work, so that they also compare equal work where it differs by a few percent.
Intervals of 95 % are by a jackknife over the seeds. The counters leave out the work that plans samples by
efficiency, in rings around tiles and in probed pixels: `plan` is the factor of its samples in a picture of
640 x 480 pixels with tiles of 16 x 16.

One scene is also rendered with several numbers of samples, for the figure of error over work.
"""

import argparse
import json
import pathlib
import re
import subprocess
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SCENES = [
    "glass", "dielectric_stack", "marbles", "hero", "spot_under_a_sky", "cornell_box", "nanotube", "lamp", "mist", "still_life",
]  # fmt: skip
SIZE = [96, 72]
N_REFERENCE = 2048
MOST_PER_MEAN = 8
LEAST_SAMPLES = 16
# The ring around a tile, and nine pixels around each of 1,024 in a picture of 640 x 480.
PLANNED_PIXELS = (18 / 16) ** 2 - 1 + 9 * 1024 / (640 * 480)
# Settings are searched with another seed, until their work is this near.
SEED_OF_SETTINGS = 123_456
MOST_STEPS = 6
NEAR = 0.02
# Student's t for 95 % by degrees of freedom from 23 on.
T = 2.07
CURVE = {"scene": "cornell_box", "samples": [32, 64, 128, 256], "seeds": 4}
RULES = ["uniform", "noise", "efficiency"]


class Renderer:
    def __init__(self, program, scene, folder):
        self.program, self.scene, self.folder = program.resolve(), ROOT / f"configs/{scene}.yaml", folder

    def render(self, seed, n_samples, adaptive="null"):
        """The light of all pixels, the work of the picture and the mean number of samples."""
        out = self.folder / "out"
        flags = ["--quiet", "--threads=1", "--cost=counters", "--also=radiance", "--compress=none", f"--seed={seed}"]
        size = [f"--width={SIZE[0]}", f"--height={SIZE[1]}", f"--spp={n_samples}"]
        sets = ["--set=image.sampler=sobol", f"--set=image.adaptive={adaptive}"]
        command = [self.program, "render", self.scene, *flags, *size, *sets, "--out", out]
        subprocess.run(command, check=True)
        totals = json.loads((out / "summary.json").read_text())["cost"]["totals"]
        work = totals["node_visits"] + totals["primitive_tests"]
        return radiance(out / "frame.vti"), work, totals["camera_rays"] / (SIZE[0] * SIZE[1])

    def by_rule(self, rule, seed, n_samples, setting):
        """Renders by a rule; `setting` is the limit of noise, or the mean number of samples by efficiency."""
        match rule:
            case "uniform":
                return self.render(seed, n_samples)
            case "noise":
                return self.render(seed, MOST_PER_MEAN * n_samples, f"{{noise: {setting:.6f}}}")
            case "efficiency":
                return self.render(seed, max(round(setting), LEAST_SAMPLES + 1), "{by: efficiency}")

    def setting(self, rule, n_samples):
        """The setting of a rule that takes about the work of uniform samples."""
        _, wanted, _ = self.render(SEED_OF_SETTINGS, n_samples)
        # The work by efficiency is proportional to the setting; by noise, about to its square.
        setting, power = {"uniform": (None, 1), "noise": (0.02, -2), "efficiency": (n_samples, 1)}[rule]
        for _ in range(MOST_STEPS if rule != "uniform" else 0):
            _, work, _ = self.by_rule(rule, SEED_OF_SETTINGS, n_samples, setting)
            if abs(work / wanted - 1) < NEAR:
                break
            setting = setting * (wanted / work) ** (1 / power)
            if rule == "noise":
                setting = min(max(setting, 1e-4), 1)
        return setting


def radiance(path):
    """The linear light of a frame without compression."""
    raw = path.read_bytes()
    offset = re.search(rb'Name="radiance"[^>]*?offset="(\d+)"', raw)
    start = raw.index(b"_", raw.index(b"<AppendedData")) + 1 + int(offset[1])
    n_bytes = int(np.frombuffer(raw, "<u8", 1, start)[0])
    return np.frombuffer(raw, "<f4", n_bytes // 4, start + 8).astype(float)


def errors(light, reference):
    shown = [np.sqrt(np.minimum(x, 1)) for x in (light, reference)]
    return [((light - reference) ** 2).mean(), ((shown[0] - shown[1]) ** 2).mean()]


def run(renderer, rule, seeds, n_samples, reference):
    """A row for each seed: linear and perceived squared error, work, samples, light over the reference's."""
    setting, rows = renderer.setting(rule, n_samples), []
    for seed in seeds:
        light, work, mean = renderer.by_rule(rule, seed, n_samples, setting)
        rows.append([*errors(light, reference), work, mean, light.mean() / reference.mean()])
    return np.array(rows)


def ratio(found, uniform, column):
    """The ratio of error times work, and its interval."""

    def logarithm(kept):
        [a, b] = [rows[kept][:, column].mean() * rows[kept][:, 2].mean() for rows in (found, uniform)]
        return np.log(a / b)

    n = len(found)
    all_seeds = np.arange(n)
    left_out = np.array([logarithm(all_seeds != seed) for seed in range(n)])
    middle = logarithm(all_seeds >= 0)
    spread = T * np.sqrt((n - 1) / n * ((left_out - left_out.mean()) ** 2).sum())
    values = {"ratio": middle, "low": middle - spread, "high": middle + spread}
    return {key: round(float(np.exp(value)), 4) for key, value in values.items()}


def row(scene, rule, found, uniform):
    return {
        "scene": scene,
        "rule": rule,
        "linear": ratio(found, uniform, 0),
        "perceived": ratio(found, uniform, 1),
        "samples": round(float(found[:, 3].mean()), 2),
        "work": round(float(found[:, 2].mean() / uniform[:, 2].mean()), 4),
        "light": round(float(found[:, 4].mean()), 5),
        "light_of_uniform": round(float(uniform[:, 4].mean()), 5),
    }


def curve(renderer, reference):
    """Error over work of each rule."""
    points = []
    for n_samples in CURVE["samples"]:
        for rule in RULES:
            found = run(renderer, rule, range(CURVE["seeds"]), n_samples, reference).mean(axis=0)
            point = {"rule": rule, "samples": round(found[3], 2), "work": round(found[2])}
            points.append(point | {"linear": float(f"{found[0]:.4g}"), "perceived": float(f"{found[1]:.4g}")})
    return points


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("raycost", type=pathlib.Path)
    parser.add_argument("scenes", nargs="*", default=SCENES, metavar="SCENE")
    parser.add_argument("--seeds", type=int, default=24, metavar="N")
    parser.add_argument("--samples", type=int, default=64, metavar="N")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE")
    options = parser.parse_args()
    rows, points = [], []
    for scene in options.scenes:
        with tempfile.TemporaryDirectory() as folder:
            renderer = Renderer(options.raycost, scene, pathlib.Path(folder))
            reference, _, _ = renderer.render(999_999, N_REFERENCE)
            seeds = range(options.seeds)
            found = {rule: run(renderer, rule, seeds, options.samples, reference) for rule in RULES}
            for rule in RULES[1:]:
                rows.append(row(scene, rule, found[rule], found["uniform"]))
                print(*(f"{value}" for value in rows[-1].values()), flush=True)
            if scene == CURVE["scene"]:
                points = curve(renderer, reference)
    measured = {"size": SIZE, "samples": options.samples, "seeds": options.seeds, "reference": N_REFERENCE}
    measured["plan"] = round(1 + PLANNED_PIXELS * LEAST_SAMPLES / options.samples, 4)
    result = measured | {"rows": rows, "curve": {"scene": CURVE["scene"], "points": points}}
    if options.json:
        options.json.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
