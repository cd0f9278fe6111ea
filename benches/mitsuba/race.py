"""Times raycost's render stage and Mitsuba 3's rendering of the same rays in turn.

    benches/mitsuba/run [MESH.obj] [--rounds N] [--size WIDTH HEIGHT] [--samples N] [--raycost PROGRAM]
        [--scalar] [--device DEVICE] [--json FILE]

A mesh on a floor, one point light, shadow rays, two threads on both sides. Mitsuba's `llvm_ad_rgb` renders
again and again in one process, so that its compilation and its scene do not count; raycost starts anew each
time, or renders three frames, of which the last one, whose memory is mapped, counts. Where the processor has
AVX-512, both also race with AVX2. With a DEVICE, raycost counts on it, and Mitsuba renders on the card if it is
`cuda`. Compares the fastest renderings; FILE gets the wall times of all rounds. The shading models differ in
constants, the rays and their number do not: fails if lit pixels are elsewhere.
Without a mesh, renders configs/meshes/spot.obj; the goal is that of the Stanford bunny, whose license
keeps it out of this repository.
"""

import argparse
import contextlib
import ctypes
import importlib.metadata
import json
import multiprocessing
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np
from PIL import Image

N_THREADS = 2
FOV_Y_DEG = 40
PEER = "Mitsuba llvm_ad_rgb"
OF_AVX2, PEER_OF_AVX2 = "raycost, counters, AVX2", f"{PEER}, AVX2"
COSTS = {f"raycost, {cost}": cost for cost in ["none", "counters", "time", "single_ray_time"]}
GOALS = {"counters": 1.0, "time": 0.5, "single_ray_time": 0.5}
# Share of all pixels: the patterns of samples differ, and with them the edges.
MOST_ELSEWHERE = 0.02
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


class Setting:
    """Where eye, light and floor are, from the box around the mesh."""

    def __init__(self, mesh, size, samples):
        self.size, self.samples = size, samples
        lines = (line.split() for line in mesh.read_text().splitlines())
        points = np.array([words[1:4] for words in lines if words and words[0] == "v"], dtype=float)
        low, high = points.min(axis=0), points.max(axis=0)
        center, size = (low + high) / 2, np.linalg.norm(high - low)
        self.mesh = mesh
        self.eye = center + size * np.array([-0.05, 0.2, 1.4])
        self.target = center - size * np.array([0, 0.04, 0])
        self.light = center + size * np.array([1.7, 2.8, 2])
        self.floor = np.array([center[0], low[1], center[2]])
        self.floor_extent = float(4 * size)

    def yaml(self):
        """raycost's scene."""
        width, height = self.size
        corners = self.floor + self.floor_extent * np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]])
        a, b, c, d = (corner.tolist() for corner in corners)
        return f"""
image: {{ width: {width}, height: {height}, samples_per_pixel: {self.samples} }}
camera:
  look_at: {{ eye: {self.eye.tolist()}, target: {self.target.tolist()}, fov_y_deg: {FOV_Y_DEG} }}
shading: {{ ambient: 0, max_depth: 1 }}
materials:
  clay: {{ color: [0.8, 0.6, 0.4] }}
  floor: {{ color: [0.5, 0.5, 0.5] }}
lights:
  - point: {{ position: {self.light.tolist()} }}
objects:
  - mesh: {{ file: {json.dumps(str(self.mesh))}, normals: flat }}
    material: clay
  - triangle: {{ vertices: [{a}, {b}, {c}] }}
    material: floor
  - triangle: {{ vertices: [{a}, {c}, {d}] }}
    material: floor
"""

    def mitsuba(self, mi):
        """The same scene; the light's intensity makes up for its distance."""
        width, height = self.size
        to_world = mi.ScalarTransform4f()
        floor = to_world.translate(self.floor.tolist()).rotate([1, 0, 0], -90).scale(self.floor_extent)
        intensity = 3 * float(np.sum((self.light - self.target) ** 2))

        def diffuse(*color):
            bsdf = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(color)}}
            return {"type": "twosided", "bsdf": bsdf}

        return mi.load_dict({
            "type": "scene",
            "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0},
            "sensor": {
                "type": "perspective",
                "fov": FOV_Y_DEG,
                "fov_axis": "y",
                "to_world": to_world.look_at(self.eye.tolist(), self.target.tolist(), [0, 1, 0]),
                "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}},
                "sampler": {"type": "independent", "sample_count": self.samples},
            },
            "mesh": {
                "type": "obj",
                "filename": str(self.mesh),
                "face_normals": True,
                "bsdf": diffuse(0.8, 0.6, 0.4),
            },
            "floor": {"type": "rectangle", "to_world": floor, "bsdf": diffuse(0.5, 0.5, 0.5)},
            "light": {
                "type": "point",
                "position": self.light.tolist(),
                "intensity": {"type": "rgb", "value": 3 * [intensity]},
            },
        })  # fmt: skip


