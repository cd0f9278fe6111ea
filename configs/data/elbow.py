"""Makes elbow.vtu: the wall of a bent pipe in which hot water meets cold water.

    pip install vtk
    python elbow.py

The numbers follow from formulas, not from a simulation: hot streaks that fade along the
pipe (`temperature` of the points in K), the way the wall moves (`displacement` in mm), and
the stress in each cell (`stress` in MPa).
"""

import math

from vtkmodules.vtkCommonCore import vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

ALONG, AROUND, THROUGH = 48, 40, 2
BEND, RADIUS, WALL, STRAIGHT = 2.0, 0.8, 0.18, 1.6


def center(s):
    """A point of the pipe's axis and the axis's direction, from 0 to 1 along the pipe."""
    bend = BEND * math.pi / 2
    at = s * (bend + 2 * STRAIGHT)
    if at < STRAIGHT:
        return (at - STRAIGHT, BEND), (1, 0)
    if at > STRAIGHT + bend:
        return (BEND, STRAIGHT + bend - at), (0, -1)
    angle = (at - STRAIGHT) / BEND
    return (BEND * math.sin(angle), BEND * math.cos(angle)), (math.cos(angle), -math.sin(angle))


def point(i, j, k):
    (x, y), (dx, dy) = center(i / ALONG)
    angle = 2 * math.pi * j / AROUND
    radius = RADIUS - WALL * k / THROUGH
    out, side = radius * math.cos(angle), radius * math.sin(angle)
    return x - dy * out, y + dx * out, side


def temperature(i, j, k):
    s, angle = i / ALONG, 2 * math.pi * j / AROUND
    streak = math.exp(-((math.cos(angle - 5 * s) - 1) ** 2) / (0.1 + 0.8 * s))
    return 290 + 60 * (0.25 + 0.75 * k / THROUGH) * streak * math.exp(-1.2 * s) + 8 * s


def main():
    grid, points = vtkUnstructuredGrid(), vtkPoints()
    arrays = [vtkFloatArray() for _ in range(3)]
    for array, name in zip(arrays, ("temperature", "displacement", "stress")):
        array.SetName(name)
    arrays[1].SetNumberOfComponents(3)
    for i in range(ALONG + 1):
        for j in range(AROUND):
            for k in range(THROUGH + 1):
                points.InsertNextPoint(point(i, j, k))
                hot = temperature(i, j, k)
                x, y, z = point(i, j, k)
                arrays[0].InsertNextValue(round(hot, 3))
                arrays[1].InsertNextTuple3(*(round(0.01 * (hot - 290) * c, 4) for c in (x + 1.6, y - 2, z)))
    at = lambda i, j, k: k + (THROUGH + 1) * (j % AROUND + AROUND * i)
    grid.SetPoints(points)
    for i in range(ALONG):
        for j in range(AROUND):
            for k in range(THROUGH):
                low = [at(i, j, k), at(i, j + 1, k), at(i, j + 1, k + 1), at(i, j, k + 1)]
                grid.InsertNextCell(12, 8, low + [n + at(1, 0, 0) for n in low])
                corners = [temperature(i + a, j + b, k + c) for a in (0, 1) for b in (0, 1) for c in (0, 1)]
                arrays[2].InsertNextValue(round(2.4 * (max(corners) - min(corners)), 2))
    grid.GetPointData().AddArray(arrays[0])
    grid.GetPointData().AddArray(arrays[1])
    grid.GetCellData().AddArray(arrays[2])
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName("elbow.vtu")
    writer.SetInputData(grid)
    writer.SetCompressionLevel(9)
    writer.EncodeAppendedDataOff()
    writer.Write()


main()
