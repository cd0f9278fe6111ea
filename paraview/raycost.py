"""raycost in ParaView 5.11 and later: a plugin, loaded by Tools > Manage Plugins > Load New.

It adds the source *raycost frame*, which renders a scene file, and the module `raycost` for
scripts and for the macro `render_with_raycost.py`:

    import raycost
    raycost.render_view()     # the active view as a scene, its picture and its cost in a new layout
"""

from __future__ import annotations

import inspect
import os
import sys
import tempfile
import warnings
from pathlib import Path

if not hasattr(inspect, "getargspec"):
    # Python 3.11 lacks what ParaView 5.11 needs for plugins, as on Debian 12.
    inspect.getargspec = inspect.getfullargspec

from paraview import servermanager, simple
from paraview.util.vtkAlgorithm import smdomain, smproperty, smproxy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOXML import vtkXMLImageDataReader

sys.path.append(os.path.dirname(os.path.abspath(__file__)))

from raycost_scene import RaycostError, Scene, program, raycost_scene  # noqa: E402

__all__ = ["RaycostError", "RaycostFrame", "export_view", "render_view", "show"]


def render_view(view=None, folder: str | None = None, **options) -> Path:
    """Renders what a view shows, and shows picture and cost in a new layout.

    The view is the active one by default, the folder of the scene a temporary one; `options` are
    those of `raycost_scene`. Returns the folder with the output, `out` in that of the scene.
    """
    scene = export_view(view, folder, **options)
    out = scene.render()
    show(out)
    print(f"raycost: the scene is {scene.file}, the picture {out / 'image.png'}")
    return out


def export_view(view=None, folder: str | None = None, **options) -> Scene:
    """Writes what a view shows as a scene. Prints what cannot be exported."""
    view = view or simple.GetActiveView()
    renderer = getattr(view and view.GetClientSideObject(), "GetRenderer", lambda: None)()
    if renderer is None or view in shown_here:
        raise RaycostError("the active view is no render view of your own; click on one first")
    simple.Render(view)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = raycost_scene(renderer, folder, names=names(view), color_bars=color_bars(view), **options)
    if any(shown.GetXMLName() == "TextSourceRepresentation" and shown.Visibility for shown in view.Representations):
        scene.warnings.append("a text over the view cannot be exported; it is left out")
    for message in scene.warnings:
        print(f"raycost: {message}")
    return scene


#: The views that show an output.
shown_here: list = []


def show(out: Path) -> None:
    """Shows an output of raycost in a new layout: the picture, its cost and the cloud of hits."""
    before = set(simple.GetViews())
    servermanager.LoadState(str(out / "overview.pvsm"))
    simple.RenderAllViews()
    views = [view for view in simple.GetViews() if view not in before]
    shown_here.extend(views)
    pictures = [view for view in views if view.GetXMLName() == "RenderView"]
    if pictures:
        simple.SetActiveView(pictures[0])


def names(view) -> dict:
    """The names of the pipeline's sources by the props that show them."""
    found = {}
    for (name, _), source in simple.GetSources().items():
        shown = simple.GetRepresentation(source, view) if has_representation(source, view) else None
        representation = shown and shown.SMProxy.GetClientSideObject()
        active = getattr(representation, "GetActiveRepresentation", lambda: None)()
        actor = getattr(active, "GetActor", lambda: None)()
        if actor is not None:
            found[actor] = name
    return found


def has_representation(source, view) -> bool:
    """Whether a view has a representation of a source."""
    return any(getattr(shown, "Input", None) == source for shown in view.Representations)


def color_bars(view) -> list:
    """The lookup tables of the view's color bars that are shown, with the bars' titles."""
    found = []
    for shown in view.Representations:
        if shown.GetXMLName() == "ScalarBarWidgetRepresentation" and shown.Visibility:
            title = f"{shown.Title} {shown.ComponentTitle}".strip()
            found.append((shown.LookupTable.GetClientSideObject(), title))
    return found


@smproxy.source(name="RaycostFrame", label="Raycost Frame")
class RaycostFrame(VTKPythonAlgorithmBase):
    """The pixels of a scene that raycost renders: colors, costs, normals and so on."""

    def __init__(self):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkImageData")
        self._scene = ""
        self._out = ""
        self._reader: vtkXMLImageDataReader | None = None

    @smproperty.stringvector(name="Scene", number_of_elements=1, default_values="")
    @smdomain.filelist()
    def SetScene(self, file: str | None) -> None:
        """The scene's YAML file."""
        if file != self._scene:
            self._scene, self._reader = file or "", None
            self.Modified()

    @smproperty.stringvector(name="OutputFolder", number_of_elements=1, default_values="")
    def SetOutputFolder(self, folder: str | None) -> None:
        """Where raycost writes; a temporary folder if this is empty."""
        if folder != self._out:
            self._out, self._reader = folder or "", None
            self.Modified()

    def RequestInformation(self, request, inputs, outputs) -> int:
        """Renders the scene unless that is done, and says how large the picture is."""
        if not self._scene:
            return 1
        if self._reader is None:
            out = Path(self._out or tempfile.mkdtemp(prefix="raycost-"))
            program.render(Path(self._scene), out)
            self._reader = vtkXMLImageDataReader()
            self._reader.SetFileName(str(out / "frame.vti"))
            self._reader.UpdateInformation()
        extent = self._reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT())
        outputs.GetInformationObject(0).Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), extent, 6)
        return 1

    def RequestData(self, request, inputs, outputs) -> int:
        """Hands over the picture."""
        if self._reader is not None:
            self._reader.Update()
            vtkImageData.GetData(outputs, 0).ShallowCopy(self._reader.GetOutput())
        return 1
