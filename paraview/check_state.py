"""Checks that a ParaView state loads and shows an output folder, and takes its picture.

    xvfb-run -a pvbatch paraview/check_state.py STATE.pvsm DATADIR OUT.png [--require time_ns,RGB]

Checks several states if -- stands between them, which is faster: ParaView starts once. Exits with 0 if everything holds, with 1 and one FAIL line a problem if not:
- each source reads a file of DATADIR, gives points or rows, and every array has a finite range;
- the required arrays exist, and so does each array that a view colors by;
- VTK reports no error from loading to the last picture;
- no view is blank: hiding the data changes its pixels.

OUT.png shows the whole layout. Works in ParaView 5.11 and later.
"""

import argparse
import os
import sys
import traceback
from pathlib import Path

import numpy as np
from paraview import simple as pv
from paraview import vtk
from paraview.vtk.util.numpy_support import vtk_to_numpy

MIN_CHANGED = {"RenderView": 0.02, "XYBarChartView": 0.002}  # of a view's pixels, when its data is hidden


def check(args):
    """The number of problems of a state, printed."""
    problems = []
    window = vtk.vtkOutputWindow.GetInstance()
    window.AddObserver("ErrorEvent", lambda *_: problems.append("VTK reported an error, see above"))
    pv._DisableFirstRenderCameraReset()  # else the first picture would throw away the state's camera
    where = {} if args.from_state else {"data_directory": str(args.data.resolve())}
    pv.LoadState(str(args.state.resolve()), **where)

    sources = {name: source for (name, _), source in pv.GetSources().items()}
    views = pv.GetViews()
    if not sources or not views:
        problems.append(f"the state has {len(sources)} sources and {len(views)} views")
    for name, source in sources.items():
        problems += check_source(name, source, args)
    found = {array.GetName() for source in sources.values() for array in arrays(source)}
    problems += [f"no source has the array {array}" for array in args.require if array not in found]

    take_picture(args.png, args.size)
    for view in views if not args.allow_empty else []:
        problems += check_view(view)
    for problem in dict.fromkeys(problems):
        print("FAIL", problem)
    print("FAILED" if problems else "OK", args.state)
    return len(problems)


def arguments(words):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("state", type=Path, help="the .pvsm file")
    parser.add_argument("data", type=Path, help="the output folder whose files it must show")
    parser.add_argument("png", type=Path, help="where to write the picture of the layout")
    parser.add_argument("--require", type=lambda names: names.split(","), default=[], metavar="ARRAY,ARRAY")
    parser.add_argument(
        "--size", type=lambda s: [int(n) for n in s.split("x")], default=[1600, 1000], metavar="WxH"
    )
    parser.add_argument(
        "--from-state", action="store_true", help="use the state's own paths, seek no file in DATADIR"
    )
    parser.add_argument("--allow-empty", action="store_true", help="let sources be empty and views blank")
    return parser.parse_args(words)


def check_source(name, source, args):
    """Its file, its size and the ranges of its arrays."""
    for file in files(source):
        if not os.path.isfile(file):
            yield f"{name}: there is no file {file!r}"
        elif not os.path.samefile(os.path.dirname(file), args.data):
            yield f"{name}: {file!r} is not in {str(args.data)!r}"
    source.UpdatePipeline()
    size = source.GetDataInformation()
    n_points, n_rows = size.GetNumberOfPoints(), size.DataInformation.GetNumberOfRows()
    print(f"{name}: {size.GetDataSetTypeAsString()}, {n_points} points, {n_rows} rows")
    if n_points == n_rows == 0:
        if not args.allow_empty:
            yield f"{name}: empty"
        return
    for array in arrays(source):
        low, high = array.GetRange(-1 if array.GetNumberOfComponents() > 1 else 0)
        print(f"  {array.GetName()}[{array.GetNumberOfComponents()}] {low:.6g} .. {high:.6g}")
        is_finite = np.isfinite([low, high]).all() or array.GetName().endswith("ratio")  # 1 / 0, in a diff
        if not (args.allow_empty or (is_finite and low <= high)):
            yield f"{name}: {array.GetName()} ranges from {low} to {high}"


def check_view(view):
    """The arrays its representations color by, and whether hiding them changes the picture."""
    shown = [r for r in view.Representations if "ColorArrayName" in r.ListProperties() and r.Visibility]
    for representation in shown:
        where, array = (list(representation.ColorArrayName) + [None, None])[:2]
        data = {"POINTS": "PointData", "CELLS": "CellData"}.get(where)
        if array and getattr(representation.Input, data).GetArray(array) is None:
            yield f"a view colors by {array}, which its source does not have"
    kind = view.GetXMLName()
    if kind != "RenderView":
        shown = list(view.Representations)
    before = pixels(view)
    for representation in shown:
        representation.Visibility = 0
    after = pixels(view)
    for representation in shown:
        representation.Visibility = 1
    changed = float((np.abs(before - after).max(axis=-1) > 8).mean())
    print(f"{kind}: the data covers {changed:.1%}")
    if changed < MIN_CHANGED.get(kind, 0.02):
        yield f"a {kind} looks blank: its data covers {changed:.1%}"


def files(source):
    named = getattr(source, "FileName", None) or []
    return [named] if isinstance(named, str) else list(named)


def arrays(source):
    for data in (source.PointData, source.CellData, getattr(source, "RowData", [])):
        for index in range(len(data)):
            yield data[index]


def take_picture(png, size):
    layouts = list(pv.GetLayouts().values())
    for layout in layouts:
        layout.SetSize(*size)
    pv.SaveScreenshot(str(png.resolve()), *(layouts or pv.GetViews())[:1], ImageResolution=size)


def pixels(view):
    """The view as it shows now: rows of RGB."""
    pv.Render(view)
    image = view.SMProxy.CaptureWindow(1)
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[..., :3].astype(int)


def main():
    """The exit code; a traceback is a failure."""
    states = [[]]
    for word in sys.argv[1:]:
        if word == "--":
            states.append([])
        else:
            states[-1].append(word)
    try:
        code = 0
        for args in [arguments(words) for words in states]:
            if check(args):
                code = 1
            pv.ResetSession()
        return code
    except SystemExit as usage:
        return usage.code
    except Exception:
        traceback.print_exc()
        return 1


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)  # pvbatch's own exit code hides failures
