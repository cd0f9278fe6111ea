"""The colors of a mapper → the `color` of a material."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from vtkmodules.vtkCommonCore import reference, vtkDataArray, vtkFloatArray, vtkScalarsToColors, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkAbstractMapper, vtkColorTransferFunction, vtkMapper

from .view import Warn
from .writer import Value

Color = tuple  # red, green and blue from 0 to 1
Titles = list[tuple[vtkScalarsToColors, str]]

#: Positions at which a color map is compared with a shorter list of its colors.
N_SAMPLES = 1024
#: An invisible difference of colors.
TOLERANCE = 2 / 255
#: Most characters of a name in a scene.
MAX_NAME = 256
#: Steps that are so many stand for a smooth map.
MIN_SMOOTH = 256
#: Modes of a mapper, whose names Python does not know.
VTK_COLOR_MODE_DEFAULT, VTK_COLOR_MODE_DIRECT_SCALARS = 0, 2
#: The most colors of a list in a scene.
MAX_COLORS = 1024


@dataclass
class ArrayColors:
    """An array, and the `color` of the material that shows it."""

    array: vtkDataArray
    of_points: bool
    color: Value

    def show_at_points(self) -> None:
        """Shows the values of cells at their points."""
        self.of_points = True
        self.color["array"].pop("of", None)


def array_colors(mapper: vtkMapper, surface: vtkPolyData, titles: Titles, warn: Warn) -> ArrayColors | None:
    """The colors by an array, if the mapper shows one that the surface has.

    `titles` has the titles of color bars with their lookup tables.
    """
    if not mapper.GetScalarVisibility():
        return None
    array, of_points = shown_array(mapper, surface)
    if array is None:
        return None
    array = named(array)
    if shows_colors_themselves(mapper, array):
        return direct_colors(array, of_points, not of_points or mapper.IsA("vtkPointGaussianMapper"), warn)
    keys = {"name": array.GetName(), **component(mapper, array), "of": "points" if of_points else "cells"}
    keys.update(color_map(mapper, warn))
    title = next((title for table, title in titles if table is mapper.GetLookupTable()), None)
    if title and "categories" not in keys["map"]:
        keys["bar"] = title
    return ArrayColors(array, of_points, {"array": keys})


def named(array: vtkDataArray) -> vtkDataArray:
    """The array, under a name that scenes may have, and that VTK's writer does not escape."""
    name = re.sub(r"[\x00-\x1f\"<>&]", "_", array.GetName() or "colors")[:MAX_NAME]
    if name == array.GetName():
        return array
    copy = array.NewInstance()
    copy.ShallowCopy(array)
    copy.SetName(name)
    return copy


def shown_array(mapper: vtkMapper, surface: vtkPolyData) -> tuple[vtkDataArray | None, bool]:
    """The array that the mapper shows, and whether it has values of points."""
    flag = reference(0)
    array = vtkAbstractMapper.GetAbstractScalars(
        surface,
        mapper.GetScalarMode(),
        mapper.GetArrayAccessMode(),
        mapper.GetArrayId(),
        mapper.GetArrayName(),
        flag,
    )
    is_numeric = isinstance(array, vtkDataArray) and int(flag) in (0, 1)
    return (array if is_numeric else None), int(flag) == 0


def shows_colors_themselves(mapper: vtkMapper, array: vtkDataArray) -> bool:
    """Whether the array has colors in place of numbers that are mapped."""
    mode = mapper.GetColorMode()
    is_color = mode == VTK_COLOR_MODE_DIRECT_SCALARS or (
        mode == VTK_COLOR_MODE_DEFAULT and isinstance(array, vtkUnsignedCharArray)
    )
    return is_color and array.GetNumberOfComponents() >= 3


def direct_colors(array: vtkDataArray, of_points: bool, is_discrete: bool, warn: Warn) -> ArrayColors:
    """Colors of an array of red, green and blue, as categories; their mean where they are interpolated."""
    whole = 255 if isinstance(array, vtkUnsignedCharArray) else 1
    colors = [tuple(x / whole for x in array.GetTuple(i)[:3]) for i in range(array.GetNumberOfTuples())]
    if not is_discrete and len(set(colors)) > 1:
        warn(f"the array {array.GetName()} has colors in place of numbers, which become their mean")
        colors = [tuple(sum(color[i] for color in colors) / len(colors) for i in range(3))] * len(colors)
    # As many levels as the longest list has room for.
    for n_levels in (255, 63, 31, 15, 9):
        rounded = [tuple(round(n_levels * x) / n_levels for x in color) for color in colors]
        distinct = list(dict.fromkeys(rounded))
        if len(distinct) <= MAX_COLORS:
            break
    number = {color: i for i, color in enumerate(distinct)}
    numbers = vtkFloatArray()
    numbers.SetName(array.GetName())
    for color in rounded:
        numbers.InsertNextValue(number[color])
    keys = {"name": array.GetName(), "map": {"categories": [hexadecimal(color) for color in distinct]}}
    return ArrayColors(numbers, of_points, {"array": keys})


