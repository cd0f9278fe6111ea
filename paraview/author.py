"""Authors the ParaView states beside this script: geometry.pvsm, heatmap.pvsm.

Takes an output folder of `raycost render` as the sample to build the pipelines against:

    xvfb-run -a pvbatch paraview/author.py out/NAME

Gives one state for each function in `STATES`. A state serves twice: ParaView loads it as it is,
with paths under `$RAYCOST_OUT`, and the renderer fills it in for each of its outputs.

Why a script and no "Save State": that writes half a megabyte, of which its maker chose some fifty
lines. Here `put` sets a property and remembers it; `save` keeps what was put and drops the rest.
A value that depends on the output is put as a `Fill` and carries its key into the file, as
`fill="KEY"`, an attribute that ParaView passes over. README.md lists the keys.
"""

import math
import sys
import tempfile
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

from paraview import simple as pv

N_COLOURS = 17  # control points of a colour map: enough for the eye, a fifteenth of the preset
INFERNO, VIRIDIS = "Inferno (matplotlib)", "Viridis (matplotlib)"
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
    inferno = colour_map(hits, "time_ns", INFERNO, "log", key="cost")
    put(cloud(hits, cost), ColorArrayName=["POINTS", Fill("cost.array", "time_ns")], LookupTable=inferno)
    colour_bar(inferno, cost, Fill("cost.title", "Time per pixel (ns)"))
    caption("False colours", cost)
    pv.AddCameraLink(colour, cost, "geometry")
    layout("Geometry", beside(colour, cost))


def heatmap(out):
    """Time and node visits of every pixel as pictures, above the histogram of the time."""
    frame = reader(pv.XMLImageDataReader, out / "frame.vti")
    time = picture(frame, "time_ns", INFERNO, "log", "Time per pixel (ns)")
    visits = picture(frame, "node_visits", VIRIDIS, "linear", "BVH nodes visited per pixel")
    pv.AddCameraLink(time, visits, "heatmap")
    layout("Heatmap", above(0.68, beside(time, visits), histogram(frame, "time_ns", "Time per pixel (ns)")))


STATES = (geometry, heatmap)


# ----------------------------------------------------------------------------------------- parts


def without_horizon(hits):
    """The hits up to a distance: ParaView hides all that is 1000 times nearer than the farthest."""
    near = put(
        pv.Threshold(Input=hits),
        SelectInputScalars=["POINTS", "distance"],
        ThresholdMethod="Below Lower Threshold",
        LowerThreshold=Fill("hits.max_distance", hits.PointData["distance"].GetRange()[1]),
    )
    pv.RenameSource("Without the horizon", near)
    near.UpdatePipeline()
    return near


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


def picture(frame, array, preset, scale, title):
    """A view of one array as a flat picture, unlit so that it agrees with its colour bar."""
    view = put(pv.CreateView("RenderView"), **BACKDROP, **picture_camera(frame))
    colours = colour_map(frame, array, preset, scale)
    put(
        pv.Show(frame, view),
        Representation="Surface",
        ColorArrayName=["POINTS", array],
        LookupTable=colours,
        Ambient=1,
        Diffuse=0,
    )
    colour_bar(colours, view, title)
    return view


