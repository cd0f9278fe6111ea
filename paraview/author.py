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

N_COLOURS = 17  # control points of a colour map: enough for the eye, a fifteenth of the preset
BLUE_RED = "BuRd"  # light in the middle, where nothing changes
INFERNO, VIRIDIS, TURBO = "Inferno (matplotlib)", "Viridis (matplotlib)", "Turbo"
CRIMSON = ("0.73", "0.21", "0.33")  # the middle of Inferno
BLACK, WHITE = (0, 0, 0), (1, 1, 1)
BACKDROP = dict(
    UseColorPaletteForBackground=0, Background=WHITE, OrientationAxesVisibility=0, CenterAxesVisibility=0
)


# ---------------------------------------------------------------------------------------- states


def geometry(out):
    """The hit cloud in its own colours and, in a linked view, coloured by what each hit cost."""
    hits = without_horizon(reader(pv.XMLUnstructuredGridReader, out / "hits.vtu"))
    colour, cost = (put(pv.CreateView("RenderView"), **BACKDROP, **scene_camera()) for _ in range(2))
    put(cloud(hits, colour), ColorArrayName=["POINTS", "RGB"], MapScalars=0)
    caption("True colours", colour)
    inferno = colour_map(hits, "time_ns", INFERNO, "log", "cost")
    put(cloud(hits, cost), ColorArrayName=["POINTS", Fill("cost.array", "time_ns")], LookupTable=inferno)
    colour_bar(inferno, cost, Fill("cost.title", "Time per pixel (ns)"))
    caption("False colours", cost)
    pv.AddCameraLink(colour, cost, "geometry")
    layout("Geometry", beside(colour, cost))


def heatmap(out):
    """Time and node visits of every pixel as pictures, above the histogram of the time.

    Where no time was measured, `cost` is the node visits, and `counter` what comes next.
    """
    frame = reader(pv.XMLImageDataReader, out / "frame.vti")
    time = picture(frame, "time_ns", INFERNO, "log", "Time per pixel (ns)", key="cost")
    visits = picture(frame, "node_visits", VIRIDIS, "linear", "BVH nodes visited per pixel", key="counter")
    pv.AddCameraLink(time, visits, "heatmap")
    times = histogram(frame, "time_ns", "Time per pixel (ns)", key="cost")
    layout("Heatmap", above(0.68, beside(time, visits), times))


def overview(out):
    """What was rendered and what it cost on one page: the picture above the cloud, the time above its histogram."""
    frame = reader(pv.XMLImageDataReader, out / "frame.vti")
    hits = without_horizon(reader(pv.XMLUnstructuredGridReader, out / "hits.vtu"))
    colour = put(pv.CreateView("RenderView"), **BACKDROP, **picture_camera(frame))
    put(pv.Show(frame, colour), Representation="Slice", ColorArrayName=["POINTS", "RGB"], MapScalars=0)
    time = picture(frame, "time_ns", INFERNO, "log", "Time per pixel (ns)", key="cost")
    pv.AddCameraLink(colour, time, "overview")
    turned = put(pv.CreateView("RenderView"), **BACKDROP, **scene_camera())
    inferno = pv.GetColorTransferFunction("time_ns")
    put(cloud(hits, turned), ColorArrayName=["POINTS", Fill("cost.array", "time_ns")], LookupTable=inferno)
    times = histogram(frame, "time_ns", "Time per pixel (ns)", key="cost")
    layout("Overview", above(0.55, beside(colour, time), beside(turned, times)))


