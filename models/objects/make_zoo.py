#!/usr/bin/env python3
"""Writes the zoo: objects of 30 to 66 mm on which turning is tried, zoo_NAME.obj and zoo_NAME.urdf beside this script.

Every object is homogeneous, 80 g, its centroid the origin, its surface closed. Three ways to make one:
    radial   |p| = r(d) over the directions d of an icosphere or of a cube's grid
    loft     a cross-section r(angle), scaled by a profile (z, scale), with poles
    rounded  a box whose edges are rounded with radius r
make_zoo.py --random N --seed S -o DIR writes N bodies of random kind, proportions and orientation instead, which nobody
has tuned on: zoo --objects "$(ls DIR/*.urdf | paste -sd,)" turns them.
Standard library only. Lengths in mm here, metres in the files.
"""
import argparse
import itertools
import math
import os
import random

from solid import det, icosahedron, moments

MASS = 0.080  # kg


def unit(p):
    norm = math.sqrt(sum(c * c for c in p))
    return tuple(c / norm for c in p)


class Builder:
    """Triangles over shared points, each turned so that it faces away from the origin."""

    def __init__(self, place):
        self.place, self.index, self.points, self.triangles = place, {}, [], []

    def vertex(self, p):
        key = tuple(round(c, 7) for c in p)
        if key not in self.index:
            self.index[key] = len(self.points)
            self.points.append(self.place(p))
        return self.index[key]

    def triangle(self, p, q, r):
        if det(p, q, r) < 0:
            q, r = r, q
        self.triangles.append((self.vertex(p), self.vertex(q), self.vertex(r)))


def icosphere(place, n=6):
    corners, faces = icosahedron()
    mesh = Builder(place)
    for f in faces:
        p, q, r = (corners[i] for i in f)
        at = lambda i, j: unit([p[c] + (q[c] - p[c]) * i / n + (r[c] - p[c]) * j / n for c in range(3)])
        for i in range(n):
            for j in range(n - i):
                mesh.triangle(at(i, j), at(i + 1, j), at(i, j + 1))
                if i + j < n - 1:
                    mesh.triangle(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1))
    return mesh


def cube_grid(place, lines):
    """The surface of the cube of half edge 1, cut at `lines` along each edge."""
    mesh = Builder(place)
    for axis, side in itertools.product(range(3), (1, -1)):
        def at(u, v):
            p = [0, 0, 0]
            p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, u, v
            return tuple(p)
        for (u0, u1), (v0, v1) in itertools.product(zip(lines, lines[1:]), repeat=2):
            mesh.triangle(at(u0, v0), at(u1, v0), at(u1, v1))
            mesh.triangle(at(u0, v0), at(u1, v1), at(u0, v1))
    return mesh


def even(n):
    return [-1 + 2 * i / n for i in range(n + 1)]


def radial(r, grid=icosphere):
    return grid(lambda p: [r(unit(p)) * c for c in unit(p)])


def ellipsoid(a, b, c):
    return radial(lambda d: 1 / math.sqrt((d[0] / a) ** 2 + (d[1] / b) ** 2 + (d[2] / c) ** 2))


def superquadric(a, b, c, e):
    """|x/a|^(2/e) + |y/b|^(2/e) + |z/c|^(2/e) = 1: e 0.2 is nearly a box, 1 an ellipsoid, 2 an octahedron."""
    k = 2 / e
    r = lambda d: (abs(d[0] / a) ** k + abs(d[1] / b) ** k + abs(d[2] / c) ** k) ** (-1 / k)
    if e >= 0.8:
        return radial(r)
    def place(p):
        d = unit([p[0] * a, p[1] * b, p[2] * c])
        return [r(d) * x for x in d]
    return cube_grid(place, even(8))


def rounded(a, b, c, r):
    h = (a, b, c)
    lines = [-1, -0.92, -0.70, -0.30, 0.30, 0.70, 0.92, 1]
    def place(p):
        # The outer eighth of a grid's edge, on either side, becomes the rounding.
        q = [math.copysign(min(1.0, abs(x) / 0.70), x) * (s - r) for x, s in zip(p, h)]
        out = unit([math.copysign(max(0.0, abs(x) - 0.70) / 0.30, x) for x in p])
        return [x + r * d for x, d in zip(q, out)]
    return cube_grid(place, lines)


def loft(profile, section=lambda angle: 1.0, segments=24):
    """profile: (z, scale) upwards; the first and the last, of scale 0, are the poles."""
    mesh = Builder(None)
    mesh.points.append([0, 0, profile[0][0]])
    for z, scale in profile[1:-1]:
        for k in range(segments):
            t = 2 * math.pi * k / segments
            mesh.points.append([scale * section(t) * math.cos(t), scale * section(t) * math.sin(t), z])
    mesh.points.append([0, 0, profile[-1][0]])
    ring = lambda i, k: 1 + i * segments + k % segments
    last = len(profile) - 3
    for k in range(segments):
        mesh.triangles.append((0, ring(0, k + 1), ring(0, k)))
        mesh.triangles.append((len(mesh.points) - 1, ring(last, k), ring(last, k + 1)))
        for i in range(last):
            mesh.triangles.append((ring(i, k), ring(i, k + 1), ring(i + 1, k + 1)))
            mesh.triangles.append((ring(i, k), ring(i + 1, k + 1), ring(i + 1, k)))
    return mesh


