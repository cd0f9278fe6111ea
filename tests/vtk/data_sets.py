"""Writes data sets of all kinds with VTK, in all of its formats and encodings, and what VTK
says of their surfaces.

    python data_sets.py FOLDER

Prints a line of JSON for each file: its name, whether it is to be read as spheres, and of
its surface the bounds, the area, and for each array the range over the surface.
"""

import json
import math
import sys
from pathlib import Path

from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import (
    vtkCellArray,
    vtkImageData,
    vtkMultiBlockDataSet,
    vtkPolyData,
    vtkRectilinearGrid,
    vtkStructuredGrid,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkIOLegacy import vtkDataSetWriter
from vtkmodules.vtkIOParallelXML import vtkXMLPPolyDataWriter, vtkXMLPUnstructuredGridWriter
from vtkmodules.vtkIOXML import (
    vtkXMLImageDataWriter,
    vtkXMLMultiBlockDataWriter,
    vtkXMLPolyDataWriter,
    vtkXMLRectilinearGridWriter,
    vtkXMLStructuredGridWriter,
    vtkXMLUnstructuredGridWriter,
)

WRITERS = dict(
    vtp=vtkXMLPolyDataWriter,
    vtu=vtkXMLUnstructuredGridWriter,
    vts=vtkXMLStructuredGridWriter,
    vtr=vtkXMLRectilinearGridWriter,
    vti=vtkXMLImageDataWriter,
)

# The linear cells by their VTK types, each with its corners in a box of its own, and
# quadratic ones with the points on their edges.
CELLS = {
    5: [(0, 0, 0), (1, 0, 0), (0, 1, 0)],
    6: [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (2, 0, 0)],
    7: [(0, 0, 0), (1, 0, 0), (1.5, 1, 0), (0.5, 1.5, 0), (-0.2, 1, 0)],
    8: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)],
    9: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
    10: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    11: [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)],
    12: [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))],
    13: [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (0, 1), (1, 0))],
    14: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)],
    15: [(math.cos(a * math.tau / 5), math.sin(a * math.tau / 5), z) for z in (0, 1) for a in range(5)],
    16: [(math.cos(a * math.tau / 6), math.sin(a * math.tau / 6), z) for z in (0, 1) for a in range(6)],
    22: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0)],
    24: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0), (0, 0, 0.5), (0.5, 0, 0.5), (0, 0.5, 0.5)],
    3: [(0, 0, 0), (1, 0, 0)],
    1: [(0, 0, 0)],
}


def add_arrays(data):
    """A scalar and a vector of points, and a scalar of cells."""
    points = range(data.GetNumberOfPoints())
    height, speed, number = vtkDoubleArray(), vtkFloatArray(), vtkFloatArray()
    height.SetName("height of it")
    speed.SetName("speed")
    speed.SetNumberOfComponents(3)
    number.SetName("number")
    for i in points:
        x, y, z = data.GetPoint(i)
        height.InsertNextValue(z + 0.25 * x)
        speed.InsertNextTuple3(x, -y, 0.5 * z)
    for i in range(data.GetNumberOfCells()):
        number.InsertNextValue(i)
    data.GetPointData().AddArray(height)
    data.GetPointData().AddArray(speed)
    data.GetCellData().AddArray(number)
    return data


def cells():
    """Two of each cell, the second of which shares a face with the first where it is solid."""
    grid, points = vtkUnstructuredGrid(), vtkPoints()
    grid.SetPoints(points)
    for at, (kind, corners) in enumerate(CELLS.items()):
        ids = [points.InsertNextPoint(x + 3 * at, y, z) for x, y, z in corners]
        grid.InsertNextCell(kind, len(ids), ids)
    return add_arrays(grid)