def schedule(out):
    """The picture, and its tiles by the time that they took, by thread and by when they were begun."""
    frame = reader(pv.XMLImageDataReader, out / "frame.vti")
    tiles = reader(pv.XMLImageDataReader, out / "tiles.vti")
    colour = put(pv.CreateView("RenderView"), **BACKDROP, **picture_camera(frame))
    put(pv.Show(frame, colour), Representation="Slice", ColorArrayName=["POINTS", "RGB"], MapScalars=0)
    maps = [
        tile_map(tiles, frame, "duration_ns", INFERNO, "log", "Time per tile (ns)", "tiles.duration"),
        tile_map(tiles, frame, "thread", TURBO, "linear", "Thread", "tiles.thread"),
        tile_map(tiles, frame, "start_ns", VIRIDIS, "linear", "Begun after (ns)", "tiles.start"),
    ]
    first, last = (Fill(f"tiles.thread.linear({f})", f) for f in (0, 1))
    put(pv.GetScalarBar(pv.GetColorTransferFunction("thread"), maps[1]), UseCustomLabels=1, CustomLabels=[first, last])
    for i, view in enumerate(maps):
        pv.AddCameraLink(colour, view, f"schedule {i}")
    duration, thread, start = maps
    layout("Schedule", above(0.5, beside(colour, duration), beside(thread, start)))


def surface(out):
    """The scene's geometry by what each primitive cost and, in a linked view, by the tests that met nothing."""
    shapes = reader(pv.XMLUnstructuredGridReader, out / "surface.vtu")
    spheres = pv.CellCenters(Input=shapes)
    pv.RenameSource("Centres", spheres)
    time, waste = (put(pv.CreateView("RenderView"), **BACKDROP, **scene_camera()) for _ in range(2))
    by_time = colour_map(shapes, "time_ns", INFERNO, "log", "surface")
    by_waste = colour_map(shapes, "wasted_tests", VIRIDIS, "log", "surface.wasted")
    for view, array, lut in (
        (time, Fill("surface.array", "time_ns"), by_time),
        (waste, "wasted_tests", by_waste),
    ):
        put(
            pv.Show(shapes, view),
            Representation="Surface",
            ColorArrayName=["CELLS", array],
            LookupTable=lut,
            Ambient=0.4,  # lit enough to show the form, too little to change the colours
            Diffuse=0.6,
        )
        balls(spheres, view, array, lut)
    put(colour_bar(by_time, time, Fill("surface.title", "Time per primitive (ns)")), **few_labels(by_time, "surface"))
    put(colour_bar(by_waste, waste, "Tests per primitive that met nothing"), **few_labels(by_waste, "surface.wasted"))
    pv.AddCameraLink(time, waste, "surface")
    layout("Surface", beside(time, waste))


def bvh(out):
    """The leaves of the hierarchy that cost most, over the hits and, in a linked view, those of most wasted visits."""
    hits = without_horizon(reader(pv.XMLUnstructuredGridReader, out / "hits.vtu"))
    nodes = reader(pv.XMLUnstructuredGridReader, out / "bvh.vtu")
    leaves = at_least(nodes, "CELLS", "is_leaf", Fill("bvh.is_leaf", 1), "Leaves")
    dearest = at_least(
        leaves, "CELLS", Fill("bvh.array", "time_ns"), Fill("bvh.least", 0), "Dearest"
    )
    wasteful = at_least(
        leaves, "CELLS", "wasted_visits", Fill("bvh.wasted.least", 0), "Most wasted"
    )
    time, waste = (put(pv.CreateView("RenderView"), **BACKDROP, **scene_camera()) for _ in range(2))
    by_time = colour_map(dearest, "time_ns", INFERNO, "log", "bvh")
    by_waste = colour_map(wasteful, "wasted_visits", VIRIDIS, "log", "bvh.wasted")
    for view in (time, waste):
        put(cloud(hits, view), ColorArrayName=["POINTS", "RGB"], MapScalars=0)
    boxes(dearest, time, Fill("bvh.array", "time_ns"), by_time)
    boxes(wasteful, waste, "wasted_visits", by_waste)
    put(colour_bar(by_time, time, Fill("bvh.title", "Time per box (ns)")), **few_labels(by_time, "bvh"))
    put(colour_bar(by_waste, waste, "Visits per box that met nothing"), **few_labels(by_waste, "bvh.wasted"))
    pv.AddCameraLink(time, waste, "bvh")
    layout("BVH", beside(time, waste))


