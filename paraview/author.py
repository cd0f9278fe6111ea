"""Authors the ParaView states beside this script.

Takes an output folder of `raycost render --also schedule,surface,bvh` as the sample to build
the pipelines against, into which `raycost trace` and `raycost diff` have written, too:

    xvfb-run -a pvbatch paraview/author.py out/NAME [STATE ...]

Gives one state for each function in `STATES`, or for those that are named. A state serves twice: ParaView loads it as it is,
with paths under `$RAYCOST_OUT`, and the renderer fills it in for each of its outputs.

Why a script: a state is then as short and as easy to compare as what is said here. `put` sets a
property for the file to keep; a value that depends on the output is a `Fill`. README.md lists them.
"""

import math
import sys
from pathlib import Path

import numpy as np
from paraview import simple as pv
from paraview.vtk.util.numpy_support import vtk_to_numpy
from template import Fill, put, reader, save, vector

N_COLORS = 52  # control points of a color map: every fifth color of the renderer's tables
INFERNO, VIRIDIS, TURBO = "inferno", "viridis", "turbo"  # the renderer's names, and ParaView's
BLUE_RED = "red_blue_reversed"  # light in the middle, where nothing changes
PRESETS = {INFERNO: "Inferno (matplotlib)", VIRIDIS: "Viridis (matplotlib)", TURBO: "Turbo", BLUE_RED: "BuRd"}
CRIMSON = ("0.73", "0.21", "0.33")  # the middle of Inferno
OPAQUE = (1, 1, 1, 1)  # behind titles and color bars: the geometry may reach there
BLACK, WHITE, LIGHT_GRAY, DARK_GRAY = (0, 0, 0), (1, 1, 1), (0.85, 0.85, 0.85), (0.3, 0.3, 0.3)
BACKDROP = dict(
    UseColorPaletteForBackground=0, Background=WHITE, OrientationAxesVisibility=0, CenterAxesVisibility=0
)
TEXTS_OF_AXES = ("BottomAxisLabel", "LeftAxisLabel", "BottomAxisTitle", "LeftAxisTitle")
UNLIT = dict(Ambient=1, Diffuse=0)  # so that colors are those of the color bar
SQUARES = """//VTK::Color::Impl
if (max(abs(offsetVCVSOutput.x), abs(offsetVCVSOutput.y)) > 1.01) { discard; }
"""
DISCS = """//VTK::Color::Impl
float d = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);
if (d > 1.0) { discard; }
if (d > 0.88) { ambientColor *= 0.4; diffuseColor *= 0.4; }
"""


# ---------------------------------------------------------------------------------------- states


def geometry(out):
    """The hit cloud in its own colors and colored by what each hit cost."""
    hits = without_horizon(reader(pv.XMLUnstructuredGridReader, out / "hits.vtu"))
    cost = in_unit(hits, "POINTS", "cost", "time_ns")
    color, by_cost = (render_view(scene_camera(2)) for _ in range(2))
    put(cloud(hits, color), **true_colors())
    caption(Fill("hits.caption", "True colors"), color)
    inferno = color_map(cost, "cost", INFERNO, "log", "cost")
    put(cloud(cost, by_cost), ColorArrayName=["POINTS", "cost"], LookupTable=inferno)
    color_bar(inferno, by_cost)
    caption(Fill("cost.title", "Time per pixel"), by_cost)
    layout("Geometry", beside(color, by_cost))


def heatmap(out):
    """Time and node visits of every pixel as pictures, and the histogram of the time.

    Where no time was measured, `cost` is the node visits, and `counter` what comes next.
    """
    frame = reader(pv.XMLImageDataReader, out / "frame.vti")
    cost = in_unit(frame, "POINTS", "cost", "time_ns")
    counter = in_unit(frame, "POINTS", "counter", "node_visits")
    time = picture(cost, "cost", INFERNO, "log", 3)
    visits = picture(counter, "counter", VIRIDIS, "log", 3)
    layout("Heatmap", above(0.67, beside(time, visits), histogram(frame, "time_ns", "cost", "histogram.title")))


