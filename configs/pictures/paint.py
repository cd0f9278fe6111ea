#!/usr/bin/env python3
"""Paints the pictures of this folder: those of the scene `pictures.yaml`, and `evening.hdr`.

Needs nothing but Python. The same bytes on every machine, but for the version of zlib.
"""

import math
import struct
import sys
import zlib
from pathlib import Path

FOLDER = Path(__file__).parent


def write(name, width, height, pixel):
    """Writes a PNG of `pixel(x, y)`, which returns three or four numbers from 0 to 1."""
    rows, channels = [], 0
    for y in range(height):
        row = []
        for x in range(width):
            found = pixel(x, y)
            channels = len(found)
            row += [round(255 * min(max(channel, 0), 1)) for channel in found]
        # Of the two simplest filters, the one whose differences are smaller.
        before = [0] * channels + row[:-channels]
        sub = [(a - b) % 256 for a, b in zip(row, before)]
        size = lambda numbers: sum(min(n, 256 - n) for n in numbers)
        best = (b"\x01", sub) if size(sub) < size(row) else (b"\x00", row)
        rows.append(best[0] + bytes(best[1]))
    color = {3: 2, 4: 6}[channels]
    chunks = [
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, color, 0, 0, 0)),
        (b"IDAT", zlib.compress(b"".join(rows), 9)),
        (b"IEND", b""),
    ]
    out = b"\x89PNG\r\n\x1a\n"
    for kind, content in chunks:
        out += struct.pack(">I", len(content)) + kind + content
        out += struct.pack(">I", zlib.crc32(kind + content))
    (FOLDER / name).write_bytes(out)
    print(name, len(out), "bytes")


def random(*cell):
    """A number from 0 to 1 that depends on the whole numbers `cell` alone."""
    state = 0x9E3779B9
    for n in cell:
        state = (state ^ (n & 0xFFFFFFFF)) * 0x85EBCA6B & 0xFFFFFFFF
        state ^= state >> 13
        state = state * 0xC2B2AE35 & 0xFFFFFFFF
        state ^= state >> 16
    return state / 0xFFFFFFFF


def noise(x, y, z, seed=0):
    """Smooth noise of period 1, from 0 to 1."""
    cell = [math.floor(t) for t in (x, y, z)]
    place = [t - c for t, c in zip((x, y, z), cell)]
    fade = [t * t * (3 - 2 * t) for t in place]
    total = 0
    for corner in range(8):
        bits = [corner >> k & 1 for k in range(3)]
        weight = 1
        for bit, f in zip(bits, fade):
            weight *= f if bit else 1 - f
        total += weight * random(*(c + bit for c, bit in zip(cell, bits)), seed)
    return total


def octaves(x, y, z, n, seed=0):
    """The sum of `n` noises, each twice as fine and half as strong; from 0 to 1."""
    total = sum(noise(x * 2**k, y * 2**k, z * 2**k, seed + k) / 2**k for k in range(n))
    return total / (2 - 2 / 2**n)


def mix(a, b, t):
    t = min(max(t, 0), 1)
    return [p + (q - p) * t for p, q in zip(a, b)]


def globe(x, y, width=512, height=256):
    longitude = 2 * math.pi * (x + 0.5) / width
    latitude = math.pi * (0.5 - (y + 0.5) / height)
    p = (
        math.cos(latitude) * math.sin(longitude),
        math.sin(latitude),
        math.cos(latitude) * math.cos(longitude),
    )
    land = octaves(*(1.7 * c + 9 for c in p), 5, seed=5) - 0.5
    warm = math.cos(latitude) + 0.3 * (noise(*(6 * c + 5 for c in p), 9) - 0.5)
    if warm < 0.3:
        return (0.93, 0.95, 0.97)
    if land < 0:
        return mix((0.18, 0.42, 0.62), (0.03, 0.12, 0.3), -9 * land)
    ground = mix((0.22, 0.42, 0.14), (0.76, 0.62, 0.36), 3 * (warm - 0.62))
    return mix(ground, (0.42, 0.32, 0.24), 7 * land - 0.6)


def planks(x, y, size=256, n=4):
    plank, across = divmod(y * n / size, 1)
    shift = random(int(plank), 7)
    along = (x / size + shift) % 1
    if across < 0.03 or along < 0.006:
        return (0.13, 0.08, 0.05)
    # Around the picture, so that it can be repeated.
    turn = 2 * math.pi * x / size
    grain = octaves(1.5 * math.cos(turn), 1.5 * math.sin(turn), 14 * across + 31 * plank, 3)
    rings = 0.5 + 0.5 * math.sin(24 * grain)
    wood = mix((0.42, 0.26, 0.14), (0.62, 0.43, 0.26), 0.6 * rings + 0.4 * grain)
    return mix(wood, (0.3, 0.17, 0.09), 0.5 * random(int(plank), 3))


