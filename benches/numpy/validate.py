"""Compares raycost with the course's NumPy model: validate.py RAYCOST OUT.json [--quick]

Writes four comparisons as JSON: images and counts against those of the course's model in
tests/reference; the same against tests/numpy/seed_model.py on random scenes; images of the first
scene against sphere.py, the model as a loop over pixels; and the times of both for these, whole
processes in turn. Fails if an image differs from the model's. `--quick` leaves out the largest image,
which takes the loop some seconds.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.append(str(ROOT / "tests" / "numpy"))

from compare import comparisons, difference, is_the_models, rendered  # noqa: E402

REFERENCE = ROOT / "tests" / "reference"
SIZES = [100, 400, 700]
N_ROUNDS = 9
# Share of all pixels, as in tests/engine/seed_reference.rs: 32-bit rounding decides on edges.
MOST_BEYOND_1 = 1e-3


def render(raycost, scene, width, height, folder):
    """Returns the image and the totals of the run."""
    size = ["--width", str(width), "--height", str(height)]
    scene = ROOT / "configs" / f"{scene}.yaml"
    subprocess.run([raycost, "render", scene, *size, "--repeats=1", "--quiet", "--out", folder], check=True)
    summary = json.loads((folder / "summary.json").read_text())
    counts = {"hits": summary["n_hits"], **summary["cost"]["totals"]}
    return rendered(folder / "image.png"), counts


def against_reference(raycost, folder):
    facts = json.loads((REFERENCE / "facts.json").read_text())
    for name, expected in facts.items():
        scene, size = name.rsplit("_", 1)
        width, height = map(int, size.split("x"))
        ours, counts = render(raycost, scene, width, height, folder / "out")
        yield {
            "scene": scene,
            "width": width,
            "height": height,
            **difference(ours, rendered(REFERENCE / f"{name}.png")),
            "counts": [
                {"name": name, "raycost": counts[name], "numpy": n} for name, n in expected.items()
            ],
        }


def against_loop(raycost, folder, sizes):
    for size in sizes:
        png, out = folder / "numpy.png", folder / "out"
        times = {"numpy_ms": [], "raycost_ms": []}
        for _ in range(N_ROUNDS):
            start = time.perf_counter()
            subprocess.run([sys.executable, HERE / "sphere.py", str(size), str(size), png], check=True)
            middle = time.perf_counter()
            ours, _ = render(raycost, "seed_sphere", size, size, out)
            times["numpy_ms"].append(1e3 * (middle - start))
            times["raycost_ms"].append(1e3 * (time.perf_counter() - middle))
        yield {"width": size, "height": size, **difference(ours, rendered(png)), **times}


def main():
    raycost, result = sys.argv[1], pathlib.Path(sys.argv[2])
    sizes = SIZES[:2] if "--quick" in sys.argv else SIZES
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        found = {
            "reference": list(against_reference(raycost, folder)),
            "random": list(comparisons(raycost, folder)),
            "loop": list(against_loop(raycost, folder, sizes)),
        }
    result.write_text(json.dumps(found, indent=1) + "\n")
    for case in [*found["reference"], *found["loop"]]:
        if case["n_beyond_1"] > MOST_BEYOND_1 * case["n_pixels"]:
            sys.exit(f"not the picture of the NumPy model: {case}")
    for case in found["random"]:
        if not is_the_models(case):
            sys.exit(f"not the picture of the NumPy model: random scene {case}")


if __name__ == "__main__":
    main()