def overview(out):
    """What was rendered and what it cost on one page: the picture above the cloud, the time above its histogram."""
    frame = reader(pv.XMLImageDataReader, out / "frame.vti")
    cost = in_unit(frame, "POINTS", "cost", "time_ns")
    hits = without_horizon(reader(pv.XMLUnstructuredGridReader, out / "hits.vtu"))
    cost_of_hits = in_unit(hits, "POINTS", "cost", "time_ns")
    color = true_picture(frame, 4)
    time = picture(cost, "cost", INFERNO, "log", 4)
    turned = render_view(scene_camera(4))
    inferno = pv.GetColorTransferFunction("cost")
    put(cloud(cost_of_hits, turned), ColorArrayName=["POINTS", "cost"], LookupTable=inferno)
    color_bar(inferno, turned)
    caption("The same in space: turn it", turned)
    layout("Overview", above(0.5, beside(color, time), beside(turned, histogram(frame, "time_ns", "cost", "histogram.notes"))))


def schedule(out):
    """The picture, and its tiles by the time that they took, by thread and by when they were begun."""
    frame = reader(pv.XMLImageDataReader, out / "frame.vti")
    tiles = reader(pv.XMLImageDataReader, out / "tiles.vti")
    duration = in_unit(tiles, "CELLS", "tiles.duration", "duration_ns")
    start = in_unit(tiles, "CELLS", "tiles.start", "start_ns")
    color = true_picture(frame, 4)
    by_duration = tile_map(duration, frame, "tiles.duration", INFERNO, "log")
    by_start = tile_map(start, frame, "tiles.start", VIRIDIS, "linear")
    by_thread = tile_map(tiles, frame, "thread", TURBO, "linear", key="tiles.thread")
    shown = pv.GetRepresentation(tiles, by_thread)
    put(shown, ColorArrayName=["CELLS", Fill("tiles.thread.array", "thread")])
    put(shown, AmbientColor=LIGHT_GRAY, DiffuseColor=LIGHT_GRAY)
    put(pv.GetScalarBar(pv.GetColorTransferFunction("thread"), by_thread), Visibility=Fill("tiles.thread.bar", 1))
    layout("Schedule", above(0.5, beside(color, by_duration), beside(by_thread, by_start)))


def surface(out):
    """The scene's geometry by what each primitive cost and by the tests that met nothing."""
    shapes = in_unit(reader(pv.XMLUnstructuredGridReader, out / "surface.vtu"), "CELLS", "surface", "time_ns")
    spheres = pv.CellCenters(Input=shapes)
    pv.RenameSource("Centers", spheres)
    time, waste = (render_view(scene_camera(2)) for _ in range(2))
    for view, array, preset, key in (
        (time, "surface", INFERNO, "surface"),
        (waste, "wasted_tests", VIRIDIS, "surface.wasted"),
    ):
        colors = color_map(shapes, array, preset, "log", key)
        put(
            pv.Show(shapes, view),
            Representation=Fill("surface.representation", "Surface With Edges"),
            EdgeColor=DARK_GRAY,
            ColorArrayName=["CELLS", array],
            LookupTable=colors,
            **UNLIT,
        )
        balls(spheres, view, array, colors)
        color_bar(colors, view)
        caption(Fill(f"{key}.title", key), view)
    layout("Surface", beside(time, waste))


def bvh(out):
    """The boxes of the hierarchy by their cost over the hits, and by their wasted visits.

    Leaves where they are few enough to be distinguished, else the nodes of one depth; few of them as
    frames, through which the scene is seen.
    """
    hits = without_horizon(reader(pv.XMLUnstructuredGridReader, out / "hits.vtu"))
    nodes = reader(pv.XMLUnstructuredGridReader, out / "bvh.vtu")
    level = Fill("bvh.level", 1)
    shown = kept(
        nodes, "CELLS", Fill("bvh.level.array", "is_leaf"), "Level",
        ThresholdMethod="Between", LowerThreshold=level, UpperThreshold=level,
    )
    shown = in_unit(shown, "CELLS", "bvh", "time_ns")
    time, waste = (render_view(scene_camera(2)) for _ in range(2))
    for view, array, preset, key in (
        (time, "bvh", INFERNO, "bvh"),
        (waste, "wasted_visits", VIRIDIS, "bvh.wasted"),
    ):
        put(cloud(hits, view), **true_colors())
        colors = color_map(shown, array, preset, "log", key)
        put(
            pv.Show(shown, view),
            Representation=Fill("bvh.representation", "Wireframe"),
            LineWidth=Fill("bvh.line_width", 3),
            EdgeColor=DARK_GRAY,
            ColorArrayName=["CELLS", array],
            LookupTable=colors,
            **UNLIT,
        )
        color_bar(colors, view, Fill(f"{key}.title", key))
        caption(Fill("bvh.caption", "The hierarchy"), view)
    layout("BVH", beside(time, waste))


