"""The common part of the scripts in this folder: building the program, and running valgrind."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def install():
    """Installs valgrind on Debian or Ubuntu if it is missing."""
    if shutil.which("valgrind"):
        return
    if not shutil.which("apt-get"):
        sys.exit("install valgrind first")
    as_root = [] if os.geteuid() == 0 else ["sudo"]
    apt = [*as_root, "env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-q"]
    subprocess.run([*apt, "update"], check=True)
    subprocess.run([*apt, "install", "-y", "--no-install-recommends", "valgrind"], check=True)


def build(folder=ROOT):
    """Builds the bench from the sources in a folder; returns the path of the program."""
    command = ["cargo", "bench", "--no-run", "--bench", "instructions", "--message-format=json"]
    # Each copy of the sources has its own target folder, since cargo would confuse them.
    environment = {**os.environ, "CARGO_TARGET_DIR": str(folder / "target")}
    built = subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE, check=True)
    messages = map(json.loads, built.stdout.splitlines())
    # The program of the package is built, too, and may be finished last.
    named = (message for message in messages if message.get("target", {}).get("name") == "instructions")
    return next(message["executable"] for message in named if message.get("executable"))


def run(tool, program, arguments):
    """Runs the program under a tool of valgrind, given with its options; returns the output
    of the program and the messages of valgrind."""
    command = ["valgrind", *tool, program, *map(str, arguments)]
    # Only these: the size of the environment changes the address of the stack.
    environment = {"PATH": os.environ["PATH"], "RAYON_NUM_THREADS": "1"}
    ran = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    if ran.returncode:
        sys.exit(ran.stderr)
    return json.loads(ran.stdout), ran.stderr
