"""The template behind `author.py`: remembers what is put into ParaView, and saves only that.

Takes the properties that `put` sets, some of their values a `Fill`; `save` gives a state file. Why
not ParaView's "Save State" as it is: that is half a megabyte, of which its maker chose some fifty
lines. A `Fill` carries its key into the file as `fill="KEY"`, an attribute that ParaView passes
over and by which the renderer finds the values to replace.
"""

import tempfile
import xml.etree.ElementTree as ET
from dataclasses import dataclass

from paraview import simple as pv


@dataclass(frozen=True)
class Fill:
    """A value that the renderer replaces: its key, and what it is for the sample."""

    key: str
    value: object


PUT = {}  # proxy's id -> property -> its values, some of them a Fill, or one Fill for all
UNUSED = ("RepresentationAnimationHelper", "TimeKeeper")
UNSAVED = ("ModelTransformMatrix",)  # what ParaView reads from a state, but does not write into one


def put(proxy, **properties):
    """Sets the properties, and has `save` keep them. Gives the proxy back."""
    for name, value in properties.items():
        whole = value.value if isinstance(value, Fill) else value
        many = isinstance(whole, (list, tuple))
        values = list(whole) if many else [value]
        plain = [v.value if isinstance(v, Fill) else v for v in values]
        proxy.SetPropertyWithName(name, plain if many else plain[0])
        as_one = many and isinstance(value, Fill)
        PUT.setdefault(proxy.GetGlobalIDAsString(), {})[name] = value if as_one else values
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
    """Writes what was put as a state, its paths under $RAYCOST_OUT, and begins an empty session."""
    with tempfile.NamedTemporaryFile(suffix=".pvsm") as whole:
        pv.SaveState(whole.name)
        tree = ET.parse(whole.name)
    trim(tree.find("ServerManagerState"))
    ET.indent(tree, " ")
    text = ET.tostring(tree.getroot(), encoding="us-ascii").decode().replace(" />", "/>")
    path.write_text(text.replace(str(out), "$RAYCOST_OUT") + "\n")
    print(f"{path} ({path.stat().st_size / 1024:.1f} KB)")
    pv.ResetSession()
    PUT.clear()


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
    for link in links.findall("*"):  # a color palette's, or one of the state before
        links.remove(link)


def mark_splits(proxy):
    """Marks the splits of a layout, which the renderer turns to fit the picture's shape."""
    items = proxy.findall("Layout/Item")
    n_panels = sum(item.get("view") != "0" for item in items)
    names = iter(["outer", "inner", "inner"])
    for item in items:
        if item.get("direction") != "0":
            rest = {name: item.attrib.pop(name) for name in list(item.attrib) if name != "direction"}
            item.set("fill", f"panels{n_panels}.{next(names)}")
            item.attrib.update(rest)


def trim_proxy(proxy):
    """Keeps the properties that were put or hold other proxies, and marks the values to be filled."""
    mark_splits(proxy)
    put_here = PUT.get(proxy.get("id"), {})
    for prop in proxy.findall("Property"):
        for domain in prop.findall("Domain"):
            if domain.find("Proxy") is None:
                prop.remove(domain)
        if prop.get("name") not in put_here and prop.find("Proxy") is None:
            proxy.remove(prop)
    for name, values in put_here.items():
        if name in UNSAVED:
            prop = ET.SubElement(proxy, "Property", name=name, number_of_elements=str(len(values)))
            for i, fill in enumerate(values):
                ET.SubElement(prop, "Element", index=str(i), value=str(fill.value))
        prop = proxy.find(f"Property[@name='{name}']")
        assert prop is not None, f"a state knows no property {name}: put the name that it has there"
        if isinstance(values, Fill):
            prop.set("fill", values.key)
            continue
        for element, value in zip(reversed(prop.findall("Element")), reversed(values)):
            if isinstance(value, Fill):
                element.set("fill", value.key)