def revolution(r, half, rings=15):
    """r(z/half): radius; z runs so that rings lie closer near the poles."""
    zs = [-math.cos(math.pi * i / (rings + 1)) for i in range(rings + 2)]
    return loft([(half * z, 0 if abs(z) > 1 - 1e-9 else r(z)) for z in zs])


def cylinder(radius, half, chamfer=1.5):
    inner = radius - chamfer
    return loft([(-half, 0), (-half, 0.6 * inner), (-half, inner), (chamfer - half, radius), (-half / 3, radius),
                 (half / 3, radius), (half - chamfer, radius), (half, inner), (half, 0.6 * inner), (half, 0)])


def prism(sides, radius, half, corner):
    """Regular polygon with round corners (superposition of p-norms), slightly domed ends."""
    def section(t):
        total = sum(max(0.0, math.cos(t - 2 * math.pi * k / sides)) ** corner for k in range(sides))
        return total ** (-1 / corner)
    r = radius
    return loft([(-half, 0), (-half, 0.55 * r), (-half + 1, 0.88 * r), (-half + 4, r), (-half / 3, r), (half / 3, r),
                 (half - 4, r), (half - 1, 0.88 * r), (half, 0.55 * r), (half, 0)], section, 24 if sides != 5 else 30)


def peanut(radius, waist, half):
    """Two lobes of `radius`, a waist between."""
    depth = 1 - waist / radius
    return revolution(lambda z: radius * (1 - z ** 4) ** 0.5 * (1 - depth * math.exp(-(z / 0.35) ** 2)), half)


def pear(low, high, half):
    bend = lambda z: low + (high - low) * (1 + math.tanh(2.2 * z)) / 2
    return revolution(lambda z: (1 - z * z) ** 0.5 * bend(z), half)


def lens(radius, half):
    return revolution(lambda z: radius * (1 - abs(z) ** 1.3) ** 0.62, half)


def pillow(a, c):
    r = lambda d: ((abs(d[0] / a) ** 4 + abs(d[1] / a) ** 4) ** 0.5 + (d[2] / c) ** 2) ** -0.5
    return radial(r)


def bumpy(radius, bump, along, about):
    def r(d):
        around = math.atan2(d[1], d[0])
        return radius + bump * (1 - d[2] ** 2) ** 1.5 * math.cos(about * around) + bump * along * (d[2] ** 3 - 0.6 * d[2])
    return radial(r)


def knobbly(radius, bump):
    return radial(lambda d: radius + bump * math.sin(4.1 * d[0] + 0.3) * math.sin(3.7 * d[1] - 0.8)
                  * math.cos(4.4 * d[2]))


def lying(mesh, degrees=0):
    """Turned so that z lies along x, then about z."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    mesh.points = [[c * z + s * y, s * z - c * y, x] for x, y, z in mesh.points]
    return mesh


ZOO = {
    "ellipsoid_tall": lambda: ellipsoid(20, 20, 30),
    "ellipsoid_lying": lambda: ellipsoid(33, 22, 22),
    "ellipsoid_flat": lambda: ellipsoid(28, 28, 17),
    "ellipsoid_three_axes": lambda: ellipsoid(30, 24, 19),
    "superquadric_02": lambda: superquadric(20.5, 20.5, 20.5, 0.2),
    "superquadric_04": lambda: superquadric(22, 22, 22, 0.4),
    "superquadric_06": lambda: superquadric(25, 22, 22, 0.6),
    "superquadric_08": lambda: superquadric(25, 24, 24, 0.8),
    "superquadric_12": lambda: superquadric(26, 26, 26, 1.2),
    "superquadric_14": lambda: superquadric(27, 27, 27, 1.4),
    "cylinder_upright": lambda: cylinder(22, 28),
    "cylinder_wide": lambda: cylinder(26, 20),
    "cylinder_lying": lambda: lying(cylinder(20, 29)),
    "cylinder_across": lambda: lying(cylinder(22, 26), 90),
    "box_rounded": lambda: rounded(25, 21, 19, 8),
    "box_tall": lambda: rounded(19, 19, 29, 8),
    "box_flat": lambda: rounded(24, 24, 16, 6),
    "cube_rounded": lambda: rounded(21, 21, 21, 5),
    "peanut_upright": lambda: peanut(22, 16.5, 32),
    "peanut_lying": lambda: lying(peanut(22, 17, 31)),
    "pear": lambda: pear(25, 15, 30),
    "pear_lying": lambda: lying(pear(24, 15, 28)),
    "lens": lambda: lens(29, 16),
    "pillow": lambda: pillow(26, 18),
    "triangle": lambda: prism(3, 17, 24, 5),
    "square": lambda: prism(4, 20, 25, 7),
    "hexagon": lambda: prism(6, 22, 22, 16),
    "bumpy_three": lambda: bumpy(24, 2.5, 0.0, 3),
    "bumpy_five": lambda: bumpy(24, 1.8, 0.0, 5),
    "bumpy_lopsided": lambda: bumpy(24, 2.2, 2.0, 2),
    "knobbly": lambda: knobbly(24, 2.5),
}


URDF = """<?xml version="1.0"?>
<!-- Written by make_zoo.py: homogeneous, {size} mm, 80 g. SI units. -->
<robot name="zoo_{name}">
  <link name="object">
    <inertial>
      <mass value="0.08"/>
      <inertia ixx="{xx:.6g}" ixy="{xy:.6g}" ixz="{xz:.6g}" iyy="{yy:.6g}" iyz="{yz:.6g}" izz="{zz:.6g}"/>
    </inertial>
    <collision>
      <geometry><mesh filename="zoo_{name}.obj"/></geometry>
    </collision>
  </link>