def rays(out):
    """The rays of traced pixels in the scene's cloud, seen from their side: by kind and, in a linked view, by cost."""
    lines = threshold(
        reader(pv.XMLPolyDataReader, out / "rays.vtp"), "CELLS", "length", Fill("rays.max_length", 1e30), "Rays"
    )
    hits = without_horizon(reader(pv.XMLUnstructuredGridReader, out / "rays_cloud.vtu"))
    kind, cost = (put(pv.CreateView("RenderView"), **BACKDROP, **side_camera()) for _ in range(2))
    for view in (kind, cost):
        put(cloud(hits, view), ColorArrayName=["POINTS", "RGB"], MapScalars=0, Opacity=0.3)
    kinds = ray_kinds()
    put(drawn(lines, kind), ColorArrayName=["CELLS", "kind"], LookupTable=kinds)
    colour_bar(kinds, kind, "Kind of each ray")
    inferno = colour_map(lines, "time_ns", INFERNO, "linear", "rays.cost")
    put(drawn(lines, cost), ColorArrayName=["CELLS", Fill("rays.cost.array", "time_ns")], LookupTable=inferno)
    colour_bar(inferno, cost, Fill("rays.cost.title", "Time of each ray (ns)"))
    pv.AddCameraLink(kind, cost, "rays")
    layout("Rays", beside(kind, cost))


def diff(out):
    """What each pixel's cost changed by between two outputs, as a difference and as a ratio, above
    the histogram of the difference."""
    change = reader(pv.XMLImageDataReader, out / "diff.vti")
    difference = picture(
        change, "time_ns_difference", BLUE_RED, "linear", "B - A: time per pixel (ns)", "difference", around_zero
    )
    ratio = picture(change, "time_ns_ratio", BLUE_RED, "log", "B / A: time per pixel", "ratio", around_one)
    lut = pv.GetColorTransferFunction("time_ns_ratio")
    put(pv.GetScalarBar(lut, ratio), **few_labels(lut, "ratio", "%.3g", (0, 0.25, 0.5, 0.75, 1)))
    pv.AddCameraLink(difference, ratio, "diff")
    array, title = Fill("difference.array", "time_ns_difference"), "B - A: time per pixel (ns)"
    ends = fill_ends("difference.linear", around_zero(change, "time_ns_difference"))
    differences = bars(change, array, ends, Fill("difference.title", title))
    layout("Difference", above(0.68, beside(difference, ratio), differences))


STATES = (geometry, heatmap, overview, schedule, surface, bvh, rays, diff)


# ----------------------------------------------------------------------------------------- parts


def without_horizon(hits):
    """The hits up to a distance: ParaView hides all that is 1000 times nearer than the farthest."""
    return threshold(hits, "POINTS", "distance", Fill("hits.max_distance", 1e30), "Without the horizon")


def threshold(source, where, array, highest, name):
    """The points or cells whose value is not above the highest."""
    return kept(source, where, array, name, ThresholdMethod="Below Lower Threshold", LowerThreshold=highest)


def at_least(source, where, array, least, name):
    """The points or cells whose value is not below the least."""
    return kept(source, where, array, name, ThresholdMethod="Above Upper Threshold", UpperThreshold=least)


def kept(source, where, array, name, **ends):
    cells = put(pv.Threshold(Input=source), SelectInputScalars=[where, array], **ends)
    pv.RenameSource(name, cells)
    cells.UpdatePipeline()
    return cells


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


def boxes(source, view, array, lut):
    """Boxes with their edges, and what is inside shining through."""
    return put(
        pv.Show(source, view),
        Representation="Surface With Edges",
        ColorArrayName=["CELLS", array],
        LookupTable=lut,
        Opacity=0.4,
    )


