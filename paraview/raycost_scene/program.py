"""Finding and running the program raycost."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from pathlib import Path

from .errors import RaycostError

#: raycost's repository, whose folder `paraview` this file is in.
REPOSITORY = Path(__file__).resolve().parents[2]


def find_program() -> str:
    """The path of raycost: the variable RAYCOST, or the program in PATH."""
    wanted = os.environ.get("RAYCOST")
    found = shutil.which(wanted or "raycost")
    if found:
        return found
    if wanted:
        raise RaycostError(f"there is no program {wanted}, which the variable RAYCOST names")
    raise RaycostError(
        "the program raycost is not in PATH; install it by "
        f"`cargo install --path {shlex.quote(str(REPOSITORY))}`, "
        "or set the variable RAYCOST to its path"
    )


def render(scene: Path, out: Path, arguments: tuple[str, ...] = ()) -> Path:
    """Renders a scene file into the folder `out`, and returns the folder."""
    command = [find_program(), "render", os.fspath(scene), "--out", os.fspath(out), *arguments]
    try:
        run = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", errors="replace", check=False)
    except OSError as error:
        raise RaycostError(f"{command[0]} does not run: {error}") from error
    if run.returncode != 0:
        raise RaycostError(run.stderr.strip() or f"raycost has ended with code {run.returncode}")
    return out