def rays(out):
    """The rays of traced pixels in the scene's cloud, seen from their side: by kind and by cost."""
    lines = threshold(
        reader(pv.XMLPolyDataReader, out / "rays.vtp"), "CELLS", "length", Fill("rays.max_length", 1e30), "Rays"
    )
    lines = in_unit(lines, "CELLS", "rays.cost", "time_ns")
    heads = arrow_heads(lines)
    hits = without_horizon(reader(pv.XMLUnstructuredGridReader, out / "rays_cloud.vtu"))
    kind, cost = (render_view(side_camera()) for _ in range(2))
    inferno = color_map(lines, "rays.cost", INFERNO, "linear", "rays.cost")
    for view, array, colors in ((kind, "kind", ray_kinds()), (cost, "rays.cost", inferno)):
        put(cloud(hits, view), **true_colors(), Opacity=0.3)
        put(drawn(lines, view), ColorArrayName=["CELLS", array], LookupTable=colors)
        put(pv.Show(heads, view), ColorArrayName=["POINTS", array], LookupTable=colors, **UNLIT)
    bar(pv.GetScalarBar(pv.GetColorTransferFunction("kind"), kind), "")
    caption(Fill("rays.caption", "Kind of each ray"), kind)
    color_bar(inferno, cost)
    caption(Fill("rays.cost.title", "Time of each ray"), cost)
    layout("Rays", beside(kind, cost))


def diff(out):
    """What each pixel's cost changed by between two outputs, as a difference and as a ratio, above
    the histogram of the difference."""
    change = reader(pv.XMLImageDataReader, out / "diff.vti")
    shown = in_unit(change, "POINTS", "difference", "time_ns_difference")
    ratio = in_unit(change, "POINTS", "ratio", "time_ns_ratio")
    by_difference = picture(shown, "difference", BLUE_RED, "linear", 3, around_zero)
    by_ratio = picture(ratio, "ratio", BLUE_RED, "log", 3, around_one)
    ends = fill_ends("difference.at", around_zero(shown, "difference"))
    view = bars(shown, "difference", ends, Fill("difference.title", "B - A"))
    labels(view, "difference.labels")
    layout("Difference", above(0.67, beside(by_difference, by_ratio), view))


STATES = (geometry, heatmap, overview, schedule, surface, bvh, rays, diff)


# ----------------------------------------------------------------------------------------- parts


def render_view(camera):
    return put(pv.CreateView("RenderView"), **BACKDROP, **camera)


def true_colors():
    return dict(ColorArrayName=["POINTS", "RGB"], MapScalars=0)


def without_horizon(hits):
    """The hits up to a distance: ParaView hides all that is 1000 times nearer than the farthest."""
    return threshold(hits, "POINTS", "distance", Fill("hits.max_distance", 1e30), "Without the horizon")


def threshold(source, where, array, highest, name):
    """The points or cells whose value is not above the highest."""
    return kept(source, where, array, name, ThresholdMethod="Below Lower Threshold", LowerThreshold=highest)


def kept(source, where, array, name, **ends):
    cells = put(pv.Threshold(Input=source), SelectInputScalars=[where, array], **ends)
    pv.RenameSource(name, cells)
    cells.UpdatePipeline()
    return cells


def in_unit(source, where, key, array):
    """The source with one more array, named as the key: the file's array in a unit that fits its values."""
    return calculated(source, where, key, Fill(f"{key}.formula", array), f"{key} in its unit")


def calculated(source, where, result, formula, name):
    kind = {"POINTS": "Point Data", "CELLS": "Cell Data"}[where]
    calculator = pv.Calculator(Input=source)
    put(calculator, AttributeType=kind, Function=formula, ResultArrayName=result, ResultArrayType="Float")
    pv.RenameSource(name, calculator)
    calculator.UpdatePipeline()
    return calculator


def cloud(hits, view):
    """One disc a hit, wide enough to cover its pixel's corners: no gaps as seen from the camera."""
    return put(
        pv.Show(hits, view),
        Representation="Point Gaussian",
        ShaderPreset="Plain circle",
        ScaleByArray=1,
        SetScaleArray=["POINTS", "footprint"],
        UseScaleFunction=0,
        GaussianRadius=0.75,
    )


