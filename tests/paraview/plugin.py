"""Renders the active view by the plugin of raycost.

    RAYCOST=PROGRAM xvfb-run -a pvbatch tests/paraview/plugin.py FOLDER

Exits with 0 if the scene has what the view shows, the picture looks like the view's, a layout with
picture and cost has opened beside the view, and the source Raycost Frame has the same picture;
with 1 and a traceback if not. FOLDER gets the scene and both pictures.
"""

import os
import sys
import traceback
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[2] / "paraview"))
import raycost  # noqa: E402
from paraview import simple as pv  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonCore import vtkOutputWindow  # noqa: E402
from vtkmodules.vtkIOImage import vtkPNGReader  # noqa: E402
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader  # noqa: E402

NAME = 'the "ball" ü'


def main():
    folder = Path(sys.argv[1])
    problems = []
    vtkOutputWindow.GetInstance().AddObserver("ErrorEvent", lambda *_: problems.append("VTK reported an error"))
    pv.LoadPlugin(raycost.__file__, ns=globals())
    view = shown_view()
    n_views, n_sources = len(pv.GetViews()), len(pv.GetSources())
    out = raycost.render_view(folder=folder)
    assert_scene((folder / "scene.yaml").read_text(encoding="utf-8"))
    assert_radii(folder, 0.021126, 0.06)
    pv.SaveScreenshot(str(folder / "paraview.png"), view, ImageResolution=view.ViewSize)
    difference = np.abs(pixels(folder / "paraview.png") - pixels(out / "image.png")).mean()
    print(f"mean difference {difference:.2f}/255")
    assert difference < 2, difference
    assert len(pv.GetViews()) == n_views + 4, "the overview has four views"
    assert len(pv.GetSources()) > n_sources
    (layout,) = [layout for (name, _), layout in pv.GetLayouts().items() if name == "Overview"]
    pv.SaveScreenshot(str(folder / "layout.png"), layout)
    shown = np.ptp(pixels(folder / "layout.png").astype(int), axis=2) > 60
    assert shown.mean() > 0.02, "the layout shows nothing"
    assert_source(folder, out)
    assert_errors(folder)
    assert not problems, problems


def shown_view():
    """A view with a colored ball, transformed dots, streamlines, a hidden cone and a volume."""
    view = pv.CreateView("RenderView", ViewSize=[480, 360], OrientationAxesVisibility=0)
    ball = pv.Show(pv.Sphere(registrationName=NAME, ThetaResolution=60, PhiResolution=60), view)
    pv.ColorBy(ball, ("POINTS", "Normals", "Z"))
    ball.RescaleTransferFunctionToDataRange()
    ball.SetScalarBarVisibility(view, False)
    dots = pv.Show(pv.Sphere(registrationName="dots"), view, Representation="Point Gaussian")
    dots.GaussianRadius, dots.Position, dots.DiffuseColor = 0.03, [1.2, 0, 0], [1, 0.5, 0]
    dots.ShaderPreset = "Sphere"
    sized = pv.Calculator(
        registrationName="sized", Input=pv.Sphere(), Function="abs(coordsZ)+0.1", ResultArrayName="size"
    )
    balls = pv.Show(sized, view, Representation="Point Gaussian")
    balls.ScaleByArray, balls.SetScaleArray, balls.UseScaleFunction = 1, ["POINTS", "size"], 0
    balls.GaussianRadius, balls.ShaderPreset, balls.Position = 0.1, "Sphere", [0, 1.2, 0]
    pv.ColorBy(balls, None)
    pv.Show(pv.Text(Text="a text"), view)
    wave = pv.Wavelet(registrationName="wave", WholeExtent=[-5, 5, -5, 5, -5, 5])
    surface = pv.Contour(registrationName="contour", Input=wave, Isosurfaces=[200.0], ContourBy=["POINTS", "RTData"])
    shown = pv.Show(surface, view, Scale=[0.1, 0.1, 0.1], Position=[-1.2, 0, 0])
    pv.ColorBy(shown, None)
    cone = pv.Show(pv.Cone(registrationName="hidden"), view)
    cone.Visibility = 0
    pv.Show(wave, view, Representation="Outline", Scale=[0.1, 0.1, 0.1], Position=[-1.2, 0, 0])
    pv.SetActiveView(view)
    pv.ResetCamera(view)
    return view


def assert_scene(text):
    objects = text[text.index("\nobjects:") :]
    assert [objects.count(kind) for kind in ("mesh:", "spheres:", "tubes:")] == [2, 2, 1], objects
    for part in ('"the \\"ball\\" ü"', '"contour"', "radius: 0.03"):
        assert part in text, f"{part} is missing in {text}"
    assert "hidden" not in text, text
    # The preset Cool to Warm, in few colors.
    assert 'name: "Normals", component: 2, of: "points", map: { colors: ["#3b4cc0"' in text, text


def assert_radii(folder, least, greatest):
    """One of the files has these radii."""
    found = []
    for file in folder.glob("*.vtp"):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(file))
        reader.Update()
        radii = reader.GetOutput().GetPointData().GetArray("raycost radius")
        if radii:
            found.append(radii.GetRange())
    assert len(found) == 1 and np.allclose(found, (least, greatest), rtol=1e-3), found


def assert_source(folder, out):
    frame = RaycostFrame(Scene=str(folder / "scene.yaml"), OutputFolder=str(folder / "again"))  # noqa: F821
    frame.UpdatePipeline()
    assert frame.GetDataInformation().GetExtent() == (0, 479, 0, 359, 0, 0)
    assert {"RGB", "node_visits"} <= set(frame.PointData.keys())
    assert np.array_equal(pixels(folder / "again/image.png"), pixels(out / "image.png"))


def assert_errors(folder):
    """Messages say what is wrong: a volume is left out, a chart is no render view, nothing to show."""
    view = pv.CreateView("RenderView")
    pv.Show(pv.Wavelet(), view).SetRepresentationType("Volume")
    for view, message in ((view, "nothing that can be exported"), (pv.CreateView("XYChartView"), "no render view")):
        try:
            raycost.render_view(view, folder / "broken")
        except raycost.RaycostError as error:
            assert message in str(error), error
        else:
            raise AssertionError(f"no message with {message}")


def pixels(file):
    reader = vtkPNGReader()
    reader.SetFileName(str(file))
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[..., :3].astype(float)


def run():
    try:
        main()
    except Exception:
        traceback.print_exc()
        return 1
    return 0


if __name__ == "__main__":
    code = run()
    sys.stdout.flush()
    os._exit(code)  # pvbatch's own exit code hides failures
