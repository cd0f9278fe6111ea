"""Times the NumPy loop and raycost in turn, whole processes: race.py RAYCOST [ROUNDS]

Both render the course's sphere at 400 x 400, raycost with all its files. Prints medians and the
ratio, and fails if the pictures differ by more than a rounding.
"""

import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
from PIL import Image

SIDE = "400"
GOAL = 100
HERE = pathlib.Path(__file__).resolve().parent
SCENE = HERE.parent.parent / "configs" / "seed_sphere.yaml"


def seconds(command):
    start = time.perf_counter()
    subprocess.run(command, check=True)
    return time.perf_counter() - start


def rendered(path):
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def main():
    raycost = sys.argv[1]
    n_rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 9
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        numpy_png, out = folder / "numpy.png", folder / "out"
        loop = [sys.executable, HERE / "sphere.py", SIDE, SIDE, numpy_png]
        render = [raycost, "render", SCENE, "--width", SIDE, "--height", SIDE, "--repeats=1",
                  "--quiet", "--out", out]
        times = {"NumPy loop": [], "raycost": []}
        for _ in range(n_rounds):
            times["NumPy loop"].append(seconds(loop))
            # Several runs per run of the loop, since they are short.
            times["raycost"] += [seconds(render) for _ in range(5)]
        difference = np.abs(rendered(numpy_png) - rendered(out / "image.png")).max()
        stages = json.loads((out / "summary.json").read_text())["stages"]
    medians = {name: statistics.median(values) for name, values in times.items()}
    for name, median in medians.items():
        print(f"{name:12}{1e3 * median:9.1f} ms, least {1e3 * min(times[name]):.1f} ms")
    print("of that     " + ", ".join(f"{stage['name']} {stage['wall_ms']:.1f} ms" for stage in stages))
    ratio = medians["NumPy loop"] / medians["raycost"]
    print(f"ratio       {ratio:9.1f}, goal {GOAL}: {'reached' if ratio >= GOAL else 'missed'}")
    print(f"pictures    {difference} of 255 apart at most")
    return 0 if difference <= 1 else 1


if __name__ == "__main__":
    sys.exit(main())
