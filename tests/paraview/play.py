"""Plays the frames of an animated scene in ParaView.

    xvfb-run -a pvbatch tests/paraview/play.py SERIES.pvsm|SERIES.pvd OUT.png N FIRST LAST

Exits with 0 if ParaView knows N time steps from FIRST to LAST, reports no error in any of
them, shows another picture in each of the first half (of a state), and has the same range of
colors in all; with 1 and one FAIL line a problem if not. OUT.png shows the frame in the
middle.
"""

import os
import sys
import traceback

import numpy as np
from paraview import simple as pv
from paraview import vtk
from paraview.vtk.util.numpy_support import vtk_to_numpy


def main():
    path, png, n, first, last = sys.argv[1], sys.argv[2], int(sys.argv[3]), *map(float, sys.argv[4:6])
    problems = []
    window = vtk.vtkOutputWindow.GetInstance()
    window.AddObserver("ErrorEvent", lambda *_: problems.append("VTK reported an error, see above"))
    pv._DisableFirstRenderCameraReset()
    if path.endswith(".pvd"):
        view = pv.CreateView("RenderView")
        pv.Show(pv.OpenDataFile(path), view)
        pv.ResetCamera(view)
        pv.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
    else:
        pv.LoadState(path)
    scene, times = pv.GetAnimationScene(), list(pv.GetTimeKeeper().TimestepValues)
    if len(times) != n or abs(times[0] - first) > 1e-9 or abs(times[-1] - last) > 1e-9:
        problems.append(f"the time steps are {times}")
    if [scene.StartTime, scene.EndTime] != [times[0], times[-1]]:
        problems.append(f"the scene plays from {scene.StartTime} to {scene.EndTime}")
    ranges, seen = set(), []
    for number, time in enumerate(times):
        scene.AnimationTime = time
        pv.RenderAllViews()
        seen.append(pictures())
        ranges.add(tuple(colors()))
        if number == n // 2:
            pv.SaveScreenshot(png, *(list(pv.GetLayouts().values()) or pv.GetViews())[:1])
    for number in range(n // 2 if path.endswith(".pvsm") else 0):
        if np.array_equal(seen[number], seen[number + 1]):
            problems.append(f"steps {number} and {number + 1} look the same")
    if len(ranges) != 1:
        problems.append(f"the ranges of the colors change: {ranges}")
    for problem in dict.fromkeys(problems):
        print("FAIL", problem)
    print("FAILED" if problems else "OK", path)
    return 1 if problems else 0


def pictures():
    """The pixels of all render views."""
    found = []
    for view in (view for view in pv.GetViews() if view.GetXMLName() == "RenderView"):
        image = view.SMProxy.CaptureWindow(1)
        found.append(vtk_to_numpy(image.GetPointData().GetScalars()).ravel())
    return np.concatenate(found)


def colors():
    """The ends of all color maps that are used."""
    for view in pv.GetViews():
        for shown in view.Representations:
            table = getattr(shown, "LookupTable", None)
            if table:
                points = list(table.RGBPoints)
                yield points[0], points[-4]


def run():
    try:
        return main()
    except Exception:
        traceback.print_exc()
        return 1


if __name__ == "__main__":
    code = run()
    sys.stdout.flush()
    os._exit(code)  # pvbatch's own exit code hides failures
