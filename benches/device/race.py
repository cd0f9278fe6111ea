"""Renders scenes on the processor and on other devices, compares every pixel and counter, and measures what a card is
worth.

    benches/device/run [DEVICE ...] [--rows-on DEVICE] [--json FILE]; RAYCOST=PROGRAM renders

A device is one of `raycost render --device`; if none is named, `cuda` and `opencl` are asked for. Renders all scenes of
configs/, small; then races some of them, in turns: a table with the medians over all rounds of the render stage's time and
of the whole process's CPU time as ratios processor / device (above 1, the device is faster). The rows with goals are
measured on the device of --rows-on, or else on a CUDA card; without one they stay empty. They need Mitsuba and Warp in
target/: benches/mitsuba/run installs the one, and `python3 -m venv target/warp; target/warp/bin/pip install numpy
warp-lang` the other; without them, their rows say so. FILE gets all.
Ends with 1 if a pixel or a counter differs. Takes ten minutes on a card.
"""

import argparse
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile

# A mesh, spheres, glass and a room of boxes; the first by direct light.
SCENES = ["spot", "million_spheres", "trellis", "glass", "cornell_box", "hall_of_mirrors"]
COUNTERS = ["node_visits", "primitive_tests", "rays"]
# The rows with goals: the work, the anchor, and the least ratio of speeds.
MESH = "mesh, direct light, 1920 x 1080, 64 samples, render stage"
ROWS = [
    (MESH, "all processors", 20),
    (MESH, "itself without counters", 0.95),
    (MESH, "Mitsuba's cuda_ad_rgb", 1),
    ("path tracing, time to equal variance", "Mitsuba's cuda_ad_rgb", 1.5),
    ("rays, by the time of kernels", "Warp's mesh_query_ray", 1.5),
]
NO_CARD = len(ROWS) * ["no CUDA card, and no --rows-on"]