def component(mapper: vtkMapper, array: vtkDataArray) -> dict[str, Value]:
    """Which component is shown; none for the magnitude."""
    if array.GetNumberOfComponents() == 1:
        return {}
    table = mapper.GetLookupTable()
    if table.GetVectorMode() == vtkScalarsToColors.MAGNITUDE:
        return {}
    return {"component": min(table.GetVectorComponent(), array.GetNumberOfComponents() - 1)}


def color_map(mapper: vtkMapper, warn: Warn) -> dict[str, Value]:
    """`map`, `range`, `scale` and `nan_color`."""
    table = mapper.GetLookupTable()
    table.Build()
    nan_color = list(table.GetNanColor()[:3])
    if table.GetIndexedLookup():
        return {"map": {"categories": categories(table)}, "nan_color": nan_color}
    uses_own = mapper.GetUseLookupTableScalarRange() or not table.IsA("vtkLookupTable")
    low, high = table.GetRange() if uses_own else mapper.GetScalarRange()
    is_log = bool(table.UsingLogScale())
    if is_log and low <= 0:
        warn("a color map with a logarithmic scale has a range from 0 or below; it becomes linear")
        is_log = False
    low, high = ascending(low, high)
    keys: dict[str, Value] = {"map": shortest(table, low, high, is_log), "range": [low, high]}
    if is_log:
        keys["scale"] = "log"
    return {**keys, "nan_color": nan_color}


def ascending(low: float, high: float) -> tuple[float, float]:
    """A range whose ends differ as numbers of 32 bits."""
    if not (math.isfinite(low) and math.isfinite(high)):
        return 0.0, 1.0
    margin = 1e-5 * max(abs(low), abs(high), 1e-30)
    return (low, high) if high - low > margin else (low, low + max(margin, 1e-6 * abs(low), 1e-6))


def shortest(table: vtkScalarsToColors, low: float, high: float, is_log: bool) -> Value:
    """The shortest list of colors that looks like the table: interpolated ones, or bands."""

    if table.IsA("vtkDiscretizableColorTransferFunction") and n_bands(table) >= MIN_SMOOTH:
        smooth = vtkColorTransferFunction()
        smooth.DeepCopy(table)
        table = smooth

    def at(position: float) -> Color:
        value = low * (high / low) ** position if is_log else low + (high - low) * position
        color = [0.0, 0.0, 0.0]
        table.GetColor(value, color)
        return tuple(color)

    samples = [at((i + 0.5) / N_SAMPLES) for i in range(N_SAMPLES)]
    for n in (2, 3, 5, 9, 17, 33, 65, 129):
        colors = [at(i / (n - 1)) for i in range(n)]
        if looks_like(colors, samples):
            return {"colors": [hexadecimal(color) for color in colors]}
    n = min(n_bands(table), MAX_COLORS)
    return {"bands": [hexadecimal(at((i + 0.5) / n)) for i in range(n)]}


def looks_like(colors: list[Color], samples: list[Color]) -> bool:
    """Whether the colors, interpolated, are those of the samples."""
    for i, sample in enumerate(samples):
        place = (i + 0.5) / len(samples) * (len(colors) - 1)
        first, share = int(place), place % 1
        pairs = zip(colors[first], colors[first + 1], sample)
        if any(abs(a + share * (b - a) - c) > TOLERANCE for a, b, c in pairs):
            return False
    return True


def n_bands(table: vtkScalarsToColors) -> int:
    """Number of different colors of a table that has steps."""
    if table.IsA("vtkLookupTable"):
        return table.GetNumberOfTableValues()
    if table.IsA("vtkDiscretizableColorTransferFunction") and table.GetDiscretize():
        return table.GetNumberOfValues()
    return MAX_COLORS


def categories(table: vtkScalarsToColors) -> list[str]:
    """The colors of 0, 1, 2 and so on, by the annotations if there are some."""
    n = table.GetNumberOfAnnotatedValues() or table.GetNumberOfAvailableColors()
    values = [table.GetAnnotatedValue(i).ToDouble() for i in range(table.GetNumberOfAnnotatedValues())]
    count = int(max(values, default=n - 1)) + 1
    found = []
    for value in range(min(count, MAX_COLORS)):
        rgba = [0.0, 0.0, 0.0, 1.0]
        table.GetAnnotationColor(value, rgba)
        found.append(hexadecimal(rgba[:3]))
    return found or ["#ffffff"]


def hexadecimal(color: Color) -> str:
    """A color as `#rrggbb`."""
    return "#" + "".join(f"{round(255 * min(max(channel, 0), 1)):02x}" for channel in color)
