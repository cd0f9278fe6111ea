"""Compares idle lanes with those that a device of lockstep lanes counts: compare.py RAYCOST FOLDER

Renders scenes with the program RAYCOST, which predicts idle lanes from the steps of rays, and traces the same
pixels with it for the steps of each ray. Puts the rays in launches and in an order, by a definition written
once more here, and lets each take its steps on an OpenCL device: the device counts the steps of its lanes
and of its warps. FOLDER gets the files of raycost.
"""

import csv
import itertools
import json
import math
import pathlib
import subprocess
import sys

import numpy as np
import pyopencl as cl

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SCENES = {
    "spot": ["--width=300", "--height=40", "--spp=1"],
    "glass": ["--width=96", "--height=60", "--spp=1"],
    "cornell_box": ["--width=64", "--height=48", "--spp=2"],
}
LAUNCH_SIDE = 256
TILE_SIZE = 16
GROUP = 64  # lanes of a work group, a multiple of each size of warp


def keys(order, materials):
    """What a ray is sorted by, after its launch."""
    tiles = lambda ray: (ray["y"] // 4, ray["x"] // 8, ray["y"] % 4, ray["x"] % 8)
    bits = lambda n: f"{n:08b}"
    signs = lambda ray: [math.copysign(1, d) < 0 for d in reversed(ray["direction"])]
    return {
        "rows": lambda ray: (ray["y"], ray["x"]),
        "tiles": tiles,
        "morton": lambda ray: [b + a for a, b in zip(bits(ray["x"] % 256), bits(ray["y"] % 256))],
        "waves": lambda ray: [
            tuple(ray[axis] // side % wrap for axis in "yx")
            for side, wrap in ((TILE_SIZE, 1 << 16), (4, TILE_SIZE // 4), (1, 4))
        ],
        "octant": lambda ray: (signs(ray), tiles(ray)),
        "material": lambda ray: (materials.index(ray["from"]), tiles(ray)),
    }[order]


def traced(raycost, scene, flags, folder):
    """All rays of a picture, each with its pixel, its launch, and the material that it starts from."""
    [width, height] = [int(flag.split("=")[1]) for flag in flags[:2]]
    pixels = f"--pixel=0..{width - 1},0..{height - 1}"
    command = [raycost, "trace", scene, *flags, "--cost=counters", "--json", pixels, "--out", folder / "trace"]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        for line in process.stdout:
            pixel = json.loads(line)
            yield from with_launches(pixel)
    assert process.returncode == 0


def with_launches(pixel):
    """The rays of a pixel."""
    x, y = pixel["pixel"]
    shadows = {}
    for ray in pixel["rays"]:
        kind = ray["kind"] if ray["kind"] in ("camera", "shadow") else "bounce"
        number = 0
        if kind == "shadow":
            number = shadows.get(ray["parent"], 0)
            shadows[ray["parent"]] = number + 1
        parent = None if ray["parent"] is None else pixel["rays"][ray["parent"]]
        yield {
            "x": x,
            "y": y,
            "kind": kind,
            "launch": (y // LAUNCH_SIDE, x // LAUNCH_SIDE, ray["sample"], ray["bounce"], number),
            "direction": ray["direction"],
            "from": parent["hit"]["material"] if parent and parent["hit"] else None,
            "steps": ray["node_visits"] + ray["primitive_tests"],
        }


class Device:
    """A device whose sub-groups run in lockstep."""

    def __init__(self, device):
        self.context = cl.Context([device])
        self.queue = cl.CommandQueue(self.context)
        source = (ROOT / "tests/opencl/lockstep.cl").read_text()
        self.kernel = cl.Kernel(cl.Program(self.context, source).build(options=["-cl-std=CL3.0"]), "trace")
        info = cl.kernel_sub_group_info.MAX_SUB_GROUP_SIZE_FOR_NDRANGE
        self.warp = self.kernel.get_sub_group_info(device, info, (GROUP,))

    def sums(self, launches):
        """The steps of the rays, and those of all lanes, of launches that fill warps one by one."""
        padded = [np.pad(np.array(steps, np.uint32), (0, -len(steps) % GROUP)) for steps in launches]
        steps = np.concatenate(padded)
        flags = cl.mem_flags
        rays = cl.Buffer(self.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=steps)
        counted = [cl.Buffer(self.context, flags.WRITE_ONLY, steps.nbytes) for _ in range(2)]
        self.kernel(self.queue, steps.shape, (GROUP,), rays, *counted)
        for buffer in counted:
            found = np.empty_like(steps)
            cl.enqueue_copy(self.queue, found, buffer)
            yield int(found.sum(dtype=np.uint64))


def predicted(file):
    """The sums that raycost predicts, by kind of ray, order and size of warp."""
    with open(file, newline="") as rows:
        return {
            (row["ray_kind"], row["order"], int(row["warp"])): (int(row["steps"]), int(row["lane_steps"]))
            for row in csv.DictReader(rows)
        }


def compare(raycost, device, name, folder):
    """Checks all kinds of rays in all orders. Returns the number of checks."""
    scene, flags = ROOT / f"configs/{name}.yaml", SCENES[name]
    tiles = f"--tile-size={TILE_SIZE}"
    command = [raycost, "render", scene, *flags, tiles, "--cost=counters", "--also=lanes", "--quiet"]
    subprocess.run([*command, "--out", folder / "render"], check=True)
    shares = predicted(folder / "render/lanes.csv")
    # After all others where there is none.
    materials = json.loads((folder / "render/summary.json").read_text())["materials"] + [None]
    rays = list(traced(raycost, scene, flags, folder))
    n = 0
    for order in ("rows", "tiles", "morton", "waves", "octant", "material"):
        key = keys(order, materials)
        for kind in ("camera", "shadow", "bounce"):
            of_kind = [ray for ray in rays if ray["kind"] == kind]
            of_kind.sort(key=lambda ray: (ray["launch"], key(ray)))
            launches = itertools.groupby(of_kind, key=lambda ray: ray["launch"])
            launches = [[ray["steps"] for ray in launch] for _, launch in launches]
            if not launches:
                continue
            measured = tuple(device.sums(launches))
            expected = shares[kind, order, device.warp]
            idle = [1 - steps / lanes for steps, lanes in (measured, expected)]
            print(f"{name:12} {kind:7} {order:9} idle of {device.warp}: measured {idle[0]:.4f}, predicted {idle[1]:.4f}")
            assert measured == expected, (measured, expected)
            n += 1
    return n


def main():
    raycost, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    devices = [device for platform in cl.get_platforms() for device in platform.get_devices()]
    device = Device(devices[0])
    print(f"{devices[0].name}: sub-groups of {device.warp} lanes")
    if device.warp not in (8, 16, 32, 64):
        return print(f"tests/with-opencl: 0 passed; 0 failed; skipped: warps of {device.warp} lanes")
    n = sum(compare(raycost, device, name, folder / name) for name in SCENES)
    print(f"tests/with-opencl: {n} passed; 0 failed; the files are in {folder}/")


main()