class Mitsuba:
    """A variant of Mitsuba, its scene loaded, its kernel compiled."""

    def __init__(self, variant, setting):
        import drjit
        import mitsuba

        drjit.set_thread_count(N_THREADS)
        mitsuba.set_variant(variant)
        self.mitsuba, self.samples = mitsuba, setting.samples
        self.scene = setting.mitsuba(mitsuba)
        self.render_ms()

    def render_ms(self):
        """Wall time and CPU time."""
        start = time.perf_counter(), time.process_time()
        self.picture = np.array(self.mitsuba.render(self.scene, spp=self.samples))
        return 1e3 * (time.perf_counter() - start[0]), 1e3 * (time.process_time() - start[1])

    def lit(self):
        return self.picture[..., :3].max(axis=2) > 0.02


class MitsubaAvx2:
    """Mitsuba's LLVM variant compiled for eight lanes of AVX2, in a process of its own: the kernels of a
    process are of one width."""

    def __init__(self, setting):
        spawned = multiprocessing.get_context("spawn")
        self.pipe, pipe = spawned.Pipe()
        spawned.Process(target=self.serve, args=[pipe, setting], daemon=True).start()
        pipe.close()

    @staticmethod
    def serve(pipe, setting):
        import drjit
        import mitsuba

        mitsuba.set_variant("llvm_ad_rgb")
        core = ctypes.CDLL(str(next(pathlib.Path(drjit.__file__).parent.glob("libdrjit-core.*"))))
        # jit_llvm_set_target(processor, features, lanes): Haswell is the first processor with AVX2.
        core["_Z19jit_llvm_set_targetPKcS0_j"](b"haswell", None, 8)
        racer = Mitsuba("llvm_ad_rgb", setting)
        # Until the pipe is closed.
        with contextlib.suppress(EOFError):
            while True:
                pipe.send(getattr(racer, pipe.recv())())

    def ask(self, request):
        self.pipe.send(request)
        return self.pipe.recv()

    def render_ms(self):
        return self.ask("render_ms")

    def lit(self):
        return self.ask("lit")


class Raycost:
    """The program, a process for each rendering."""

    # The folder of the output in `out`.
    frame = "."

    def __init__(self, program, folder, setting, *options):
        self.scene, self.out = folder / "scene.yaml", folder / "_".join([type(self).__name__, *options])
        self.text = setting.yaml()
        self.command = [program, "render", self.scene, "--repeats=1", "--quiet", *options, "--out", self.out]

    def render_ms(self):
        """Wall time and CPU time."""
        self.scene.write_text(self.text)
        subprocess.run(self.command, check=True)
        stages = json.loads((self.out / self.frame / "summary.json").read_text())["stages"]
        render = next(stage for stage in stages if stage["name"] == "render")
        return render["wall_ms"], render["cpu_ms"]

    def lit(self):
        image = Image.open(self.out / self.frame / "image.png")
        return np.asarray(image.convert("RGB")).max(axis=2) > 5


class ThirdFrame(Raycost):
    """The same picture as the last one of an animation's three."""

    frame = "frames/0002"

    def __init__(self, *arguments):
        super().__init__(*arguments)
        keyframes = f"camera.look_at.fov_y_deg: [{{ frame: 0, value: {FOV_Y_DEG} }}]"
        self.text += f"animation:\n  frames: 3\n  keyframes:\n    {keyframes}\n"

    def render_ms(self):
        # Complete frames are not rendered again.
        shutil.rmtree(self.out, ignore_errors=True)
        return super().render_ms()


