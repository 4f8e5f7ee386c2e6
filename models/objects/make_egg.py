#!/usr/bin/env python3
"""Writes egg.obj and prints its inertia: a closed, convex egg of 50 x about 41 mm.

A unit sphere (an icosahedron, each edge cut into N) is mapped by
    (x, y, z) -> (b x / s, b y / s, a z),   s = sqrt(1 + k z),   a = 25 mm, b = 20 mm, k = 0.25,
which makes the profile r(z)^2 = b^2 (1 - t^2) / (1 + k t), t = z / a, and then moved so that the
centroid of the solid is the origin. Standard library only.
"""
import math
import os

from solid import det, icosahedron, moments

A, B, K, N = 0.025, 0.020, 0.25, 16
MASS = 0.080


def mesh():
    corners, faces = icosahedron()
    index, points, triangles = {}, [], []

    def vertex(p):
        norm = math.sqrt(sum(c * c for c in p))
        x, y, z = (c / norm for c in p)
        key = tuple(round(c, 9) for c in (x, y, z))
        if key not in index:
            s = math.sqrt(1 + K * z)
            index[key] = len(points)
            points.append([B * x / s, B * y / s, A * z])
        return index[key]

    for f in faces:
        p, q, r = (corners[i] for i in f)
        if det(p, q, r) < 0:
            q, r = r, q
        at = lambda i, j: vertex([p[c] + (q[c] - p[c]) * i / N + (r[c] - p[c]) * j / N for c in range(3)])
        for i in range(N):
            for j in range(N - i):
                triangles.append((at(i, j), at(i + 1, j), at(i, j + 1)))
                if i + j < N - 1:
                    triangles.append((at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)))
    return points, triangles


def main():
    points, triangles = mesh()
    _, centroid, _ = moments(points, triangles)
    points = [[p[c] - centroid[c] for c in range(3)] for p in points]
    points = [[round(c, 9) for c in p] for p in points]
    volume, centroid, s = moments(points, triangles)
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "egg.obj")
    with open(path, "w", encoding="ascii") as out:
        out.write("# Written by make_egg.py. Metres; origin at the centroid.\n")
        out.writelines("v %.9f %.9f %.9f\n" % tuple(p) for p in points)
        out.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in triangles)
    density = MASS / volume
    print("vertices", len(points), "triangles", len(triangles), "volume_m3 %.6g" % volume)
    print("centroid_m", centroid, "size_m", [max(p[c] for p in points) - min(p[c] for p in points) for c in range(3)])
    print("ixx %.5g iyy %.5g izz %.5g for %g kg" % (density * (s[1][1] + s[2][2]),
          density * (s[0][0] + s[2][2]), density * (s[0][0] + s[1][1]), MASS))


main()