def pixels(frame, view):
    """One square a pixel, unlit and unblended.

    Not the representation Slice: as a state is loaded, ParaView's window draws views before their
    data is there, which that alone takes for an error. Surface would blend neighbors.
    """
    return put(
        pv.Show(frame, view),
        Representation="Point Gaussian",
        ShaderPreset="Custom",
        CustomShader=SQUARES,
        CustomTriangleScale=2,
        ScaleByArray=0,
        UseScaleFunction=0,
        GaussianRadius=0.5,
    )


def balls(source, view, array, lut):
    """One flat disc a sphere, with the sphere's radius and a dark edge."""
    return put(
        pv.Show(source, view),
        Representation="Point Gaussian",
        ShaderPreset="Custom",
        CustomShader=DISCS,
        CustomTriangleScale=2,
        ScaleByArray=1,
        SetScaleArray=["POINTS", "radius"],
        UseScaleFunction=0,
        GaussianRadius=1,
        ColorArrayName=["POINTS", array],
        LookupTable=lut,
    )


def drawn(lines, view):
    """Lines of the same width near and far, not lit."""
    width = Fill("rays.line_width", 3)
    return put(pv.Show(lines, view), Representation="Wireframe", LineWidth=width, **UNLIT)


def arrow_heads(lines):
    """A cone at the end of each ray, its tip where the ray ends."""
    middles = pv.CellCenters(Input=lines)
    pv.RenameSource("Middles", middles)
    formula = Fill("rays.to_head", "direction*(0.5*length-0.02)")
    shifts = calculated(middles, "POINTS", "to_head", formula, "From middles to heads")
    ends = put(pv.WarpByVector(Input=shifts), SelectInputVectors=["POINTS", "to_head"])
    pv.RenameSource("Ends", ends)
    heads = pv.Glyph(Input=ends, GlyphType="Cone")
    put(
        heads,
        OrientationArray=["POINTS", "direction"],
        ScaleArray=["POINTS", "No scale array"],
        ScaleFactor=Fill("rays.head", 0.04),
        GlyphMode="All Points",
    )
    put(heads.GlyphType, Resolution=12, Radius=0.25, Height=1.0)
    pv.RenameSource("Arrow heads", heads)
    return heads


def ray_kinds():
    """The kinds of rays by name, in colors that are distinct with any color vision (Okabe and Ito, 2008)."""
    kinds = {
        "camera": (0, 0.45, 0.70),
        "shadow": (0.90, 0.62, 0),
        "reflection": (0.84, 0.37, 0),
    }
    return put(
        pv.GetColorTransferFunction("kind"),
        IndexedLookup=1,  # InterpretValuesAsCategories in scripts
        Annotations=Fill("rays.kinds", [text for number, name in enumerate(kinds) for text in (str(number), name)]),
        IndexedColors=Fill("rays.kind_colors", [channel for color in kinds.values() for channel in color]),
    )


def true_picture(frame, n_panels):
    view = render_view(picture_camera(frame, n_panels))
    put(pixels(frame, view), **true_colors())
    caption(Fill("subject", "The picture"), view)
    return view


def picture(frame, key, preset, scale, n_panels, ends=None):
    """A view of one array, named as its key, as a flat picture in one of so many panels."""
    view = render_view(picture_camera(frame, n_panels))
    colors = color_map(frame, key, preset, scale, key, ends)
    put(pixels(frame, view), ColorArrayName=["POINTS", key], LookupTable=colors)
    color_bar(colors, view)
    caption(Fill(f"{key}.title", key), view)
    return view


def tile_map(tiles, frame, array, preset, scale, key=None):
    """A view of one array of the tiles, flat and unlit, where the picture's pixels would be."""
    key = key or array
    view = render_view(picture_camera(frame, 4))
    colors = color_map(tiles, array, preset, scale, key)
    put(
        pv.Show(tiles, view),
        Representation="Surface",
        ColorArrayName=["CELLS", array],
        LookupTable=colors,
        **UNLIT,
    )
    color_bar(colors, view)
    caption(Fill(f"{key}.{'caption' if array == 'thread' else 'title'}", "Thread of each tile"), view)
    return view