</robot>
"""


def write(folder, name, mesh):
    points = [[1e-3 * c for c in p] for p in mesh.points]
    _, centroid, _ = moments(points, mesh.triangles)
    points = [[round(c - m, 7) + 0.0 for c, m in zip(p, centroid)] for p in points]
    volume, _, s = moments(points, mesh.triangles)
    size = [1e3 * (max(p[c] for p in points) - min(p[c] for p in points)) for c in range(3)]
    size = " x ".join("%.0f" % c for c in size)
    with open(os.path.join(folder, "zoo_%s.obj" % name), "w", encoding="ascii") as out:
        out.write("# Written by make_zoo.py. Metres; origin at the centroid.\n")
        out.writelines("v %.7f %.7f %.7f\n" % tuple(p) for p in points)
        out.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in mesh.triangles)
    d = MASS / volume
    clean = lambda v: 0.0 if abs(v) < 1e-10 else v
    with open(os.path.join(folder, "zoo_%s.urdf" % name), "w", encoding="ascii") as out:
        out.write(URDF.format(name=name, size=size, xx=d * (s[1][1] + s[2][2]), yy=d * (s[0][0] + s[2][2]),
                              zz=d * (s[0][0] + s[1][1]), xy=clean(-d * s[0][1]), xz=clean(-d * s[0][2]),
                              yz=clean(-d * s[1][2])))
    print("%-22s %-14s mm  %4d triangles  %5.1f cm3" % (name, size, len(mesh.triangles), 1e6 * volume))


def turned(mesh, q):
    """By the quaternion q = (w, x, y, z), of any length."""
    w, x, y, z = (c / math.sqrt(sum(d * d for d in q)) for c in q)
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
    mesh.points = [[sum(r * c for r, c in zip(row, p)) for row in rows] for p in mesh.points]
    return mesh


def random_body(draw):
    """A body 30 to 68 mm wide along every axis and its kind; half of them turned, half of these about z only."""
    u = draw.uniform
    kinds = {
        "ellipsoid": lambda: ellipsoid(u(18, 31), u(18, 31), u(16, 31)),
        "superquadric": lambda: superquadric(u(20, 27), u(20, 27), u(18, 27), u(0.2, 1.5)),
        "rounded": lambda: rounded(u(16, 26), u(16, 26), u(16, 27), u(3, 9)),
        "cylinder": lambda: cylinder(u(17, 26), u(18, 29)),
        "prism": lambda: prism(draw.choice([3, 4, 5, 6]), u(17, 22), u(20, 27), u(5, 16)),
        "peanut": lambda: (lambda r: peanut(r, r * u(0.7, 0.9), u(26, 33)))(u(19, 24)),
        "pear": lambda: pear(u(22, 26), u(14, 19), u(25, 31)),
        "lens": lambda: lens(u(25, 30), u(14, 20)),
        "pillow": lambda: pillow(u(22, 27), u(16, 22)),
        "bumpy": lambda: bumpy(u(22, 26), u(1, 3), u(0, 2), draw.choice([2, 3, 4, 5])),
        "knobbly": lambda: knobbly(u(22, 26), u(1, 3)),
    }
    while True:
        kind = draw.choice(list(kinds))
        mesh = kinds[kind]()
        if draw.random() < 0.5:
            about_z = draw.random() < 0.5
            q = [draw.gauss(0, 1) for _ in range(4)]
            mesh = turned(mesh, (q[0], 0, 0, q[3]) if about_z else q)
        widths = [max(p[c] for p in mesh.points) - min(p[c] for p in mesh.points) for c in range(3)]
        if 30 <= min(widths) and max(widths) <= 68:
            return kind, mesh


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--random", type=int, metavar="N", help="N random bodies instead of the zoo")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-o", metavar="DIR", default=os.path.dirname(os.path.abspath(__file__)))
    given = parser.parse_args()
    if given.random is None:
        bodies = ((name, make()) for name, make in ZOO.items())
    else:
        draw = random.Random(given.seed)
        drawn = (random_body(draw) for _ in range(given.random))
        bodies = (("%s_%d" % (kind, i), mesh) for i, (kind, mesh) in enumerate(drawn))
    os.makedirs(given.o, exist_ok=True)
    for name, mesh in bodies:
        write(given.o, name, mesh)


if __name__ == "__main__":
    main()