def blocks(n):
    """A block of n³ hexahedra, one fifth of which are split into tetrahedra or wedges."""
    grid, points = vtkUnstructuredGrid(), vtkPoints()
    grid.SetPoints(points)
    for z in range(n + 1):
        for y in range(n + 1):
            for x in range(n + 1):
                points.InsertNextPoint(x / n, y / n + 0.1 * math.sin(3 * x / n), z / n)
    at = lambda x, y, z: x + (n + 1) * (y + (n + 1) * z)
    for z in range(n):
        for y in range(n):
            for x in range(n):
                low = [at(x, y, z), at(x + 1, y, z), at(x + 1, y + 1, z), at(x, y + 1, z)]
                high = [at(x, y, z + 1), at(x + 1, y, z + 1), at(x + 1, y + 1, z + 1), at(x, y + 1, z + 1)]
                if x == n - 1:
                    for a, b, c in ((0, 2, 1), (0, 3, 2)):
                        grid.InsertNextCell(13, 6, [low[a], low[b], low[c], high[a], high[b], high[c]])
                else:
                    grid.InsertNextCell(12, 8, low + high)
    return add_arrays(grid)


def polygons():
    data, points = vtkPolyData(), vtkPoints()
    data.SetPoints(points)
    kinds = [vtkCellArray() for _ in range(4)]
    for at, kind in enumerate((1, 3, 5, 7, 6)):
        corners = CELLS[kind]
        ids = [points.InsertNextPoint(x + 3 * at, y, z + 0.1 * x) for x, y, z in corners]
        array = kinds[{1: 0, 3: 1, 5: 2, 7: 2, 6: 3}[kind]]
        array.InsertNextCell(len(ids), ids)
    data.SetVerts(kinds[0])
    data.SetLines(kinds[1])
    data.SetPolys(kinds[2])
    data.SetStrips(kinds[3])
    return add_arrays(data)


def image():
    data = vtkImageData()
    data.SetExtent(-2, 3, 1, 5, 0, 4)
    data.SetOrigin(0.5, -1, 2)
    data.SetSpacing(0.5, 0.25, 0.125)
    data.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
    return add_arrays(data)


def slab():
    data = vtkImageData()
    data.SetDimensions(5, 1, 7)
    data.SetSpacing(0.5, 0.25, 0.125)
    return add_arrays(data)


def curvilinear():
    data, points = vtkStructuredGrid(), vtkPoints()
    data.SetDimensions(5, 4, 3)
    for z in range(3):
        for r in range(4):
            for a in range(5):
                points.InsertNextPoint((1 + r) * math.cos(a / 3), (1 + r) * math.sin(a / 3), z + 0.1 * r)
    data.SetPoints(points)
    return add_arrays(data)


def hidden():
    """A curvilinear grid of which two cells are not shown."""
    data = curvilinear()
    data.BlankCell(0)
    data.BlankCell(7)
    return data


def rectilinear():
    data = vtkRectilinearGrid()
    data.SetDimensions(4, 3, 5)
    axes = [(0, 1, 3, 7), (0, 0.5, 2), (-1, 0, 0.25, 2, 2.5)]
    for axis, values in zip("XYZ", axes):
        array = vtkDoubleArray()
        for value in values:
            array.InsertNextValue(value)
        getattr(data, f"Set{axis}Coordinates")(array)
    return add_arrays(data)


SETS = dict(cells=cells, block=lambda: blocks(5), polygons=polygons, image=image, slab=slab, curvilinear=curvilinear, hidden=hidden, rectilinear=rectilinear)
EXTENSIONS = dict(vtkUnstructuredGrid="vtu", vtkPolyData="vtp", vtkStructuredGrid="vts", vtkRectilinearGrid="vtr", vtkImageData="vti")


