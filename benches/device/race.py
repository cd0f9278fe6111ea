"""Renders scenes on the processor and on other devices, in turns, and compares pixels, counters and times.

race.py PROGRAM [DEVICE ...]: a device is `opencl`, the default, or another one of `raycost render --device`.
Prints a table, and writes one JSON file for --json: for each scene and device the medians over all rounds of the render
stage's time and of the whole process's CPU time, as ratios processor / device (above 1, the device is faster), with
the totals of the counters. Ends with 1 if a pixel or a counter differs.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile

# A mesh, spheres, glass and a room of boxes; the first by direct light.
SCENES = ["spot", "million_spheres", "trellis", "glass", "cornell_box", "hall_of_mirrors"]
COUNTERS = ["node_visits", "primitive_tests", "rays"]


def pixels(png):
    """The compressed pixels of a PNG picture, without its texts, which name the settings."""
    found, at = b"", 8
    while at < len(png):
        length, kind = int.from_bytes(png[at:at + 4], "big"), png[at + 4:at + 8]
        found += png[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    return found


def render(program, scene, size, samples, device, folder):
    """Returns the wall time of the render stage and the CPU time of the process, in seconds, the totals of the
    counters, and the bytes of the picture."""
    out = os.path.join(folder, "out")
    width, height = size
    command = [program, "render", f"configs/{scene}.yaml", "--out", out, "--quiet", "--cost", "counters"]
    command += ["--width", str(width), "--height", str(height), "--spp", str(samples)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    # Large tiles make large launches.
    command += ["--device", device, "--set", "tiles.size=128"] if device else []
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file)
    with open(os.path.join(out, "image.png"), "rb") as file:
        picture = pixels(file.read())
    wall = next(stage["wall_ms"] for stage in summary["stages"] if stage["name"] == "render") / 1e3
    totals = summary["cost"]["totals"]
    return wall, cpu, {counter: totals[counter] for counter in COUNTERS}, picture, summary["acceleration"].get("device")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("devices", nargs="*", default=["opencl"])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--size", type=int, nargs=2, default=[640, 480])
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--scenes", nargs="*", default=SCENES)
    parser.add_argument("--json", metavar="FILE")
    arguments = parser.parse_args()
    results, differs = [], False
    with tempfile.TemporaryDirectory() as folder:
        for scene in arguments.scenes:
            runs = {device: [] for device in [None, *arguments.devices]}
            for _ in range(arguments.rounds):
                for device in runs:
                    run = render(arguments.program, scene, arguments.size, arguments.samples, device, folder)
                    runs[device].append(run)
            median = {device: [statistics.median(run[i] for run in runs[device]) for i in (0, 1)] for device in runs}
            expected = runs[None][0][2:4]
            for device in arguments.devices:
                same = all(run[2:4] == expected for run in runs[device])
                differs |= not same
                wall, cpu = (median[None][i] / median[device][i] for i in (0, 1))
                name = runs[device][0][4]
                print(f"{scene:16} {name}: render stage {wall:.2f}, CPU {cpu:.2f}, "
                      f"{'every bit equal' if same else 'DIFFERENT'}")
                results.append({
                    "scene": scene, "device": name, "is_equal": same, "speed_of_render_stage": round(wall, 3),
                    "speed_by_cpu_time": round(cpu, 3), "render_s": round(median[device][0], 4),
                    "render_on_processor_s": round(median[None][0], 4), "totals": expected[0],
                })
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump({"size": arguments.size, "samples": arguments.samples, "rounds": arguments.rounds,
                       "n_cpus": os.cpu_count(), "runs": results}, file, indent=1)
            file.write("\n")
    sys.exit(differs)


main()