def race(racers, n_rounds):
    times = {name: [] for name in racers}
    for _ in range(n_rounds):
        for name, racer in racers.items():
            times[name].append(racer.render_ms())
    return times


def on_processor(options, folder, setting):
    """All racers, the peer last."""
    to = options.raycost.resolve(), folder, setting, f"--threads={N_THREADS}"
    racers = {name: Raycost(*to, f"--cost={cost}") for name, cost in COSTS.items()}
    racers["raycost, counters, third frame"] = ThirdFrame(*to, "--cost=counters")
    if "avx512f" in pathlib.Path("/proc/cpuinfo").read_text():
        racers[OF_AVX2] = Raycost(*to, "--cost=counters", "--simd=avx2")
        racers[PEER_OF_AVX2] = MitsubaAvx2(setting)
    if options.scalar:
        racers["Mitsuba scalar_rgb"] = Mitsuba("scalar_rgb", setting)
    return racers | {PEER: Mitsuba("llvm_ad_rgb", setting)}


def on_device(options, folder, setting):
    """raycost on a device, and Mitsuba on NVIDIA's card or on the processor."""
    # Large tiles make large launches.
    flags = ["--cost=counters", f"--device={options.device}", "--tile-size=256"]
    racers = {"raycost, counters": Raycost(options.raycost.resolve(), folder, setting, *flags)}
    variant = "cuda_ad_rgb" if options.device.startswith("cuda") else "llvm_ad_rgb"
    return racers | {f"Mitsuba {variant}": Mitsuba(variant, setting)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="?", type=pathlib.Path, default=ROOT / "configs/meshes/spot.obj")
    parser.add_argument("--rounds", type=int, default=9, metavar="N")
    parser.add_argument("--raycost", type=pathlib.Path, default=ROOT / "target/release/raycost", metavar="PROGRAM")
    parser.add_argument("--size", type=int, nargs=2, default=[1600, 1200], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--samples", type=int, default=4, metavar="N")
    parser.add_argument("--device", help="of raycost; with `cuda`, Mitsuba renders on the card, too")
    parser.add_argument("--scalar", action="store_true", help="also race Mitsuba's scalar_rgb")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE")
    options = parser.parse_args()
    setting = Setting(options.mesh.resolve(), options.size, options.samples)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        # The last is the one that docs/condense compares the others with.
        racers = on_device(options, folder, setting) if options.device else on_processor(options, folder, setting)
        peer = list(racers)[-1]
        times = race(racers, options.rounds)
        lit = [racer.lit() for racer in racers.values()]
    # The least wall time and the least CPU time of each.
    least = {name: [min(values) for values in zip(*pairs)] for name, pairs in times.items()}
    print("                              wall             CPU")
    for name, [wall, cpu] in least.items():
        ratio, of_cpu = (first / own for first, own in zip(least[peer], [wall, cpu]))
        goal = GOALS.get(COSTS.get(name))
        verdict = "" if goal is None else f"   goal {goal}, {'reached' if ratio >= goal else 'missed'}"
        print(f"{name:25}{wall:6.0f} ms {ratio:5.2f}{cpu:8.0f} ms {of_cpu:5.2f}{verdict}")
    if options.json:
        walls = {name: [wall for wall, _ in pairs] for name, pairs in times.items()}
        setup = {"mitsuba": importlib.metadata.version("mitsuba"), "mesh": setting.mesh.stem, "threads": N_THREADS}
        setup |= {"width": options.size[0], "height": options.size[1], "samples": options.samples}
        setup["bases"] = {OF_AVX2: PEER_OF_AVX2} if OF_AVX2 in racers else {}
        options.json.write_text(json.dumps({**setup, "times_ms": walls}))
    elsewhere = max(np.mean(lit[0] != other) for other in lit)
    print(f"lit pixels {100 * np.mean(lit[0]):.1f} %, elsewhere {100 * elsewhere:.2f} %")
    if elsewhere > MOST_ELSEWHERE:
        sys.exit("lit pixels are elsewhere")


if __name__ == "__main__":
    main()
