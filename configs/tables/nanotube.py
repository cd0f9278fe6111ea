"""Makes nanotube.csv, bonds.csv and fullerenes.csv, the atoms of a carbon peapod, for nanotube.yaml.

    python nanotube.py

Fullerenes C60 in a (10, 10) nanotube (Smith, Monthioux and Luzzi, "Encapsulated C60 in carbon
nanotubes", Nature 396, 1998), in angstroms; a part of the tube is left out. `r` is chosen to be seen.
"""

import itertools
import math
from pathlib import Path

BOND = 1.42
N_AROUND = 10
HALF_LENGTH = 20.2
SPACING = 9.9


def tube():
    """The atoms of the nanotube, whose axis is x, without a part that would hide the fullerenes."""
    radius = 3 * N_AROUND * BOND / (2 * math.pi)
    row_height = BOND * math.sqrt(3) / 2
    n_rows = int(HALF_LENGTH / row_height)
    for row in range(-n_rows, n_rows + 1):
        for around in range(2 * N_AROUND):
            arc = 3 * BOND * (around // 2) + BOND * (around % 2) + 1.5 * BOND * (row % 2)
            angle = arc / radius
            # The part that is open grows toward +x.
            x = row * row_height
            half_open = math.radians(62 + 2.0 * x)
            if abs(math.remainder(angle - math.radians(52), 2 * math.pi)) > half_open:
                yield x, radius * math.sin(angle), radius * math.cos(angle)


def fullerene(center):
    """The 60 corners of a truncated icosahedron."""
    golden = (1 + math.sqrt(5)) / 2
    corners = [(0, 1, 3 * golden), (1, 2 + golden, 2 * golden), (golden, 2, 2 * golden + 1)]
    found = set()
    for corner in corners:
        for signs in itertools.product((1, -1), repeat=3):
            x, y, z = (sign * value for sign, value in zip(signs, corner))
            found |= {(x, y, z), (y, z, x), (z, x, y)}
    unique = {tuple(round(value * BOND / 2, 4) + 0.0 for value in point) for point in found}
    for x, y, z in sorted(unique):
        turned = x * math.cos(center) - y * math.sin(center), x * math.sin(center) + y * math.cos(center)
        yield turned[0] + center, turned[1], z


def write(name, header, rows):
    lines = [",".join(value if isinstance(value, str) else f"{value:.3f}" for value in row) for row in rows]
    Path(__file__).with_name(name).write_text("\n".join([header, *lines]) + "\n")


def bonds(atoms):
    """The ends of all bonds, as lines of two points."""
    pairs = [(a, b) for a, b in itertools.combinations(atoms, 2) if math.dist(a, b) < 1.1 * BOND]
    return [[*end, str(number)] for number, pair in enumerate(pairs) for end in pair]


def main():
    atoms = list(tube())
    centers = [(i - 1.5) * SPACING for i in range(4)]
    carbon_60 = [list(fullerene(center)) for center in centers]
    write("nanotube.csv", "x,y,z", atoms)
    write("fullerenes.csv", "x,y,z", [atom for one in carbon_60 for atom in one])
    write("bonds.csv", "x,y,z,line", bonds([*atoms, *(atom for one in carbon_60 for atom in one)]))


if __name__ == "__main__":
    main()
