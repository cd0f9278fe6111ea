"""Shows the surface of a data set by an array in flat colors, with VTK.

    python picture.py FILE ARRAY LOW HIGH WIDTH HEIGHT FOV_Y_DEG EYE TARGET OUT

EYE and TARGET are numbers with commas. OUT gets three bytes for each pixel, the upper row
first. The color map is Cool to Warm between LOW and HIGH.
"""

import sys

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkColorTransferFunction,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)


def main(file, array, low, high, width, height, fov, eye, target, out):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(file)
    surface = vtkDataSetSurfaceFilter()
    surface.SetInputConnection(reader.GetOutputPort())
    colors = cool_to_warm(float(low), float(high))
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(surface.GetOutputPort())
    surface.Update()
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
