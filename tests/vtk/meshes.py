"""Prints what VTK reads of meshes: for each file a line of JSON with the bounds and the number
of triangles.

    python meshes.py FILE...
"""

import json
import sys
from pathlib import Path

from vtkmodules.vtkCommonDataModel import vtkBoundingBox, vtkMultiBlockDataSet
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkIOGeometry import vtkGLTFReader, vtkOBJReader
from vtkmodules.vtkIOPLY import vtkPLYReader

READERS = {".obj": vtkOBJReader, ".ply": vtkPLYReader, ".gltf": vtkGLTFReader, ".glb": vtkGLTFReader}


def surfaces(block):
    """All surfaces of a data set, or of a tree of them."""
    if not isinstance(block, vtkMultiBlockDataSet):
        return [] if block is None else [block]
    blocks = (block.GetBlock(i) for i in range(block.GetNumberOfBlocks()))
    return [surface for each in blocks for surface in surfaces(each)]


for file in sys.argv[1:]:
    reader = READERS[Path(file).suffix]()
    reader.SetFileName(file)
    reader.Update()
    bounds, n_triangles = vtkBoundingBox(), 0
    for surface in surfaces(reader.GetOutput()):
        triangles = vtkTriangleFilter()
        triangles.SetInputData(surface)
        triangles.PassVertsOff()
        triangles.PassLinesOff()
        triangles.Update()
        bounds.AddBounds(surface.GetBounds())
        n_triangles += triangles.GetOutput().GetNumberOfCells()
    ends = [0.0] * 6
    bounds.GetBounds(ends)
    print(json.dumps({"bounds": ends, "n_triangles": n_triangles}))
