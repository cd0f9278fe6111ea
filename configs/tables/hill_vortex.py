"""Makes hill_vortex.csv, streamlines of Hill's spherical vortex, for hill_vortex.yaml.

    python hill_vortex.py

An exact solution of Euler's equations (Hill, "On a spherical vortex", Philosophical Transactions
of the Royal Society A 185, 1894), in the frame of the vortex, of radius 1 in a flow of speed 1
toward +x. `speed` is a share of the speed far away, `line` numbers the streamlines.
"""

import math
from pathlib import Path


def velocity(r, x):
    """The velocity away from the axis and along it, at a distance from the axis."""
    square = r * r + x * x
    if square < 1:
        return -1.5 * r * x, -1.5 * (1 - 2 * r * r - x * x)
    cube, fifth = square**-1.5, square**-2.5
    return -1.5 * r * x * fifth, 1 - cube + 1.5 * r * r * fifth


def step(r, x, length):
    """The point at a distance along the streamline, by Runge and Kutta's method."""

    def direction(r, x):
        v_r, v_x = velocity(r, x)
        speed = math.hypot(v_r, v_x)
        return v_r / speed, v_x / speed

    a = direction(r, x)
    b = direction(r + a[0] * length / 2, x + a[1] * length / 2)
    c = direction(r + b[0] * length / 2, x + b[1] * length / 2)
    d = direction(r + c[0] * length, x + c[1] * length)
    mean = [(p + 2 * q + 2 * s + t) / 6 for p, q, s, t in zip(a, b, c, d)]
    return r + mean[0] * length, x + mean[1] * length


def passing(r):
    """A streamline that passes the vortex."""
    points = [(r, -2.6)]
    while points[-1][1] < 2.6:
        points.append(step(*points[-1], 0.06))
    return points


def closed(r, n_points=44):
    """A streamline inside of the vortex, which returns to its first point."""
    length, (at_r, at_x) = 0, (r, 0.0)
    turned = 0
    center = math.sqrt(0.5)
    while abs(turned) < 2 * math.pi:
        before = math.atan2(at_x, at_r - center)
        at_r, at_x = step(at_r, at_x, 0.002)
        change = math.atan2(at_x, at_r - center) - before
        turned += math.remainder(change, 2 * math.pi)
        length += 0.002
    points = [(r, 0.0)]
    for _ in range(n_points - 1):
        points.append(step(*points[-1], length / n_points))
    return [*points, points[0]]


def main():
    lines = [(closed(r), angle) for angle in range(0, 360, 12) for r in (0.94, 0.86, 0.78)]
    lines += [(passing(r), angle) for angle in range(95, 276, 18) for r in (0.1, 0.35, 0.7)]
    rows = ["x,y,z,line,speed"]
    for number, (points, angle) in enumerate(lines):
        angle = math.radians(angle)
        for r, x in points:
            place = x, r * math.sin(angle), r * math.cos(angle)
            numbers = [*(f"{value:.3f}" for value in place), str(number)]
            rows.append(",".join([*numbers, f"{math.hypot(*velocity(r, x)):.3f}"]))
    Path(__file__).with_suffix(".csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
