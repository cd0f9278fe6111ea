"""Shows a data set by an array in flat colors, with VTK.

    python picture.py FILE HOW ARRAY LOW HIGH WIDTH HEIGHT FOV_Y_DEG EYE TARGET OUT

HOW is `surface`, or `tubes=RADIUS` for the lines of the file with a sphere at each point, or
`isosurface=VALUE` for that of the speed. ARRAY may be `NAME, component: N`.
EYE and TARGET are numbers with commas. OUT gets three bytes for each pixel, the upper row
first. The color map is Cool to Warm between LOW and HIGH.
"""

import math
import sys

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkLookupTable
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkContourFilter, vtkGlyph3D, vtkTubeFilter
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkColorTransferFunction,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)


READERS = dict(vti=vtkXMLImageDataReader, vtp=vtkXMLPolyDataReader, vtu=vtkXMLUnstructuredGridReader)


def shown(file, how):
    """What is shown of a file."""
    reader = READERS[file.rsplit(".", 1)[1]]()
    reader.SetFileName(file)
    how, _, value = how.partition("=")
    if how == "surface":
        surface = vtkDataSetSurfaceFilter()
        surface.SetInputConnection(reader.GetOutputPort())
        return surface
    if how == "isosurface":
        reader.Update()
        data, speed = reader.GetOutput(), vtkFloatArray()
        for i in range(data.GetNumberOfPoints()):
            speed.InsertNextValue(math.hypot(*data.GetPointData().GetArray("velocity").GetTuple3(i)))
        data.GetPointData().SetScalars(speed)
        # vtkFlyingEdges3D of VTK 9.7 interpolates vectors wrongly.
        contour = vtkContourFilter()
        contour.SetInputData(data)
        contour.SetValue(0, float(value))
        return contour
    tubes, sphere, spheres = vtkTubeFilter(), vtkSphereSource(), vtkGlyph3D()
    tubes.SetInputConnection(reader.GetOutputPort())
    tubes.SetRadius(float(value))
    tubes.SetNumberOfSides(90)
    sphere.SetRadius(float(value))
    sphere.SetThetaResolution(60)
    sphere.SetPhiResolution(60)
    spheres.SetInputConnection(reader.GetOutputPort())
    spheres.SetSourceConnection(sphere.GetOutputPort())
    spheres.SetScaleModeToDataScalingOff()
    spheres.SetScaleFactor(1)
    both = vtkAppendPolyData()
    both.AddInputConnection(tubes.GetOutputPort())
    both.AddInputConnection(spheres.GetOutputPort())
    return both


def main(file, how, array, low, high, width, height, fov, eye, target, out):
    array, _, component = array.partition(", component: ")
    surface = shown(file, how)
    colors = cool_to_warm(float(low), float(high))
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(surface.GetOutputPort())
    surface.Update()
    if component:
        array = add_component(surface.GetOutput().GetPointData(), array, int(component))
    of_points = surface.GetOutput().GetPointData().HasArray(array)
    if of_points:
        mapper.SetScalarModeToUsePointFieldData()
        mapper.InterpolateScalarsBeforeMappingOn()
    else:
        mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray(array)
    mapper.SetLookupTable(colors)
    mapper.UseLookupTableScalarRangeOn()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    renderer = vtkRenderer()
    renderer.AddActor(actor)
    renderer.SetBackground(0, 0, 0)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*map(float, eye.split(",")))
    camera.SetFocalPoint(*map(float, target.split(",")))
    camera.SetViewUp(0, 1, 0)
    camera.SetViewAngle(float(fov))
    renderer.ResetCameraClippingRange()
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(int(width), int(height))
    window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.SetInputBufferTypeToRGB()
    grab.Update()
    pixels = bytes(memoryview(grab.GetOutput().GetPointData().GetScalars()))
    row = 3 * int(width)
    rows = [pixels[i : i + row] for i in range(0, len(pixels), row)]
    with open(out, "wb") as picture:
        picture.write(b"".join(reversed(rows)))


def add_component(data, name, component):
    """Adds a component of an array as an array, and returns its name."""
    found, vectors = vtkFloatArray(), data.GetArray(name)
    found.SetName("component")
    for i in range(vectors.GetNumberOfTuples()):
        found.InsertNextValue(vectors.GetComponent(i, component))
    data.AddArray(found)
    return "component"


def cool_to_warm(low, high):
    gradient = vtkColorTransferFunction()
    gradient.SetColorSpaceToDiverging()
    gradient.AddRGBPoint(0, 59 / 255, 76 / 255, 192 / 255)
    gradient.AddRGBPoint(1, 180 / 255, 4 / 255, 38 / 255)
    table = vtkLookupTable()
    table.SetNumberOfTableValues(1024)
    table.SetTableRange(low, high)
    table.SetVectorModeToMagnitude()
    for i in range(1024):
        table.SetTableValue(i, *gradient.GetColor(i / 1023))
    return table


main(*sys.argv[1:])
