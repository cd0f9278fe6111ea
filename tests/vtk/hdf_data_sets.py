"""Writes data sets as VTKHDF, and each step of them in VTK's XML formats.

    python hdf_data_sets.py FOLDER

Prints a line of JSON for each step: the VTKHDF file, the step or null, and the XML file.
"""

import json
import sys
from pathlib import Path

from data_sets import EXTENSIONS, WRITERS, add_arrays, blocks, cells, image, polygons, slab
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkFloatArray
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersCore import vtkConvertToPolyhedra, vtkPolyDataNormals, vtkTriangleFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOHDF import vtkHDFWriter


def polyhedra():
    convert = vtkConvertToPolyhedra()
    convert.SetInputData(blocks(3))
    convert.Update()
    return convert.GetOutput()


def ball():
    """Triangles with normals."""
    sphere = vtkSphereSource()
    sphere.SetThetaResolution(9)
    sphere.Update()
    return sphere.GetOutput()


SETS = dict(cells=cells, block=lambda: blocks(5), polyhedra=polyhedra, polygons=polygons, ball=ball, image=image, slab=slab)


class Steps(VTKPythonAlgorithmBase):
    """A data set for each of some times."""

    def __init__(self, kind, steps):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType=kind)
        self.steps = steps

    def RequestInformation(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        times = [0.5 * i for i in range(len(self.steps))]
        info.Set(vtkStreamingDemandDrivenPipeline.TIME_STEPS(), times, len(times))
        info.Set(vtkStreamingDemandDrivenPipeline.TIME_RANGE(), [times[0], times[-1]], 2)
        if self.steps[0].IsA("vtkImageData"):
            info.Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), self.steps[0].GetExtent(), 6)
        return 1

    def RequestData(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        time = info.Get(vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()) or 0
        found = vtkDataObject.GetData(info)
        found.ShallowCopy(self.steps[round(2 * time)])
        found.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time)
        return 1


def scaled(data, factor):
    """The data set with other numbers in its arrays."""
    copy = data.NewInstance()
    copy.DeepCopy(data)
    for arrays in (copy.GetPointData(), copy.GetCellData()):
        for k in range(arrays.GetNumberOfArrays()):
            array = arrays.GetArray(k)
            for i in range(array.GetNumberOfValues()):
                array.SetValue(i, array.GetValue(i) * factor)
    return copy


def write(writer, path):
    writer.SetFileName(str(path))
    if not writer.Write():
        sys.exit(f"VTK cannot write {path}")


def write_xml(data, path):
    writer = WRITERS[path.suffix[1:]]()
    writer.SetInputData(data)
    write(writer, path)


def describe(file, step, xml):
    print(json.dumps(dict(file=file.name, step=step, xml=xml.name)))


def main(folder):
    for name, make in SETS.items():
        data = make()
        xml = folder / f"{name}.{EXTENSIONS[data.GetClassName()]}"
        write_xml(data, xml)
        for compression in (0, 5):
            file = folder / f"{name}_{compression}.vtkhdf"
            writer = vtkHDFWriter()
            writer.SetInputData(data)
            writer.SetCompressionLevel(compression)
            writer.SetChunkSize(100)
            write(writer, file)
            describe(file, None, xml)
    series = dict(
        blocks=[blocks(n) for n in (2, 4, 3)],
        polygons=[scaled(polygons(), factor) for factor in (1, 2, 0.5)],
    )
    for name, steps in series.items():
        kind = steps[0].GetClassName()
        source = Steps(kind, steps)
        file = folder / f"{name}_steps.vtkhdf"
        writer = vtkHDFWriter()
        writer.SetInputConnection(source.GetOutputPort())
        writer.SetWriteAllTimeSteps(True)
        write(writer, file)
        for i, data in enumerate(steps):
            xml = folder / f"{name}_steps_{i}.{EXTENSIONS[kind]}"
            write_xml(data, xml)
            describe(file, i, xml)


main(Path(sys.argv[1]))
