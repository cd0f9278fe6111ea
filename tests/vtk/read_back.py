"""Reads a VTK file with VTK and hands over all that is in it.

    python read_back.py FILE.vtu|FILE.vti|FILE.vtp|FILE.pvtu|FILE.pvti

Prints a line of JSON with the type of the data set and its arrays, then the arrays
themselves, each with its length in 64 bits before it. Fails if VTK says a word on the way.
"""

import json
import struct
import sys

from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOXML import (
    vtkXMLImageDataReader,
    vtkXMLPImageDataReader,
    vtkXMLPolyDataReader,
    vtkXMLPUnstructuredGridReader,
    vtkXMLUnstructuredGridReader,
)

READERS = dict(
    pvti=vtkXMLPImageDataReader,
    pvtu=vtkXMLPUnstructuredGridReader,
    vti=vtkXMLImageDataReader,
    vtp=vtkXMLPolyDataReader,
    vtu=vtkXMLUnstructuredGridReader,
)


def main(path):
    data, time = read(path)
    normals = data.GetPointData().GetNormals()
    header = dict(
        kind=data.GetClassName().removeprefix("vtk"),
        n_points=data.GetNumberOfPoints(),
        normals=None if normals is None else normals.GetName(),
    )
    numbers, header["texts"] = field_arrays(data.GetFieldData())
    header["time"] = time
    arrays = numbers + attribute_arrays(data.GetPointData()) + attribute_arrays(data.GetCellData())
    if header["kind"] == "ImageData":
        header.update(extent=data.GetExtent(), origin=data.GetOrigin(), spacing=data.GetSpacing())
    else:
        header.update(n_cells=data.GetNumberOfCells())
        arrays += mesh_arrays(data)
    header["arrays"] = [array for array, _ in arrays]
    sys.stdout.buffer.write(json.dumps(header).encode() + b"\n")
    for _, content in arrays:
        sys.stdout.buffer.write(struct.pack("=Q", len(content)) + content)


def read(path):
    reader = READERS[path.rsplit(".", 1)[1]]()
    complaints = []
    for speaker in (reader, vtkOutputWindow.GetInstance()):
        for event in ("ErrorEvent", "WarningEvent"):
            speaker.AddObserver(event, lambda _, event: complaints.append(event))
    if not reader.CanReadFile(path):
        sys.exit(f"{path}: {reader.GetClassName()} cannot read it")
    reader.SetFileName(path)
    reader.Update()
    if complaints or reader.GetErrorCode():
        sys.exit(f"{path}: VTK's error code is {reader.GetErrorCode()}, its events are {complaints}")
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    return reader.GetOutput(), times[0] if times else None


def field_arrays(fields):
    """The arrays of numbers of the field data, and the names of the others with their texts."""
    arrays = [fields.GetAbstractArray(i) for i in range(fields.GetNumberOfArrays())]
    is_text = [array.IsA("vtkStringArray") for array in arrays]
    texts = [(a.GetName(), [a.GetValue(i) for i in range(a.GetNumberOfValues())]) for a, t in zip(arrays, is_text) if t]
    return [described(a.GetName(), a) for a, t in zip(arrays, is_text) if not t], texts


def attribute_arrays(arrays):
    return [described(arrays.GetArrayName(i), arrays.GetArray(i)) for i in range(arrays.GetNumberOfArrays())]


def mesh_arrays(data):
    """Points and cells: those of a grid, with their types, or the lines of PolyData."""
    is_grid = data.IsA("vtkUnstructuredGrid")
    cells = data.GetCells() if is_grid else data.GetLines()
    offsets, ends = described("offsets", cells.GetOffsetsArray())
    types = bytes(data.GetCellType(i) for i in range(data.GetNumberOfCells()))
    return [
        described("Points", data.GetPoints().GetData()),
        described("connectivity", cells.GetConnectivityArray()),
        (offsets, ends[cells.GetOffsetsArray().GetDataTypeSize() :]),  # files leave out the 0 in front
    ] + [(dict(name="types", scalar="UInt8", n_components=1), types)] * is_grid


def described(name, array):
    """The array in words, its numbers called as in VTK's files, and its bytes."""
    c_type = array.GetDataTypeAsString()
    kind = "Float" if c_type in ("float", "double") else "UInt" if c_type.startswith("unsigned") else "Int"
    scalar = f"{kind}{8 * array.GetDataTypeSize()}"
    content = bytes(memoryview(array)) if array.GetNumberOfValues() else b""
    return dict(name=name, scalar=scalar, n_components=array.GetNumberOfComponents()), content


main(sys.argv[1])