def balls(source, view, array, lut):
    """One shaded disc a sphere, with the sphere's radius."""
    return put(
        pv.Show(source, view),
        Representation="Point Gaussian",
        ShaderPreset="Sphere",
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
    return put(pv.Show(lines, view), Representation="Wireframe", LineWidth=width, Ambient=1, Diffuse=0)


def ray_kinds():
    """The kinds of rays by name, in colours that all eyes can tell apart (Okabe and Ito, 2008)."""
    kinds = {
        "camera": (0, 0.45, 0.70),
        "shadow": (0.90, 0.62, 0),
        "reflection": (0.84, 0.37, 0),
        "refraction": (0, 0.62, 0.45),
    }
    return put(
        pv.GetColorTransferFunction("kind"),
        IndexedLookup=1,  # InterpretValuesAsCategories in scripts
        Annotations=[text for number, name in enumerate(kinds) for text in (str(number), name)],
        IndexedColors=[channel for colour in kinds.values() for channel in colour],
    )


def picture(frame, array, preset, scale, title, key, ends=None):
    """A view of one array as a flat picture: a slice shows each pixel as it is, unlit and unblended."""
    view = put(pv.CreateView("RenderView"), **BACKDROP, **picture_camera(frame))
    colours = colour_map(frame, array, preset, scale, key, ends)
    shown = ["POINTS", Fill(f"{key}.array", array)]
    put(pv.Show(frame, view), Representation="Slice", ColorArrayName=shown, LookupTable=colours)
    colour_bar(colours, view, Fill(f"{key}.title", title))
    return view


def tile_map(tiles, frame, array, preset, scale, title, key):
    """A view of one array of the tiles, flat and unlit, where the picture's pixels would be."""
    view = put(pv.CreateView("RenderView"), **BACKDROP, **picture_camera(frame))
    colours = colour_map(tiles, array, preset, scale, key)
    put(
        pv.Show(tiles, view),
        Representation="Surface",
        ColorArrayName=["CELLS", array],
        LookupTable=colours,
        Ambient=1,
        Diffuse=0,
    )
    colour_bar(colours, view, title)
    return view


def histogram(frame, array, title, key):
    """A view of how many pixels took which value: bars over log10, labelled with the values."""
    log10 = pv.Calculator(Input=frame)
    put(log10, Function=Fill(f"{key}.log10", f"log10({array})"), ResultArrayName="log10", ResultArrayType="Float")
    pv.RenameSource("log10", log10)
    ends = fill_ends(f"{key}.log10", [math.log10(end) for end in spread(frame, array)])
    view = bars(log10, "log10", ends, Fill(f"{key}.log10.title", f"{title}, log scale"))
    return put(
        view,
        BottomAxisUseCustomLabels=1,
        BottomAxisLabels=[
            text for k in range(10) for n in (1, 2, 5) for text in (str(k + math.log10(n)), str(n * 10**k))
        ],
    )


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
        BottomAxisTitle=title,
        BottomAxisTitleFontSize=18,
        BottomAxisLabelFontSize=14,
        LeftAxisTitle="Pixels",
        LeftAxisTitleFontSize=18,
        LeftAxisLabelFontSize=14,
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


def colour_map(source, array, preset, scale, key, ends=None):
    """The preset over the array's range, thinned; `scale` is "log" or "linear"."""
    low, high = ends(source, array) if ends else wide(*spread(source, array))
    lut = pv.GetColorTransferFunction(array)
    lut.ApplyPreset(preset)
    colours = [lut.RGBPoints[i + 1 : i + 4] for i in range(0, len(lut.RGBPoints), 4)]
    points = []
    for step in range(N_COLOURS):
        f = step / (N_COLOURS - 1)
        at = low * (high / low) ** f if scale == "log" else low + (high - low) * f
        colour = colours[round(f * (len(colours) - 1))]
        points += [Fill(f"{key}.{scale}({f:g})", at), *(round(c, 4) for c in colour)]
    return put(
        lut,
        RGBPoints=points,
        ColorSpace="RGB",  # the preset's own space paints false hues between so few points
        UseLogScale=int(scale == "log"),
        NanColor=(0.5, 0.5, 0.5),
        ScalarRangeInitialized=1,
        AutomaticRescaleRangeMode="Never",
    )


def colour_bar(lut, view, title):
    return put(
        pv.GetScalarBar(lut, view),
        Title=title,
        ComponentTitle="",
        Orientation="Horizontal",
        WindowLocation="Lower Center",
        ScalarBarLength=0.7,
        AddRangeLabels=0,
        TitleColor=BLACK,
        TitleFontSize=18,
        LabelColor=BLACK,
        LabelFontSize=16,
        Enabled=1,
        Visibility=1,
    )


def few_labels(lut, key, form="%.2g", places=(0.05, 0.35, 0.65, 0.95)):
    """Some labels for a logarithmic colour bar: ParaView's own overlap where the numbers are long."""
    low, high = lut.RGBPoints[0], lut.RGBPoints[-4]
    labels = [Fill(f"{key}.label({f:g})", float(form % (low * (high / low) ** f))) for f in places]
    return dict(UseCustomLabels=1, CustomLabels=labels, AutomaticLabelFormat=0, LabelFormat=form)


def caption(text, view):
    source = put(pv.Text(), Text=text)
    pv.RenameSource(text, source)
    put(pv.Show(source, view), WindowLocation="Upper Center", FontSize=20, Color=BLACK)


def scene_camera():
    """The camera of the three spheres, which is left-handed and so shows its world mirrored."""
    target = (0, 0.05, 2)
    mirror = (-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
    return dict(
        CameraPosition=vector("camera.position", (0, 0.35, -1)),
        CameraFocalPoint=vector("camera.focal_point", target),
        CenterOfRotation=vector("camera.focal_point", target),
        CameraViewUp=vector("camera.view_up", (0, 1, 0)),
        CameraViewAngle=Fill("camera.view_angle", 105),
        CameraParallelProjection=Fill("camera.parallel_projection", 0),
        CameraParallelScale=Fill("camera.parallel_scale", 3.9),
        ModelTransformMatrix=vector("camera.mirror", mirror),
    )


def side_camera():
    """Beside the camera of the three spheres, and mirrored as it is."""
    return dict(
        CameraPosition=vector("rays.position", (4, 3, -6)),
        CameraFocalPoint=vector("rays.focal_point", (0, 0, 2)),
        CenterOfRotation=vector("rays.focal_point", (0, 0, 2)),
        CameraViewUp=vector("rays.view_up", (0, 1, 0)),
        CameraViewAngle=30,
        ModelTransformMatrix=scene_camera()["ModelTransformMatrix"],
    )


def picture_camera(frame):
    """Straight at the picture, which fits the view above the colour bar; README.md has the formulas."""
    x0, x1, y0, y1, _, _ = frame.GetDataInformation().GetExtent()
    width, height = x1 - x0 + 1, y1 - y0 + 1
    scale = max(height / (2 * 0.79), width / (2 * 0.96 * 1.1))
    x, y = Fill("image.center.0", (width - 1) / 2), Fill("image.center.1", (height - 1) / 2 - 0.18 * scale)
    return dict(
        InteractionMode="2D",
        CameraPosition=[x, y, 10000],
        CameraFocalPoint=[x, y, 0],
        CenterOfRotation=[x, y, 0],
        CameraParallelProjection=1,
        CameraParallelScale=Fill("image.parallel_scale", scale),
    )


def beside(left, right):
    return "SplitHorizontal", 0.5, left, right


def above(fraction, upper, lower):
    return "SplitVertical", fraction, upper, lower


def layout(name, tree):
    """Lays out a view, or a tree of them made with `beside` and `above`."""

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
