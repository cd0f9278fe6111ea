"""Camera, background and lights of a renderer → the sections of a scene."""

from __future__ import annotations

import math
from collections.abc import Callable

from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkRenderingCore import vtkCamera, vtkLight, vtkRenderer

from .writer import Value

Warn = Callable[[str], None]


def camera(renderer: vtkRenderer, warn: Warn) -> Value:
    """The `camera` section."""
    of = renderer.GetActiveCamera()
    view: dict[str, Value] = {
        "eye": list(of.GetPosition()),
        "target": list(of.GetFocalPoint()),
        "up": list(of.GetViewUp()),
    }
    if any(of.GetWindowCenter()):
        warn("the view is off the camera's center, which raycost ignores")
    if of.GetParallelProjection():
        view["eye"] = eye_before(renderer, of)
        return {"orthographic": {**view, "height": 2.0 * of.GetParallelScale()}}
    return {"look_at": {**view, "fov_y_deg": vertical_angle(renderer, of)}}


def eye_before(renderer: vtkRenderer, of: vtkCamera) -> list[float]:
    """The eye, so far back that all that is shown lies before it: rays of raycost start there."""
    nearest = min(of.GetClippingRange()[0], 0.0)
    back = 1.5 * nearest
    return [at + back * along for at, along in zip(of.GetPosition(), of.GetDirectionOfProjection())]


def vertical_angle(renderer: vtkRenderer, of: vtkCamera) -> float:
    """The vertical angle of view in degrees."""
    if not of.GetUseHorizontalViewAngle():
        return of.GetViewAngle()
    width, height = renderer.GetSize()
    half = math.tan(math.radians(of.GetViewAngle()) / 2) * height / width
    return math.degrees(2 * math.atan(half))


def pixel_size(renderer: vtkRenderer) -> float:
    """The height of a pixel in world units, at the focal point."""
    of = renderer.GetActiveCamera()
    if of.GetParallelProjection():
        height = 2 * of.GetParallelScale()
    else:
        height = 2 * of.GetDistance() * math.tan(math.radians(vertical_angle(renderer, of)) / 2)
    return height / max(renderer.GetSize()[1], 1)


def background(renderer: vtkRenderer, warn: Warn) -> Value:
    """The `background` section."""
    bottom, top = renderer.GetBackground(), renderer.GetBackground2()
    if renderer.GetTexturedBackground() and renderer.GetBackgroundTexture():
        warn("the background's picture becomes its color")
    if not renderer.GetGradientBackground() or bottom == top:
        return list(bottom)
    warn("the background's gradient becomes the color in its middle")
    return [(low + high) / 2 for low, high in zip(bottom, top)]


def lights(renderer: vtkRenderer, warn: Warn) -> list[Value]:
    """The `lights` section: all that are on, where the camera has them."""
    renderer.UpdateLightsGeometryToFollowCamera()
    found = [light for light in renderer.GetLights() if light.GetSwitch() and light.GetIntensity() > 0]
    if not found and not renderer.GetLights().GetNumberOfItems() and renderer.GetAutomaticLightCreation():
        eye, focal_point = (getattr(renderer.GetActiveCamera(), f"Get{of}")() for of in ("Position", "FocalPoint"))
        return [directional(eye, focal_point, {})]
    return [exported(light, warn) for light in found]


def exported(light: vtkLight, warn: Warn) -> Value:
    """One of the `lights`."""
    position, target = light.GetTransformedPosition(), light.GetTransformedFocalPoint()
    shine = {"color": list(light.GetDiffuseColor()), "intensity": light.GetIntensity()}
    if not light.GetPositional():
        return directional(position, target, shine)
    shine = {"position": list(position), **shine, "falloff": falloff(light, warn)}
    angle = 2 * light.GetConeAngle()
    if angle >= 180:
        return {"point": shine}
    return {"spot": {**shine, "target": list(target), "angle_deg": angle, "soft_edge": 0.0}}


def directional(start: tuple, end: tuple, shine: dict[str, Value]) -> Value:
    """A light from one direction."""
    return {"directional": {"direction": [b - a for a, b in zip(start, end)], **shine}}


def falloff(light: vtkLight, warn: Warn) -> str:
    """The nearest falloff; the factors of the others go into its intensity."""
    names = ("none", "inverse", "inverse_square")
    factors = light.GetAttenuationValues()
    present = [i for i, factor in enumerate(factors) if factor]
    if len(present) != 1 or factors[present[0]] != 1:
        warn("a light's attenuation becomes the nearest of raycost's")
    return names[max(present, default=0)]


def has_headlight_alone(renderer: vtkRenderer) -> bool:
    """Whether one light shines along the view, whose highlights VTK computes by another formula."""
    found = [light for light in renderer.GetLights() if light.GetSwitch()]
    return len(found) <= 1 and all(light.LightTypeIsHeadlight() and not light.GetPositional() for light in found)


def world_matrix(renderer: vtkRenderer, of_prop: vtkMatrix4x4 | None) -> vtkMatrix4x4:
    """From a prop's coordinates to those of the scene, with the transform that the camera has for all."""
    matrix = vtkMatrix4x4()
    matrix.DeepCopy(renderer.GetActiveCamera().GetModelTransformMatrix())
    if of_prop is not None:
        vtkMatrix4x4.Multiply4x4(matrix, of_prop, matrix)
    return matrix
