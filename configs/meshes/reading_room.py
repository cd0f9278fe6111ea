#!/usr/bin/env python3
"""Makes reading_room.glb: a library's reading room of 13 x 8 x 5 meters, with its windows, doors, books and chairs.

Needs nothing but Python. Each part is stored once and placed by `EXT_mesh_gpu_instancing`; books and chairs
differ in place and size. Prints the triangles of the room.
"""

import json
import math
import random
import struct
from pathlib import Path

LEFT, RIGHT, FRONT, BACK, TOP = -4.0, 4.0, 3.0, -10.0, 5.0
# The windows' middles along the left wall, half of their width, and their lower and upper edges.
WINDOWS, HALF, SILL, HEAD = [0.8 - 2.4 * i for i in range(5)], 0.75, 0.9, 4.2
WALL = 0.45
SHELF_DEPTH, SHELF_TOP, SHELF_BOTTOM, N_BOARDS, PITCH = 0.34, 3.0, 0.28, 8, 1.2
TABLES = [(x, z) for z in (-0.9, -3.7, -6.5) for x in (-1.95, 1.45)]
DOOR, DOOR_TOP = 1.15, 3.1
GLOBE = (1.25, 0.95, 0.6)
# Half of the width of the laylight, a ceiling of frosted glass.
LAYLIGHT = 2.2
MATERIALS = {
    "plaster": {"color": [0.8, 0.76, 0.68]},
    "oak": {"color": [0.2, 0.095, 0.045], "rough": 0.4},
    "walnut": {"color": [0.11, 0.05, 0.025], "rough": 0.35},
    "paint": {"color": [0.82, 0.81, 0.77], "rough": 0.5},
    "brass": {"color": [0.86, 0.62, 0.26], "metal": 1, "rough": 0.22},
    "shade": {"color": [0.015, 0.16, 0.06], "rough": 0.15},
    "baize": {"color": [0.014, 0.05, 0.028]},
    "carpet": {"color": [0.3, 0.03, 0.03]},
    "pane": {"color": [1, 1, 1, 0.1], "metal": 1, "rough": 0},
    "glass": {"color": [1, 1, 1], "rough": 0, "clear": True},
    "paper": {"color": [0.78, 0.72, 0.58]},
    "red": {"color": [0.24, 0.03, 0.025], "rough": 0.5},
    "brown": {"color": [0.17, 0.075, 0.03], "rough": 0.5},
    "green": {"color": [0.03, 0.1, 0.05], "rough": 0.5},
    "blue": {"color": [0.03, 0.055, 0.16], "rough": 0.5},
    "tan": {"color": [0.42, 0.26, 0.12], "rough": 0.5},
    "black": {"color": [0.025, 0.022, 0.02], "rough": 0.5},
}
LEATHERS = ["red", "brown", "green", "blue", "tan", "black", "brown"]
IDENTITY = (0, 0, 0, 1)


class Mesh:
    """Triangles of one material or more."""

    def __init__(self):
        self.points, self.triangles = [], {}

    def add(self, points, faces, material):
        """Adds polygons over points of their own."""
        first = len(self.points)
        self.points += points
        for face in faces:
            corners = [first + corner for corner in face]
            fan = [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:])]
            self.triangles.setdefault(material, []).extend(fan)
        return self

    def box(self, low, high, material):
        points = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        return self.add(points, faces, material)

    def lathe(self, profile, n_sides, material, squeeze=1.0):
        """Turns (radius, height) from bottom to top around +y; `squeeze` is a factor of z."""
        points, faces, rings = [], [], []
        for radius, y in profile:
            n = n_sides if radius > 0 else 1
            rings.append(range(len(points), len(points) + n))
            angles = [2 * math.pi * i / n_sides for i in range(n)]
            points += [(radius * math.cos(a), y, squeeze * radius * math.sin(a)) for a in angles]
        for low, high in zip(rings, rings[1:]):
            for i in range(n_sides):
                at = lambda ring, j: ring[j % len(ring)]
                corners = [at(low, i), at(high, i), at(high, i + 1), at(low, i + 1)]
                faces.append(list(dict.fromkeys(corners)))
        return self.add(points, [face for face in faces if len(face) > 2], material)

    def sweep(self, path, radius, n_sides, material):
        """A round bar along a path in the plane of x and y."""
        points, faces = [], []
        for i, (x, y, z) in enumerate(path):
            before, after = path[max(i - 1, 0)], path[min(i + 1, len(path) - 1)]
            dx, dy = after[0] - before[0], after[1] - before[1]
            length = math.hypot(dx, dy)
            for j in range(n_sides):
                a = 2 * math.pi * j / n_sides
                out, side = radius * math.cos(a), radius * math.sin(a)
                points.append((x - out * dy / length, y + out * dx / length, z + side))
        for i in range(len(path) - 1):
            for j in range(n_sides):
                k = (j + 1) % n_sides
                faces.append([i * n_sides + j, (i + 1) * n_sides + j, (i + 1) * n_sides + k, i * n_sides + k])
        return self.add(
            points, [*faces, list(range(n_sides)), list(range(len(path) * n_sides))[: -n_sides - 1 : -1]], material
        )


