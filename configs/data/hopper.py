"""Makes hopper/: grains that fall through a hopper, as a series of 20 VTP files.

    python hopper.py        # Python's own library is all that it needs

A small simulation by the discrete element method: spheres under gravity that push each
other, the walls and the floor away with damped springs. Each file has the points with their
`radius` in m and `velocity` in m/s; grains.pvd lists the files with their times in s;
walls.stl has the hopper.
"""

import math
import random
from pathlib import Path

N, N_FILES, INTERVAL = 90, 20, 0.06  # grains, files, seconds from file to file
STEP, GRAVITY, DENSITY = 2e-4, -9.81, 1000.0
STIFFNESS, RESTITUTION = 40000.0, 0.35
OPENING, RIM, BOTTOM, TOP = 0.13, 0.42, 0.45, 0.95  # half widths, heights


def walls():
    """The triangles of the four slanted sides and of the straight rim above them."""
    low = [(x * OPENING, BOTTOM, z * OPENING) for x, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    high = [(x * RIM, TOP, z * RIM) for x, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    for i in range(4):
        j = (i + 1) % 4
        yield low[i], low[j], high[j]
        yield low[i], high[j], high[i]


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def nearest(p, triangle):
    """The point of a triangle that is nearest to p (Ericson, Real-Time Collision Detection)."""
    a, b, c = triangle
    ab, ac, ap = sub(b, a), sub(c, a), sub(p, a)
    d1, d2 = dot(ab, ap), dot(ac, ap)
    if d1 <= 0 and d2 <= 0:
        return a
    bp, cp = sub(p, b), sub(p, c)
    d3, d4, d5, d6 = dot(ab, bp), dot(ac, bp), dot(ab, cp), dot(ac, cp)
    if d3 >= 0 and d4 <= d3:
        return b
    if d6 >= 0 and d5 <= d6:
        return c
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if vc <= 0 <= d1 and d3 <= 0:
        v, w = d1 / (d1 - d3), 0.0
    elif vb <= 0 <= d2 and d6 <= 0:
        v, w = 0.0, d2 / (d2 - d6)
    elif va <= 0 and d4 >= d3 and d5 >= d6:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        v = 1 - w
    else:
        v, w = vb / (va + vb + vc), vc / (va + vb + vc)
    return tuple(a[k] + v * ab[k] + w * ac[k] for k in range(3))


class Grains:
    def __init__(self):
        numbers = random.Random(7)
        self.radii = [0.025 + 0.02 * numbers.random() for _ in range(N)]
        self.masses = [DENSITY * 4 / 3 * math.pi * r**3 for r in self.radii]
        self.points, self.velocities = [], []
        for i in range(N):  # on a grid above the hopper, a little beside its nodes
            x, z, y = i % 5 - 2, i // 5 % 5 - 2, i // 25
            jitter = [0.008 * (numbers.random() - 0.5) for _ in range(3)]
            self.points.append([0.1 * x + jitter[0], 0.93 + 0.1 * y + jitter[1], 0.1 * z + jitter[2]])
            self.velocities.append([0.0, 0.0, 0.0])
        self.triangles = list(walls())

    def push(self, forces, i, direction, distance, radius, velocity, mass):
        """Adds the force of a contact to forces[i]; returns it. `direction` points to i."""
        overlap = radius - distance
        if overlap <= 0 or distance == 0:
            return None
        normal = [x / distance for x in direction]
        damping = -2 * math.log(RESTITUTION) * math.sqrt(
            STIFFNESS * mass / (math.pi**2 + math.log(RESTITUTION) ** 2)
        )
        size = max(0.0, STIFFNESS * overlap - damping * dot(velocity, normal))
        force = [size * x for x in normal]
        for k in range(3):
            forces[i][k] += force[k]
        return force

    def step(self):
        forces = [[0.0, GRAVITY * m, 0.0] for m in self.masses]
        cells = {}
        for i, p in enumerate(self.points):
            cells.setdefault(tuple(int(x // 0.09) for x in p), []).append(i)
        for i, p in enumerate(self.points):
            r, m, v = self.radii[i], self.masses[i], self.velocities[i]
            self.push(forces, i, (0, p[1], 0), p[1], r, v, m)  # the floor, y = 0
            if BOTTOM - r < p[1] < TOP + r:
                for triangle in self.triangles:
                    direction = sub(p, nearest(p, triangle))
                    self.push(forces, i, direction, math.sqrt(dot(direction, direction)), r, v, m)
            cell = [int(x // 0.09) for x in p]
            for dx in (-1, 0, 1):
                for dy in (-1, 0, 1):
                    for dz in (-1, 0, 1):
                        for j in cells.get((cell[0] + dx, cell[1] + dy, cell[2] + dz), ()):
                            if j <= i:
                                continue
                            direction = sub(p, self.points[j])
                            distance = math.sqrt(dot(direction, direction))
                            mass = m * self.masses[j] / (m + self.masses[j])
                            relative = sub(v, self.velocities[j])
                            reach = r + self.radii[j]
                            force = self.push(forces, i, direction, distance, reach, relative, mass)
                            for k in range(3 if force else 0):
                                forces[j][k] -= force[k]
        for i in range(N):
            v = self.velocities[i]
            on_floor = self.points[i][1] < 1.02 * self.radii[i]
            for k in range(3):
                v[k] += STEP * forces[i][k] / self.masses[i]
                if on_floor and k != 1:
                    v[k] *= 1 - 3 * STEP / 0.06  # it rolls until it rests
                self.points[i][k] += STEP * v[k]

    def write(self, path):
        def rows(values, digits):
            return "\n".join(" ".join(f"{x:.{digits}f}" for x in row) for row in values)

        def array(name, n, values, digits):
            begin = f'<DataArray type="Float32" Name="{name}" NumberOfComponents="{n}" format="ascii">'
            return f"{begin}\n{rows(values, digits)}\n</DataArray>\n"

        path.write_text(
            '<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian">\n'
            f'<PolyData>\n<Piece NumberOfPoints="{N}">\n<PointData>\n'
            + array("radius", 1, [[r] for r in self.radii], 4)
            + array("velocity", 3, self.velocities, 3)
            + "</PointData>\n<Points>\n"
            + array("Points", 3, self.points, 4)
            + "</Points>\n</Piece>\n</PolyData>\n</VTKFile>\n"
        )


def main():
    folder = Path(__file__).with_name("hopper")
    folder.mkdir(exist_ok=True)
    stl = ["solid hopper"]
    for a, b, c in walls():
        n = cross(sub(b, a), sub(c, a))
        length = math.sqrt(dot(n, n))
        stl.append("facet normal " + " ".join(f"{x / length:.6f}" for x in n) + "\nouter loop")
        stl += ["vertex " + " ".join(f"{x:.4f}" for x in p) for p in (a, b, c)]
        stl.append("endloop\nendfacet")
    (folder / "walls.stl").write_text("\n".join(stl) + "\nendsolid hopper\n")
    grains, listed = Grains(), []
    for number in range(N_FILES):
        name = f"grains_{number:04}.vtp"
        grains.write(folder / name)
        time = number * INTERVAL
        listed.append(f'<DataSet timestep="{time:.2f}" part="0" file="{name}"/>')
        for _ in range(round(INTERVAL / STEP)):
            grains.step()
    (folder / "grains.pvd").write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
        + "\n".join(listed)
        + "\n</Collection>\n</VTKFile>\n"
    )


main()
