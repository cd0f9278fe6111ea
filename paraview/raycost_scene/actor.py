"""Actors → objects and materials of a scene, and the files of their shapes."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkRenderingCore import (
    VTK_FLAT,
    VTK_POINTS,
    VTK_WIREFRAME,
    vtkActor,
    vtkMapper,
    vtkProperty,
    vtkRenderer,
)

from . import geometry, view
from .colors import ArrayColors, Titles, array_colors
from .holes import cutout
from .view import Warn
from .writer import Value

#: Mappers that draw something else than their input.
GLYPHS = ("vtkGlyph3DMapper", "vtkStickMapper", "vtkSphereMapper", "vtkFastLabeledDataMapper", "vtkPVImageSliceMapper")


@dataclass
class Contents:
    """The objects and materials of a scene, and what all of them share."""

    folder: Path
    renderer: vtkRenderer
    titles: Titles
    warn: Warn
    objects: list[Value] = field(default_factory=list)
    materials: dict[str, Value] = field(default_factory=dict)

    def add(self, shape: str, part: Part, data: vtkPolyData, keys: dict[str, Value], material: Value) -> None:
        """Adds an object of a kind, its file and its material."""
        name = unique(f"{part.name} {part.kind}" if part.kind else part.name, self.materials)
        slug = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:40] or "object"
        file = f"{len(self.objects):02}_{slug}.vtp"
        kept = tuple(key["array"] for key in keys.values() if isinstance(key, dict))
        geometry.write(self.folder / file, data, part.colors, kept)
        self.materials[name] = material
        self.objects.append({shape: {"file": file, **keys}, "material": name, "name": name})


@dataclass
class Part:
    """What the objects of one data set of an actor share."""

    name: str
    kind: str
    actor: vtkActor
    colors: ArrayColors | None
    color: Value
    opacity: float
    texture: str | None = None


def add_actor(contents: Contents, name: str, actor: vtkActor, matrix: vtkMatrix4x4) -> None:
    """Adds what an actor shows."""
    mapper = actor.GetMapper()
    if mapper is None or any(mapper.IsA(kind) for kind in GLYPHS):
        contents.warn(f"{name}: {(mapper or actor).GetClassName()} cannot be exported; it is left out")
        return
    mapper.GetInputAlgorithm().Update()
    warn_of_property(contents, name, actor)
    world = view.world_matrix(contents.renderer, matrix)
    for block, data in geometry.blocks(mapper.GetInputDataObject(0, 0)):
        surface = geometry.surface_of(data, world)
        look = block_look(actor, data)
        if surface is not None and look is not None:
            add_surface(contents, f"{name} {block}".strip(), actor, surface, look)


def block_look(actor: vtkActor, data) -> tuple[Value, float] | None:
    """Color and opacity of a block of an actor; none if it is hidden."""
    surface = actor.GetProperty()
    color, opacity = list(base_color(surface)), surface.GetOpacity()
    mapper = actor.GetMapper()
    blocks = getattr(mapper, "GetCompositeDataDisplayAttributes", lambda: None)()
    if blocks is not None:
        if blocks.HasBlockVisibility(data) and not blocks.GetBlockVisibility(data):
            return None
        if blocks.HasBlockColor(data):
            color = [0.0, 0.0, 0.0]
            blocks.GetBlockColor(data, color)
        if blocks.HasBlockOpacity(data):
            opacity = blocks.GetBlockOpacity(data)
    return (color, opacity) if opacity > 0 else None


def add_surface(contents: Contents, name: str, actor: vtkActor, surface: vtkPolyData, look: tuple) -> None:
    """Adds the polygons, lines and points of a data set as the actor shows them."""
    mapper, of = actor.GetMapper(), actor.GetProperty()
    colors = array_colors(mapper, surface, contents.titles, contents.warn)
    if colors is not None:
        (surface.GetPointData() if colors.of_points else surface.GetCellData()).AddArray(colors.array)
    part = Part(name, "", actor, colors, look[0], look[1])
    if mapper.IsA("vtkPointGaussianMapper"):
        add_gaussians(contents, part, surface)
    elif of.GetRepresentation() == VTK_POINTS:
        add_points(contents, part, surface, of_vertices=False)
    elif of.GetRepresentation() == VTK_WIREFRAME:
        if surface.GetNumberOfPolys() or surface.GetNumberOfStrips():
            add_lines(contents, part, geometry.edges_of(surface))
        add_lines(contents, part, surface)
    else:
        add_all(contents, part, surface)


def add_all(contents: Contents, part: Part, surface: vtkPolyData) -> None:
    """Adds polygons as a mesh, lines as tubes and vertices as spheres."""
    of = part.actor.GetProperty()
    if surface.GetNumberOfPolys() or surface.GetNumberOfStrips():
        keys = {"normals": "flat"} if of.GetInterpolation() == VTK_FLAT else {}
        part.texture = texture(contents, part.actor, surface)
        contents.add("mesh", part, surface, keys, material(contents, part))
        part.texture = None
        if of.GetEdgeVisibility():
            edges = Part(part.name, "edges", part.actor, None, list(of.GetEdgeColor()), part.opacity)
            add_lines(contents, edges, geometry.edges_of(surface), flat=True)
    add_lines(contents, part, surface)
    if surface.GetNumberOfVerts():
        add_points(contents, part, surface, of_vertices=True)


def add_lines(contents: Contents, part: Part, lines: vtkPolyData, flat: bool = False) -> None:
    """Adds lines as tubes that are as wide at the focal point as VTK draws them."""
    if lines.GetNumberOfLines():
        radius = part.actor.GetProperty().GetLineWidth() / 2 * view.pixel_size(contents.renderer)
        part.kind = part.kind or "lines"
        contents.add("tubes", part, lines, {"radius": radius}, material(contents, part, flat))


def add_points(contents: Contents, part: Part, surface: vtkPolyData, of_vertices: bool) -> None:
    """Adds points as spheres that are as large at the focal point as VTK draws them."""
    points = geometry.points_of(surface, of_vertices)
    if part.colors is not None:
        part.colors.show_at_points()
    if points.GetNumberOfPoints():
        radius = part.actor.GetProperty().GetPointSize() / 2 * view.pixel_size(contents.renderer)
        part.kind = "points"
        contents.add("spheres", part, points, {"radius": radius}, material(contents, part))


def add_gaussians(contents: Contents, part: Part, surface: vtkPolyData) -> None:
    """Adds the points of a Point Gaussian as spheres with its radius, or with an array of them."""
    mapper = part.actor.GetMapper()
    factor, name = mapper.GetScaleFactor(), mapper.GetScaleArray()
    if factor <= 0:
        add_points(contents, part, surface, of_vertices=False)
        return
    keys: dict[str, Value] = {"radius": factor}
    array = surface.GetPointData().GetArray(name) if name else None
    if array is not None:
        surface = geometry.positive_radii(surface, radii(mapper, array, factor))
        keys["radius"] = {"array": geometry.RADIUS}
    if surface.GetNumberOfPoints():
        contents.add("spheres", part, surface, keys, material(contents, part))


def radii(mapper: vtkMapper, array, factor: float) -> list[float]:
    """The radius of each point."""
    component = min(max(mapper.GetScaleArrayComponent(), 0), array.GetNumberOfComponents() - 1)
    values = (array.GetComponent(i, component) for i in range(array.GetNumberOfTuples()))
    function = mapper.GetScaleFunction()
    if function is not None:
        values = map(function.GetValue, values)
    return [factor * value for value in values]


def material(contents: Contents, part: Part, flat: bool = False) -> Value:
    """The material that looks like a property of VTK: in the numbers of the screen."""
    of = part.actor.GetProperty()
    color = part.colors.color if part.colors else part.color
    if part.texture and not flat:
        texels = "bilinear" if part.actor.GetTexture().GetInterpolate() else "nearest"
        color = {"image": {"file": part.texture, "filter": texels, "transfer": "linear"}}
    found: dict[str, Value] = {"color": color}
    if flat or not of.GetLighting():
        found.update(ambient=1.0, diffuse=0.0)
    else:
        found.update(ambient=of.GetAmbient(), diffuse=of.GetDiffuse())
        if of.GetSpecular() > 0:
            shine = of.GetSpecular() * sum(of.GetSpecularColor()) / 3
            # Blinn's angle is half of that of Phong, which VTK computes for all but a headlight.
            factor = 1 if view.has_headlight_alone(contents.renderer) else 4
            found.update(specular=shine, exponent=factor * of.GetSpecularPower())
    if part.opacity < 1:
        size = view.pixel_size(contents.renderer)
        found["cutout"] = cutout(contents.folder, part.opacity, size, contents.renderer)
    return found


def texture(contents: Contents, actor: vtkActor, surface: vtkPolyData) -> str | None:
    """The file of the actor's texture, if it has one and the surface has coordinates for it."""
    image = actor.GetTexture() and actor.GetTexture().GetInput()
    if not image or surface.GetPointData().GetTCoords() is None:
        return None
    file = f"{len(contents.objects):02}_texture.png"
    geometry.write_picture(contents.folder / file, image)
    return file


def base_color(of: vtkProperty) -> tuple:
    """The color of a property without an array."""
    return of.GetDiffuseColor() if of.GetDiffuse() or not of.GetAmbient() else of.GetAmbientColor()


def warn_of_property(contents: Contents, name: str, actor: vtkActor) -> None:
    """Warns of what raycost does not show."""
    of, mapper = actor.GetProperty(), actor.GetMapper()
    missing = {
        "its clipping planes": bool(mapper.GetClippingPlanes() and mapper.GetClippingPlanes().GetNumberOfItems()),
        "culling of its faces": bool(of.GetBackfaceCulling() or of.GetFrontfaceCulling()),
        "physically based rendering": of.GetInterpolation() > 2,
    }
    found = [what for what, is_there in missing.items() if is_there]
    if found:
        contents.warn(f"{name}: {' and '.join(found)} cannot be exported")


def unique(name: str, taken: dict[str, Value]) -> str:
    """The name, with a number where it is taken."""
    name, number = name[:200] or "object", 2
    found = name
    while found in taken:
        found, number = f"{name} {number}", number + 1
    return found
