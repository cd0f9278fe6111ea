"""Races raycost's path tracing against Mitsuba 3 to pictures with equal variance.

    benches/mitsuba/run --variance [--rounds N] [--samples N] [--size PIXELS] [--raycost PROGRAM] [--device DEVICE]
        [--json FILE] [SCENE ...]

The scenes are those of tests/mitsuba, and configs/cornell_box.yaml. Each racer renders each of them N
times with other seeds, in turn, on two threads. The variance of a pixel is that over these pictures; the
time to equal variance is time times variance. Mitsuba's `llvm_ad_rgb` renders in one process, after a
first picture that compiles it; raycost starts anew each time, and its render stage counts. With
`--device cuda` both render on an NVIDIA card, Mitsuba by `cuda_ad_rgb`. FILE gets the least ratio of each
scene. Fireflies make means of variances uncertain: the median over the pixels is printed beside them.
"""

import argparse
import importlib
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import drjit
import mitsuba as mi
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
N_THREADS = 2
GOAL = 1.5
sys.path.insert(0, str(ROOT / "tests/mitsuba"))
mi.set_variant("scalar_rgb")
import translate  # noqa: E402  (needs the variant)


class Mitsuba:
    def __init__(self, variant, sampler, config, options):
        mi.set_variant(variant)
        # Its types are those of the variant.
        importlib.reload(translate)
        scene = translate.scene(config, options.size, options.size, config["shading"]["max_depth"])
        scene["sensor"]["sampler"] = {"type": sampler, "sample_count": options.samples}
        self.variant, self.n_samples = variant, options.samples
        self.scene = mi.load_dict(scene)
        self.render(1_000_000)

    def render(self, seed):
        mi.set_variant(self.variant)
        start = time.perf_counter()
        picture = np.array(mi.render(self.scene, spp=self.n_samples, seed=seed))[:, :, :3]
        return 1e3 * (time.perf_counter() - start), picture


class Raycost:
    def __init__(self, config, options, folder):
        image = {"width": options.size, "height": options.size}
        self.config = config | {"image": image | {"samples_per_pixel": options.samples, "sampler": "sobol"}}
        self.program, self.folder = options.raycost.resolve(), folder
        of_device = [f"--device={options.device}", "--tile-size=256"]
        self.flags = of_device if options.device else [f"--threads={N_THREADS}"]

    def render(self, seed):
        self.config["image"]["seed"] = seed
        scene, out = self.folder / "scene.yaml", self.folder / "out"
        scene.write_text(json.dumps(self.config, indent=1))
        arguments = ["--quiet", "--cost=none", "--repeats=1", "--also=exr", *self.flags]
        subprocess.run([self.program, "render", scene, *arguments, "--out", out], check=True)
        stages = json.loads((out / "summary.json").read_text())["stages"]
        render = next(stage for stage in stages if stage["name"] == "render")
        mi.set_variant("scalar_rgb")
        return render["wall_ms"], np.array(mi.Bitmap(str(out / "image.exr")))[:, :, :3]


def race(racers, n_rounds):
    """The median time of each racer in ms, and its variances, of the mean of the channels."""
    runs = {name: [] for name in racers}
    for seed in range(n_rounds):
        for name, racer in racers.items():
            runs[name].append(racer.render(seed))
    results = {}
    for name, found in runs.items():
        grays = np.array([picture.mean(axis=2) for _, picture in found])
        variance = grays.var(axis=0, ddof=1)
        results[name] = np.median([ms for ms, _ in found]), variance.mean(), np.median(variance)
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    parser.add_argument("--rounds", type=int, default=8, metavar="N")
    parser.add_argument("--samples", type=int, default=64, metavar="N")
    parser.add_argument("--size", type=int, default=256, metavar="PIXELS")
    parser.add_argument("--raycost", type=pathlib.Path, default=ROOT / "target/release/raycost", metavar="PROGRAM")
    parser.add_argument("--device")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE")
    options = parser.parse_args()
    variants = ["cuda_ad_rgb"] if (options.device or "").startswith("cuda") else ["llvm_ad_rgb", "scalar_rgb"]
    ratios = {}
    drjit.set_thread_count(N_THREADS)
    for scene, config in translate.scenes():
        if options.scenes and scene not in options.scenes:
            continue
        with tempfile.TemporaryDirectory() as folder:
            racers = {"raycost": Raycost(config, options, pathlib.Path(folder))}
            for variant in variants:
                for sampler in ["independent", "multijitter"]:
                    racers[f"{variant}, {sampler}"] = Mitsuba(variant, sampler, config, options)
            results = race(racers, options.rounds)
        own_ms, own_mean, own_median = results["raycost"]
        print(f"{scene}: raycost {own_ms:.0f} ms")
        least = np.inf
        for name, (ms, mean, median) in results.items():
            if name == "raycost":
                continue
            slower, mean, median = ms / own_ms, mean / own_mean, median / own_median
            least = min(least, slower * mean)
            print(
                f"  {name:25} time {slower:6.2f}  variance {mean:5.2f} (median {median:5.2f})"
                f"  time to equal variance {slower * mean:6.2f} ({slower * median:.2f})"
            )
        print(f"  goal {GOAL}, {'reached' if least >= GOAL else 'missed'}: {least:.2f}")
        ratios[scene] = round(float(least), 3)
    if options.json:
        options.json.write_text(json.dumps(ratios))


if __name__ == "__main__":
    main()
