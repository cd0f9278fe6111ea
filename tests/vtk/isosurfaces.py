"""Writes grids and what VTK says of their isosurfaces.

    python isosurfaces.py FOLDER

Prints a line of JSON for each file: its name, the value of the isosurface of `field`, and of
that surface the bounds, the area, the numbers of points and triangles, and the range of the
array `color` over it.
"""

import json
import math
import random
import sys
from pathlib import Path

from vtkmodules.vtkCommonCore import vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData, vtkRectilinearGrid, vtkStructuredGrid, vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import vtkAppendFilter, vtkContourFilter, vtkConvertToPolyhedra, vtkFlyingEdges3D, vtkTriangleFilter
from vtkmodules.vtkFiltersGeneral import vtkDataSetTriangleFilter
from vtkmodules.vtkFiltersMeshing import vtkVoronoiFlower3D
from vtkmodules.vtkIOXML import (
    vtkXMLImageDataWriter,
    vtkXMLRectilinearGridWriter,
    vtkXMLStructuredGridWriter,
    vtkXMLUnstructuredGridWriter,
)

WRITERS = dict(vti=vtkXMLImageDataWriter, vtr=vtkXMLRectilinearGridWriter, vts=vtkXMLStructuredGridWriter, vtu=vtkXMLUnstructuredGridWriter)


def eddies(x, y, z):
    return math.sin(2 * x) * math.cos(y) + math.cos(2 * y + z) * math.sin(z) + 0.1 * x


def waves(x, y, z):
    return math.sin(0.6 * x + 0.2 * y) + math.sin(0.5 * y + 0.4 * z) - 1.2


def noise(x, y, z):
    return random.uniform(-1, 1)


def add_arrays(data, field):
    random.seed(7)
    values, color = vtkFloatArray(), vtkFloatArray()
    values.SetName("field")
    color.SetName("color")
    for i in range(data.GetNumberOfPoints()):
        x, y, z = data.GetPoint(i)
        values.InsertNextValue(field(x, y, z))
        color.InsertNextValue(x * y + 2 * z)
    data.GetPointData().SetScalars(values)
    data.GetPointData().AddArray(color)
    return data


def image(field):
    data = vtkImageData()
    data.SetExtent(-3, 14, 2, 20, 0, 15)
    data.SetSpacing(0.25, 0.2, 0.3)
    data.SetOrigin(0.5, -1, 2)
    return add_arrays(data, field)


def rectilinear(field):
    data = vtkRectilinearGrid()
    data.SetDimensions(12, 14, 13)
    for axis, n in zip("XYZ", (12, 14, 13)):
        along = vtkFloatArray()
        for i in range(n):
            along.InsertNextValue(0.3 * i + 0.01 * i * i)
        getattr(data, f"Set{axis}Coordinates")(along)
    return add_arrays(data, field)


def curvilinear(field):
    data, points = vtkStructuredGrid(), vtkPoints()
    data.SetDimensions(14, 9, 12)
    for z in range(12):
        for r in range(9):
            for a in range(14):
                points.InsertNextPoint((1 + 0.3 * r) * math.cos(a / 5), (1 + 0.3 * r) * math.sin(a / 5), 0.3 * z + 0.02 * r)
    data.SetPoints(points)
    return add_arrays(data, field)


def hexahedra(field):
    append = vtkAppendFilter()
    append.AddInputData(curvilinear(field))
    append.Update()
    return append.GetOutput()


def tetrahedra(field):
    split = vtkDataSetTriangleFilter()
    split.SetInputData(curvilinear(field))
    split.Update()
    return split.GetOutput()


def polyhedra(field):
    convert = vtkConvertToPolyhedra()
    convert.SetInputData(hexahedra(field))
    convert.Update()
    return convert.GetOutput()


def voronoi(field):
    """The cells of random points: faces with three to a dozen corners."""
    random.seed(3)
    points, seeds, cells = vtkPoints(), vtkPolyData(), vtkVoronoiFlower3D()
    for _ in range(300):
        points.InsertNextPoint(*(random.uniform(0, 4) for _ in range(3)))
    seeds.SetPoints(points)
    cells.SetInputData(seeds)
    cells.SetOutputTypeToVoronoi()
    cells.MergePointsOn()
    cells.Update()
    return add_arrays(cells.GetOutput(), field)


def contour(data, value):
    """What VTK says of an isosurface."""
    filter = vtkFlyingEdges3D() if data.IsA("vtkImageData") else vtkContourFilter()
    filter.SetInputData(data)
    filter.SetValue(0, value)
    filter.ComputeNormalsOff()
    if data.IsA("vtkImageData"):
        filter.InterpolateAttributesOn()
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(filter.GetOutputPort())
    triangles.Update()
    found = triangles.GetOutput()
    where = [found.GetPoint(i) for i in range(found.GetNumberOfPoints())]
    area = 0
    for i in range(found.GetNumberOfCells()):
        a, b, c = (where[found.GetCell(i).GetPointId(k)] for k in range(3))
        u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
        area += 0.5 * math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    colors = found.GetPointData().GetArray("color").GetRange()
    low, high = ([side(p[k] for p in where) for k in range(3)] for side in (min, max))
    n_points, n_triangles = found.GetNumberOfPoints(), found.GetNumberOfCells()
    return dict(low=low, high=high, area=area, color=colors, points=n_points, triangles=n_triangles)


def main(folder):
    for make, extension in ((image, "vti"), (rectilinear, "vtr"), (curvilinear, "vts"), (hexahedra, "vtu"), (tetrahedra, "vtu"), (polyhedra, "vtu"), (voronoi, "vtu")):
        # Where corners inside and outside alternate on faces, VTK leaves out parts of polyhedra.
        for field in [waves] if make is voronoi else (eddies, noise):
            data = same = make(field)
            if field is noise and make is polyhedra:
                same = hexahedra(field)
            writer = WRITERS[extension]()
            path = folder / f"{make.__name__}_{field.__name__}.{extension}"
            writer.SetFileName(str(path))
            writer.SetInputData(data)
            writer.Write()
            for value in (0.05, 0.4):
                print(json.dumps(dict(file=path.name, value=value, **contour(same, value))))


main(Path(sys.argv[1]))