class Scene:
    """The parts of a GLB file and where they stand."""

    def __init__(self):
        self.bytes, self.views, self.accessors = bytearray(), [], []
        self.meshes, self.nodes, self.n_triangles = [], [], 0

    def accessor(self, rows, layout, kind, component, bounds=False):
        packed = b"".join(struct.pack(layout, *row) for row in rows)
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(packed)})
        self.bytes += packed + bytes(-len(packed) % 4)
        found = {"bufferView": len(self.views) - 1, "componentType": component, "count": len(rows), "type": kind}
        if bounds:
            rounded = [struct.unpack(layout, struct.pack(layout, *row)) for row in rows]
            found |= {"min": [min(c) for c in zip(*rounded)], "max": [max(c) for c in zip(*rounded)]}
        self.accessors.append(found)
        return len(self.accessors) - 1

    def mesh(self, mesh):
        """Stores a mesh; returns what `put` takes."""
        position = self.accessor(mesh.points, "<3f", "VEC3", 5126, bounds=True)
        primitives = []
        for material, triangles in mesh.triangles.items():
            indices = self.accessor([(i,) for one in triangles for i in one], "<H", "SCALAR", 5123)
            material = list(MATERIALS).index(material)
            primitives.append({"attributes": {"POSITION": position}, "indices": indices, "material": material})
        return primitives, sum(map(len, mesh.triangles.values()))

    def put(self, name, stored, places=((0, 0, 0),), turns=None, scales=None, repaint=None, **node):
        """An object of instances of a mesh, at `places`, turned by quaternions, and scaled."""
        primitives, n_triangles = stored
        if repaint:
            old, new = [list(MATERIALS).index(one) for one in repaint]
            primitives = [{**one, "material": new if one["material"] == old else one["material"]} for one in primitives]
        self.meshes.append({"primitives": primitives})
        attributes = {"TRANSLATION": self.accessor(places, "<3f", "VEC3", 5126)}
        if turns:
            attributes["ROTATION"] = self.accessor(turns, "<4f", "VEC4", 5126)
        if scales:
            attributes["SCALE"] = self.accessor(scales, "<3f", "VEC3", 5126)
        instancing = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
        self.nodes.append({"name": name, "mesh": len(self.meshes) - 1, "extensions": instancing, **node})
        self.n_triangles += len(places) * n_triangles

    def write(self, path):
        document = {
            "asset": {"version": "2.0", "generator": path.with_suffix(".py").name},
            "extensionsUsed": ["EXT_mesh_gpu_instancing", "KHR_materials_transmission"],
            "extensionsRequired": ["EXT_mesh_gpu_instancing"],
            "scene": 0,
            "scenes": [{"nodes": list(range(len(self.nodes)))}],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": [material(name, **keys) for name, keys in MATERIALS.items()],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.bytes)}],
        }
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(self.bytes), 0x004E4942) + bytes(self.bytes)
        path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
        print(f"{path.name}: {path.stat().st_size:,} bytes, {self.n_triangles:,} triangles")