def plank_height(x, y, size=256, n=4):
    """The height of the planks in texels: gaps, round edges and a wavy surface."""
    x, y = x % size, y % size
    plank, across = divmod(y * n / size, 1)
    along = (x / size + random(int(plank), 7)) % 1
    # Texels to the middle of the nearest gap.
    to_gap = min(
        abs(across - 0.015) * size / n,
        abs(across - 1.015) * size / n,
        abs(along - 0.003) * size,
        abs(along - 1.003) * size,
    )
    turn = 2 * math.pi * x / size
    wave = noise(1.5 * math.cos(turn) + 5, 1.5 * math.sin(turn), 5 * across + 31 * plank, 4)
    return 2.2 * min(to_gap / 5, 1) ** 0.5 + 2.5 * wave


def plank_normals(x, y):
    """Their normals: to the right, upward and away from the floor, from 0 to 1."""
    right = plank_height(x + 1, y) - plank_height(x - 1, y)
    down = plank_height(x, y + 1) - plank_height(x, y - 1)
    normal = (-right / 2, down / 2, 1)
    length = math.hypot(*normal)
    return [0.5 + 0.5 * coordinate / length for coordinate in normal]


def spot():
    """The hide of Spot the cow: a color of each point in space, on the map of its mesh."""
    size = 512
    vertices, uvs, faces = [], [], []
    for line in (FOLDER / "../meshes/spot.obj").read_text().splitlines():
        keyword, *words = line.split() or [""]
        if keyword == "v":
            vertices.append([float(word) for word in words[:3]])
        elif keyword == "vt":
            uvs.append([float(word) for word in words[:2]])
        elif keyword == "f":
            faces.append([[int(i) - 1 for i in word.split("/")[:2]] for word in words])
    texels = {}
    for face in faces:
        (ax, ay), (bx, by), (cx, cy) = (
            (uvs[uv][0] * size - 0.5, (1 - uvs[uv][1]) * size - 0.5) for _, uv in face
        )
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area == 0:
            continue
        # Two texels over the edges, for the lookups between texels.
        for y in range(math.floor(min(ay, by, cy)) - 2, math.ceil(max(ay, by, cy)) + 3):
            for x in range(math.floor(min(ax, bx, cx)) - 2, math.ceil(max(ax, bx, cx)) + 3):
                v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
                w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
                outside = -min(v, w, 1 - v - w, 0) * abs(area) ** 0.5
                if outside > 3 or texels.get((x, y), (9,))[0] <= outside:
                    continue
                v, w = min(max(v, 0), 1), min(max(w, 0), 1)
                corners = [vertices[corner] for corner, _ in face]
                weights = (1 - v - w, v, w)
                texels[x, y] = (
                    outside,
                    [sum(t * p[k] for t, p in zip(weights, corners)) for k in range(3)],
                )

    def pixel(x, y):
        if (x, y) not in texels:
            return (0.8, 0.72, 0.62)
        px, py, pz = texels[x, y][1]
        if py < -0.64:
            return (0.14, 0.1, 0.09)
        # The muzzle.
        if pz < -0.72:
            return (0.86, 0.58, 0.52)
        patch = octaves(1.9 * px + 3, 1.9 * py + 1, 1.9 * pz + 8, 3, seed=2)
        cream, brown = (0.93, 0.88, 0.8), (0.24, 0.13, 0.08)
        return mix(cream, brown, 40 * (patch - 0.56))

    write("spot.png", size, size, pixel)


def write_light(name, width, height, pixel):
    """Writes a Radiance HDR picture of `pixel(x, y)`, which returns three numbers greater than 0."""
    out = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    for y in range(height):
        for x in range(width):
            color = pixel(x, y)
            fraction, exponent = math.frexp(max(color))
            out += bytes([int(256 * c * fraction / max(color)) for c in color] + [exponent + 128])
    (FOLDER / name).write_bytes(out)
    print(name, len(out), "bytes")


def evening(x, y, width=64, height=32):
    """All directions around a low sun, a bit right of the middle."""
    latitude, longitude = math.pi * (0.5 - (y + 0.5) / height), 2 * math.pi * ((x + 0.5) / width - 0.5)
    elevation, azimuth = math.radians(6), math.radians(20)
    to_sun = math.acos(
        math.sin(latitude) * math.sin(elevation)
        + math.cos(latitude) * math.cos(elevation) * math.cos(longitude - azimuth)
    )
    if to_sun < 0.08:
        return (160, 90, 30)
    glow = math.exp(-3 * to_sun)
    if latitude < 0:
        return (0.07 + 0.1 * glow, 0.06 + 0.06 * glow, 0.05 + 0.02 * glow)
    haze = math.exp(-4 * math.sin(latitude))
    return (0.12 + 0.5 * haze + 1.2 * glow, 0.2 + 0.3 * haze + 0.6 * glow, 0.45 - 0.1 * haze + 0.15 * glow)


if __name__ == "__main__":
    write_light("evening.hdr", 64, 32, evening)
    write("globe.png", 512, 256, globe)
    write("planks.png", 256, 256, planks)
    write("plank_normals.png", 256, 256, plank_normals)
    spot()
