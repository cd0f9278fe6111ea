"""Scene files: sections and lists of plain values → YAML.

JSON is YAML, so that the values are written as JSON, an entry a line.
"""

from __future__ import annotations

import json
import math
from typing import Any

Value = Any  # what JSON can hold


def scene_text(comment: str, sections: dict[str, Value]) -> str:
    """A scene file; the entries of lists, and those of materials, have a line each."""
    lines = [f"# {line}".rstrip() for line in comment.splitlines()]
    for key, value in sections.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            lines += [f"{key}:", *(f"  - {flow(item)}" for item in value)]
        elif key == "materials" and value:
            lines += ["materials:", *(f"  {flow(name)}: {flow(item)}" for name, item in value.items())]
        else:
            lines.append(f"{key}: {flow(value)}")
    return "\n".join(lines) + "\n"


def flow(value: Value) -> str:
    """A value on one line, its keys without quotes."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key}: {flow(item)}" for key, item in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(flow, value)) + "]"
    if isinstance(value, float):
        return number(value)
    return json.dumps(value, ensure_ascii=False)


def number(value: float) -> str:
    """A number to the precision that raycost reads, and no more digits."""
    if not math.isfinite(value):
        raise ValueError(f"a number of the view is {value}")
    return f"{value:.9g}"
