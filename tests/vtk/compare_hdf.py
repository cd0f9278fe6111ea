"""Compares a VTKHDF file with VTK's XML files, a step for each, array by array.

    python compare_hdf.py FILE.vtkhdf FILE.vtu ...
    python compare_hdf.py FILE.vtkhdf TIME=FILE.vti ...

Fails if anything differs, or if VTK says a word on the way.
"""

import sys

from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLUnstructuredGridReader

READERS = dict(vti=vtkXMLImageDataReader, vtu=vtkXMLUnstructuredGridReader)
complaints = []


def main(path, *steps):
    listen(vtkOutputWindow.GetInstance())
    times, files = zip(*(step.split("=") if "=" in step else (None, step) for step in steps))
    hdf = listen(vtkHDFReader())
    hdf.SetFileName(path)
    hdf.UpdateInformation()
    found = hdf.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    expected = None if times[0] is None else tuple(map(float, times))
    same("times", found, expected)
    for time, file in zip(times, files):
        hdf.Update() if time is None else hdf.UpdateTimeStep(float(time))
        xml = listen(READERS[file.rsplit(".", 1)[1]]())
        xml.SetFileName(file)
        xml.Update()
        same(file, *(content(reader.GetOutputDataObject(0)) for reader in (hdf, xml)))
    if complaints:
        sys.exit(f"{path}: VTK complains: {complaints}")


def listen(speaker):
    for event in ("ErrorEvent", "WarningEvent"):
        speaker.AddObserver(event, lambda _, event: complaints.append(event))
    return speaker


def content(data):
    """All that is in a data set, by name."""
    normals = data.GetPointData().GetNormals()
    found = dict(kind=data.GetClassName(), n_points=data.GetNumberOfPoints(), n_cells=data.GetNumberOfCells())
    if data.IsA("vtkImageData"):
        found.update(extent=data.GetExtent(), origin=data.GetOrigin(), spacing=data.GetSpacing())
    elif found["n_points"]:
        found.update(normals=normals.GetName(), points=array(data.GetPoints().GetData()))
        ids = data.GetCells().GetConnectivityArray()
        found["ids"] = [ids.GetTuple1(i) for i in range(ids.GetNumberOfTuples())]
        found["types"] = [data.GetCellType(i) for i in range(data.GetNumberOfCells())]
    for arrays in (data.GetPointData(), data.GetFieldData()):
        for i in range(arrays.GetNumberOfArrays()):
            name = arrays.GetArrayName(i)
            if name != "Time":  # VTK adds it to steps
                found[name] = array(arrays.GetAbstractArray(i))
    return found


def array(of):
    if of.IsA("vtkStringArray"):
        return [of.GetValue(i) for i in range(of.GetNumberOfValues())]
    content = bytes(memoryview(of)) if of.GetNumberOfValues() else b""
    return of.GetDataTypeAsString(), of.GetNumberOfComponents(), content


def same(what, found, expected):
    if found == expected:
        return
    if isinstance(found, dict):
        names = sorted(found.keys() | expected.keys())
        different = [name for name in names if found.get(name) != expected.get(name)]
        sys.exit(f"{what}: {different} differ")
    sys.exit(f"{what}: {found} instead of {expected}")


main(*sys.argv[1:])
