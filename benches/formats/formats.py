"""Times VTK's file formats with the cloud of hit points of a scene: formats.py RAYCOST [--json FILE]

Each round writes and reads hits.vtu once in each format by VTK's own writers and readers, in turn, so that
formats differ only in how they store the same arrays. Fails if an array that was read is not the one written.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy as np
import vtk
from vtkmodules.numpy_interface import dataset_adapter

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = "sphere_cloud"
N_ROUNDS = 9


def xml(mode, compressor=None):
    """A writer of `.vtu` files with this data mode."""

    def make():
        writer = vtk.vtkXMLUnstructuredGridWriter()
        getattr(writer, f"SetDataModeTo{mode}")()
        writer.EncodeAppendedDataOff()
        getattr(writer, f"SetCompressorTypeTo{compressor or 'None'}")()
        return writer

    return make


# Ending, writer and reader of each format.
FORMATS = {
    "ASCII": ("vtu", xml("Ascii"), vtk.vtkXMLUnstructuredGridReader),
    "base64": ("vtu", xml("Binary"), vtk.vtkXMLUnstructuredGridReader),
    "appended": ("vtu", xml("Appended"), vtk.vtkXMLUnstructuredGridReader),
    "zlib": ("vtu", xml("Appended", "ZLib"), vtk.vtkXMLUnstructuredGridReader),
    "LZ4": ("vtu", xml("Appended", "LZ4"), vtk.vtkXMLUnstructuredGridReader),
    "VTKHDF": ("vtkhdf", vtk.vtkHDFWriter, vtk.vtkHDFReader),
}


def write(make, cloud, path):
    writer = make()
    writer.SetFileName(str(path))
    writer.SetInputDataObject(cloud)
    start = time.perf_counter()
    if not writer.Write():
        raise SystemExit(f"{path.name}: VTK could not write it")
    return 1e3 * (time.perf_counter() - start)


def read(make, path):
    reader = make()
    reader.SetFileName(str(path))
    start = time.perf_counter()
    reader.Update()
    return 1e3 * (time.perf_counter() - start), reader.GetOutputDataObject(0)


def same(one, other):
    """Whether both clouds have the same points and point arrays, bit for bit."""
    one, other = (dataset_adapter.WrapDataObject(cloud) for cloud in (one, other))
    names = set(one.PointData.keys())
    equal = (np.array_equal(one.PointData[name], other.PointData[name], equal_nan=True) for name in names)
    return names <= set(other.PointData.keys()) and np.array_equal(one.Points, other.Points) and all(equal)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("raycost")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE")
    options = parser.parse_args()
    result = {name: {"format": name, "write_ms": [], "read_ms": []} for name in FORMATS}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        render = ["render", f"configs/{SCENE}.yaml", "--width=960", "--height=720", "--cost=counters", "--quiet"]
        subprocess.run([options.raycost, *render, "--out", folder / "out"], cwd=ROOT, check=True)
        _, cloud = read(vtk.vtkXMLUnstructuredGridReader, folder / "out" / "hits.vtu")
        for _ in range(N_ROUNDS):
            for name, (ending, writer, reader) in FORMATS.items():
                path = folder / f"{name}.{ending}"
                path.unlink(missing_ok=True)
                result[name]["write_ms"].append(write(writer, cloud, path))
                ms, found = read(reader, path)
                result[name]["read_ms"].append(ms)
                result[name]["bytes"] = path.stat().st_size
                if not same(cloud, found):
                    raise SystemExit(f"{name}: an array is not the one that was written")
    for name, row in result.items():
        write_ms, read_ms = (statistics.median(row[key]) for key in ["write_ms", "read_ms"])
        print(f"{name:<9} {row['bytes']:>10,} bytes, written in {write_ms:7.1f} ms, read in {read_ms:7.1f} ms")
    if options.json:
        made_by = {"vtk": vtk.vtkVersion().GetVTKVersion(), "scene": SCENE}
        measured = {**made_by, "n_points": cloud.GetNumberOfPoints(), "rows": list(result.values())}
        options.json.write_text(json.dumps(measured, indent=1) + "\n")


if __name__ == "__main__":
    main()
