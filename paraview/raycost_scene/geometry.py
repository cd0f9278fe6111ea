"""The polygons, lines and points of a mapper's input, in world space, and their files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from vtkmodules.vtkCommonCore import vtkFloatArray
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet, vtkDataObject, vtkDataSet, vtkImageData, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkCommonTransforms import vtkMatrixToLinearTransform
from vtkmodules.vtkFiltersCore import vtkCellDataToPointData, vtkCleanPolyData, vtkExtractEdges
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from .colors import ArrayColors

#: The name of the radii in a file of spheres.
RADIUS = "raycost radius"


def blocks(data: vtkDataObject | None) -> Iterator[tuple[str, vtkDataObject]]:
    """The data sets of composite data with their names, or the data set itself."""
    if not isinstance(data, vtkCompositeDataSet):
        if data is not None:
            yield "", data
        return
    walk = data.NewIterator()
    walk.InitTraversal()
    while not walk.IsDoneWithTraversal():
        has_name = walk.HasCurrentMetaData() and walk.GetCurrentMetaData().Has(vtkCompositeDataSet.NAME())
        name = walk.GetCurrentMetaData().Get(vtkCompositeDataSet.NAME()) if has_name else ""
        yield name or "", walk.GetCurrentDataObject()
        walk.GoToNextItem()


def surface_of(data: vtkDataObject, matrix: vtkMatrix4x4) -> vtkPolyData | None:
    """A copy of what VTK draws of a data set, in world space; none of what has no points."""
    if not isinstance(data, vtkDataSet) or data.GetNumberOfPoints() == 0:
        return None
    if not isinstance(data, vtkPolyData):
        data = output_of(vtkDataSetSurfaceFilter(), data)
    if matrix.IsIdentity():
        copy = vtkPolyData()
        copy.ShallowCopy(data)
        return copy
    transform = vtkMatrixToLinearTransform()
    transform.SetInput(matrix)
    move = vtkTransformPolyDataFilter()
    move.SetTransform(transform)
    return output_of(move, data)


def edges_of(surface: vtkPolyData) -> vtkPolyData:
    """The edges of polygons and strips, as lines."""
    polygons = vtkPolyData()
    polygons.ShallowCopy(surface)
    polygons.SetLines(None)
    return output_of(vtkExtractEdges(), polygons)


def points_of(surface: vtkPolyData, of_vertices: bool) -> vtkPolyData:
    """The points that cells have, or that vertices have; values of cells go to the points."""
    chosen = vtkPolyData()
    chosen.ShallowCopy(surface)
    if of_vertices:
        # The cells of polydata begin with the vertices, and so do their values.
        chosen = vtkPolyData()
        chosen.SetPoints(surface.GetPoints())
        chosen.GetPointData().ShallowCopy(surface.GetPointData())
        chosen.SetVerts(surface.GetVerts())
        chosen.GetCellData().CopyAllocate(surface.GetCellData())
        for i in range(surface.GetNumberOfVerts()):
            chosen.GetCellData().CopyData(surface.GetCellData(), i, i)
    spread = vtkCellDataToPointData()
    spread.PassCellDataOn()
    clean = vtkCleanPolyData()
    clean.PointMergingOff()
    return output_of(clean, output_of(spread, chosen))


def positive_radii(points: vtkPolyData, radii: list[float]) -> vtkPolyData:
    """The points whose radius is greater than 0, with it as an array."""
    array = vtkFloatArray()
    array.SetName(RADIUS)
    kept = vtkPolyData()
    kept.ShallowCopy(points)
    kept.Initialize()
    data = kept.GetPointData()
    data.CopyAllocate(points.GetPointData())
    places = points.GetPoints().NewInstance()
    places.SetDataType(points.GetPoints().GetDataType())
    for i, radius in enumerate(radii):
        if radius > 0:
            data.CopyData(points.GetPointData(), i, places.InsertNextPoint(points.GetPoint(i)))
            array.InsertNextValue(radius)
    kept.SetPoints(places)
    data.AddArray(array)
    return kept


def write(file: Path, shape: vtkPolyData, colors: ArrayColors | None, keep: tuple[str, ...] = ()) -> None:
    """Writes a shape with the array of its colors, its normals, its texture coordinates and the arrays to keep."""
    lean = vtkPolyData()
    lean.CopyStructure(shape)
    points, cells = shape.GetPointData(), shape.GetCellData()
    lean.GetPointData().SetNormals(points.GetNormals())
    lean.GetPointData().SetTCoords(points.GetTCoords())
    for name in keep:
        lean.GetPointData().AddArray(points.GetArray(name))
    if colors is not None:
        source = points if colors.of_points else cells
        target = lean.GetPointData() if colors.of_points else lean.GetCellData()
        target.AddArray(source.GetArray(colors.array.GetName()))
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(lean)
    writer.SetFileName(str(file))
    writer.EncodeAppendedDataOff()
    if not writer.Write():
        raise OSError(f"cannot write {file}")


def write_picture(file: Path, image: vtkImageData) -> None:
    """Writes a picture of 8 or 16 bits as PNG."""
    writer = vtkPNGWriter()
    writer.SetInputData(image)
    writer.SetFileName(str(file))
    writer.Write()


def output_of(algorithm, data: vtkDataObject) -> vtkPolyData:
    """What a filter makes of a data set."""
    algorithm.SetInputData(data)
    algorithm.Update()
    return algorithm.GetOutput()
