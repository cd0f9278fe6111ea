"""Validates the files of configs/ and broken scenes: validate.py PROGRAM"""

import json
import re
import subprocess
import sys
from pathlib import Path

import yaml
from jsonschema import Draft202012Validator

ROOT = Path(__file__).resolve().parents[2]
# A scene without a mistake, as in tests/commands/errors.rs.
FINE = """\
image: { width: 4, height: 3 }
camera: { look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 } }
materials: { red: { color: [1, 0, 0] } }
lights: [{ point: { position: [5, 5, 5] } }]
objects: [{ sphere: { center: [0, 0, 0], radius: 1 }, material: red }]
"""
# Mistakes in the kind of a value or in a key; what contradicts something else is no
# matter of a schema.
STRUCTURAL = re.compile(r"error: (unknown key|.* needs the key|.* must have exactly one key)")


def main():
    program = sys.argv[1]
    validators = {}
    for kind in ["scene", "part", "study"]:
        output = subprocess.run([program, "schema", kind], check=True, capture_output=True)
        schema = json.loads(output.stdout)
        Draft202012Validator.check_schema(schema)
        validators[kind] = Draft202012Validator(schema)
    folders = [
        ("configs", "scene"),
        ("configs/library", "part"),
        ("configs/studies", "study"),
        ("configs/studies/ranks", "study"),
        ("configs/studies/16_cores", "study"),
    ]
    for folder, kind in folders:
        for path in sorted((ROOT / folder).glob("*.yaml")):
            expect(validators[kind], path.read_text(), True, path)
    expect(validators["scene"], (ROOT / "tests/full.yaml").read_text(), True, "full.yaml")
    n = sum(1 for title, scene in structural() if expect(validators["scene"], scene, False, title))
    assert n > 40, n


def expect(validator, text, is_valid, name):
    """Whether the text is YAML; its validity must be as expected."""
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError:
        return False
    errors = [error.message[:200] for error in validator.iter_errors(value)]
    assert (not errors) == is_valid, f"{name}: {errors}"
    return True


def structural():
    """The broken scenes with a structural mistake, and their titles."""
    for path in sorted((ROOT / "tests/broken").glob("*.txt")):
        for case in path.read_text().split("===== ")[1:]:
            title, rest = case.split("\n", 1)
            scene, _, message = rest.partition("-----\n")
            if not STRUCTURAL.match(message) or "(whole file)" in title:
                continue
            for line in FINE.splitlines(keepends=True):
                key = line[: line.index(":") + 1]
                if not any(own.startswith(key) for own in scene.splitlines()):
                    scene += line
            yield title, scene


if __name__ == "__main__":
    main()
