"""A renderer → the folder of a scene."""

from __future__ import annotations

import re
import tempfile
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from vtkmodules.vtkRenderingCore import vtkActor, vtkProp, vtkProp3D, vtkRenderer

from . import actor, program, view
from .colors import Titles
from .errors import RaycostError
from .writer import Value, scene_text

COMMENT = """What a view of VTK showed. Render it with

    raycost render {file}

Colors are numbers of the screen, as in VTK, which shades with them: hence `transfer: linear`."""

#: The files of a scene.
FILES = ("scene.yaml", "[0-9]*_*.vtp", "[0-9]*_texture.png", "opacity.png")

#: Samples per pixel, and those of scenes with opacity, which is noise.
SAMPLES, SAMPLES_OF_HOLES = 4, 32


@dataclass
class Scene:
    """A scene in a folder of its own."""

    file: Path
    warnings: list[str] = field(default_factory=list)

    def render(self, out: str | Path | None = None, *arguments: str) -> Path:
        """Renders it, by default into the folder `out` beside it; returns the folder.

        `arguments` are more ones of `raycost render`, such as `"--spp", "16"`.
        """
        return program.render(self.file, Path(out or self.file.parent / "out"), arguments)


def raycost_scene(
    plotter,
    folder: str | Path | None = None,
    *,
    samples_per_pixel: int | None = None,
    shadows: bool = False,
    names: Mapping[vtkProp, str] | None = None,
    color_bars: Titles = (),
) -> Scene:
    """Writes what a view shows as `scene.yaml` and `.vtp` files.

    `plotter` is PyVista's, or a vtkRenderer. The folder is made where it is missing, and is
    a temporary one by default. With `shadows` objects throw shadows, as they do not in VTK.
    `names` has the names of the objects by their props,
    `color_bars` lookup tables with the titles of color bars that the renderer does not have. What
    cannot be exported is a warning each of Python, and in `Scene.warnings`.
    """
    renderer = plotter if isinstance(plotter, vtkRenderer) else plotter.renderer
    folder = Path(folder or tempfile.mkdtemp(prefix="raycost-"))
    scene = Scene(folder / "scene.yaml")
    prepare(scene.file)

    def warn(message: str) -> None:
        if message not in scene.warnings:
            scene.warnings.append(message)
            warnings.warn(f"raycost: {message}", stacklevel=3)

    contents = actor.Contents(folder, renderer, [*color_bars, *shown_bars(renderer)], warn)
    add_props(contents, names or prop_names(renderer))
    sections = sections_of(contents, samples_per_pixel, shadows)
    scene.file.write_text(scene_text(COMMENT.format(file=scene.file.name), sections), encoding="utf-8")
    return scene


def prepare(file: Path) -> None:
    """Makes the folder of a scene file. Of files that a scene has, those of an earlier one may be there."""
    file.parent.mkdir(parents=True, exist_ok=True)
    first_line = COMMENT.splitlines()[0]
    is_own = file.is_file() and first_line in file.read_text(encoding="utf-8", errors="replace")[:100]
    other = next((found for pattern in FILES for found in file.parent.glob(pattern)), None)
    if other and not is_own:
        raise RaycostError(f"{other} would be replaced; name another folder for the scene")


def add_props(contents: actor.Contents, names: Mapping[vtkProp, str]) -> None:
    """Adds what the renderer shows."""
    if min(contents.renderer.GetSize()) < 1:
        raise RaycostError("the view has no size; show it first")
    for number, prop in enumerate(contents.renderer.GetViewProps()):
        if prop.GetVisibility():
            add_prop(contents, prop, names.get(prop) or f"object {number}")
    if not contents.objects:
        raise RaycostError("the view shows nothing that can be exported")


def sections_of(contents: actor.Contents, samples: int | None, shadows: bool) -> dict[str, Value]:
    """The sections of the scene file."""
    renderer, warn = contents.renderer, contents.warn
    width, height = renderer.GetSize()
    has_holes = any("cutout" in material for material in contents.materials.values())
    samples = samples or (SAMPLES_OF_HOLES if has_holes else SAMPLES)
    return {
        "image": {"width": width, "height": height, "samples_per_pixel": samples},
        "camera": view.camera(renderer, warn),
        "background": view.background(renderer, warn),
        "shading": {"ambient": 1.0, "shadows": shadows},
        "film": {"transfer": "linear"},
        "materials": contents.materials,
        "lights": view.lights(renderer, warn),
        "objects": contents.objects,
    }


def add_prop(contents: actor.Contents, prop: vtkProp, name: str) -> None:
    """Adds what a prop shows, or all parts of an assembly."""
    if not isinstance(prop, vtkProp3D):
        if not prop.IsA("vtkScalarBarActor"):
            contents.warn(f"{kind_of(prop)} cannot be exported; it is left out")
        return
    prop.InitPathTraversal()
    path = prop.GetNextPath()
    while path is not None:
        node = path.GetLastNode()
        leaf = node.GetViewProp()
        if isinstance(leaf, vtkActor) and leaf.GetMapper() is not None:
            if leaf.GetVisibility():
                actor.add_actor(contents, name, leaf, node.GetMatrix())
        else:
            contents.warn(f"{name}: {kind_of(leaf)} cannot be exported; it is left out")
        path = prop.GetNextPath()


def kind_of(prop: vtkProp) -> str:
    """What a user calls a prop."""
    kinds = {"vtkVolume": "a volume", "vtkImageSlice": "a slice of an image", "vtkCubeAxesActor": "axes"}
    found = next((words for kind, words in kinds.items() if prop.IsA(kind)), None)
    return found or ("a text or other drawing over the view" if prop.IsA("vtkActor2D") else prop.GetClassName())


def shown_bars(renderer: vtkRenderer) -> Titles:
    """The titles of the color bars that are shown, with their lookup tables."""
    bars = (prop for prop in renderer.GetViewProps() if prop.IsA("vtkScalarBarActor") and prop.GetVisibility())
    return [(bar.GetLookupTable(), bar.GetTitle() or "") for bar in bars]


def prop_names(renderer: vtkRenderer) -> dict[vtkProp, str]:
    """The names that PyVista's renderer gives its props."""
    actors = getattr(renderer, "actors", {})
    return {prop: re.sub(r"\(Addr=.*\)", "", name) for name, prop in actors.items()}
