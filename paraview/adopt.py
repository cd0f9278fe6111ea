"""Takes the values that the renderer filled in for the sample over into the templates.

    python3 paraview/adopt.py out/NAME [STATE ...]

`author.py` knows the pipelines, but not what the renderer puts into them: after it, and after a build
with the new templates and a rendering, the states of this folder are made those of the sample, with
its paths under `$RAYCOST_OUT`. The marks stay.
"""

import re
import sys
from pathlib import Path

MARK = re.compile(r' fill="([^"]*)"')


def main():
    out, here = Path(sys.argv[1]).resolve(), Path(__file__).resolve().parent
    for template in sorted(here.glob("*.pvsm")):
        filled = out / template.name
        if filled.exists() and (template.stem in sys.argv[2:] or not sys.argv[2:]):
            text = filled.read_text().replace(str(out), "$RAYCOST_OUT")
            template.write_text(marked(template.read_text(), text))


def marked(template, filled):
    """The filled state with the template's marks; the lines are the same but for comments and elements in lists."""
    lines = (line for line in filled.splitlines(keepends=True) if not line.startswith("<!--"))
    result, is_in_list = [], False
    for line in template.splitlines(keepends=True):
        if is_in_list and "<Element " in line:
            continue  # the filled state's own elements have been taken
        mark = MARK.search(line)
        new = next(lines)
        while is_in_list and "<Element " in new:
            result.append("    " + new.lstrip())
            new = next(lines)
        is_in_list = "<Property " in line and mark is not None
        result.append(new if mark is None else with_mark(line, new, mark))
    return "".join(result)


def with_mark(line, new, mark):
    """The new line with the mark behind the same attribute as in the old line."""
    attribute = re.findall(r'(\w+)="[^"]*"$', line[: mark.start()])[0]
    value = re.search(rf' {attribute}="[^"]*"', new)
    return new[: value.end()] + mark.group() + new[value.end() :]


if __name__ == "__main__":
    main()
