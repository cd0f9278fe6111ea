"""Makes abc_flow.vti, the Arnold-Beltrami-Childress flow on a grid, and abc_streamlines.vtp,
streamlines that VTK integrates in it.

    pip install vtk
    python abc_flow.py

The flow is an exact, steady solution of Euler's equations that repeats in each direction
(Dombre et al., "Chaotic streamlines in the ABC flows", Journal of Fluid Mechanics 167, 1986).
The grid has its `velocity` at the points; streamlines have it too, and their `thickness`.
"""

import math

from vtkmodules.vtkCommonCore import vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersFlowPaths import vtkStreamTracer
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter, vtkXMLPolyDataWriter

SIDE = 29
A, B, C = math.sqrt(3), math.sqrt(2), 1


def velocity(x, y, z):
    return (
        A * math.sin(z) + C * math.cos(y),
        B * math.sin(x) + A * math.cos(z),
        C * math.sin(y) + B * math.cos(x),
    )


def array(name, n_components):
    found = vtkFloatArray()
    found.SetName(name)
    found.SetNumberOfComponents(n_components)
    return found


def flow():
    grid = vtkImageData()
    grid.SetDimensions(SIDE, SIDE, SIDE)
    grid.SetSpacing(*[2 * math.pi / (SIDE - 1)] * 3)
    velocities = array("velocity", 3)
    for i in range(grid.GetNumberOfPoints()):
        velocities.InsertNextTuple3(*(round(v, 3) for v in velocity(*grid.GetPoint(i))))
    grid.GetPointData().SetVectors(velocities)
    return grid


def streamlines(grid):
    seeds, points = vtkPolyData(), vtkPoints()
    for i in range(60):
        # The R2 sequence of Martin Roberts: evenly spread.
        points.InsertNextPoint(*(2 * math.pi * ((0.5 + i * a) % 1) for a in (0.8191725, 0.6710436, 0.5497005)))
    seeds.SetPoints(points)
    tracer = vtkStreamTracer()
    tracer.SetInputData(grid)
    tracer.SetSourceData(seeds)
    tracer.SetIntegrationDirectionToBoth()
    tracer.SetIntegratorTypeToRungeKutta45()
    tracer.SetMaximumPropagation(9)
    tracer.SetMaximumIntegrationStep(0.5)
    tracer.SetComputeVorticity(False)
    tracer.Update()
    return tracer.GetOutput()


def thinned(lines):
    """The lines with rounded points, their velocity and thickness alone."""
    found, points = vtkPolyData(), vtkPoints()
    velocities, thickness = array("velocity", 3), array("thickness", 1)
    of_lines = lines.GetPointData().GetArray("velocity")
    for i in range(lines.GetNumberOfPoints()):
        points.InsertNextPoint(*(round(c, 4) for c in lines.GetPoint(i)))
        v = of_lines.GetTuple3(i)
        velocities.InsertNextTuple3(*(round(c, 3) for c in v))
        # As much flows through each cross section of a tube: it is thin where the flow is fast.
        thickness.InsertNextValue(round(0.06 / math.sqrt(max(math.hypot(*v), 0.3)), 4))
    found.SetPoints(points)
    found.SetLines(lines.GetLines())
    found.GetPointData().AddArray(velocities)
    found.GetPointData().AddArray(thickness)
    return found


def write(writer, data, path):
    writer.SetFileName(path)
    writer.SetInputData(data)
    writer.SetCompressorTypeToZLib()
    writer.EncodeAppendedDataOff()
    writer.SetCompressionLevel(9)
    writer.Write()


def main():
    grid = flow()
    write(vtkXMLImageDataWriter(), grid, "abc_flow.vti")
    write(vtkXMLPolyDataWriter(), thinned(streamlines(grid)), "abc_streamlines.vtp")


main()