def pixels(png):
    """The compressed pixels of a PNG picture, without its texts, which name the settings."""
    found, at = b"", 8
    while at < len(png):
        length, kind = int.from_bytes(png[at:at + 4], "big"), png[at + 4:at + 8]
        found += png[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    return found


def render(program, scene, size, samples, device, folder, cost="counters"):
    """Returns the wall time of the render stage and the CPU time of the process, in seconds, the totals of the
    counters, and the bytes of the picture."""
    out = os.path.join(folder, "out")
    width, height = size
    shutil.rmtree(out, ignore_errors=True)
    command = [program, "render", f"configs/{scene}.yaml", "--out", out, "--quiet", "--cost", cost]
    command += ["--width", str(width), "--height", str(height), "--spp", str(samples)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    # Large tiles make large launches.
    command += ["--device", device, "--tile-size=256"] if device else []
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    # Of an animation, the first frame.
    frame = os.path.join(out, "frames", "0000")
    out = frame if os.path.isdir(frame) else out
    with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file)
    with open(os.path.join(out, "image.png"), "rb") as file:
        picture = pixels(file.read())
    wall = next(stage["wall_ms"] for stage in summary["stages"] if stage["name"] == "render") / 1e3
    totals = summary["cost"]["totals"] if cost == "counters" else {}
    return wall, cpu, {counter: totals.get(counter) for counter in COUNTERS}, picture


def names(program, devices, folder):
    """The name of each device, or the reason why it cannot render."""
    found, missing = {}, {}
    for device in devices:
        command = [program, "render", "configs/seed_sphere.yaml", "--width=16", "--height=12", "--device", device]
        done = subprocess.run([*command, "--out", folder, "--quiet"], capture_output=True, text=True)
        if done.returncode:
            missing[device] = done.stderr.splitlines()[0]
        else:
            with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
                found[device] = json.load(file)["acceleration"]["device"]
        print(f"{device}: {found.get(device) or missing[device]}")
    return found, missing


def differing(program, device, folder):
    """The scenes of which a pixel or a counter differs, rendered small; of an animation the first frame."""
    scenes = sorted(name.removesuffix(".yaml") for name in os.listdir("configs") if name.endswith(".yaml"))
    differ = []
    for scene in scenes:
        runs = [render(program, scene, (64, 48), 2, on, folder) for on in (None, device)]
        if runs[0][2:4] != runs[1][2:4]:
            differ.append(scene)
    print(f"{device}: {len(scenes) - len(differ)} of {len(scenes)} scenes have every bit equal {' '.join(differ)}")
    return {"scenes": len(scenes), "differ": differ}


def race(program, devices, options, folder):
    """Races of the scenes, one row for each scene and device."""
    results = []
    for scene in options.scenes:
        runs = {device: [] for device in [None, *devices]}
        for _ in range(options.rounds):
            for device in runs:
                runs[device].append(render(program, scene, options.size, options.samples, device, folder))
        median = {device: [statistics.median(run[i] for run in runs[device]) for i in (0, 1)] for device in runs}
        expected = runs[None][0][2:4]
        for device, name in devices.items():
            same = all(run[2:4] == expected for run in runs[device])
            wall, cpu = (median[None][i] / median[device][i] for i in (0, 1))
            print(f"{scene:16} {name}: render stage {wall:.2f}, CPU {cpu:.2f}, "
                  f"{'every bit equal' if same else 'DIFFERENT'}")
            results.append({
                "scene": scene, "device": name, "is_equal": same, "speed_of_render_stage": round(wall, 3),
                "speed_by_cpu_time": round(cpu, 3), "render_s": round(median[device][0], 4),
                "render_on_processor_s": round(median[None][0], 4), "totals": expected[0],
            })
    return results


def measured(program, device, folder):
    """The ratios of each row by case, or why there are none. Where the device is not a CUDA card, Mitsuba and Warp run on
    the processor."""
    size, samples, file = (1920, 1080), 64, os.path.join(folder, "peer.json")
    walls = {
        (on, cost): statistics.median(render(program, "spot", size, samples, on, folder, cost)[0] for _ in range(3))
        for on, cost in [(None, "counters"), (device, "counters"), (device, "none")]
    }
    yield {"spot": walls[None, "counters"] / walls[device, "counters"]}
    yield {"spot": walls[device, "none"] / walls[device, "counters"]}
    flags = ["--raycost", program, "--device", device, "--json", file]

    def mitsuba(script, *more):
        """What a script wrote, or the last line of its failure."""
        return written("target/mitsuba/bin/python", [f"benches/mitsuba/{script}.py", *more, *flags], file)

    found = mitsuba("race", "--size", *map(str, size), "--samples", str(samples), "--rounds=3")
    if isinstance(found, dict):
        least = {name: min(times) for name, times in found["times_ms"].items()}
        found = {"spot": list(least.values())[-1] / least["raycost, counters"]}
    yield found
    yield mitsuba("variance", "cornell_box", "glass_sphere")
    on = "cuda:0" if device.startswith("cuda") else "cpu"
    found = written("target/warp/bin/python", ["benches/device/rays.py", program, device, on, file], file)
    if isinstance(found, dict):
        races = found["races"]
        found = {f"{kind}, {race['triangles']}": ratio for race in races for kind, ratio in race["ratios"].items()}
    yield found


def written(python, arguments, file):
    """The JSON file that a script of a virtual environment writes, or why there is none."""
    if not os.path.exists(python):
        return f"{os.path.dirname(os.path.dirname(python))} is not installed"
    done = subprocess.run([python, *arguments], capture_output=True, text=True)
    if done.returncode:
        return (done.stderr.strip().splitlines() or ["no message"])[-1]
    with open(file, encoding="utf-8") as content:
        return json.load(content)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("devices", nargs="*")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--size", type=int, nargs=2, default=[640, 480])
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--scenes", nargs="*", default=SCENES)
    parser.add_argument("--rows-on", metavar="DEVICE")
    parser.add_argument("--json", metavar="FILE")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        asked = options.devices or ["cuda", "opencl"]
        devices, missing = names(options.program, asked, folder)
        agreement = {device: differing(options.program, device, folder) for device in devices}
        runs = race(options.program, devices, options, folder)
        on = options.rows_on or ("cuda" if "cuda" in devices else None)
        table = []
        for (work, anchor, goal), found in zip(ROWS, measured(options.program, on, folder) if on else NO_CARD):
            print(f"{work}, over {anchor}:", end=" ", flush=True)
            if isinstance(found, dict):
                cases = ", ".join(f"{ratio:.2f} ({case})" for case, ratio in found.items())
                print(f"{cases}; goal {goal}, {'reached' if min(found.values()) >= goal else 'missed'}")
            else:
                print(f"not measured: {found}")
            table.append({"work": work, "anchor": anchor, "goal": goal, "device": on, "found": found})
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump({"size": options.size, "samples": options.samples, "rounds": options.rounds,
                       "n_cpus": os.cpu_count(), "missing": missing, "agreement": agreement, "rows": table,
                       "runs": runs}, file, indent=1)
            file.write("\n")
    if any(found["differ"] for found in agreement.values()) or not all(run["is_equal"] for run in runs):
        sys.exit(1)


main()