def histogram(frame, array, key, title):
    """A view of how many pixels took which value: bars over log10, labeled with the values."""
    log10 = calculated(frame, "POINTS", "log10", Fill(f"{key}.log10.formula", f"log10({array})"), "log10")
    ends = fill_ends(f"{key}.log10", [math.log10(end) for end in spread(frame, array)])
    view = bars(log10, "log10", ends, Fill(f"{key}.log10.title", f"{array}, log scale"))
    put(view, ChartTitle=Fill(title, "Histogram"))
    return labels(view, f"{key}.log10.labels")


def labels(view, key):
    """Labels of a chart's lower axis where the renderer wants them."""
    return put(view, BottomAxisUseCustomLabels=1, BottomAxisLabels=Fill(key, ["0", "1"]))


def bars(source, array, ends, title):
    """A view of how many pixels have which value of an array, in 100 bins between the ends."""
    bins = put(
        pv.Histogram(Input=source),
        SelectInputArray=["POINTS", array],
        BinCount=100,
        UseCustomBinRanges=1,
        CustomBinRanges=ends,
    )
    pv.RenameSource("Histogram", bins)
    view = put(
        pv.CreateView("XYBarChartView"),
        ChartTitle="Histogram",
        ChartTitleFontSize=16,
        BottomAxisTitle=title,
        BottomAxisTitleFontSize=16,
        BottomAxisLabelFontSize=14,
        LeftAxisTitle="Pixels, log scale",
        LeftAxisTitleFontSize=16,
        LeftAxisLabelFontSize=14,
        LeftAxisLogScale=1,
        LeftAxisUseCustomRange=1,  # a logarithmic axis does not show bins without pixels by itself
        LeftAxisRangeMinimum=0.7,
        LeftAxisRangeMaximum=Fill("histogram.pixels", n_pixels(source)),
        # In Arial, pictures that ParaView saves have a second row of dashes below each label.
        **{f"{text}FontFamily": "Courier" for text in TEXTS_OF_AXES},
        ShowLegend=0,
    )
    put(
        pv.Show(bins, view),
        AttributeType="Row Data",
        UseIndexForXAxis=0,
        XArrayName="bin_extents",
        SeriesVisibility=["bin_values"],
        SeriesColor=["bin_values", *CRIMSON],
    )
    return view


def n_pixels(source):
    return source.GetDataInformation().GetNumberOfPoints()


def fill_ends(key, ends):
    return [Fill(f"{key}({f})", end) for f, end in enumerate(ends)]


def spread(source, array):
    """The array's range without the one value in 200 that is greatest: the system's interruptions."""
    values = positive(source, array)
    return float(values.min()), float(np.percentile(values, 99.5))


def positive(source, array):
    values = array_of(source, array)
    return values[values > 0]


def array_of(source, name):
    """The values of a source's points, or of its cells."""
    data = pv.servermanager.Fetch(source)
    return vtk_to_numpy(data.GetPointData().GetArray(name) or data.GetCellData().GetArray(name))


def wide(low, high):
    return low, max(high, low + 1)


def around_zero(source, array):
    """As far down as up, without the one value in 100 that is farthest."""
    values = array_of(source, array)
    reach = float(np.percentile(np.abs(values), 99))
    return -reach, reach


def around_one(source, array):
    """The same of ratios, with few digits, as their labels."""
    values = array_of(source, array)
    with np.errstate(divide="ignore"):
        reach = float(np.percentile(np.abs(np.log(values)), 98))
    return float(f"{math.exp(-reach):.3g}"), float(f"{math.exp(reach):.3g}")


def color_map(source, array, preset, scale, key, ends=None):
    """The map over the array's range; `scale` is "log" or "linear"."""
    low, high = ends(source, array) if ends else wide(*spread(source, array))
    lut = pv.GetColorTransferFunction(array)
    lut.ApplyPreset(PRESETS[preset])
    colors = [lut.RGBPoints[i + 1 : i + 4] for i in range(0, len(lut.RGBPoints), 4)]
    points = []
    for step in range(N_COLORS):
        f = step / (N_COLORS - 1)
        at = low * (high / low) ** f if scale == "log" else low + (high - low) * f
        color = colors[round(f * (len(colors) - 1))]
        points += [at, *(round(c, 4) for c in color)]
    return put(
        lut,
        RGBPoints=Fill(f"{key}.colors({preset})", points),
        ColorSpace="RGB",  # the preset's own space paints false hues between so few points
        UseLogScale=int(scale == "log"),
        NanColor=(0.5, 0.5, 0.5),
        ScalarRangeInitialized=1,
        AutomaticRescaleRangeMode="Never",
        # The labels of the color bar: texts, since the formats of numbers differ between versions.
        Annotations=Fill(f"{key}.labels", [text for end in (low, high) for text in (str(end), f"{end:.2g}")]),
    )