def histogram(frame, array, title):
    """A view of how many pixels took which value: bars over log10, labelled with the values."""
    log10 = pv.Calculator(Input=frame)
    put(log10, Function=f"log10({array})", ResultArrayName="log10", ResultArrayType="Float")
    bins = put(pv.Histogram(Input=log10), SelectInputArray=["POINTS", "log10"], BinCount=100)
    pv.RenameSource(f"log10({array})", log10)
    pv.RenameSource("Histogram", bins)
    view = put(
        pv.CreateView("XYBarChartView"),
        BottomAxisTitle=f"{title}, log scale",
        BottomAxisTitleFontSize=18,
        BottomAxisLabelFontSize=14,
        BottomAxisUseCustomLabels=1,
        BottomAxisLabels=[
            text for k in range(10) for n in (1, 2, 5) for text in (str(k + math.log10(n)), str(n * 10**k))
        ],
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


def colour_map(source, array, preset, scale, key=None):
    """The preset over the array's range, thinned; `scale` is "log" or "linear"."""
    low, high = source.PointData[array].GetRange()
    lut = pv.GetColorTransferFunction(array)
    lut.ApplyPreset(preset)
    colours = [lut.RGBPoints[i + 1 : i + 4] for i in range(0, len(lut.RGBPoints), 4)]
    points = []
    for step in range(N_COLOURS):
        f = step / (N_COLOURS - 1)
        at = low * (high / low) ** f if scale == "log" else low + (high - low) * f
        colour = colours[round(f * (len(colours) - 1))]
        points += [Fill(f"{key or array}.{scale}({f:g})", at), *(round(c, 4) for c in colour)]
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
    put(
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


# --------------------------------------------------------------------------------------- writing


@dataclass(frozen=True)
class Fill:
    """A value that the renderer replaces: its key, and what it is for the sample."""

    key: str
    value: object


UNUSED = ("RepresentationAnimationHelper", "TimeKeeper")
PUT = {}  # proxy's id -> property -> its values, some of them a Fill


def put(proxy, **properties):
    """Sets the properties, and has `save` keep them. Gives the proxy back."""
    for name, value in properties.items():
        many = isinstance(value, (list, tuple))
        values = list(value) if many else [value]
        plain = [v.value if isinstance(v, Fill) else v for v in values]
        proxy.SetPropertyWithName(name, plain if many else plain[0])
        PUT.setdefault(proxy.GetGlobalIDAsString(), {})[name] = values
    return proxy


def vector(key, values):
    return [Fill(f"{key}.{i}", value) for i, value in enumerate(values)]


def reader(kind, path):
    """Reads a file of the output folder; its name is both the key and the name in the browser."""
    source = put(kind(FileName=[str(path)]), FileName=[Fill(path.name, str(path))])
    pv.RenameSource(path.name, source)
    source.UpdatePipeline()
    return source


def save(path, out):
    """Writes what the session has put as a state, with its paths under $RAYCOST_OUT."""
    with tempfile.NamedTemporaryFile(suffix=".pvsm") as whole:
        pv.SaveState(whole.name)
        tree = ET.parse(whole.name)
    trim(tree.find("ServerManagerState"))
    ET.indent(tree, " ")
    text = ET.tostring(tree.getroot(), encoding="us-ascii").decode().replace(" />", "/>")
    path.write_text(text.replace(str(out), "$RAYCOST_OUT") + "\n")
    print(f"{path} ({path.stat().st_size / 1024:.1f} KB)")


def trim(state):
    """Keeps what was put, and the bare helper proxies, without which ParaView's window crashes."""
    proxies = {proxy.get("id"): proxy for proxy in state.findall("Proxy")}
    for id_, proxy in list(proxies.items()):
        if proxy.get("group") in ("animation", "settings") or proxy.get("type") in UNUSED:
            state.remove(proxies.pop(id_))
        else:
            trim_proxy(proxy)
    for collection in state.findall("ProxyCollection"):
        for item in collection.findall("Item"):
            item.attrib.pop("logname", None)
            if item.get("id") not in proxies:
                collection.remove(item)
        if not len(collection):
            state.remove(collection)
    for part in state.findall("CustomProxyDefinitions") + state.findall("Settings"):
        state.remove(part)
    links = state.find("Links")
    for link in links.findall("*"):  # a session keeps the links of the state before
        if link.tag != "CameraLink" or link.find("Proxy").get("id") not in proxies:
            links.remove(link)
        else:  # the first child since 5.12; without it a later ParaView warns, and 5.11 warns of it
            link.insert(0, ET.Element("Properties", exceptionBehavior="0"))


def trim_proxy(proxy):
    values = PUT.get(proxy.get("id"), {})
    for prop in proxy.findall("Property"):
        for domain in prop.findall("Domain"):
            if domain.find("Proxy") is None:
                prop.remove(domain)
        if prop.get("name") not in values and prop.find("Proxy") is None:
            proxy.remove(prop)
    for name, put_values in values.items():
        prop = proxy.find(f"Property[@name='{name}']")
        if prop is None:  # ParaView reads this one property from a state, but writes none
            assert name == "ModelTransformMatrix", f"{name} has another name in a state"
            prop = ET.SubElement(proxy, "Property", name=name, number_of_elements=str(len(put_values)))
            for i, value in enumerate(put_values):
                ET.SubElement(prop, "Element", index=str(i), value=str(value.value))
        for element, value in zip(reversed(prop.findall("Element")), reversed(put_values)):
            if isinstance(value, Fill):
                element.set("fill", value.key)


def main():
    out = Path(sys.argv[1]).resolve()
    for state in STATES:
        state(out)
        save(Path(__file__).resolve().parent / f"{state.__name__}.pvsm", out)
        pv.ResetSession()
        PUT.clear()


main()