def material(name, color, metal=0, rough=1, clear=False):
    color = [*color, 1][:4]
    surface = {"baseColorFactor": color, "metallicFactor": metal, "roughnessFactor": rough}
    found = {"name": name, "pbrMetallicRoughness": surface, "doubleSided": not clear}
    if color[3] < 1:
        found["alphaMode"] = "BLEND"
    if clear:
        found["extensions"] = {"KHR_materials_transmission": {"transmissionFactor": 1}}
    return found


def turn(axis, degrees):
    """The quaternion of a rotation about x, y or z."""
    half = math.radians(degrees) / 2
    found = [0, 0, 0, math.cos(half)]
    found["xyz".index(axis)] = math.sin(half)
    return tuple(found)


def product(a, b):
    """The quaternion that turns by b first, then by a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def turned(quaternion, point):
    """A point, rotated."""
    x, y, z, w = quaternion
    conjugate = (-x, -y, -z, w)
    return product(product(quaternion, (*point, 0)), conjugate)[:3]


def walls():
    """Walls, ceiling and beams of plaster, without the floor."""
    mesh = Mesh()
    outside = LEFT - WALL
    edges = [FRONT, *(z + side for z in WINDOWS for side in (HALF, -HALF)), BACK]
    for far, near in zip(edges[1::2], edges[::2]):
        mesh.box((outside, 0, far), (LEFT, TOP, near), "plaster")
    mesh.box((outside, 0, BACK), (LEFT, SILL, FRONT), "plaster").box(
        (outside, HEAD, BACK), (LEFT, TOP, FRONT), "plaster"
    )
    mesh.box((RIGHT, 0, BACK), (RIGHT + WALL, TOP, FRONT), "plaster")
    mesh.box((outside, 0, FRONT), (RIGHT + WALL, TOP, FRONT + WALL), "plaster")
    mesh.box((outside, TOP, BACK - 4), (RIGHT + WALL, TOP + WALL, FRONT + WALL), "plaster")
    for low, high in [(outside, -DOOR), (DOOR, RIGHT + WALL)]:
        mesh.box((low, 0, BACK - WALL), (high, TOP, BACK), "plaster")
    mesh.box((-DOOR, DOOR_TOP, BACK - WALL), (DOOR, TOP, BACK), "plaster")
    # The corridor behind the doors, which has the sky on its left.
    mesh.box((outside, 0, BACK - 4), (RIGHT + WALL, TOP, BACK - 3.6), "plaster")
    mesh.box((RIGHT, 0, BACK - 4), (RIGHT + WALL, TOP, BACK - WALL), "plaster")
    for step, (y, out) in enumerate([(0.0, 0.24), (0.08, 0.17), (0.15, 0.1), (0.22, 0.05)]):
        high = TOP - y - (0.002 * step)
        low = high - 0.1
        mesh.box((LEFT, low, BACK), (LEFT + out, high, FRONT), "paint")
        mesh.box((RIGHT - out, low, BACK), (RIGHT, high, FRONT), "paint")
        mesh.box((LEFT, low, BACK), (RIGHT, high, BACK + out), "paint")
    return mesh


def beam():
    """An oak beam from wall to wall, with a ledge on both sides."""
    mesh = Mesh().box((LEFT, TOP - 0.34, -0.13), (RIGHT, TOP, 0.13), "oak")
    return mesh.box((LEFT, TOP - 0.1, -0.2), (RIGHT, TOP, 0.2), "oak")


def laylight():
    """The bars of the laylight between two beams."""
    mesh = Mesh()
    for i in range(7):
        x = LAYLIGHT * (i / 3 - 1)
        mesh.box((x - 0.025, TOP - 0.06, -1.2), (x + 0.025, TOP - 0.01, 1.2), "paint")
    for z in (-0.66, 0, 0.66):
        mesh.box((-LAYLIGHT, TOP - 0.05, z - 0.015), (LAYLIGHT, TOP - 0.01, z + 0.015), "paint")
    return mesh


def window():
    """A frame with bars, a sill and a pane of glass; the middle of its lower edge is the origin."""
    height = HEAD - SILL
    mesh = Mesh().box((-0.02, -0.05, -HALF - 0.08), (WALL / 2 + 0.1, 0, HALF + 0.08), "paint")
    for z in (-HALF, HALF - 0.07):
        mesh.box((-0.05, 0, z), (0.05, height, z + 0.07), "paint")
    for y in (0, height - 0.07, 0.68 * height):
        mesh.box((-0.05, y, -HALF), (0.05, y + 0.07, HALF), "paint")
    mesh.box((-0.045, 0, -0.035), (0.045, height, 0.035), "paint")
    for z in (-HALF / 2, HALF / 2):
        mesh.box((-0.02, 0, z - 0.014), (0.02, height, z + 0.014), "paint")
    for i in range(1, 8):
        y = i * height / 8
        mesh.box((-0.02, y - 0.014, -HALF), (0.02, y + 0.014, HALF), "paint")
    corners = [(0, 0, -HALF), (0, height, -HALF), (0, height, HALF), (0, 0, HALF)]
    return mesh.add(corners, [(0, 1, 2, 3)], "pane")


def leaf():
    """A leaf of the door: a frame of walnut, eight panes, and a handle; hinged at the origin, to +x."""
    width, height = DOOR - 0.02, DOOR_TOP - 0.03
    mesh = Mesh()
    for x in (0, width - 0.13, width / 2 - 0.025):
        wide = 0.05 if 0 < x < width / 2 else 0.13
        mesh.box((x, 0.02, -0.03), (x + wide, height, 0.03), "walnut")
    for y, high in [(0.02, 0.85), (height - 0.14, 0.14), *((0.87 + 0.52 * i, 0.05) for i in range(1, 4))]:
        mesh.box((0, y, -0.03), (width, y + high, 0.03), "walnut")
    for x in (0.16, width / 2 + 0.05):
        mesh.box((x, 0.2, 0.03), (x + width / 2 - 0.2, 0.75, 0.045), "walnut")
    mesh.add(
        [(0.13, 0.87, 0), (width - 0.13, 0.87, 0), (width - 0.13, height, 0), (0.13, height, 0)], [(0, 1, 2, 3)], "pane"
    )
    bar = [(width - 0.065, 1.05 + 0.02 * i, 0.075) for i in range(16)]
    return mesh.sweep(bar, 0.014, 16, "brass")


def bay():
    """A bookcase without books: sides, boards, a base and a cornice; its back at x = 0, its left end at z = 0."""
    mesh, width = Mesh(), PITCH
    for z in (0, width - 0.02):
        mesh.box((-SHELF_DEPTH, 0, z), (0, SHELF_TOP, z + 0.02), "oak")
        mesh.box((-SHELF_DEPTH - 0.02, 0, z - 0.03), (-SHELF_DEPTH, SHELF_TOP, z + 0.05), "oak")
    mesh.box((-0.02, 0, 0), (0, SHELF_TOP, width), "walnut")
    for i in range(N_BOARDS + 1):
        mesh.box((-SHELF_DEPTH, board(i) - 0.025, 0), (0, board(i), width), "oak")
    mesh.box((-SHELF_DEPTH - 0.02, 0, 0), (-SHELF_DEPTH, SHELF_BOTTOM, width), "oak")
    for y, out in [(0, 0.03), (0.05, 0.06), (0.1, 0.1)]:
        mesh.box((-SHELF_DEPTH - out, SHELF_TOP + y, 0), (0, SHELF_TOP + y + 0.05, width), "oak")
    return mesh


def board(i):
    return SHELF_BOTTOM + (SHELF_TOP - SHELF_BOTTOM) * i / N_BOARDS


def book():
    """A book of 1 x 1 x 1 whose spine, rounded and with raised bands, faces -x: two covers, pages and gold lines."""
    mesh = Mesh().box((0.12, 0, 0), (1, 1, 0.12), "red").box((0.12, 0, 0.88), (1, 1, 1), "red")
    mesh.box((0.12, 0.02, 0.12), (0.96, 0.98, 0.88), "paper")
    spine(mesh, [(0, 0), (1, 0)], "red")
    for y in (0.2, 0.75):
        spine(mesh, [(y, 0), (y + 0.011, 0.04), (y + 0.022, 0)], "red")
    spine(mesh, [(0.62, 0.01), (0.66, 0.01)], "brass")
    return mesh


def spine(mesh, profile, material, n_sides=6):
    """Half a cylinder along y at (height, lift)."""
    points = []
    for y, lift in profile:
        for i in range(n_sides + 1):
            a = math.pi * i / n_sides
            points.append((0.12 - (0.12 + lift) * math.sin(a), y, 0.5 - (0.5 + lift) * math.cos(a)))
    rows, at = range(len(profile) - 1), n_sides + 1
    faces = [[r * at + i, r * at + i + 1, (r + 1) * at + i + 1, (r + 1) * at + i] for r in rows for i in range(n_sides)]
    mesh.add(points, faces, material)


def shelves(scene, chance):
    """Bookcases along the right wall and beside the doors, and their books."""
    case = scene.mesh(bay())
    of_right = [(RIGHT, 0, BACK + 0.4 + PITCH * i) for i in range(10)]
    scene.put("bookcases", case, of_right)
    # In a space that is turned about y: its x is -z of the room, its z is x.
    of_back = [(-BACK, 0, x) for x in (-3.75, -2.52, 1.32, 2.55)]
    scene.put("bookcases by the door", case, of_back, rotation=turn("y", 90))
    stored = scene.mesh(book())
    for cases, where, node in [(of_right, "", {}), (of_back, " by the door", {"rotation": turn("y", 90)})]:
        found = {}
        for back, _, first in cases:
            for i in range(N_BOARDS):
                fill(found, chance, back, board(i), first, board(i + 1) - board(i) - 0.04)
        for color, rows in found.items():
            places, scales = zip(*rows)
            scene.put(f"{color} books{where}", stored, places, scales=scales, repaint=("red", color), **node)


def fill(found, chance, back, y, first, room):
    """A shelf of books, some in sets, with a gap here and there."""
    at, end = first + 0.03, first + PITCH - 0.03
    while at < end - 0.06:
        if chance.random() < 0.06:
            at += chance.uniform(0.04, 0.2)
            continue
        color, thick = chance.choice(LEATHERS), chance.uniform(0.03, 0.065)
        high, deep = room * chance.uniform(0.68, 0.98), chance.uniform(0.19, 0.26)
        for _ in range(chance.choice([1, 1, 1, 2, 3, 6])):
            if at + thick > end:
                break
            place = back - SHELF_DEPTH + 0.03 + 0.01 * chance.random(), y, at
            found.setdefault(color, []).append((place, (deep, high, thick)))
            at += thick + 0.001


def tables(scene):
    """Tables on turned legs, with a runner of baize."""
    top = (
        Mesh()
        .box((-0.6, 0.735, -1.15), (0.6, 0.77, 1.15), "walnut")
        .box((-0.52, 0.6, -1.05), (0.52, 0.735, 1.05), "oak")
    )
    top.box((-0.4, 0.77, -0.95), (0.4, 0.773, 0.95), "baize")
    scene.put("tables", scene.mesh(top), [(x, 0, z) for x, z in TABLES])
    profile = [(0, 0), (0.03, 0), (0.042, 0.03), (0.03, 0.06), (0.022, 0.09), (0.03, 0.16), (0.044, 0.3), (0.046, 0.36)]
    profile += [(0.034, 0.44), (0.026, 0.46), (0.042, 0.48), (0.042, 0.5), (0.03, 0.52), (0.05, 0.55), (0.05, 0.72)]
    feet = [(x + a, 0, z + b) for x, z in TABLES for a in (-0.46, 0.46) for b in (-0.98, 0.98)]
    scene.put("legs of tables", scene.mesh(Mesh().lathe(profile, 24, "oak")), feet)


def chairs(scene, chance):
    """Windsor chairs: a round seat, turned legs, spindles and a bent rail."""
    stands = []
    for x, z in TABLES:
        for side in (-1, 1):
            for along in (-0.55, 0.55):
                out = chance.choice([0.72, 0.78, 0.8, 0.95])
                place = x + side * out, 0, z + along + chance.uniform(-0.06, 0.06)
                stands.append((place, turn("y", 90 * (1 - side) + chance.uniform(-14, 14))))

    def put(name, mesh, parts):
        placed = [
            (tuple(a + b for a, b in zip(place, turned(way, at))), product(way, tilt))
            for place, way in stands
            for at, tilt in parts
        ]
        places, turns = zip(*placed)
        scene.put(name, scene.mesh(mesh), places, turns)

    seat = [
        (0, 0.43),
        (0.19, 0.43),
        (0.215, 0.44),
        (0.222, 0.455),
        (0.215, 0.47),
        (0.19, 0.475),
        (0.1, 0.468),
        (0, 0.466),
    ]
    put("seats of chairs", Mesh().lathe(seat, 40, "oak"), [((0, 0, 0), IDENTITY)])
    leg = [(0, 0), (0.012, 0), (0.016, 0.08), (0.022, 0.18), (0.016, 0.21), (0.022, 0.225), (0.015, 0.25)]
    leg += [(0.019, 0.3), (0.019, 0.38), (0.012, 0.45), (0, 0.45)]
    splay = lambda a, b: product(turn("z", 9 * a), turn("x", -9 * b))
    legs = [((0.21 * a, 0, 0.2 * b), splay(a, b)) for a in (-1, 1) for b in (-1, 1)]
    put("legs of chairs", Mesh().lathe(leg, 20, "oak"), legs)
    spindle = [(0, 0), (0.006, 0), (0.009, 0.12), (0.006, 0.45), (0, 0.45)]
    arc = [math.radians(a) for a in range(-60, 61, 15)]
    spindles = [((0.19 * math.cos(a), 0.46, 0.19 * math.sin(a)), turn("z", -10)) for a in arc]
    put("spindles of chairs", Mesh().lathe(spindle, 12, "oak"), spindles)
    bend = [(0.19 * math.sin(math.radians(a)), -0.19 * math.cos(math.radians(a)), 0) for a in range(-66, 67, 6)]
    # Bent in the plane of x and y, then laid down.
    rail = Mesh().sweep(bend, 0.02, 16, "oak")
    put("rails of chairs", rail, [((0.08, 0.9, 0), product(turn("y", 90), turn("x", 90)))])


def things(scene, chance):
    """Lamps, carafes and tumblers, open books, a globe, a ladder and what else stands about."""
    stands = [(x, 0.773, z + b) for x, z in TABLES for b in (-0.5, 0.5)]
    base = [(0, 0), (0.085, 0), (0.09, 0.012), (0.08, 0.022), (0.03, 0.03), (0.014, 0.05), (0.01, 0.08), (0.016, 0.1)]
    base += [(0.01, 0.12), (0.009, 0.3), (0.018, 0.32), (0.009, 0.34), (0, 0.36)]
    scene.put("stems of lamps", scene.mesh(Mesh().lathe(base, 32, "brass")), stands)
    arch = [(0.085 * math.cos(math.radians(a)), 0.085 * math.sin(math.radians(a)), 0) for a in range(0, 181, 10)]
    shade = Mesh()
    points = [(x, y, z) for x, y, _ in arch for z in (-0.16, 0.16)]
    faces = [[2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2] for i in range(len(arch) - 1)]
    ends = [list(range(0, 2 * len(arch), 2)), list(range(1, 2 * len(arch), 2))]
    shade.add(points, faces, "shade").add(points, ends, "shade")
    scene.put("shades of lamps", scene.mesh(shade), [(x, y + 0.29, z) for x, y, z in stands])

    places = [(x + chance.uniform(-0.1, 0.1), 0.773, z + chance.uniform(-0.08, 0.08)) for x, z in TABLES]
    carafe = [(0, 0), (0.05, 0), (0.075, 0.02), (0.08, 0.06), (0.065, 0.12), (0.03, 0.17), (0.025, 0.22), (0.038, 0.26)]
    carafe += [(0.034, 0.26), (0.021, 0.22), (0.026, 0.17), (0.061, 0.12), (0.075, 0.06), (0.07, 0.025), (0, 0.012)]
    scene.put("carafes", scene.mesh(Mesh().lathe(carafe, 48, "glass")), places)
    tumbler = [(0, 0), (0.03, 0), (0.038, 0.09), (0.036, 0.09), (0.028, 0.008), (0, 0.008)]
    beside = [(x + 0.14 * math.cos(a), y, z + 0.14 * math.sin(a)) for x, y, z in places for a in (0.5, 2.4)]
    scene.put("tumblers", scene.mesh(Mesh().lathe(tumbler, 32, "glass")), beside)

    n, pages = 12, Mesh()
    curve = [
        (x, 0.012 + 0.02 * math.sin(math.pi * min(abs(x) / 0.15, 1) ** 0.6))
        for x in (0.15 * (i / n - 1) for i in range(2 * n + 1))
    ]
    points = [(x, y, z) for z in (-0.11, 0.11) for x, y in curve]
    at = 2 * n + 1
    pages.add(points, [[i, at + i, at + i + 1, i + 1] for i in range(2 * n)], "paper").box(
        (-0.16, 0, -0.115), (0.16, 0.01, 0.115), "brown"
    )
    reading = [
        (x + side * 0.36, 0.773, z + b)
        for x, z in TABLES
        for side in (-1, 1)
        for b in (-0.55, 0.6)
        if chance.random() < 0.6
    ]
    ways = [turn("y", 90 + chance.uniform(-25, 25)) for _ in reading]
    scene.put("open books", scene.mesh(pages), reading, ways)

    globe = Mesh()
    ring = [(0.335 * math.cos(math.radians(a)), 0.335 * math.sin(math.radians(a)), 0) for a in range(0, 361, 5)]
    globe.sweep(ring, 0.012, 12, "brass")
    foot = [
        (0, -0.95),
        (0.22, -0.95),
        (0.22, -0.92),
        (0.06, -0.88),
        (0.035, -0.8),
        (0.05, -0.6),
        (0.03, -0.5),
        (0.035, -0.36),
        (0, -0.34),
    ]
    globe.lathe(foot, 32, "walnut")
    scene.put("stand of the globe", scene.mesh(globe), [GLOBE], [turn("y", 25)])

    ladder = Mesh()
    for z in (-0.22, 0.22):
        ladder.box((-0.02, 0, z - 0.03), (0.02, 3.25, z + 0.03), "walnut")
    for i in range(1, 11):
        ladder.box((-0.05, 0.29 * i, -0.22), (0.05, 0.29 * i + 0.025, 0.22), "oak")
    scene.put("ladder", scene.mesh(ladder), [(2.85, 0, -4.6)], [turn("z", -14)])
    carpet = Mesh().box((-0.75, 0, BACK + 0.5), (0.3, 0.012, FRONT - 0.3), "carpet")
    for x in (-0.72, 0.24):
        carpet.box((x, 0.012, BACK + 0.5), (x + 0.03, 0.014, FRONT - 0.3), "tan")
    scene.put("carpet", scene.mesh(carpet))


def main():
    scene, chance = Scene(), random.Random(7)
    scene.put("walls", scene.mesh(walls()))
    scene.put("beams", scene.mesh(beam()), [(0, 0, 2.0 - 2.4 * i) for i in range(6)])
    scene.put("bars of the laylight", scene.mesh(laylight()), [(0, 0, 0.8 - 2.4 * i) for i in range(5)])
    scene.put("windows", scene.mesh(window()), [(LEFT - WALL / 2, SILL, z) for z in WINDOWS])
    frame = Mesh()
    for x in (-DOOR - 0.14, DOOR):
        frame.box((x, 0, BACK - 0.05), (x + 0.14, DOOR_TOP + 0.14, BACK + 0.04), "walnut")
    frame.box((-DOOR, DOOR_TOP, BACK - 0.05), (DOOR, DOOR_TOP + 0.14, BACK + 0.04), "walnut")
    scene.put("frame of the door", scene.mesh(frame))
    hinges = [(-DOOR, 0, BACK), (DOOR, 0, BACK)]
    scene.put("doors", scene.mesh(leaf()), hinges, [turn("y", -62), turn("y", 180)])
    shelves(scene, chance)
    tables(scene)
    chairs(scene, chance)
    things(scene, chance)
    scene.write(Path(__file__).with_suffix(".glb"))


main()