def color_bar(lut, view, title=""):
    """The color bar, whose title is that of the view if it has none."""
    return put(
        bar(pv.GetScalarBar(lut, view), title),
        DrawTickLabels=0,
        DrawTickMarks=0,
        AddRangeLabels=0,
    )


def bar(color_bar, title):
    return put(
        color_bar,
        Title=title,
        ComponentTitle="",
        Orientation="Horizontal",
        WindowLocation="Lower Center",
        ScalarBarLength=0.7,
        TitleColor=BLACK,
        TitleFontSize=18,
        LabelColor=BLACK,
        LabelFontSize=16,
        Enabled=1,
        Visibility=1,
        DrawBackground=1,
        BackgroundColor=OPAQUE,
    )


def caption(text, view):
    source = put(pv.Text(), Text=text)
    pv.RenameSource(f"Title {text.key}" if isinstance(text, Fill) else text, source)
    put(
        pv.Show(source, view), WindowLocation="Upper Center", FontSize=18, Color=BLACK, BackgroundColor=OPAQUE
    )


def scene_camera(n_panels):
    """The camera of the three spheres, which is left-handed and so shows its world mirrored, in one
    of so many panels."""
    key = f"camera{n_panels}"
    target = (0, 0.05, 2)
    mirror = (-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
    return dict(
        CameraPosition=vector(f"{key}.position", (0, 0.35, -1)),
        CameraFocalPoint=vector(f"{key}.focal_point", target),
        CenterOfRotation=vector(f"{key}.focal_point", target),
        CameraViewUp=vector(f"{key}.view_up", (0, 1, 0)),
        CameraViewAngle=Fill(f"{key}.view_angle", 105),
        CameraParallelProjection=Fill(f"{key}.parallel_projection", 0),
        CameraParallelScale=Fill(f"{key}.parallel_scale", 3.9),
        ModelTransformMatrix=vector(f"{key}.mirror", mirror),
    )


def side_camera():
    """Beside the camera of the three spheres, and mirrored as it is."""
    return dict(
        CameraPosition=vector("rays.position", (4, 3, -6)),
        CameraFocalPoint=vector("rays.focal_point", (0, 0, 2)),
        CenterOfRotation=vector("rays.focal_point", (0, 0, 2)),
        CameraViewUp=vector("rays.view_up", (0, 1, 0)),
        CameraViewAngle=30,
        ModelTransformMatrix=scene_camera(2)["ModelTransformMatrix"],
    )


def picture_camera(frame, n_panels):
    """Straight at the picture, which fits between caption and color bar; README.md has the formulas."""
    key = f"image{n_panels}"
    x0, x1, y0, y1, _, _ = frame.GetDataInformation().GetExtent()
    width, height = x1 - x0 + 1, y1 - y0 + 1
    scale = max(height / (2 * 0.79), width / (2 * 0.96 * 1.1))
    x, y = Fill(f"{key}.center.0", (width - 1) / 2), Fill(f"{key}.center.1", (height - 1) / 2 - 0.18 * scale)
    return dict(
        InteractionMode="2D",
        CameraPosition=[x, y, 10000],
        CameraFocalPoint=[x, y, 0],
        CenterOfRotation=[x, y, 0],
        CameraParallelProjection=1,
        CameraParallelScale=Fill(f"{key}.parallel_scale", scale),
    )


def beside(left, right):
    return "SplitHorizontal", 0.5, left, right


def above(fraction, upper, lower):
    return "SplitVertical", fraction, upper, lower


def layout(name, tree):
    """Lays out a view, or a tree of them made with `beside` and `above`. The renderer chooses which."""

    def place(cell, tree):
        if not isinstance(tree, tuple):
            tab.AssignView(cell, tree)
            return
        split, fraction, first, second = tree
        cell = getattr(tab, split)(cell, fraction)
        place(cell, first)
        place(cell + 1, second)

    tab = pv.CreateLayout(name)
    place(0, tree)


def main():
    out = Path(sys.argv[1]).resolve()
    names = sys.argv[2:]
    for state in (state for state in STATES if not names or state.__name__ in names):
        state(out)
        save(Path(__file__).resolve().parent / f"{state.__name__}.pvsm", out)


if __name__ == "__main__":
    main()
