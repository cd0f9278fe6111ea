"""Opacity as holes that are smaller than pixels, as of a fine net."""

from __future__ import annotations

import random
import struct
import zlib
from pathlib import Path

from vtkmodules.vtkRenderingCore import vtkRenderer

from .writer import Value

FILE = "opacity.png"
#: Grains along a side of the picture, and along that of a pixel at the focal point.
N_GRAINS, PER_PIXEL = 512, 16.3
#: Right and up in the picture, in the coordinates of the camera.
OBLIQUE = ((0.8, -0.36, -0.48), (0.0, 0.8, -0.6))


def cutout(folder: Path, opacity: float, pixel_size: float, renderer: vtkRenderer) -> Value:
    """The `cutout` of a material: grains of the surface that stay are its opacity's share."""
    file = folder / FILE
    if not file.exists():
        file.write_bytes(noise())
    camera = renderer.GetActiveCamera()
    matrix = camera.GetViewTransformMatrix()
    axes = [[matrix.GetElement(row, column) for column in range(3)] for row in range(3)]
    # Not along the view, where surfaces behind each other would have the same holes.
    right, up = ([sum(a * axis[i] for a, axis in zip(of, axes)) for i in range(3)] for of in OBLIQUE)
    image = {
        "file": FILE,
        "mapping": {"planar": {"right": right, "up": up}},
        "size": pixel_size * N_GRAINS / PER_PIXEL,
        "filter": "nearest",
        "transfer": "linear",
    }
    return {"image": image, "threshold": 1.0 - opacity}


def noise() -> bytes:
    """A gray picture of random numbers, always the same, as PNG."""
    grains = random.Random(1).randbytes(N_GRAINS * N_GRAINS)
    rows = b"".join(b"\0" + grains[i : i + N_GRAINS] for i in range(0, len(grains), N_GRAINS))
    header = struct.pack(">IIBBBBB", N_GRAINS, N_GRAINS, 8, 0, 0, 0, 0)
    chunks = (chunk(b"IHDR", header), chunk(b"IDAT", zlib.compress(rows)), chunk(b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def chunk(kind: bytes, content: bytes) -> bytes:
    """A chunk of a PNG file."""
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
