# SPDX-License-Identifier: Apache-2.0
"""A kettle and a conch in the manner of the figures of [SAR], as Wavefront OBJ.

Not a page. Each part is a grid of points, swept along a curve; one unit of u and v is one unit
of length, so that the texture has one size everywhere. Points are (x, y, z), z up; files have y
up."""

import math


def _add(a, b, scale=1.0):
    return tuple(x + scale * y for x, y in zip(a, b))


def _cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _unit(a):
    length = math.sqrt(sum(x * x for x in a)) or 1.0
    return tuple(x / length for x in a)


class Obj:
    def __init__(self):
        self.lines, self.count = [], 0

    def grid(self, points, inside_out=False):
        """Rows of points; u is the length along the longest row, v the length across rows."""
        rows, cols = len(points), len(points[0])
        middle = max(points, key=lambda row: sum(math.dist(a, b) for a, b in zip(row, row[1:])))
        u, v = [0.0], [0.0]
        for a, b in zip(middle, middle[1:]):
            u.append(u[-1] + math.dist(a, b))
        for a, b in zip(points, points[1:]):
            v.append(v[-1] + max(math.dist(p, q) for p, q in zip(a, b)))
        for row, y in zip(points, v):
            for p, x in zip(row, u):
                self.lines.append(f"v {p[0]:.5f} {p[2]:.5f} {-p[1]:.5f}")
                self.lines.append(f"vt {x:.5f} {y:.5f}")
        for r in range(rows - 1):
            for c in range(cols - 1):
                a = self.count + r * cols + c + 1
                corners = [a, a + 1, a + cols + 1, a + cols]
                if inside_out:
                    corners.reverse()
                self.lines.append("f " + " ".join(f"{k}/{k}" for k in corners))
        self.count += rows * cols

    def turned(self, profile, around=96):
        """(radius, height) from below upwards, turned about the z axis."""
        self.grid([
            [(r * math.cos(a), r * math.sin(a), z)
             for a in (2 * math.pi * k / around for k in range(around + 1))]
            for r, z in profile
        ])  # fmt: skip

    def tube(self, centres, radii, around=32):
        """A tube along a curve in the plane of x and z."""
        rows = []
        for i, (centre, radius) in enumerate(zip(centres, radii)):
            before, after = centres[max(0, i - 1)], centres[min(len(centres) - 1, i + 1)]
            along = _unit(_add(after, before, -1))
            side = (0.0, 1.0, 0.0)
            up = _cross(along, side)
            rows.append([
                _add(_add(centre, side, radius * math.cos(a)), up, radius * math.sin(a))
                for a in (2 * math.pi * k / around for k in range(around + 1))
            ])  # fmt: skip
        self.grid(rows, inside_out=True)

    def text(self):
        return "\n".join(self.lines) + "\n"


def _smooth(points, steps):
    """A Catmull-Rom curve through the points."""
    out = []
    padded = [points[0], *points, points[-1]]
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:]):
        for k in range(steps):
            t = k / steps
            out.append(tuple(
                0.5 * (2 * q + (r - p) * t + (2 * p - 5 * q + 4 * r - s) * t * t
                       + (3 * q - p - 3 * r + s) * t**3)
                for p, q, r, s in zip(a, b, c, d)
            ))  # fmt: skip
    return [*out, points[-1]]


def kettle():
    obj = Obj()
    belly = [(0.001, 0), (0.55, 0), (0.85, 0.12), (1.0, 0.45), (0.92, 0.85), (0.62, 1.15), (0.45, 1.22)]
    obj.turned(_smooth(belly, 10))
    lid = [(0.5, 1.21), (0.48, 1.27), (0.3, 1.36), (0.1, 1.4), (0.07, 1.45), (0.12, 1.52), (0.1, 1.6),
           (0.001, 1.63)]  # fmt: skip
    obj.turned(_smooth(lid, 8))
    spout = _smooth([(0.75, 0.0, 0.42), (1.15, 0.0, 0.55), (1.38, 0.0, 0.9), (1.62, 0.0, 1.12)], 10)
    obj.tube(spout, [0.24 - 0.15 * k / (len(spout) - 1) for k in range(len(spout))])
    handle = [(0.78 * math.cos(a), 0.0, 1.0 + 0.85 * math.sin(a))
              for a in (math.pi * (0.03 + 0.94 * k / 48) for k in range(49))]  # fmt: skip
    obj.tube(handle, [0.07] * len(handle))
    return obj.text()


def conch(turns=5.0, around=72, along=420):
    """A tube around a logarithmic spiral, lying on its side: centre and radius grow by one
    factor a turn."""
    growth = math.log(1.75) / (2 * math.pi)
    rows = []
    for i in range(along + 1):
        angle = 2 * math.pi * turns * i / along
        size = math.exp(growth * (angle - 2 * math.pi * turns))
        outward = (math.cos(angle), math.sin(angle), 0.0)
        centre = (size * 0.85 * outward[0], size * 0.85 * outward[1], 2.2 * (1 - size))
        row = []
        for k in range(around + 1):
            a = 2 * math.pi * k / around
            ridge = 1 + 0.16 * max(0.0, math.cos(a - 0.6)) ** 6 * (0.5 + 0.5 * math.cos(9 * angle))
            across, up = size * 0.72 * ridge * math.cos(a), size * 1.05 * ridge * math.sin(a)
            x, y, z = _add(_add(centre, outward, across), (0.0, 0.0, 1.0), up)
            row.append((x, -z, y))
        rows.append(row)
    obj = Obj()
    obj.grid(rows)
    return obj.text()