def xml_writers(extension):
    """Writers with all encodings, byte orders, lengths and compressors, by their names."""
    for mode in ("Ascii", "Binary", "Raw", "Base64"):
        for order in ("LittleEndian", "BigEndian"):
            for wide in ("UInt32", "UInt64"):
                for compressor in ("None", "ZLib", "LZ4"):
                    if mode == "Ascii" and (order, wide, compressor) != ("LittleEndian", "UInt32", "None"):
                        continue
                    writer = WRITERS[extension]()
                    getattr(writer, dict(Ascii="SetDataModeToAscii", Binary="SetDataModeToBinary").get(mode, "SetDataModeToAppended"))()
                    writer.SetEncodeAppendedData(mode == "Base64")
                    getattr(writer, f"SetByteOrderTo{order}")()
                    getattr(writer, f"SetHeaderTypeTo{wide}")()
                    getattr(writer, f"SetCompressorTypeTo{compressor}")()
                    writer.SetBlockSize(256)
                    yield f"{mode}_{order}_{wide}_{compressor}", writer


def legacy_writers():
    for binary in (False, True):
        for version in (42, 51):
            writer = vtkDataSetWriter()
            writer.SetFileVersion(version)
            writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
            yield f"{'binary' if binary else 'ascii'}_{version}", writer


def surface(data):
    """What VTK says of the surface."""
    filter = vtkDataSetSurfaceFilter()
    filter.SetNonlinearSubdivisionLevel(0)
    filter.SetInputData(data)
    triangles = vtkTriangleFilter()
    triangles.SetPassLines(False)
    triangles.SetPassVerts(False)
    triangles.SetInputConnection(filter.GetOutputPort())
    triangles.Update()
    found = triangles.GetOutput()
    corners = [[found.GetCell(i).GetPointId(k) for k in range(3)] for i in range(found.GetNumberOfCells())]
    points = sorted({i for ids in corners for i in ids})
    where = [found.GetPoint(i) for i in points]
    area = sum(triangle_area(*(found.GetPoint(i) for i in ids)) for ids in corners)
    ranges = {}
    for data, indices in ((found.GetPointData(), points), (found.GetCellData(), range(len(corners)))):
        for k in range(data.GetNumberOfArrays()):
            array = data.GetArray(k)
            if array.GetName() in ("height of it", "speed", "number"):
                sizes = [math.hypot(*array.GetTuple(i)) if array.GetNumberOfComponents() > 1 else array.GetTuple1(i) for i in indices]
                ranges[array.GetName()] = [min(sizes), max(sizes)]
    low, high = ([side(p[k] for p in where) for k in range(3)] for side in (min, max))
    return dict(low=low, high=high, area=area, ranges=ranges)


def triangle_area(a, b, c):
    u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
    return 0.5 * math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def write(writer, data, path, described):
    writer.SetInputData(data)
    writer.SetFileName(str(path))
    if not writer.Write():
        sys.exit(f"VTK cannot write {path}")
    print(json.dumps(dict(file=path.name, **described)))


def main(folder):
    for name, make in SETS.items():
        data = make()
        extension, described = EXTENSIONS[data.GetClassName()], surface(data)
        for how, writer in xml_writers(extension):
            write(writer, data, folder / f"{name}_{how}.{extension}", described)
        # Legacy files have neither a direction nor hidden cells.
        if name not in ("image", "hidden"):
            for how, writer in legacy_writers():
                write(writer, data, folder / f"{name}_{how}.vtk", described)
    pieces = vtkXMLPPolyDataWriter()
    pieces.SetNumberOfPieces(1)
    write(pieces, polygons(), folder / "pieces.pvtp", surface(polygons()))
    pieces = vtkXMLPUnstructuredGridWriter()
    pieces.SetNumberOfPieces(1)
    write(pieces, blocks(4), folder / "pieces.pvtu", surface(blocks(4)))
    multi = vtkMultiBlockDataSet()
    multi.SetBlock(0, slab())
    inner = vtkMultiBlockDataSet()
    inner.SetBlock(0, slab())
    multi.SetBlock(1, inner)
    both = surface(slab())
    both["area"] *= 2
    write(vtkXMLMultiBlockDataWriter(), multi, folder / "blocks.vtm", both)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
